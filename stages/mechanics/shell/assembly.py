"""Nodal forces, tangent stiffness and mass, straight into a symmetric band (eqs. 30, 45-48)."""

from __future__ import annotations

from typing import Any

import numpy as np

from stages.mechanics.shell.discretisation import Basis, shape_derivatives, shape_values
from stages.mechanics.shell.kinematics import Frames
from stages.mechanics.shell.resultants import Resultants
from stages.numerics.compiled import inlined, kernel


def half_bandwidth(basis: Basis) -> int:
    """Largest distance between two degrees of freedom that share an element."""
    rows, columns = basis.values1.shape[2], basis.values2.shape[2]
    return 3 * ((rows - 1) * basis.columns + columns - 1) + 2


@kernel
def assemble_force(
    basis: Basis, weights: Any, frames: Frames, resultants: Resultants, force: Any
) -> None:
    """Add F_int to ``force`` (control point, 3).

    Per node: integral of N_,a t^a - N_,ab m^ab a_3, with t^a = n^ab a_b + (m^cd Gamma^a_cd) a_3,
    from delta eps_ab = (a_a . delta r_,b + ...)/2 and delta kappa_ab = -(delta r_,ab - Gamma^c_ab
    delta r_,c) . a_3.
    """
    q = basis.points
    rows, columns = basis.values1.shape[2], basis.values2.shape[2]
    grid2 = basis.values2.shape[0]
    shapes = np.empty((5, rows * columns))
    t = np.empty((5, 3))
    for g1 in range(basis.values1.shape[0]):
        for g2 in range(grid2):
            p = g1 * grid2 + g2
            shape_derivatives(basis, g1, g2, shapes)
            n, m, w = resultants.force[p], resultants.moment[p], weights[p]
            gamma, normal, a = frames.christoffel[p], frames.normal[p], frames.tangents[p]
            c1 = m[0] * gamma[0, 0] + m[1] * gamma[0, 1] + 2.0 * m[2] * gamma[0, 2]
            c2 = m[0] * gamma[1, 0] + m[1] * gamma[1, 1] + 2.0 * m[2] * gamma[1, 2]
            for x in range(3):
                t[0, x] = w * (n[0] * a[0, x] + n[2] * a[1, x] + c1 * normal[x])
                t[1, x] = w * (n[2] * a[0, x] + n[1] * a[1, x] + c2 * normal[x])
                t[2, x] = -w * m[0] * normal[x]
                t[3, x] = -w * m[1] * normal[x]
                t[4, x] = -2.0 * w * m[2] * normal[x]
            for i in range(rows):
                for j in range(columns):
                    c = (basis.first1[g1 // q] + i) * basis.columns + basis.first2[g2 // q] + j
                    k = i * columns + j
                    for x in range(3):
                        force[c, x] += (
                            shapes[0, k] * t[0, x]
                            + shapes[1, k] * t[1, x]
                            + shapes[2, k] * t[2, x]
                            + shapes[3, k] * t[3, x]
                            + shapes[4, k] * t[4, x]
                        )


@kernel
def _rows(
    shapes: Any, w: float, p: int, frames: Any, resultants: Any, left: Any, right: Any
) -> None:
    """Fill ``left`` and ``right`` (10, dof), so that the point adds sum_k left_k (x) right_k.

    Rows 0-5: delta eps (11, 22, 2*12) and delta kappa against their tangents (eqs. 49-50). Rows 6-9:
    m : D[delta kappa], with H_I = N_I,ab - Gamma^c_ab N_I,c, M_I = m^ab H_I,ab, U_d = M_I a^d and
    V_d = N_I,d a_3:

        sum_d V_d (x) (U_d + (m : b) a^dc V_c) + U_d (x) V_d.
    """
    a, dual, normal = frames.tangents[p], frames.dual[p], frames.normal[p]
    gamma, b = frames.christoffel[p], frames.curvature[p]
    m, s = resultants.moment[p], resultants.stiffness[p]
    mb = m[0] * b[0] + m[1] * b[1] + 2.0 * m[2] * b[2]
    con11 = mb * (dual[0, 0] * dual[0, 0] + dual[0, 1] * dual[0, 1] + dual[0, 2] * dual[0, 2])
    con22 = mb * (dual[1, 0] * dual[1, 0] + dual[1, 1] * dual[1, 1] + dual[1, 2] * dual[1, 2])
    con12 = mb * (dual[0, 0] * dual[1, 0] + dual[0, 1] * dual[1, 1] + dual[0, 2] * dual[1, 2])
    for k in range(shapes.shape[1]):
        s1, s2 = shapes[0, k], shapes[1, k]
        h11 = shapes[2, k] - gamma[0, 0] * s1 - gamma[1, 0] * s2
        h22 = shapes[3, k] - gamma[0, 1] * s1 - gamma[1, 1] * s2
        h12 = 2.0 * (shapes[4, k] - gamma[0, 2] * s1 - gamma[1, 2] * s2)
        moment = m[0] * h11 + m[1] * h22 + m[2] * h12
        for x in range(3):
            i = 3 * k + x
            z = normal[x]
            e0, e1 = s1 * a[0, x], s2 * a[1, x]
            e2 = s1 * a[1, x] + s2 * a[0, x]
            k0, k1, k2 = -h11 * z, -h22 * z, -h12 * z
            v1, v2 = s1 * z, s2 * z
            u1, u2 = moment * dual[0, x], moment * dual[1, x]
            left[0, i], left[1, i], left[2, i] = e0, e1, e2
            left[3, i], left[4, i], left[5, i] = k0, k1, k2
            left[6, i], left[7, i], left[8, i], left[9, i] = v1, v2, u1, u2
            right[0, i] = w * (
                (s[0, 0] * e0 + s[0, 1] * e1 + s[0, 2] * e2)
                + (s[1, 0] * k0 + s[1, 1] * k1 + s[1, 2] * k2)
            )
            right[1, i] = w * (
                (s[0, 1] * e0 + s[0, 3] * e1 + s[0, 4] * e2)
                + (s[1, 1] * k0 + s[1, 3] * k1 + s[1, 4] * k2)
            )
            right[2, i] = w * (
                (s[0, 2] * e0 + s[0, 4] * e1 + s[0, 5] * e2)
                + (s[1, 2] * k0 + s[1, 4] * k1 + s[1, 5] * k2)
            )
            right[3, i] = w * (
                (s[1, 0] * e0 + s[1, 1] * e1 + s[1, 2] * e2)
                + (s[2, 0] * k0 + s[2, 1] * k1 + s[2, 2] * k2)
            )
            right[4, i] = w * (
                (s[1, 1] * e0 + s[1, 3] * e1 + s[1, 4] * e2)
                + (s[2, 1] * k0 + s[2, 3] * k1 + s[2, 4] * k2)
            )
            right[5, i] = w * (
                (s[1, 2] * e0 + s[1, 4] * e1 + s[1, 5] * e2)
                + (s[2, 2] * k0 + s[2, 4] * k1 + s[2, 5] * k2)
            )
            right[6, i] = w * (u1 + con11 * v1 + con12 * v2)
            right[7, i] = w * (u2 + con12 * v1 + con22 * v2)
            right[8, i], right[9, i] = w * v1, w * v2


@inlined
def _column(rows: Any, i: int) -> tuple[float, ...]:
    """One column of a (10, dof) array, as constants of the loop that uses them."""
    return (
        rows[0, i],
        rows[1, i],
        rows[2, i],
        rows[3, i],
        rows[4, i],
        rows[5, i],
        rows[6, i],
        rows[7, i],
        rows[8, i],
        rows[9, i],
    )


@inlined
def _add_node(left: Any, right: Any, i: int, element: Any) -> None:
    """Add rows i to i + 2 of sum_k left_k (x) right_k, from the diagonal on.

    Three rows at once, so that each entry of ``right`` is loaded for three products.
    """
    a, b, c = _column(left, i), _column(left, i + 1), _column(left, i + 2)
    for j in range(i, right.shape[1]):
        s0 = s1 = s2 = 0.0
        for k in range(10):
            s0 += a[k] * right[k, j]
            s1 += b[k] * right[k, j]
            s2 += c[k] * right[k, j]
        element[i, j] += s0
        element[i + 1, j] += s1
        element[i + 2, j] += s2


@kernel
def assemble_stiffness(
    basis: Basis, weights: Any, frames: Frames, resultants: Resultants, bands: Any
) -> None:
    """Add K_int (eq. 48) to ``bands`` (dof, half bandwidth + 1): ``bands[j, i - j] = K_ij``, i >= j."""
    q = basis.points
    rows, columns = basis.values1.shape[2], basis.values2.shape[2]
    grid2 = basis.values2.shape[0]
    local = rows * columns
    shapes = np.empty((5, local))
    left, right = np.empty((10, 3 * local)), np.empty((10, 3 * local))
    element = np.empty((3 * local, 3 * local))
    membrane = np.empty((local, local))
    for e1 in range(basis.first1.size):
        for e2 in range(basis.first2.size):
            element[:] = 0.0
            membrane[:] = 0.0
            for g1 in range(e1 * q, (e1 + 1) * q):
                for g2 in range(e2 * q, (e2 + 1) * q):
                    p = g1 * grid2 + g2
                    w, n = weights[p], resultants.force[p]
                    shape_derivatives(basis, g1, g2, shapes)
                    _rows(shapes, w, p, frames, resultants, left, right)
                    for i in range(local):
                        n1 = w * (n[0] * shapes[0, i] + n[2] * shapes[1, i])
                        n2 = w * (n[2] * shapes[0, i] + n[1] * shapes[1, i])
                        for j in range(local):
                            membrane[i, j] += n1 * shapes[0, j] + n2 * shapes[1, j]
                    for i in range(local):
                        _add_node(left, right, 3 * i, element)
            for i in range(local):
                for j in range(i, local):
                    for x in range(3):
                        element[3 * i + x, 3 * j + x] += membrane[i, j]
            corner = basis.first1[e1] * basis.columns + basis.first2[e2]
            for i in range(3 * local):
                ci = i // 3
                row = 3 * (corner + (ci // columns) * basis.columns + ci % columns) + i % 3
                for cj in range(ci, local):
                    column = 3 * (corner + (cj // columns) * basis.columns + cj % columns)
                    for x in range(3):
                        j = 3 * cj + x
                        if j >= i:
                            bands[row, column + x - row] += element[i, j]


@kernel
def assemble_mass(basis: Basis, weights: Any, density: float, bands: Any) -> None:
    """Add M = integral of rho N^T N (eq. 46) to ``bands``, laid out as the stiffness."""
    q = basis.points
    rows, columns = basis.values1.shape[2], basis.values2.shape[2]
    grid2 = basis.values2.shape[0]
    local = rows * columns
    shape = np.empty(local)
    for g1 in range(basis.values1.shape[0]):
        for g2 in range(grid2):
            w = density * weights[g1 * grid2 + g2]
            shape_values(basis, g1, g2, shape)
            corner = basis.first1[g1 // q] * basis.columns + basis.first2[g2 // q]
            for i in range(local):
                row = 3 * (corner + (i // columns) * basis.columns + i % columns)
                for j in range(i, local):
                    column = 3 * (corner + (j // columns) * basis.columns + j % columns)
                    value = w * shape[i] * shape[j]
                    for x in range(3):
                        bands[row + x, column - row] += value
