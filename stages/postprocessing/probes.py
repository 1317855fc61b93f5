"""Fields followed at a few points of the film.

A field over time is never held whole: frames are read in blocks, and each block is multiplied with
one row of weights per probe.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.numerics.surface_geometry import locate

BLOCK = 64
"""Frames read at once: the chunk length of stored histories."""


def probe_parameters(film: Patch, points: Array) -> Array:
    """Parameters of the points of the undeformed film that lie over (X, Y).

    Parameters
    ----------
    film
        Undeformed mid-surface; over every (X, Y) there is at most one point of it.
    points
        Shape ``(probes, 2)``, mm.

    Returns
    -------
    Array
        Shape ``(probes, 2)``. They mean the same points on every mesh of the film.

    Raises
    ------
    ValueError
        If a point lies outside the film.
    """
    shadow = Patch(film.first, film.second, film.control_points * np.array([1.0, 1.0, 0.0]))
    return locate(shadow, np.column_stack((points, np.zeros(len(points)))))


def control_weights(patch: Patch, theta: Array) -> Array:
    """Basis functions at the probes: value = weights @ control values; ``(probes, m1 * m2)``."""
    return _tensor(patch.first.evaluate(theta[:, 0]), patch.second.evaluate(theta[:, 1]))


def collocation_weights(patch: Patch, theta: Array) -> Array:
    """Cardinal splines at the probes: value = weights @ values at the collocation points (eq. 86).

    The control values of the spline through the collocation values are a fixed linear map of these,
    so the map is applied to the probe's basis functions once, and not to every frame.
    """
    first, second = (
        space.evaluate(theta[:, axis]) @ space.interpolate(np.eye(space.size))
        for axis, space in enumerate(patch.spaces)
    )
    return _tensor(first, second)


def blocks(frames: Array) -> Iterator[tuple[slice, Array]]:
    """Successive blocks of frames (first axis), read one at a time, in double precision."""
    for start in range(0, frames.shape[0], BLOCK):
        block = slice(start, min(start + BLOCK, frames.shape[0]))
        yield block, np.asarray(frames[block], dtype=float)


def series(frames: Array, weights: Array) -> Array:
    """Values at the probes over time: ``(time, point, ...)`` -> ``(time, probe, ...)``."""
    parts = [np.einsum("pc,tc...->tp...", weights, block) for _, block in blocks(frames)]
    return np.concatenate(parts)


def resample(values: Array, time: Array, at: Array) -> Array:
    """Values ``(time, probe)`` at other times, linear between frames.

    Raises
    ------
    ValueError
        If a time lies outside the history.
    """
    slack = 1e-9 * max(float(time[-1] - time[0]), 1.0)  # rounding of i * dt, nothing more
    if at[0] < time[0] - slack or at[-1] > time[-1] + slack:
        raise ValueError(
            f"the electrophysiology covers {time[0]:g} to {time[-1]:g} ms, "
            f"but values are asked for from {at[0]:g} to {at[-1]:g} ms"
        )
    return np.column_stack([np.interp(at, time, column) for column in values.T])


def _tensor(first: Array, second: Array) -> Array:
    return np.einsum("pi,pj->pij", first, second).reshape(len(first), -1)
