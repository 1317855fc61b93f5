"""Incompressible plane stress, eliminated once for every law (eqs. 89-90; Kiendl et al., 2015).

A film strains in its plane only: with E_ab, and C_33 = J0^-2 by incompressibility, every isotropic or
one-fibre energy is a function w(t, j, q) of three plane invariants

    t = G^ab C_ab,    j = J0^2 = det C_ab / det G_ab,    q = f0^a C_ab f0^b = lambda_f^2,

namely w = psi(I1, I2, I4) at I1 = t + 1/j, I2 = t/j + j, I4 = q. The functions here turn the
derivatives of psi into those of w, and these into S^ab and C^abcd.
"""

from __future__ import annotations

from typing import TypeAlias

PlaneGradient: TypeAlias = tuple[float, float, float]
"""(w_t, w_j, w_q)."""

PlaneHessian: TypeAlias = tuple[float, float, float, float, float, float]
"""(w_tt, w_tj, w_tq, w_jj, w_jq, w_qq)."""


def plane_gradient(t: float, j: float, p1: float, p2: float, p4: float) -> PlaneGradient:
    """Chain rule for the first derivatives, from (psi_1, psi_2, psi_4).

    Examples
    --------
    >>> plane_gradient(2.0, 1.0, 250.0, 0.0, 0.0)  # at rest w_t + w_j = 0: no stress
    (250.0, -250.0, 0.0)
    """
    return p1 + p2 / j, -p1 / j**2 + p2 * (1.0 - t / j**2), p4


def plane_hessian(
    t: float,
    j: float,
    gradient: tuple[float, float, float],
    hessian: tuple[float, float, float, float, float, float],
) -> PlaneHessian:
    """Chain rule for the second derivatives, from those of psi with respect to (I1, I2, I4)."""
    p1, p2, _ = gradient
    p11, p12, p14, p22, p24, p44 = hessian
    inverse = 1.0 / j
    i1_j = -(inverse**2)
    i2_t = inverse
    i2_j = 1.0 + t * i1_j
    tt = p11 + 2.0 * p12 * i2_t + p22 * i2_t**2
    tj = p11 * i1_j + p12 * (i2_j + i2_t * i1_j) + p22 * i2_t * i2_j + p2 * i1_j
    tq = p14 + p24 * i2_t
    jj = p11 * i1_j**2 + 2.0 * p12 * i1_j * i2_j + p22 * i2_j**2 + 2.0 * inverse**3 * (p1 + p2 * t)
    jq = p14 * i1_j + p24 * i2_j
    return tt, tj, tq, jj, jq, p44
