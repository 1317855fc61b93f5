"""Symmetry edge: the film goes on as its mirror image beyond the plane of this edge."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Literal

from stages.configuration import Edge, setting
from stages.mechanics.supports.base import Support

if TYPE_CHECKING:
    from stages.numerics.patches import Patch
    from stages.numerics.ties import Relation


class Symmetry(Support):
    """The edge stays in its plane, and the film crosses that plane at a right angle.

    The mirrored spline surface has the first two rows of control points, and those two mirrored, around
    the plane. It is C1 if the second row differs from the first one along the normal of the plane only;
    that holds at any rotation.
    """

    kind: Literal["symmetry"] = "symmetry"
    edge: Edge = setting("edge in the plane of symmetry", "this project")

    def relations(self, patch: Patch) -> Iterable[Relation]:
        """n . u = 0 on the first row; along the plane both rows move alike."""
        import numpy as np

        from stages.mechanics.actions.edges import control_rows, symmetry_plane
        from stages.mechanics.actions.relations import along, together

        first, second = control_rows(patch, self.edge)
        normal, *in_plane = symmetry_plane(patch, self.edge)
        yield from along(first, np.tile(normal, (first.size, 1)))
        for direction in in_plane:
            yield from together(first, second, np.tile(direction, (first.size, 1)))


MODEL = Symmetry
