"""What a support is: a table of the configuration that turns into relations between control points."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from stages.configuration import Section

if TYPE_CHECKING:  # a configuration is read without numpy
    from stages.mechanics.relations import Relation
    from stages.numerics.patches import Patch


class Support(Section):
    """How a part of the film is held; a file of this folder holds one kind and names it in ``MODEL``."""

    kind: str

    def relations(self, patch: Patch) -> Iterable[Relation]:
        """Linear relations between the displacements of the control points of a mid-surface.

        Raises
        ------
        ValueError
            If the patch cannot be held in this way.
        """
        raise TypeError(f"{type(self).__name__} does not say what it holds")
