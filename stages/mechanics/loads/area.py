"""Dead load per area of the undeformed film, such as its weight."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from stages.configuration import quantity
from stages.mechanics.loads.base import Load

if TYPE_CHECKING:
    from stages.mechanics.actions.forces.base import Force
    from stages.numerics.patches import Patch


class AreaLoad(Load):
    """It keeps its direction and its total as the film deforms."""

    kind: Literal["area"] = "area"
    traction: tuple[float, float, float] = quantity(
        "kPa", "force per undeformed area along X, Y, Z", "eq. 47"
    )

    def on(self, patch: Patch, points: int) -> Force:
        """F_I = integral of N_I q."""
        from stages.mechanics.actions.forces.dead import over_area

        return over_area(patch, self.traction, points)


MODEL = AreaLoad
