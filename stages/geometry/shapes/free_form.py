"""Film whose mid-surface runs smoothly through measured or designed points."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from stages.configuration import quantity, unkeyed
from stages.geometry.shapes.base import Elements, Shape

if TYPE_CHECKING:
    from stages.numerics.patches import Patch

Point: TypeAlias = tuple[float, float, float]

CLOSE = 0.01
"""By this part the film's lengths may differ from those of the surface."""

FEWEST = 3
"""Points in each direction; fewer say nothing about how the film is bent."""


class FreeForm(Shape):
    """Points of the mid-surface in rows along X and columns along Y.

    The film is the smooth surface (C2 splines) through them. Its edges and corners are the outermost
    points, X runs from row to row and Y from column to column, and the top face is on the side of the
    normal, to which X, Y and it are right-handed. A file is read once, when the configuration is; its
    content enters the key.
    """

    name: Literal["free-form"] = "free-form"
    file: str | None = unkeyed(
        "CSV file with row, column and x, y, z [mm] of each point; its folder is that of the command",
        default=None,
    )
    points: tuple[tuple[Point, ...], ...] = quantity(
        "mm", "points (x, y, z) of each row", "this project", default=()
    )

    @model_validator(mode="before")
    @classmethod
    def _read_file(cls, data: Any) -> Any:
        if not isinstance(data, dict) or not isinstance(data.get("file"), str):
            return data
        from stages.geometry.point_grid import read_points

        if "points" in data:
            raise PydanticCustomError("grid", "give either a file or points, not both", {})
        return data | {"points": read_points(data["file"])}

    @model_validator(mode="after")
    def _is_a_grid(self) -> FreeForm:
        lengths = {len(row) for row in self.points}
        if len(lengths) > 1:
            raise PydanticCustomError(
                "grid",
                "all rows must have as many points, but they have {numbers}",
                {"numbers": ", ".join(str(len(row)) for row in self.points)},
            )
        columns = max(lengths, default=0)
        if len(self.points) < FEWEST or columns < FEWEST:
            raise PydanticCustomError(
                "grid",
                "needs a file, or points, with {fewest} rows and {fewest} columns at least, not {rows} x "
                "{columns}",
                {"fewest": FEWEST, "rows": len(self.points), "columns": columns},
            )
        return self

    def problems(self, length: float, width: float) -> Iterator[str]:
        """A surface that folds, or has other lengths than the film."""
        from stages.geometry.free_surface import FreeSurface

        try:
            surface = FreeSurface.through(self.points)
            surface.smallest_radius()
        except ValueError as error:
            yield str(error)
            return
        found = surface.size
        for name, given, is_long in (("length", length, found[0]), ("width", width, found[1])):
            if abs(given - is_long) > CLOSE * is_long:
                yield (
                    f"the {name} of the surface through the points is {is_long:.5g} mm along its middle, but "
                    f"geometry.{name} = {given:.10g} mm: set it to {is_long:.5g}, or scale the points"
                )

    def smallest_radius(self, length: float, width: float) -> float | None:
        """Over a grid of samples."""
        from stages.geometry.free_surface import FreeSurface

        return FreeSurface.through(self.points).smallest_radius()

    def patch(self, length: float, width: float, degree: int, elements: Elements) -> Patch:
        """Spline that meets the surface at its Greville points, with parameters by length."""
        from stages.geometry.free_surface import FreeSurface

        return FreeSurface.through(self.points).patch(degree, elements)


MODEL = FreeForm
