"""Velocity of the fronts of activation: from when they reach a point and its neighbours."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.numerics.waves import matching, taken

FLATNESS = 0.5
"""Arrival times may deviate from those of a plane front by this share of their spread (both rms)."""

CHUNK = 2**21
"""Pairs of beats that are compared at once."""


def front_velocity(patch: Patch, activation_times: Array) -> Array:
    """Velocity of every wave at every collocation point.

    The arrival times of one wave at a point and at the eight others of a 3 x 3 window (at an edge, one
    that reaches inwards) are fitted by a quadratic function of the place in the tangent plane, in the
    mean square. Its gradient g at the point gives the velocity g/|g|^2, the error of which falls with the
    square of the mesh size. It is NaN where no front passes: one of the nine did not fire in that
    wave, or the times are not those of a front, which at the scale of the mesh is nearly plane. So it
    is where a wave breaks out, where two collide, and in the core of a spiral.

    Parameters
    ----------
    patch
        Excitable surface.
    activation_times
        Shape ``(point, beat)``, ms; NaN where there was none.

    Returns
    -------
    Array
        Shape ``(point, beat, 3)``, mm/ms, tangential to the surface.
    """
    windows = _neighbours(patch)
    tangents, places, gradient = _geometry(patch, windows)
    found = np.full((*activation_times.shape, 3), np.nan)
    beats = activation_times.shape[1]
    if not beats:
        return found
    length = max(CHUNK // (9 * beats * beats), 1)
    for first in range(0, len(found), length):
        points = slice(first, first + length)
        around = _arrivals(activation_times, windows[points], points)
        slope = np.einsum("pdk,pbk->pbd", gradient[points], around)
        plane = np.einsum("pbd,pkd->pbk", slope, places[points])
        spread, off = (np.sqrt((f**2).mean(axis=-1)) for f in (plane, around - plane))
        with np.errstate(invalid="ignore", divide="ignore"):
            speed = slope / (slope**2).sum(axis=-1, keepdims=True)
            flat = (off <= FLATNESS * spread)[..., None]
        velocity = np.einsum("pbd,pdx->pbx", speed, tangents[points])
        found[points] = np.where(flat, velocity, np.nan)
    return found


def _neighbours(patch: Patch) -> NDArray[np.int64]:
    """Numbers of the nine points of each window, shape ``(point, 9)``."""
    near = [
        np.clip(np.arange(n), 1, n - 2)[:, None] + np.arange(-1, 2)
        for n in (patch.first.size, patch.second.size)
    ]
    rows, columns = near[0][:, None, :, None], near[1][None, :, None, :]
    return np.asarray(rows * patch.second.size + columns).reshape(patch.size, 9)


def _geometry(patch: Patch, windows: NDArray[np.int64]) -> tuple[Array, Array, Array]:
    """Geometry of the windows.

    Returns
    -------
    tangents
        Orthonormal ones, shape ``(point, 2, 3)``.
    places
        Of the nine from the point, in the tangent plane, mm, shape ``(point, 9, 2)``.
    gradient
        Takes values at the nine to the gradient at the point, 1/mm, shape ``(point, 2, 9)``.
    """
    at1, at2 = (space.greville() for space in patch.spaces)
    position, along, across = (patch.evaluate(at1, at2, k) for k in ((0, 0), (1, 0), (0, 1)))
    first = along / np.linalg.norm(along, axis=1, keepdims=True)
    rest = across - (across * first).sum(axis=1, keepdims=True) * first
    second = rest / np.linalg.norm(rest, axis=1, keepdims=True)
    tangents = np.stack((first, second), axis=1)
    away = position[windows] - position[:, None]
    places = np.einsum("pkx,pdx->pkd", away, tangents)
    size = np.abs(places).max(axis=1, keepdims=True)
    x, y = np.moveaxis(places / size, -1, 0)
    terms = np.stack((np.ones_like(x), x, y, x * x, x * y, y * y), axis=-1)
    fit = np.linalg.pinv(
        terms
    )  # on a tube of three spans, points of a window may lie over one another
    return tangents, places, fit[:, 1:3] / np.swapaxes(size, 1, 2)


def _arrivals(times: Array, windows: NDArray[np.int64], points: slice) -> Array:
    """When the wave reaches each of the nine, after the point itself, ms; shape ``(p, beat, 9)``."""
    own, nine = times[points], times[windows]
    around = taken(nine, matching(own[:, None], nine)) - own[:, None]
    return np.moveaxis(around, 1, -1)
