"""Flat film [0, L1] x [0, L2] at Z = 0 (sec. 4.1, Fig. 2)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from stages.geometry.shapes.base import Elements, Shape

if TYPE_CHECKING:
    from stages.numerics.patches import Patch


class Flat(Shape):
    """No parameters."""

    name: Literal["flat"] = "flat"

    @property
    def is_flat(self) -> bool:
        """It is."""
        return True

    def patch(self, length: float, width: float, degree: int, elements: Elements) -> Patch:
        """One bilinear patch, refined."""
        from stages.numerics.patches import Patch

        return Patch.rectangle(length, width).refine(degree, elements)


MODEL = Flat
