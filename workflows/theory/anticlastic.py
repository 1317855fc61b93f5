"""Curvature of a long film of any width: between the free strip and the cylinder.

Bent to a curvature k along X, a long film would curl across the other way (anticlastic), but lines that
leave the cylinder by w are stretched or shortened by k w, which a film resists far more than bending.
Only strips along the sides, as wide as sqrt(t/k)/(3 (1 - nu^2))^(1/4), can curl; the middle of a wide film
stays a cylinder (Lamb, 1891; Searle, 1908; Ashwell, 1950). Here this theory is extended to a film that
bends by itself: plies with active stress, whose curvature is part of the solution.

Assumed: nothing changes along X (a long film, away from its ends); no force across, N22 = 0; small slopes
across the film, w' << 1; and a section that responds linearly to the departure from the cylinder,

    dW = Q q . dq + m dk22,    q = (e11, k - k_c, k22),    e11 = -k v,    k22 = v'',

where Q is its stiffness in the state of the cylinder (N22 = 0 eliminated), m the moment that keeps the
cylinder from curling across, and v = w up to a constant. The energy of the width is stationary in v(y),

    Q33 v'''' - 2 Q13 k v'' + Q11 k^2 v = Q12 k (k - k_c),
    Q33 v'' - Q13 k v + Q23 (k - k_c) + m = 0 and Q33 v''' - Q13 k v' = 0 at the sides,

and in k, which is what :func:`film_of_width` solves.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import brentq

from workflows.theory.bilayer import Array, Bend, Ply, cylindrical, free_strip, resultants


@dataclass(frozen=True)
class WideFilm:
    """A film of finite width.

    Attributes
    ----------
    curvature
        k along X, 1/mm; uniform over the width.
    edge
        Width of the strips along the sides that curl, mm: the length over which they decay by e.
    across
        Distances from the middle line, mm, and there
    profile
        v(y), mm: how far the film leaves the cylinder through its mid-surface fibres of natural length.
    """

    curvature: float
    edge: float
    across: Array
    profile: Array


@dataclass(frozen=True)
class _Section:
    """Linear response about the cylinder: stiffness Q (3, 3), side moment m, and k_c."""

    stiffness: Array
    moment: float
    curvature: float


def film_of_width(plies: Sequence[Ply], width: float) -> WideFilm:
    """Long film of that width under its own active stress.

    Raises
    ------
    ValueError
        If the film does not bend along X towards its upper side, or no curvature is in balance.

    Examples
    --------
    A film 2 mm wide is nearly a cylinder, one of 0.02 mm nearly a free strip:

    >>> from workflows.theory.bilayer import prescribed
    >>> film = [Ply(0.018, 500.0), Ply(0.004, 0.767, 21.0, 5.5, prescribed(12.2))]
    >>> narrow, wide = film_of_width(film, 0.02).curvature, film_of_width(film, 2.0).curvature
    >>> round(narrow / free_strip(film).curvature_x, 3), round(wide / cylindrical(film).curvature_x, 3)
    (0.999, 1.028)
    """
    middle, limit = cylindrical(plies), free_strip(plies).curvature_x
    if middle.curvature_x <= 0.0:
        raise ValueError(
            "the film does not bend towards its upper side: there is nothing to compare"
        )
    section = _linearise(plies, middle)

    def imbalance(curvature: float) -> float:
        return _slope(section, width, curvature)

    ends = 0.9 * section.curvature, 1.1 * limit
    if imbalance(ends[0]) * imbalance(ends[1]) > 0:
        raise ValueError(f"no curvature between {ends[0]:g} and {ends[1]:g} /mm is in balance")
    curvature = float(brentq(imbalance, *ends, xtol=1e-15, rtol=1e-13))
    root = _root(section, curvature)
    across, _ = _points(width)
    profile = _profile(section, width, curvature, across)[0]
    return WideFilm(curvature, float(1.0 / root.real), across, profile)


def _linearise(plies: Sequence[Ply], at: Bend) -> _Section:
    """Q by central differences of the resultants, with the stretch along Y eliminated by N22 = 0."""
    half = 0.5 * sum(ply.thickness for ply in plies)
    steps = {
        "stretch_x": 1e-5,
        "curvature_x": 1e-5 / half,
        "curvature_y": 1e-5 / half,
        "stretch_y": 1e-5,
    }
    columns = []
    for name, step in steps.items():
        ahead, behind = (
            _conjugates(plies, replace(at, **{name: getattr(at, name) + sign * step}))
            for sign in (1.0, -1.0)
        )
        columns.append((ahead - behind) / (2.0 * step))
    full = np.stack(columns, axis=1)
    full = 0.5 * (full + full.T)  # symmetric but for terms of the size of the strains
    condensed = full[:3, :3] - np.outer(full[:3, 3], full[3, :3]) / full[3, 3]
    return _Section(condensed, float(_conjugates(plies, at)[2]), at.curvature_x)


def _conjugates(plies: Sequence[Ply], bend: Bend) -> Array:
    """(N11, -M11, -M22, N22): what does work on (lx, kx, ky, ly) at small strains."""
    n11, n22, m11, m22 = resultants(plies, bend)
    return np.array([n11, -m11, -m22, n22])


def _root(section: _Section, k: float) -> complex:
    """r with v = exp(r y): Q33 r^4 - 2 Q13 k r^2 + Q11 k^2 = 0; the one of positive real part."""
    q = section.stiffness
    square = k * (q[0, 2] + np.sqrt(complex(q[0, 2] ** 2 - q[0, 0] * q[2, 2]))) / q[2, 2]
    root = np.sqrt(square)
    return complex(root if root.real > 0 else -root)


def _profile(section: _Section, width: float, k: float, y: Array) -> tuple[Array, Array]:
    """v and v'' at y: a constant, and both parts of cosh(r y), fitted to the two conditions at the side."""
    q, rise = section.stiffness, k - section.curvature
    root, side = _root(section, k), 0.5 * width

    def wave(at: Array | float, order: int) -> Any:
        """d^order cosh(r y)/dy^order, scaled by exp(-Re r side) so that it cannot overflow."""
        grow, fall = (np.exp(s * root * np.asarray(at) - root.real * side) for s in (1.0, -1.0))
        return 0.5 * root**order * (grow + (-1) ** order * fall)

    constant = q[0, 1] * rise / (q[0, 0] * k)
    moment = q[2, 2] * wave(side, 2) - q[0, 2] * k * wave(side, 0)
    shear = q[2, 2] * wave(side, 3) - q[0, 2] * k * wave(side, 1)
    right = q[0, 2] * k * constant - q[1, 2] * rise - section.moment
    parts = np.linalg.solve(
        np.array([[moment.real, -moment.imag], [shear.real, -shear.imag]]), [right, 0.0]
    )
    factor = complex(*parts)
    v, bend = (np.asarray((factor * wave(y, order)).real, dtype=float) for order in (0, 2))
    return constant + v, bend


def _slope(section: _Section, width: float, k: float) -> float:
    """d(energy)/dk at the best v(y), mean over the width; zero in balance."""
    q, rise = section.stiffness, k - section.curvature
    y, weights = _points(width)
    v, bend = _profile(section, width, k, y)
    density = (
        q[0, 0] * k * v**2
        - q[0, 1] * v * (rise + k)
        - q[0, 2] * v * bend
        + q[1, 1] * rise
        + q[1, 2] * bend
    )
    return float(weights @ density)


def _points(width: float) -> tuple[Array, Array]:
    """Gauss points over half the width, crowded at the side, and weights of a mean."""
    x, w = _rule()
    return 0.25 * width * (1.0 + x), 0.5 * w


@functools.cache
def _rule() -> tuple[Array, Array]:
    """Gauss rule of 200 points; its eigenvalue problem takes longer than all that it is used for."""
    x, w = np.polynomial.legendre.leggauss(200)
    return np.asarray(x), np.asarray(w)
