"""The mid-axis of the film over time: how long its projection is, how far it has turned."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.numerics.time_series import StoredFrames, blocks
from stages.postprocessing.curvature import arc_length, curvature_from_projection, widest_point

SAMPLES_PER_ELEMENT = 4
"""Tangents compared with one another; between two neighbours a film turns by far less than 180 degrees."""


@dataclass(frozen=True)
class AxisSeries:
    """A line theta2 = const of the film at every time.

    Attributes
    ----------
    projected_length
        Its largest X, mm, shape ``(time,)``.
    curvature
        From that and its own length (eq. 101), 1/mm, shape ``(time,)``.
    turning
        Largest angle between two of its tangents, seen along Y, degrees, shape ``(time,)``.
    """

    projected_length: Array
    curvature: Array
    turning: Array


def follow_axis(film: Patch, displacement: StoredFrames, theta2: float) -> AxisSeries:
    """Series of a line of the deformed film.

    Parameters
    ----------
    film
        Undeformed mid-surface, clamped at X = 0.
    displacement
        Of the control points, shape ``(time, control point, xyz)``, mm.
    theta2
        Parameter of the line.

    Raises
    ------
    ValueError
        If the film is rational: films that are flat at rest are not.
    """
    if film.weights is not None:
        raise ValueError(
            "the projected length belongs to a film that is flat at rest; this one has weights, as "
            "exact cylinders and spheres do: use a patch without weights"
        )
    across = film.second.evaluate(np.array([theta2]))[0]
    line = np.einsum("j,ijx->ix", across, film.control_points)
    samples = SAMPLES_PER_ELEMENT * film.first.elements + 1
    at = np.linspace(film.first.knots[0], film.first.knots[-1], samples)
    slopes = film.first.evaluate(at, 1)
    projected, turning = np.empty(displacement.shape[0]), np.empty(displacement.shape[0])
    for frames, block in blocks(displacement):
        net = block.reshape(len(block), film.first.size, film.second.size, 3)
        moved = line + np.einsum("tijx,j->tix", net, across)
        projected[frames] = [widest_point(film.first, x) for x in moved[:, :, 0]]
        tangents = np.einsum("si,tix->tsx", slopes, moved)
        angles = np.unwrap(np.arctan2(tangents[:, :, 2], tangents[:, :, 0]), axis=1)
        turning[frames] = np.degrees(np.ptp(angles, axis=1))
    length = arc_length(film.first, line)
    curvature = np.array([curvature_from_projection(x, length) for x in projected])
    return AxisSeries(projected, curvature, turning)
