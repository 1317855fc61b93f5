"""Tips of a spiral whose tip is known: where they are, which way they turn, how their paths are linked."""

from __future__ import annotations

import numpy as np
import pytest

from stages.artefacts import TipPaths
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.postprocessing.tip_paths import linked, no_tips, turn_times
from stages.postprocessing.tips import tips_of_frames
from tests.problems import observed_orders, parabolic_sheet, sheet_arc_length

PERIOD, LEVEL, PITCH, RADIUS = 300.0, -30.0, 2.0, 0.3
CENTRE = np.array([1.8, 1.0])


def spiral(x: Array, y: Array, t: float, turning: float) -> Array:
    """Archimedean spiral that turns rigidly: v - v_iso = 50 mV (cos(psi) - 2/(1 + r^2/R^2)).

    Along psi = const, theta winds up with r; psi falls in time. v = v_iso needs r >= R, and dv/dt = 0 needs
    psi = 0 or pi: the only tip is at r = R and psi = 0, where grad v points outwards.
    """
    dx, dy = x - CENTRE[0], y - CENTRE[1]
    radius = np.hypot(dx, dy)
    psi = turning * np.arctan2(dy, dx) - 2 * np.pi * (t / PERIOD - (radius - RADIUS) / PITCH)
    return LEVEL + 50.0 * (np.cos(psi) - 2.0 / (1.0 + (radius / RADIUS) ** 2))


def exact_tip(t: Array, turning: float) -> Array:
    """Round a circle in one period, shape ``(..., 2)``."""
    angle = turning * 2 * np.pi * np.asarray(t) / PERIOD
    return CENTRE + RADIUS * np.stack((np.cos(angle), np.sin(angle)), axis=-1)


def paths(patch: Patch, x: Array, y: Array, turning: float, end: float = 900.0) -> TipPaths:
    time = np.arange(0.0, end + 1.0, 2.0)
    frames = np.stack([spiral(x, y, t, turning) for t in time])
    return linked(tips_of_frames(patch, frames, time, LEVEL), reach=0.1, speed=0.03)


def flat(elements: tuple[int, int]) -> tuple[Patch, Array, Array]:
    patch = Patch.rectangle(3.5, 2.0).refine(2, elements)
    x, y = patch.evaluate(*(space.greville() for space in patch.spaces))[:, :2].T
    return patch, x, y


@pytest.mark.parametrize("turning", [1.0, -1.0], ids=["counter-clockwise", "clockwise"])
def test_the_tip_of_a_spiral_is_found_in_every_frame_and_turns_its_way(turning: float) -> None:
    tips = paths(*flat((102, 60)), turning)
    assert set(tips.number) == {1.0}
    np.testing.assert_array_equal(tips.time, np.arange(1.0, 900.0, 2.0))
    np.testing.assert_array_equal(tips.chirality, turning)
    exact = exact_tip(tips.time, turning)
    # linear in cells of h = 0.034 mm: h^2/4 times curvatures of 32/mm^2 over a slope of 1/R
    np.testing.assert_allclose(tips.position[:, :2], exact, atol=0.003)
    # grad v turns by 10 rad/mm: 1.7 degrees over the error of the place
    whole_turns = turning * 360.0 * (tips.time - tips.time[0]) / PERIOD
    np.testing.assert_allclose(tips.heading - tips.heading[0], whole_turns, atol=2.0)
    np.testing.assert_allclose(turn_times(tips), PERIOD, atol=1.5)
    assert turn_times(tips).size == 2  # three turns less one interval of two frames


def test_the_tip_and_the_activations_of_a_point_tell_one_period() -> None:
    patch, x, y = flat((102, 60))
    tips = paths(patch, x, y, 1.0, end=1300.0)
    time = np.arange(0.0, 1301.0, 2.0)
    corner = np.array([spiral(x[-1:], y[-1:], t, 1.0)[0] for t in time])
    rises = np.flatnonzero((corner[:-1] < LEVEL) & (corner[1:] >= LEVEL))
    low, high = corner[rises], corner[rises + 1]
    arrivals = time[rises] + 2.0 * (LEVEL - low) / (high - low)
    # equal phases of a period of whole steps are equal to round-off
    np.testing.assert_allclose(np.diff(arrivals), PERIOD, rtol=1e-9)
    assert turn_times(tips).mean() == pytest.approx(PERIOD, abs=0.5)  # heading to 1.7 degrees


def test_the_place_of_the_tip_converges_at_second_order() -> None:
    errors = []
    for elements in ((51, 30), (102, 60), (204, 120)):
        tips = paths(*flat(elements), 1.0, end=120.0)
        errors.append(np.sqrt(((tips.position[:, :2] - exact_tip(tips.time, 1.0)) ** 2).mean()))
    assert observed_orders(np.array(errors))[0] > 1.5


def test_a_bent_film_shows_the_same_tip_at_the_same_length() -> None:
    bend = 0.5
    patch = parabolic_sheet(bend, 2.75, 2.0).refine(2, (102, 60))
    place = patch.evaluate(*(space.greville() for space in patch.spaces))
    along = sheet_arc_length(bend, place[:, 0])
    tips = paths(patch, along, place[:, 1], -1.0, end=300.0)
    assert set(tips.number) == {1.0}
    np.testing.assert_array_equal(tips.chirality, -1.0)
    exact, found = exact_tip(tips.time, -1.0), tips.position
    np.testing.assert_allclose(sheet_arc_length(bend, found[:, 0]), exact[:, 0], atol=0.005)
    np.testing.assert_allclose(found[:, 1], exact[:, 1], atol=0.005)
    np.testing.assert_allclose(found[:, 2], 0.5 * bend * found[:, 0] ** 2, atol=1e-3)


def test_plane_waves_have_no_tip() -> None:
    patch, x, _ = flat((50, 20))
    time = np.arange(0.0, 300.0, 2.0)
    waves = LEVEL + 50.0 * np.sin(2 * np.pi * (x / 1.2 - time[:, None] / PERIOD))
    tips = linked(tips_of_frames(patch, waves, time, LEVEL), reach=0.1, speed=0.03)
    assert tips.time.size == 0
    assert turn_times(tips).size == 0


def test_two_spirals_are_two_paths_and_never_exchanged() -> None:
    """A pair of opposite tips, one in each half: the mirror image makes the other."""
    patch, x, y = flat((102, 60))
    time = np.arange(0.0, 300.0, 2.0)
    half = np.where(x < 1.75, x + 0.9, 3.5 - x + 0.9)
    frames = np.stack([spiral(half, y, t, 1.0) for t in time])
    tips = linked(tips_of_frames(patch, frames, time, LEVEL), reach=0.1, speed=0.03)
    assert set(tips.number) == {1.0, 2.0}
    signs = {number: set(tips.chirality[tips.number == number]) for number in (1.0, 2.0)}
    assert sorted(map(tuple, signs.values())) == [(-1.0,), (1.0,)]
    left, right = (tips.position[tips.chirality == sign] for sign in (1.0, -1.0))
    assert len(left) == len(right) == time.size - 1
    assert left[:, 0].max() < 1.75 < right[:, 0].min()
    np.testing.assert_allclose(left[:, 0] + right[:, 0], 3.5, atol=0.01)


def test_a_tip_that_is_gone_for_a_while_is_another_one() -> None:
    patch, x, y = flat((102, 60))
    time = np.arange(0.0, 100.0, 2.0)
    frames = np.stack([spiral(x, y, t, 1.0) for t in time])
    frames[20:28] = -80.0
    tips = linked(tips_of_frames(patch, frames, time, LEVEL), reach=0.02, speed=0.005)
    assert set(tips.number) == {1.0, 2.0}


def test_a_tip_that_swings_back_ends_its_turn_once() -> None:
    """Two turns of 100 ms; just after the first the heading falls back below 360 degrees and returns."""
    heading = np.array([0.0, 90, 180, 270, 350, 370, 345, 355, 400, 540, 640, 720])
    time = np.array([0.0, 25, 50, 75, 95, 105, 110, 115, 120, 150, 180, 200])
    ones = np.ones(time.size)
    tips = TipPaths(time, ones, np.zeros((time.size, 3)), ones, heading)
    np.testing.assert_allclose(turn_times(tips), 100.0, rtol=1e-12)


def test_nothing_looked_for_is_nothing_found() -> None:
    tips = no_tips()
    assert tips.time.shape == tips.heading.shape == (0,)
    assert tips.position.shape == (0, 3)
    assert turn_times(tips).size == 0
