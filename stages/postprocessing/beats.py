"""Beats: when the wave reaches a point, how fast it travels, how hard the muscle pulls."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from stages.numerics.bsplines import Array, SplineSpace
from stages.numerics.patches import Patch
from stages.numerics.waves import matching, taken

BENDING = 0.25
"""Part of the range of neighbouring values by which a smooth field departs from straight lines at most."""
NEGLIGIBLE = 1e-9
"""A point of less weight does not count: a place on a collocation point is known to rounding only."""
ROUGHNESS = 5.0
"""A front takes at most this many times its median step time between neighbouring points."""


def arrival_times(surface: Patch, activation_times: Array, theta: Array) -> Array:
    """Activation times at parameters ``theta``, beat by beat, shape ``(probes, beats)``, ms.

    See :func:`beats_at`.
    """
    return beats_at(surface, activation_times, theta, {"time": activation_times})["time"]


def beats_at(
    surface: Patch, activation_times: Array, theta: Array, maps: Mapping[str, Array]
) -> dict[str, Array]:
    """What maps over points and beats say at parameters ``theta``.

    Cubic along X and along Y through the twelve collocation points around ``theta`` (four by four without
    the corners), whose events are matched in time: where one point has missed a wave, column k of two
    neighbours may belong to different waves. With C the cubic and L the straight line in a direction,
    that is C_x L_y + L_x C_y - L_x L_y, of fourth order: a front that bends on the way from point to
    point is met where straight lines would be late by h^2/8 over its radius and speed. Twelve points lie
    closer to a wave's end than sixteen. Where one of them did not fire in that beat,
    or cubics depart from the straight lines by more than a quarter of the range of the nearest points (fronts
    meet there), linear between the up to four points around; NaN where one of these did not fire.

    Parameters
    ----------
    surface
        Excitable surface.
    activation_times
        At the collocation points, shape ``(points, beats)``, NaN where a point did not fire, ms.
    theta
        Shape ``(probes, 2)``.
    maps
        Fields by name, each of shape ``(points, beats)``.

    Returns
    -------
    dict
        The same names, each of shape ``(probes, beats)``.
    """
    shape = (surface.first.size, surface.second.size, activation_times.shape[1])
    grids = {name: values.reshape(shape) for name, values in maps.items()}
    times = activation_times.reshape(shape)
    (rows, lines1, cubics1), (columns, lines2, cubics2) = (
        _around(space, theta[:, k]) for k, space in enumerate(surface.spaces)
    )
    found = {name: np.full((len(theta), shape[2]), np.nan) for name in maps}
    for probe in range(len(theta)):
        around = np.ix_(rows[probe], columns[probe])
        near = np.outer(lines1[probe], lines2[probe])
        wide = np.outer(cubics1[probe], lines2[probe]) + np.outer(lines1[probe], cubics2[probe])
        wide -= near
        events = times[around].reshape(near.size, -1)
        waves = matching(events[[np.argmax(near)]], events)
        for name, grid in grids.items():
            values = taken(grid[around].reshape(near.size, -1), waves)
            straight, low, high = _weighted(near.ravel(), values)
            curved, _, _ = _weighted(wide.ravel(), values)
            smooth = np.abs(curved - straight) <= BENDING * (high - low)  # NaN is not
            found[name][probe] = np.where(smooth, curved, straight)
    return found


def conduction_velocity(arrivals: Array, distance: float) -> Array:
    """Mean speed of each front that runs along a line, from its first to its last point.

    A wave is followed from point to point by its nearest event in time. It counts as one front if it
    passes all points in one direction and takes nowhere far longer than elsewhere; two waves that
    happen to pass the two ends do not make a speed.

    Parameters
    ----------
    arrivals
        Activation times at points along the line, shape ``(points, beats)``, ms, NaN where a point
        did not fire; about one collocation point apart.
    distance
        Length of the line on the undeformed film, mm.

    Returns
    -------
    Array
        One entry per beat of the first point, shape ``(beats,)``, mm/ms; negative for a wave that
        comes the other way, NaN where no front ran along the whole line.
    """
    front = [arrivals[0]]
    for events in arrivals[1:]:
        front.append(taken(events, matching(front[-1], events)))
    steps = np.diff(np.array(front), axis=0)
    smooth = np.abs(steps).max(axis=0) <= ROUGHNESS * np.median(np.abs(steps), axis=0)
    one_way = (steps > 0).all(axis=0) | (steps < 0).all(axis=0)
    return np.where(
        smooth & one_way, distance / np.where(one_way, steps.sum(axis=0), np.nan), np.nan
    )


def beat_peaks(stress: Array, time: Array, arrivals: Array) -> Array:
    """Largest active stress of each beat at each probe.

    A beat of a probe lasts from its activation time to the next one, or to the end.

    Parameters
    ----------
    stress
        Shape ``(time, probes)``, kPa.
    time
        Shape ``(time,)``, ms.
    arrivals
        Shape ``(probes, beats)``, ms; NaN where the probe was not activated.

    Returns
    -------
    Array
        Shape ``(probes, beats)``, kPa; NaN where there was no beat.
    """
    peaks = np.full(arrivals.shape, np.nan)
    for probe, starts in enumerate(arrivals):
        fired = np.flatnonzero(np.isfinite(starts))
        ends = np.append(starts[fired], np.inf)[1:]
        for beat, end in zip(fired, ends, strict=True):
            inside = (time >= starts[beat]) & (time < end)
            if inside.any():
                peaks[probe, beat] = stress[inside, probe].max()
    return peaks


def _weighted(weights: Array, values: Array) -> tuple[Array, Array, Array]:
    """Weighted sum over points, and the smallest and largest of those that count, each ``(beats,)``."""
    used = np.abs(weights) > NEGLIGIBLE
    return weights[used] @ values[used], values[used].min(axis=0), values[used].max(axis=0)


def _around(space: SplineSpace, at: Array) -> tuple[NDArray[np.int64], Array, Array]:
    """The four collocation points around each parameter, weights of straight lines and of cubics, ``(n, 4)``."""
    points = space.greville()
    count = min(4, space.size)
    right = np.searchsorted(points, at, side="right")
    indices = np.clip(right - 2, 0, space.size - count)[:, None] + np.arange(count)
    near = np.clip(right - 1, 0, space.size - 2)[:, None] + np.arange(2)
    lines = np.zeros(indices.shape)
    np.put_along_axis(lines, near - indices[:, :1], _lagrange(points[near], at), axis=1)
    return indices, lines, _lagrange(points[indices], at)


def _lagrange(places: Array, at: Array) -> Array:
    """Weights of the values at ``places`` ``(n, count)`` in their polynomial's value at ``at`` ``(n,)``."""
    weights = np.ones_like(places)
    for i in range(places.shape[1]):
        for j in range(places.shape[1]):
            if i != j:
                weights[:, i] *= (at - places[:, j]) / (places[:, i] - places[:, j])
    return weights
