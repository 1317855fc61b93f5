"""A plane-stress law in which all three arguments meet; no material file needs all derivatives yet."""

from __future__ import annotations

from typing import NamedTuple

from stages.mechanics.materials.base import Gradient, Hessian, PlaneStress


class Constants(NamedTuple):
    """Coefficient, kPa."""

    a: float


class MixedPlane(PlaneStress):
    """w = a (t^2 - d/2 + t d f + d^2 f + t f^2 + f^2)."""

    name: str = "mixed-plane"
    a: float = 120.0

    def constants(self) -> Constants:
        return Constants(self.a)


def energy(t: float, d: float, f: float, p: Constants) -> float:
    return p.a * (t * t - 0.5 * d + t * d * f + d * d * f + t * f * f + f * f)


def gradient(t: float, d: float, f: float, p: Constants) -> Gradient:
    return (
        p.a * (2.0 * t + d * f + f * f),
        p.a * (-0.5 + t * f + 2.0 * d * f),
        p.a * (t * d + d * d + 2.0 * t * f + 2.0 * f),
    )


def hessian(t: float, d: float, f: float, p: Constants) -> Hessian:
    return (
        2.0 * p.a,
        p.a * f,
        p.a * (d + 2.0 * f),
        p.a * 2.0 * f,
        p.a * (t + 2.0 * d),
        p.a * (2.0 * t + 2.0),
    )


def thickness_stretch(t: float, d: float, f: float, p: Constants) -> float:
    return 1.0


MODEL = MixedPlane
