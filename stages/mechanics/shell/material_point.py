"""Stress and tangent at one material point of a layer, compiled for its law.

Everything is written in the strain E_ab rather than in C_ab: the stress is then exactly zero at rest and
loses no digits at small strains.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

from stages.mechanics.materials.base import Material
from stages.mechanics.shell.plane_stress import Prepare, as_it_is, plane_law
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

    ``constants`` are those of the material and of the tension law (:func:`constants_of`). With
    F^ab = f0^a f0^b, the cofactor K^ab = d det/d(2 E_ab) and (trace, det, fibre) as in
    :mod:`~stages.mechanics.materials.base`:

        S^ab   = 2 w_t G^ab + 2 w_d K^ab + (2 w_f + sigma_a/lambda_f^2) F^ab
        C^abcd = 4 (w_tt G G + w_td (G K + K G) + ... + w_ff F F + w_d d2det/d(2E)d(2E))
                 + (sigma_a'/lambda_f^3 - 2 sigma_a/lambda_f^4) F F

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
    return _compiled(type(material), type(tension))


def plain_point(material: Material, tension: TensionLaw) -> Callable[..., PlaneResponse]:
    """The same function uncompiled: at once for a few points, in tests and reports."""
    return _point(type(material), type(tension), as_it_is)


def constants_of(material: Material, tension: TensionLaw) -> tuple[NamedTuple, NamedTuple]:
    """Parameters of both laws as a compiled point reads them."""
    return material.constants(), tension.constants()


@functools.cache
def _compiled(material: type[Material], tension: type[TensionLaw]) -> Callable[..., PlaneResponse]:
    """One kernel per pair of laws and process; layers share it, whatever their parameters."""
    return _point(material, tension, inlined)


def _point(
    material: type[Material], tension: type[TensionLaw], prepare: Prepare
) -> Callable[..., PlaneResponse]:
    law, pull = plane_law(material, prepare), prepare(functions_of(tension).tension)

    def respond(
        e11: float, e22: float, e12: float, ref: Any, activation: float, both: Any
    ) -> PlaneResponse:
        constants, pulling = both
        g11, g22, g12, h, f11, f22, f12 = ref
        trace = 2.0 * (g11 * e11 + g22 * e22 + 2.0 * g12 * e12)
        det = 4.0 * h * (e11 * e22 - e12 * e12)
        fibre = 2.0 * (f11 * e11 + f22 * e22 + 2.0 * f12 * e12)
        trace = trace if 1.0 + trace + det > 0.0 else float("nan")
        psi, gradient, hessian = law(trace, det, fibre, constants)
        w_t, w_d, w_f = gradient
        tt, td, tf, dd, df, ff = hessian
        stretch = (1.0 + fibre) ** 0.5
        shrink = 1.0 / (1.0 + fibre)
        sigma, sigma_slope = pull(activation, stretch, pulling)

        k11, k22, k12 = 2.0 * h * e22, 2.0 * h * e11, -2.0 * h * e12
        metric, cofactor, along = 2.0 * w_t, 2.0 * w_d, 2.0 * w_f + sigma * shrink
        s11 = metric * g11 + cofactor * k11 + along * f11
        s22 = metric * g22 + cofactor * k22 + along * f22
        s12 = metric * g12 + cofactor * k12 + along * f12

        tt, td, tf, dd, df = 4.0 * tt, 4.0 * td, 4.0 * tf, 4.0 * dd, 4.0 * df
        ff = 4.0 * ff + (sigma_slope / stretch - 2.0 * sigma * shrink) * shrink
        bend = 4.0 * w_d * h
        # rows of C: derivatives of S^ab along G^cd, K^cd and F^cd
        a11, b11, c11 = (
            tt * g11 + td * k11 + tf * f11,
            td * g11 + dd * k11 + df * f11,
            tf * g11 + df * k11 + ff * f11,
        )
        a22, b22, c22 = (
            tt * g22 + td * k22 + tf * f22,
            td * g22 + dd * k22 + df * f22,
            tf * g22 + df * k22 + ff * f22,
        )
        a12, b12, c12 = (
            tt * g12 + td * k12 + tf * f12,
            td * g12 + dd * k12 + df * f12,
            tf * g12 + df * k12 + ff * f12,
        )
        return PlaneResponse(
            psi,
            s11,
            s22,
            s12,
            a11 * g11 + b11 * k11 + c11 * f11,
            a11 * g22 + b11 * k22 + c11 * f22 + bend,
            a11 * g12 + b11 * k12 + c11 * f12,
            a22 * g22 + b22 * k22 + c22 * f22,
            a22 * g12 + b22 * k12 + c22 * f12,
            a12 * g12 + b12 * k12 + c12 * f12 - 0.5 * bend,
        )

    return prepare(respond)
