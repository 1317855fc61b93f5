"""Tips of spiral waves: where they are, and which way they turn.

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
    v, rate = value[mesh.corners[near]], change[mesh.corners[near]]
    v1, v2 = v[:, 1] - v[:, 0], v[:, 2] - v[:, 0]
    rate1, rate2 = rate[:, 1] - rate[:, 0], rate[:, 2] - rate[:, 0]
    turning = v1 * rate2 - v2 * rate1  # from grad v to grad dv/dt, in a frame that is right-handed
    with np.errstate(divide="ignore", invalid="ignore"):
        first = (v2 * rate[:, 0] - rate2 * v[:, 0]) / turning
        second = (rate1 * v[:, 0] - v1 * rate[:, 0]) / turning
        inside = (first >= 0.0) & (second >= 0.0) & (first + second < 1.0)
    share = np.stack((first, second), axis=1)[inside]
    corners = mesh.position[mesh.corners[near[inside]]]
    place = corners[:, 0] + np.einsum("ts,tsx->tx", share, corners[:, 1:] - corners[:, :1])
    heading = [
        _heading(mesh, cell, frame, tip, value)
        for cell, frame, tip in zip(
            np.concatenate([cells, cells])[inside], mesh.frame[near[inside]], place, strict=True
        )
    ]
    return Tips(time, place, np.sign(turning[inside]), np.array(heading))


def _heading(mesh: Triangles, cell: int, frame: Array, tip: Array, value: Array) -> float:
    """Direction of grad v at a tip, degrees: of the quadratic function nearest to v at the 16 points around.

    The slope of v in the tip's triangle alone would belong to the middle of the triangle.
    """
    rows, columns = mesh.shape
    i, j = divmod(cell, columns - 1)
    around = np.arange(-1, 3)
    row, column = np.clip(i + around, 0, rows - 1), np.clip(j + around, 0, columns - 1)
    points = (row[:, None] * columns + column).ravel()
    x, y = frame @ (mesh.position[points] - tip).T
    size = max(np.abs(x).max(), np.abs(y).max())
    x, y = x / size, y / size
    terms = np.stack((np.ones_like(x), x, y, x * x, x * y, y * y), axis=1)
    _, along, across, *_ = np.linalg.lstsq(terms, value[points])[0]
    return float(np.degrees(np.arctan2(across, along)))


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
