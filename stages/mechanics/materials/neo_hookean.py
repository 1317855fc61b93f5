"""Incompressible Neo-Hookean solid (eqs. 88-89): the PDMS substrate."""

from __future__ import annotations

from typing import Literal, NamedTuple

from stages.configuration import quantity
from stages.mechanics.materials.base import Gradient, Hessian, Incompressible


class Constants(NamedTuple):
    """Parameters in the order of Table 1."""

    mu: float


class NeoHookean(Incompressible):
    """Parameters of eq. 88."""

    name: Literal["neo-hookean"] = "neo-hookean"
    shear_modulus: float = quantity("kPa", "shear modulus mu", "Table 1", gt=0)

    def constants(self) -> Constants:
        """Parameters as the law reads them."""
        return Constants(self.shear_modulus)


def energy(x1: float, x2: float, x4: float, p: Constants) -> float:
    """psi = mu/2 (I1 - 3), kPa (eq. 88).

    Examples
    --------
    >>> energy(2.0**2 + 2 / 2.0 - 3.0, 0.0, 0.0, Constants(500.0))  # uniaxial stretch 2
    500.0
    """
    return 0.5 * p.mu * x1


def gradient(x1: float, x2: float, x4: float, p: Constants) -> Gradient:
    """psi_1 = mu/2."""
    return 0.5 * p.mu, 0.0, 0.0


def hessian(x1: float, x2: float, x4: float, p: Constants) -> Hessian:
    """All zero: the energy is linear in I1."""
    return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0


MODEL = NeoHookean
