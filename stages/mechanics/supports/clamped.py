"""Clamped edge: displacement and rotation are zero, by two rows of control points."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Literal

from stages.configuration import Edge, setting
from stages.mechanics.supports.base import Support

if TYPE_CHECKING:
    from stages.numerics.patches import Patch
    from stages.numerics.ties import Relation


class Clamped(Support):
    """Two rows of control points are held in all components.

    This is common practice. It also holds the stretch normal to the edge, an over-constraint that
    fades with the size of the elements.
    """

    kind: Literal["clamped"] = "clamped"
    edge: Edge = setting("edge that is held", "sec. 4.1")

    def relations(self, patch: Patch) -> Iterable[Relation]:
        """Every component of the first two rows is zero."""
        from stages.mechanics.actions.edges import control_rows
        from stages.mechanics.actions.relations import held

        for row in control_rows(patch, self.edge):
            yield from held(row)


MODEL = Clamped
