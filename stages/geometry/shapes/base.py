"""What a shape is: how the film lies in space before anything acts on it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Literal, TypeAlias

from stages.configuration import OneOf, Section

if TYPE_CHECKING:  # a configuration is read without numpy
    from stages.numerics.patches import Patch

Elements: TypeAlias = tuple[int, int]
Direction: TypeAlias = Literal["X", "Y"]

Face: TypeAlias = Literal["top", "bottom"]
"""Faces of a film by its layers: the last layer of the lay-up, as a rule the muscle, is at the top."""


class Shape(Section):
    """A film without stress that is bent or doubly curved; a file of this folder holds one shape.

    Whatever the shape, length and width are lengths along the film, and so are the X and Y of probes,
    stimuli, supports and loads. The middle of the edge X = 0 lies at (0, width/2, 0), and the film leaves
    it along the X axis with its top face up, unless a shape says otherwise.
    """

    name: str

    @property
    def is_flat(self) -> bool:
        """Whether the film lies in the plane Z = 0, as the formulas of experiments suppose."""
        return False

    @property
    def closed(self) -> tuple[bool, bool]:
        """Whether the film runs into itself along X and along Y."""
        return False, False

    def problems(self, length: float, width: float) -> Iterator[str]:
        """Why a film of that length and width (mm) cannot have this shape, in words."""
        yield from ()

    def smallest_radius(self, length: float, width: float) -> float | None:
        """Smallest radius of curvature, mm; none: flat."""
        return None

    def unfit_mesh(self, degree: int, elements: Elements) -> Iterator[str]:
        """Why a mesh cannot follow this shape, in words."""
        yield from ()

    def patch(self, length: float, width: float, degree: int, elements: Elements) -> Patch:
        """Mid-surface on a mesh. The parameters mean the same points of the film on every mesh."""
        raise TypeError(f"{type(self).__name__} does not say its surface")


AnyShape: TypeAlias = Annotated[Shape, OneOf("stages.geometry.shapes", Shape)]
