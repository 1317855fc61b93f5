"""A stage that hands any stress history to the mechanics, for runs through the engine."""

from __future__ import annotations

import numpy as np
from pydantic import BaseModel

from pipeline.nodes import stage
from stages.artefacts import StressSamples


class JumpConfig(BaseModel):
    """Uniform active stress that jumps from 0 to ``stress`` (kPa) after ``step``."""

    duration: float
    n_steps: int
    points: int
    step: int
    stress: float


@stage
def jump(config: JumpConfig) -> StressSamples:
    """The stress at the quadrature points and times of the mechanics."""
    time = np.linspace(0.0, config.duration, config.n_steps + 1)
    late = np.arange(config.n_steps + 1) > config.step
    return StressSamples(time, np.where(late, config.stress, 0.0)[:, None] * np.ones(config.points))
