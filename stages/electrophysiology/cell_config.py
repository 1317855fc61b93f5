"""Configuration of cells: cell model, tension law, and the state from which they start."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import ValidationInfo, field_validator

from stages.configuration import OneOf, Section, quantity, setting, unkeyed
from stages.electrophysiology.cell_models.base import CellModel
from stages.electrophysiology.tension_laws.base import TensionLaw

AnyCellModel = Annotated[
    CellModel, OneOf("stages.electrophysiology.cell_models", CellModel, library="cell_models")
]
AnyTensionLaw = Annotated[
    TensionLaw, OneOf("stages.electrophysiology.tension_laws", TensionLaw, library="tension_laws")
]


class CellConfig(Section):
    """Cells and their active stress; what the potential is at rest follows from the cell model."""

    cell_model: AnyCellModel = setting(
        "cell model: the name of a parameter set, or a table with its parameters", "eq. 100"
    )
    tension_law: AnyTensionLaw = setting(
        "tension law: the name of a parameter set, or a table with its parameters", "eqs. 97-98"
    )
    initial_potential: float = quantity(
        "mV",
        "potential at the start v_0; left out: the cells' rest",
        "Table 3",
        default=None,
        validate_default=True,
    )
    cell_models: dict[str, AnyCellModel] = unkeyed(
        "named parameter sets that `cell_model` may take", default_factory=dict
    )
    tension_laws: dict[str, AnyTensionLaw] = unkeyed(
        "named parameter sets that `tension_law` may take", default_factory=dict
    )

    @field_validator("initial_potential", mode="before")
    @classmethod
    def _start_at_rest(cls, value: Any, info: ValidationInfo) -> Any:
        cells = info.data.get("cell_model")
        if value is not None or cells is None:  # without cells the configuration is refused anyway
            return 0.0 if value is None else value
        return cells.rest_potential()

    @field_validator("tension_law", mode="after")
    @classmethod
    def _stress_vanishes_at_rest(cls, law: TensionLaw, info: ValidationInfo) -> TensionLaw:
        cells = info.data.get("cell_model")
        return law if cells is None else law.for_cells(cells)
