"""Front velocities from exact arrival times: plane, round and colliding waves, on flat and curved films."""

from __future__ import annotations

import numpy as np
import pytest

from stages.electrophysiology.front_velocity import front_velocity
from stages.numerics.bsplines import Array, SplineSpace
from stages.numerics.patches import Patch
from stages.numerics.tubes import closed_tube
from tests.problems import observed_orders, parabolic_sheet, sheet_arc_length, skewed_square

SPEED = 0.0175  # mm/ms
FILM = Patch.rectangle(3.5, 2.0)


def places(patch: Patch) -> Array:
    return patch.evaluate(*(space.greville() for space in patch.spaces))


@pytest.mark.parametrize("patch", [FILM, skewed_square()], ids=["film", "skewed"])
@pytest.mark.parametrize("degree", [2, 4])
@pytest.mark.parametrize("angle", [0.0, 37.0, 200.0])
def test_a_plane_wave_has_its_speed_and_direction(patch: Patch, degree: int, angle: float) -> None:
    surface = patch.refine(degree, (14, 8))
    direction = np.array([np.cos(np.deg2rad(angle)), np.sin(np.deg2rad(angle)), 0.0])
    times = 500.0 + places(surface) @ direction / SPEED
    found = front_velocity(surface, times[:, None])[:, 0]
    # a fit of linear values by quadratic functions: rounding of 500 ms over differences of 1 ms or more
    np.testing.assert_allclose(found, np.broadcast_to(SPEED * direction, found.shape), atol=1e-12)


def test_a_round_wave_runs_outwards_and_converges_at_second_order() -> None:
    errors = []
    for elements in ((14, 8), (28, 16), (56, 32)):
        surface = FILM.refine(2, elements)
        away = places(surface) - np.array([-0.4, 0.7, 0.0])
        radius = np.linalg.norm(away, axis=1, keepdims=True)
        found = front_velocity(surface, radius / SPEED)[:, 0]
        errors.append(np.abs(found - SPEED * away / radius).max())
    assert errors[-1] < 0.01 * SPEED  # h^2/R^2 = 0.02 at the nearest point, times a sixth
    assert observed_orders(np.array(errors))[-1] > 1.8


@pytest.mark.parametrize("angle", [0.0, 50.0])
def test_a_plane_wave_on_a_bent_film_follows_the_film(angle: float) -> None:
    """Bending without stretch: times are plane in the arc length, velocities are tangents."""
    bend, speeds = 0.8, []
    direction = np.array([np.cos(np.deg2rad(angle)), np.sin(np.deg2rad(angle))])
    for elements in ((20, 12), (40, 24)):
        surface = parabolic_sheet(bend, 1.6, 1.0).refine(3, elements)
        x, y, _ = places(surface).T
        times = (direction[0] * sheet_arc_length(bend, x) + direction[1] * y) / SPEED
        found = front_velocity(surface, times[:, None])[:, 0]
        steep = bend * x
        tangent = np.stack((np.ones_like(x), np.zeros_like(x), steep), -1)
        tangent /= np.sqrt(1 + steep**2)[:, None]
        exact = SPEED * (direction[0] * tangent + direction[1] * np.array([0.0, 1.0, 0.0]))
        speeds.append(np.abs(found - exact).max() / SPEED)
    assert speeds[1] < 0.01  # (h kappa)^2 with h = 0.05 mm and kappa up to 0.8/mm
    assert speeds[0] / speeds[1] > 3.5


def test_a_wave_round_a_tube_has_its_velocity_at_the_seam_too() -> None:
    """Points of the seam are there twice; from both sides the same front passes."""
    radius = 0.6
    errors = []
    for spans in (24, 48):
        around = SplineSpace.uniform(1, 1).refine(3, spans)
        angles = 2 * np.pi * around.greville()
        ring = np.stack((0 * angles, radius * np.cos(angles), radius * np.sin(angles)), axis=-1)
        flat = Patch.rectangle(1.0, 1.0).refine(3, (8, spans))
        x = flat.first.greville()
        points = np.repeat(ring[None], x.size, axis=0)
        points[..., 0] = x[:, None]
        tube = flat.interpolate(points.reshape(-1, 3))
        bearing = np.tile(angles, x.size)
        # the wave goes on and on: what ends a turn at the seam's second copy begins the next at its first
        waves = (np.arange(4.0) + bearing[:, None] / (2 * np.pi)) * 2 * np.pi * radius / SPEED
        found = front_velocity(tube, waves)
        exact = SPEED * np.stack((0 * bearing, -np.sin(bearing), np.cos(bearing)), axis=-1)
        assert np.isfinite(found).all()
        assert found.shape == (tube.size, 4, 3)
        errors.append(np.abs(found - exact[:, None]).max() / SPEED)
    assert errors[1] < 0.01  # (h/R)^2 = 0.017 over windows that reach to one side
    assert errors[0] / errors[1] > 3.0


def test_waves_are_matched_in_time_where_points_have_missed_one() -> None:
    """Right of 1.2 mm the second of three waves is blocked: there the third is the second beat."""
    surface = FILM.refine(2, (28, 8))
    x = places(surface)[:, 0]
    waves = np.array([0.0, 400.0, 900.0]) + x[:, None] / SPEED
    waves[x > 1.2, 1] = np.nan
    times = np.sort(waves, axis=1)
    found = front_velocity(surface, times)
    np.testing.assert_allclose(found[:, 0, 0], SPEED, rtol=1e-10)
    third = np.where(x > 1.2, 1, 2)
    np.testing.assert_allclose(found[np.arange(x.size), third, 0], SPEED, rtol=1e-10)
    blocked = found[:, 1, 0][x < 1.2]
    near = np.isnan(blocked)
    assert 0 < near.sum() <= 2 * 10  # the last column before the block, no more than two
    np.testing.assert_allclose(blocked[~near], SPEED, rtol=1e-10)


def test_no_front_passes_where_a_wave_breaks_out_and_where_two_collide() -> None:
    surface = FILM.refine(2, (56, 32))
    position = places(surface)
    source = np.array([1.2, 0.9, 0.0])
    burst = np.linalg.norm(position - source, axis=1) / SPEED
    crash = -np.abs(position[:, 0] - 2.0) / SPEED
    found = front_velocity(surface, np.column_stack((burst, 300.0 + crash)))
    h = 3.5 / 56
    unknown = np.isnan(found[..., 0])
    assert np.linalg.norm(position[unknown[:, 0]] - source, axis=1).max() < 1.5 * h
    assert unknown[np.argmin(burst), 0]
    assert np.abs(position[unknown[:, 1], 0] - 2.0).max() < h
    middle = np.abs(position[:, 0] - 2.0) < 0.3 * h
    assert unknown[middle, 1].all()
    speeds = np.linalg.norm(found[~unknown], axis=-1)
    # next to the kink a parabola in the mean square is off by as much as it allows itself
    assert speeds.min() > 0.6 * SPEED
    assert speeds.max() < 1.7 * SPEED


def test_everything_at_once_and_nothing_at_all_are_no_fronts() -> None:
    surface = FILM.refine(2, (6, 4))
    assert np.isnan(front_velocity(surface, np.full((surface.size, 2), 7.0))).all()
    assert front_velocity(surface, np.empty((surface.size, 0))).shape == (surface.size, 0, 3)


def test_the_smallest_tubes_have_velocities_too() -> None:
    """Of three spans, where the first window reaches to the other side of the tube."""
    ring = closed_tube(0.4, 1.0, SplineSpace.uniform(2, 1), SplineSpace.uniform(2, 3))
    found = front_velocity(ring, places(ring)[:, [0]] / SPEED)
    np.testing.assert_allclose(found[:, 0, 0], SPEED, rtol=1e-9)


def test_the_smallest_patch_has_one_window() -> None:
    surface = FILM.refine(2, (1, 1))
    found = front_velocity(surface, places(surface)[:, [0]] / SPEED)
    np.testing.assert_allclose(found[:, 0, 0], SPEED, rtol=1e-12)
