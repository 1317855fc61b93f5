"""Mid-surface kinematics at the quadrature points (eqs. 16-17, 24-26)."""

from __future__ import annotations

from typing import Any, NamedTuple, TypeAlias

import numpy as np

from stages.mechanics.shell.discretisation import Basis, shape_derivatives
from stages.numerics.bsplines import Array
from stages.numerics.compiled import inlined, kernel


class Frames(NamedTuple):
    """Moving frame of a mid-surface at all quadrature points; symmetric pairs run 11, 22, 12.

    Attributes
    ----------
    tangents
        a_a, shape ``(point, 2, 3)``.
    dual
        a^a, shape ``(point, 2, 3)``.
    normal
        a_3, shape ``(point, 3)``.
    christoffel
        Gamma^c_ab = r_,ab . a^c, shape ``(point, c, pair)``.
    metric
        a_ab, shape ``(point, pair)``.
    curvature
        b_ab = r_,ab . a_3, shape ``(point, pair)``.
    area
        sqrt(det a_ab), shape ``(point,)``.
    """

    tangents: Array
    dual: Array
    normal: Array
    christoffel: Array
    metric: Array
    curvature: Array
    area: Array

    @classmethod
    def empty(cls, points: int) -> Frames:
        """Room for the frames of ``points`` points."""
        shapes = ((2, 3), (2, 3), (3,), (2, 3), (3,), (3,), ())
        return cls(*(np.empty((points, *shape)) for shape in shapes))


Strains: TypeAlias = tuple[float, float, float, float, float, float]
"""eps 11, 22, 12, then kappa 11, 22, 12 (one shear each, not twice)."""


@inlined
def strains_at(reference: Frames, current: Frames, p: int) -> Strains:
    """eps_ab = (a_ab - A_ab)/2 and kappa_ab = B_ab - b_ab at a point (eqs. 24-25)."""
    return (
        0.5 * (current.metric[p, 0] - reference.metric[p, 0]),
        0.5 * (current.metric[p, 1] - reference.metric[p, 1]),
        0.5 * (current.metric[p, 2] - reference.metric[p, 2]),
        reference.curvature[p, 0] - current.curvature[p, 0],
        reference.curvature[p, 1] - current.curvature[p, 1],
        reference.curvature[p, 2] - current.curvature[p, 2],
    )


@kernel
def compute_frames(basis: Basis, position: Any, frames: Frames) -> None:
    """Fill ``frames`` for control points at ``position`` (control point, 3), eqs. 42-43."""
    q = basis.points
    rows, columns = basis.values1.shape[2], basis.values2.shape[2]
    grid2 = basis.values2.shape[0]
    shapes = np.empty((5, rows * columns))
    r = np.empty((5, 3))
    for g1 in range(basis.values1.shape[0]):
        for g2 in range(grid2):
            p = g1 * grid2 + g2
            shape_derivatives(basis, g1, g2, shapes)
            r[:] = 0.0
            for a in range(rows):
                for b in range(columns):
                    c = (basis.first1[g1 // q] + a) * basis.columns + basis.first2[g2 // q] + b
                    k = a * columns + b
                    for d in range(5):
                        for x in range(3):
                            r[d, x] += shapes[d, k] * position[c, x]
            n0 = r[0, 1] * r[1, 2] - r[0, 2] * r[1, 1]
            n1 = r[0, 2] * r[1, 0] - r[0, 0] * r[1, 2]
            n2 = r[0, 0] * r[1, 1] - r[0, 1] * r[1, 0]
            area = np.sqrt(n0 * n0 + n1 * n1 + n2 * n2)
            normal = frames.normal[p]
            normal[0], normal[1], normal[2] = n0 / area, n1 / area, n2 / area
            a11 = r[0, 0] * r[0, 0] + r[0, 1] * r[0, 1] + r[0, 2] * r[0, 2]
            a22 = r[1, 0] * r[1, 0] + r[1, 1] * r[1, 1] + r[1, 2] * r[1, 2]
            a12 = r[0, 0] * r[1, 0] + r[0, 1] * r[1, 1] + r[0, 2] * r[1, 2]
            inverse = 1.0 / (area * area)
            tangents, dual = frames.tangents[p], frames.dual[p]
            for x in range(3):
                tangents[0, x], tangents[1, x] = r[0, x], r[1, x]
                dual[0, x] = inverse * (a22 * r[0, x] - a12 * r[1, x])
                dual[1, x] = inverse * (a11 * r[1, x] - a12 * r[0, x])
            for pair in range(3):
                second = r[2 + pair]
                frames.curvature[p, pair] = (
                    second[0] * normal[0] + second[1] * normal[1] + second[2] * normal[2]
                )
                for c in range(2):
                    frames.christoffel[p, c, pair] = (
                        second[0] * dual[c, 0] + second[1] * dual[c, 1] + second[2] * dual[c, 2]
                    )
            frames.metric[p, 0], frames.metric[p, 1], frames.metric[p, 2] = a11, a22, a12
            frames.area[p] = area
