"""What the engine needs of a store, whatever it is kept on."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Protocol

from pipeline.events import Holder
from pipeline.keys import Ref
from pipeline.manifest import Manifest
from pipeline.store.labels import RunLabel
from pipeline.store.upkeep import Upkeep


class Workspace(Protocol):
    """Where the holder of a key's lock writes before it publishes."""

    @property
    def folder(self) -> Path:
        """Folder of the unfinished work."""
        ...

    @property
    def data(self) -> Path:
        """Folder for the data files of the artefact."""
        ...

    @property
    def checkpoint(self) -> Path:
        """File for the checkpoint."""
        ...

    def begin(self, *, resume: bool) -> None:
        """Make ready to write; unless resuming, all that an earlier process left is removed."""
        ...

    def saved(self, *, last: bool) -> None:
        """Take note that the checkpoint was saved; a store elsewhere may keep a copy of it.

        Parameters
        ----------
        last
            Whether this process stops now, so that no later call will come.

        Raises
        ------
        StoreError
            If the copy could not be made; the checkpoint itself is safe here.
        """
        ...

    def publish(self, manifest: Manifest) -> Manifest:
        """Make the data, with its manifest, an artefact for all readers at once.

        Returns
        -------
        Manifest
            Of the artefact that stands: that of another process if it was published first. Where
            processors differ its last bits may, too, so what follows must go on from this one.
        """
        ...


class Store(Protocol):
    """What the engine needs of a store; ``pipeline.testing.stores`` tests it."""

    @property
    def location(self) -> str:
        """Where it is, for messages."""
        ...

    @property
    def upkeep(self) -> Upkeep:
        """What its user needs of it: lists, tags, removing."""
        ...

    def begin(self, label: RunLabel) -> None:
        """Make a run known and alive, before any of its processes asks for artefacts.

        It stays alive until it is finished or this process ends, however it ends. Beginning it again
        changes nothing. In a store that may only be read nothing happens.
        """
        ...

    def find(self, ref: Ref, label: RunLabel | None = None) -> Manifest | None:
        """Manifest of an artefact, ``None`` if there is none; sizes of its files are checked.

        With the label of a run the artefact is also noted as used now, and registered as one that this
        run needs, *whether it is there or not*: from then on nobody removes it as long as the run
        keeps what it needs. So whoever computes it afterwards need not register it again.

        Raises
        ------
        StoreError
            If the artefact is damaged.
        """
        ...

    def finish(self, label: RunLabel, *, keep_earlier: bool = False) -> None:
        """Note that a run ended well; what earlier runs of its name registered is forgotten.

        Parameters
        ----------
        label
            That the run was begun with.
        keep_earlier
            Whether the run was only a part of what its name stands for.
        """
        ...

    def manifest(self, ref: Ref) -> Manifest:
        """Manifest of an artefact that must be there; its files are not looked at."""
        ...

    def data(self, ref: Ref) -> Path:
        """Local folder with the data files of an artefact."""
        ...

    def refs(self, stage: str | None = None) -> Iterator[Ref]:
        """Artefacts of one stage or of all, sorted."""
        ...

    def newest(self, stage: str, count: int) -> list[Ref]:
        """The artefacts of a stage that were published last, at most ``count`` of them."""
        ...

    def checkpoint(self, ref: Ref) -> Path | None:
        """Local file with the checkpoint of an interrupted computation, ``None`` if there is none."""
        ...

    def verify(self, ref: Ref, *, full: bool = False) -> tuple[str, ...]:
        """Problems of an artefact in words; ``full`` recomputes every checksum."""
        ...

    def where(self, ref: Ref) -> Path | str:
        """Folder or URL of an artefact, to be told to users."""
        ...

    def quarantine(self, ref: Ref, problems: Iterable[str] = ()) -> Path | str | None:
        """Move an artefact aside if it is damaged; where it is then, ``None`` if it is not."""
        ...

    def writing(
        self, ref: Ref, on_wait: Callable[[Holder], None]
    ) -> AbstractContextManager[Workspace]:
        """Hold the lock of a key, waiting for its present holder, and work on the artefact.

        Raises
        ------
        InputError
            If the store cannot be written to, the first time that this is wanted.
        StoreError
            If it cannot any longer.
        """
        ...
