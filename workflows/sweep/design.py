"""The cases of a sweep: every combination of what was asked for."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from pipeline.config.variants import Setting
from pipeline.errors import InputError
from workflows.sweep.fields import Field, Scalar

MOST = 10_000_000
"""Cases of a sweep at most."""


@dataclass(frozen=True)
class Block:
    """Fields that change together, row by row.

    Attributes
    ----------
    fields
        The fields.
    rows
        A value for each, ``None`` for the workflow's own one.
    names
        Of the cases, if they have some.
    is_axis
        Whether it is one field whose values were listed, each once.
    """

    fields: tuple[Field, ...]
    rows: Sequence[tuple[Scalar | None, ...]]
    names: tuple[str, ...] = ()
    is_axis: bool = False


@dataclass(frozen=True)
class CaseSettings:
    """What one case sets.

    Attributes
    ----------
    name
        Unique in the sweep; names the folder of the case.
    values
        By the dotted name of the field; only those that are set.
    """

    name: str
    values: dict[str, Scalar]

    @property
    def settings(self) -> list[Setting]:
        """The same for :class:`pipeline.config.variants.Variants`."""
        return [(tuple(path.split(".")), value) for path, value in self.values.items()]

    def __str__(self) -> str:
        told = ", ".join(f"{path} = {value}" for path, value in self.values.items())
        return f"case {self.name} ({told})"


class Design:
    """All combinations of the rows of some blocks; those of the last block follow one another.

    Parameters
    ----------
    blocks
        What is combined, in order.

    Raises
    ------
    InputError
        If two blocks set the same field, or there are too many cases.
    """

    def __init__(self, blocks: Sequence[Block]) -> None:
        self.blocks = tuple(blocks)
        seen: set[str] = set()
        for field in self.fields:
            if field.path in seen:
                raise InputError(f"{field.path} is given twice; give its values together")
            seen.add(field.path)
        if len(self) > MOST:
            raise InputError(f"these are {len(self)} cases, and {MOST} are the most")

    @cached_property
    def fields(self) -> tuple[Field, ...]:
        """Fields in the order in which they were given."""
        return tuple(field for block in self.blocks for field in block.fields)

    @property
    def shape(self) -> tuple[int, ...]:
        """Rows of each block."""
        return tuple(len(block.rows) for block in self.blocks)

    @property
    def is_grid(self) -> bool:
        """Whether each field changes by itself, so that the cases fill a grid."""
        return all(block.is_axis for block in self.blocks)

    def __len__(self) -> int:
        return math.prod(self.shape)

    def __iter__(self) -> Iterator[CaseSettings]:
        return (self[number] for number in range(len(self)))

    def __getitem__(self, number: int) -> CaseSettings:
        values: dict[str, Scalar] = {}
        for block, row in zip(self.blocks, self.rows(number), strict=True):
            cells = zip(block.fields, block.rows[row], strict=True)
            values |= {field.path: value for field, value in cells if value is not None}
        return CaseSettings(self.name(number), values)

    def rows(self, number: int) -> list[int]:
        """Row of each block in a case."""
        rows = []
        for count in reversed(self.shape):
            number, row = divmod(number, count)
            rows.append(row)
        return rows[::-1]

    def name(self, number: int) -> str:
        """Name of a case: that in its table, if it comes from one alone, else its number from 1."""
        if len(self.blocks) == 1 and self.blocks[0].names:
            return self.blocks[0].names[number]
        return f"{number + 1:0{len(str(len(self)))}d}"

    @cached_property
    def numbers(self) -> dict[str, int]:
        """Number of each case by its name."""
        return {self.name(number): number for number in range(len(self))}
