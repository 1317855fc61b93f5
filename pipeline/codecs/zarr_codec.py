"""zarr codec: one group per record, arrays in chunks of whole frames, read lazily.

Blosc compresses and a checksum follows, since a flipped bit would otherwise pass silently.
"""

from __future__ import annotations

import math
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
from pipeline.codecs.whole import WholeStore
from pipeline.runs import FRAMES_PER_CHUNK

R = TypeVar("R")

SMALL, LARGE = 1 << 20, 1 << 24
"""Bytes of an array that is kept in one chunk, and of a chunk of a larger one."""

FEW = 24
"""Bytes of a frame that holds three numbers at most; a history of such frames is one chunk, if small."""

# Several threads append their blocks in the order in which they finish: the bytes would vary.
numcodecs.blosc.use_threads = False


def save(path: Path, record: Any) -> None:
    """Write a record as a group."""
    tree.write(record, GroupWriter(open_group(path)))


def load(path: Path, record: type[R], checksums: Mapping[str, str]) -> R:
    """Record of a group, its arrays lazily; checksums of the files below the path are compared."""
    kept = WholeStore(path, checksums)
    group = zarr.open_group(kept, mode="r", zarr_format=3, use_consolidated=False)
    return tree.read(record, _Reader(group))


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
    rows: int,
) -> zarr.Array[Any]:
    """Empty array of a group, in chunks of whole rows."""
    chunks = tuple(max(1, length) for length in shape)
    if chunks:
        chunks = (min(rows, chunks[0]), *chunks[1:])
    return group.create_array(
        name,
        shape=shape,
        dtype=dtype,
        chunks=chunks,
        compressors=[BloscCodec(cname="zstd", clevel=3, shuffle="shuffle"), Crc32cCodec()],
        fill_value=np.nan if dtype.kind in "fc" else 0,
        # Files of an array side by side: a folder for each index would double what a file system counts.
        chunk_key_encoding={"name": "default", "separator": "."},
        dimension_names=axes or None,
        attributes={"unit": unit} if unit else {},
        config={"write_empty_chunks": True},
    )


def frames_per_chunk(count: int, shape: tuple[int, ...], dtype: np.dtype[Any]) -> int:
    """Frames that are written together in a history of at most ``count`` frames of a shape."""
    frame = math.prod(shape) * dtype.itemsize
    return max(1, count) if frame <= FEW and count * frame <= SMALL else FRAMES_PER_CHUNK


def _rows_per_chunk(values: NDArray[Any], axes: tuple[str, ...]) -> int:
    """All rows of a small array; otherwise frames as in a stream, or rows of some megabytes."""
    if values.nbytes <= SMALL:
        return max(1, len(values)) if values.ndim else 1
    if axes[:1] == ("time",):
        return FRAMES_PER_CHUNK
    return max(1, LARGE * len(values) // values.nbytes)


@dataclass(frozen=True)
class GroupWriter:
    """Writer of a zarr group."""

    place: zarr.Group

    def array(self, name: str, values: NDArray[Any], unit: str, axes: tuple[str, ...]) -> None:
        """Store an array."""
        rows = _rows_per_chunk(values, axes)
        stored = create_array(self.place, name, values.shape, values.dtype, unit, axes, rows)
        if values.ndim == 0:
            stored[...] = values
        # One chunk at a time: of chunks written together, only the first failure could be told.
        for start in range(0, len(values) if values.ndim else 0, rows):
            stored[start : start + rows] = values[start : start + rows]

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
