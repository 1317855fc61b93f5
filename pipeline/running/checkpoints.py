"""Checkpoints: the state of an interrupted stage, in one file that is replaced atomically."""

from __future__ import annotations

import io
import json
import zipfile
import zlib
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pipeline.durable import files_below, storing, write_atomically
from pipeline.manifest import sha256
from pipeline.provenance import processor, versions
from pipeline.running.checkpoint_summary import FORM, form_obstacle
from pipeline.running.streams import SavedStream


class UnusableCheckpoint(ValueError):  # noqa: N818 - the name says what is wrong
    """A checkpoint that cannot be continued from; the stage starts anew."""


@dataclass(frozen=True)
class Checkpoint:
    """What a stage needs to go on where it was interrupted.

    Attributes
    ----------
    key
        Key of the result; it stands for configuration, code and inputs.
    state
        Arrays given by the stage.
    streams
        Unfinished chunk of each history, by part.
    files
        SHA-256 of each chunk file written so far, by its path in the data folder.
    seconds, cpu_seconds, warnings, notes
        What goes into the manifest of the whole.
    versions
        Library versions: others could continue with other last bits.
    processor
        Kind of processor, likewise.
    """

    key: str
    state: Mapping[str, NDArray[Any]]
    streams: Mapping[str, SavedStream]
    files: Mapping[str, str]
    seconds: float = 0.0
    cpu_seconds: float = 0.0
    warnings: tuple[str, ...] = ()
    notes: Mapping[str, Any] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=versions)
    processor: str = field(default_factory=processor)

    def save(self, path: Path) -> None:
        """Write the checkpoint, replacing an earlier one."""
        about = {name: getattr(self, name) for name in _PLAIN}
        about["form"] = FORM
        about["streams"] = {part: saved.frames_done for part, saved in self.streams.items()}
        arrays = {f"state/{name}": values for name, values in self.state.items()}
        for part, saved in self.streams.items():
            arrays |= {f"stream/{part}/{name}": rows for name, rows in saved.buffers.items()}
        contents = io.BytesIO()
        text = np.frombuffer(json.dumps(about).encode(), np.uint8)
        np.savez(contents, allow_pickle=False, about=text, **arrays)
        with storing(path):
            write_atomically(path, contents.getvalue())

    @classmethod
    def load(cls, path: Path, key: str, data: Path) -> Checkpoint | None:
        """Checkpoint of a key, if there is one.

        Raises
        ------
        UnusableCheckpoint
            If it is damaged, of other library versions or another processor, or its data files are
            not there.
        """
        if not path.exists():
            return None
        try:
            with np.load(path, allow_pickle=False) as kept:
                arrays = {name: kept[name] for name in kept.files}
            about = json.loads(arrays.pop("about").tobytes())
            if obstacle := form_obstacle(about):
                raise UnusableCheckpoint(obstacle)
            about["warnings"] = tuple(about["warnings"])
            found = cls(
                state=_below("state/", arrays),
                streams={
                    part: SavedStream(frames, _below(f"stream/{part}/", arrays))
                    for part, frames in about.pop("streams").items()
                },
                **{name: about[name] for name in _PLAIN},
            )
        except UnusableCheckpoint:
            raise
        except (OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile, zlib.error) as error:
            raise UnusableCheckpoint(f"it cannot be read ({error})") from error
        found._check(key, data)
        return found

    def _check(self, key: str, data: Path) -> None:
        if self.key != key:
            raise UnusableCheckpoint("it belongs to another result")
        if self.versions != versions():
            changed = [n for n in versions() if self.versions.get(n) != versions()[n]]
            raise UnusableCheckpoint(f"it was saved with other versions of {', '.join(changed)}")
        if self.processor != processor():
            raise UnusableCheckpoint("it was saved on another kind of processor")
        present = ChunkFiles(data).digests()
        if any(present.get(path) != digest for path, digest in self.files.items()):
            raise UnusableCheckpoint("data files that belong to it are missing or damaged")


_PLAIN = ("key", "files", "seconds", "cpu_seconds", "warnings", "notes", "versions", "processor")


class ChunkFiles:
    """Files of array data below a folder; metadata files are left out.

    A file is read once, unless it is written again: what a checkpoint costs does not grow with what
    was written before the one before.
    """

    def __init__(self, data: Path) -> None:
        self._data = data
        self._known: dict[Path, tuple[tuple[int, int, int], str]] = {}

    def digests(self) -> dict[str, str]:
        """SHA-256 of each file, by its path in the folder."""
        return {
            path.relative_to(self._data).as_posix(): self._digest(path)
            for path in files_below(self._data)
            if path.name != "zarr.json"
        }

    def _digest(self, path: Path) -> str:
        status = path.stat()
        state = status.st_mtime_ns, status.st_size, status.st_ino
        known = self._known.get(path)
        if known is None or known[0] != state:
            known = self._known[path] = state, sha256(path)
        return known[1]


def keep_only(data: Path, files: Collection[str]) -> None:
    """Remove every file of a folder that does not belong to a checkpoint."""
    for path in list(files_below(data)):
        if path.relative_to(data).as_posix() not in files:
            path.unlink()


def _below(prefix: str, arrays: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    return {name[len(prefix) :]: a for name, a in arrays.items() if name.startswith(prefix)}
