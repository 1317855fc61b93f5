"""Where an artefact of a local store is written before it is published."""

from __future__ import annotations

import errno
import os
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from pipeline.durable import remove_tree, storing, sync, sync_tree
from pipeline.manifest import Manifest
from pipeline.store.catalogue import note
from pipeline.store.local_upkeep import INDEX, stamp


@dataclass(frozen=True)
class LocalWorkspace:
    """Work folder in a local store."""

    folder: Path
    checkpoint: Path
    target: Path

    @property
    def data(self) -> Path:
        """Folder for the data files."""
        return self.folder / "data"

    def begin(self, *, resume: bool) -> None:
        """Make ready to write."""
        make_ready(self.folder, self.data, self.checkpoint, resume=resume)

    def saved(self, *, last: bool) -> None:
        """The checkpoint is where it belongs already."""

    def publish(self, manifest: Manifest) -> Manifest:
        """Sync everything, then rename the folder: the only commit point."""
        with storing(self.folder):
            (self.folder / "manifest.json").write_bytes(manifest.to_json())
            sync_tree(self.folder)
            _make_durable(self.target.parent)
            try:
                os.rename(self.folder, self.target)
            except OSError as error:
                if error.errno not in (errno.EEXIST, errno.ENOTEMPTY):
                    raise
                # Another process published the same result first: its manifest is the one that counts.
                manifest = Manifest.from_json((self.target / "manifest.json").read_bytes())
                remove_tree(self.folder)
            sync(self.target.parent)
            remove_tree(self.checkpoint.parent)
            note(self.target.parents[2] / INDEX, manifest, stamp(self.target))
        return manifest


def make_ready(folder: Path, data: Path, checkpoint: Path, *, resume: bool) -> None:
    """Make the data folder below a work folder; unless resuming, remove what was left there.

    Raises
    ------
    StoreError
        If the disk refuses.
    """
    with storing(folder):
        if not resume:
            remove_tree(folder)
            remove_tree(checkpoint.parent)
        data.mkdir(parents=True, exist_ok=True)


def _make_durable(folder: Path) -> None:
    """Make a folder; if another process did, its entry may not be on the disk yet."""
    folder.mkdir(parents=True, exist_ok=True)
    _sync_entry(folder, folder.stat().st_ino)


@lru_cache
def _sync_entry(folder: Path, inode: int) -> None:
    """Force the entry of a folder to the disk, once a process: an entry that is there stays."""
    sync(folder.parent)
