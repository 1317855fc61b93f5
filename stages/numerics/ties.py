"""Linear relations between unknowns, solved for some of them: u = T q + G d.

Fixed and prescribed unknowns are relations of one unknown; ties, such as those of a rotation about an
inclined edge, have several. Dependent unknowns are eliminated from matrices and vectors, which keep their
numbering: a dependent one has an empty row, and one on the diagonal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stages.numerics.bands import Band, tied
from stages.numerics.bsplines import Array

NEGLIGIBLE = 1e-10
"""What elimination may leave of a factor by round-off, relative to the relation's largest."""


@dataclass(frozen=True)
class Relation:
    """sum_k factors_k u_k = value, where ``value`` is the size of a change over time, or zero.

    The first unknown with a factor of at least half the largest is made the dependent one.
    """

    unknowns: tuple[int, ...]
    factors: tuple[float, ...]
    value: float = 0.0


class ContradictionError(ValueError):
    """A relation contradicts those before it.

    Attributes
    ----------
    relation
        Its number.
    others
        Numbers of the relations that it contradicts.
    """

    def __init__(self, relation: int, others: tuple[int, ...]) -> None:
        self.relation = relation
        self.others = others
        super().__init__(f"relation {relation} contradicts {', '.join(map(str, others))}")


@dataclass(frozen=True)
class Ties:
    """Dependent unknowns in terms of the others.

    Attributes
    ----------
    dependent
        True where an unknown depends on others or is prescribed, shape ``(unknown,)``.
    slaves
        Dependent unknowns with at least one master; u_s = sum factors u_masters + (G d)_s.
    starts, masters, factors
        Masters of slave k are at ``starts[k]:starts[k + 1]``.
    offsets
        G, shape ``(unknown, drive)``; zero rows where independent.
    """

    dependent: NDArray[np.bool_]
    slaves: NDArray[np.int64]
    starts: NDArray[np.int64]
    masters: NDArray[np.int64]
    factors: Array
    offsets: Array

    def admissible(self, u: Array, drives: Array) -> Array:
        """The unknowns with the dependent ones in their places, for the values d of the drives."""
        placed = u.copy()
        placed[self.dependent] = 0.0
        self._follow(placed)
        return placed + self.offsets @ drives if drives.size else placed

    def expand(self, q: Array) -> Array:
        """T q, for q with any values where dependent."""
        full = q.copy()
        full[self.dependent] = 0.0
        self._follow(full)
        return full

    def collect(self, vector: Array) -> Array:
        """T^T r, with zeros where dependent."""
        collected = vector.copy()
        if self.slaves.size:
            pulled = np.repeat(vector[self.slaves], np.diff(self.starts)) * self.factors
            np.add.at(collected, self.masters, pulled)
        collected[self.dependent] = 0.0
        return collected

    def reduce(self, matrix: Band) -> Band:
        """T^T A T, with ones on the diagonal where dependent."""
        if not self.slaves.size:
            return matrix.supported(self.dependent)
        ties = (self.slaves, self.starts, self.masters, self.factors)
        return tied(matrix, ties).supported(self.dependent)

    def _follow(self, u: Array) -> None:
        if self.slaves.size:
            u[self.slaves] = np.add.reduceat(u[self.masters] * self.factors, self.starts[:-1])


def eliminate(
    size: int, relations: Sequence[tuple[Relation, int]], drives: int
) -> tuple[Ties, tuple[int, ...]]:
    """Relations solved for their dependent unknowns, and the numbers of those that say nothing new.

    Parameters
    ----------
    size
        Number of unknowns.
    relations
        Each with the number of the drive that its value is a multiple of; any number where it is zero.
    drives
        Number of drives.

    Raises
    ------
    ContradictionError
        If a relation contradicts others.

    Examples
    --------
    >>> ties, repeated = eliminate(3, [(Relation((0,), (1.0,)), 0), (Relation((1, 2), (2.0, -1.0)), 0)], 0)
    >>> ties.admissible(np.array([9.0, 9.0, 4.0]), np.zeros(0)).tolist(), repeated
    ([0.0, 2.0, 4.0], ())
    """
    rows: dict[int, tuple[dict[int, float], Array]] = {}
    source: dict[int, int] = {}
    users: dict[int, set[int]] = {}
    repeated = []
    for number, (relation, drive) in enumerate(relations):
        largest = max(abs(factor) for factor in relation.factors)
        left = {u: f / largest for u, f in zip(relation.unknowns, relation.factors, strict=True)}
        value = np.zeros(drives)
        if relation.value:
            value[drive] = relation.value / largest
        used = []
        for unknown in [u for u in left if u in rows]:
            used.append(source[unknown])
            factor = left.pop(unknown)
            _add(left, rows[unknown][0], factor)
            value -= factor * rows[unknown][1]
        left = {u: f for u, f in left.items() if abs(f) > NEGLIGIBLE}
        if not left:
            if np.abs(value).max(initial=0.0) > NEGLIGIBLE * _size(relations):
                raise ContradictionError(number, tuple(sorted(set(used))))
            repeated.append(number)
            continue
        pivot = next(u for u, f in left.items() if abs(f) >= 0.5 * max(map(abs, left.values())))
        factor = left.pop(pivot)
        row = {u: -f / factor for u, f in left.items()}
        offset = value / factor
        for slave in users.pop(pivot, set()):
            weight = rows[slave][0].pop(pivot)
            _add(rows[slave][0], row, weight)
            rows[slave] = rows[slave][0], rows[slave][1] + weight * offset
            for master in row:
                users.setdefault(master, set()).add(slave)
        rows[pivot], source[pivot] = (row, offset), number
        for master in row:
            users.setdefault(master, set()).add(pivot)
    return _ties(size, rows, drives), tuple(repeated)


def _add(into: dict[int, float], row: dict[int, float], factor: float) -> None:
    for unknown, value in row.items():
        into[unknown] = into.get(unknown, 0.0) + factor * value


def _size(relations: Sequence[tuple[Relation, int]]) -> float:
    return max((abs(r.value) / max(map(abs, r.factors)) for r, _ in relations), default=0.0)


def _ties(size: int, rows: dict[int, tuple[dict[int, float], Array]], drives: int) -> Ties:
    dependent, offsets = np.zeros(size, dtype=bool), np.zeros((size, drives))
    slaves: list[int] = []
    starts: list[int] = [0]
    masters: list[int] = []
    factors: list[float] = []
    for unknown in sorted(rows):
        row, offset = rows[unknown]
        dependent[unknown] = True
        offsets[unknown] = offset
        kept: dict[int, Any] = {u: f for u, f in sorted(row.items()) if abs(f) > NEGLIGIBLE}
        if kept:
            slaves.append(unknown)
            masters.extend(kept)
            factors.extend(kept.values())
            starts.append(len(masters))
    return Ties(
        dependent,
        np.array(slaves, dtype=np.int64),
        np.array(starts, dtype=np.int64),
        np.array(masters, dtype=np.int64),
        np.array(factors, dtype=float),
        offsets,
    )
