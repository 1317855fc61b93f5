"""Fields followed at a few points of the film: frames times one row of weights per probe."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.film_lengths import FilmLengths
from stages.numerics.patches import Patch
from stages.numerics.time_series import StoredFrames, TimeSeries, blocks
from stages.postprocessing.config import Place

NAMED_PLACES = {"centre": (0.5, 0.5), "tip": (1.0, 0.5), "corner": (1.0, 1.0)}
"""Parameters of the points that follow the film when its length or width changes."""


def place_parameters(film: Patch, places: Iterable[Place]) -> Array:
    """Parameters of probes, given by name or by (X, Y); shape ``(probes, 2)``.

    Raises
    ------
    ValueError
        If a point lies outside the film.
    """
    rows = [
        np.array(NAMED_PLACES[place])
        if isinstance(place, str)
        else probe_parameters(film, np.array([place]))[0]
        for place in places
    ]
    return np.array(rows)


def axis_parameter(film: Patch, axis: float | str) -> float:
    """Parameter theta2 of the line Y = ``axis`` (mm) along X; ``"middle"``: half the width."""
    if isinstance(axis, str):
        return 0.5
    return float(FilmLengths(film).parameters_along(1, np.array([axis]))[0])


def probe_parameters(film: Patch, points: Array) -> Array:
    """Parameters of the points (X, Y) of the film, lengths along it.

    Parameters
    ----------
    film
        Undeformed mid-surface.
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
    return FilmLengths(film).parameters(points)


def control_weights(patch: Patch, theta: Array) -> Array:
    """Basis functions at the probes: value = weights @ control values; ``(probes, m1 * m2)``."""
    return patch.functions(theta)


def collocation_weights(patch: Patch, theta: Array) -> Array:
    """Cardinal splines at the probes: value = weights @ values at the collocation points (eq. 86).

    The control values of the spline through the collocation values are a fixed linear map of these,
    so the map is applied to the probe's basis functions once, and not to every frame.
    """
    return _tensor(patch.first.cardinals(theta[:, 0]), patch.second.cardinals(theta[:, 1]))


def series(frames: StoredFrames, weights: Array) -> Array:
    """Values at the probes over time: ``(time, point, ...)`` -> ``(time, probe, ...)``."""
    parts = [np.einsum("pc,tc...->tp...", weights, block) for _, block in blocks(frames)]
    return np.concatenate(parts)


def resample(values: Array, time: Array, at: Array) -> Array:
    """Values ``(time, probe)`` of the cells at other times, linear between frames.

    Raises
    ------
    TimesNotCoveredError
        If a time lies outside the history.
    """
    cells = TimeSeries(
        values,
        time,
        name="the cells' state at the probes",
        known="the electrophysiology ran",
        remedy="Simulate longer cells (electrophysiology.duration).",
    )
    cells.check_covers(at)
    return np.stack([cells.at(t) for t in at])


def _tensor(first: Array, second: Array) -> Array:
    return np.einsum("pi,pj->pij", first, second).reshape(len(first), -1)
