"""Which artefacts may go and in what order, decided from lists alone.

What a kept run or a tag reaches never goes: the artefacts that it names, and all that these were
computed from. Among the others each limit is a reason to go.
"""

from __future__ import annotations

from collections.abc import Collection, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass

from pipeline.keys import Ref
from pipeline.store.catalogue import Row
from pipeline.store.upkeep import Leftover

DAY = 86400.0

UNFINISHED_DAYS = 30.0
"""Days for which a checkpoint is kept that nobody goes on from, and what was set aside as damaged."""

FAILED_DAYS = 1.0
"""Days for which the unfinished work of a failed stage is kept, to be looked at."""


@dataclass(frozen=True)
class Limits:
    """Why artefacts that nothing reaches should go; each limit that is set is a reason.

    Attributes
    ----------
    unused_for
        Seconds since an artefact was used last.
    size
        Bytes that all artefacts together may have.
    unreachable
        Whether it is enough that nothing reaches them.
    """

    unused_for: float | None = None
    size: int | None = None
    unreachable: bool = False


@dataclass(frozen=True)
class Removal:
    """An artefact that is to go, and why."""

    row: Row
    why: str


def reachable(
    roots: Iterable[Ref], rows: Mapping[Ref, Row], known: Collection[Ref] = ()
) -> set[Ref]:
    """The roots and all that they were computed from, as far as that is there or was named.

    Nothing is asked again of what is known to be reached.

    Examples
    --------
    >>> film, wave = Ref("geometry", "1"), Ref("electrophysiology", "2")
    >>> rows = {wave: Row(wave, 0, 0.0, 0.0, inputs=(film,))}
    >>> reachable([wave], rows) == {film, wave}
    True
    """
    found = set(known)
    pending = [ref for ref in roots if ref not in found]
    while pending:
        ref = pending.pop()
        if ref not in found:
            found.add(ref)
            if row := rows.get(ref):
                pending.extend(row.inputs)
    return found


def removals(
    rows: Sequence[Row],
    last_uses: Mapping[Ref, float],
    reached: Container[Ref],
    limits: Limits,
    now: float,
) -> list[Removal]:
    """What should go, in this order: what saves the fewest seconds per byte goes first.

    Parameters
    ----------
    rows
        All artefacts; damaged ones stay, since nobody can tell what they are.
    last_uses
        When each was found last; without one it counts from its computation.
    reached
        What stays.
    limits
        Reasons to go.
    now
        Seconds since 1970.
    """
    free = [row for row in rows if row.ref not in reached and not row.problem]
    free.sort(key=lambda row: (worth(row), last_use(row, last_uses), row.ref.stage, row.ref.key))
    over = sum(row.size for row in rows) - limits.size if limits.size is not None else 0
    chosen = {row.ref: why for row in free if (why := _reason(row, last_uses, limits, now))}
    over -= sum(row.size for row in free if row.ref in chosen)
    for row in free:
        if over > 0 and row.size and row.ref not in chosen:
            chosen[row.ref] = "the store is too large"
            over -= row.size
    return [Removal(row, chosen[row.ref]) for row in free if row.ref in chosen]


def worth(row: Row) -> float:
    """Seconds of computing that a byte saves: low for what is large and quickly made."""
    return row.seconds / max(row.size, 1)


def last_use(row: Row, last_uses: Mapping[Ref, float]) -> float:
    """When an artefact was found or computed, whichever was later."""
    return max(row.finished, last_uses.get(row.ref, 0.0))


def _reason(row: Row, last_uses: Mapping[Ref, float], limits: Limits, now: float) -> str:
    if limits.unreachable:
        return "nothing reaches it"
    idle = now - last_use(row, last_uses)
    if limits.unused_for is not None and idle > limits.unused_for:
        return f"not used for {idle / DAY:.0f} days"
    return ""


def stale(leftovers: Iterable[Leftover], limits: Limits, now: float) -> list[tuple[Leftover, str]]:
    """Unfinished work that nobody will go on from, old evidence of damage, and why they may go.

    A checkpoint saves its stage all the time up to it, so it stays as long as ``unused_for`` says.
    """
    patience = UNFINISHED_DAYS * DAY if limits.unused_for is None else limits.unused_for
    found = []
    for leftover in leftovers:
        idle = now - leftover.changed
        if leftover.busy:
            continue
        if leftover.damaged:
            if idle > patience:
                found.append((leftover, f"set aside as damaged {idle / DAY:.0f} days ago"))
        elif leftover.published:
            found.append((leftover, "its result is there"))
        elif leftover.resumable and idle > patience:
            found.append((leftover, f"nobody went on from it for {idle / DAY:.0f} days"))
        elif not leftover.resumable and idle > FAILED_DAYS * DAY:
            found.append((leftover, "it cannot be gone on from"))
    return found
