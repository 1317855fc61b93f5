"""Results read back from a store, never damaged ones.

Sizes of all files are compared with the manifest at once, and checksums, too, except of the chunks of
zarr arrays: these are compared whenever a chunk is read.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pipeline.codecs import load, load_part
from pipeline.durable import storing
from pipeline.keys import Ref
from pipeline.manifest import FileEntry, sha256
from pipeline.records import parts_of
from pipeline.store import Store
from pipeline.verification import DamagedError, size_problem, wrong_checksum


def load_result(store: Store, ref: Ref, record: type, part: str | None = None) -> Any:
    """Record kept as an artefact, or one part of it.

    Parameters
    ----------
    store, ref
        The artefact.
    record
        Record class of the whole.
    part
        Name of the part; ``None`` for the whole.

    Raises
    ------
    StoreError
        If the artefact cannot be read or is damaged.
    """
    folder = store.data(ref)
    files = [file for file in store.manifest(ref).files if part in (None, file.part)]
    checksums = {file.path: file.sha256 for file in files}
    with storing(folder):
        problems = [problem for file in files if (problem := _problem(folder, file))]
        if problems:
            raise DamagedError(ref, store.where(ref), problems)
        if part is None:
            return load(folder, record, checksums)
        return load_part(folder, part, parts_of(record)[part], checksums)


def _problem(folder: Path, file: FileEntry) -> str | None:
    if problem := size_problem(folder, file):
        return problem
    if _is_read_later(file) or sha256(folder / file.path) == file.sha256:
        return None
    return wrong_checksum(file.path)


def _is_read_later(file: FileEntry) -> bool:
    """Whether a file is a chunk of a zarr array."""
    return ".zarr/" in file.path and not file.path.endswith("/zarr.json")
