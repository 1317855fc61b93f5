"""Cantilever strips bent far: rolled by an end moment, and sheared by a dead end load.

The classical elastica bends without stretching. A thin strip of St. Venant-Kirchhoff material without
lateral contraction (nu = 0) is, as a Kirchhoff-Love shell, a rod that stretches a little: with the
stretch l of its axis and the rotation theta, the shell's strains are

    eps = (l^2 - 1)/2,    kappa = -l theta',    energy per length = (EA eps^2 + EI kappa^2)/2,

so that both problems have solutions exact for the shell itself, beside the classical ones; the two
differ by about (t/R)^2/6.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_bvp
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc

Array: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True)
class Tip:
    """Where the free end is: it came back by ``shortening``, rose by ``deflection``, and turned (rad)."""

    shortening: float
    deflection: float
    rotation: float


@dataclass(frozen=True)
class Strip:
    """Rectangular section of a material with nu = 0.

    Attributes
    ----------
    length, width, thickness
        In one unit of length.
    modulus
        Young's modulus.
    """

    length: float
    width: float
    thickness: float
    modulus: float

    @property
    def axial_stiffness(self) -> float:
        """EA."""
        return self.modulus * self.width * self.thickness

    @property
    def bending_stiffness(self) -> float:
        """EI."""
        return self.axial_stiffness * self.thickness**2 / 12.0


def rolled(strip: Strip, moment: float) -> Tip:
    """Elastica under an end moment: an arc of radius R = EI/M.

    Examples
    --------
    A full circle brings the end back to the clamp (Sze, Liu and Lo, 2004, end moment):

    >>> strip = Strip(12.0, 1.0, 0.1, 1.2e6)
    >>> tip = rolled(strip, 2 * np.pi * strip.bending_stiffness / strip.length)
    >>> round(tip.shortening, 12), round(tip.deflection, 12)
    (12.0, 0.0)
    """
    return _arc(strip, moment / strip.bending_stiffness, 1.0)


def rolled_shell(strip: Strip, moment: float) -> Tip:
    """The same for the shell, exactly: EI l^2 theta' = M and EA (l^2 - 1)/2 + EI theta'^2 = 0.

    With x = theta'^2 t^2/6 the second equation is l^2 = 1 - x, and the first
    sqrt(x) (1 - x) = M t/(EI sqrt(6)).

    Raises
    ------
    ValueError
        If the moment exceeds what such a section can carry, (2/9) sqrt(18) EI/t.
    """
    thick = strip.thickness / np.sqrt(6.0)
    load = abs(moment) / strip.bending_stiffness * thick
    if load > 2.0 / np.sqrt(27.0):
        raise ValueError(
            f"no equilibrium under the moment {moment:g}: the strip carries at most "
            f"{2.0 / np.sqrt(27.0) / thick * strip.bending_stiffness:g}"
        )
    root = float(brentq(lambda y: y * (1.0 - y * y) - load, 0.0, np.sqrt(1.0 / 3.0), xtol=1e-16))
    return _arc(strip, float(np.copysign(root / thick, moment)), float(np.sqrt(1.0 - root * root)))


def _arc(strip: Strip, turn: float, stretch: float) -> Tip:
    """Tip of an arc that turns by ``turn`` per reference length."""
    angle = turn * strip.length
    if angle == 0.0:
        return Tip(0.0, 0.0, 0.0)
    radius = stretch / turn
    return Tip(
        float(strip.length - radius * np.sin(angle)), float(radius * (1 - np.cos(angle))), angle
    )


def sheared(strip: Strip, force: float) -> Tip:
    """Elastica under a dead transverse end force P >= 0, by elliptic integrals.

    With k^2 = (1 + sin theta_L)/2, sin phi = 1/(k sqrt 2) and a^2 = P L^2/EI,

        a = K(k) - F(phi, k),    w/L = 1 - 2 (E(k) - E(phi, k))/a,    x/L = sqrt(2 sin theta_L)/a.

    References
    ----------
    Bisshopp and Drucker (1945), Q. Appl. Math. 3, 272; tabulated to five digits by Mattiasson (1981),
    Int. J. Numer. Meth. Engng 17, 145.

    Examples
    --------
    Loads P L^2/EI = 1 and 10:

    >>> strip = Strip(1.0, 1.0, 1.0, 12.0)
    >>> for load in (1.0, 10.0):
    ...     tip = sheared(strip, load)
    ...     print(f"{tip.shortening:.5f} {tip.deflection:.5f} {tip.rotation:.5f}")
    0.05643 0.30172 0.46135
    0.55500 0.81061 1.43029
    """
    if force == 0.0:
        return Tip(0.0, 0.0, 0.0)
    root = np.sqrt(force * strip.length**2 / strip.bending_stiffness)

    def arguments(angle: float) -> tuple[float, float]:
        m = 0.5 * (1.0 + np.sin(angle))
        return m, float(np.arcsin(1.0 / np.sqrt(2.0 * m)))

    def excess(angle: float) -> float:
        m, phi = arguments(angle)
        return float(ellipk(m) - ellipkinc(phi, m) - root)

    angle = float(brentq(excess, 1e-12, 0.5 * np.pi - 1e-12, xtol=1e-15))
    m, phi = arguments(angle)
    rise = 1.0 - 2.0 * (ellipe(m) - ellipeinc(phi, m)) / root
    reach = np.sqrt(2.0 * np.sin(angle)) / root
    return Tip(strip.length * float(1.0 - reach), strip.length * float(rise), angle)


def sheared_shell(strip: Strip, force: float) -> Tip:
    """The same for the shell: a boundary value problem for (x, z, theta, m) along the axis.

        x' = l cos theta,  z' = l sin theta,  theta' = m/(EI l^2),  m' = -P l cos theta,
        EA l (l^2 - 1)/2 + m^2/(EI l^3) = P sin theta,    x = z = theta = 0 at the clamp, m = 0 at the end.

    Examples
    --------
    It differs from the elastica by its stretching only:

    >>> strip = Strip(10.0, 1.0, 0.1, 1.2e6)
    >>> round(sheared_shell(strip, 4.0).deflection / sheared(strip, 4.0).deflection, 3)
    1.0
    """
    ea, ei, length = strip.axial_stiffness, strip.bending_stiffness, strip.length

    def stretch(theta: Array, m: Array) -> Array:
        x = np.ones_like(theta)
        for _ in range(6):  # from 1, with l - 1 of 1e-3 or less: quadratic, round-off after four
            residual = 0.5 * ea * x * (x**2 - 1.0) + m**2 / (ei * x**3) - force * np.sin(theta)
            x = x - residual / (0.5 * ea * (3.0 * x**2 - 1.0) - 3.0 * m**2 / (ei * x**4))
        return x

    def slopes(s: Array, y: Array) -> Array:
        _, _, theta, m = y
        x = stretch(theta, m)
        along, up = x * np.cos(theta), x * np.sin(theta)
        return np.stack((along, up, m / (ei * x**2), -force * along))

    def ends(a: Array, b: Array) -> Array:
        return np.array([a[0], a[1], a[2], b[3]])

    guess = sheared(strip, force).rotation
    s = np.linspace(0.0, length, 101)
    bend = 2.0 * guess / length * (1.0 - s / length)
    theta = guess * (1.0 - (1.0 - s / length) ** 2)
    start = np.stack((s * np.cos(guess / 2), s * np.sin(guess / 2), theta, ei * bend))
    found = solve_bvp(slopes, ends, s, start, tol=1e-11, max_nodes=100_000)
    if not found.success:
        raise ValueError(f"the strip's equilibrium was not found: {found.message}")
    x, z, rotation, _ = found.y[:, -1]
    return Tip(float(length - x), float(z), float(rotation))
