"""All measures of a coupled experiment, from the histories of both sub-problems."""

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
from stages.numerics.film_lengths import FilmLengths, length_between
from stages.numerics.patches import Patch
from stages.postprocessing.axis import follow_axis
from stages.postprocessing.beats import arrival_times, beat_peaks, beats_at, conduction_velocity
from stages.postprocessing.config import PostprocessingConfig
from stages.postprocessing.probes import (
    axis_parameter,
    collocation_weights,
    control_weights,
    place_parameters,
    resample,
    series,
)
from stages.postprocessing.tip_paths import no_tips, tip_paths

BEAT_MAPS = (
    "activation_times",
    "repolarisation_times",
    "apd50",
    "apd90",
    "peak_potential",
)
"""What is measured of every beat at every point, and interpolated to the probes."""


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
    theta = place_parameters(film, config.probes.values())
    theta2 = axis_parameter(film, config.mid_axis)
    at_cells = collocation_weights(cells, theta)
    stress = series(history.active_stress, at_cells)
    potential = series(history.potential, at_cells)
    events = np.asarray(history.activation_times, dtype=float)
    maps = {name: np.asarray(getattr(history, name), dtype=float) for name in BEAT_MAPS}
    beats = beats_at(cells, events, theta, maps)
    arrivals = beats["activation_times"]

    gates = FilmLengths(film).parameters_along(0, np.array(config.velocity_window))
    way = np.linspace(gates[0], gates[1], _points_between(cells, gates))
    passing = arrival_times(cells, events, np.column_stack((way, np.full(way.size, theta2))))
    distance = length_between(cells, theta2, gates)

    level = config.tip_potential
    axis = follow_axis(film, deformation.displacement, theta2)
    return Measures(
        probe_names=tuple(config.probes),
        time=time,
        probe_points=film.evaluate_points(theta),
        displacement=series(deformation.displacement, control_weights(film, theta)),
        active_stress=resample(stress, cell_time, time),
        potential=resample(potential, cell_time, time),
        projected_length=axis.projected_length,
        curvature=axis.curvature,
        **beats,
        peak_active_stress=beat_peaks(stress, cell_time, arrivals),
        conduction_velocity=conduction_velocity(passing, distance),
        tips=no_tips() if level is None else tip_paths(cells, history, level),
    )


def _points_between(cells: Patch, gates: Array) -> int:
    """Number of points that divides a line along X as finely as the collocation points."""
    greville = cells.first.greville()
    low, high = gates
    return int(((greville > low) & (greville < high)).sum()) + 2
