"""Records as trees of groups: arrays are stored as arrays, all else in the group's description.

The description of a group is a JSON object: the name of the record class and, for each field, either
its plain value or where it is found::

    {"record": "Film", "fields": {"thickness": 0.018, "label": null, "points": {"array": "points"},
     "layers": {"tuple": [{"record": "Layer", "group": "layers.0"}]}}, "units": {"thickness": "mm"}}
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from pipeline.annotations import alternatives, complete_field_hints, field_hints, item_hints
from pipeline.canonical import is_structure
from pipeline.errors import StoreError
from pipeline.records import is_record_type

R = TypeVar("R")


class GroupWriter(Protocol):
    """A group of a file format that is being written."""

    def array(self, name: str, values: NDArray[Any], unit: str, axes: tuple[str, ...]) -> None:
        """Store an array."""
        ...

    def group(self, name: str) -> GroupWriter:
        """Begin a group inside this one."""
        ...

    def describe(self, description: Mapping[str, Any]) -> None:
        """Store the description, a JSON object."""
        ...


class GroupReader(Protocol):
    """A group of a file format that is being read."""

    def array(self, name: str) -> Any:
        """An array, in memory or lazily."""
        ...

    def group(self, name: str) -> GroupReader:
        """A group inside this one."""
        ...

    def description(self) -> Mapping[str, Any]:
        """The description."""
        ...


def write(record: Any, writer: GroupWriter, written: Collection[str] = ()) -> None:
    """Write a record into a group, except the array fields that are written already.

    Raises
    ------
    TypeError
        If a field holds something that no record may hold.
    ValueError
        If an array does not have the axes that its field declares.
    """
    owner = type(record).__name__
    fields: dict[str, Any] = {}
    units: dict[str, str] = {}
    for name, _, extra in field_hints(type(record)):
        if name in written:
            fields[name] = {"array": name}
        else:
            fields[name] = _write(getattr(record, name), name, extra, writer, owner)
        if extra.get("unit"):
            units[name] = extra["unit"]
    writer.describe({"record": owner, "fields": fields, "units": units})


def read(record: type[R], reader: GroupReader) -> R:
    """Record read from a group.

    Raises
    ------
    StoreError
        If the fields kept are not those of the record class.
    """
    kept = reader.description()["fields"]
    complete = complete_field_hints(record)
    hints = {name: complete[name] for name, _, _ in field_hints(record)}
    if kept.keys() != hints.keys():
        raise StoreError(
            f"the kept record has the fields {', '.join(kept)}, but {record.__name__} has "
            f"{', '.join(hints)}",
            remedy="compute it again, or read it with the version of the code that wrote it",
        )
    return record(**{name: _read(kept[name], hints[name], reader) for name in hints})


def as_stored(array: NDArray[Any], dtype: np.dtype[Any]) -> NDArray[Any]:
    """An array in its stored type; what is too large for that becomes infinite without a warning.

    Only a stage that diverges gets there, and it tells of that itself.
    """
    with np.errstate(over="ignore"):
        return array.astype(dtype, copy=False)


def checked_array(
    value: Any, name: str, extra: Mapping[str, Any], owner: str
) -> tuple[NDArray[Any], str, tuple[str, ...]]:
    """Array of the stored type, with its unit and axes."""
    array = np.ascontiguousarray(value) if np.ndim(value) else np.asarray(value)
    if extra.get("stored"):
        array = as_stored(array, np.dtype(extra["stored"]))
    if array.dtype.kind not in "biufc":
        raise TypeError(f"{owner}.{name} holds {array.dtype} values, which cannot be stored")
    axes = tuple(extra.get("axes", ()))
    if axes and len(axes) != array.ndim:
        raise ValueError(f"{owner}.{name} has shape {array.shape}, but its axes are {axes}")
    return array, str(extra.get("unit", "")), axes


def _write(value: Any, name: str, extra: Mapping[str, Any], writer: GroupWriter, owner: str) -> Any:
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return {"float": repr(value)}
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, tuple):
        return {
            "tuple": [
                _write(item, f"{name}.{i}", extra, writer, owner) for i, item in enumerate(value)
            ]
        }
    if is_structure(value):
        write(value, writer.group(name))
        return {"record": type(value).__name__, "group": name}
    if hasattr(value, "dtype") and hasattr(value, "shape"):
        writer.array(name, *checked_array(value, name, extra, owner))
        return {"array": name}
    raise TypeError(
        f"{owner}.{name} holds a {type(value).__name__}; records hold arrays, None, bool, int, "
        "float, str, records and tuples of these"
    )


def _read(kept: Any, hint: Any, reader: GroupReader) -> Any:
    if not isinstance(kept, Mapping):
        return kept
    if "array" in kept:
        return reader.array(kept["array"])
    if "tuple" in kept:
        return tuple(
            _read(item, item_hints(hint, i), reader) for i, item in enumerate(kept["tuple"])
        )
    if "float" in kept:
        return float(kept["float"])
    return read(_class_named(kept["record"], hint), reader.group(kept["group"]))


def _class_named(name: str, hint: Any) -> type[Any]:
    for one in alternatives(hint):
        if is_record_type(one) and one.__name__ == name:
            return one
    raise StoreError(f"a kept record is a {name}, but the field is declared as {hint}")
