"""Activation times, front speed and peaks, on waves of known speed."""

from __future__ import annotations

import numpy as np
import pytest

from stages.numerics.patches import Patch
from stages.postprocessing.beats import (
    arrival_times,
    beat_peaks,
    beats_at,
    conduction_velocity,
)

SURFACE = Patch.rectangle(3.5, 2.0).refine(2, (14, 8))
PLACES = SURFACE.evaluate(*(space.greville() for space in SURFACE.spaces))
THETA = np.array([[0.31, 0.5], [0.77, 0.21]])
X = 3.5 * THETA[:, 0]


def test_a_plane_wave_arrives_when_its_speed_says() -> None:
    times = np.column_stack((PLACES[:, 0] / 0.0175, 430.0 + PLACES[:, 0] / 0.012))
    found = arrival_times(SURFACE, times, THETA)
    # Linear in X, as the interpolation is: rounding of 700 ms.
    np.testing.assert_allclose(found, np.column_stack((X / 0.0175, 430 + X / 0.012)), rtol=1e-13)


def test_a_curved_front_is_met_to_fourth_order() -> None:
    errors = []
    for spans in ((14, 8), (28, 16), (56, 32)):
        surface = Patch.rectangle(3.5, 2.0).refine(2, spans)
        places = surface.evaluate(*(space.greville() for space in surface.spaces))
        times = np.hypot(places[:, 0] + 1.0, places[:, 1])[:, None] / 0.02
        exact = np.hypot(X + 1.0, 2.0 * THETA[:, 1]) / 0.02
        errors.append(np.abs(arrival_times(surface, times, THETA)[:, 0] - exact).max())
    # straight lines would be late by h^2/8 over radius and speed, 0.4 ms on the coarsest mesh here
    assert errors[0] < 0.05
    assert np.log2(errors[0] / errors[2]) / 2 > 3.0  # four on average over places within a span


def test_a_wave_that_ends_nearby_is_met_as_well_while_it_reaches_the_twelve_points_around() -> None:
    """A corner of the four by four points around the place did not fire; straight lines are 0.3 ms off."""
    theta = np.array([[0.5, 0.5]])
    times = np.hypot(PLACES[:, 0] - 1.0, PLACES[:, 1] - 0.2)[:, None] / 0.02
    exact = np.hypot(0.5 * 3.5 - 1.0, 0.5 * 2.0 - 0.2) / 0.02
    all_fired = arrival_times(SURFACE, times, theta)[0, 0]
    ended = times.copy()
    ended[np.argmin(np.hypot(PLACES[:, 0] - 2.125, PLACES[:, 1] - 1.375))] = np.nan
    assert arrival_times(SURFACE, ended, theta)[0, 0] == all_fired
    # a span of 0.25 mm at 1.1 mm from the centre of the wave
    assert abs(all_fired - exact) < 0.02


def test_where_two_fronts_meet_times_stay_between_those_of_the_neighbours() -> None:
    times = np.minimum(PLACES[:, 0], 2.17 - PLACES[:, 0])[:, None] / 0.02 + 100.0
    path = np.column_stack((np.linspace(0.2, 0.4, 81), np.full(81, 0.41)))
    found = arrival_times(SURFACE, times, path)[:, 0]
    exact = np.minimum(3.5 * path[:, 0], 2.17 - 3.5 * path[:, 0]) / 0.02 + 100.0
    # half a span of 0.25 mm at 0.02 mm/ms where the ridge lies between two points
    assert np.abs(found - exact).max() < 0.5 * 0.25 / 0.02 * 1.25


def test_beside_a_line_where_a_wave_waits_times_are_those_of_their_own_side() -> None:
    """It waits 200 ms at 1.75 mm; cubics across that line would be off by 200/16 ms in the next span."""
    times = PLACES[:, [0]] / 0.02 + 200.0 * (PLACES[:, [0]] > 1.75)
    path = np.column_stack((np.linspace(0.25, 0.4, 61), np.full(61, 0.41)))
    found = arrival_times(SURFACE, times, path)[:, 0]
    # a quarter of the 12.5 ms for a span is what a cubic may depart by
    np.testing.assert_allclose(found, 3.5 * path[:, 0] / 0.02, rtol=0, atol=3.2)


def test_a_wave_that_a_neighbour_missed_is_not_mixed_with_the_next_one() -> None:
    """Left of 1.2 mm three waves pass, right of it the second is blocked: columns no longer agree."""
    first, third = PLACES[:, 0] / 0.02, 900.0 + PLACES[:, 0] / 0.02
    second = np.where(PLACES[:, 0] < 1.2, 430.0 + PLACES[:, 0] / 0.02, np.nan)
    times = np.column_stack((first, second, third))
    times = np.sort(times, axis=1)  # NaN last: events of a point are numbered as they come
    theta = np.array([[0.2, 0.5], [0.35, 0.5], [0.8, 0.5]])
    found = arrival_times(SURFACE, times, theta)
    at = 3.5 * theta[:, 0] / 0.02
    np.testing.assert_allclose(found[0], [at[0], 430 + at[0], 900 + at[0]], rtol=1e-13)
    np.testing.assert_allclose(found[2, :2], [at[2], 900 + at[2]], rtol=1e-13)
    near = found[1][np.isfinite(found[1])]  # beside the block: no wave that never was
    assert all(min(abs(t - at[1]), abs(t - 900 - at[1])) < 1e-9 for t in near)
    path = np.column_stack((np.linspace(0.2, 0.8, 12), np.full(12, 0.5)))
    speeds = conduction_velocity(arrival_times(SURFACE, times, path), 2.1)
    np.testing.assert_allclose(speeds[[0, 2]], 0.02, rtol=1e-12)
    assert np.isnan(speeds[1])


def test_maps_of_beats_are_interpolated_within_one_wave() -> None:
    """The second of three waves is blocked at 1.2 mm: there, the third is the points' second beat."""
    x, ends = PLACES[:, 0], np.array([300.0, 250.0, 280.0])
    waves = np.array([0.0, 430.0, 900.0]) + x[:, None] / 0.02
    lasting = ends + 10.0 * x[:, None]
    waves[x > 1.2, 1] = np.nan
    order = np.argsort(waves, axis=1)  # NaN last
    times, apd = (np.take_along_axis(field, order, axis=1) for field in (waves, lasting))
    apd[np.isnan(times)] = np.nan
    found = beats_at(SURFACE, times, THETA, {"apd90": apd})["apd90"]
    # linear in X, as the interpolation is
    np.testing.assert_allclose(found[0], ends + 10.0 * X[0], rtol=1e-13)
    np.testing.assert_allclose(found[1], [*(ends[[0, 2]] + 10.0 * X[1]), np.nan], rtol=1e-13)


def test_points_that_did_not_fire_spoil_only_their_neighbourhood() -> None:
    times = (PLACES[:, 0] / 0.0175)[:, None].copy()
    times[PLACES[:, 0] > 2.0] = np.nan  # the wave dies at 2 mm
    found = arrival_times(SURFACE, times, THETA)[:, 0]
    assert found[0] == pytest.approx(X[0] / 0.0175, rel=1e-13)  # linear between neighbours
    assert np.isnan(found[1])


def test_a_probe_on_a_collocation_point_does_not_need_its_neighbours() -> None:
    times = np.full((SURFACE.size, 1), np.nan)
    times[0] = 3.25
    assert arrival_times(SURFACE, times, np.array([[0.0, 0.0]]))[0, 0] == 3.25


def test_a_probe_that_rounding_has_moved_off_its_collocation_point_does_not_either() -> None:
    first, second = SURFACE.first.greville(), SURFACE.second.greville()
    times = np.full((first.size, second.size), np.nan)
    times[5, 3] = 3.25
    for off in (-1e-15, 1e-15):
        theta = np.array([[first[5] + off, second[3] - off]])
        found = arrival_times(SURFACE, times.reshape(-1, 1), theta)[0, 0]
        assert found == pytest.approx(3.25, rel=1e-12)


def test_no_beats_give_empty_tables() -> None:
    nothing = np.empty((SURFACE.size, 0))
    assert arrival_times(SURFACE, nothing, THETA).shape == (2, 0)
    assert conduction_velocity(np.empty((2, 0)), 1.5).shape == (0,)
    assert beat_peaks(np.ones((3, 2)), np.arange(3.0), np.empty((2, 0))).shape == (2, 0)


def test_the_speed_of_a_front_is_the_way_over_the_time() -> None:
    way = np.linspace(0.0, 1.5, 31)
    fronts = np.column_stack((57.0 + way / 0.0175, 980.0 - way / 0.03))
    found = conduction_velocity(fronts, 1.5)
    # the second came the other way; sums of 30 differences of numbers below 1000
    np.testing.assert_allclose(found, [0.0175, -0.03], rtol=1e-12)


def test_waves_from_both_ends_that_meet_make_no_speed() -> None:
    way = np.linspace(0.0, 1.5, 31)
    meeting = np.minimum(way, 1.5 - way)[:, None] / 0.02
    assert np.isnan(conduction_velocity(100.0 + meeting, 1.5)).all()


def test_a_front_that_stops_and_one_that_everything_feels_at_once_make_no_speed() -> None:
    way = np.linspace(0.0, 1.5, 31)[:, None]
    assert np.isnan(conduction_velocity(np.where(way < 1.0, way / 0.02, np.nan), 1.5)).all()
    assert np.isnan(conduction_velocity(np.full((31, 1), 5.0), 1.5)).all()


def test_each_beat_has_its_own_peak() -> None:
    time = np.arange(0.0, 101.0)
    pulses = 12.0 * np.exp(-(((time - 20) / 5) ** 2)) + 10.0 * np.exp(-(((time - 70) / 5) ** 2))
    stress = np.column_stack((pulses, pulses))
    arrivals = np.array([[10.0, 60.0], [60.0, np.nan]])
    peaks = beat_peaks(stress, time, arrivals)
    # The pulses lie 10 widths apart: the other one's tail is exp(-100).
    np.testing.assert_allclose(peaks[0], [12.0, 10.0], rtol=1e-15)
    assert peaks[1, 0] == pytest.approx(10.0, rel=1e-15)
    assert np.isnan(peaks[1, 1])


def test_a_skipped_beat_does_not_shorten_the_one_before() -> None:
    time = np.arange(0.0, 31.0)
    stress = time[:, None]
    peaks = beat_peaks(stress, time, np.array([[5.0, np.nan, 20.0]]))
    assert peaks[0, 0] == 19.0
    assert np.isnan(peaks[0, 1])
    assert peaks[0, 2] == 30.0


def test_a_beat_after_the_last_frame_has_no_peak() -> None:
    assert np.isnan(beat_peaks(np.ones((3, 1)), np.arange(3.0), np.array([[2.5]]))[0, 0])
