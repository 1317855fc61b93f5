"""Current applied to a disc of the film (eqs. 8, 73), such as the tip of a point electrode."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

from stages.configuration import quantity
from stages.electrophysiology.stimuli.base import Stimulus

if TYPE_CHECKING:
    from stages.electrophysiology.point_cells import PointCells
    from stages.numerics.bsplines import Array


class DiscCurrent(Stimulus):
    """A disc in the lengths X and Y; on a film that is no developable surface it is a disc in these only."""

    kind: Literal["disc-current"] = "disc-current"
    centre: tuple[float, float] = quantity("mm", "X and Y of the centre", "this project")
    radius: float = quantity("mm", "radius of the disc", "this project", gt=0)
    current: float = quantity("nF*mV/ms/mm^2", "applied current I_app", "eq. 8")

    def off_the_film(self, length: float, width: float) -> Iterator[str]:
        """A disc that reaches beyond an edge."""
        (x, y), r = self.centre, self.radius
        if not (r <= x <= length - r and r <= y <= width - r):
            yield (
                f"the stimulated disc of radius {r:.10g} mm about ({x:.10g}, {y:.10g}) mm reaches outside "
                f"the film [0, {length:.10g}] x [0, {width:.10g}] mm"
            )

    def interior(self, cells: PointCells) -> Array:
        """The current times the part of each point's own cell that lies in the disc."""
        return self.current * cells.share_of_disc(self.centre, self.radius)


MODEL = DiscCurrent
