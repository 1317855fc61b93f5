"""Rolling up: how far the film's surface turns along its lines, and whether it may meet itself."""

from __future__ import annotations

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch

SAMPLES = 201
"""Points along a line; the tangent may turn by half a circle between two of them."""


def largest_turn(patch: Patch, displacement: Array) -> float:
    """Angle in radians by which a tangent turns from end to end, at most, beyond what it does at rest.

    Four lines are looked at: those through the middle along both directions of the patch, and its two
    diagonals. The angle is the length of the sum of the rotation vectors from each tangent to the next,
    so that bends to both sides cancel, and a strip that is rolled into a full circle gives 2 pi.
    Beyond that its ends have met, unless they have passed each other sideways.

    Parameters
    ----------
    patch
        Undeformed mid-surface.
    displacement
        Of the control points, mm, shape ``(dof,)``.
    """
    net = patch.control_points
    moved = Patch(patch.first, patch.second, net + displacement.reshape(net.shape), patch.weights)
    return max(
        float(np.linalg.norm(after - before))
        for before, after in zip(_turns(patch), _turns(moved), strict=True)
    )


def _turns(patch: Patch) -> list[Array]:
    """Total rotation vector along each of the four lines."""
    grid1, grid2 = (
        np.linspace(space.breaks[0], space.breaks[-1], SAMPLES) for space in patch.spaces
    )
    middle1, middle2 = grid1[[SAMPLES // 2]], grid2[[SAMPLES // 2]]
    whole = patch.evaluate(grid1, grid2).reshape(SAMPLES, SAMPLES, 3)
    index = np.arange(SAMPLES)
    lines = (
        patch.evaluate(grid1, middle2),
        patch.evaluate(middle1, grid2),
        whole[index, index],
        whole[index, ::-1][index, index],
    )
    return [_turn(line) for line in lines]


def _turn(line: Array) -> Array:
    chords = np.diff(line, axis=0)
    directions = chords / np.linalg.norm(chords, axis=1)[:, None]
    axes = np.cross(directions[:-1], directions[1:])
    sines = np.linalg.norm(axes, axis=1)
    angles = np.arctan2(sines, np.einsum("ix,ix->i", directions[:-1], directions[1:]))
    # where the line goes straight on the axis does not matter
    return np.asarray((angles / np.where(sines > 0.0, sines, 1.0)) @ axes)
