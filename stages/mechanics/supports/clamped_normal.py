"""Clamped edge that may stretch: displacement and rotation are zero, and nothing else is."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Literal

from stages.configuration import Edge, setting
from stages.mechanics.supports.base import Support

if TYPE_CHECKING:
    from stages.mechanics.relations import Relation
    from stages.numerics.patches import Patch


class ClampedNormal(Support):
    """The first row of control points is held, and the next one's displacement along the normal.

    The edge does not move, so its rotation is that of the tangent across it; the tangent's change along
    the normal is that of the second row. Nothing hinders the film from stretching there.
    """

    kind: Literal["clamped-normal"] = "clamped-normal"
    edge: Edge = setting("edge that is held", "sec. 4.1")

    def relations(self, patch: Patch) -> Iterable[Relation]:
        """u = 0 on the first row, n . u = 0 on the second."""
        from stages.mechanics.edges import control_rows, edge_frame
        from stages.mechanics.relations import along, held

        first, second = control_rows(patch, self.edge)
        yield from held(first)
        yield from along(second, edge_frame(patch, self.edge).normal)


MODEL = ClampedNormal
