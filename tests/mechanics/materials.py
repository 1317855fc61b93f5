"""Every material file of the project with parameters to test it on, and one law that is nobody's."""

from __future__ import annotations

from typing import NamedTuple

from stages.configuration import OneOf
from stages.mechanics.materials.base import Gradient, Hessian, Material
from stages.mechanics.materials.neo_hookean import NeoHookean
from stages.mechanics.materials.neo_hookean_fibre import NeoHookeanFibre

NAMES = OneOf("stages.mechanics.materials", Material).names()

EXAMPLES: dict[str, Material] = {
    "neo-hookean": NeoHookean(density=0.965, shear_modulus=500.0),
    "neo-hookean-fibre": NeoHookeanFibre(
        density=0.965, shear_modulus=0.767, fibre_stiffness=21.0, fibre_exponent=5.5
    ),
}
"""Parameters for the tests, by the material's name; a new file needs a line here (Table 1 so far)."""


def example(name: str) -> Material:
    """A material by its name, with parameters."""
    if name not in EXAMPLES:
        raise LookupError(
            f"material {name!r} has no parameters to be tested with: add them to EXAMPLES in "
            f"tests/mechanics/materials.py"
        )
    return EXAMPLES[name]


class Constants(NamedTuple):
    """Coefficients of the mixed law, kPa."""

    a: float
    b: float


class Mixed(Material):
    """A law in which all three invariants meet; no material file needs psi_2 and psi_14 yet."""

    name: str = "mixed"
    a: float = 300.0
    b: float = 80.0

    def constants(self) -> Constants:
        return Constants(self.a, self.b)


def energy(i1: float, i2: float, i4: float, p: Constants) -> float:
    """psi = a (x + y/2 + x y + x^2 q) + b (q^2 + x q^2 + y q^2), x = I1 - 3, y = I2 - 3, q = I4 - 1."""
    x, y, q = i1 - 3.0, i2 - 3.0, i4 - 1.0
    return p.a * (x + 0.5 * y + x * y + x * x * q) + p.b * (1.0 + x + y) * q * q


def gradient(i1: float, i2: float, i4: float, p: Constants) -> Gradient:
    x, y, q = i1 - 3.0, i2 - 3.0, i4 - 1.0
    return (
        p.a * (1.0 + y + 2.0 * x * q) + p.b * q * q,
        p.a * (0.5 + x) + p.b * q * q,
        p.a * x * x + 2.0 * p.b * (1.0 + x + y) * q,
    )


def hessian(i1: float, i2: float, i4: float, p: Constants) -> Hessian:
    x, y, q = i1 - 3.0, i2 - 3.0, i4 - 1.0
    return (
        2.0 * p.a * q,
        p.a,
        2.0 * p.a * x + 2.0 * p.b * q,
        0.0,
        2.0 * p.b * q,
        2.0 * p.b * (1.0 + x + y),
    )


MODEL = Mixed
