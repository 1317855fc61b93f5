"""Film that is a part of a sphere, between two meridians and two parallels."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

from stages.configuration import quantity, setting
from stages.geometry.shapes.base import Elements, Face, Shape

if TYPE_CHECKING:
    from stages.numerics.patches import Patch

LARGEST = 170.0
"""Degrees; of one rational arc from pole to pole 180 would be left, without a normal at the poles."""


class SphereSegment(Shape):
    """Its mid-axis lies on the equator, its other middle line on a meridian; both are great circles.

    Length and width belong to these two: parallels are shorter, by the cosine of their latitude. X is
    measured along the equator and Y along the meridian, everywhere.
    """

    name: Literal["sphere-segment"] = "sphere-segment"
    radius: float = quantity("mm", "radius of the mid-surface", "this project", gt=0)
    inside: Face = setting("face of the film towards the centre", "this project", default="top")

    def smallest_radius(self, length: float, width: float) -> float:
        """That of the sphere."""
        return self.radius

    def problems(self, length: float, width: float) -> Iterator[str]:
        """Segments that reach a pole or the other side."""
        for name, along in (("length", length), ("width", width)):
            opening = math.degrees(along / self.radius)
            if opening > LARGEST:
                yield (
                    f"a {name} of {along:g} mm on a sphere of radius {self.radius:g} mm opens by {opening:.4g} "
                    f"degrees, but at most {LARGEST:g} are possible: the radius must be at least "
                    f"{along / math.radians(LARGEST):.4g} mm"
                )

    def patch(self, length: float, width: float, degree: int, elements: Elements) -> Patch:
        """Exact: two rational arcs."""
        from stages.geometry.bending import sphere

        exact = sphere(self.radius, length, width, self.inside)
        return exact.refine(degree, elements)


MODEL = SphereSegment
