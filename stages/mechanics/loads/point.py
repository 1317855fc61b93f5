"""Dead load at one material point."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from stages.configuration import quantity, setting
from stages.mechanics.loads.base import Load

if TYPE_CHECKING:
    from stages.mechanics.actions.forces.base import Force
    from stages.numerics.patches import Patch


class PointLoad(Load):
    """It keeps its direction; the deflection of a thin film under it is finite."""

    kind: Literal["point"] = "point"
    position: tuple[float, float] | None = quantity(
        "mm", "X and Y of the point in the undeformed film", "this project", default=None
    )
    parameters: tuple[float, float] | None = setting(
        "theta1 and theta2 of the point, where X and Y do not tell it", "this project", default=None
    )
    force: tuple[float, float, float] = quantity(
        "kPa*mm^2", "force along X, Y, Z (1 kPa mm^2 = 1 mN)", "this project"
    )

    @model_validator(mode="after")
    def _is_at_one_place(self) -> PointLoad:
        if (self.position is None) == (self.parameters is None):
            raise PydanticCustomError(
                "point_load_place", "needs a place: give either position = [X, Y] or parameters"
            )
        return self

    def on(self, patch: Patch, points: int) -> Force:
        """F_I = N_I P."""
        from stages.mechanics.actions.forces.dead import at_parameters, at_position

        if self.position is not None:
            return at_position(patch, self.position, self.force)
        assert self.parameters is not None
        return at_parameters(patch, self.parameters, self.force)


MODEL = PointLoad
