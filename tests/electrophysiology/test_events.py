"""Beats on functions whose events are known, and on rough ones against a plain search."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from stages.electrophysiology.events import restart, watch
from stages.electrophysiology.monodomain import build
from stages.electrophysiology.recording import BeatRecorder
from stages.electrophysiology.stimuli.edge_flux import EdgeFlux
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from tests.paper import electrophysiology_config

THRESHOLD, REST = -30.0, -80.0
NAMES = ("activation_times", "repolarisation_times", "apd50", "apd90", "peak_potential")


def watched(
    levels: Array, step: float, log_rows: int = 10_000, threshold: float = THRESHOLD
) -> dict[str, Array]:
    """Tables from potentials at successive levels, shape ``(level, point)``, block by block."""
    beats = BeatRecorder(levels[0], threshold, REST, log_rows)
    k = 0
    for steps in beats.blocks(len(levels) - 1):
        for _ in range(steps):
            k += 1
            watch(beats.watch, levels[k], (k - 1) * step, step)
    return beats.tables()


def action_potential(t: Array, start: Array | float = 0.0) -> Array:
    """A steep rise with the time scale of the front (4.6 ms) and a slow, rounded fall."""
    rise = 1.0 / (1.0 + np.exp(-(t - start - 60.0) / 4.6))
    return REST + 100.0 * rise / (1.0 + np.exp((t - start - 340.0) / 25.0))


def on_grid(function: Callable[[Array], Array], step: float, end: float) -> dict[str, Array]:
    t = np.arange(round(end / step) + 1)[:, None] * step
    return watched(function(t), step)


def test_events_hardly_depend_on_the_step() -> None:
    """Steps of 0.01 and of 1 ms; 0.01 ms is the aim."""
    shift = np.linspace(0.0, 1.0, 21)  # every place of the events between two levels
    fine, coarse = (on_grid(lambda t: action_potential(t, shift), s, 700.0) for s in (0.01, 1.0))
    # v'''/6 * 0.385 over a slope of 100/(4 * 4.6) mV/ms: 0.0016 ms on the rise
    for name, allowed in zip(NAMES, (0.002, 0.002, 0.002, 0.002, 1e-3), strict=True):
        np.testing.assert_allclose(coarse[name], fine[name], rtol=0, atol=allowed)
        assert fine[name].shape == (21, 1)


def test_parabolas_are_worth_it_where_the_rise_bends() -> None:
    """At -60 mV, where v'' is largest: v''/8 over the slope is 0.016 ms for straight lines."""
    shift = np.linspace(0.0, 1.0, 21)
    levels = action_potential(np.arange(701.0)[:, None], shift)
    exact = shift + 60.0 + 4.6 * np.log(0.2 / 0.8)
    found = watched(levels, 1.0, threshold=-60.0)["activation_times"][:, 0]
    np.testing.assert_allclose(found, exact, rtol=0, atol=0.002)
    k = np.argmax(levels >= -60.0, axis=0)
    low, high = levels[k - 1, range(21)], levels[k, range(21)]
    assert np.abs(k - 1 + (-60.0 - low) / (high - low) - exact).max() > 0.01


def test_events_of_an_action_potential_are_the_exact_ones() -> None:
    """rise alone: 50 % at t = 60; 1/(1 + exp) alone: levels x of the peak at 340 + 25 ln(1/(1-x) - 1)."""
    found = on_grid(action_potential, 0.1, 700.0)
    # the other factor is off 1 by exp(-11) on the rise, and by exp(-60) on the fall
    start = 60.0 - 4.6 * np.log(1.0)
    np.testing.assert_allclose(found["activation_times"], start, atol=2e-3)
    peak = action_potential(np.linspace(100.0, 200.0, 100_001)).max()
    np.testing.assert_allclose(found["peak_potential"], peak, atol=1e-9)
    for x, name in ((0.5, "apd50"), (0.9, "apd90")):
        share = (1.0 - x) * (peak - REST) / 100.0
        exact = 340.0 + 25.0 * np.log(1.0 / share - 1.0)
        np.testing.assert_allclose(found[name] + found["activation_times"], exact, atol=1e-4)


def test_a_parabola_is_read_exactly() -> None:
    t = np.arange(0.0, 21.0)[:, None]
    found = watched(20.0 - (t - 9.7) ** 2, 1.0)
    # sqrt(50) before the vertex, and levels -30 and -70 behind it; a few roundings of 100
    exact = [9.7 - 50**0.5, 9.7 + 90**0.5, 2 * 50**0.5, 50**0.5 + 90**0.5, 20.0]
    np.testing.assert_allclose([found[name][0, 0] for name in NAMES], exact, rtol=1e-13)


def test_a_beat_cut_short_by_the_next_one_has_no_duration() -> None:
    t = np.arange(0.0, 1200.0)[:, None]
    early = np.maximum(action_potential(t), action_potential(t, 290.0))  # meets at about -37 mV
    found = watched(early, 1.0)
    assert found["activation_times"].shape == (1, 2)
    assert np.isnan(found["apd90"][0, 0])
    assert np.isnan(found["repolarisation_times"][0, 0])
    assert np.isfinite([found[name][0, 1] for name in NAMES]).all()
    alone = watched(action_potential(t, 290.0), 1.0)
    np.testing.assert_allclose(found["apd90"][0, 1], alone["apd90"][0, 0], atol=1e-9)


def test_a_beat_under_way_at_the_end_has_no_duration_yet() -> None:
    found = watched(action_potential(np.arange(0.0, 300.0)[:, None]), 1.0)
    assert np.isfinite(found["activation_times"][0, 0])
    assert np.isfinite(found["peak_potential"][0, 0])
    assert np.isnan(found["apd50"][0, 0])


def test_a_notch_before_the_highest_point_is_no_repolarisation() -> None:
    """A spike falls by more than half, and a dome follows that is higher."""
    t = np.arange(0.0, 600.0)[:, None]
    spike, dome = 70.0 * np.exp(-(((t - 20) / 5) ** 2)), 100.0 * np.exp(-(((t - 200) / 90) ** 2))
    plateau = 55.0 / (1.0 + np.exp(-(t - 15.0))) / (1.0 + np.exp(t - 150.0))
    found = watched(REST + np.maximum(np.maximum(spike, dome), plateau), 1.0)
    assert found["activation_times"].shape == (1, 1)
    np.testing.assert_allclose(found["peak_potential"], 20.0, atol=1e-9)
    ends = [200 + 90 * np.log(2) ** 0.5, 200 + 90 * np.log(10) ** 0.5]
    durations = [found[name][0, 0] for name in ("apd50", "apd90")]
    np.testing.assert_allclose(durations, ends - found["activation_times"][0], atol=1e-4)


def plain_beats(v: Array) -> Array:
    """Rows (activation, 90 %, 50 % duration, 90 % duration, peak) of one point, step 1."""

    def crossing(k: int, level: float) -> float:
        """In the step after ``k``, by bisection of the parabola through levels k - 1, k, k + 1."""
        levels = v[k - 1 : k + 2] if k else np.array([2 * v[0] - v[1], v[0], v[1]])
        curve = np.polynomial.Polynomial.fit([-1, 0, 1], levels - level, 2)
        low, high = 0.0, 1.0
        for _ in range(60):
            middle = 0.5 * (low + high)
            same = (curve(middle) > 0) == (v[k] > level)
            low, high = (middle, high) if same else (low, middle)
        return k + low

    rises = np.flatnonzero((v[:-1] < THRESHOLD) & (v[1:] >= THRESHOLD))
    rows = []
    for start, stop in zip(rises, [*rises[1:], v.size - 1], strict=True):
        top = start + 1 + int(np.argmax(v[start + 1 : stop + 1]))
        peak = v[top]
        if top + 1 < v.size and top < stop:
            curve = np.polynomial.Polynomial.fit([-1, 0, 1], v[top - 1 : top + 2], 2)
            peak = max(peak, curve(curve.deriv().roots()[0].real))
        half, full = (
            next(
                (crossing(k, level) for k in range(top, stop) if v[k + 1] <= level < v[k]),
                np.nan,
            )
            for level in (REST + 0.5 * (peak - REST), REST + 0.1 * (peak - REST))
        )
        at = crossing(start, THRESHOLD)
        rows.append((at, full, half - at, full - at, peak))
    return np.array(rows).reshape(-1, 5)


@pytest.mark.parametrize("log_rows", [10_000, 1], ids=["one block", "blocks of two steps"])
def test_rough_potentials_have_the_beats_that_a_plain_search_finds(log_rows: int) -> None:
    """Far more beats than cells have, at 130 points (more than one pack of 128)."""
    random = np.random.default_rng(5)
    levels = REST + 60.0 * np.abs(np.cumsum(random.normal(0.0, 0.6, (200, 130)), axis=0) % 4 - 2)
    found = watched(levels, 1.0, log_rows)
    assert found["activation_times"].shape[1] > 20
    for point in (*range(0, 127, 9), 127, 128, 129):
        exact = plain_beats(levels[:, point])
        table = np.column_stack([found[name][point] for name in NAMES])
        # 60 bisections; the parabola of a random walk may be nearly flat where it crosses
        np.testing.assert_allclose(table[: len(exact)], exact, rtol=0, atol=1e-7)
        assert np.isnan(table[len(exact) :]).all()


def test_a_potential_that_jumps_at_every_step_fills_no_log() -> None:
    """The most beats that there can be: up and down in turn."""
    levels = np.where(np.arange(101)[:, None] % 2, 20.0, -80.0) * np.ones((1, 3))
    recorder = BeatRecorder(levels[0], THRESHOLD, REST, log_rows=9)
    assert list(recorder.blocks(20)) == [6, 6, 6, 2]
    found = watched(levels, 1.0, log_rows=9)
    np.testing.assert_allclose(
        found["activation_times"][0], np.arange(50) * 2 + 0.5, atol=0.25 + 1e-12
    )
    np.testing.assert_array_equal(found["activation_times"][0], found["activation_times"][2])
    assert np.isfinite(found["apd90"]).all()  # each falls to rest before the next


def test_a_log_that_is_too_small_is_an_error() -> None:
    levels = np.where(np.arange(9)[:, None] % 2, 20.0, -80.0) * np.ones((1, 3))
    recorder = BeatRecorder(levels[0], THRESHOLD, REST, log_rows=3)
    steps = recorder.blocks(2)
    assert next(steps) == 2
    for k in range(8):  # more than that
        watch(recorder.watch, levels[k + 1], float(k), 1.0)
    with pytest.raises(RuntimeError, match="9 beats ended in a block of steps with room for fewer"):
        next(steps)


def test_points_that_never_fire_have_no_beats() -> None:
    found = watched(np.full((5, 4), -80.0), 1.0)
    assert {table.shape for table in found.values()} == {(4, 0)}


def test_a_wave_sampled_every_millisecond_has_the_events_of_the_wave_itself() -> None:
    """The paper's tissue on a strip: steps of 0.05 ms, watched at each and at every twentieth."""
    patch, ratio, step = Patch.rectangle(3.5, 0.1).refine(2, (102, 1)), 20, 0.05
    config = electrophysiology_config(n_steps=12_000, duration=600.0)
    stepper, state = build(config, patch)
    fine, coarse = (BeatRecorder(state.potential, THRESHOLD, REST) for _ in range(2))
    for k in range(12_000 // ratio):
        for steps in fine.blocks(ratio):
            stepper.advance(state, steps, fine.watch)
        watch(coarse.watch, state.potential, k * ratio * step, ratio * step)
    # at the stimulated edge and next to it the potential has kinks where the stimulus begins and ends
    away = patch.evaluate(patch.first.greville(), patch.second.greville())[:, 0] > 0.2
    for name in NAMES:
        exact, found = (beats.tables()[name][away] for beats in (fine, coarse))
        assert np.isfinite(exact).all()
        np.testing.assert_allclose(found, exact, rtol=0, atol=0.004)  # 0.01 ms is the aim


def test_after_a_restart_earlier_levels_count_no_more() -> None:
    """At rest, then a stimulus that lifts the first point to -60 mV at once and further by 50 mV a step."""
    beats = BeatRecorder(np.full(3, REST), THRESHOLD, REST)
    watch(beats.watch, np.full(3, REST), 0.0, 1.0)
    restart(beats.watch, np.array([0, 1]), np.array([-60.0, REST, REST]))
    watch(beats.watch, np.full(3, -10.0), 1.0, 1.0)
    # of the others one is known to be driven, but does not jump; the third is not known to be
    parabola = 1.0 + (-35.0 + (35.0**2 + 4 * 35.0 * 50.0) ** 0.5) / 70.0  # 35 s^2 + 35 s = 50
    np.testing.assert_allclose(
        beats.tables()["activation_times"][:, 0],
        [1.0 + 30.0 / 50.0, 1.0 + 50.0 / 70.0, parabola],
        rtol=1e-13,
    )


def test_a_restart_keeps_the_peak_that_was_reached() -> None:
    """A flux that ends: the edges fall at once, after they had risen until then."""
    top = np.linspace(30.0, 31.0, 101)  # round-off bends straight lines either way
    beats = BeatRecorder(np.full(101, REST), THRESHOLD, REST)
    watch(beats.watch, 0.0 * top, 0.0, 1.0)
    watch(beats.watch, top, 1.0, 1.0)
    restart(beats.watch, np.arange(101), 0.5 * top)
    watch(beats.watch, 0.47 * top, 2.0, 1.0)
    np.testing.assert_array_equal(beats.tables()["peak_potential"][:, 0], top)


@pytest.mark.parametrize("general", [False, True])
def test_a_flux_activates_its_edge_as_fast_whenever_it_sets_in(general: bool) -> None:
    """The first level is as good as any other one, though nothing is known of what came before."""
    patch = Patch.rectangle(1.0, 0.1).refine(4, (29, 2))

    def activation(start: float, step: float) -> float:
        pulse = EdgeFlux(edge="X=0", start=start, duration=5.0, flux=5.0)
        steps = round(8.0 / step)
        config = electrophysiology_config(
            n_steps=steps, duration=8.0, stimuli=(pulse,), scheme="strang", degree=4
        )
        stepper, state = build(config, patch, general)
        beats = BeatRecorder(state.potential, THRESHOLD, REST)
        for block in beats.blocks(steps):
            stepper.advance(state, block, beats.watch)
        return float(beats.tables()["activation_times"][0, 0] - start)

    late, exact = activation(2.0, 0.5), activation(0.0, 0.01)
    assert late == pytest.approx(activation(0.0, 0.5), abs=1e-9)
    # a straight line from the potential just after the jump; 0.16 ms by the parabola through the level before
    assert late == pytest.approx(exact, abs=0.08)


@pytest.mark.parametrize("scheme", ["cn-ab2", "strang"])
def test_every_stepper_lets_the_same_beats_be_watched(scheme: str) -> None:
    """Beats of the fast solver, of the general one, and those of a plain search in every step."""
    patch = Patch.rectangle(1.5, 0.5).refine(2, (16, 2))
    config = electrophysiology_config(n_steps=1000, duration=420.0, scheme=scheme)
    tables = []
    for general in (False, True):
        stepper, state = build(config, patch, general)
        beats = BeatRecorder(state.potential, THRESHOLD, REST)
        levels = [state.potential.copy()]
        for _ in range(1000):
            for steps in beats.blocks(1):
                stepper.advance(state, steps, beats.watch)
            levels.append(state.potential.copy())
        tables.append(np.stack([beats.tables()[name][:, 0] for name in NAMES]))
    # round-off of the potential over slopes above 0.1 mV/ms
    np.testing.assert_allclose(tables[0], tables[1], rtol=0, atol=1e-7)
    # a plain search does not know where a flux drives the edge X = 0
    for point in (0, 40, patch.size - 1) if scheme == "cn-ab2" else (40, patch.size - 1):
        at, full, half, whole, peak = plain_beats(np.array(levels)[:, point])[0]
        exact = 0.42 * np.array([at, full, half, whole])
        np.testing.assert_allclose(tables[1][:4, point], exact, rtol=0, atol=1e-7)
        assert tables[1][4, point] == pytest.approx(peak, abs=1e-9)
