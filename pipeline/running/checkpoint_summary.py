"""What a checkpoint holds, in a few numbers, read without NumPy."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pipeline.provenance import processor, versions

FORM = 2
"""Form of checkpoints and of the histories that belong to them; the first one did not say so."""


@dataclass(frozen=True)
class CheckpointSummary:
    """How far an interrupted computation had come.

    Attributes
    ----------
    frames
        Frames of its longest history; ``None`` if it streams none.
    seconds
        Work in it, which going on from it saves.
    obstacle
        Why it cannot be gone on from; empty if it can, as far as it tells itself.
    """

    frames: int | None
    seconds: float
    obstacle: str = ""

    def __str__(self) -> str:
        after = "" if self.frames is None else f" after {self.frames} frames"
        if self.obstacle:
            return (
                f"a checkpoint{after} ({self.seconds:.1f} s of work) is of no use: {self.obstacle}"
            )
        return f"a checkpoint{after} will be resumed; it saves {self.seconds:.1f} s"


def summary(path: Path, key: str) -> CheckpointSummary | None:
    """Summary of the checkpoint of a key, ``None`` if there is none that can be read."""
    import zipfile
    import zlib

    try:
        with zipfile.ZipFile(path) as archive:
            about = json.loads(_without_header(archive.read("about.npy")))
        frames = [int(count) for count in about["streams"].values()]
        found = CheckpointSummary(max(frames, default=None), float(about["seconds"]))
        obstacle = form_obstacle(about) or _obstacle(
            about["key"], about["versions"], about["processor"], key
        )
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None
    except (zipfile.BadZipFile, zlib.error, NotImplementedError, EOFError):
        return None
    return CheckpointSummary(found.frames, found.seconds, obstacle)


def form_obstacle(about: Mapping[str, Any]) -> str:
    """Why a checkpoint of this form cannot be gone on from; empty if it can."""
    form = about.get("form", 1)
    return "" if form == FORM else f"its form is {form}, not {FORM}: another version saved it"


def _obstacle(of_key: str, of_versions: dict[str, str], of_processor: str, key: str) -> str:
    if of_key != key:
        return "it belongs to another result"
    if changed := [name for name, now in versions().items() if of_versions.get(name) != now]:
        return f"it was saved with other versions of {', '.join(changed)}"
    return "" if of_processor == processor() else "it was saved on another kind of processor"


def _without_header(npy: bytes) -> bytes:
    """Contents of an array of bytes in the NPY format, version 1: magic 6, version 2, length 2."""
    if npy[:8] != b"\x93NUMPY\x01\x00":
        raise ValueError("not an array")
    return npy[10 + int.from_bytes(npy[8:10], "little") :]
