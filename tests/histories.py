"""Made-up histories of cells, with as much of the beats as a test cares for."""

from __future__ import annotations

from typing import Any

import numpy as np

from stages.artefacts import ActivationHistory


def history_with(
    time: np.ndarray,
    potential: np.ndarray,
    active_stress: np.ndarray,
    activation_times: np.ndarray,
    **maps: Any,
) -> ActivationHistory:
    """History whose maps hold NaN, except those given."""
    unknown = np.full_like(activation_times, np.nan)
    names = ("repolarisation_times", "apd50", "apd90", "peak_potential")
    velocity = np.full((*activation_times.shape, 3), np.nan)
    fields = dict.fromkeys(names, unknown) | {"conduction_velocity": velocity} | maps
    return ActivationHistory(time, potential, active_stress, activation_times, **fields)
