"""One material point of the film, held or moved in chosen components."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

from stages.configuration import quantity
from stages.mechanics.supports.base import MovingSupport

if TYPE_CHECKING:
    from stages.numerics.patches import Patch
    from stages.numerics.ties import Relation


class Point(MovingSupport):
    """A point inside the film is a relation between the control points around it."""

    kind: Literal["point"] = "point"
    position: tuple[float, float] = quantity("mm", "X and Y in the undeformed film", "this project")

    def relations(self, patch: Patch) -> Iterator[Relation]:
        """sum_i N_i(theta) u_i is the displacement prescribed, component by component."""
        import numpy as np

        from stages.mechanics.actions.points import functions_over
        from stages.mechanics.actions.relations import COMPONENTS, weighted

        functions = functions_over(patch, self.position)
        points = [int(i) for i in np.flatnonzero(functions)]
        weights = [float(functions[i]) for i in points]
        for component, value in self.prescribed.items():
            direction = np.eye(3)[COMPONENTS.index(component)]
            yield weighted(points, weights, direction, value)


MODEL = Point
