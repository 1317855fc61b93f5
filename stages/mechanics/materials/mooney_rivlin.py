"""Incompressible Mooney-Rivlin solid (Mooney, 1940; Rivlin, 1948): rubber at moderate stretches."""

from __future__ import annotations

from typing import Literal, NamedTuple

from stages.configuration import quantity
from stages.mechanics.materials.base import Gradient, Hessian, Incompressible


class Constants(NamedTuple):
    """Parameters as in the equation."""

    c_1: float
    c_2: float


class MooneyRivlin(Incompressible):
    """Parameters of psi = c_1 (I1 - 3) + c_2 (I2 - 3); the shear modulus at rest is 2 (c_1 + c_2)."""

    name: Literal["mooney-rivlin"] = "mooney-rivlin"
    c_1: float = quantity("kPa", "coefficient of I1 - 3", "Rivlin (1948)", gt=0)
    c_2: float = quantity("kPa", "coefficient of I2 - 3", "Rivlin (1948)", ge=0)

    def constants(self) -> Constants:
        """Parameters as the law reads them."""
        return Constants(self.c_1, self.c_2)


def energy(x1: float, x2: float, x4: float, p: Constants) -> float:
    """psi = c_1 (I1 - 3) + c_2 (I2 - 3), kPa.

    Examples
    --------
    >>> energy(2.0, 1.25, 0.0, Constants(200.0, 40.0))  # uniaxial stretch 2: I1 = 5, I2 = 4.25
    450.0
    """
    return p.c_1 * x1 + p.c_2 * x2


def gradient(x1: float, x2: float, x4: float, p: Constants) -> Gradient:
    """psi_1 = c_1, psi_2 = c_2."""
    return p.c_1, p.c_2, 0.0


def hessian(x1: float, x2: float, x4: float, p: Constants) -> Hessian:
    """All zero: the energy is linear in I1 and I2."""
    return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0


MODEL = MooneyRivlin
