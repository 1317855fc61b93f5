"""The cases of a sweep with what came of them, column by column."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeAlias

from workflows.sweep.kinds import kind_of
from workflows.sweep.study import Study
from workflows.workflow import Quantity

Cell: TypeAlias = float | int | str | bool | None


@dataclass(frozen=True)
class Column:
    """One value per case.

    Attributes
    ----------
    name, unit
        What it is.
    cells
        In the order of the cases; ``None`` where there is nothing.
    meaning
        In plain words.
    place
        Of a quantity that is a list: which item, counted from 1; else ``None``.
    """

    name: str
    unit: str
    cells: Sequence[Cell]
    meaning: str = ""
    place: int | None = None

    @property
    def heading(self) -> str:
        """Name, place and unit."""
        name = self.name if self.place is None else f"{self.name} {self.place}"
        return name if self.unit in ("", "1") else f"{name} [{self.unit}]"

    @cached_property
    def is_numeric(self) -> bool:
        """Whether all values are numbers."""
        return all(
            isinstance(cell, int | float) and not isinstance(cell, bool)
            for cell in self.cells
            if cell is not None
        )

    @cached_property
    def numbers(self) -> list[float]:
        """The values as numbers, NaN where there is none."""
        return [math.nan if cell is None else float(cell) for cell in self.cells]


@dataclass(frozen=True)
class Stage:
    """What a sweep did of one stage."""

    computed: int = 0
    found: int = 0
    seconds: float = 0.0


@dataclass
class Results:
    """What came of the cases so far.

    Attributes
    ----------
    study
        The sweep.
    quantities
        Of each case that is done, by its number.
    errors
        Of each case that failed, by its number.
    warnings
        Of the stages of each case that is done and has some, by its number.
    stages
        What was done of each stage, each result counted once.
    """

    study: Study
    quantities: dict[int, dict[str, Quantity]] = field(default_factory=dict)
    errors: dict[int, str] = field(default_factory=dict)
    warnings: dict[int, tuple[str, ...]] = field(default_factory=dict)
    stages: dict[str, Stage] = field(default_factory=dict)

    @property
    def statuses(self) -> list[str]:
        """``done``, ``failed`` or ``open`` of each case."""
        numbers = range(len(self.study.design))
        return [
            "done" if i in self.quantities else "failed" if i in self.errors else "open"
            for i in numbers
        ]

    def kinds_of_warnings(self) -> list[tuple[str, list[int]]]:
        """A warning of each kind, with the cases that have one; those of a kind differ in numbers only."""
        first: dict[str, str] = {}
        cases: dict[str, list[int]] = {}
        for number in sorted(self.warnings):
            for text in self.warnings[number]:
                kind = kind_of(text)
                first.setdefault(kind, text)
                if number not in cases.setdefault(kind, []):
                    cases[kind].append(number)
        return [(text, cases[kind]) for kind, text in first.items()]

    def parameters(self) -> list[Column]:
        """Swept parameters, in the order in which they were given."""
        rows = [self.study.parameters(case) for case in self.study.design]
        fields = self.study.design.fields
        return [
            Column(one.path, one.unit, [row[i] for row in rows], one.declared.description)
            for i, one in enumerate(fields)
        ]

    def lists(self) -> dict[str, tuple[Quantity, int | None]]:
        """Each quantity in the order of the workflow, with the longest list that it is in any case."""
        found: dict[str, tuple[Quantity, int | None]] = {}
        for case in self.quantities.values():
            for name, quantity in case.items():
                longest = found[name][1] if name in found else None
                if isinstance(quantity.value, list):
                    longest = max(longest or 0, len(quantity.value))
                found[name] = (quantity, longest)
        return found

    def measured(self) -> list[Column]:
        """Quantities; one that is a list has a column per item."""
        return [column for columns in self._columns() for column in columns]

    def scalars(self) -> list[Column]:
        """Quantities that are one number in every case, and the first items of the others."""
        return [columns[0] for columns in self._columns() if columns]

    def _columns(self) -> Iterator[list[Column]]:
        for name, (quantity, longest) in self.lists().items():
            places: list[int | None] = [None]
            if longest is not None:
                places = list(range(1, longest + 1))
            yield [
                Column(name, quantity.unit, self._cells(name, place), quantity.meaning, place)
                for place in places
            ]

    def _cells(self, name: str, place: int | None) -> list[Cell]:
        return [
            _cell(self.quantities.get(number, {}).get(name), place)
            for number in range(len(self.study.design))
        ]


def _cell(quantity: Quantity | None, place: int | None) -> Cell:
    if quantity is None:
        return None
    value = quantity.value
    if isinstance(value, list):
        index = (place or 1) - 1
        return value[index] if index < len(value) else None
    return value if place in (None, 1) else None
