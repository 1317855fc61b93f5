"""How the spiral wave of section 4.3 moves when mesh and step are refined.

A spiral keeps its errors: each turn starts where the last one ended, so that activation times drift
apart in proportion to time. They do so smoothly, by no more than the error of the speed of its front, and
two discretisations as different as the published one and an economical one tend to the same times.

The first run is the reference. Runs with the published scheme and degree 2 follow, the first of them
as published, then on finer meshes, which must be listed from coarse to fine, then in longer steps.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from pipeline.nodes import StageRun, stage
from stages.artefacts import StudyTable
from stages.configuration import Count, Section, quantity, setting
from stages.electrophysiology.config import ElectrophysiologyConfig
from workflows.verification.study import Study
from workflows.workflow import Quantity

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from stages.numerics.bsplines import Array

PLACES = {"A": (0.5, 0.5), "B": (1.0, 0.5), "C": (1.0, 1.0)}
BEATS = 5
"""Activations of B and C in 2 s."""
CAUSED = 2
"""Activations of C by the two stimuli; each later one ends a turn."""


class RunConfig(Section):
    """What differs from run to run."""

    scheme: str = setting("scheme in time by name", "this project")
    degree: int = setting("degree of the splines", "this project", ge=2)
    elements: tuple[Count, Count] = setting("knot spans along X and Y", "this project")
    step: float = quantity("ms", "time step", "this project", gt=0)


class SpiralRefinementConfig(Section):
    """The film, its cells, and the runs."""

    length: float = quantity("mm", "length L1 of the film", "sec. 4.1", gt=0)
    width: float = quantity("mm", "width L2 of the film", "sec. 4.1", gt=0)
    cells: ElectrophysiologyConfig = setting(
        "cells and stimuli; elements, degree, n_steps and scheme are those of each run", "sec. 4.3"
    )
    runs: tuple[RunConfig, ...] = setting("the reference, and the runs to compare", "this project")


@stage
def spiral_refinement(config: SpiralRefinementConfig, *, run: StageRun) -> StudyTable:
    """Activation times of each run at the centre A, the tip B and the corner C."""
    import numpy as np

    rows = []
    for one in config.runs:
        times = _activations(config, one)
        published = float(one.scheme == "cn-ab2")
        rows.append((published, one.degree, *one.elements, one.step, *times.ravel()))
        run.progress(len(rows), len(config.runs))
    names = tuple(f"{place}{beat + 1}" for place in PLACES for beat in range(BEATS))
    return StudyTable(
        columns=("published", "degree", "elements_x", "elements_y", "step", *names),
        units=("", "", "", "", "ms", *("ms",) * len(names)),
        values=np.array(rows),
    )


def _activations(config: SpiralRefinementConfig, one: RunConfig) -> Array:
    """Activation times at the places, shape ``(place, beat)``, NaN where there are fewer."""
    import numpy as np

    from stages.electrophysiology.monodomain import build
    from stages.electrophysiology.recording import BeatRecorder
    from stages.numerics.patches import Patch
    from stages.postprocessing.beats import arrival_times

    given = {name: getattr(config.cells, name) for name in type(config.cells).model_fields}
    given |= {"scheme": one.scheme, "degree": one.degree, "elements": one.elements}
    given |= {"n_steps": round(config.cells.duration / one.step)}
    cells = ElectrophysiologyConfig.model_validate(given)
    patch = Patch.rectangle(config.length, config.width).refine(one.degree, one.elements)
    stepper, state = build(cells, patch)
    beats = BeatRecorder(state.potential, cells.activation_threshold, cells.initial_potential)
    for steps in beats.blocks(cells.n_steps):
        stepper.advance(state, steps, beats.watch)
    times = beats.tables()["activation_times"]
    found = arrival_times(patch, times, np.array(list(PLACES.values())))[:, :BEATS]
    missing = np.full((len(PLACES), BEATS - found.shape[1]), np.nan)
    return np.concatenate((found, missing), axis=1)


def activations(table: StudyTable, place: str) -> Array:
    """Activation times at a place, shape ``(run, beat)``, ms."""
    import numpy as np

    return np.stack([table.column(f"{place}{beat + 1}") for beat in range(BEATS)], axis=1)


def periods(table: StudyTable) -> Array:
    """Times of the turns that C sees, shape ``(run, turn)``, ms."""
    import numpy as np

    return np.diff(activations(table, "C")[:, CAUSED - 1 :], axis=1)


def deviations(table: StudyTable) -> Array:
    """Times at B and C less those of the reference, shape ``(run, time)``, ms."""
    import numpy as np

    times = np.concatenate([activations(table, place) for place in "BC"], axis=1)
    return times - times[0]


def _runs(table: StudyTable, *, published: bool) -> NDArray[np.int64]:
    """Numbers of the runs with the published scheme, or of the others but the reference."""
    import numpy as np

    numbers = np.flatnonzero(table.column("published") == float(published))
    return numbers[numbers > 0]


def _series(table: StudyTable, column: str) -> NDArray[np.int64]:
    """Numbers of the published runs that differ from the first of them in that column alone, it included."""
    numbers = _runs(table, published=True)
    other = "step" if column == "elements_x" else "elements_x"
    same = table.column(other)[numbers] == table.column(other)[numbers[0]]
    return numbers[same]


def order(table: StudyTable) -> float:
    """Observed order in the mesh of the published discretisation, at the last activation of C."""
    import numpy as np

    meshes = _series(table, "elements_x")
    error, n = np.abs(deviations(table)[meshes, -1]), table.column("elements_x")[meshes]
    return float(np.log(error[0] / error[-1]) / np.log(n[-1] / n[0]))


def quantities(table: StudyTable) -> dict[str, Quantity]:
    """What the settings are wrong by, and whether refinement is smooth."""
    import numpy as np

    off, turns = deviations(table), periods(table)
    meshes, steps = _series(table, "elements_x"), _series(table, "step")
    economical = _runs(table, published=False)
    last = np.abs(off[meshes, -1]).tolist()
    lag = off[steps] - 0.5 * table.column("step")[steps][:, None]
    return {
        "published_error": Quantity(
            float(np.abs(off[meshes[0]]).max()),
            "ms",
            "largest error of an activation time at B and C in 2 s, as published",
            limit=2.5,
        ),
        "economical_error": Quantity(
            float(np.abs(off[economical[0]]).max()),
            "ms",
            "the same of the economical setting",
            limit=0.25,
        ),
        "published_period_error": Quantity(
            float(np.abs(turns[meshes[0]] - turns[0]).max()),
            "ms",
            "largest error of the time of a turn, as published",
            limit=0.6,
        ),
        "economical_period_error": Quantity(
            float(np.abs(turns[economical[0]] - turns[0]).max()),
            "ms",
            "the same of the economical setting",
            limit=0.06,
        ),
        "not_falling": Quantity(
            float(sum(b >= a for a, b in pairwise(last))),
            "",
            "refinements of the published mesh that do not lower the error of the last activation of C",
            limit=0.0,
        ),
        "order_behind": Quantity(
            max(2.0 - order(table), 0.0),
            "",
            "by how much the order in the mesh falls behind two",
            limit=0.2,
        ),
        "beyond_half_a_step": Quantity(
            float(np.ptp(lag, axis=0).max()),
            "ms",
            "how far longer steps of the published scheme move activation times other than by the half "
            "step that its stimuli are late",
            limit=0.1,
        ),
    }


def draw(table: StudyTable, figure: Figure) -> None:
    """Errors over time of the first activations to the last, and the time of a turn."""
    errors, turning = figure.subplots(1, 2)
    _draw_errors(table, errors)
    _draw_turns(table, turning)


def _labels(table: StudyTable) -> list[str]:
    keys = ("published", "degree", "elements_x", "elements_y", "step")
    return [
        f"p = {degree:.0f}, {n1:.0f} x {n2:.0f}, {step:g} ms" + (" (cn-ab2)" if published else "")
        for published, degree, n1, n2, step in zip(*map(table.column, keys), strict=True)
    ]


def _draw_errors(table: StudyTable, axes: Axes) -> None:
    times, off = activations(table, "C")[0], deviations(table)[:, BEATS:]
    for i, label in enumerate(_labels(table)):
        if i:
            axes.plot(times, off[i], "o-", ms=3.5, lw=1.0, label=label, color=f"C{i - 1}")
    axes.axhline(0.0, color="#9a9a9a", lw=0.8)
    axes.set(
        xlabel="activation time at C [ms]",
        ylabel="against the reference [ms]",
        title="(a) activations of C",
    )
    axes.legend(fontsize="x-small")


def _draw_turns(table: StudyTable, axes: Axes) -> None:
    turns = periods(table)
    numbers = range(1, turns.shape[1] + 1)
    for i, label in enumerate(_labels(table)):
        if i:
            axes.plot(
                numbers, turns[i] - turns[0], "o-", ms=3.5, lw=1.0, label=label, color=f"C{i - 1}"
            )
    axes.axhline(0.0, color="#9a9a9a", lw=0.8)
    axes.set_xticks(
        numbers, [f"{n}\n({turn:.1f} ms)" for n, turn in zip(numbers, turns[0], strict=True)]
    )
    axes.set(
        xlabel="turn (its time in the reference)",
        ylabel="against the reference [ms]",
        title="(b) times of turns, seen at C",
    )


STUDY = Study(
    name="spiral-refinement",
    title="Spiral wave of section 4.3: activation times and rotation under refinement of mesh and step, "
    "as published and economical",
    stage=spiral_refinement,
    draw=draw,
    quantities=quantities,
    size=(10.0, 4.6),
)
