"""The catalogue of a remote store: kept on each machine, and shared through an object."""

from __future__ import annotations

import contextlib
from pathlib import Path

from pipeline.errors import StoreError
from pipeline.store.catalogue import Row, catalogue
from pipeline.store.remote.objects import Objects
from pipeline.store.remote.reader import Reader

INDEX = "index.jsonl"
"""Object with the lines of a catalogue, so that a new machine need not read every manifest."""

LINE = 100
"""Bytes that a line of it has at least."""

WORTH_SHARING = 256
"""New lines that are worth writing it again."""


def rows(objects: Objects, reader: Reader, index: Path) -> list[Row]:
    """All artefacts, sorted by stage and key; those whose manifest cannot be read say so.

    Parameters
    ----------
    index
        File of this machine; filled from the shared object if it knows little.
    """
    listed = reader.listed()
    order = sorted(listed, key=lambda ref: (ref.stage, ref.key))
    present = [(ref, f"{objects.location} {listed[ref].version}") for ref in order]
    with contextlib.suppress(OSError):
        index.parent.mkdir(parents=True, exist_ok=True)
        if _size(index) < LINE * len(present):
            with open(index, "ab") as file:
                file.write(objects.read(INDEX) or b"")
    before = _size(index)
    found = catalogue(index, present, lambda ref: reader.known(ref).manifest)
    if _size(index) - before > LINE * WORTH_SHARING:
        with contextlib.suppress(OSError, StoreError):  # only a cache, and perhaps read-only
            objects.write({INDEX: index.read_bytes()})
    return found


def _size(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError:
        return 0
