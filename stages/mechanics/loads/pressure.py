"""Pressure that stays normal to the film."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from stages.configuration import quantity
from stages.mechanics.loads.base import Load

if TYPE_CHECKING:
    from stages.mechanics.actions.forces.base import Force
    from stages.numerics.patches import Patch


class PressureLoad(Load):
    """Per area of the deformed film, along its normal a_3: from below where positive."""

    kind: Literal["pressure"] = "pressure"
    pressure: float = quantity("kPa", "pressure along the film's normal", "this project")

    def on(self, patch: Patch, points: int) -> Force:
        """F_I = integral of p N_I a_3 over the deformed film; exact with points of its own."""
        from stages.mechanics.actions.forces.pressure import Pressure
        from stages.mechanics.actions.forces.scaled import Scaled

        return Scaled(self.pressure, Pressure.on(patch))


MODEL = PressureLoad
