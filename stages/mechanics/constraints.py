"""What the supports of a film hold together."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from stages.mechanics.supports.base import Support
from stages.numerics.patches import Patch

Fixed = NDArray[np.bool_]
"""Held degrees of freedom, shape ``(dof,)``."""


def fixed_degrees(patch: Patch, supports: Mapping[str, Support]) -> Fixed:
    """Degrees of freedom that supports hold at zero.

    Raises
    ------
    ValueError
        If a support ties several degrees of freedom to one another.

    Examples
    --------
    >>> from stages.mechanics.supports.clamped import Clamped
    >>> film = Patch.rectangle(3.5, 2.0).refine(2, (4, 3))
    >>> int(fixed_degrees(film, {"clamp": Clamped(edge="X=0")}).sum())
    30
    """
    fixed = np.zeros(3 * patch.size, dtype=bool)
    for label, support in sorted(supports.items()):
        for relation in support.relations(patch):
            if len(relation.degrees) > 1:
                raise ValueError(
                    f"support {label!r} ({support.kind}) needs an edge whose normal lies along a "
                    "coordinate axis; use 'clamped' on this film"
                )
            fixed[relation.degrees[0]] = True
    return fixed
