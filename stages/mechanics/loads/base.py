"""What a load is: a table of the configuration that turns into forces on the control points."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stages.configuration import Section, setting
from stages.time_laws.base import AnyTimeLaw

if TYPE_CHECKING:  # a configuration is read without numpy
    from stages.mechanics.actions.forces.base import Force
    from stages.numerics.patches import Patch


class Load(Section):
    """What pulls or pushes the film; a file of this folder holds one kind and names it in ``MODEL``.

    Sizes are those at the factor one of the time law.
    """

    kind: str
    time_law: AnyTimeLaw = setting("course of the load over time, by name", "this project")

    def on(self, patch: Patch, points: int) -> Force:
        """The force of size one on a mid-surface, integrated with ``points`` Gauss points per span.

        Raises
        ------
        ValueError
            If the patch cannot be loaded in this way.
        """
        raise TypeError(f"{type(self).__name__} does not say what it exerts")
