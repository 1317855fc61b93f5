"""Stimuli as data on the collocation points: where they act, and when."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stages.electrophysiology.config import EdgeFlux, PatchCurrent
from stages.numerics.bsplines import Array
from stages.numerics.collocation import CollocationOperators


@dataclass(frozen=True)
class Source:
    """Spatial pattern of one stimulus and the time for which it is on.

    Attributes
    ----------
    boundary
        Right-hand side of the boundary rows (eq. 78), nF mV/ms/mm, shape ``(point,)``.
    interior
        I_app of the interior rows (eq. 73), nF mV/ms/mm^2, shape ``(point,)``.
    start, stop
        On for ``start < t <= stop``, ms.
    """

    boundary: Array
    interior: Array
    start: float
    stop: float

    def amplitude(self, times: Array) -> Array:
        """1 while the stimulus is on and 0 otherwise, for each time.

        Times are compared with a tolerance of 1e-9 ms, so that ``n * step`` is on time in floating
        point too.
        """
        on = (times > self.start + 1e-9) & (times <= self.stop + 1e-9)
        return on.astype(float)


def sources(
    stimuli: Sequence[EdgeFlux | PatchCurrent], operators: CollocationOperators
) -> tuple[Source, ...]:
    """Patterns of all stimuli; where edges meet, a corner takes the sum of its edges' data.

    Raises
    ------
    ValueError
        If a rectangle holds no collocation point.
    """
    made = []
    for stimulus in stimuli:
        boundary = np.zeros(operators.interior.size)
        interior = np.zeros(operators.interior.size)
        if isinstance(stimulus, EdgeFlux):
            boundary[operators.edges[stimulus.edge]] = stimulus.flux
        else:
            x, y = operators.frame.position[:, 0], operators.frame.position[:, 1]
            inside = (
                (x >= stimulus.x[0])
                & (x <= stimulus.x[1])
                & (y >= stimulus.y[0])
                & (y <= stimulus.y[1])
                & operators.interior
            )
            if not inside.any():
                raise ValueError(
                    f"the stimulated rectangle X {stimulus.x}, Y {stimulus.y} mm holds no "
                    "collocation point: move it onto the film, enlarge it, or refine the mesh"
                )
            interior[inside] = stimulus.current
        made.append(Source(boundary, interior, stimulus.start, stimulus.start + stimulus.duration))
    return tuple(made)
