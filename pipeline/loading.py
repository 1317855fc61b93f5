"""Results read back from a store, never damaged ones.

Checksums are compared with the manifest where the codec would not notice a flipped bit: in HDF5 files
and in the metadata of zarr groups. Chunks of zarr arrays, read lazily, carry checksums of their own.
"""

from __future__ import annotations

from typing import Any

from pipeline.codecs import load, load_part
from pipeline.durable import storing
from pipeline.keys import Ref
from pipeline.manifest import FileEntry, sha256
from pipeline.records import parts_of
from pipeline.store import Store
from pipeline.verification import DamagedError, wrong_checksum


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
    with storing(folder):
        checked = [file for file in files if not _checks_itself(file)]
        problems = [
            wrong_checksum(file.path)
            for file in checked
            if sha256(folder / file.path) != file.sha256
        ]
        if problems:
            raise DamagedError(ref, folder.parent, problems)
        if part is None:
            return load(folder, record)
        return load_part(folder, part, parts_of(record)[part])


def _checks_itself(file: FileEntry) -> bool:
    """Whether a file is a chunk of a zarr array."""
    return ".zarr/" in file.path and not file.path.endswith("/zarr.json")
