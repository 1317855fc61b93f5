"""Stages `postprocessing` and `shape`: from histories to what an experimenter reads off the film."""

from __future__ import annotations

from pipeline.nodes import StageRun, stage
from stages.artefacts import (
    ActivationHistory,
    Deformation,
    Equilibria,
    ExcitableSurface,
    Measures,
    MidSurface,
    ShapeMeasures,
)
from stages.postprocessing.config import PostprocessingConfig, ShapeConfig


@stage
def postprocessing(
    config: PostprocessingConfig,
    history: ActivationHistory,
    surface: ExcitableSurface,
    mid_surface: MidSurface,
    deformation: Deformation,
) -> Measures:
    """Probe series, curvature, activation times, conduction velocity and peak stresses."""
    from stages.postprocessing.measures import take_measures

    return take_measures(config, history, surface, mid_surface, deformation)


@stage
def shape(
    config: ShapeConfig,
    mid_surface: MidSurface,
    deformation: Equilibria | Deformation,
    *,
    run: StageRun,
) -> ShapeMeasures:
    """Probe series, projected length and curvature of a film without cells of its own."""
    from stages.postprocessing.shapes import measure_shapes, self_contact

    measures = measure_shapes(config, mid_surface, deformation)
    closed = mid_surface.patch.closed[0]  # its mid-axis is a full circle at rest
    if isinstance(deformation, Deformation) and not closed:  # a quasi-static run has said so itself
        for warning in self_contact(measures):
            run.warn(warning)
    return measures
