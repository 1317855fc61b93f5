"""The angle by which a film has rolled up, on shapes whose angle is known."""

from __future__ import annotations

import numpy as np
import pytest

from stages.mechanics.statics.equilibrium import Rest, Shape
from stages.mechanics.statics.loading_log import LoadingLog
from stages.mechanics.statics.roll_up import largest_turn
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from tests.mechanics import films


def rolled(patch: Patch, angle: float, across: bool = False) -> Array:
    """Displacement that rolls the film 3.5 x 2 into an arc of that angle."""
    grid = patch.evaluate(patch.first.greville(), patch.second.greville())
    x, y = grid[:, 0], grid[:, 1]
    along, other = (y, x) if across else (x, y)
    radius = np.ptp(along) / angle
    bent, height = radius * np.sin(along / radius), radius * (1.0 - np.cos(along / radius))
    shape = (other, bent, height) if across else (bent, other, height)
    moved = patch.interpolate(np.stack(shape, axis=1))
    return (moved.control_points - patch.control_points).ravel()


@pytest.mark.parametrize("angle", [0.3, 3.0, 7.0])
@pytest.mark.parametrize("across", [False, True])
def test_a_cylinder_turns_by_its_angle(angle: float, across: bool) -> None:
    patch = films.flat((24, 24), degree=3)
    # chords of 1/200 of the line lose one of 200 parts of the angle
    assert largest_turn(patch, rolled(patch, angle, across)) == pytest.approx(angle, rel=0.006)


def test_a_film_at_rest_does_not_turn_even_if_it_is_curved() -> None:
    for patch in (films.flat(), films.arched()):
        assert largest_turn(patch, np.zeros(3 * patch.size)) == 0.0


def test_bends_to_both_sides_cancel() -> None:
    patch = films.flat((24, 4), degree=3)
    grid = patch.evaluate(patch.first.greville(), patch.second.greville())
    wave = np.stack((grid[:, 0], grid[:, 1], np.sin(2 * np.pi * grid[:, 0] / 3.5)), axis=1)
    moved = patch.interpolate(wave).control_points - patch.control_points
    # a full wave starts and ends in the same direction
    assert largest_turn(patch, moved.ravel()) < 0.05


def test_a_run_warns_once_when_the_film_meets_itself_and_whenever_its_stability_changes() -> None:
    body = films.shell(films.flat((12, 2)))
    held = films.clamped(body)
    log = LoadingLog()

    def look(angle: float, activation: float) -> list[str]:
        moved = rolled(body.patch, angle) if angle else np.zeros(body.size)
        balance = held.balance(moved, held.under(np.full(body.points, activation)))
        shape = Shape(Rest(moved, moved, 0.0), 5, 2.5)
        return list(log.look_at_frame(20.0, 5.0, balance, shape))

    assert look(0.0, 0.0) == []
    compressed = look(0.0, -40.0)  # active pressure makes a flat film buckle
    assert len(compressed) == 1
    assert "between t = 15 and 20 ms (activation up to 40 kPa)" in compressed[0]
    assert "buckled or passed a limit point" in compressed[0]
    assert look(0.0, -40.0) == []
    assert "more stable" in look(0.0, 0.0)[0]
    first = [line for line in look(6.5, 0.0) if "full circle" in line]
    assert len(first) == 1
    assert "Contact of the film with itself is not modelled" in first[0]
    assert not [line for line in look(6.6, 0.0) if "full circle" in line]
    assert LoadingLog.restored(log.saved()) == log
    assert log.divided == 6
