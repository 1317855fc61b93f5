"""Tips of spiral waves: where they are, which way they turn, and the paths that they take.

The line v = v_iso has a front, where v rises, and a back, where it falls. They meet at a tip, where
v = v_iso and dv/dt = 0 at once (Fenton and Karma, 1998, Chaos 8, 20). Between two frames v is their
mean and dv/dt their difference; on triangles between collocation points both are linear, so that the
tip is a point of a triangle or none.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.numerics.time_series import StoredFrames, blocks


class Tips(NamedTuple):
    """Tips at one time: places in mm, chirality 1 or -1, direction of grad v in degrees."""

    time: float
    position: Array
    chirality: Array
    heading: Array


class Triangles(NamedTuple):
    """Collocation points joined to triangles, two to a cell of the grid.

    Attributes
    ----------
    shape
        Of the grid of points.
    corners
        Numbers of the triangles' points, shape ``(triangle, 3)``; first one of each cell, then the other.
    position
        Of the points, mm, shape ``(point, 3)``.
    frame
        Orthonormal tangents, the first along the first parametric direction, shape
        ``(triangle, 2, 3)``.
    """

    shape: tuple[int, int]
    corners: NDArray[np.int64]
    position: Array
    frame: Array


def triangles(surface: Patch) -> Triangles:
    """Triangles between the collocation points of a patch."""
    position = surface.evaluate(surface.first.greville(), surface.second.greville())
    index = np.arange(surface.size).reshape(surface.first.size, surface.second.size)
    a, b, c, d = (
        part.ravel() for part in (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:])
    )
    corners = np.concatenate([np.stack((a, b, c), axis=1), np.stack((a, c, d), axis=1)])
    along = np.concatenate([position[b] - position[a], position[c] - position[d]])
    sides = position[corners[:, 1:]] - position[corners[:, :1]]
    normal = np.cross(sides[:, 0], sides[:, 1])
    first, second = along, np.cross(normal, along)
    frame = np.stack(
        [side / np.linalg.norm(side, axis=1, keepdims=True) for side in (first, second)]
    )
    return Triangles(index.shape, corners, position, np.moveaxis(frame, 0, 1))


def tips_between(mesh: Triangles, time: float, value: Array, change: Array) -> Tips:
    """Tips at one time, from v - v_iso and dv/dt (to any scale) at the points, shape ``(point,)``."""
    cells = np.flatnonzero(
        _takes_both_signs(value, mesh.shape) & _takes_both_signs(change, mesh.shape)
    )
    near = np.concatenate([cells, cells + len(mesh.corners) // 2])
    corners = mesh.corners[near]
    place = mesh.position[corners]
    sides = place[:, 1:] - place[:, :1]
    flat = np.einsum("tsx,tdx->tsd", sides, mesh.frame[near])
    fields = np.stack((value[corners], change[corners]), axis=2)  # (triangle, corner, field)
    slopes = np.linalg.solve(flat, fields[:, 1:] - fields[:, :1])  # (triangle, direction, field)
    turning = np.linalg.det(slopes)
    near_zero = turning == 0.0
    slopes[near_zero] = np.eye(2)
    root = np.linalg.solve(np.swapaxes(slopes, 1, 2), -fields[:, 0, :, None])
    share = np.linalg.solve(np.swapaxes(flat, 1, 2), root)[..., 0]
    inside = (share >= 0.0).all(axis=1) & (share.sum(axis=1) < 1.0) & ~near_zero
    found = place[:, 0] + np.einsum("ts,tsx->tx", share, sides)
    heading = np.degrees(np.arctan2(slopes[:, 1, 0], slopes[:, 0, 0]))
    return Tips(time, found[inside], np.sign(turning[inside]), heading[inside])


def _takes_both_signs(field: Array, shape: tuple[int, int]) -> NDArray[np.bool_]:
    """Whether a field has both signs at the corners of each cell, shape ``(cell,)``."""
    above = (field > 0.0).reshape(shape)
    corners = above[:-1, :-1], above[1:, :-1], above[1:, 1:], above[:-1, 1:]
    return np.asarray(np.any(corners, axis=0) & ~np.all(corners, axis=0)).ravel()


def tips_of_frames(
    surface: Patch, potential: StoredFrames, time: Array, level: float
) -> Iterator[Tips]:
    """Tips half way between every two frames, in the order of time.

    Parameters
    ----------
    potential
        Frames at the collocation points, shape ``(time, point)``, mV.
    time
        Of the frames, ms.
    level
        v_iso, mV.
    """
    mesh, before = triangles(surface), None
    for frames, block in blocks(potential):
        for t, v in zip(time[frames], block, strict=True):
            if before is not None:
                then, earlier = before
                yield tips_between(mesh, 0.5 * (then + t), 0.5 * (earlier + v) - level, v - earlier)
            before = t, v
