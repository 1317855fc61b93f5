"""Every material file of the project with parameters to test it on, and one law that is nobody's."""

from __future__ import annotations

from typing import NamedTuple

from stages.configuration import OneOf
from stages.mechanics.materials.base import Gradient, Hessian, Incompressible, Material
from stages.mechanics.materials.holzapfel_ogden import HolzapfelOgden
from stages.mechanics.materials.mooney_rivlin import MooneyRivlin
from stages.mechanics.materials.neo_hookean import NeoHookean
from stages.mechanics.materials.neo_hookean_fibre import NeoHookeanFibre
from stages.mechanics.materials.st_venant_kirchhoff import StVenantKirchhoff
from tests.mechanics import plane_material

NAMES = OneOf("stages.mechanics.materials", Material).names()

EXAMPLES: dict[str, Material] = {
    "neo-hookean": NeoHookean(density=0.965, shear_modulus=500.0),  # Table 1
    "neo-hookean-fibre": NeoHookeanFibre(  # Table 1
        density=0.965, shear_modulus=0.767, fibre_stiffness=21.0, fibre_exponent=5.5
    ),
    "mooney-rivlin": MooneyRivlin(density=1.1, c_1=200.0, c_2=50.0),
    "holzapfel-ogden": HolzapfelOgden(  # Holzapfel and Ogden (2009)
        density=1.05,
        matrix_stiffness=0.059,
        matrix_exponent=8.023,
        fibre_stiffness=18.472,
        fibre_exponent=16.026,
    ),
    "st-venant-kirchhoff": StVenantKirchhoff(density=1.2, young_modulus=1500.0, poisson_ratio=0.3),
}
"""Parameters for the tests, by the material's name; a new file needs a line here."""


def example(name: str) -> Material:
    """A material by its name, with parameters."""
    if name not in EXAMPLES:
        raise LookupError(
            f"material {name!r} has no parameters to be tested with: add them to EXAMPLES in "
            f"tests/mechanics/materials.py"
        )
    return EXAMPLES[name]


def every() -> dict[str, Material]:
    """All of the project, and two laws in which all three arguments meet."""
    mixed = {"mixed": Mixed(density=1.0), "mixed-plane": plane_material.MixedPlane(density=1.0)}
    return {name: example(name) for name in NAMES} | mixed


class Constants(NamedTuple):
    """Coefficients of the mixed law, kPa."""

    a: float
    b: float


class Mixed(Incompressible):
    """A law in which all three invariants meet; no material file needs psi_12 and psi_14 yet."""

    name: str = "mixed"
    a: float = 300.0
    b: float = 80.0

    def constants(self) -> Constants:
        return Constants(self.a, self.b)


def energy(x: float, y: float, q: float, p: Constants) -> float:
    """psi = a (x + y/2 + x y + x^2 q) + b (q^2 + x q^2 + y q^2), x = I1 - 3, y = I2 - 3, q = I4 - 1."""
    return p.a * (x + 0.5 * y + x * y + x * x * q) + p.b * (1.0 + x + y) * q * q


def gradient(x: float, y: float, q: float, p: Constants) -> Gradient:
    return (
        p.a * (1.0 + y + 2.0 * x * q) + p.b * q * q,
        p.a * (0.5 + x) + p.b * q * q,
        p.a * x * x + 2.0 * p.b * (1.0 + x + y) * q,
    )


def hessian(x: float, y: float, q: float, p: Constants) -> Hessian:
    return (
        2.0 * p.a * q,
        p.a,
        2.0 * p.a * x + 2.0 * p.b * q,
        0.0,
        2.0 * p.b * q,
        2.0 * p.b * (1.0 + x + y),
    )


MODEL = Mixed
