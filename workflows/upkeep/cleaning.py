"""What ``store gc``, ``store rm`` and ``store tag`` do."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence

from pipeline.errors import InputError, StoreError
from pipeline.keys import Ref
from pipeline.store import Store
from pipeline.store.cleaning import Limits, last_use
from pipeline.store.collection import Keeper, Plan, collect, insists, keepers, plan, remove
from pipeline.store.labels import RegisteredRun, runs_called
from workflows.progress import duration, size
from workflows.request import open_store
from workflows.tables import aligned
from workflows.upkeep.amounts import ago, bytes_of, seconds_of
from workflows.upkeep.names import AT_LEAST, SHORT, artefact, artefacts, short

LINES = 40
"""Lines of a list of what would be removed; the rest is counted."""


def collect_garbage(
    location: str | None,
    older_than: str | None,
    max_size: str | None,
    *,
    unreachable: bool = False,
    yes: bool = False,
) -> None:
    """Tell what would be removed, and with ``yes`` remove it.

    Raises
    ------
    InputError
        If a limit is none.
    """
    limits = Limits(
        None if older_than is None else seconds_of(older_than),
        None if max_size is None else bytes_of(max_size),
        unreachable,
    )
    store, now = open_store(location), time.time()
    planned = plan(store, limits, now)
    if not yes:
        for line in _told(store, planned, limits, now):
            print(line)
        return
    gone, discarded = collect(store, planned)
    freed = sum(each.row.size for each in gone) + sum(each.size for each in discarded)
    print(
        f"removed {_count(len(gone), 'result')} and "
        f"{_count(len(discarded), 'leftover')}: {size(freed)} are free"
    )
    stayed = len(planned.removals) + len(planned.leftovers) - len(gone) - len(discarded)
    if stayed:
        print(f"{stayed} stayed: somebody uses them by now")
    for line in _too_large(planned, limits):
        print(line)


def remove_named(names: Sequence[str], location: str | None) -> None:
    """Remove single results, or forget runs.

    Raises
    ------
    InputError
        If a name is neither, or not of one only, or a result is kept by a name or a tag.
    StoreError
        If a result is used at this moment.
    """
    store = open_store(location)
    for name in names:
        found = artefacts(store, name) if len(name) >= AT_LEAST else []
        try:
            runs = runs_called(store.upkeep.runs(), name)
        except InputError:
            if not found:
                raise InputError(
                    f"{store.location} knows no run {name!r} and holds no result whose key starts "
                    f"so (of a key at least {AT_LEAST} characters must be given)"
                ) from None
            _remove_artefact(store, artefact(store, name))
        else:
            _forget(store, runs)


def change_tag(key: str, tag: str, location: str | None, *, remove: bool = False) -> None:
    """Give a result a tag, which keeps it, or take it away.

    Raises
    ------
    InputError
        If there is no such result, it cannot have such a tag, or has not the one to take away.
    """
    store = open_store(location)
    ref = artefact(store, key)
    if not remove:
        store.upkeep.tag(ref, tag)
    elif tag in (tags := store.upkeep.tags().get(ref, ())):
        store.upkeep.untag(ref, tag)
    else:
        raise InputError(f"{short(ref)} has no tag {tag!r}. It has: {', '.join(tags) or 'none'}")


def _remove_artefact(store: Store, ref: Ref) -> None:
    rows, now = store.upkeep.rows(), time.time()
    held = list(keepers(store, ref, rows, now, insists))
    if held:
        ways = "; ".join(dict.fromkeys(_release(keeper) for keeper in held))
        raise InputError(f"{short(ref)} is kept. To remove it, first {ways}")
    if not remove(store, [ref], rows, insists):
        raise StoreError(
            f"{short(ref)} was not removed: a process uses it", remedy="try again when it has ended"
        )
    users = {keeper.run.label.name for keeper in keepers(store, ref, rows, now) if keeper.run}
    after = f"; {', '.join(sorted(users))} would need it computed again" if users else ""
    print(f"removed {short(ref)}{after}")


def _release(keeper: Keeper) -> str:
    if keeper.run is None:
        assert keeper.tagged is not None
        return f"take the tag away: myofilm store tag {short(keeper.tagged)} {keeper.tag} --remove"
    if keeper.run.alive:
        label = keeper.run.label
        return f"wait for the run {label.name!r} (process {label.process} on {label.host})"
    return f"remove the run: myofilm store rm {keeper.run.label.name!r}"


def _forget(store: Store, runs: Sequence[RegisteredRun]) -> None:
    for run in runs:
        if run.alive:
            where = f"process {run.label.process} on {run.label.host}"
            raise InputError(f"the run {run.label.name!r} goes on ({where}); stop it first")
    for run in runs:
        store.upkeep.forget(run.label)
    free = plan(store, Limits(unreachable=True)).removals
    total = size(sum(removal.row.size for removal in free))
    print(f"forgot the run {runs[-1].label.name}")
    print(
        f"{_count(len(free), 'result')} ({total}) that nothing keeps: myofilm store gc --unreachable"
    )


def _told(store: Store, planned: Plan, limits: Limits, now: float) -> list[str]:
    """Lines about what would be removed."""
    uses = store.upkeep.last_uses()
    lines: list[str] = []
    if planned.removals:
        table = [("STAGE", "KEY", "SIZE", "COMPUTED IN", "LAST USE", "WHY")]
        for removal in planned.removals[:LINES]:
            row, idle = removal.row, ago(now - last_use(removal.row, uses))
            seconds = duration(row.seconds)
            table.append(
                (row.ref.stage, row.ref.key[:SHORT], size(row.size), seconds, idle, removal.why)
            )
        lines += aligned(table)
        lines += _more(len(planned.removals))
    if planned.leftovers:
        lines.append("left over:")
        rows = [
            (each.key[:SHORT], size(each.size), f"{ago(now - each.changed)} ago", why)
            for each, why in planned.leftovers[:LINES]
        ]
        lines += aligned(rows, indent="  ")
        lines += _more(len(planned.leftovers))
    total = sum(row.size for row in planned.rows)
    goes = planned.removals or planned.leftovers or planned.ended
    lines.append(
        f"nothing would go; all results are {size(total)}"
        if not goes
        else f"{_count(len(planned.removals), 'result')} (computed in {duration(planned.seconds)}) and "
        f"{_count(len(planned.leftovers), 'leftover')} would go: {size(planned.size)}; "
        f"all results are {size(total)}"
    )
    lines += _too_large(planned, limits)
    if limits == Limits():
        lines.append(
            "say which results should go: --older-than 30d, --max-size 10GB, --unreachable"
        )
    if goes:
        lines.append("nothing was removed yet; the same command with --yes does it")
    return lines


def _too_large(planned: Plan, limits: Limits) -> Iterator[str]:
    """A line if the store is too large even so."""
    left = sum(row.size for row in planned.rows) - sum(r.row.size for r in planned.removals)
    if limits.size is not None and left > limits.size:
        yield (
            f"{size(left)} of results stay, more than {size(limits.size)}: runs and tags keep them; "
            "see myofilm store runs"
        )


def _more(count: int) -> list[str]:
    return [f"  and {count - LINES} more"] if count > LINES else []


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"
