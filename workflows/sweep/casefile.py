"""Cases from a CSV file: a column per field, a row per case."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable
from pathlib import Path

from pipeline.errors import InputError
from workflows.sweep.design import Block
from workflows.sweep.fields import Field, Scalar

NAMES = "case"
"""Heading of the column that names the cases; it may be left out."""

HEADING = re.compile(r"\s*(?P<path>[^\[\]]+?)\s*(\[(?P<unit>.*)\])?\s*")
PLAIN = re.compile(r"[\w.+-]+")


def read_cases(path: Path, find: Callable[[str], Field]) -> Block:
    """The cases of a file.

    The first row names the fields, if need be with a unit for their bare numbers, as in
    ``geometry.length [um]``. An empty cell leaves the value that the workflow has anyway.

    Parameters
    ----------
    path
        The file.
    find
        Gives the field of a dotted name.

    Raises
    ------
    InputError
        Naming the line, if anything is wrong.
    """
    headings, *lines = _lines(path)
    headings = [heading.strip() for heading in headings]
    named = NAMES in headings
    columns = [i for i, heading in enumerate(headings) if heading != NAMES]
    parsed = [HEADING.fullmatch(headings[i]) for i in columns]
    wrong = [headings[i] for i, match in zip(columns, parsed, strict=True) if not match]
    if not columns or wrong:
        what = f"; {wrong[0]!r} names none" if wrong else ""
        raise InputError(
            f"{path}: the first row must name fields, such as mechanics.damping or "
            f"geometry.length [um]{what}"
        )
    _refuse_other_separators(path, headings)
    fields = tuple(find(match["path"]) for match in parsed if match)
    units = [match["unit"] or "" for match in parsed if match]
    rows, names = [], []
    for number, cells in enumerate(lines, start=2):
        if not any(cell.strip() for cell in cells):
            continue
        if len(cells) != len(headings):
            raise InputError(
                f"{path}, line {number}: {len(cells)} cells below {len(headings)} headings"
            )
        try:
            values = (cells[i].strip() for i in columns)
            rows.append(tuple(map(_value, fields, units, values)))
        except InputError as error:
            raise InputError(f"{path}, line {number}: {error}") from error
        names.append(cells[headings.index(NAMES)].strip() if named else "")
    if not rows:
        raise InputError(f"{path}: there are no cases below the first row")
    if named:
        _check_names(path, names)
    return Block(fields, rows, tuple(names) if named else ())


def _lines(path: Path) -> list[list[str]]:
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:
            lines = list(csv.reader(file))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"cannot read the cases {path}: {reason}") from error
    if not lines:
        raise InputError(f"{path} is empty; its first row must name fields")
    return lines


def _refuse_other_separators(path: Path, headings: list[str]) -> None:
    """Spreadsheets write semicolons or tabs where the comma is the sign for decimals."""
    for sign, name in ((";", "semicolons"), ("\t", "tabs")):
        if any(sign in heading for heading in headings):
            raise InputError(
                f"{path}: {name} separate its cells; separate them by commas, and write numbers "
                "with a point"
            )


def _value(field: Field, unit: str, text: str) -> Scalar | None:
    if not text:
        return None
    value = field.value(text)
    if unit not in ("", field.unit) and not isinstance(value, bool | str):
        try:
            float(text)
        except ValueError:
            return value  # it has a unit of its own
        return field.value(f"{text} {unit}")
    return value


def _check_names(path: Path, names: list[str]) -> None:
    """Names become folders."""
    for number, name in enumerate(names, start=1):
        if not PLAIN.fullmatch(name) or name.startswith("."):
            raise InputError(
                f"{path}, case {number}: {name!r} cannot name a folder; use letters, digits, '_', "
                "'-' and '.'"
            )
        if name in names[: number - 1]:
            raise InputError(f"{path}: two cases are called {name!r}")
