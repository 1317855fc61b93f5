"""What a command line asks a sweep to run over, read and checked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pipeline.config.variants import Variants
from pipeline.errors import InputError
from workflows.sweep.casefile import read_cases
from workflows.sweep.design import Block, Design
from workflows.sweep.fields import Field, find_field
from workflows.sweep.grammar import Interval, interval, values
from workflows.sweep.sampling import parse_sample, sampled


@dataclass(frozen=True)
class Asked:
    """Options of the command that say what the cases are, as they were written.

    Attributes
    ----------
    over
        ``FIELD=VALUES``: every combination.
    together
        ``FIELD=VALUES`` whose first, second, ... values make a row each.
    cases
        CSV file.
    sample
        ``lhs:N`` or ``sobol:N``, of the fields whose values are an interval.
    seed
        Of the samples.
    """

    over: Sequence[str] = ()
    together: Sequence[str] = ()
    cases: Path | None = None
    sample: str | None = None
    seed: int = 0


def read_design(asked: Asked, variants: Variants[Any], overrides: Sequence[str] = ()) -> Design:
    """The cases that are asked for.

    Parameters
    ----------
    asked
        The options.
    variants
        The configuration that the cases have in common.
    overrides
        ``--set`` strings, which may not set what the sweep runs over.

    Raises
    ------
    InputError
        If anything about the options is wrong.
    """
    blocks, intervals = _product(asked, variants)
    if asked.together:
        blocks.append(_zipped(asked.together, variants))
    if asked.cases is not None:
        blocks.append(read_cases(asked.cases, lambda path: find_field(path, variants, "--cases")))
    if asked.sample is None and asked.seed:
        raise InputError(
            f"--seed {asked.seed} makes samples, and there are none: add --sample lhs:N or sobol:N"
        )
    if asked.sample is not None:
        method, count = parse_sample(asked.sample)
        if not intervals:
            raise InputError(
                f"--sample {asked.sample}: say between which values: --over SECTION.KEY=LOW..HIGH"
            )
        blocks.append(sampled(method, count, intervals, asked.seed))
    if not blocks:
        raise InputError(
            "there is nothing to sweep over: give --over SECTION.KEY=V1,V2,..., --zip or --cases"
        )
    design = Design(blocks)
    _refuse_fields_set_twice(design, overrides)
    return design


def _product(asked: Asked, variants: Variants[Any]) -> tuple[list[Block], dict[Field, Interval]]:
    """A block for each list, and the intervals to take samples from."""
    blocks: list[Block] = []
    intervals: dict[Field, Interval] = {}
    for text in asked.over:
        field, listed = _field_and_values(text, variants, "--over")
        between = interval(field, listed, "--over") if asked.sample is not None else None
        if between is None:
            rows = [(value,) for value in values(field, listed, "--over")]
            blocks.append(Block((field,), rows, is_axis=True))
        elif any(field.path == known.path for known in intervals):
            raise InputError(f"{field.path} is given twice; give one interval")
        else:
            intervals[field] = between
    return blocks, intervals


def _zipped(texts: Sequence[str], variants: Variants[Any]) -> Block:
    fields, columns = [], []
    for text in texts:
        field, listed = _field_and_values(text, variants, "--zip")
        fields.append(field)
        columns.append(values(field, listed, "--zip", distinct=False))
    if len({len(column) for column in columns}) > 1:
        counts = ", ".join(f"{f.path} {len(c)}" for f, c in zip(fields, columns, strict=True))
        raise InputError(f"--zip needs as many values for each field; there are: {counts}")
    if len(columns) == 1:
        raise InputError(
            f"--zip {texts[0]}: one field changes with no other; give a second --zip, or use --over"
        )
    return Block(tuple(fields), list(zip(*columns, strict=True)))


def _field_and_values(text: str, variants: Variants[Any], option: str) -> tuple[Field, str]:
    path, equals, listed = text.partition("=")
    if not equals or not path.strip():
        raise InputError(f"{option} needs SECTION.KEY=VALUES, got {text!r}")
    return find_field(path, variants, option), listed


def _refuse_fields_set_twice(design: Design, overrides: Sequence[str]) -> None:
    swept = {field.path for field in design.fields}
    for override in overrides:
        path = ".".join(name.strip() for name in override.partition("=")[0].split("."))
        if path in swept:
            raise InputError(
                f"{path} is set by --set and swept over, too: leave one of the two out"
            )
