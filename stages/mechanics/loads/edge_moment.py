"""Moment about an edge, which turns with it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from stages.configuration import Edge, quantity, setting
from stages.mechanics.loads.base import Load

if TYPE_CHECKING:
    from stages.mechanics.actions.forces.base import Force
    from stages.numerics.patches import Patch


class EdgeMomentLoad(Load):
    """A couple that rolls the film up, towards its normal a_3 where positive."""

    kind: Literal["edge-moment"] = "edge-moment"
    edge: Edge = setting("edge that is loaded", "this project")
    moment: float = quantity(
        "kPa*mm^2",
        "moment per undeformed length about the edge (1 kPa mm^2 = 1 mN)",
        "this project",
    )

    def on(self, patch: Patch, points: int) -> Force:
        """F_I = integral of m N_I,n a_3 along the edge."""
        from stages.mechanics.actions.forces.edge_moment import EdgeMoment
        from stages.mechanics.actions.forces.scaled import Scaled

        return Scaled(self.moment, EdgeMoment.on(patch, self.edge, points))


MODEL = EdgeMomentLoad
