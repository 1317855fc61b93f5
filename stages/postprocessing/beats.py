"""Beats: when the wave reaches a point, how fast it travels, how hard the muscle pulls."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from stages.numerics.bsplines import Array, SplineSpace
from stages.numerics.patches import Patch
from stages.numerics.waves import matching, taken

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

    Linear between the up to four collocation points around ``theta``, whose events are matched in
    time: where one point has missed a wave, column k of two neighbours may belong to different waves.
    NaN where a neighbour did not fire in that beat.

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
    rows, row_weights = _neighbours(surface.first, theta[:, 0])
    columns, column_weights = _neighbours(surface.second, theta[:, 1])
    found = {name: np.full((len(theta), shape[2]), np.nan) for name in maps}
    for probe in range(len(theta)):
        weights = np.outer(row_weights[:, probe], column_weights[:, probe]).ravel()
        around = np.ix_(rows[:, probe], columns[:, probe])
        corners = times[around].reshape(4, -1)
        waves = matching(corners[[np.argmax(weights)]], corners)
        used = weights > 0.0
        for name, grid in grids.items():
            values = taken(grid[around].reshape(4, -1), waves)
            found[name][probe] = weights[used] @ values[used]
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


def _neighbours(space: SplineSpace, at: Array) -> tuple[Array, Array]:
    """Indices and linear weights of the two collocation points around each parameter, ``(2, n)``."""
    points = space.greville()
    left = np.clip(np.searchsorted(points, at, side="right") - 1, 0, space.size - 2)
    fraction = (at - points[left]) / (points[left + 1] - points[left])
    return np.stack((left, left + 1)), np.stack((1 - fraction, fraction))
