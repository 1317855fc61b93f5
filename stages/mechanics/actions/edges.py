"""The edges of a patch: their rows of control points, and the frames along them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stages.mechanics.actions.relations import Points, weighted
from stages.numerics.bsplines import Array
from stages.numerics.collocation import EDGES
from stages.numerics.patches import Patch
from stages.numerics.quadrature import gauss_on_spans
from stages.numerics.surface_geometry import frame_on_grid
from stages.numerics.ties import Relation

FLAT = 1e-10
"""Difference of unit vectors that is round-off of the geometry."""


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


def edge_frame(patch: Patch, edge: str) -> EdgeFrame:
    """Frame at the Greville points of an edge's control points."""
    across = across_direction(edge)
    theta = [space.greville() for space in patch.spaces]
    theta[across] = theta[across][[0 if is_start(edge) else -1]]
    frame = frame_on_grid(patch, *theta)
    tangent = frame.tangents[:, 1 - across]
    tangent = tangent / np.linalg.norm(tangent, axis=1)[:, None]
    inward = np.cross(frame.normal, tangent)
    away = frame.tangents[:, across] * (1.0 if is_start(edge) else -1.0)
    inward *= np.sign(np.einsum("px,px->p", inward, away))[:, None]
    return EdgeFrame(tangent, inward, frame.normal)


def turning_rows(patch: Patch, edge: str, *, moving: bool = False) -> Iterator[Relation]:
    """Relations of the second row of control points that keep an edge from turning about itself.

    The rotation is a_3 . u_,across, a sum over the second row less the first; that one is left out
    where it is held, not ``moving``.
    """
    first, second = control_rows(patch, edge)
    normals = edge_frame(patch, edge).normal
    alike = np.abs(normals - normals[0]).max() < FLAT
    if alike and (patch.weights is None or not moving):
        slopes = np.zeros((second.size, patch.size))
        slopes[np.arange(second.size), second] = 1.0
        slopes[np.arange(second.size), first] = -1.0
    else:
        slopes = _slopes_across(patch, edge)
    turning = np.concatenate((second, first)) if moving else second
    for slope, normal in zip(slopes[:, turning], normals, strict=True):
        near = np.flatnonzero(np.abs(slope) > FLAT * np.abs(slope).max())
        yield weighted(turning[near].tolist(), slope[near].tolist(), normal)


def _slopes_across(patch: Patch, edge: str) -> Array:
    """Derivatives of all functions across an edge, at its Greville points, relative to the largest."""
    across = across_direction(edge)
    theta = [space.greville() for space in patch.spaces]
    theta[across] = theta[across][[0 if is_start(edge) else -1]]
    points = np.stack([grid.ravel() for grid in np.meshgrid(*theta, indexing="ij")], axis=1)
    slopes = patch.functions(points, (1, 0) if across == 0 else (0, 1))
    return np.asarray(slopes / np.abs(slopes).max())


def symmetry_plane(patch: Patch, edge: str) -> tuple[Array, Array, Array]:
    """Unit normal of the plane of a symmetry edge, and two directions in it.

    Raises
    ------
    ValueError
        If the film does not meet one plane at a right angle there, with its mesh lines.
    """
    first, second = control_rows(patch, edge)
    net = patch.control_points.reshape(-1, 3)
    across = net[second] - net[first]
    across = across / np.linalg.norm(across, axis=1)[:, None]
    normal = edge_frame(patch, edge).inward.mean(axis=0)
    normal = normal / np.linalg.norm(normal)
    if np.abs(across - normal).max() > FLAT or np.ptp(net[first] @ normal) > FLAT * np.ptp(net):
        raise ValueError(
            f"the edge {edge} is no edge of symmetry: it must lie in one plane, and the film and its "
            f"mesh lines must meet that plane at a right angle"
        )
    if patch.weights is not None:
        ratio = patch.weights.ravel()[second] / patch.weights.ravel()[first]
        if np.ptp(ratio) > FLAT:
            raise ValueError(
                f"the weights of the rational film next to the edge {edge} are not in one ratio: its "
                f"mirror image would not continue it smoothly"
            )
    normal[np.abs(normal) < FLAT] = 0.0
    axes = np.eye(3)[np.argsort(np.abs(normal), kind="stable")]
    one = axes[0] - (axes[0] @ normal) * normal
    one = one / np.linalg.norm(one)
    return normal, one, np.cross(normal, one)


def across_direction(edge: str) -> int:
    """Parametric direction (0 or 1) that leads away from an edge."""
    return 0 if edge.startswith("X") else 1


def is_start(edge: str) -> bool:
    """Whether an edge is the start of the direction that leads across it."""
    return edge.endswith("=0")


def edge_quadrature(patch: Patch, edge: str, points: int) -> tuple[Array, Array]:
    """Gauss points (theta1, theta2) of an edge, and weights times ds of the undeformed edge, mm.

    Raises
    ------
    ValueError
        If the edge has no length.
    """
    direction = 1 - across_direction(edge)
    along, weights = (a.ravel() for a in gauss_on_spans(patch.spaces[direction].breaks, points))
    fixed = np.full_like(along, patch.spaces[1 - direction].knots[0 if is_start(edge) else -1])
    theta = np.stack((fixed, along) if direction == 1 else (along, fixed), axis=1)
    tangents = patch.evaluate_points(theta, (0, 1) if direction == 1 else (1, 0))
    lengths = weights * np.linalg.norm(tangents, axis=1)
    if not lengths.min() > FLAT * float(np.ptp(patch.control_points)):
        raise ValueError(f"the edge {edge} has no length: nothing can act along it")
    return theta, lengths


def edge_integrals(patch: Patch, edge: str, points: int) -> Array:
    """Integral of each basis function along an edge of the undeformed film, mm, ``(control point,)``."""
    theta, lengths = edge_quadrature(patch, edge, points)
    return np.asarray(lengths @ patch.functions(theta))
