"""What a force is: nodal forces as a function of the shape, and their derivative."""

from __future__ import annotations

from typing import Protocol

from stages.numerics.bands import GeneralBand
from stages.numerics.bsplines import Array


class Force(Protocol):
    """A load of size one on the discrete film; ``position`` is of the control points, (point, 3)."""

    @property
    def follows(self) -> bool:
        """Whether it depends on the shape, and therefore enters the tangent."""
        ...

    def at(self, position: Array) -> Array:
        """Nodal forces, kPa mm^2, shape ``(dof,)``."""
        ...

    def add_stiffness(self, position: Array, factor: float, matrix: GeneralBand) -> None:
        """Add ``factor`` times the derivative of the nodal forces by the displacement."""
        ...
