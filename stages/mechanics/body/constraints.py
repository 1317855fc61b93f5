"""What the supports of a film hold together: one set of ties, checked for sense."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stages.mechanics.actions.seams import seams
from stages.mechanics.supports.base import Support
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.numerics.ties import ContradictionError, Relation, Ties, eliminate
from stages.time_laws.base import TimeLaw

SEAM = "(seam)"
"""Label of what holds a tube together; no support is called so."""


@dataclass(frozen=True)
class Drive:
    """A support that moves, and the law of its motion."""

    label: str
    law: TimeLaw


@dataclass(frozen=True)
class Constraints:
    """Ties between the degrees of freedom ``3 * control point + component``.

    Attributes
    ----------
    ties
        Dependent degrees of freedom in terms of the others and of the drives.
    drives
        Supports that move, in the order in which the ties take their factors.
    relations
        What the ties were made of.
    """

    ties: Ties
    drives: tuple[Drive, ...]
    relations: tuple[Relation, ...]

    def resistance(self, motions: Array) -> Array:
        """What each relation says to motions of all degrees of freedom, shape (dof, motion)."""
        return np.array(
            [
                np.array(r.factors) @ motions[list(r.unknowns)] / np.linalg.norm(r.factors)
                for r in self.relations
            ]
        ).reshape(len(self.relations), motions.shape[1])


def constrain(patch: Patch, supports: Mapping[str, Support]) -> Constraints:
    """Constraints of a mid-surface under supports by label; the order of the labels does not matter.

    Raises
    ------
    ValueError
        If a support does not fit the film, contradicts others, or adds nothing to them.

    Examples
    --------
    >>> from stages.mechanics.supports.clamped import Clamped
    >>> film = Patch.rectangle(3.5, 2.0).refine(2, (4, 3))
    >>> int(constrain(film, {"clamp": Clamped(edge="X=0")}).ties.dependent.sum())
    30
    """
    relations: list[tuple[Relation, int]] = [(relation, -1) for relation in seams(patch)]
    labels: list[str] = [SEAM] * len(relations)
    drives: list[Drive] = []
    for label, support in sorted(supports.items()):
        try:
            found = list(support.relations(patch))
        except ValueError as error:
            raise ValueError(f"support {label!r} ({support.kind}): {error}") from error
        if support.law is not None:
            drives.append(Drive(label, support.law))
        relations += [(relation, len(drives) - 1) for relation in found]
        labels += [label] * len(found)
    try:
        ties, repeated = eliminate(3 * patch.size, relations, len(drives))
    except ContradictionError as error:
        raise _contradiction(error, labels) from error
    _check_each_adds_something(labels, repeated)
    return Constraints(ties, tuple(drives), tuple(relation for relation, _ in relations))


def _contradiction(error: ContradictionError, labels: Sequence[str]) -> ValueError:
    label = labels[error.relation]
    others = sorted({labels[i] for i in error.others} - {label})
    against = f"support{'s' if len(others) > 1 else ''} {', '.join(map(repr, others))}"
    return ValueError(
        f"support {label!r} moves what {against if others else 'it also holds'}"
        f"{' holds or moves otherwise' if others else ''}: let only one support act on each "
        f"component of an edge or point"
    )


def _check_each_adds_something(labels: Sequence[str], repeated: Sequence[int]) -> None:
    idle = (
        set(labels) - {SEAM} - {label for i, label in enumerate(labels) if i not in set(repeated)}
    )
    for label in sorted(idle):
        raise ValueError(
            f"support {label!r} holds nothing that other supports do not hold already: leave it out, "
            f"or switch the other one off by kind = 'free'"
        )
