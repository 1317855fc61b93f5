"""Edge that is moved: chosen components of its displacement are prescribed over time."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

from stages.configuration import Edge, setting
from stages.mechanics.supports.base import MovingSupport

if TYPE_CHECKING:
    from stages.numerics.patches import Patch
    from stages.numerics.ties import Relation


class Displacement(MovingSupport):
    """The edge's row of control points moves as one; the edge may turn, or keeps its direction.

    With ``rotation = "held"`` it is a clamp that is moved without being turned: the second row of
    control points follows the first one along the normal.
    """

    kind: Literal["displacement"] = "displacement"
    edge: Edge = setting("edge that is moved", "this project")
    rotation: Literal["free", "held"] = setting(
        "whether the edge may turn about itself", "this project", default="free"
    )

    def relations(self, patch: Patch) -> Iterator[Relation]:
        """The components of the first row are those prescribed."""
        from stages.mechanics.actions.edges import control_rows, turning_rows
        from stages.mechanics.actions.relations import moved

        yield from moved(control_rows(patch, self.edge)[0], self.prescribed)
        if self.rotation == "held":
            yield from turning_rows(patch, self.edge, moving=True)


MODEL = Displacement
