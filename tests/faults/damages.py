"""Ways in which a kept artefact can be damaged, and what is then said of it."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

CHUNK = "record.zarr/potential/c.1.0"
METADATA = "record.zarr/potential/zarr.json"
TABLE = "surface.h5"


def flipped(path: Path) -> None:
    """One bit in the middle of a file."""
    contents = bytearray(path.read_bytes())
    contents[len(contents) // 2] ^= 1
    path.write_bytes(contents)


def shortened(path: Path) -> None:
    """A file that lost its last byte."""
    path.write_bytes(path.read_bytes()[:-1])


def emptied(path: Path) -> None:
    """A file as some file systems leave it after a power cut."""
    path.write_bytes(b"")


def zeroed(path: Path) -> None:
    """A file as others leave it: the right length, no contents."""
    path.write_bytes(bytes(path.stat().st_size))


def removed(path: Path) -> None:
    """A file, or a folder, that is gone."""
    shutil.rmtree(path) if path.is_dir() else path.unlink()


def foreign(path: Path) -> None:
    """A file that was not there."""
    path.write_bytes(b"notes")


def swapped(path: Path) -> None:
    """A chunk in the place of another one: its own checksum is right."""
    path.write_bytes((path.parent / "c.0.0").read_bytes())


def rewritten(path: Path) -> None:
    """A chunk with other values, of the same size and with the right checksum inside."""
    import numpy as np
    import zarr

    size = path.stat().st_size
    array: Any = zarr.open_array(path.parent, mode="r+")
    first = array[64, 0]
    while True:
        array[64, 0] = first = np.nextafter(first, np.float32(np.inf))
        if path.stat().st_size == size:
            return


def edited(path: Path) -> None:
    """A manifest in which somebody put a number right."""
    text = path.read_text()
    assert '"cpu_seconds": ' in text
    path.write_text(text.replace('"cpu_seconds": ', '"cpu_seconds": 1'))


def exchanged(path: Path) -> None:
    """A manifest, whole and sealed, of another artefact of the stage."""
    other = next(p for p in sorted(path.parent.parent.iterdir()) if p != path.parent)
    path.write_bytes((other / "manifest.json").read_bytes())


Damage = tuple[str, str, Callable[[Path], Any], str]
"""Stage, file below the artefact's folder, what happens to it, and what full verification says."""

WRONG, SIZE, GONE = "the checksum of {} is wrong", "{} has ", "{} is missing"

DAMAGES: dict[str, Damage] = {
    "bit of a chunk": ("wave", f"data/{CHUNK}", flipped, WRONG),
    "end of a chunk": ("wave", f"data/{CHUNK}", shortened, SIZE),
    "empty chunk": ("wave", f"data/{CHUNK}", emptied, SIZE),
    "chunk of zeros": ("wave", f"data/{CHUNK}", zeroed, WRONG),
    "chunk in another's place": ("wave", f"data/{CHUNK}", swapped, "{} "),
    "chunk of other values": ("wave", f"data/{CHUNK}", rewritten, WRONG),
    "lost chunk": ("wave", f"data/{CHUNK}", removed, GONE),
    "bit of array metadata": ("wave", f"data/{METADATA}", flipped, WRONG),
    "lost array metadata": ("wave", f"data/{METADATA}", removed, GONE),
    "lost array": ("wave", "data/record.zarr/potential", removed, f"{CHUNK} is missing"),
    "foreign chunk": ("wave", "data/record.zarr/potential/c.9", foreign, "does not belong to it"),
    "bit of a table": ("mesh", f"data/{TABLE}", flipped, WRONG),
    "end of a table": ("mesh", f"data/{TABLE}", shortened, SIZE),
    "table of zeros": ("mesh", f"data/{TABLE}", zeroed, WRONG),
    "lost table": ("mesh", f"data/{TABLE}", removed, GONE),
    "foreign file": ("mesh", "data/notes", foreign, "notes does not belong to it"),
    "foreign file beside the data": ("mesh", "notes", foreign, "notes does not belong to it"),
    "lost data": ("mesh", "data", removed, f"{TABLE} is missing"),
    "lost manifest": ("mesh", "manifest.json", removed, GONE),
    "empty manifest": ("mesh", "manifest.json", emptied, "unreadable manifest"),
    "end of a manifest": ("mesh", "manifest.json", shortened, "unreadable manifest"),
    "bit of a manifest": ("mesh", "manifest.json", flipped, ""),
    "edited manifest": ("mesh", "manifest.json", edited, "edited after it had been written"),
    "exchanged manifest": ("mesh", "manifest.json", exchanged, "its manifest belongs to mesh/"),
}

UNREAD = {"foreign chunk", "foreign file", "foreign file beside the data"}
"""What a reader does not look at; it cannot change what is read."""


def told(damage: Damage) -> str:
    """Part of what full verification says."""
    _, file, _, words = damage
    return words.format(file.removeprefix("data/"))
