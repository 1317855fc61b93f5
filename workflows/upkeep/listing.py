"""What ``store ls`` and ``store runs`` tell."""

from __future__ import annotations

import time
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from pipeline.errors import InputError
from pipeline.keys import Ref
from pipeline.store import Store
from pipeline.store.catalogue import Row
from pipeline.store.cleaning import last_use, reachable, worth
from pipeline.store.collection import kept
from pipeline.store.labels import RegisteredRun, runs_called
from workflows.progress import duration, size
from workflows.request import open_store
from workflows.tables import aligned
from workflows.upkeep.amounts import ago, seconds_of
from workflows.upkeep.names import SHORT

ORDERS = ("stage", "size", "age", "use", "worth")
"""Orders of the list; all but the first begin with what one may want to remove."""


@dataclass(frozen=True)
class Choice:
    """Which artefacts to list, all conditions together.

    Attributes
    ----------
    stage
        Only of this stage.
    run
        Only what a run of this name, or into this folder, used.
    tag
        Only with this tag.
    unused_for
        Only what was not used for such a time, as ``"30d"``.
    unreachable
        Only what no run and no tag keeps.
    """

    stage: str | None = None
    run: str | None = None
    tag: str | None = None
    unused_for: str | None = None
    unreachable: bool = False


def list_artefacts(location: str | None, choice: Choice, order: str = "stage") -> None:
    """One line for each result kept: stage, key, size, cost, age, last use, tags.

    Raises
    ------
    InputError
        If there is no such stage, run, tag or order, or the time is none.
    """
    if order not in ORDERS:
        raise InputError(f"there is no order {order!r}; choose one of {', '.join(ORDERS)}")
    store, now = open_store(location), time.time()
    rows, uses, tags = store.upkeep.rows(), store.upkeep.last_uses(), store.upkeep.tags()
    chosen = _chosen(store, rows, uses, tags, choice, now)
    if not chosen:
        print(f"{store.location} holds no {'such ' if rows else ''}results")
        return
    keys = {
        "size": lambda row: -row.size,
        "age": lambda row: row.finished,
        "use": lambda row: last_use(row, uses),
        "worth": worth,
    }
    if order in keys:
        chosen.sort(key=keys[order])
    table: list[Sequence[str]] = [
        ("STAGE", "KEY", "SIZE", "COMPUTED IN", "AGE", "LAST USE", "TAGS")
    ]
    table += [_line(row, uses, tags.get(row.ref, ()), now) for row in chosen]
    for line in aligned(table):
        print(line)
    total = size(sum(row.size for row in chosen))
    print(f"{len(chosen)} results, {total} in {store.location}")


def list_runs(location: str | None) -> None:
    """One line for each run: its name, what it ran, what it keeps and why."""
    store, now = open_store(location), time.time()
    runs = sorted(store.upkeep.runs(), key=lambda run: run.label.began)
    if not runs:
        print(f"{store.location} knows no runs")
        return
    rows = {row.ref: row for row in store.upkeep.rows()}
    table = [("NAME", "WORKFLOW", "BEGAN", "STATE", "RESULTS", "SIZE", "KEPT")]
    for run in runs:
        used = reachable(store.upkeep.used_by(run.label), rows) & rows.keys()
        bytes_used = size(sum(rows[ref].size for ref in used))
        label = run.label
        began, count = f"{ago(now - label.began)} ago", str(len(used))
        workflow = label.workflow or "-"
        table.append((label.name, workflow, began, state(run), count, bytes_used, why(run, now)))
    for line in aligned(table):
        print(line)


def state(run: RegisteredRun) -> str:
    """Whether a run goes on, ended well, or was cut short."""
    if run.alive:
        return "running"
    return "finished" if run.finished is not None else "unfinished"


def why(run: RegisteredRun, now: float) -> str:
    """Why a run keeps its results, or that it does not."""
    if run.label.named:
        return "by its name"
    if run.alive:
        return "while it runs"
    return "by its folder" if run.keeps(now) else "no longer"


def _chosen(
    store: Store,
    rows: Sequence[Row],
    uses: Mapping[Ref, float],
    tags: Mapping[Ref, Collection[str]],
    choice: Choice,
    now: float,
) -> list[Row]:
    """Rows that meet all conditions."""
    found = list(rows)
    if choice.stage is not None and rows:
        _check("kept result of a stage", choice.stage, {row.ref.stage for row in rows})
        found = [row for row in found if row.ref.stage == choice.stage]
    if choice.tag is not None:
        _check("tag", choice.tag, {tag for each in tags.values() for tag in each})
        found = [row for row in found if choice.tag in tags.get(row.ref, ())]
    if choice.run is not None:
        runs = runs_called(store.upkeep.runs(), choice.run)
        used = {ref for run in runs for ref in store.upkeep.used_by(run.label)}
        reached = reachable(used, {row.ref: row for row in rows})
        found = [row for row in found if row.ref in reached]
    if choice.unused_for is not None:
        since = now - seconds_of(choice.unused_for)
        found = [row for row in found if last_use(row, uses) < since]
    if choice.unreachable:
        reached = kept(store, rows, now)
        found = [row for row in found if row.ref not in reached]
    return found


def _check(kind: str, name: str, known: Collection[str]) -> None:
    if name not in known:
        from workflows.registry import unknown

        raise unknown(kind, name, sorted(known) or ["none"])


def _line(
    row: Row, uses: Mapping[Ref, float], tags: Collection[str], now: float
) -> tuple[str, ...]:
    name = (row.ref.stage, row.ref.key[:SHORT])
    if row.problem:
        return (*name, "-", "-", "-", "-", f"damaged: {row.problem}")
    age, used = ago(now - row.finished), uses.get(row.ref)
    idle = "-" if used is None else ago(now - used)
    return (*name, size(row.size), duration(row.seconds), age, idle, ", ".join(tags))
