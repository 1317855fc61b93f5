"""Film bent to a part of a cylinder."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

from stages.configuration import quantity, setting
from stages.geometry.shapes.base import Direction, Elements, Face, Shape

if TYPE_CHECKING:
    from stages.numerics.patches import Patch


class Cylinder(Shape):
    """The mid-surface is an arc times a straight line.

    Bent about Y, the film rises from its edge X = 0 like a scroll; bent about X, it is a gutter whose
    lowest line is its mid-axis.
    """

    name: Literal["cylinder"] = "cylinder"
    radius: float = quantity("mm", "radius of the mid-surface", "this project", gt=0)
    axis: Direction = setting("direction of the axis about which the film is bent", "this project")
    inside: Face = setting("face of the film towards the axis", "this project", default="top")

    def smallest_radius(self, length: float, width: float) -> float:
        """That of the cylinder."""
        return self.radius

    def problems(self, length: float, width: float) -> Iterator[str]:
        """An arc of a full turn or more."""
        name, along = ("length", length) if self.axis == "Y" else ("width", width)
        around = 2.0 * math.pi * self.radius
        if along >= around:
            yield (
                f"a {name} of {along:g} mm goes {along / around:.3g} times around a cylinder of radius "
                f"{self.radius:g} mm: the radius must be above {along / (2.0 * math.pi):.4g} mm; a film "
                f"that closes is a tube"
            )

    def patch(self, length: float, width: float, degree: int, elements: Elements) -> Patch:
        """An exact rational arc below half a turn; beyond, a spline through points of the arc."""
        from stages.geometry.bending import arc, bent, line

        if self.axis == "Y":
            profile = arc(self.radius, 0.0, length, degree, elements[0])
            straight = line(width, degree, elements[1])
        else:
            profile = arc(self.radius, -0.5 * width, 0.5 * width, degree, elements[1])
            straight = line(length, degree, elements[0])
        return bent(profile, straight, self.axis, 0.5 * width, self.inside)


MODEL = Cylinder
