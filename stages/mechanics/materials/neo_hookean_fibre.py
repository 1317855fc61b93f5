"""Neo-Hookean solid with an exponential stiffening along the fibres (eqs. 88-93): the muscle."""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

from stages.configuration import quantity
from stages.mechanics.materials.base import Gradient, Hessian, Incompressible
from stages.numerics.elementary import expm1


class Constants(NamedTuple):
    """Parameters in the order of Table 1."""

    mu: float
    e_p: float
    a: float


class NeoHookeanFibre(Incompressible):
    """Parameters of eqs. 88 and 91."""

    name: Literal["neo-hookean-fibre"] = "neo-hookean-fibre"
    shear_modulus: float = quantity("kPa", "shear modulus mu", "Table 1", gt=0)
    fibre_stiffness: float = quantity("kPa", "passive fibre stiffness E_p", "Table 1", ge=0)
    fibre_exponent: float = quantity("", "stiffening of the fibres a", "Table 1", gt=0)

    def constants(self) -> Constants:
        """Parameters as the law reads them."""
        return Constants(self.shear_modulus, self.fibre_stiffness, self.fibre_exponent)


def energy(x1: float, x2: float, x4: float, p: Constants) -> float:
    """psi = mu/2 (I1 - 3) + E_p/a^2 (exp(a (l - 1)) - a (l - 1) - 1), l = sqrt(I4), kPa (eq. 91).

    The elongation l - 1 = (I4 - 1)/(l + 1) keeps its digits when it is small.
    """
    x = p.a * x4 / (math.sqrt(1.0 + x4) + 1.0)
    return 0.5 * p.mu * x1 + p.e_p / p.a**2 * (expm1(x) - x)


def gradient(x1: float, x2: float, x4: float, p: Constants) -> Gradient:
    """psi_1 = mu/2; psi_4 = E_p/(2 a l) (exp(a (l - 1)) - 1), half the factor of eq. 92.

    Examples
    --------
    >>> p = Constants(0.767, 21.0, 5.5)
    >>> gradient(0.0, 0.0, 0.0, p)
    (0.3835, 0.0, 0.0)
    >>> round(2 * gradient(0.0, 0.0, 1.1**2 - 1, p)[2], 6)  # 21/(5.5 * 1.1) (e^0.55 - 1)
    2.545176
    """
    stretch = math.sqrt(1.0 + x4)
    grown = expm1(p.a * x4 / (stretch + 1.0))
    return 0.5 * p.mu, 0.0, 0.5 * (p.e_p / (p.a * stretch) * grown)


def hessian(x1: float, x2: float, x4: float, p: Constants) -> Hessian:
    """psi_44 = (E_p exp(a (l - 1)) - 2 psi_4) / (4 l^2), from d/dI4 = 1/(2 l) d/dl."""
    stretch = math.sqrt(1.0 + x4)
    grown = expm1(p.a * x4 / (stretch + 1.0))
    slope = p.e_p / (p.a * stretch) * grown
    return 0.0, 0.0, 0.0, 0.0, 0.0, 0.25 / (1.0 + x4) * (p.e_p * (grown + 1.0) - slope)


MODEL = NeoHookeanFibre
