"""St. Venant-Kirchhoff solid: Hooke's law for large rotations, compressible.

With lambda = E nu/((1 + nu) (1 - 2 nu)) and mu = E/(2 (1 + nu)), S = lambda tr(E) I + 2 mu E. The film's
faces are free, S^33 = 0, so E_33 = -lambda/(lambda + 2 mu) tr(E) with the trace in the plane, which leaves
the plane modulus 2 lambda mu/(lambda + 2 mu) = E nu/(1 - nu^2) in place of lambda. In the plane
tr(E) = trace/2 and tr(E^2) = (trace^2 - 2 det)/4. For small strains and large rotations only: squeezed to
about 58 % of its length it gives way, as the law does in one dimension.
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

from stages.configuration import quantity
from stages.mechanics.materials.base import Gradient, Hessian, PlaneStress


class Constants(NamedTuple):
    """Plane modulus and shear modulus, kPa, and the ratio lambda/(lambda + 2 mu)."""

    plane: float
    mu: float
    ratio: float


class StVenantKirchhoff(PlaneStress):
    """Young's modulus and Poisson's ratio."""

    name: Literal["st-venant-kirchhoff"] = "st-venant-kirchhoff"
    young_modulus: float = quantity("kPa", "Young's modulus E", "linear elasticity", gt=0)
    poisson_ratio: float = quantity("", "Poisson's ratio nu", "linear elasticity", gt=-1, lt=0.5)

    def constants(self) -> Constants:
        """Parameters as the law reads them."""
        young, nu = self.young_modulus, self.poisson_ratio
        return Constants(young * nu / (1.0 - nu**2), 0.5 * young / (1.0 + nu), nu / (1.0 - nu))


def energy(trace: float, det: float, fibre: float, p: Constants) -> float:
    """w = plane/2 tr(E)^2 + mu tr(E^2), kPa.

    Examples
    --------
    >>> energy(0.002, 0.0, 0.0, Constants(0.0, 500.0, 0.0))  # E_11 = 0.001 alone: 1000/2 * 1e-6
    0.0005
    """
    return 0.125 * p.plane * trace * trace + 0.25 * p.mu * (trace * trace - 2.0 * det)


def gradient(trace: float, det: float, fibre: float, p: Constants) -> Gradient:
    """w_trace = (plane + 2 mu) trace/4, w_det = -mu/2."""
    return (0.25 * p.plane + 0.5 * p.mu) * trace, -0.5 * p.mu, 0.0


def hessian(trace: float, det: float, fibre: float, p: Constants) -> Hessian:
    """Constant: w_trace,trace = (plane + 2 mu)/4."""
    return 0.25 * p.plane + 0.5 * p.mu, 0.0, 0.0, 0.0, 0.0, 0.0


def thickness_stretch(trace: float, det: float, fibre: float, p: Constants) -> float:
    """lambda_3 = sqrt(1 + 2 E_33) with E_33 = -lambda/(lambda + 2 mu) trace/2; NaN if none is left.

    Examples
    --------
    >>> thickness_stretch(0.36, 0.0, 0.0, Constants(1.0, 1.0, 1.0))
    0.8
    """
    square = 1.0 - p.ratio * trace
    return math.sqrt(square) if square > 0.0 else math.nan


MODEL = StVenantKirchhoff
