"""Waves on cylinders and spheres in closed form, with what diffusion along fibres makes of them.

The diffusivity is one along the fibres and k across: div(D grad v) = k Lap v + (1 - k) div(f (f . grad v)).
With k = 1 the waves are eigenfunctions of the Laplace-Beltrami operator.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from stages.numerics.bsplines import Array


class Field(NamedTuple):
    """v; its surface gradient and the flux D grad v as vectors ``(point, 3)``; div(D grad v)."""

    value: Array
    flux: Array
    diffused: Array


class Wave(Protocol):
    """A field on a surface."""

    def at(self, position: Array) -> Field:
        """The field at points of the surface, shape ``(point, 3)``."""


@dataclass(frozen=True)
class CylinderWave:
    """v = cos(a x + 0.2) cos(n phi + 0.3) on Y^2 + Z^2 = R^2, phi from Z towards Y.

    Fibres run at ``angle`` (radians) from the axis towards growing phi. On the unrolled surface all
    coefficients are constant, and Lap v = -(a^2 + n^2/R^2) v.
    """

    radius: float
    along: float
    around: int
    ratio: float = 1.0
    angle: float = 0.0

    def at(self, position: Array) -> Field:
        """Products of cosines."""
        phi = np.arctan2(position[:, 1], position[:, 2])
        a, n = self.along, self.around / self.radius
        first, second = a * position[:, 0] + 0.2, self.around * phi + 0.3
        value = np.cos(first) * np.cos(second)
        slopes = np.stack(
            (-a * np.sin(first) * np.cos(second), -n * np.cos(first) * np.sin(second)), axis=1
        )
        mixed = a * n * np.sin(first) * np.sin(second)
        f = np.array([np.cos(self.angle), np.sin(self.angle)])
        tensor = self.ratio * np.eye(2) + (1.0 - self.ratio) * np.outer(f, f)
        diffused = -(a**2 * tensor[0, 0] + n**2 * tensor[1, 1]) * value + 2 * tensor[0, 1] * mixed
        axis = np.broadcast_to([1.0, 0.0, 0.0], position.shape)
        arc = np.stack((np.zeros_like(phi), np.cos(phi), -np.sin(phi)), axis=1)
        flow = slopes @ tensor
        return Field(value, flow[:, :1] * axis + flow[:, 1:] * arc, diffused)


@dataclass(frozen=True)
class SphereWave:
    """v = cos(3 l) cos^3 b sin b at longitude l and latitude b: a spherical harmonic of degree 4, order 3.

    Lap v = -20 v/R^2. Fibres run at ``angle`` (radians) from the parallels towards growing latitude.
    """

    radius: float
    ratio: float = 1.0
    angle: float = 0.0

    def at(self, position: Array) -> Field:
        """With w = f . grad v, div(f w) = (c w_l/cos b + s (w_b - w tan b))/R."""
        radius, k = self.radius, self.ratio
        unit = position / radius
        longitude, sin = np.arctan2(unit[:, 1], unit[:, 0]), unit[:, 2]
        cos = np.hypot(unit[:, 0], unit[:, 1])
        wave, slope, bend = (
            np.cos(3 * longitude),
            -3 * np.sin(3 * longitude),
            -9 * np.cos(3 * longitude),
        )
        g, g1 = cos**3 * sin, cos**4 - 3 * cos**2 * sin**2
        g2 = -10 * cos**3 * sin + 6 * cos * sin**3
        h, h1 = cos**2 * sin, cos**3 - 2 * cos * sin**2  # g/cos b and its slope
        c, s = np.cos(self.angle), np.sin(self.angle)
        east, north = slope * h / radius, wave * g1 / radius
        w = c * east + s * north
        w_east = (c * bend * h + s * slope * g1) / radius
        w_north = (c * slope * h1 + s * wave * g2) / radius
        carried = (c * w_east / cos + s * (w_north - w * sin / cos)) / radius
        value = wave * g
        diffused = k * (-20.0 / radius**2) * value + (1.0 - k) * carried
        parallel = np.stack((-np.sin(longitude), np.cos(longitude), np.zeros_like(cos)), axis=1)
        meridian = np.stack((-sin * np.cos(longitude), -sin * np.sin(longitude), cos), axis=1)
        flux = k * (east[:, None] * parallel + north[:, None] * meridian)
        flux = flux + (1.0 - k) * w[:, None] * (c * parallel + s * meridian)
        return Field(value, flux, diffused)
