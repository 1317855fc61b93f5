"""Film that closes to a tube."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

from stages.configuration import setting
from stages.geometry.shapes.base import Direction, Elements, Face, Shape

if TYPE_CHECKING:
    from stages.numerics.patches import Patch


class Tube(Shape):
    """Along X: the width is the circumference, and the edges Y = 0 and Y = L2 are one seam at the top.

    Along Y: the length is the circumference, and the seam is where X = 0 and X = L1. There is no
    edge at a seam, so that nothing can be held, loaded or stimulated there as at an edge.
    """

    name: Literal["tube"] = "tube"
    axis: Direction = setting("direction of the tube", "this project")
    inside: Face = setting("face of the film inside the tube", "this project", default="top")

    @property
    def closed(self) -> tuple[bool, bool]:
        """The direction around."""
        return self.axis == "Y", self.axis == "X"

    def smallest_radius(self, length: float, width: float) -> float:
        """Circumference over 2 pi."""
        return (length if self.axis == "Y" else width) / (2.0 * math.pi)

    def unfit_mesh(self, degree: int, elements: Elements) -> Iterator[str]:
        """Too few spans around for a periodic spline."""
        direction = int(self.axis == "X")
        if elements[direction] <= degree:
            yield (
                f"{elements[direction]} elements along {'XY'[direction]} are too few around a tube: splines of "
                f"degree {degree} need {degree + 1} at least"
            )

    def patch(self, length: float, width: float, degree: int, elements: Elements) -> Patch:
        """A periodic spline around, as smooth across the seam as elsewhere."""
        from stages.geometry.bending import bent, line, ring

        if self.axis == "Y":
            profile, straight = ring(length, degree, elements[0]), line(width, degree, elements[1])
        else:
            profile, straight = ring(width, degree, elements[1]), line(length, degree, elements[0])
        return bent(profile, straight, self.axis, 0.5 * width, self.inside)


MODEL = Tube
