"""Passive heart muscle (Holzapfel & Ogden, 2009), reduced to one fibre family.

    psi = a/(2 b) (exp(b (I1 - 3)) - 1) + a_f/(2 b_f) (exp(b_f (I4 - 1)^2) - 1) where I4 > 1.

Fibres carry tension only: where they are shortened, their part is zero, and so is its stress at I4 = 1; its
stiffness jumps there. The full law has two more parts, of the sheets and of the shear between fibres and
sheets. A film of cultured muscle has one family in its plane and no sheets, so these are left out, which
makes the law transversely isotropic. The matrix is incompressible, and the free faces of the film determine
C_33 = 1/j, so I1 = t + 1/j holds the thickness strain; I4 lies in the plane.

References
----------
Holzapfel and Ogden (2009), Constitutive modelling of passive myocardium: a structurally based framework
for material characterization, Phil. Trans. R. Soc. A 367, 3445-3475. Their fit to the shear tests of Dokos
et al. (2002) is a = 0.059 kPa, b = 8.023, a_f = 18.472 kPa, b_f = 16.026, as open codes quote it (for instance
the defaults of FEniCS pulse); the paper itself was not at hand.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from stages.configuration import quantity
from stages.mechanics.materials.base import Gradient, Hessian, Incompressible
from stages.numerics.elementary import exp, expm1

SOURCE = "Holzapfel & Ogden (2009)"


class Constants(NamedTuple):
    """Parameters in the order of the equation."""

    a: float
    b: float
    a_f: float
    b_f: float


class HolzapfelOgden(Incompressible):
    """Parameters of the two exponentials; the shear modulus at rest is a."""

    name: Literal["holzapfel-ogden"] = "holzapfel-ogden"
    matrix_stiffness: float = quantity("kPa", "stiffness a of the matrix", SOURCE, gt=0)
    matrix_exponent: float = quantity("", "stiffening b of the matrix", SOURCE, gt=0)
    fibre_stiffness: float = quantity("kPa", "stiffness a_f of the fibres", SOURCE, ge=0)
    fibre_exponent: float = quantity("", "stiffening b_f of the fibres", SOURCE, gt=0)

    def constants(self) -> Constants:
        """Parameters as the law reads them."""
        return Constants(
            self.matrix_stiffness, self.matrix_exponent, self.fibre_stiffness, self.fibre_exponent
        )


def energy(x1: float, x2: float, x4: float, p: Constants) -> float:
    """psi, kPa.

    Examples
    --------
    >>> p = Constants(0.059, 8.023, 18.472, 16.026)
    >>> energy(0.0, 0.0, -0.1, p)  # fibres shortened
    0.0
    >>> round(energy(0.0, 0.0, 0.1, p), 6)  # 18.472/32.052 (e^0.16026 - 1)
    0.100173
    """
    pulled = x4 if x4 > 0.0 else 0.0
    matrix = 0.5 * p.a / p.b * expm1(p.b * x1)
    return matrix + 0.5 * p.a_f / p.b_f * expm1(p.b_f * pulled * pulled)


def gradient(x1: float, x2: float, x4: float, p: Constants) -> Gradient:
    """psi_1 = a/2 exp(b (I1 - 3)); psi_4 = a_f (I4 - 1) exp(b_f (I4 - 1)^2) where I4 > 1."""
    pulled = x4 if x4 > 0.0 else 0.0
    return 0.5 * p.a * exp(p.b * x1), 0.0, p.a_f * pulled * exp(p.b_f * pulled * pulled)


def hessian(x1: float, x2: float, x4: float, p: Constants) -> Hessian:
    """psi_11 = a b/2 exp(b (I1 - 3)); psi_44 = a_f (1 + 2 b_f (I4 - 1)^2) exp(...) where I4 > 1."""
    square = p.b_f * x4 * x4
    along = p.a_f * (1.0 + 2.0 * square) * exp(square) if x4 > 0.0 else 0.0
    return 0.5 * p.a * p.b * exp(p.b * x1), 0.0, 0.0, 0.0, 0.0, along


MODEL = HolzapfelOgden
