"""Listing, tagging and removing in a remote store."""

from __future__ import annotations

import contextlib
import dataclasses
import datetime
import json
import platform
import sys
import time
from collections.abc import Callable, Container, Iterable, Iterator, Sequence
from dataclasses import dataclass
from urllib.parse import quote, unquote

from pipeline.errors import StoreError
from pipeline.keys import Ref
from pipeline.store.catalogue import Row
from pipeline.store.labels import RegisteredRun, RunLabel
from pipeline.store.local_upkeep import LocalUpkeep
from pipeline.store.registers import Registers
from pipeline.store.remote.folders import Folders
from pipeline.store.remote.index import INDEX, rows
from pipeline.store.remote.leases import Leases
from pipeline.store.remote.markers import Marker, data_folder, marker_path
from pipeline.store.remote.objects import Entry, Objects
from pipeline.store.remote.reader import Reader
from pipeline.store.remote.registers import RemoteRegisters
from pipeline.store.remote.uses import Uses
from pipeline.store.tags import checked
from pipeline.store.upkeep import Leftover

WAIT = 0.1
"""Seconds between looks at a removal that is under way."""


@dataclass(frozen=True)
class RemoteUpkeep:
    """Upkeep of a remote store.

    Attributes
    ----------
    objects, reader, registers, uses, leases, folders
        Of the store.
    """

    objects: Objects
    reader: Reader
    registers: RemoteRegisters
    uses: Uses
    leases: Leases
    folders: Folders

    def rows(self) -> list[Row]:
        """All artefacts, sorted by stage and key; those whose manifest cannot be read say so."""
        return rows(self.objects, self.reader, self.folders.path / INDEX)

    def last_uses(self) -> dict[Ref, float]:
        """When a run found each artefact last, by the server's clock; those never found are left out."""
        self.uses.write()
        found = self.objects.listing("usage")
        return {Ref(*path.split("/")[-2:]): entry.modified for path, entry in found.items()}

    def runs(self) -> Iterator[RegisteredRun]:
        """All runs that the store knows, in no particular order."""
        return self.registers.runs()

    def used_by(self, label: RunLabel) -> Iterator[Ref]:
        """What a run has registered so far, some of it perhaps not there."""
        return self.registers.refs(label)

    def forget(self, label: RunLabel) -> None:
        """Remove all that is known of a run, and nothing of what it used."""
        self.registers.forget(label)

    def tags(self) -> dict[Ref, tuple[str, ...]]:
        """Tags of all artefacts that have any, sorted."""
        found: dict[Ref, list[str]] = {}
        for path in self.objects.listing("tags"):
            _, stage, key, name = path.split("/")
            found.setdefault(Ref(stage, key), []).append(unquote(name))
        return {ref: tuple(sorted(names)) for ref, names in found.items()}

    def tag(self, ref: Ref, name: str) -> None:
        """Give an artefact a tag, which keeps it from being removed."""
        self.objects.write({_tag_path(ref, name): b""})

    def untag(self, ref: Ref, name: str) -> None:
        """Take a tag away; nothing happens if the artefact has it not."""
        self.objects.remove([_tag_path(ref, name)])

    def remove(self, refs: Sequence[Ref], kept: Callable[[], Container[Ref]]) -> list[Ref]:
        """Take markers away while their leases are held; put back those that are wanted after all.

        A run registers an artefact before it looks for the marker. So if it still found the marker,
        its registration is there when ``kept`` is asked. If it found none in between, it waits.
        """
        self._put_back(self.objects.listing("removed"))
        gone: list[Ref] = []
        with contextlib.ExitStack() as stack:
            free = [ref for ref in refs if self._take(ref, stack)]
            away = {ref: contents for ref in free if (contents := self._hide(ref)) is not None}
            stay = kept() if away else ()
            for ref, contents in away.items():
                if ref in stay:
                    self.objects.create(marker_path(ref), contents)
                    self.objects.remove([_hidden(ref)])
                else:
                    # Before the data, so that a marker that is put back has them all.
                    self.objects.remove([_hidden(ref)])
                    self._delete(ref, contents)
                    gone.append(ref)
        return gone

    def await_removal(self, ref: Ref) -> bool:
        """Wait while an artefact is being removed; gives whether it was.

        If the process that removed it is gone, the marker is put back.
        """
        if self.objects.read(_hidden(ref)) is None:
            return False
        while self.leases.busy(ref.key) and self.objects.read(_hidden(ref)) is not None:
            time.sleep(WAIT)
        self._put_back([_hidden(ref)])
        return True

    def leftovers(self) -> list[Leftover]:
        """What is left on this machine and in the store, sorted by name.

        That is work that was begun and not published, and what was set aside as damaged.
        """
        groups: dict[str, dict[str, Entry]] = {}
        for path, entry in self.objects.listing("data").items():
            groups.setdefault("/".join(path.split("/")[:4]), {})[path] = entry
        counted = self._counted({Ref(*name.split("/")[1:3]) for name in groups})
        groups = {name: files for name, files in groups.items() if name not in counted}
        for path, entry in self.objects.listing("checkpoints").items():
            groups.setdefault("/".join(path.split("/")[:3]), {})[path] = entry
        aside: dict[str, dict[str, Entry]] = {}
        for path, entry in self.objects.listing("quarantine").items():
            aside.setdefault("/".join(path.split("/")[:3]), {})[path] = entry
        here = self._here.leftovers()
        published = {ref.key for ref in self.reader.listed()} if groups or here else set()
        there = [self._leftover(name, files, published) for name, files in groups.items()]
        here = [dataclasses.replace(one, published=one.key in published) for one in here]
        there += [_set_aside(name, files) for name, files in aside.items()]
        return sorted(here + there, key=lambda one: one.name)

    def discard(self, leftover: Leftover) -> bool:
        """Remove one of these, unless a process works on it; gives whether it is gone."""
        if "/" not in leftover.name:
            return self._here.discard(leftover)
        with contextlib.ExitStack() as stack:
            if not self._take(Ref("upkeep", leftover.key), stack):
                return False
            kind, *stage_and_key = leftover.name.split("/")[:3]
            if kind == "data" and leftover.name in self._counted([Ref(*stage_and_key)]):
                return False  # it was published meanwhile
            self.objects.remove(self.objects.listing(leftover.name))
        return True

    @property
    def _here(self) -> LocalUpkeep:
        """Unfinished work on this machine lies as in a local store."""
        return LocalUpkeep(self.folders.path, Registers(self.folders.path / "runs"))

    def _take(self, ref: Ref, stack: contextlib.ExitStack) -> bool:
        held = self.leases.take(ref.key, ref.stage, alone_here=False)
        if held is None:
            return False
        held.settled = True
        stack.enter_context(self.leases.keeping(held, ref.stage))
        return True

    def _hide(self, ref: Ref) -> bytes | None:
        """Take a marker away, remembering it first in case this process ends here."""
        contents = self.objects.read(marker_path(ref))
        if contents is not None:
            self.objects.write({_hidden(ref): contents})
            self.objects.remove([marker_path(ref)])
        return contents

    def _put_back(self, paths: Iterable[str]) -> None:
        """Put markers back that a removal which was killed had taken away."""
        for path in paths:
            ref = Ref(*path.split("/")[-2:])
            with contextlib.ExitStack() as stack:
                if self._take(ref, stack) and (contents := self.objects.read(path)) is not None:
                    self.objects.create(marker_path(ref), contents)
                    self.objects.remove([path])

    def _delete(self, ref: Ref, contents: bytes) -> None:
        try:
            folder = data_folder(ref, Marker.from_bytes(contents).attempt)
        except ValueError:
            folder = data_folder(ref)
        self.objects.remove(self.objects.listing(folder))
        self.uses.drop(ref)
        self.objects.remove([f"usage/{ref.stage}/{ref.key}"])

    def _counted(self, refs: Iterable[Ref]) -> set[str]:
        """Folders of data that markers name; all of an artefact whose marker cannot be read."""
        refs = list(refs)
        paths = {marker_path(ref): ref for ref in refs} | {_hidden(ref): ref for ref in refs}
        folders: set[str] = set()
        for path, contents in self.objects.read_many(paths).items():
            try:
                folders.add(data_folder(paths[path], Marker.from_bytes(contents).attempt))
            except ValueError:
                there = self.objects.listing(data_folder(paths[path]))
                folders |= {"/".join(one.split("/")[:4]) for one in there}
        return folders

    def _leftover(self, name: str, files: dict[str, Entry], published: set[str]) -> Leftover:
        parts = name.split("/")
        key = parts[1] if parts[0] == "checkpoints" else parts[2]
        return Leftover(
            name=name,
            key=key,
            size=sum(entry.size for entry in files.values()),
            changed=max(entry.modified for entry in files.values()),
            resumable=f"{name}/state.npz" in files,
            busy=self.leases.busy(key),
            published=key in published,
        )


def _set_aside(name: str, files: dict[str, Entry]) -> Leftover:
    return Leftover(
        name=name,
        key=name.rpartition("/")[2].partition(".")[0],
        size=sum(entry.size for entry in files.values()),
        changed=max(entry.modified for entry in files.values()),
        resumable=False,
        busy=False,
        published=False,
        damaged=True,
    )


def set_aside(objects: Objects, reader: Reader, ref: Ref, problems: Iterable[str]) -> str:
    """Move a damaged artefact to ``quarantine/<stage>/<key>.<time>/``; gives its URL.

    The caller has the lease of its key. Report and copies are written first.
    """
    now = datetime.datetime.now(datetime.UTC)
    place = f"quarantine/{ref.stage}/{ref.key}.{now:%Y%m%dT%H%M%S.%fZ}"
    report = {
        "artefact": str(ref),
        "found": now.isoformat(timespec="milliseconds"),
        "problems": list(problems),
        "host": platform.node(),
        "command": sys.argv,
    }
    objects.write({f"{place}/report.json": json.dumps(report, indent=1).encode()})
    marker = objects.read(marker_path(ref))
    if marker is None:
        raise StoreError("the artefact was removed meanwhile", path=reader.where(ref))
    objects.write({f"{place}/manifest": marker})
    files = objects.listing(data_folder(ref))
    with reader.scratch() as scratch:
        copies = {path: scratch / path for path in files}
        objects.download(copies)
        objects.upload({f"{place}/{path}": copy for path, copy in copies.items()})
    objects.remove([marker_path(ref)])
    objects.remove(files)
    return f"{objects.location}/{place}"


def _hidden(ref: Ref) -> str:
    return f"removed/{ref.stage}/{ref.key}"


def _tag_path(ref: Ref, name: str) -> str:
    return f"tags/{ref.stage}/{ref.key}/{quote(checked(name), safe='')}"
