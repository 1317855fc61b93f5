"""Writing that survives a crash, and disk errors told in the user's terms."""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import threading
from collections.abc import Iterator
from pathlib import Path

from pipeline.errors import InputError, StoreError


def write_atomically(path: Path, contents: bytes) -> None:
    """Replace a file by new contents: a reader sees the old or the new ones, never a mixture."""
    temporary = path.with_name(f"{path.name}.{os.getpid()}.{threading.get_ident()}.new")
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        with open(temporary, "wb") as file:
            file.write(contents)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    sync(path.parent)


def sync(path: Path) -> None:
    """Force a file or a folder's entries to the disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def sync_tree(folder: Path) -> None:
    """Force all files and folders below (and including) a folder to the disk."""
    for parent, _, files in os.walk(folder, topdown=False, onerror=_refuse):
        for name in files:
            sync(Path(parent, name))
        sync(Path(parent))


def files_below(folder: Path) -> Iterator[Path]:
    """All files below a folder; none if it is not there.

    Raises
    ------
    OSError
        If a folder cannot be read: what is in it must not be taken for absent.
    """
    if folder.is_dir():
        for parent, _, names in os.walk(folder, onerror=_refuse):
            yield from (Path(parent, name) for name in names)


def _refuse(error: OSError) -> None:
    raise error


def remove_tree(folder: Path) -> None:
    """Remove a folder and all in it; nothing happens if it is not there."""
    with contextlib.suppress(FileNotFoundError):
        shutil.rmtree(folder)


@contextlib.contextmanager
def storing(path: Path) -> Iterator[None]:
    """Translate disk errors met in the block.

    Raises
    ------
    StoreError
        Naming the path and what to do, for a full disk also the space left on it.
    """
    try:
        yield
    except OSError as error:
        raise _told(error, path) from error


@contextlib.contextmanager
def opening(path: Path) -> Iterator[None]:
    """Translate disk errors met in the block, which makes the first use of a store.

    Raises
    ------
    InputError
        If this store can never be used: another one must be asked for.
    StoreError
        If its disk is full.
    """
    try:
        yield
    except OSError as error:
        told = _told(error, path)
        if _is_full(error):
            raise told from error
        raise InputError(str(told)) from error


def _told(error: OSError, path: Path) -> StoreError:
    where = Path(error.filename) if isinstance(error.filename, str) else path
    if _is_full(error):
        cause = f"no space left on the disk of the store ({_free(path)} free)"
        remedy = "free some space, or choose another disk with --store"
    elif error.errno == errno.EROFS:
        cause = "the store is on a read-only file system"
        remedy = "choose another folder with --store"
    elif error.errno in (errno.EACCES, errno.EPERM):
        cause = "no permission to use the store"
        remedy = "change the permissions, or choose another folder with --store"
    else:
        cause = f"the store cannot be used ({error.strerror or error})"
        remedy = "choose another folder with --store"
    return StoreError(cause, path=where, remedy=remedy)


def _is_full(error: OSError) -> bool:
    return error.errno in (errno.ENOSPC, errno.EDQUOT) or "No space left" in str(error)


def _free(path: Path) -> str:
    for folder in (path, *path.parents):
        with contextlib.suppress(OSError):
            return f"{shutil.disk_usage(folder).free / 1e6:.1f} MB"
    return "an unknown amount"
