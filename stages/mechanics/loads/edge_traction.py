"""Dead load along an edge."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from stages.configuration import Edge, quantity, setting
from stages.mechanics.loads.base import Load

if TYPE_CHECKING:
    from stages.mechanics.actions.forces.base import Force
    from stages.numerics.patches import Patch


class EdgeTraction(Load):
    """It keeps its direction and its total as the film deforms."""

    kind: Literal["edge-traction"] = "edge-traction"
    edge: Edge = setting("edge that is loaded", "this project")
    traction: tuple[float, float, float] = quantity(
        "kPa*mm", "force per undeformed length along X, Y, Z (1 kPa mm = 1 mN/mm)", "eq. 47"
    )

    def on(self, patch: Patch, points: int) -> Force:
        """F_I = integral of N_I t along the edge."""
        from stages.mechanics.actions.forces.dead import along_edge

        return along_edge(patch, self.edge, self.traction, points)


MODEL = EdgeTraction
