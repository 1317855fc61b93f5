"""The garbage collection: what would go is told first, what goes is looked at again."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from pipeline.keys import Ref
from pipeline.store.catalogue import Row
from pipeline.store.cleaning import Limits, Removal, reachable, removals, stale
from pipeline.store.labels import RegisteredRun, RunLabel
from pipeline.store.protocol import Store
from pipeline.store.upkeep import Leftover

BATCH = 256
"""Artefacts removed together: their locks are held while the registers are read again."""


@dataclass(frozen=True)
class Plan:
    """What a collection would remove.

    Attributes
    ----------
    rows
        All artefacts that there are.
    reached
        Those that a run or a tag keeps, there or not.
    removals
        Artefacts that would go.
    leftovers
        Unfinished work that would go, and why.
    ended
        Runs that keep nothing any longer: they would be forgotten.
    """

    rows: Sequence[Row]
    reached: Collection[Ref]
    removals: Sequence[Removal]
    leftovers: Sequence[tuple[Leftover, str]]
    ended: Sequence[RunLabel]

    @property
    def size(self) -> int:
        """Bytes that would be free."""
        artefacts = sum(removal.row.size for removal in self.removals)
        return artefacts + sum(leftover.size for leftover, _ in self.leftovers)

    @property
    def seconds(self) -> float:
        """Seconds that computing the artefacts again would take."""
        return sum(removal.row.seconds for removal in self.removals)


Holds: TypeAlias = Callable[[RegisteredRun, float], bool]
"""Whether a run holds on to what it uses, now."""


def keeps(run: RegisteredRun, now: float) -> bool:
    """What holds against a collection: a name, a folder that is there, a process that runs."""
    return run.keeps(now)


def insists(run: RegisteredRun, now: float) -> bool:
    """What holds against a user who asks to remove one artefact: a folder does not."""
    return run.alive or run.label.named


def plan(store: Store, limits: Limits, now: float | None = None) -> Plan:
    """What would be removed now.

    Raises
    ------
    StoreError
        If the store cannot be read; nobody can tell then what a damaged register kept.
    """
    now = time.time() if now is None else now
    rows = store.upkeep.rows()
    reached = kept(store, rows, now)
    runs = list(store.upkeep.runs())
    return Plan(
        rows=rows,
        reached=reached,
        removals=removals(rows, store.upkeep.last_uses(), reached, limits, now),
        leftovers=stale(store.upkeep.leftovers(), limits, now),
        ended=[run.label for run in runs if not run.keeps(now)],
    )


def kept(store: Store, rows: Sequence[Row], now: float) -> set[Ref]:
    """What runs and tags keep: what they name, and all that this was computed from."""
    return reachable(roots(store, now), {row.ref: row for row in rows})


def roots(store: Store, now: float, holds: Holds = keeps) -> Iterator[Ref]:
    """What tags name, and those runs that hold on to what they use."""
    yield from store.upkeep.tags()
    for run in store.upkeep.runs():
        if holds(run, now):
            yield from store.upkeep.used_by(run.label)


@dataclass(frozen=True)
class Keeper:
    """Who keeps an artefact: a run, or a tag (of something computed from it)."""

    run: RegisteredRun | None = None
    tag: str = ""
    tagged: Ref | None = None


def keepers(
    store: Store, ref: Ref, rows: Sequence[Row], now: float, holds: Holds = keeps
) -> Iterator[Keeper]:
    """All who keep one artefact."""
    by_ref = {row.ref: row for row in rows}
    for tagged, tags in store.upkeep.tags().items():
        if ref in reachable([tagged], by_ref):
            yield from (Keeper(tag=tag, tagged=tagged) for tag in tags)
    for run in store.upkeep.runs():
        if holds(run, now) and ref in reachable(store.upkeep.used_by(run.label), by_ref):
            yield Keeper(run)


def collect(store: Store, planned: Plan) -> tuple[list[Removal], list[Leftover]]:
    """Remove what was planned, except what somebody uses by now; gives what is gone."""
    by_ref = {removal.row.ref: removal for removal in planned.removals}
    gone = remove(store, list(by_ref), planned.rows)
    discarded = [each for each, _ in planned.leftovers if store.upkeep.discard(each)]
    for run in list(store.upkeep.runs()):
        if run.label in planned.ended and not run.keeps(time.time()):
            store.upkeep.forget(run.label)
    return [by_ref[ref] for ref in gone], discarded


def remove(
    store: Store, refs: Sequence[Ref], rows: Sequence[Row], holds: Holds = keeps
) -> list[Ref]:
    """Remove artefacts that nothing keeps at the moment when each goes; gives those that are gone.

    Parameters
    ----------
    store
        Where they are.
    refs
        What should go.
    rows
        All artefacts: what each was computed from.
    holds
        Which runs count.
    """
    gone: list[Ref] = []
    by_ref = {row.ref: row for row in rows}
    reached: set[Ref] = set()

    def look_again() -> set[Ref]:
        # Those who began to use something since then named it themselves, with all of its inputs.
        reached.update(reachable(roots(store, time.time(), holds), by_ref, reached))
        return reached

    for begin in range(0, len(refs), BATCH):
        gone += store.upkeep.remove(refs[begin : begin + BATCH], look_again)
    return gone
