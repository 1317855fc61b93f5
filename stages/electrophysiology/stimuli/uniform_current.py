"""Current applied to all cells at once (eqs. 8, 73): field stimulation, or a cell of its own."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

from stages.configuration import quantity
from stages.electrophysiology.stimuli.base import Stimulus

if TYPE_CHECKING:
    from stages.electrophysiology.point_cells import PointCells
    from stages.numerics.bsplines import Array


class UniformCurrent(Stimulus):
    """Its size alone."""

    kind: Literal["uniform-current"] = "uniform-current"
    current: float = quantity("nF*mV/ms/mm^2", "applied current I_app", "eq. 8")

    def off_the_film(self, length: float, width: float) -> Iterator[str]:
        """Nothing: it acts on whatever film there is."""
        return iter(())

    def interior(self, cells: PointCells) -> Array:
        """The current at every point inside."""
        x, y = cells.x, cells.y
        whole = (float(x[0]), float(x[-1])), (float(y[0]), float(y[-1]))
        return self.current * cells.share_of_rectangle(*whole)


MODEL = UniformCurrent
