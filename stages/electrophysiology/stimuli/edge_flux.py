"""Current flux through an edge of the film, or through a part of it (eqs. 8, 78)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

from pydantic import model_validator

from stages.configuration import Edge, quantity, setting
from stages.electrophysiology.stimuli.base import Interval, Stimulus, check_interval

if TYPE_CHECKING:
    from stages.electrophysiology.point_cells import PointCells
    from stages.numerics.bsplines import Array


class EdgeFlux(Stimulus):
    """Where edges meet, a corner takes the sum of its edges' data."""

    kind: Literal["edge-flux"] = "edge-flux"
    edge: Edge = setting("edge that is stimulated", "sec. 4.3")
    extent: Interval | None = quantity(
        "mm",
        "part of the edge, from where to where along it; none: all of it",
        "this project",
        default=None,
    )
    flux: float = quantity("nF*mV/ms/mm", "inward flux I_n = n . D grad v", "sec. 4.3")

    @model_validator(mode="after")
    def _extent_runs_forward(self) -> EdgeFlux:
        if self.extent is not None:
            check_interval("extent", self.extent)
        return self

    def off_the_film(self, length: float, width: float) -> Iterator[str]:
        """An extent beyond the ends of the edge."""
        along = width if self.edge.startswith("X") else length
        if self.extent is not None and not (self.extent[0] >= 0 and self.extent[1] <= along):
            yield (
                f"extent = [{self.extent[0]:.10g}, {self.extent[1]:.10g}] mm reaches beyond the edge "
                f"{self.edge}, which runs from 0 to {along:.10g} mm"
            )

    def on_edge(self) -> str:
        """The edge that it crosses."""
        return self.edge

    def boundary(self, cells: PointCells) -> Array:
        """The flux times the part of each point's own interval that lies in the extent.

        So the flux over the whole edge is right on any mesh, and varies smoothly with the extent.
        """
        return self.flux * cells.share_of_edge(self.edge, self.extent)


MODEL = EdgeFlux
