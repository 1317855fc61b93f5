"""Records: the frozen dataclasses that stages hand on, and what they declare about themselves."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from functools import cache
from typing import Any

from pipeline.annotations import Unknown, alternatives, field_hints

WHOLE = "record"
"""Name under which a record without parts is stored."""


def is_record_type(hint: Any) -> bool:
    """Whether a type is a record class."""
    return isinstance(hint, type) and dataclasses.is_dataclass(hint)


def parts_of(record: type) -> Mapping[str, type]:
    """Record class of each part, if *all* fields are records; otherwise the record as a whole.

    Parts are stored apart, each with its own content id, so that a consumer of one is not disturbed
    by a change in another.
    """
    return _parts_of(record)


@cache
def _parts_of(record: type) -> Mapping[str, type]:
    hints = {name: alternatives(hint) for name, hint, _ in field_hints(record)}
    if hints and all(len(one) == 1 and is_record_type(one[0]) for one in hints.values()):
        return {name: one[0] for name, one in hints.items()}
    return {WHOLE: record}


def has_parts(record: type) -> bool:
    """Whether a record is stored part by part."""
    return WHOLE not in parts_of(record)


def stored_as(record: type) -> str:
    """Format in which a record is kept: ``"hdf5"`` (default) or ``"zarr"``.

    Raises
    ------
    TypeError
        For any other format.
    """
    kind = getattr(record, "stored_as", "hdf5")
    if kind not in ("hdf5", "zarr"):
        raise TypeError(f"{record.__name__}.stored_as is {kind!r}; it must be 'hdf5' or 'zarr'")
    return str(kind)


def field_metadata(record: type, name: str) -> Mapping[str, Any]:
    """Metadata of a field: ``unit``, ``axes`` and ``stored`` where declared."""
    return next(extra for field, _, extra in field_hints(record) if field == name)


def accepts(expected: Any, given: type) -> bool:
    """Whether a parameter declared as ``expected`` takes a record of class ``given``."""
    return any(
        one is Any or isinstance(one, Unknown) or (isinstance(one, type) and issubclass(given, one))
        for one in alternatives(expected)
    )
