"""Activation, repolarisation and peak of two waves: read off samples against every time step.

A strip of the paper's tissue is run in short steps, and its beats are watched at each of them, and at
every few of them alone. So only the parabolas between samples make a difference.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from pipeline.nodes import StageRun, stage
from stages.artefacts import StudyTable
from stages.configuration import Section, quantity, setting
from stages.electrophysiology.config import ElectrophysiologyConfig
from workflows.verification.study import Study
from workflows.workflow import Quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stages.numerics.bsplines import Array

TIMES = {
    "activation_times": "activation",
    "repolarisation_times": "90 % repolarisation",
    "apd50": "APD50",
    "apd90": "APD90",
}
ALLOWED = 0.01
"""ms, for samples of 1 ms or less."""


class EventsConfig(Section):
    """The strip, and how often it is looked at."""

    length: float = quantity("mm", "length of the strip", "sec. 4.1", gt=0)
    width: float = quantity("mm", "width of the strip", "this project", gt=0)
    clearance: float = quantity(
        "mm",
        "points nearer than this to the stimulated edge X = 0 are told apart: there the potential has "
        "kinks where the stimulus begins and ends",
        "this project",
        gt=0,
    )
    samples: tuple[int, ...] = setting("time steps from sample to sample", "this project")
    electrophysiology: ElectrophysiologyConfig = setting("mesh, steps, cells, stimuli", "sec. 4.3")


@stage
def events(config: EventsConfig, *, run: StageRun) -> StudyTable:
    """Largest differences over all beats: away from the stimulated edge, and of activation beside it."""
    import numpy as np

    from stages.electrophysiology.events import watch
    from stages.electrophysiology.monodomain import build
    from stages.electrophysiology.recording import BeatRecorder
    from stages.numerics.patches import Patch

    cells = config.electrophysiology
    patch = Patch.rectangle(config.length, config.width).refine(cells.degree, cells.elements)
    stepper, state = build(cells, patch)
    every, *sampled = (
        BeatRecorder(state.potential, cells.activation_threshold, cells.initial_potential)
        for _ in range(1 + len(config.samples))
    )
    for number in range(1, cells.n_steps + 1):
        for _ in every.blocks(1):
            stepper.advance(state, 1, every.watch)
        for steps, beats in zip(config.samples, sampled, strict=True):
            if number % steps == 0:
                for _ in beats.blocks(1):
                    span = steps * cells.step
                    watch(beats.watch, state.potential, number * cells.step - span, span)
        run.progress(number, cells.n_steps)
    x = patch.evaluate(patch.first.greville(), patch.second.greville())[:, 0]
    away, exact = x > config.clearance, every.tables()
    rows = []
    for steps, beats in zip(config.samples, sampled, strict=True):
        found = beats.tables()
        off = {name: _apart(found[name], exact[name]) for name in exact}
        largest = [off[name][away].max() for name in (*TIMES, "peak_potential")]
        rows.append((steps * cells.step, *largest, off["activation_times"][~away].max()))
    return StudyTable(
        columns=("interval", *TIMES, "peak_potential", "beside_the_stimulus"),
        units=("ms", *("ms",) * len(TIMES), "mV", "ms"),
        values=np.array(rows),
    )


def _apart(found: Array, exact: Array) -> Array:
    """Differences of two tables; infinite where one has an event that the other has not."""
    import numpy as np

    if found.shape != exact.shape:
        return np.full(exact.shape, np.inf)
    off = np.abs(found - exact)
    neither = np.isnan(found) & np.isnan(exact)
    return np.where(neither, 0.0, np.where(np.isnan(off), np.inf, off))


def quantities(table: StudyTable) -> dict[str, Quantity]:
    """Largest differences for samples of at most 1 ms."""
    short = table.column("interval") < 1.0 + 1e-9
    found = {
        name: Quantity(
            float(table.column(name)[short].max()),
            "ms",
            f"largest error of {meaning} for samples of 1 ms or less",
            limit=ALLOWED,
        )
        for name, meaning in TIMES.items()
    }
    peak = float(table.column("peak_potential")[short].max())
    return found | {"peak_potential": Quantity(peak, "mV", "the same of the peak", limit=ALLOWED)}


def draw(table: StudyTable, figure: Figure) -> None:
    """Errors over the interval between samples."""
    times, peaks = figure.subplots(1, 2)
    interval = table.column("interval")
    for name, meaning in TIMES.items():
        times.loglog(interval, table.column(name), "o-", ms=4, label=meaning)
    beside = table.column("beside_the_stimulus")
    times.loglog(
        interval, beside, "s:", ms=4, color="#9a9a9a", label="activation beside the stimulus"
    )
    times.axhline(ALLOWED, color="#9a9a9a", lw=0.8, ls="--")
    times.set(xlabel="interval between samples [ms]", ylabel="largest error [ms]", title="(a)")
    times.legend(fontsize=8)
    peaks.loglog(interval, table.column("peak_potential"), "o-", ms=4)
    peaks.set(
        xlabel="interval between samples [ms]", ylabel="largest error of the peak [mV]", title="(b)"
    )


STUDY = Study(
    name="events",
    title="Activation, repolarisation and peaks of two waves: parabolas between samples against every "
    "time step",
    stage=events,
    draw=draw,
    quantities=quantities,
)
