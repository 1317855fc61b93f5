"""Configuration of the electrophysiology stage."""

from __future__ import annotations

from difflib import get_close_matches
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from stages.configuration import Count, Edge, OneOf, Section, quantity, setting, unkeyed
from stages.electrophysiology.cell_models.base import CellModel
from stages.electrophysiology.tension_laws.base import TensionLaw


class EdgeFlux(Section):
    """Current flux through one edge of the film, for a while (eqs. 8, 78)."""

    kind: Literal["edge-flux"] = "edge-flux"
    edge: Edge = setting("edge that is stimulated", "sec. 4.3")
    start: float = quantity("ms", "time at which the stimulus begins", "sec. 4.3", ge=0)
    duration: float = quantity("ms", "length of the stimulus", "sec. 4.3", gt=0)
    flux: float = quantity("nF*mV/ms/mm", "inward flux I_n = n . D grad v", "sec. 4.3")


class PatchCurrent(Section):
    """Current applied to a rectangle of the film, by X and Y, for a while (eqs. 8, 73)."""

    kind: Literal["patch-current"]
    x: tuple[float, float] = quantity("mm", "extent along X", "eq. 8")
    y: tuple[float, float] = quantity("mm", "extent along Y", "eq. 8")
    start: float = quantity("ms", "time at which the stimulus begins", "eq. 8", ge=0)
    duration: float = quantity("ms", "length of the stimulus", "eq. 8", gt=0)
    current: float = quantity("nF*mV/ms/mm^2", "applied current I_app", "eq. 8")

    @model_validator(mode="after")
    def _extents_increase(self) -> PatchCurrent:
        for axis in ("x", "y"):
            low, high = getattr(self, axis)
            if not low < high:
                raise PydanticCustomError(
                    "extent", "{axis} must run from a smaller to a larger value", {"axis": axis}
                )
        return self


Stimulus = Annotated[EdgeFlux | PatchCurrent, Field(discriminator="kind")]


class ElectrophysiologyConfig(Section):
    """Monodomain problem on the active layer: mesh, time grid, cells, tension, stimuli."""

    elements: tuple[Count, Count] = setting("knot spans along X and along Y", "sec. 4.3")
    degree: int = setting("degree of the splines; C1 is needed, so 2 or more", "sec. 4.3", ge=2)
    n_steps: int = setting("number of time steps", "sec. 4.3", ge=1, le=10**9)
    duration: float = quantity("ms", "simulated time", "sec. 4.3", gt=0)
    output_interval: float = quantity(
        "ms", "time between stored frames, rounded to whole time steps", "this project", gt=0
    )
    activation_threshold: float = quantity(
        "mV", "potential whose upward crossing is the activation time", "this project"
    )
    conductivity: float = quantity("nF/ms", "tissue conductivity D", "Table 3", gt=0)
    transverse_conductivity: float | None = quantity(
        "nF/ms",
        "conductivity across the fibres, where `conductivity` is that along them; none: the same",
        "eq. 8, D as a tensor",
        gt=0,
        default=None,
    )
    diffusion_angle: float | None = quantity(
        "degree",
        "angle from X of the fibres that conduct better; none: that of the active layer's fibres",
        "eq. 8, D as a tensor",
        ge=-180,
        le=180,
        default=None,
    )
    membrane_capacitance: float = quantity("nF/mm^2", "membrane capacitance C_m", "Table 3", gt=0)
    initial_potential: float = quantity("mV", "potential at rest v_0", "Table 3")
    cell_model: Annotated[CellModel, OneOf("stages.electrophysiology.cell_models", CellModel)] = (
        setting("cell model by name, with its parameters", "eq. 100")
    )
    tension_law: Annotated[
        TensionLaw, OneOf("stages.electrophysiology.tension_laws", TensionLaw)
    ] = setting("tension law by name, with its parameters", "eqs. 97-98")
    stimuli: tuple[Stimulus, ...] = setting(
        "stimuli that are applied: names from the library, or tables", "sec. 4.3"
    )
    stimulus_library: dict[str, Stimulus] = unkeyed(
        "named stimuli that `stimuli` may refer to", default_factory=dict
    )

    @model_validator(mode="before")
    @classmethod
    def _look_up_stimuli(cls, data: Any) -> Any:
        """Replace names in ``stimuli`` by their tables in ``stimulus_library``."""
        if not isinstance(data, dict):
            return data
        library = data.get("stimulus_library") or {}
        chosen = data.get("stimuli")
        if isinstance(chosen, str):
            names = chosen.strip().removeprefix("[").removesuffix("]").split(",")
            chosen = [name.strip() for name in names if name.strip()]
        if not isinstance(chosen, list | tuple) or not isinstance(library, dict):
            return data
        for name in chosen:
            if isinstance(name, str) and name not in library:
                near = get_close_matches(name, library, n=1, cutoff=0.3)
                raise PydanticCustomError(
                    "unknown_stimulus",
                    "stimuli: no stimulus is called {name}{hint}; the library holds: {allowed}",
                    {
                        "name": repr(name),
                        "hint": f" (did you mean {near[0]!r}?)" if near else "",
                        "allowed": ", ".join(library) or "nothing",
                    },
                )
        return data | {
            "stimuli": tuple(library[item] if isinstance(item, str) else item for item in chosen)
        }

    @model_validator(mode="after")
    def _angle_has_a_meaning(self) -> ElectrophysiologyConfig:
        if self.diffusion_angle is not None and self.transverse_conductivity is None:
            raise PydanticCustomError(
                "angle_without_fibres",
                "diffusion_angle has no meaning without transverse_conductivity: the tissue conducts "
                "alike in all directions",
                {},
            )
        return self

    @property
    def step(self) -> float:
        """Time step, ms."""
        return self.duration / self.n_steps

    @property
    def steps_per_frame(self) -> int:
        """Time steps between stored frames: the output interval in whole steps, one at least."""
        return max(round(self.output_interval / self.step), 1)

    @property
    def frame_steps(self) -> list[int]:
        """Steps after which a frame is stored: 0, then every ``steps_per_frame``, and the last."""
        return [*range(0, self.n_steps, self.steps_per_frame), self.n_steps]
