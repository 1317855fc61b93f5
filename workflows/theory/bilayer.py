"""Closed forms of a film that bends under uniform active stress along X: free strip, and cylinder.

A film of plies bottom to top, fibres along X, strains uniformly over its plane. With the stretches lx, ly
and the curvatures kx, ky of its mid-surface, the Kirchhoff-Love section at depth z has

    C11 = lx^2 (1 - 2 z kx),    C22 = ly^2 (1 - 2 z ky),    C33 = 1/(C11 C22),

and the resultants N = int S dz, M = int z S dz decide between two limits:

- :func:`free_strip`: a narrow film curls across as well, N11 = M11 = N22 = M22 = 0;
- :func:`cylindrical`: a wide film cannot (it would have to stretch), so ky = 0 and N11 = M11 = N22 = 0.

For incompressible plies at small strains the cylinder has 1 - nu^2 = 3/4 of the strip's curvature. The
Stoney formula knows the strip only: on a wide film it returns three quarters of the true stress.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import fsolve

Array: TypeAlias = NDArray[np.float64]
Tension: TypeAlias = Callable[[Array], Array]
"""Active stress sigma_a along the fibres, kPa, at the fibre stretches lambda_f."""


@dataclass(frozen=True)
class Ply:
    """A layer of incompressible Neo-Hookean solid with fibres along X (eqs. 88-93).

    Attributes
    ----------
    thickness
        mm.
    shear_modulus
        mu, kPa.
    fibre_stiffness, fibre_exponent
        E_p (kPa) and a of the exponential along the fibres; no fibres: 0 and any a.
    tension
        Its active stress; none: passive.
    """

    thickness: float
    shear_modulus: float
    fibre_stiffness: float = 0.0
    fibre_exponent: float = 1.0
    tension: Tension | None = None

    def stress(self, c11: Array, c22: Array) -> tuple[Array, Array]:
        """S11 and S22, kPa, in plane stress (eqs. 37, 89, 92).

        Examples
        --------
        >>> s11, s22 = Ply(0.018, 500.0).stress(np.array([4.0]), np.array([0.5]))  # l = 2, uniaxial
        >>> float(4 * s11[0]), float(s22[0])  # Cauchy stress mu (l^2 - 1/l)
        (1750.0, 0.0)
        """
        s11 = self.shear_modulus * (1.0 - 1.0 / (c11**2 * c22))
        s22 = self.shear_modulus * (1.0 - 1.0 / (c11 * c22**2))
        stretch = np.sqrt(c11)
        growth = np.expm1(self.fibre_exponent * (stretch - 1.0))
        s11 = s11 + self.fibre_stiffness / (self.fibre_exponent * stretch) * growth
        if self.tension is not None:
            s11 = s11 + self.tension(stretch) / c11
        return s11, s22


@dataclass(frozen=True)
class Bend:
    """Uniform state of the mid-surface: stretches along X and Y, curvatures along them in 1/mm.

    Positive curvature: concave on the upper side.
    """

    stretch_x: float
    stretch_y: float
    curvature_x: float
    curvature_y: float


def prescribed(stress: float) -> Tension:
    """The same active stress at any stretch, kPa."""
    return lambda stretch: np.full_like(stretch, stress)


def free_strip(plies: Sequence[Ply]) -> Bend:
    """Narrow film: N11 = M11 = N22 = M22 = 0, anticlastic.

    Raises
    ------
    ValueError
        If no state is in balance, as when the active stress is far beyond the film's stiffness.

    Examples
    --------
    A thin active layer on a linear substrate obeys Stoney, k = 6 sigma d_a/(E d_s^2), and the strip
    curls across by nu k the other way:

    >>> thin = [Ply(1.0, 1.0), Ply(1e-6, 1e-9, tension=prescribed(1.0))]
    >>> bend = free_strip(thin)
    >>> round(bend.curvature_x * 1e6 / (6 / 3.0), 4), round(bend.curvature_y / bend.curvature_x, 4)
    (1.0, -0.5)
    """
    return _bend(plies, across=True)


def cylindrical(plies: Sequence[Ply]) -> Bend:
    """Wide film far from its edges: N11 = M11 = N22 = 0 and no curvature along Y.

    Raises
    ------
    ValueError
        As :func:`free_strip`.

    Examples
    --------
    >>> thin = [Ply(1.0, 1.0), Ply(1e-6, 1e-9, tension=prescribed(1.0))]
    >>> round(cylindrical(thin).curvature_x / free_strip(thin).curvature_x, 4)
    0.75
    """
    return _bend(plies, across=False)


def resultants(plies: Sequence[Ply], bend: Bend) -> tuple[float, float, float, float]:
    """N11, N22 (kPa mm), M11, M22 (kPa mm^2) per reference length, about the middle of the film."""
    x, w = np.polynomial.legendre.leggauss(6)  # strains vary by a few per cent: exact to round-off
    half = 0.5 * sum(ply.thickness for ply in plies)
    total = np.zeros(4)
    bottom = -half
    for ply in plies:
        z = bottom + 0.5 * ply.thickness * (1.0 + x)
        dz = 0.5 * ply.thickness * w
        s11, s22 = ply.stress(
            bend.stretch_x**2 * (1.0 - 2.0 * z * bend.curvature_x),
            bend.stretch_y**2 * (1.0 - 2.0 * z * bend.curvature_y),
        )
        total += [dz @ s11, dz @ s22, dz @ (z * s11), dz @ (z * s22)]
        bottom += ply.thickness
    n11, n22, m11, m22 = total.tolist()
    return n11, n22, m11, m22


def _bend(plies: Sequence[Ply], *, across: bool) -> Bend:
    """Unknowns of one size: stretches minus 1, and curvatures times d/2."""
    half = 0.5 * sum(ply.thickness for ply in plies)
    stiffness = sum((3 * ply.shear_modulus + ply.fibre_stiffness) * ply.thickness for ply in plies)

    def state(unknown: Array) -> Bend:
        ky = unknown[3] / half if across else 0.0
        return Bend(
            1.0 + float(unknown[0]), 1.0 + float(unknown[1]), float(unknown[2]) / half, float(ky)
        )

    def balance(unknown: Array) -> Array:
        n11, n22, m11, m22 = resultants(plies, state(unknown))
        rows = [n11, n22, m11 / half, m22 / half] if across else [n11, n22, m11 / half]
        return np.array(rows) / stiffness

    with np.errstate(invalid="ignore"):
        found, _, status, message = fsolve(
            balance, np.zeros(4 if across else 3), xtol=1e-14, full_output=True
        )
        error = np.abs(balance(found)).max()
    # rounding alone leaves 1e-16 of the stiffness; fsolve's own verdict asks for more than that
    if not error < 1e-13:
        raise ValueError(f"no uniform bend of the film is in balance (status {status}): {message}")
    return state(found)
