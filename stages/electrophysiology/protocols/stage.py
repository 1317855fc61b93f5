"""Stages `restitution` and `vulnerable_window`: paced tissue, case by case."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pipeline.nodes import StageRun, stage
from stages.artefacts import ExcitableSurface
from stages.electrophysiology.protocols.config import RestitutionConfig, WindowConfig
from stages.paced_artefacts import REENTRY, PacedBeats, Restitution, VulnerableWindow

if TYPE_CHECKING:
    from stages.electrophysiology.protocols.cases import Cases


@stage
def restitution(
    config: RestitutionConfig, surface: ExcitableSurface | None = None, *, run: StageRun
) -> Restitution:
    """S2 at each interval after a train S1, and steady trains, on a cell or (with a surface) a strip."""
    import math

    from stages.electrophysiology.protocols.cases import Cases, bisections, refine_borders
    from stages.electrophysiology.protocols.restitution import Pacing

    protocol = config.protocol
    pacing = Pacing(config, surface.patch if surface is not None else None)
    if not pacing.s1_is_over:
        run.warn(
            f"the last beat of the train has not repolarised {pacing.longest:g} ms after its stimulus, "
            "or there is none, so that no rest and no beat after it can be measured: raise "
            "electrophysiology.duration (and n_steps), or pace more strongly or more slowly"
        )
    planned = len(protocol.intervals) + len(protocol.periods)
    planned += bisections(protocol.intervals, protocol.tolerance)

    def told() -> None:
        done = len(s2) + len(steady)
        run.progress(done, max(planned, done))
        run.checkpoint(lambda: {**s2.arrays("s2"), **steady.arrays("steady")})

    s2, steady = Cases(pacing.after, told), Cases(pacing.steady, told)
    saved = run.resume()
    if saved is not None:
        s2.restore("s2", saved)
        steady.restore("steady", saved)
    for interval in protocol.intervals:
        s2(interval)
    for period in protocol.periods:
        steady(period)
    list(
        refine_borders(
            protocol.intervals, lambda one: math.isfinite(s2(one)[0]), protocol.tolerance
        )
    )
    run.progress(1, 1)
    potential, stress = pacing.s1_samples
    return Restitution(
        s2=_beats(s2, potential.size),
        steady=_beats(steady, potential.size),
        sample_times=pacing.sample_times,
        s1_apd90=pacing.s1_apd90,
        s1_potential=potential,
        s1_active_stress=stress,
    )


def _beats(cases: Cases, samples: int) -> PacedBeats:
    """Results of the cases, of which there may be none, as named columns and samples."""
    from stages.electrophysiology.protocols.restitution import COLUMNS

    intervals, rows = cases.sorted()
    rows = rows.reshape(intervals.size, len(COLUMNS) + 2 * samples)
    series = rows[:, len(COLUMNS) :].reshape(-1, 2, samples)
    return PacedBeats(
        interval=intervals,
        **dict(zip(COLUMNS, rows[:, : len(COLUMNS)].T, strict=True)),
        potential=series[:, 0],
        active_stress=series[:, 1],
    )


@stage
def vulnerable_window(
    config: WindowConfig, surface: ExcitableSurface, *, run: StageRun
) -> VulnerableWindow:
    """The last stimulus at each time, and at times between, until the borders of re-entry are known."""
    from stages.electrophysiology.protocols.cases import Cases, bisections, refine_borders
    from stages.electrophysiology.protocols.window import COLUMNS, CrossField

    protocol = config.protocol
    film = CrossField(config, surface.patch)
    planned = len(protocol.times) + 2 * bisections(protocol.times, protocol.tolerance)

    def told() -> None:
        run.progress(len(cases), max(planned, len(cases)))
        run.checkpoint(lambda: cases.arrays("window"))

    cases = Cases(film.at, told)
    saved = run.resume()
    if saved is not None:
        cases.restore("window", saved)
    for time in protocol.times:
        cases(time)
    list(
        refine_borders(
            protocol.times, lambda one: bool(cases(one)[0] == REENTRY), protocol.tolerance
        )
    )
    run.progress(1, 1)
    times, rows = cases.sorted()
    return VulnerableWindow(
        probe_names=tuple(protocol.probes),
        time=times,
        **dict(zip(COLUMNS, rows[:, : len(COLUMNS)].T, strict=True)),
        activations=rows[:, len(COLUMNS) :],
    )
