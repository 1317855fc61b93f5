"""Tips of spiral waves: where they are, how they turn, and the paths that they take."""

from __future__ import annotations

import numpy as np

from stages.artefacts import TipPaths


def no_tips() -> TipPaths:
    """What there is to tell where no tips were looked for."""
    nothing = np.empty(0)
    return TipPaths(nothing, nothing, np.empty((0, 3)), nothing, nothing)
