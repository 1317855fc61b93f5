"""Control by arc length: the path of equilibria is followed, whichever way the load goes along it."""

from __future__ import annotations

from typing import Literal

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from stages.configuration import Section, quantity, setting
from stages.mechanics.controls.base import Control
from stages.mechanics.supports.base import Component


class Until(Section):
    """The displacement of one material point that ends a path."""

    position: tuple[float, float] = quantity("mm", "X and Y in the undeformed film", "this project")
    component: Component = setting("x, y or z", "this project")
    displacement: float = quantity("mm", "displacement at which the path ends", "this project")


class ArcLength(Control):
    """What acts at the last instant of the loading, times a factor that starts from 0 and is sought.

    With a ``preload``, that much of the loading acts in full, and the factor is that of the rest.
    ``n_steps`` is the largest number of points; a path that is at its end earlier has fewer.
    """

    kind: Literal["arc-length"] = "arc-length"
    preload: float = quantity(
        "ms",
        "instant up to which the loading is followed by load first, at a stored shape; then only what is "
        "added to it is multiplied by the load factor",
        "this project",
        ge=0,
        default=0.0,
    )
    target: float | None = setting(
        "load factor at which the path ends; none: 1, the whole loading, unless `until` says else",
        "Keller (1977)",
        default=None,
    )
    until: Until | None = setting(
        "displacement at which the path ends, in place of a load factor: a table with position, "
        "component and displacement",
        "Keller (1977)",
        default=None,
    )
    first_load: float = setting(
        "load factor of the first step, whose arc is the unit of arcs", gt=0, default=0.05
    )
    smallest_arc: float = setting(
        "arc below which a step that fails is given up, relative to the first", gt=0, default=1e-4
    )
    largest_arc: float = setting("longest arc, relative to the first", gt=0, default=5.0)
    max_turn: float = setting(
        "largest angle by which the path may turn over a step, degrees", gt=0, lt=90, default=20.0
    )

    @model_validator(mode="after")
    def _has_one_end(self) -> ArcLength:
        if self.target is not None and self.until is not None:
            raise PydanticCustomError(
                "two_ends", "gives two ends of the path: keep either target or until"
            )
        if self.target == 0.0:
            raise PydanticCustomError("target", "target must not be 0: there the path begins")
        return self

    @property
    def last_factor(self) -> float | None:
        """Load factor at the end; None where a displacement ends the path."""
        if self.until is not None:
            return None
        return 1.0 if self.target is None else self.target


MODEL = ArcLength
