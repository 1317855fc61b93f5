"""Stage `postprocessing`: from the histories to what an experimenter would read off the film."""

from __future__ import annotations

from pipeline.nodes import stage
from stages.artefacts import (
    ActivationHistory,
    Deformation,
    ExcitableSurface,
    Measures,
    MidSurface,
)
from stages.postprocessing.config import PostprocessingConfig


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
