"""Current applied to a rectangle of the film (eqs. 8, 73)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

from pydantic import model_validator

from stages.configuration import quantity
from stages.electrophysiology.stimuli.base import Interval, Stimulus, check_interval

if TYPE_CHECKING:
    from stages.electrophysiology.point_cells import PointCells
    from stages.numerics.bsplines import Array


class PatchCurrent(Stimulus):
    """Sides along X and Y."""

    kind: Literal["patch-current"] = "patch-current"
    x: Interval = quantity("mm", "extent along X", "eq. 8")
    y: Interval = quantity("mm", "extent along Y", "eq. 8")
    current: float = quantity("nF*mV/ms/mm^2", "applied current I_app", "eq. 8")

    @model_validator(mode="after")
    def _extents_run_forward(self) -> PatchCurrent:
        check_interval("x", self.x)
        check_interval("y", self.y)
        return self

    def off_the_film(self, length: float, width: float) -> Iterator[str]:
        """Sides beyond the film."""
        (left, right), (low, high) = self.x, self.y
        if not (left >= 0 and right <= length and low >= 0 and high <= width):
            yield (
                f"the stimulated rectangle [{left:.10g}, {right:.10g}] x [{low:.10g}, {high:.10g}] mm "
                f"reaches outside the film [0, {length:.10g}] x [0, {width:.10g}] mm"
            )

    def interior(self, cells: PointCells) -> Array:
        """The current times the part of each point's own cell that lies in the rectangle."""
        return self.current * cells.share_of_rectangle(self.x, self.y)


MODEL = PatchCurrent
