"""Every law as a plane-stress law w(trace, det, fibre) (eqs. 89-90; Kiendl et al., 2015).

For an incompressible solid C_33 = 1/j with j = det C_ab/det G_ab, so w = psi(I1, I2, I4) at

    I1 - 3 = (trace (j - 1) - det)/j,    I2 - 3 = ((j - 1)^2 - det)/j,    I4 - 1 = fibre.

These are I1 = t + 1/j and I2 = t/j + j with the ones and twos taken out by hand: they and their
derivatives along ``trace`` vanish at rest exactly, and keep all digits at small strains.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, TypeAlias

from stages.mechanics.materials.base import Gradient, Hessian, Incompressible, Material, law_of

PlaneDerivatives: TypeAlias = tuple[float, Gradient, Hessian]
"""w and its derivatives with respect to (trace, det, fibre), kPa."""

PlaneLaw: TypeAlias = Callable[[float, float, float, Any], PlaneDerivatives]

Prepare: TypeAlias = Callable[[Any], Any]
"""What is done to each function before others call it: nothing, or compilation."""


def as_it_is(function: Any) -> Any:
    """Leave a function in plain Python."""
    return function


def plane_law(material: type[Material], prepare: Prepare = as_it_is) -> PlaneLaw:
    """The function ``(trace, det, fibre, constants) -> (w, gradient, hessian)`` of a material.

    Examples
    --------
    >>> from stages.mechanics.materials.neo_hookean import Constants, NeoHookean
    >>> w, (slope, *_), _ = plane_law(NeoHookean)(0.0, 0.0, 0.0, Constants(500.0))
    >>> w, slope  # at rest
    (0.0, 0.0)
    """
    law: Any = law_of(material)
    parts = (prepare(part) for part in (law.energy, law.gradient, law.hessian))
    combine = _incompressible if issubclass(material, Incompressible) else _given
    made: PlaneLaw = prepare(combine(*parts))
    return made


def thickness_stretch(material: Material, trace: float, det: float, fibre: float) -> float:
    """lambda_3: 1/sqrt(j) for an incompressible solid, else what the law says."""
    if isinstance(material, Incompressible):
        return float((1.0 + trace + det) ** -0.5)
    law: Any = law_of(type(material))
    return float(law.thickness_stretch(trace, det, fibre, material.constants()))


def _given(energy: Any, gradient: Any, hessian: Any) -> PlaneLaw:
    def evaluate(trace: float, det: float, fibre: float, p: NamedTuple) -> PlaneDerivatives:
        return (
            energy(trace, det, fibre, p),
            gradient(trace, det, fibre, p),
            hessian(trace, det, fibre, p),
        )

    return evaluate


def _incompressible(energy: Any, gradient: Any, hessian: Any) -> PlaneLaw:
    """Chain rule from (I1, I2, I4) to (trace, det, fibre)."""

    def evaluate(trace: float, det: float, fibre: float, p: NamedTuple) -> PlaneDerivatives:
        y = trace + det
        j = 1.0 + y
        n = 1.0 / j
        n2, n3 = n * n, n * n * n
        x1, x2 = (trace * y - det) * n, (y * y - det) * n
        p1, p2, p4 = gradient(x1, x2, fibre, p)
        p11, p12, p14, p22, p24, p44 = hessian(x1, x2, fibre, p)
        grown = y * (2.0 + y)  # j^2 - 1
        i1_t, i1_d = grown * n2, -n2
        i2_t, i2_d = (det + grown) * n2, (grown - 1.0 - trace) * n2
        bent = 2.0 * p1 * n3  # I1 has one and the same second derivative for all pairs
        tt = p11 * i1_t * i1_t + 2.0 * p12 * i1_t * i2_t + p22 * i2_t * i2_t
        td = p11 * i1_t * i1_d + p12 * (i1_t * i2_d + i2_t * i1_d) + p22 * i2_t * i2_d
        dd = p11 * i1_d * i1_d + 2.0 * p12 * i1_d * i2_d + p22 * i2_d * i2_d
        return (
            energy(x1, x2, fibre, p),
            (p1 * i1_t + p2 * i2_t, p1 * i1_d + p2 * i2_d, p4),
            (
                tt + bent + 2.0 * p2 * (1.0 - det) * n3,
                td + bent + p2 * (3.0 + trace - det) * n3,
                p14 * i1_t + p24 * i2_t,
                dd + bent + 2.0 * p2 * (2.0 + trace) * n3,
                p14 * i1_d + p24 * i2_d,
                p44,
            ),
        )

    return evaluate
