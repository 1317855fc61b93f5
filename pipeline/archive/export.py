"""Writing artefacts of a store into an archive."""

from __future__ import annotations

import contextlib
import hashlib
import io
import os
import tarfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from pipeline.archive.form import HEADER, Header, folder_of
from pipeline.durable import storing, sync
from pipeline.errors import InputError, MyofilmError, StoreError
from pipeline.keys import Ref
from pipeline.manifest import Manifest
from pipeline.store.protocol import Store
from pipeline.verification import DamagedError, wrong_checksum


class WritingError(MyofilmError):
    """An archive cannot be written; what is in the store stays as it is."""


def export(store: Store, header: Header, path: Path) -> int:
    """Write an archive, and give its size in bytes.

    Every file is compared with its checksum on the way. The archive appears whole or not at all; it
    holds no times and no users, so that the same results give the same bytes.

    Parameters
    ----------
    store
        Where the artefacts are.
    header
        Which they are, and what is to be told of them.
    path
        File to be made.

    Raises
    ------
    InputError
        If there is such a file, or its folder is not there.
    StoreError
        If an artefact is damaged or gone.
    WritingError
        If the file cannot be written.
    """
    if path.exists():
        raise InputError(f"{path} is there already; remove it, or choose another name")
    if not path.parent.is_dir():
        raise InputError(f"the folder {path.parent} of the archive is not there; make it first")
    with _appearing(path) as file, tarfile.open(fileobj=file, mode="w") as tar:
        _add(tar, HEADER, header.to_json())
        for ref in header.refs:
            manifest = _found(store, ref)
            _add(tar, f"{folder_of(ref)}/manifest.json", manifest.to_json())
            _add_data(tar, store, manifest)
    return path.stat().st_size


def _found(store: Store, ref: Ref) -> Manifest:
    manifest = store.find(ref)
    if manifest is None:
        raise StoreError(
            f"the result {ref} is no longer in the store",
            path=store.location,
            remedy="run the experiment again, then export it",
        )
    return manifest


def _add_data(tar: tarfile.TarFile, store: Store, manifest: Manifest) -> None:
    data, folder = store.data(manifest.ref), f"{folder_of(manifest.ref)}/data"
    for entry in manifest.files:
        with storing(data):
            contents = (data / entry.path).read_bytes()
        if hashlib.sha256(contents).hexdigest() != entry.sha256:
            where = store.where(manifest.ref)
            raise DamagedError(manifest.ref, where, [wrong_checksum(entry.path)])
        _add(tar, f"{folder}/{entry.path}", contents)


def _add(tar: tarfile.TarFile, name: str, contents: bytes) -> None:
    member = tarfile.TarInfo(name)
    member.size, member.mode = len(contents), 0o644
    tar.addfile(member, io.BytesIO(contents))


@contextlib.contextmanager
def _appearing(path: Path) -> Iterator[IO[bytes]]:
    """File that takes its name when all is written and on the disk."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.new")
    try:
        with open(temporary, "wb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
        sync(path.parent)
    except OSError as error:
        raise WritingError(
            f"cannot write the archive {path}: {(error.strerror or str(error)).lower()}\n"
            "Remedy: choose another place for it; nothing in the store has changed"
        ) from error
    finally:
        temporary.unlink(missing_ok=True)
