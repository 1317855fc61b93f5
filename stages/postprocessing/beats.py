"""Beats: when the wave reaches a point, how fast it travels, how hard the muscle pulls."""

from __future__ import annotations

import numpy as np

from stages.numerics.bsplines import Array, SplineSpace
from stages.numerics.patches import Patch
from stages.postprocessing.probes import collocation_weights


def arrival_times(surface: Patch, activation_times: Array, theta: Array) -> Array:
    """Activation times at parameters ``theta``, beat by beat.

    Through the spline over all collocation points if all of them fired in that beat; else linear
    between the up to four points around ``theta``, NaN if one of these did not fire.

    Parameters
    ----------
    surface
        Excitable surface.
    activation_times
        At the collocation points, shape ``(points, beats)``, NaN where a point did not fire, ms.
    theta
        Shape ``(probes, 2)``.

    Returns
    -------
    Array
        Shape ``(probes, beats)``, ms.
    """
    times = np.asarray(activation_times, dtype=float)
    smooth = collocation_weights(surface, theta) @ np.nan_to_num(times)
    everywhere = np.isfinite(times).all(axis=0)
    return np.where(everywhere, smooth, _bilinear(surface, times, theta))


def conduction_velocity(arrivals: Array, distance: float) -> Array:
    """Mean speed of the front between two points, per beat.

    Parameters
    ----------
    arrivals
        Activation times at the start and at the end, shape ``(2, beats)``, ms.
    distance
        Length of the way between them on the undeformed film, mm.

    Returns
    -------
    Array
        Shape ``(beats,)``, mm/ms; negative for a wave that comes the other way, NaN where it did not
        pass both points or reached both at once.
    """
    delay = arrivals[1] - arrivals[0]
    return distance / np.where(delay == 0, np.nan, delay)


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


def _bilinear(surface: Patch, times: Array, theta: Array) -> Array:
    grid = times.reshape(surface.first.size, surface.second.size, -1)
    total = np.zeros((len(theta), grid.shape[2]))
    rows, row_weights = _neighbours(surface.first, theta[:, 0])
    columns, column_weights = _neighbours(surface.second, theta[:, 1])
    for a in range(2):
        for b in range(2):
            weight = (row_weights[a] * column_weights[b])[:, None]
            corner = grid[rows[a], columns[b]]
            total += np.where(weight > 0, weight * corner, 0.0)
    return total


def _neighbours(space: SplineSpace, at: Array) -> tuple[Array, Array]:
    """Indices and linear weights of the two collocation points around each parameter, ``(2, n)``."""
    points = space.greville()
    left = np.clip(np.searchsorted(points, at, side="right") - 1, 0, space.size - 2)
    fraction = (at - points[left]) / (points[left + 1] - points[left])
    return np.stack((left, left + 1)), np.stack((1 - fraction, fraction))
