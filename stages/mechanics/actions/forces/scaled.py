"""A multiple of a force."""

from __future__ import annotations

from dataclasses import dataclass

from stages.mechanics.actions.forces.base import Force
from stages.numerics.bands import GeneralBand
from stages.numerics.bsplines import Array


@dataclass(frozen=True)
class Scaled:
    """``size`` times a force of size one."""

    size: float
    unit: Force

    @property
    def follows(self) -> bool:
        """As the force itself."""
        return self.unit.follows

    def at(self, position: Array) -> Array:
        """Nodal forces, kPa mm^2, shape ``(dof,)``."""
        return self.size * self.unit.at(position)

    def add_stiffness(self, position: Array, factor: float, matrix: GeneralBand) -> None:
        """Add ``factor`` times the derivative of the nodal forces by the displacement."""
        self.unit.add_stiffness(position, self.size * factor, matrix)
