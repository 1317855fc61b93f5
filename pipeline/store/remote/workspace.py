"""Where an artefact of a remote store is written, on this machine, before it is published."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from pathlib import Path

from pipeline.durable import remove_tree, storing
from pipeline.errors import StoreError
from pipeline.keys import Ref
from pipeline.manifest import Manifest
from pipeline.store.remote.leases import Held
from pipeline.store.remote.markers import Marker, data_folder, marker_path
from pipeline.store.remote.mirror import Mirror
from pipeline.store.remote.objects import Objects
from pipeline.store.remote.read_cache import ReadCache
from pipeline.store.workspace import make_ready


@dataclass(frozen=True)
class RemoteWorkspace:
    """Work folder in the cache folder of this machine.

    Attributes
    ----------
    ref
        The artefact.
    folder, checkpoint
        Of the unfinished work.
    objects, cache, mirror, lease
        Of the store; where the copies of this attempt's checkpoints go; what is held.
    """

    ref: Ref
    folder: Path
    checkpoint: Path
    objects: Objects
    cache: ReadCache
    mirror: Mirror
    lease: Held

    @property
    def data(self) -> Path:
        """Folder for the data files."""
        return self.folder / "data"

    def begin(self, *, resume: bool) -> None:
        """Make ready to write."""
        make_ready(self.folder, self.data, self.checkpoint, resume=resume)

    def saved(self, *, last: bool) -> None:
        """Copy the checkpoint now and then."""
        self.mirror.copy(last=last)

    def publish(self, manifest: Manifest) -> Manifest:
        """Upload the data under a name of their own, then create the marker: the only commit point."""
        marker = Marker(self.mirror.attempt, manifest)
        mine = data_folder(self.ref, marker.attempt)
        try:
            self._upload(manifest, mine)
            standing = self._commit(marker)
        except StoreError:
            with contextlib.suppress(StoreError):
                self._discard_unless_published(marker, mine)
            raise
        self.lease.settled = True
        with storing(self.folder):
            if standing.attempt == marker.attempt:
                self.cache.adopt(self.ref, marker, self.data)
            remove_tree(self.folder)
            remove_tree(self.checkpoint.parent)
        with contextlib.suppress(StoreError):  # it is published; what is left is swept some day
            self._discard_all_but(standing)
            self.mirror.remove()
        return standing.manifest

    def _upload(self, manifest: Manifest, folder: str) -> None:
        self.objects.upload({f"{folder}/{f.path}": self.data / f.path for f in manifest.files})
        there = self.objects.listing(folder)
        for file in manifest.files:
            entry = there.get(f"{folder}/{file.path}")
            if entry is None or entry.size != file.size:
                raise StoreError(
                    f"{file.path} did not arrive whole",
                    path=f"{self.objects.location}/{folder}",
                    remedy="run the same command again",
                )

    def _commit(self, marker: Marker) -> Marker:
        """Create the marker; gives the one that stands, another's if that was first."""
        path = marker_path(self.ref)
        for _ in range(3):
            if self.objects.create(path, marker.to_bytes()):
                return marker
            contents = self.objects.read(path)
            if contents is not None:
                try:
                    return Marker.from_bytes(contents)
                except ValueError as error:
                    raise StoreError(
                        f"unreadable manifest of {self.ref} ({error})",
                        path=f"{self.objects.location}/{path}",
                        remedy="run the same command with --recompute-damaged",
                    ) from error
        raise StoreError(
            f"{self.ref} was removed again and again while it was published",
            path=f"{self.objects.location}/{path}",
        )

    def _discard_unless_published(self, marker: Marker, folder: str) -> None:
        """After a failure: the marker may be there though its answer was lost."""
        contents = self.objects.read(marker_path(self.ref))
        if contents is None or f'"{marker.attempt}"'.encode() not in contents.partition(b"\n")[0]:
            self.objects.remove(self.objects.listing(folder))

    def _discard_all_but(self, marker: Marker) -> None:
        """Remove what attempts left that never came to count, this one perhaps among them.

        One that is still being uploaded cannot come to count any more.
        """
        kept = data_folder(self.ref, marker.attempt) + "/"
        there = self.objects.listing(data_folder(self.ref))
        self.objects.remove([path for path in there if not path.startswith(kept)])
