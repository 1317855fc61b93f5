"""Hinged edge: chosen components of its displacement are zero, its rotation is free."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Literal

from pydantic import field_validator
from pydantic_core import PydanticCustomError

from stages.configuration import Edge, setting
from stages.mechanics.supports.base import Component, Support

if TYPE_CHECKING:
    from stages.numerics.patches import Patch
    from stages.numerics.ties import Relation


class Hinged(Support):
    """The edge's row of control points is held; all components, or some (a roller, a diaphragm)."""

    kind: Literal["hinged"] = "hinged"
    edge: Edge = setting("edge that is held", "this project")
    components: tuple[Component, ...] = setting(
        "components that are held, along X, Y and Z", "this project", default=("x", "y", "z")
    )

    @field_validator("components")
    @classmethod
    def _some_in_order(cls, components: tuple[Component, ...]) -> tuple[Component, ...]:
        if not components:
            raise PydanticCustomError("no_components", "holds nothing: name x, y or z")
        return tuple(sorted(set(components)))  # the order is not part of the key

    def relations(self, patch: Patch) -> Iterable[Relation]:
        """The components of the first row are zero."""
        from stages.mechanics.actions.edges import control_rows
        from stages.mechanics.actions.relations import held

        return held(control_rows(patch, self.edge)[0], self.components)


MODEL = Hinged
