"""zarr codec: one group per record, arrays in chunks of whole frames, read lazily.

Blosc compresses and a checksum follows, since a flipped bit would otherwise pass silently.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numcodecs.blosc  # type: ignore[import-untyped]  # numcodecs ships no type hints
import numpy as np
import zarr
from numpy.typing import NDArray
from zarr.codecs import BloscCodec, Crc32cCodec

from pipeline.codecs import tree
from pipeline.runs import FRAMES_PER_CHUNK

R = TypeVar("R")

# Several threads append their blocks in the order in which they finish: the bytes would vary.
numcodecs.blosc.use_threads = False


def save(path: Path, record: Any) -> None:
    """Write a record as a group."""
    tree.write(record, GroupWriter(open_group(path)))


def load(path: Path, record: type[R]) -> R:
    """Record of a group, its arrays lazily."""
    return tree.read(record, _Reader(zarr.open_group(path, mode="r", use_consolidated=False)))


def open_group(path: Path) -> zarr.Group:
    """Group at a path, created if need be; existing chunks are left alone."""
    return zarr.open_group(path, mode="a", zarr_format=3, use_consolidated=False)


def create_array(
    group: zarr.Group,
    name: str,
    shape: tuple[int, ...],
    dtype: np.dtype[Any],
    unit: str,
    axes: tuple[str, ...],
) -> zarr.Array[Any]:
    """Empty array of a group, chunked by frames if its first axis is ``"time"``."""
    chunks = tuple(max(1, length) for length in shape)
    if axes[:1] == ("time",):
        chunks = (min(FRAMES_PER_CHUNK, chunks[0]), *chunks[1:])
    return group.create_array(
        name,
        shape=shape,
        dtype=dtype,
        chunks=chunks,
        compressors=[BloscCodec(cname="zstd", clevel=3, shuffle="shuffle"), Crc32cCodec()],
        fill_value=np.nan if dtype.kind in "fc" else 0,
        dimension_names=axes or None,
        attributes={"unit": unit} if unit else {},
        config={"write_empty_chunks": True},
    )


@dataclass(frozen=True)
class GroupWriter:
    """Writer of a zarr group."""

    place: zarr.Group

    def array(self, name: str, values: NDArray[Any], unit: str, axes: tuple[str, ...]) -> None:
        """Store an array."""
        stored = create_array(self.place, name, values.shape, values.dtype, unit, axes)
        stored[...] = values

    def group(self, name: str) -> GroupWriter:
        """Begin a group inside this one."""
        return GroupWriter(self.place.create_group(name))

    def describe(self, description: Mapping[str, Any]) -> None:
        """Store the description as attributes."""
        self.place.attrs.update(description)


@dataclass(frozen=True)
class _Reader:
    place: zarr.Group

    def array(self, name: str) -> Any:
        return self.place[name]

    def group(self, name: str) -> _Reader:
        inner = self.place[name]
        assert isinstance(inner, zarr.Group)
        return _Reader(inner)

    def description(self) -> Mapping[str, Any]:
        return self.place.attrs
