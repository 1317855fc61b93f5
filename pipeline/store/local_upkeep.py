"""Listing, tagging and removing in a local store."""

from __future__ import annotations

import contextlib
import fcntl
import os
import time
from collections.abc import Callable, Container, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from pipeline.durable import remove_tree, storing, sync
from pipeline.errors import StoreError
from pipeline.fingerprint.contents import state
from pipeline.keys import Ref
from pipeline.manifest import Manifest
from pipeline.store import local_leftovers, tags
from pipeline.store.catalogue import Row, catalogue
from pipeline.store.folders import entries, names
from pipeline.store.labels import RegisteredRun, RunLabel
from pipeline.store.local_leftovers import REMOVED
from pipeline.store.locks import try_lock
from pipeline.store.registers import Registers
from pipeline.store.upkeep import Leftover

INDEX = "index.jsonl"
"""File of the catalogue, a cache."""


@dataclass(frozen=True)
class LocalUpkeep:
    """Upkeep of a store in a folder.

    Attributes
    ----------
    path
        The folder.
    registers
        What its runs use.
    """

    path: Path
    registers: Registers

    def rows(self) -> list[Row]:
        """All artefacts, sorted by stage and key; those whose manifest cannot be read say so."""
        with storing(self.path):
            return catalogue(self.path / INDEX, self._stamped(), self._load)

    def last_uses(self) -> dict[Ref, float]:
        """When a run found each artefact last, seconds since 1970; those never found are left out."""
        with storing(self.path):
            uses = {}
            for stage in names(self.path / "usage"):
                for entry in entries(self.path / "usage" / stage):
                    with contextlib.suppress(FileNotFoundError):  # removed just now
                        uses[Ref(stage, entry.name)] = entry.stat().st_mtime
            return uses

    def runs(self) -> Iterator[RegisteredRun]:
        """All runs that the store knows, in no particular order."""
        with storing(self.path):
            yield from self.registers.runs()

    def used_by(self, label: RunLabel) -> Iterator[Ref]:
        """What a run has registered so far, some of it perhaps twice, or not there."""
        with storing(self.path):
            yield from self.registers.refs(label)

    def forget(self, label: RunLabel) -> None:
        """Remove all that is known of a run, and nothing of what it used."""
        with storing(self.path):
            self.registers.forget(label)

    def tags(self) -> dict[Ref, tuple[str, ...]]:
        """Tags of all artefacts that have any, sorted."""
        with storing(self.path):
            return tags.read_tags(self.path / "tags")

    def tag(self, ref: Ref, name: str) -> None:
        """Give an artefact a tag, which keeps it from being removed."""
        with storing(self.path):
            tags.add_tag(self.path / "tags", ref, name)

    def untag(self, ref: Ref, name: str) -> None:
        """Take a tag away; nothing happens if the artefact has it not."""
        with storing(self.path):
            tags.remove_tag(self.path / "tags", ref, name)

    def remove(self, refs: Sequence[Ref], kept: Callable[[], Container[Ref]]) -> list[Ref]:
        """Rename each artefact out of sight while its lock is held, then delete what is out of sight."""
        gone: dict[Ref, Path] = {}
        with storing(self.path), contextlib.ExitStack() as stack:
            free = [ref for ref in refs if stack.enter_context(self._alone(ref.key))]
            stay = kept() if free else ()
            for ref in free:
                if ref in stay:
                    continue
                target = self.path / "tmp" / f"{ref.key}.{REMOVED}.{time.time_ns()}"
                with contextlib.suppress(FileNotFoundError):
                    os.rename(self.path / "objects" / ref.stage / ref.key, target)
                    gone[ref] = target
            for stage in {ref.stage for ref in gone}:
                sync(self.path / "objects" / stage)
        with storing(self.path):
            for ref, folder in gone.items():
                remove_tree(folder)
                (self.path / "usage" / ref.stage / ref.key).unlink(missing_ok=True)
        return list(gone)

    def leftovers(self) -> list[Leftover]:
        """Work that was begun and not published, and what was set aside, sorted by name."""
        with storing(self.path):
            return local_leftovers.read(self.path)

    def discard(self, leftover: Leftover) -> bool:
        """Remove one of them, unless it changed since or a process works on it."""
        with storing(self.path), self._alone(leftover.key) as free:
            return free and local_leftovers.remove(self.path, leftover)

    def _load(self, ref: Ref) -> Manifest:
        folder = self.path / "objects" / ref.stage / ref.key
        try:
            return Manifest.from_json((folder / "manifest.json").read_bytes())
        except FileNotFoundError:
            if folder.is_dir():
                raise StoreError("its manifest is missing", path=folder) from None
            raise

    def _stamped(self) -> Iterator[tuple[Ref, str]]:
        """All artefacts, each with the state of its manifest."""
        objects = self.path / "objects"
        for stage in names(objects):
            for key in names(objects / stage):
                yield Ref(stage, key), stamp(objects / stage / key)

    @contextlib.contextmanager
    def _alone(self, key: str) -> Iterator[bool]:
        """Hold the lock of a key against all others, if nobody holds it."""
        lock = self.path / "locks" / key
        lock.parent.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(lock, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            yield try_lock(descriptor, fcntl.LOCK_EX) is not False
        finally:
            os.close(descriptor)


def stamp(folder: Path) -> str:
    """What changes when the manifest of an artefact does; empty if there is none."""
    try:
        return "{} {}".format(*state(folder / "manifest.json"))
    except OSError:
        return ""
