"""Histories written to the store as they are computed, in whole chunks of frames."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pipeline.codecs import tree
from pipeline.codecs.zarr_codec import GroupWriter, create_array, frames_per_chunk, open_group
from pipeline.durable import storing
from pipeline.records import field_metadata
from pipeline.running.frames import FrameShapes

R = TypeVar("R")


@dataclass(frozen=True)
class SavedStream:
    """What a checkpoint keeps of a history: its length and the frames of the unfinished chunk."""

    frames_done: int
    buffers: Mapping[str, NDArray[Any]]


class StoredHistory(Generic[R]):
    """A history in a zarr group.

    Memory holds one chunk per field: 64 frames, or all of them if they hold few numbers. Arrays are
    created with the first frame, whose types they take unless the field declares another one.

    Parameters
    ----------
    path
        Folder of the group.
    frames
        Count and shapes of the frames.
    saved
        Where to continue; the chunks before it must be in the folder.
    """

    def __init__(self, path: Path, frames: FrameShapes[R], saved: SavedStream | None) -> None:
        self._path = path
        self._frames = frames
        self._buffers: dict[str, NDArray[Any]] = {}
        self._arrays: dict[str, Any] = {}
        self._rows: dict[str, int] = {}
        self.frames_done = 0
        self.record: R | None = None
        with storing(path):
            self._group = open_group(path)
            if saved is not None and saved.buffers:
                self._allocate({name: rows.dtype for name, rows in saved.buffers.items()})
                for name, rows in saved.buffers.items():
                    self._buffers[name][: len(rows)] = rows
                self.frames_done = saved.frames_done

    def append(self, **fields: ArrayLike) -> None:
        """Add one frame of every streamed field; one that fills a chunk writes it."""
        frame = self._frames.checked(fields, self.frames_done)
        if not self._buffers:
            with storing(self._path):
                self._allocate({name: value.dtype for name, value in frame.items()})
        for name, value in frame.items():
            self._buffers[name][self._unwritten(name)] = value
        self.frames_done += 1
        with storing(self._path):
            for name, rows in self._rows.items():
                if self.frames_done % rows == 0:
                    self._write(name, rows)

    def flush(self) -> None:
        """Write the frames of the unfinished chunks; these may be written again later."""
        with storing(self._path):
            for name in self._rows:
                self._write(name, self._unwritten(name))

    def saved(self) -> SavedStream:
        """What a checkpoint must keep."""
        kept = {name: rows[: self._unwritten(name)] for name, rows in self._buffers.items()}
        return SavedStream(self.frames_done, kept)

    def finish(self, **fields: Any) -> R:
        """The record, from the streamed frames and the remaining fields."""
        self._frames.check_finished(self.frames_done, fields)
        with storing(self._path):
            if not self._arrays:
                self._allocate({name: self._frames.dtype(name) for name in self._frames.shapes})
            self.flush()
            if self.frames_done < self._frames.count:
                self._shorten()
            record = self._frames.record(**self._arrays, **fields)
            tree.write(record, GroupWriter(self._group), written=self._frames.shapes)
        self.record = record
        return record

    def _allocate(self, dtypes: Mapping[str, np.dtype[Any]]) -> None:
        count = self._frames.count
        for name, shape in self._frames.shapes.items():
            extra = field_metadata(self._frames.record, name)
            axes = tuple(extra["axes"])
            whole = (count, *shape)
            if len(axes) != len(whole):
                raise ValueError(
                    f"frames of {name!r} have shape {tuple(shape)}, but its axes are {axes}"
                )
            unit = str(extra.get("unit", ""))
            rows = self._rows[name] = frames_per_chunk(count, shape, dtypes[name])
            self._arrays[name] = create_array(
                self._group, name, whole, dtypes[name], unit, axes, rows
            )
            self._buffers[name] = np.zeros((rows, *shape), dtypes[name])

    def _shorten(self) -> None:
        """Let the arrays end with the last frame."""
        for array in self._arrays.values():
            array.resize((self.frames_done, *array.shape[1:]))

    def _unwritten(self, name: str) -> int:
        """Frames of a field that are in no chunk yet."""
        return self.frames_done % self._rows[name]

    def _write(self, name: str, rows: int) -> None:
        """Write the last rows of a field."""
        if rows:
            start = self.frames_done - rows
            self._arrays[name][start : self.frames_done] = self._buffers[name][:rows]
