"""Travelling front of the cubic reaction: speed and profile, and their orders in space and time.

With the recovery variable frozen at w = 0 the Aliev-Panfilov model is Nagumo's equation, whose front is known:
v* = 1/(1 + exp((x - c t)/l)) = (1 - tanh((x - c t)/2l))/2 with l = sqrt(2 D/k), c = sqrt(k D/2)(1 - 2a), k = k_v/r_t. A
front that starts with the exact profile settles, and is then timed. Errors in space are those at vanishing step, from two runs
extrapolated; errors in time are differences from that on the same mesh.

References
----------
Nagumo, Yoshizawa, Arimoto (1965), Bistable transmission lines, IEEE Trans. Circuit Theory 12, 400.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from pipeline.nodes import StageRun, stage
from stages.artefacts import StudyTable
from stages.configuration import Count, Section, quantity, setting
from stages.electrophysiology.cell_models.aliev_panfilov import AlievPanfilov
from stages.electrophysiology.config import ElectrophysiologyConfig
from stages.electrophysiology.schemes.base import AnyScheme, Scheme
from workflows.verification.orders import behind, draw_orders, number_of, order_quantities
from workflows.verification.study import Study
from workflows.workflow import Quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stages.numerics.bsplines import Array

ROUND_OFF = 1e-8
"""Relative errors below this are not used for orders: what the extrapolation leaves."""


class FrontConfig(Section):
    """Strip, meshes, steps and schemes."""

    length: float = quantity("mm", "length of the strip", "sec. 4.1", gt=0)
    start: float = quantity("mm", "place of the front at the start", "this project", gt=0)
    settling: float = quantity("ms", "time before the front is timed", "this project", gt=0)
    degrees: tuple[int, ...] = setting("degrees of the splines")
    elements: tuple[Count, ...] = setting("knot spans along the strip")
    time_mesh: tuple[int, Count] = setting("degree and knot spans for the orders in time")
    steps: tuple[Count, ...] = setting("steps for the orders in time")
    schemes: tuple[AnyScheme, ...] = setting("schemes in time")
    electrophysiology: ElectrophysiologyConfig = setting(
        "tissue; its duration, and its steps for the orders in space"
    )


class Passage(NamedTuple):
    """Speed in mm/ms, and v* at the end over the distance from the front in l, shape ``(point,)``."""

    speed: float
    profile: Array
    exact: Array


class Closed(NamedTuple):
    """Speed in mm/ms and length l in mm of the front in closed form."""

    speed: float
    length: float


def closed_form(tissue: ElectrophysiologyConfig) -> Closed:
    """The front of a tissue of Aliev-Panfilov cells whose w is 0."""
    cell = tissue.cell_model
    assert isinstance(cell, AlievPanfilov)
    diffusivity, rate = (
        tissue.conductivity / tissue.membrane_capacitance,
        cell.k_v / cell.time_scale,
    )
    return Closed(
        (0.5 * rate * diffusivity) ** 0.5 * (1.0 - 2.0 * cell.a), (2.0 * diffusivity / rate) ** 0.5
    )


@stage
def front(config: FrontConfig, *, run: StageRun) -> StudyTable:
    """Relative errors of the speed, and largest errors of v* beside the front where it is."""
    import numpy as np

    speed, n = closed_form(config.electrophysiology).speed, config.electrophysiology.n_steps
    space = [(p, h) for p in config.degrees for h in config.elements]
    time = [(s, way) for s in config.schemes for way in (False, True)]
    rows = []
    for degree, elements in space:
        limit = _limit(config, degree, elements, n)
        error = (abs(limit.speed / speed - 1.0), float(np.abs(limit.profile - limit.exact).max()))
        rows.append((degree, elements, 0, number_of(config.schemes[-1]), False, *error))
        run.progress(len(rows), len(space) + len(time))
    mesh = config.time_mesh
    limit = _limit(config, *mesh, n)
    for number, (scheme, general) in enumerate(time, start=1):
        for steps in config.steps:
            found = _pass(config, *mesh, steps, scheme, general)
            rows.append(
                (
                    *mesh,
                    steps,
                    number_of(scheme),
                    general,
                    abs(found.speed / limit.speed - 1.0),
                    float(np.abs(found.profile - limit.profile).max()),
                )
            )
        run.progress(len(space) + number, len(space) + len(time))
    names = ("degree", "elements", "steps", "scheme", "general", "speed_error", "profile_error")
    return StudyTable(names, ("",) * 7, np.array(rows, dtype=float))


def _limit(config: FrontConfig, degree: int, elements: int, n: int) -> Passage:
    """The passage at vanishing step, from n and 2n steps of a scheme of second order."""
    once, twice = (_pass(config, degree, elements, steps) for steps in (n, 2 * n))
    return Passage(
        twice.speed + (twice.speed - once.speed) / 3.0,
        twice.profile + (twice.profile - once.profile) / 3.0,
        twice.exact + (twice.exact - once.exact) / 3.0,
    )


def _pass(
    config: FrontConfig,
    degree: int,
    elements: int,
    steps: int,
    scheme: Scheme | None = None,
    general: bool = False,
) -> Passage:
    """One run along the strip."""
    import numpy as np

    from stages.electrophysiology.monodomain import build
    from stages.numerics.patches import Patch

    tissue, exact = config.electrophysiology, closed_form(config.electrophysiology)
    cell = tissue.cell_model
    assert isinstance(cell, AlievPanfilov)
    frozen = cell.model_copy(update={"e_0": 0.0, "mu_1": 0.0})
    patch = Patch.rectangle(config.length, config.length / elements).refine(degree, (elements, 1))
    changes = {"n_steps": steps, "scheme": scheme or config.schemes[-1], "cell_model": frozen}
    cells = tissue.model_copy(update=changes)
    stepper, state = build(cells, patch, general)
    x = patch.evaluate(patch.first.greville(), patch.second.greville())[:, 0]
    v = 1.0 / (1.0 + np.exp((x - config.start) / exact.length))
    state.potential[:] = cell.potential_range * v + cell.potential_rest
    state.diffusion[:] = stepper.diffusion_state(state.potential)
    state.ionic[:] = (
        cell.potential_range / cell.time_scale * cell.k_v * v * (v - cell.a) * (v - 1.0)
    )
    along = patch.evaluate(patch.first.greville(), [0.5])[:, 0]

    def normalised() -> Array:
        rows = state.potential.reshape(patch.first.size, -1)[:, 1]
        return np.asarray((rows - cell.potential_rest) / cell.potential_range)

    first = round(config.settling / cells.step)
    stepper.advance(state, first)
    before = _place(along, normalised(), exact.length)
    stepper.advance(state, steps - first)
    now = normalised()
    after = _place(along, now, exact.length)
    speed = (after - before) / ((steps - first) * cells.step)
    return Passage(speed, now, 1.0 / (1.0 + np.exp((along - after) / exact.length)))


def _place(x: Array, v: Array, length: float) -> float:
    """Where the logistic profile is one half: the mean over all points of the flank, weighted smoothly."""
    import numpy as np

    inside = np.clip(v, 1e-6, 1.0 - 1e-6)
    weight = (inside * (1.0 - inside)) ** 2
    return float(weight @ (x + length * np.log(inside / (1.0 - inside))) / weight.sum())


def quantities(table: StudyTable) -> dict[str, Quantity]:
    """Orders of speed and profile, and how far they fall behind the theory at most."""
    found: dict[str, Quantity] = {}
    for column, name in (("speed_error", "speed"), ("profile_error", "profile")):
        orders = order_quantities(table, column, ROUND_OFF)
        found |= {f"{name}_{key}": order for key, order in orders.items()}
        found[f"{name}_order_deficit"] = Quantity(
            behind(table, column, ROUND_OFF),
            "",
            f"how far an order of the {name} falls behind the theory at most",
            limit=0.1,
        )
    return found


def draw(table: StudyTable, figure: Figure) -> None:
    """Errors of the speed; dotted lines have the theoretical slopes."""
    draw_orders(table, figure, "speed_error", "relative error of the speed")


STUDY = Study(
    name="front",
    title="Travelling front of the cubic reaction: speed and profile against the closed form (Nagumo)",
    stage=front,
    draw=draw,
    quantities=quantities,
)
