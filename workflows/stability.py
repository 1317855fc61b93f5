"""What a quasi-static run says about stability: limit points, bifurcations, buckling modes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from workflows.workflow import Export, Quantity

if TYPE_CHECKING:
    from stages.mechanics.config import EquilibriumConfig
    from stages.numerics.bsplines import Array
    from workflows.experiment import Experiment


def stability_quantities(experiment: Experiment) -> dict[str, Quantity]:
    """Critical load factors, of a path by arc length and of the buckling modes, where there are any."""
    mechanics: EquilibriumConfig = experiment.config.mechanics
    found: dict[str, Quantity] = {}
    if mechanics.control.kind == "arc-length":
        found |= _path_quantities(experiment)
    if mechanics.buckling_modes:
        found["buckling_factors"] = Quantity(
            _listed(experiment.buckling.factors),
            "",
            "factors of what acts at the last instant under which the film at rest would buckle, for a film "
            "that hardly deforms before",
        )
    return found


def _path_quantities(experiment: Experiment) -> dict[str, Quantity]:
    path = experiment.path
    return {
        "load_factor": Quantity(
            float(path.load_factor[-1]), "", "load factor at the end of the path"
        ),
        "limit_loads": Quantity(
            _listed(path.limit_loads),
            "",
            "load factors at which the load cannot grow (or fall) any further, in the order of the path",
        ),
        "bifurcation_loads": Quantity(
            _listed(path.bifurcation_loads), "", "load factors at which another path branches off"
        ),
        "unstable_directions": Quantity(
            float(path.unstable_directions[-1]),
            "",
            "ways in which the film would leave its last shape by itself; 0 where that is stable",
        ),
    }


def _listed(values: Array) -> list[float | None]:
    return [float(value) for value in values]


MODES = Export(
    files=("modes.png", "modes.svg"),
    modules=("workflows.figures.modes",),
    stages=("geometry", "buckling"),
    kind="picture",
    caption="How the film would buckle, with the load factor of each mode; the size of a mode means "
    "nothing. Linearised at the film at rest, which is the truth where it hardly deforms before.",
    shown=lambda config: bool(config.mechanics.buckling_modes),
)

MODES_FILE = Export(
    files=("modes.vtkhdf",),
    modules=("workflows.exports.paraview_modes",),
    stages=("geometry", "buckling"),
    kind="data",
    caption="The buckling modes for ParaView 5.12 or newer, one a time step.",
    shown=lambda config: bool(config.mechanics.buckling_modes),
)
