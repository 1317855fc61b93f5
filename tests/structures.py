"""Small structures with exact load paths: snap-through, snap-back, bifurcation.

Each is R(x, load) = 0 with its tangent and its load rate dR/dload, as the continuation wants it, and
carries its exact path.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.newton import Linearisation
from stages.numerics.sparse import SingularMatrixError


def dense_linearisation(residual: Array, tangent: Array) -> Linearisation:
    """Linearisation with a dense tangent that counts its negative eigenvalues."""

    def solve(b: Array) -> Array:
        try:
            return np.linalg.solve(tangent, b)
        except np.linalg.LinAlgError as error:
            raise SingularMatrixError(str(error)) from None

    return Linearisation(
        residual,
        solve,
        float(np.abs(np.diagonal(tangent)).max()),
        lambda: int((np.linalg.eigvalsh(tangent) < 0.0).sum()),
    )


@dataclass(frozen=True)
class ShallowTruss:
    """Von Mises truss: two bars of stiffness EA and half span 1 meet at height ``rise``.

    The apex goes down by w; with z = rise - w and l^2 = 1 + rise^2, Green's strain of a bar is
    (z^2 - rise^2)/(2 l^2), and the load is P = EA/l^3 (rise^2 - z^2) z. It has its extrema at
    z = +-rise/sqrt(3).
    """

    rise: float = 0.2
    stiffness: float = 1.0

    @property
    def factor(self) -> float:
        return self.stiffness / (1.0 + self.rise**2) ** 1.5

    def load(self, w: Array | float) -> Array:
        z = self.rise - np.asarray(w)
        return self.factor * (self.rise**2 - z**2) * z

    @property
    def limit_load(self) -> float:
        return float(2.0 * self.factor * (self.rise / np.sqrt(3.0)) ** 3)

    @property
    def limit_displacements(self) -> tuple[float, float]:
        half = self.rise / np.sqrt(3.0)
        return self.rise - half, self.rise + half

    def slope(self, w: float) -> float:
        z = self.rise - w
        return self.factor * (3.0 * z**2 - self.rise**2)

    def linearise(self, x: Array, load: float) -> Linearisation:
        return dense_linearisation(
            np.array([float(self.load(x[0])) - load]), np.array([[self.slope(x[0])]])
        )

    def rate(self, x: Array, load: float) -> Array:
        return np.array([-1.0])

    def admissible(self, x: Array, load: float) -> Array:
        return x


@dataclass(frozen=True)
class SprungTruss:
    """The same truss loaded through a spring: v = w + P(w)/k, which turns back if k < EA rise^2/l^3.

    Unknowns: apex displacement w and displacement v of the spring's loaded end.
    """

    truss: ShallowTruss = ShallowTruss()
    spring: float = 0.01

    def end(self, w: Array | float) -> Array:
        return np.asarray(w) + self.truss.load(w) / self.spring

    def linearise(self, x: Array, load: float) -> Linearisation:
        w, v = x
        pull = self.spring * (v - w)
        tangent = self.spring * np.array([[1.0, -1.0], [-1.0, 1.0]])
        tangent[0, 0] += self.truss.slope(w)
        return dense_linearisation(
            np.array([float(self.truss.load(w)) - pull, pull - load]), tangent
        )

    def rate(self, x: Array, load: float) -> Array:
        return np.array([0.0, -1.0])

    def admissible(self, x: Array, load: float) -> Array:
        return x


@dataclass(frozen=True)
class HingedColumn:
    """Rigid bar of length 1 on a rotational spring of stiffness 1, pressed down: a stable pitchfork.

    Unknowns: angle and shortening of an axial spring of stiffness ``axial`` under the bar. With
    the spring relaxed at ``tilt``, balance is angle - tilt = P sin(angle). Without tilt the straight bar
    bifurcates at P = 1 into P = angle/sin(angle).
    """

    tilt: float = 0.0
    axial: float = 10.0

    def load(self, angle: Array | float) -> Array:
        angle = np.asarray(angle)
        return (angle - self.tilt) / np.sin(angle)

    def linearise(self, x: Array, load: float) -> Linearisation:
        angle, short = x
        residual = np.array([angle - self.tilt - load * np.sin(angle), self.axial * short - load])
        tangent = np.diag([1.0 - load * np.cos(angle), self.axial])
        return dense_linearisation(residual, tangent)

    def rate(self, x: Array, load: float) -> Array:
        return np.array([-np.sin(x[0]), -1.0])

    def admissible(self, x: Array, load: float) -> Array:
        return x
