"""What a remote store keeps on this machine."""

from __future__ import annotations

import contextlib
import os
import uuid
from dataclasses import dataclass
from pathlib import Path

from pipeline.canonical import digest
from pipeline.durable import write_atomically
from pipeline.errors import InputError
from pipeline.keys import Ref

SIZE = 10e9
"""Bytes of copies of artefacts that are kept, if nothing else is said."""


def cache_folder(location: str) -> Path:
    """Folder for a store: below ``MYOFILM_CACHE``, or in the user's cache folder."""
    base = os.environ.get("MYOFILM_CACHE")
    if not base:
        import platformdirs

        base = platformdirs.user_cache_dir("myofilm")
    return Path(base).expanduser().absolute() / "remote" / digest(location)[:16]


def cache_limit() -> float:
    """Bytes of copies to keep: ``MYOFILM_CACHE_SIZE`` in GB, or 10 GB.

    Raises
    ------
    InputError
        If it is not a size.
    """
    text = os.environ.get("MYOFILM_CACHE_SIZE", "").strip()
    try:
        size = float(text.removesuffix("GB")) * 1e9 if text else SIZE
        if not size >= 0.0:
            raise ValueError
    except ValueError:
        raise InputError(
            f"MYOFILM_CACHE_SIZE is {text!r}; give the size of the cache in GB, such as 20"
        ) from None
    return size


@dataclass(frozen=True)
class Folders:
    """Folders for unfinished work, its locks and checkpoints.

    Attributes
    ----------
    path
        The folder that holds all.
    """

    path: Path

    def make(self) -> None:
        """Make them."""
        for name in ("tmp", "locks", "checkpoints"):
            (self.path / name).mkdir(parents=True, exist_ok=True)

    def work(self, name: str) -> tuple[Path, Path]:
        """Work folder and checkpoint of a name."""
        return self.path / "tmp" / name, self.path / "checkpoints" / name / "state.npz"

    def lock(self, ref: Ref) -> Path:
        """Lock file of a key: among processes of this machine it tells who is dead at once."""
        return self.path / "locks" / ref.key

    def identity(self) -> str:
        """Id of this folder, the same for all processes that use it."""
        path = self.path / "id"
        with contextlib.suppress(FileNotFoundError):
            return path.read_text()
        self.path.mkdir(parents=True, exist_ok=True)
        new = path.with_name(f"id.{uuid.uuid4().hex}")
        write_atomically(new, uuid.uuid4().hex.encode())
        with contextlib.suppress(FileExistsError):
            os.link(new, path)
        new.unlink()
        return path.read_text()
