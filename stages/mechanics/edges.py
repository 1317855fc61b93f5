"""The edges of a patch: their rows of control points, and the frames along them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stages.numerics.bsplines import Array
from stages.numerics.collocation import EDGES
from stages.numerics.patches import Patch
from stages.numerics.surface_geometry import frame_on_grid

Points = NDArray[np.int64]
"""Numbers of control points."""


@dataclass(frozen=True)
class EdgeFrame:
    """Unit vectors at points of an edge of the undeformed film, each of shape ``(point, 3)``.

    Attributes
    ----------
    along
        Tangent of the edge, towards growing parameters.
    inward
        Normal to the edge in the tangent plane of the film, away from the edge.
    normal
        Normal a_3 of the film.
    """

    along: Array
    inward: Array
    normal: Array


def control_rows(patch: Patch, edge: str) -> tuple[Points, Points]:
    """Control points of an edge, and those of the next row, in the order of growing parameters.

    Raises
    ------
    ValueError
        If there is no such edge.
    """
    if edge not in EDGES:
        raise ValueError(f"there is no edge {edge!r}; the edges are: {', '.join(EDGES)}")
    grid = np.arange(patch.size).reshape(patch.first.size, patch.second.size)
    rows = {
        "X=0": (grid[0], grid[1]),
        "X=L1": (grid[-1], grid[-2]),
        "Y=0": (grid[:, 0], grid[:, 1]),
        "Y=L2": (grid[:, -1], grid[:, -2]),
    }
    return rows[edge]


def edge_parameters(patch: Patch, edge: str, along: Array) -> tuple[Array, Array]:
    """Parameters (theta1, theta2) of points of an edge, as the two lists of a tensor grid."""
    space = patch.first if edge.startswith("X") else patch.second
    fixed = space.knots[[0 if edge.endswith("=0") else -1]]
    return (fixed, along) if edge.startswith("X") else (along, fixed)


def edge_frame(patch: Patch, edge: str, along: Array | None = None) -> EdgeFrame:
    """Frame at parameters of an edge; by default at the Greville points of its control points."""
    direction = 1 if edge.startswith("X") else 0
    parameters = patch.spaces[direction].greville() if along is None else along
    frame = frame_on_grid(patch, *edge_parameters(patch, edge, parameters))
    tangent = frame.tangents[:, direction]
    tangent = tangent / np.linalg.norm(tangent, axis=1)[:, None]
    inward = np.cross(frame.normal, tangent)
    across = frame.tangents[:, 1 - direction] * (1.0 if edge.endswith("=0") else -1.0)
    inward *= np.sign(np.einsum("px,px->p", inward, across))[:, None]
    return EdgeFrame(tangent, inward, frame.normal)
