"""All measures of one experiment, from the histories of both sub-problems."""

from __future__ import annotations

import numpy as np

from stages.artefacts import (
    ActivationHistory,
    Deformation,
    ExcitableSurface,
    Measures,
    MidSurface,
)
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.numerics.time_series import blocks
from stages.postprocessing.beats import arrival_times, beat_peaks, conduction_velocity
from stages.postprocessing.config import PostprocessingConfig
from stages.postprocessing.curvature import arc_length, curvature_from_projection, widest_point
from stages.postprocessing.probes import (
    collocation_weights,
    control_weights,
    probe_parameters,
    resample,
    series,
)


def take_measures(
    config: PostprocessingConfig,
    history: ActivationHistory,
    surface: ExcitableSurface,
    mid_surface: MidSurface,
    deformation: Deformation,
) -> Measures:
    """Probe series at the mechanics times, curvature of the mid-axis, and the beats.

    Peaks are taken over the stored frames of the electrophysiology, which are closer together than
    the mechanics times.
    """
    film, cells = mid_surface.patch, surface.patch
    time = np.asarray(deformation.time, dtype=float)
    cell_time = np.asarray(history.time, dtype=float)
    theta = probe_parameters(film, np.array(list(config.probes.values())))
    at_cells = collocation_weights(cells, theta)
    stress = series(history.active_stress, at_cells)
    potential = series(history.potential, at_cells)
    events = np.asarray(history.activation_times, dtype=float)
    arrivals = arrival_times(cells, events, theta)

    window = np.array([(x, config.mid_axis) for x in config.velocity_window])
    gates = probe_parameters(film, window)
    way = np.linspace(gates[0], gates[1], _points_between(cells, gates))
    passing = arrival_times(cells, events, way)
    distance = float(np.linalg.norm(np.diff(film.evaluate_points(way), axis=0), axis=1).sum())

    projected, length = projected_lengths(film, deformation.displacement, float(gates[0, 1]))
    return Measures(
        probe_names=tuple(config.probes),
        time=time,
        probe_points=film.evaluate_points(theta),
        displacement=series(deformation.displacement, control_weights(film, theta)),
        active_stress=resample(stress, cell_time, time),
        potential=resample(potential, cell_time, time),
        projected_length=projected,
        curvature=np.array([curvature_from_projection(x, length) for x in projected]),
        activation_times=arrivals,
        peak_active_stress=beat_peaks(stress, cell_time, arrivals),
        conduction_velocity=conduction_velocity(passing, distance),
    )


def _points_between(cells: Patch, gates: Array) -> int:
    """Number of points that divides a line along X as finely as the collocation points."""
    greville = cells.first.greville()
    low, high = gates[:, 0]
    return int(((greville > low) & (greville < high)).sum()) + 2


def projected_lengths(film: Patch, displacement: Array, theta2: float) -> tuple[Array, float]:
    """Largest X of a deformed line theta2 = const over time, and the line's own length.

    Parameters
    ----------
    film
        Undeformed mid-surface, clamped at X = 0.
    displacement
        Of the control points, shape ``(time, control point, xyz)``, mm.
    theta2
        Parameter of the line.

    Returns
    -------
    projected
        Shape ``(time,)``, mm.
    length
        Length of the undeformed line, mm.

    Raises
    ------
    ValueError
        If the film is rational: flat films are not.
    """
    if film.weights is not None:
        raise ValueError(
            "the projected length belongs to a film that is flat at rest; this one has weights, as "
            "curved films have: use a patch without weights"
        )
    across = film.second.evaluate(np.array([theta2]))[0]
    line = np.einsum("j,ijx->ix", across, film.control_points)
    shape = (film.first.size, film.second.size)
    projected = np.empty(displacement.shape[0])
    for frames, block in blocks(displacement):
        moved = line[:, 0] + block[:, :, 0].reshape(-1, *shape) @ across
        projected[frames] = [widest_point(film.first, x) for x in moved]
    return projected, arc_length(film.first, line)
