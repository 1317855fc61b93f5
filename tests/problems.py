"""Problems that carry their exact solution."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stages.numerics.bsplines import Array, SplineSpace
from stages.numerics.patches import Patch


@dataclass(frozen=True)
class CubicFront:
    """Travelling front of dv/dt = D v'' - k v (v - a)(v - 1) on the line, v from 1 to 0.

    v = 1 / (1 + exp((x - x0 - c t) / l)) with l = sqrt(2 D / k), c = sqrt(k D / 2) (1 - 2 a); the
    logistic curve is (1 - tanh) / 2 of half the argument. With the paper's numbers, k = k_v / r_t and
    D = 0.002 mm^2/ms, c = 0.017432 mm/ms.
    """

    diffusivity: float = 0.002
    rate: float = 8.0 / 12.9
    threshold: float = 0.15

    @property
    def speed(self) -> float:
        return float(np.sqrt(self.rate * self.diffusivity / 2.0) * (1.0 - 2.0 * self.threshold))

    @property
    def width(self) -> float:
        return float(np.sqrt(2.0 * self.diffusivity / self.rate))

    def __call__(self, x: Array, time: float, start: float) -> Array:
        return 1.0 / (1.0 + np.exp((x - start - self.speed * time) / self.width))


def parabolic_sheet(bend: float, length: float = 1.0, width: float = 1.0) -> Patch:
    """Sheet Z = bend X^2 / 2, exact with one quadratic span; X = length theta1, Y = width theta2."""
    first, second = SplineSpace.uniform(2, 1), SplineSpace.uniform(1, 1)
    x, y = np.meshgrid([0.0, 0.5 * length, length], [0.0, width], indexing="ij")
    z = 0.5 * bend * np.array([0.0, 0.0, length**2])[:, None] * np.ones_like(x)
    return Patch(first, second, np.stack((x, y, z), axis=-1))


def sheet_arc_length(bend: float, x: Array) -> Array:
    """Arc length of Z = bend X^2 / 2 from X = 0 (closed form)."""
    slope = bend * np.asarray(x)
    return (slope * np.sqrt(1.0 + slope**2) + np.arcsinh(slope)) / (2.0 * bend)


def skewed_square() -> Patch:
    """Square [0.3, 1.3]^2 with a distorted interior: the control points of Table C.1."""
    line = SplineSpace.uniform(2, 1)
    x = [[0.3, 0.3, 0.3], [0.8, 0.9, 0.8], [1.3, 1.3, 1.3]]
    y = [[0.3, 0.8, 1.3], [0.3, 0.9, 1.3], [0.3, 0.8, 1.3]]
    return Patch(line, line, np.stack((np.array(x), np.array(y), np.zeros((3, 3))), axis=-1))


def observed_orders(errors: Array) -> Array:
    """log2 of successive error ratios: the order where each refinement halves the step."""
    errors = np.asarray(errors, dtype=float)
    return np.log2(errors[:-1] / errors[1:])
