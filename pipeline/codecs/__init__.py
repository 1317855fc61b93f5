"""Codecs: records to files and back, part by part.

A record class says by ``stored_as`` whether it is kept as one HDF5 file (geometry, tables) or as one
zarr group (time-dependent fields, which come back lazily).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any, TypeVar, cast

from pipeline.records import WHOLE, has_parts, parts_of, stored_as

R = TypeVar("R")

UNCHECKED: Mapping[str, str] = {}

SUFFIX = {"hdf5": ".h5", "zarr": ".zarr"}


def part_path(folder: Path, part: str, record: type) -> Path:
    """File or folder in which a part is kept."""
    return folder / (part + SUFFIX[stored_as(record)])


def save(folder: Path, record: Any, written: Collection[str] = ()) -> None:
    """Write a record into a folder, except the parts that are written already.

    Raises
    ------
    TypeError
        If a field holds something that no record may hold.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for part, declared in parts_of(type(record)).items():
        if part in written:
            continue
        value = record if part == WHOLE else getattr(record, part)
        if type(value) is not declared:
            raise TypeError(f"part {part!r} is a {type(value).__name__}, not {declared.__name__}")
        _codec(declared).save(part_path(folder, part, declared), value)


def load(folder: Path, record: type[R], checksums: Mapping[str, str] = UNCHECKED) -> R:
    """Whole record kept in a folder; HDF5 fields as numpy arrays, zarr fields lazily.

    ``checksums`` are the SHA-256 of files by path, compared where a file is read after this returns.
    """
    if not has_parts(record):
        return load_part(folder, WHOLE, record, checksums)
    parts = parts_of(record).items()
    return record(**{part: load_part(folder, part, cls, checksums) for part, cls in parts})


def load_part(
    folder: Path, part: str, record: type[R], checksums: Mapping[str, str] = UNCHECKED
) -> R:
    """One part of the record kept in a folder."""
    path = part_path(folder, part, record)
    below = f"{path.name}/"
    own = {file.removeprefix(below): c for file, c in checksums.items() if file.startswith(below)}
    return cast(R, _codec(record).load(path, record, own))


def _codec(record: type) -> Any:
    if stored_as(record) == "zarr":
        from pipeline.codecs import zarr_codec

        return zarr_codec
    from pipeline.codecs import hdf5_codec

    return hdf5_codec
