"""What a support is: a table of the configuration that turns into relations between control points."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Literal

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from stages.configuration import Section, quantity, setting
from stages.time_laws.base import AnyTimeLaw, TimeLaw

if TYPE_CHECKING:  # a configuration is read without numpy
    from stages.numerics.patches import Patch
    from stages.numerics.ties import Relation

Component = Literal["x", "y", "z"]
"""A component of a displacement, along X, Y or Z."""


class Support(Section):
    """How a part of the film is held; a file of this folder holds one kind and names it in ``MODEL``."""

    kind: str

    @property
    def law(self) -> TimeLaw | None:
        """Course of what it prescribes; None for one that only holds."""
        return None

    def relations(self, patch: Patch) -> Iterable[Relation]:
        """Linear relations between the displacements of the control points of a mid-surface.

        Raises
        ------
        ValueError
            If the patch cannot be held in this way.
        """
        raise TypeError(f"{type(self).__name__} does not say what it holds")


class MovingSupport(Support):
    """Components of a displacement that are prescribed; the others are free."""

    x: float | None = quantity(
        "mm", "displacement along X, 0 to hold it; none: free", "this project", default=None
    )
    y: float | None = quantity(
        "mm", "displacement along Y, 0 to hold it; none: free", "this project", default=None
    )
    z: float | None = quantity(
        "mm", "displacement along Z, 0 to hold it; none: free", "this project", default=None
    )
    time_law: AnyTimeLaw | None = setting(
        "course of the motion, a factor on these displacements; none: they are all zero or free",
        "this project",
        default=None,
    )

    @property
    def prescribed(self) -> dict[str, float]:
        """Displacement of each prescribed component at the factor one, mm."""
        values = {"x": self.x, "y": self.y, "z": self.z}
        return {name: value for name, value in values.items() if value is not None}

    @property
    def law(self) -> TimeLaw | None:
        """Course of the motion."""
        return self.time_law if any(self.prescribed.values()) else None

    @model_validator(mode="after")
    def _says_what_moves(self) -> MovingSupport:
        if not self.prescribed:
            raise PydanticCustomError(
                "prescribes_nothing",
                "prescribes nothing: give x, y or z in mm (0 holds that component)",
            )
        if any(self.prescribed.values()) and self.time_law is None:
            raise PydanticCustomError(
                "no_time_law", "moves, so it needs a time_law: the course of its displacement"
            )
        return self
