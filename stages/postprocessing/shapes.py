"""All measures of a film under imposed activation, from its shapes alone."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from stages.artefacts import Deformation, Equilibria, MidSurface, ShapeMeasures
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.numerics.projection import GaussProjection
from stages.numerics.quadrature import quadrature_grid
from stages.numerics.surface_geometry import frame_on_grid
from stages.postprocessing.axis import follow_axis
from stages.postprocessing.config import ShapeConfig
from stages.postprocessing.probes import (
    axis_parameter,
    control_weights,
    place_parameters,
    series,
)

FULL_CIRCLE = 360.0
"""Degrees."""


def measure_shapes(
    config: ShapeConfig, mid_surface: MidSurface, deformation: Equilibria | Deformation
) -> ShapeMeasures:
    """Probe series and curvature at every frame.

    Fibre stretch and active stress are known at the Gauss points; at a probe they are those of the
    spline nearest to them in the mean.
    """
    film = mid_surface.patch
    theta = place_parameters(film, config.probes.values())
    tip = place_parameters(film, ["tip"])
    points = deformation.fibre_stretch.shape[1]
    projection = GaussProjection.onto(film, points, theta[:, 0], theta[:, 1]).at_points()
    axis = follow_axis(film, deformation.displacement, axis_parameter(film, config.mid_axis))
    time = np.asarray(deformation.time, dtype=float)
    factor = deformation.load_factor if isinstance(deformation, Equilibria) else np.ones(time.size)
    return ShapeMeasures(
        probe_names=tuple(config.probes),
        time=time,
        load_factor=np.asarray(factor, dtype=float),
        probe_points=film.evaluate_points(theta),
        displacement=series(deformation.displacement, control_weights(film, theta)),
        fibre_stretch=series(deformation.fibre_stretch, projection),
        active_stress=series(deformation.active_stress, projection),
        tip=series(deformation.displacement, control_weights(film, tip))[:, 0],
        projected_length=axis.projected_length,
        curvature=axis.curvature,
        turning=axis.turning,
        mean_active_stress=series(deformation.active_stress, _mean(film, points))[:, 0],
    )


def self_contact(measures: ShapeMeasures) -> Iterator[str]:
    """A warning if the film rolls past a full circle, where it would touch itself."""
    beyond = np.flatnonzero(measures.turning > FULL_CIRCLE)
    if beyond.size:
        yield (
            f"from t = {measures.time[beyond[0]]:g} ms on the film is rolled past a full circle (its "
            f"tangent turns by up to {measures.turning.max():.0f} degrees): it would touch itself, "
            "and contact is not modelled"
        )


def _mean(film: Patch, points: int) -> Array:
    """Weights of the mean over the area of the undeformed film."""
    per_element = round((points / (film.first.elements * film.second.elements)) ** 0.5)
    grid = quadrature_grid(film, per_element)
    area = frame_on_grid(film, grid.theta1, grid.theta2).area
    weights = np.outer(grid.weights1, grid.weights2).ravel() * area
    return np.asarray(weights / weights.sum())[None, :]
