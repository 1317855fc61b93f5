"""Clamped edge that may stretch: displacement and rotation are zero, and nothing else is."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Literal

from stages.configuration import Edge, setting
from stages.mechanics.supports.base import Support

if TYPE_CHECKING:
    from stages.numerics.patches import Patch
    from stages.numerics.ties import Relation


class ClampedNormal(Support):
    """The first row of control points is held, and of the next one what turns the edge.

    The edge does not move, so its rotation is that of the tangent across it, whose change along the
    normal is that of the second row. Nothing hinders the film from stretching there. Where the normal
    varies along the edge, the rotation is zero at the Greville points.
    """

    kind: Literal["clamped-normal"] = "clamped-normal"
    edge: Edge = setting("edge that is held", "sec. 4.1")

    def relations(self, patch: Patch) -> Iterable[Relation]:
        """u = 0 on the first row, n . u = 0 along the second."""
        from stages.mechanics.actions.edges import control_rows, turning_rows
        from stages.mechanics.actions.relations import held

        yield from held(control_rows(patch, self.edge)[0])
        yield from turning_rows(patch, self.edge)


MODEL = ClampedNormal
