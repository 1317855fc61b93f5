"""What listing, tagging and removing need of a store, whatever it is kept on."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

from pipeline.keys import Ref
from pipeline.store.catalogue import Row
from pipeline.store.labels import RegisteredRun, RunLabel


@dataclass(frozen=True)
class Leftover:
    """Work that was begun and not published, or a damaged artefact that was set aside.

    Attributes
    ----------
    name
        Under which the store keeps it.
    key
        Of the result that it was to become.
    size
        Bytes.
    changed
        When something of it changed last, seconds since 1970.
    resumable
        Whether there is a checkpoint to go on from.
    busy
        Whether a process works on it.
    published
        Whether that result is there, computed by another process.
    damaged
        Whether it is an artefact that was set aside; it is none of the others then.
    """

    name: str
    key: str
    size: int
    changed: float
    resumable: bool
    busy: bool
    published: bool
    damaged: bool = False


class Upkeep(Protocol):
    """The side of a store that its user looks after; ``pipeline.testing.upkeep`` tests it."""

    def rows(self) -> list[Row]:
        """All artefacts, sorted by stage and key; those whose manifest cannot be read say so."""
        ...

    def last_uses(self) -> dict[Ref, float]:
        """When a run found each artefact last, seconds since 1970; those never found are left out."""
        ...

    def runs(self) -> Iterator[RegisteredRun]:
        """All runs that the store knows, in no particular order."""
        ...

    def used_by(self, label: RunLabel) -> Iterator[Ref]:
        """What a run has registered so far, some of it perhaps twice, or not there."""
        ...

    def forget(self, label: RunLabel) -> None:
        """Remove all that is known of a run, and nothing of what it used."""
        ...

    def tags(self) -> dict[Ref, tuple[str, ...]]:
        """Tags of all artefacts that have any, sorted."""
        ...

    def tag(self, ref: Ref, name: str) -> None:
        """Give an artefact a tag, which keeps it from being removed."""
        ...

    def untag(self, ref: Ref, name: str) -> None:
        """Take a tag away; nothing happens if the artefact has it not."""
        ...

    def remove(self, refs: Sequence[Ref], kept: Callable[[], Container[Ref]]) -> list[Ref]:
        """Remove artefacts, and give those that are gone now.

        Nobody sees a part of one. Those that a process writes, or finds at this moment, stay.

        Parameters
        ----------
        refs
            At best some dozens: for their time nobody can find them with the label of a run.
        kept
            What must stay; asked when no further run can register any of ``refs`` before they are
            gone.
        """
        ...

    def leftovers(self) -> list[Leftover]:
        """Work that was begun and not published, and what was set aside, sorted by name."""
        ...

    def discard(self, leftover: Leftover) -> bool:
        """Remove one of them, unless it changed since or a process works on it; tells if it is gone."""
        ...
