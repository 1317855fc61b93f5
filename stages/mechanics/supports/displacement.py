"""Edge that is moved: chosen components of its displacement are prescribed over time."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Literal

from stages.configuration import Edge, setting
from stages.mechanics.supports.base import MovingSupport

if TYPE_CHECKING:
    from stages.numerics.patches import Patch
    from stages.numerics.ties import Relation


class Displacement(MovingSupport):
    """The edge's row of control points moves as one; the edge may turn."""

    kind: Literal["displacement"] = "displacement"
    edge: Edge = setting("edge that is moved", "this project")

    def relations(self, patch: Patch) -> Iterable[Relation]:
        """The components of the first row are those prescribed."""
        from stages.mechanics.edges import control_rows
        from stages.mechanics.relations import moved

        return moved(control_rows(patch, self.edge)[0], self.prescribed)


MODEL = Displacement
