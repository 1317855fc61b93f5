"""Stress and tangent at one material point of a layer, compiled for its law.

Everything is written in the strain E_ab rather than in C_ab: invariants, and with them the stress,
are then exactly zero at rest and lose no digits at small strains.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

from stages.mechanics.materials.base import Material, law_of
from stages.mechanics.plane_stress import plane_gradient, plane_hessian
from stages.mechanics.tension_laws.base import TensionLaw, functions_of
from stages.numerics.compiled import inlined


class PlaneReference(NamedTuple):
    """Undeformed metric and fibres at a point: G^ab, 1/det G_ab, f0^a f0^b (eqs. 38-39)."""

    con11: float
    con22: float
    con12: float
    inverse_det: float
    ff11: float
    ff22: float
    ff12: float


class PlaneResponse(NamedTuple):
    """psi (kPa), S^ab (kPa) and the plane-stress tangent C^abcd (kPa) at a point (eqs. 36, 51)."""

    energy: float
    s11: float
    s22: float
    s12: float
    c1111: float
    c1122: float
    c1112: float
    c2222: float
    c2212: float
    c1212: float


def compile_point(material: Material, tension: TensionLaw) -> Callable[..., PlaneResponse]:
    """Compiled ``respond(e11, e22, e12, reference, activation, constants) -> PlaneResponse``.

    ``constants`` are those of the material and of the tension law (:func:`constants_of`). With F^ab = f0^a f0^b, cofactor K^ab and X^ab = dj/dC_ab = G^ab + K^ab:

        S^ab   = 2 ((w_t + w_j) G^ab + w_j K^ab + (w_q + sigma_a/(2 q)) F^ab)
        C^abcd = 4 (w_tt G G + w_tj (G X + X G) + ... + w_qq F F + w_j d2j/dC dC)
                 + (sigma_a'/(lambda_f q) - 2 sigma_a/q^2) F F

    ``energy`` is the passive one. A turned-over element (j <= 0) gives NaN.

    Parameters
    ----------
    material
        Passive law of the layer.
    tension
        Tension law of the layer.

    References
    ----------
    Torre et al., eqs. 36-39, 51, 89-93; Kiendl et al. (2015), eqs. 47-49 for the static condensation.
    """
    return _compile(type(material), type(tension))


def constants_of(material: Material, tension: TensionLaw) -> tuple[NamedTuple, NamedTuple]:
    """Parameters of both laws as a compiled point reads them."""
    return material.constants(), tension.constants()


@functools.cache
def _compile(material: type[Material], tension: type[TensionLaw]) -> Callable[..., PlaneResponse]:
    """One kernel per pair of laws and process; layers share it, whatever their parameters."""
    law = law_of(material)
    energy, gradient, hessian = inlined(law.energy), inlined(law.gradient), inlined(law.hessian)
    first, second, pull = (
        inlined(plane_gradient),
        inlined(plane_hessian),
        inlined(functions_of(tension).tension),
    )

    @inlined
    def respond(
        e11: float, e22: float, e12: float, ref: Any, activation: float, both: Any
    ) -> PlaneResponse:
        constants, pulling = both
        g11, g22, g12, h, f11, f22, f12 = ref
        trace = 2.0 * (g11 * e11 + g22 * e22 + 2.0 * g12 * e12)
        t = 2.0 + trace
        j = 1.0 + trace + 4.0 * h * (e11 * e22 - e12 * e12)
        q = 1.0 + 2.0 * (f11 * e11 + f22 * e22 + 2.0 * f12 * e12)
        j = j if j > 0.0 else float("nan")
        i1, i2 = t + 1.0 / j, t / j + j
        psi = energy(i1, i2, q, constants)
        slopes = gradient(i1, i2, q, constants)
        w_t, w_j, w_q = first(t, j, slopes[0], slopes[1], slopes[2])
        tt, tj, tq, jj, jq, qq = second(t, j, slopes, hessian(i1, i2, q, constants))
        stretch = q**0.5
        sigma, sigma_slope = pull(activation, stretch, pulling)

        k11, k22, k12 = 2.0 * h * e22, 2.0 * h * e11, -2.0 * h * e12
        x11, x22, x12 = g11 + k11, g22 + k22, g12 + k12
        metric, cofactor, fibre = 2.0 * (w_t + w_j), 2.0 * w_j, 2.0 * w_q + sigma / q
        s11 = metric * g11 + cofactor * k11 + fibre * f11
        s22 = metric * g22 + cofactor * k22 + fibre * f22
        s12 = metric * g12 + cofactor * k12 + fibre * f12

        tt, tj, tq, jj, jq = 4.0 * tt, 4.0 * tj, 4.0 * tq, 4.0 * jj, 4.0 * jq
        ff = 4.0 * qq + sigma_slope / (stretch * q) - 2.0 * sigma / q**2
        bend = 4.0 * w_j * h
        # rows of C: derivatives of S^ab along G^cd, X^cd and F^cd
        a11, b11, c11 = (
            tt * g11 + tj * x11 + tq * f11,
            tj * g11 + jj * x11 + jq * f11,
            tq * g11 + jq * x11 + ff * f11,
        )
        a22, b22, c22 = (
            tt * g22 + tj * x22 + tq * f22,
            tj * g22 + jj * x22 + jq * f22,
            tq * g22 + jq * x22 + ff * f22,
        )
        a12, b12, c12 = (
            tt * g12 + tj * x12 + tq * f12,
            tj * g12 + jj * x12 + jq * f12,
            tq * g12 + jq * x12 + ff * f12,
        )
        return PlaneResponse(
            psi,
            s11,
            s22,
            s12,
            a11 * g11 + b11 * x11 + c11 * f11,
            a11 * g22 + b11 * x22 + c11 * f22 + bend,
            a11 * g12 + b11 * x12 + c11 * f12,
            a22 * g22 + b22 * x22 + c22 * f22,
            a22 * g12 + b22 * x12 + c22 * f12,
            a12 * g12 + b12 * x12 + c12 * f12 - 0.5 * bend,
        )

    return respond
