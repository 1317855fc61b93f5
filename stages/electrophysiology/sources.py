"""Stimuli as data on the collocation points: where they act, and when."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from stages.electrophysiology.point_cells import PointCells
from stages.electrophysiology.pulse_train import PulseTrain, train_of
from stages.electrophysiology.stimuli.base import Stimulus
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch


@dataclass(frozen=True)
class Source:
    """Spatial pattern of one stimulus, and its pulses.

    Attributes
    ----------
    boundary
        Right-hand side of the boundary rows (eq. 78), nF mV/ms/mm, shape ``(point,)``.
    interior
        I_app of the interior rows (eq. 73), nF mV/ms/mm^2, shape ``(point,)``.
    pulses
        Factor on both over time.
    """

    boundary: Array
    interior: Array
    pulses: PulseTrain


def sources(stimuli: Sequence[Stimulus], patch: Patch) -> tuple[Source, ...]:
    """Patterns of all stimuli on the Greville points of a patch.

    Raises
    ------
    ValueError
        If a stimulus lies beside the film.
    """
    cells = PointCells.of(patch)
    return tuple(
        Source(stimulus.boundary(cells), stimulus.interior(cells), train_of(stimulus))
        for stimulus in stimuli
    )
