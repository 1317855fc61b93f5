"""Paced tissue: branches of a run, restitution against an independent integrator, vulnerable window."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from pipeline.testing import MemoryRun, Stopped
from stages.artefacts import ExcitableSurface
from stages.electrophysiology.monodomain import build
from stages.electrophysiology.protocols.branches import Stimuli, TissueRun, Trunk
from stages.electrophysiology.protocols.cases import Cases, refine_borders
from stages.electrophysiology.protocols.config import (
    RestitutionConfig,
    RestitutionProtocol,
    WindowConfig,
    WindowProtocol,
)
from stages.electrophysiology.protocols.restitution import peak_after
from stages.electrophysiology.protocols.stage import restitution, vulnerable_window
from stages.electrophysiology.stimuli.uniform_current import UniformCurrent
from stages.electrophysiology.tissue import Stepper, TissueState
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.paced_artefacts import Restitution
from tests.paper import S1, electrophysiology_config
from tests.problems import parabolic_sheet

PULSE = UniformCurrent(start=0.0, duration=2.0, current=20.0)
S3 = S1.model_copy(update={"edge": "Y=0"})


def pacing(preparation: str = "cell", **changes: Any) -> RestitutionConfig:
    """Two S1 600 ms apart, then S2; 400 ms in steps of 0.05 ms."""
    protocol: dict[str, Any] = {
        "preparation": preparation,
        "pulses": {"cell": PULSE, "cable": S1},
        "count": 2,
        "period": 600.0,
        "intervals": (150.0, 320.0, 450.0),
        "periods": (400.0,),
        "tolerance": 20.0,
        "window": (1.0, 2.0),
    }
    tissue = electrophysiology_config(
        elements=(40, 1), degree=4, n_steps=8000, duration=400.0, stimuli=()
    )
    return RestitutionConfig(tissue=tissue, protocol=RestitutionProtocol(**protocol | changes))


def rates(t: float, y: Array, applied: float) -> list[float]:
    """Aliev-Panfilov cell and Göktepe-Kuhl tension, written apart from the code (Table 3)."""
    v, w, sigma = y
    x = (v + 80.0) / 100.0
    current = 100.0 / 12.9 * (8.0 * x * (x - 0.15) * (x - 1.0) + x * w)
    recovery = (0.002 + 0.2 * w / (0.3 + x)) * (-w - 8.0 * x * (x - 1.15)) / 12.9
    switch = 0.1 + 0.9 * np.exp(-np.exp(-v))
    return [applied - current, recovery, switch * (0.122 * (v + 80.0) - sigma)]


def reference_beat(starts: list[float], end: float) -> dict[str, float]:
    """What the last of some pulses makes of a cell, by an adaptive integrator and root finding."""
    y, at, pieces = np.array([-80.0, 0.0, 0.0]), 0.0, []
    knots = [(t, 20.0) for t in starts] + [(t + 2.0, 0.0) for t in starts]
    for (begin, applied), (stop, _) in zip(
        sorted(knots), [*sorted(knots)[1:], (end, 0.0)], strict=True
    ):
        piece = solve_ivp(
            rates,
            (begin, stop),
            y,
            "DOP853",
            rtol=1e-11,
            atol=1e-11,
            args=(applied,),
            dense_output=True,
        )
        pieces.append(piece)
        y, at = piece.y[:, -1], stop
    assert at == end

    def state(t: float) -> Array:
        piece = next(p for p in pieces if t <= p.t[-1])
        return np.asarray(piece.sol(t))

    def fall(peak: float, after: float, part: float) -> float:
        level = -80.0 + (1.0 - part) * (peak + 80.0)
        grid = np.arange(after, end, 1.0)
        high = np.array([state(t)[0] for t in grid]) > level
        k = int(np.flatnonzero(high[:-1] & ~high[1:])[0])
        return float(brentq(lambda t: state(t)[0] - level, grid[k], grid[k + 1], xtol=1e-9))

    beats = []
    for start, until in zip(starts, [*starts[1:], end], strict=True):
        rise = brentq(lambda t: state(t)[0] + 30.0, start, start + 30.0, xtol=1e-9)
        grid = np.arange(rise, min(until, rise + 60.0), 0.01)
        values = np.array([state(t) for t in grid])
        beats.append((rise, values[:, 0].max(), values[:, 2].max()))
    (_, peak, _), (rise, last_peak, stress) = beats[-2:]
    before = fall(peak, starts[-2] + 60.0, 0.9)
    return {
        "activation_time": rise - starts[-1],
        "diastolic_interval": rise - before,
        "apd50": fall(last_peak, rise + 30.0, 0.5) - rise,
        "apd90": fall(last_peak, rise + 30.0, 0.9) - rise,
        "peak_active_stress": stress,
    }


@pytest.fixture(scope="module")
def cell() -> Restitution:
    return restitution.compute(pacing())


def test_a_paced_cell_agrees_with_an_independent_integrator(cell: Restitution) -> None:
    for beats, at, starts in (
        (cell.s2, 320.0, [0.0, 600.0, 920.0]),
        (cell.s2, 450.0, [0.0, 600.0, 1050.0]),
        (cell.steady, 400.0, [0.0, 400.0]),
    ):
        case = int(np.flatnonzero(beats.interval == at)[0])
        expected = reference_beat(starts, starts[-1] + 400.0)
        for name, value in expected.items():
            # events are parabolas through steps of 0.05 ms, good to 1e-3 ms; the peak of the stress is that
            # of a parabola through samples 1 ms apart
            assert getattr(beats, name)[case] == pytest.approx(value, abs=2e-3), name


def test_an_s2_on_the_plateau_makes_no_beat_and_the_border_is_found(cell: Restitution) -> None:
    made = np.isfinite(cell.s2.activation_time)
    assert not made[0]
    assert made[-2:].all()
    last, first = cell.s2.interval[~made][-1], cell.s2.interval[made][0]
    assert 0 < first - last <= 20.0
    for name in ("diastolic_interval", "apd50", "apd90", "peak_active_stress"):
        np.testing.assert_array_equal(np.isfinite(getattr(cell.s2, name)), made)


def test_a_stimulus_on_a_falling_potential_makes_no_beat() -> None:
    """At 195 ms the potential is below the threshold again, and 40 mV lift it through, but no cell fires."""
    found = restitution.compute(pacing(intervals=(195.0, 450.0), periods=(), tolerance=300.0))
    lifted = found.s2.potential[0]
    assert lifted[0] < -30.0 < lifted.max()
    assert np.isnan(found.s2.apd90[0])
    assert np.isfinite(found.s2.apd90[1])


def test_a_beat_that_is_not_over_is_told() -> None:
    run = MemoryRun()
    config = pacing(intervals=(20.0,), periods=())
    tissue = config.tissue.model_copy(update={"duration": 100.0, "n_steps": 2000})
    short = config.model_copy(update={"tissue": tissue})
    found = restitution.compute(short, run=run)
    assert np.isnan(found.s2.activation_time).all()
    assert len(run.warnings) == 1
    assert "has not repolarised 120 ms after" in run.warnings[0]


def test_a_longer_rest_makes_longer_and_stronger_beats(cell: Restitution) -> None:
    whole = cell.s2.interval >= 320.0
    for name in ("diastolic_interval", "apd50", "apd90", "peak_active_stress"):
        assert (np.diff(getattr(cell.s2, name)[whole]) > 0).all()
    assert cell.s1_apd90.shape == (2,)
    assert cell.s2.potential.shape == (cell.s2.interval.size, cell.sample_times.size)


def test_a_wave_on_a_strip_is_slower_after_a_shorter_rest() -> None:
    config = pacing("cable", intervals=(200.0, 360.0, 600.0), periods=(), tolerance=200.0)
    strip = ExcitableSurface(Patch.rectangle(3.0, 0.2).refine(4, (40, 1)))
    speed = restitution.compute(config, strip).s2.conduction_velocity
    assert np.isnan(speed[0])
    # the front with recovery at rest runs at 0.0174 mm/ms; recovery left over slows it down
    assert 0.012 < speed[1] < speed[2] < 0.01743


class StopsAfterCase(MemoryRun):
    """A run that is stopped at the checkpoint after a number of cases."""

    def __init__(self, cases: int) -> None:
        super().__init__()
        self._cases = cases

    def checkpoint(self, state: Callable[[], Mapping[str, Any]]) -> None:
        self._cases -= 1
        if not self._cases:
            self._stop_after = 0
        super().checkpoint(state)


@pytest.mark.parametrize("case", [1, 3, 6], ids=["first", "last given", "bisected"])
def test_a_stopped_restitution_goes_on_as_if_nothing_had_happened(
    cell: Restitution, case: int
) -> None:
    run = StopsAfterCase(case)
    with pytest.raises(Stopped):
        restitution.compute(pacing(), run=run)
    resumed = restitution.compute(pacing(), run=run)
    for name in vars(cell.s2):
        np.testing.assert_array_equal(getattr(resumed.s2, name), getattr(cell.s2, name))
        np.testing.assert_array_equal(getattr(resumed.steady, name), getattr(cell.steady, name))


@pytest.mark.parametrize("start", [8.0, 8.03])
@pytest.mark.parametrize("scheme", ["cn-ab2", "strang"])
@pytest.mark.parametrize(
    "film", [Patch.rectangle(1.0, 0.6), parabolic_sheet(0.5, 1.0, 0.6)], ids=["flat", "bent"]
)
def test_a_branch_equals_the_unbroken_run_bit_for_bit(
    start: float, scheme: str, film: Patch
) -> None:
    config, patch = electrophysiology_config(scheme=scheme), film.refine(3, (8, 6))
    moved = S3.model_copy(update={"start": start})

    def make(stimuli: Stimuli) -> tuple[Stepper, TissueState]:
        return build(config.model_copy(update={"stimuli": stimuli}), patch)

    trunk = Trunk(config, make, (S1,))
    trunk.branch(20.0)  # a later one first
    branch, unbroken = trunk.branch(start, moved), TissueRun(config, make, (S1, moved))
    for run in (branch, unbroken):
        run.advance_to(400)
    for name, values in unbroken.arrays().items():
        np.testing.assert_array_equal(branch.arrays()[name], values, err_msg=name)
    np.testing.assert_array_equal(
        branch.beats()["activation_times"], unbroken.beats()["activation_times"]
    )
    assert branch.beats()["activation_times"].shape[1] == 1


@pytest.mark.parametrize("film", [Patch.rectangle(1.0, 0.6), parabolic_sheet(0.5, 1.0, 0.6)])
def test_a_stimulus_that_does_not_act_yet_leaves_the_beats_alone(film: Patch) -> None:
    """Points of the edge Y = 0 cross the threshold while S1 sets in and ends; S3 would come later."""
    config = electrophysiology_config(scheme="strang", n_steps=20, duration=10.0)
    patch, strong = film.refine(3, (60, 2)), S1.model_copy(update={"flux": 10.0})
    late = S3.model_copy(update={"start": 9.9})

    def make(stimuli: Stimuli) -> tuple[Stepper, TissueState]:
        return build(config.model_copy(update={"stimuli": stimuli}), patch)

    one, other = (TissueRun(config, make, stimuli) for stimuli in ((strong,), (strong, late)))
    for run in (one, other):
        run.advance_to(19)
    found = one.beats()["activation_times"]
    np.testing.assert_array_equal(found, other.beats()["activation_times"])
    assert ((found > 5.0) & (found < 6.0)).any()


def sweep(**changes: Any) -> WindowConfig:
    """The film of the paper on a mesh for tests, watched for two turns of a spiral."""
    protocol: dict[str, Any] = {
        "times": (380.0, 480.0, 600.0),
        "tolerance": 200.0,
        "least_share": 0.25,
        "probes": {"B": (3.5, 1.0), "C": (3.5, 2.0)},
    }
    tissue = electrophysiology_config(
        elements=(28, 16), degree=4, n_steps=4000, duration=800.0, stimuli=(S1, S3)
    )
    return WindowConfig(tissue=tissue, protocol=WindowProtocol(**protocol | changes))


def test_a_wave_across_a_tail_dies_or_passes_or_comes_round_again() -> None:
    config = sweep()
    film = ExcitableSurface(Patch.rectangle(3.5, 2.0).refine(4, (28, 16)))
    found = vulnerable_window.compute(config, film)
    np.testing.assert_array_equal(found.outcome, [0.0, 2.0, 1.0])
    # into refractory tissue it dies; a spiral is there for as long as one looks; a passing wave takes
    # 2 mm / 0.0174 mm/ms and a little more for the recovery that it meets
    assert found.life_time[0] < 60.0
    assert found.life_time[1] > 780.0
    assert 2.0 / 0.0174 < found.life_time[2] < 2.0 / 0.0174 + 30.0
    np.testing.assert_array_equal(found.activations, [[0, 0], [2, 2], [1, 1]])
    assert found.reactivated_share[1] > 0.5
    assert found.reactivated_share[2] == 0.0
    assert found.activated_share[2] == pytest.approx(1.0, abs=1e-12)


def test_a_stopped_sweep_goes_on_as_if_nothing_had_happened() -> None:
    """With bisection, stopped in the midst of it; in steps of 1 ms."""
    tissue = electrophysiology_config(
        elements=(28, 16), degree=4, n_steps=800, duration=800.0, scheme="strang", stimuli=(S1, S3)
    )
    config = sweep(tolerance=60.0).model_copy(update={"tissue": tissue})
    film = ExcitableSurface(Patch.rectangle(3.5, 2.0).refine(4, (28, 16)))
    whole = vulnerable_window.compute(config, film)
    assert whole.time.size > 4
    run = StopsAfterCase(4)
    with pytest.raises(Stopped):
        vulnerable_window.compute(config, film, run=run)
    resumed = vulnerable_window.compute(config, film, run=run)
    for name in set(vars(whole)) - {"probe_names"}:
        np.testing.assert_array_equal(getattr(resumed, name), getattr(whole, name))


def test_what_s1_would_have_activated_anyway_does_not_count() -> None:
    """At 100 ms half of the film still waits for S1: a wave of S3 there comes first, but adds nothing."""
    film = ExcitableSurface(Patch.rectangle(3.5, 2.0).refine(4, (28, 16)))
    found = vulnerable_window.compute(sweep(times=(100.0,)), film)
    assert (found.outcome, found.activated_share, found.life_time) == (0.0, 0.0, 0.0)
    np.testing.assert_array_equal(found.activations, [[0, 0]])


def test_a_cell_takes_no_current_through_an_edge() -> None:
    with pytest.raises(ValidationError, match="'edge-flux', but a cell has no edges"):
        pacing(pulses={"cell": S1})
    with pytest.raises(ValidationError, match=r"pulses\.cable is missing"):
        pacing("cable", pulses={"cell": PULSE})


def test_a_case_is_computed_once_and_known_after_a_restart() -> None:
    solved: list[float] = []

    def solve(x: float) -> Array:
        solved.append(x)
        return np.array([x, float(0.3 < x < 1.3)])

    cases = Cases(solve)
    borders = list(refine_borders([0.0, 1.0, 2.0], lambda x: bool(cases(x)[1]), 0.25))
    assert borders == [(0.25, 0.5), (1.25, 1.5)]
    assert len(solved) == len(set(solved)) == len(cases)
    again = Cases(lambda x: np.array([np.nan, np.nan]))
    again.restore("any", cases.arrays("any"))
    for one, two in zip(cases.sorted(), again.sorted(), strict=True):
        np.testing.assert_array_equal(one, two)


def test_the_peak_of_a_parabola_is_found_between_samples() -> None:
    times = np.arange(0.0, 10.0)
    assert peak_after(2.0, times, 5.0 - (times - 4.3) ** 2) == pytest.approx(5.0, rel=1e-14)
    assert peak_after(6.0, times, 5.0 - (times - 4.3) ** 2) == pytest.approx(5.0 - 1.7**2)
    assert np.isnan(peak_after(np.nan, times, times))
