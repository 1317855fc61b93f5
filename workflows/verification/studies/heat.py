"""Decay of heat modes: orders of diffusion in space and in time, for every scheme and both solvers.

Without reaction, v = v_0 + a cos(k pi X/L) cos(m pi Y/W) exp(-D/C_m (k^2/L^2 + m^2/W^2) pi^2 t) on a film without flux. In
space, errors are those at vanishing step: two runs, with so many steps and twice as many, extrapolated. Collocation
at Greville points converges at order p for even and p - 1 for odd degree.

References
----------
Auricchio, Beirao da Veiga, Hughes, Reali, Sangalli (2010), Isogeometric collocation methods, Math. Models Methods
Appl. Sci. 20, 2075, for the orders in space.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from pipeline.nodes import StageRun, stage
from stages.artefacts import StudyTable
from stages.configuration import Count, Section, quantity, setting
from stages.electrophysiology.config import ElectrophysiologyConfig
from stages.electrophysiology.schemes.base import AnyScheme, Scheme
from workflows.verification.orders import behind, draw_orders, number_of, order_quantities
from workflows.verification.study import Study
from workflows.workflow import Quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stages.numerics.bsplines import Array

ROUND_OFF = 1e-9
"""Relative errors below this are not used for orders: hundreds of steps on 80 mV, extrapolated."""


class HeatConfig(Section):
    """Film, mode, meshes, steps and schemes."""

    length: float = quantity("mm", "length of the film", "this project", gt=0)
    width: float = quantity("mm", "width of the film", "this project", gt=0)
    waves: tuple[Count, Count] = setting("half waves of the mode along X and Y")
    amplitude: float = quantity("mV", "amplitude of the mode at the start", "this project")
    degrees: tuple[int, ...] = setting("degrees of the splines")
    elements: tuple[Count, ...] = setting("knot spans per direction")
    steps: tuple[Count, ...] = setting("steps on the finest mesh of the highest degree")
    schemes: tuple[AnyScheme, ...] = setting("schemes in time")
    electrophysiology: ElectrophysiologyConfig = setting(
        "tissue without stimuli; its duration, and its steps for the orders in space"
    )


@stage
def heat(config: HeatConfig, *, run: StageRun) -> StudyTable:
    """Relative L2 errors; ``scheme`` is a number, ``general`` the solver, rows without ``steps`` are extrapolated."""
    import numpy as np

    n = config.electrophysiology.n_steps
    space = [(p, h) for p in config.degrees for h in config.elements]
    time = [(s, way) for s in config.schemes for way in (False, True)]
    rows = []
    for degree, elements in space:
        exact, (once, twice) = _ends(config, degree, elements, (n, 2 * n))
        error = _relative(once + 4.0 / 3.0 * (twice - once), exact)
        rows.append((degree, elements, 0, number_of(config.schemes[-1]), False, error))
        run.progress(len(rows), len(space) + len(time))
    degree, elements = max(config.degrees), max(config.elements)
    for number, (scheme, general) in enumerate(time, start=1):
        exact, ends = _ends(config, degree, elements, config.steps, scheme, general)
        for steps, end in zip(config.steps, ends, strict=True):
            rows.append(
                (degree, elements, steps, number_of(scheme), general, _relative(end, exact))
            )
        run.progress(len(space) + number, len(space) + len(time))
    names = ("degree", "elements", "steps", "scheme", "general", "error")
    return StudyTable(names, ("",) * 6, np.array(rows, dtype=float))


def _ends(
    config: HeatConfig,
    degree: int,
    elements: int,
    counts: tuple[int, ...],
    scheme: Scheme | None = None,
    general: bool = False,
) -> tuple[Array, list[Array]]:
    """The mode at the end in closed form, and after so many steps, mV; shape ``(point,)``."""
    import numpy as np

    from stages.electrophysiology.monodomain import build
    from stages.numerics.patches import Patch

    patch = Patch.rectangle(config.length, config.width).refine(degree, (elements, elements))
    x, y = patch.evaluate(patch.first.greville(), patch.second.greville())[:, :2].T
    tissue = config.electrophysiology
    k = np.pi * np.array(config.waves) / (config.length, config.width)
    mode = config.amplitude * np.cos(k[0] * x) * np.cos(k[1] * y)
    rate = tissue.conductivity / tissue.membrane_capacitance * float(k @ k)
    silent = tissue.cell_model.model_copy(update={"k_v": 0.0})  # no current, and w stays at 0
    ends = []
    for steps in counts:
        changes = {"n_steps": steps, "scheme": scheme or config.schemes[-1], "cell_model": silent}
        stepper, state = build(tissue.model_copy(update=changes), patch, general)
        state.potential += mode
        state.diffusion[:] = stepper.diffusion_state(state.potential)
        stepper.advance(state, steps)
        ends.append(state.potential - tissue.initial_potential)
    return np.asarray(mode * np.exp(-rate * tissue.duration)), ends


def _relative(found: Array, exact: Array) -> float:
    import numpy as np

    return float(np.linalg.norm(found - exact) / np.linalg.norm(exact))


def quantities(table: StudyTable) -> dict[str, Quantity]:
    """Observed orders, and how far they fall behind the theory at most."""
    return order_quantities(table, "error", ROUND_OFF) | {
        "order_deficit": Quantity(
            behind(table, "error", ROUND_OFF),
            "",
            "how far an order falls behind at most",
            limit=0.3,
        )
    }


def draw(table: StudyTable, figure: Figure) -> None:
    """Errors over mesh and step; dotted lines have the theoretical slopes."""
    draw_orders(table, figure, "error", "relative L2 error")


STUDY = Study(
    name="heat",
    title="Decay of heat modes on a film without flux: orders in space and time against the closed form",
    stage=heat,
    draw=draw,
    quantities=quantities,
)
