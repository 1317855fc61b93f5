"""Waves on closed tubes: along them, around them and through the seam."""

from __future__ import annotations

import numpy as np
import pytest

from stages.electrophysiology.monodomain import build
from stages.electrophysiology.point_cells import PointCells
from stages.electrophysiology.recording import BeatRecorder
from stages.electrophysiology.stimuli.patch_current import PatchCurrent
from stages.numerics.bsplines import Array, SplineSpace
from stages.numerics.patches import Patch
from stages.numerics.tubes import closed_tube
from tests.electrophysiology.test_monodomain import advance
from tests.paper import S1, electrophysiology_config

HALF = 1.2  # mm, half the way around


def tube(elements: tuple[int, int], length: float = 1.0, degree: int = 4) -> Patch:
    spaces = (SplineSpace.uniform(degree, n) for n in elements)
    return closed_tube(HALF / np.pi, length, *spaces)


def strip(y: tuple[float, float]) -> PatchCurrent:
    """A current on a strip across the whole film, for 2 ms."""
    return PatchCurrent(
        kind="patch-current", x=(0.0, 0.3), y=y, start=0.0, duration=2.0, current=40.0
    )


def arrivals(patch: Patch, *stimuli: PatchCurrent) -> Array:
    """Crossing times along the middle line, ms."""
    config = electrophysiology_config(n_steps=2000, duration=100.0, stimuli=stimuli)
    stepper, state = build(config, patch)
    beats = BeatRecorder(state.potential, -30.0, -80.0)
    stepper.advance(state, 2000, beats.watch)
    found = beats.tables()["activation_times"][:, 0]
    return np.asarray(found.reshape(patch.first.size, -1)[2])


@pytest.mark.parametrize("scheme", ["cn-ab2", "strang"])
def test_a_wave_along_a_tube_is_that_on_a_flat_film(scheme: str) -> None:
    """S1 on the ring X = 0: nothing depends on the angle."""
    found = advance(tube((12, 16)), 200, scheme=scheme)
    flat = advance(Patch.rectangle(1.0, 0.5).refine(4, (12, 2)), 200, True, scheme=scheme)
    around = found.potential.reshape(16, 20)
    expected = flat.potential.reshape(16, 6)[:, 1]
    # 200 steps; the tube's splines differ from a circle by 1e-6, to which a constant is blind
    np.testing.assert_allclose(around, np.broadcast_to(expected[:, None], around.shape), atol=1e-9)
    assert np.ptp(expected) > 50.0  # mV: the wave is there


@pytest.mark.parametrize("angle", [0.0, 40.0, 90.0])
def test_helical_fibres_slow_a_wave_along_a_tube_by_their_angle(angle: float) -> None:
    """A ring keeps its shape, so only D_xx = D_l cos^2 + D_t sin^2 counts: a flat film with that one."""
    along, across = 0.002, 0.0005
    fibres = {"transverse_conductivity": across, "diffusion_angle": angle}
    found = advance(tube((12, 16)), 200, conductivity=along, **fibres)
    cos2 = np.cos(np.deg2rad(angle)) ** 2
    effective = along * cos2 + across * (1.0 - cos2)
    flat = advance(Patch.rectangle(1.0, 0.5).refine(4, (12, 2)), 200, True, conductivity=effective)
    expected = flat.potential.reshape(16, 6)[:, 1]
    # 200 steps of round-off; what the splines miss of the circle does not show in a plane wave
    np.testing.assert_allclose(
        found.potential.reshape(16, 20), np.broadcast_to(expected[:, None], (16, 20)), atol=1e-9
    )


def test_two_waves_from_the_seam_meet_on_the_other_side() -> None:
    """Each runs half around as along a flat film of that length, with a mirror at either end."""
    whole = 2.0 * HALF
    around = arrivals(tube((2, 48), 0.3), strip((0.0, 0.2)), strip((whole - 0.2, whole)))
    flat = arrivals(Patch.rectangle(0.3, HALF).refine(4, (2, 24)), strip((0.0, 0.2)))
    middle = around.size // 2  # points lie half a span, then one and a half beside the far line
    met = (9.0 * around[middle] - around[middle + 1]) / 8.0
    # the same fields on meshes that differ at the mirrors; the wave needs 2 ms for one span
    assert met == pytest.approx(flat[-1], abs=0.02)
    np.testing.assert_allclose(around, around[::-1], rtol=0, atol=1e-6)  # mirror images


def test_a_wave_passes_the_seam_as_if_it_were_not_there() -> None:
    """Started a quarter around, it reaches the seam from one side as soon as the far point on the other."""
    whole = 2.0 * HALF
    found = arrivals(tube((2, 48), 0.3), strip((0.25 * whole - 0.1, 0.25 * whole + 0.1)))
    y = PointCells.of(tube((2, 48), 0.3)).y
    late = np.interp([0.5 * whole, 0.75 * whole], y, found)
    assert found[0] == found[-1]
    # converged to well below the time for one span (2 ms); arrival is latest opposite to the start
    assert late[0] == pytest.approx(found[0], abs=0.05)
    assert y[np.argmax(found)] == pytest.approx(0.75 * whole, abs=0.06)  # one span


def test_a_seam_is_no_edge_that_a_current_could_cross() -> None:
    for edge in ("Y=0", "Y=L2"):
        stimulus = S1.model_copy(update={"edge": edge})
        with pytest.raises(ValueError, match=f"there is no edge {edge}: the film is closed"):
            build(electrophysiology_config(stimuli=(stimulus,)), tube((4, 8)))


def test_extents_beside_the_seam_share_its_point() -> None:
    """Half of the seam's own interval lies on either side; all shares together are the extent."""
    cells = PointCells.of(tube((4, 24)))
    widths = np.gradient(cells.y)
    widths[0] = widths[0] / 2 + widths[-1] / 2
    for extent in ((0.0, 0.3), (2.0, 2.4), (0.0, 2.4)):
        share = cells.share_of_edge("X=L1", extent).reshape(cells.x.size, -1)[-1]
        assert share[-1] == 0.0
        # the ends of the intervals lie half way between points, as in numpy's gradient
        assert share[:-1] @ widths[:-1] == pytest.approx(extent[1] - extent[0], rel=1e-6)
