"""Study: kill real workflow runs, look into the store, and let the next run complete.

    python -m tests.faults.crashes --kills 200

Each trial has a store of its own. A run in it is killed at a random moment of a chosen stage, or just
before or after a chosen operation on a file of the store, or in the middle of a write; a third of
the runs that go on are killed once more. After each kill ``store verify`` must find every artefact whole, and nothing may be in
the store that is neither an artefact nor work that the next run takes up. The run that completes must
leave the same bytes as one that was never disturbed.
"""

from __future__ import annotations

import argparse
import collections
import contextlib
import fcntl
import io
import json
import os
import random
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pipeline.manifest import hash_files
from pipeline.nodes import Node
from pipeline.store import LocalStore
from tests.faults.operations import Fault, Operation, kill_after, kill_before, kill_within
from tests.faults.victims import Ending, Victim
from tests.faults.workloads import WORKLOADS, nodes_of
from workflows.upkeep.checking import verify_artefacts

WAYS = ("moment", "before", "after", "within")
CRITICAL = {
    *((what, verb) for what in ("chunk", "table", "checkpoint") for verb in ("open", "rename")),
    ("manifest", "open"),
    ("artefact", "rename"),
    ("checkpoint", "remove"),
}
"""What is written and renamed, file by file, until a result is published."""

INTERVALS = (0.0, 0.01, 0.05)
"""Seconds between checkpoints: these workflows take half a second, not the usual minutes."""


@dataclass(frozen=True)
class Workload:
    """A workflow with what an undisturbed run of it leaves and does."""

    name: str
    nodes: Mapping[str, Node[Any]]
    result: Mapping[str, Any]
    operations: Sequence[Operation]
    seconds: float

    @property
    def stages(self) -> list[str]:
        """Its stages in order."""
        return list(dict.fromkeys(op.stage for op in self.operations if op.stage != "start"))


def prepare(name: str, folder: Path) -> Workload:
    """Run a workflow twice: here, which compiles its kernels, and in a child, which is traced."""
    from pipeline.runner import run

    nodes = nodes_of(name)
    run(nodes, LocalStore(folder / f"{name}-first"))
    store, trace = folder / f"{name}-unbroken", folder / f"{name}.trace"
    ending = Victim(nodes, store, 0.0, trace=trace).wait()
    assert not ending.error, ending.error
    result = contents(store)
    assert result == contents(folder / f"{name}-first"), (
        f"{name} does not give the same bytes twice"
    )
    operations = []
    for line in trace.read_text().splitlines():
        stage, what, verb, count = line.split("\t")
        operations.append(Operation(stage, what, verb, int(count)))
    return Workload(name, nodes, result, operations, ending.seconds)


def contents(store: Path) -> dict[str, Any]:
    """Files of all artefacts, with their checksums."""
    kept = LocalStore(store)
    return {str(ref): hash_files(kept.data(ref)) for ref in kept.refs()}


def problems_after_a_kill(store: Path) -> Iterator[str]:
    """What must not be in a store, in words."""
    if not store.exists():
        return
    told = io.StringIO()
    with contextlib.redirect_stdout(told):
        try:
            verify_artefacts([], str(store))
        except Exception as error:
            yield f"store verify: {error} {told.getvalue()}"
    kept = LocalStore(store)
    keys = {ref.key for ref in kept.refs()}
    for folder in (store / "tmp").glob("*"):
        if folder.name in keys:
            yield f"{folder} is left though its result is published"
    for lock in (store / "locks").glob("*"):
        with open(lock, "rb") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                yield f"{lock} is held by a dead process"
    for leftover in kept.upkeep.leftovers():
        if leftover.busy:
            yield f"{leftover.name} is called busy, and its process is dead"


def problems_at_the_end(store: Path, workload: Workload, ending: Ending) -> Iterator[str]:
    """What differs from an undisturbed run, in words."""
    if ending.error or ending.killed:
        yield f"the next run did not complete: {ending.error or ending.place}"
        return
    if contents(store) != workload.result:
        yield "the artefacts are not those of an unbroken run"
    yield from problems_after_a_kill(store)
    yield from (f"{path} is left" for path in (store / "tmp").glob("*"))
    for path in (store / "checkpoints").glob("*"):
        # A kill between the rename that publishes and the removal of the checkpoint leaves it.
        if not any(key.endswith(path.name) for key in workload.result):
            yield f"{path} is left"


@dataclass
class Trial:
    """What was done to one store, and what came of it."""

    workload: str
    way: str
    stage: str
    kills: list[str]
    problems: list[str]
    resumed: dict[str, int]
    again: bool = False


def plan_kill(
    workload: Workload, way: str, stage: str, chance: random.Random
) -> tuple[Fault | None, Operation | None]:
    """A fault for a child, and the operation at which it happens."""
    if way == "moment":
        return None, None
    mine = [op for op in workload.operations if op.stage == stage]
    if way == "within":
        mine = [op for op in mine if op.verb == "open" and op.what != "lock"]
    kinds = sorted({(op.what, op.verb) for op in mine})
    # Each kind of operation is as likely as any other, but those that write results are more so.
    kind = chance.choice([k for k in kinds for _ in range(4 if k in CRITICAL else 1)])
    operation = chance.choice([op for op in mine if (op.what, op.verb) == kind])
    if way == "within":
        return kill_within(operation, int(2 ** chance.uniform(0.0, 12.0))), operation
    return (kill_before if way == "before" else kill_after)(operation), operation


def attempt(workload: Workload, way: str, stage: str, store: Path, chance: random.Random) -> Ending:
    """Run a workflow in a store that is killed on the way, if it gets there."""
    fault, _ = plan_kill(workload, way, stage, chance)
    # Named operations are those of a trace in which every step was saved.
    interval = 0.0 if way != "moment" else chance.choice(INTERVALS)
    victim = Victim(workload.nodes, store, interval, fault)
    if way == "moment":
        victim.kill_in(stage, chance.uniform(0.0, 1.5 * workload.seconds / len(workload.stages)))
    return victim.wait()


def trial(workload: Workload, way: str, stage: str, store: Path, chance: random.Random) -> Trial:
    """Kill, look, perhaps kill again, complete, compare."""
    done = Trial(workload.name, way, stage, [], [], {})
    while True:
        ending = attempt(workload, way, stage, store, chance)
        done.problems.extend(spoilt(ending))
        if not ending.killed:
            if ending.error:
                done.problems.append(ending.error)
            break  # it was through before
        done.kills.append(f"{way} {ending.place}")
        done.resumed |= ending.resumed
        done.problems.extend(problems_after_a_kill(store))
        if chance.random() > 1 / 3:
            break
    ending = Victim(workload.nodes, store, chance.choice(INTERVALS)).wait()
    done.resumed |= ending.resumed
    done.problems.extend(spoilt(ending))
    done.problems.extend(problems_at_the_end(store, workload, ending))
    return done


def spoilt(ending: Ending) -> list[str]:
    """Checkpoints that a run could not go on from: a kill may cost one, but never half of one."""
    return [warning for warning in ending.warnings if "checkpoint" in warning]


def study(
    kills: int, seed: int, names: Sequence[str], folder: Path, out: Any = sys.stderr
) -> dict[str, Any]:
    """Trials over all workflows, stages and ways until so many runs were killed; a summary."""
    began = time.perf_counter()
    workloads = [prepare(name, folder) for name in names]
    chance = random.Random(seed)
    cells = [(w, stage, way) for w in workloads for stage in w.stages for way in WAYS]
    chance.shuffle(cells)
    trials: list[Trial] = []
    while sum(len(one.kills) for one in trials) < kills:
        workload, stage, way = cells[len(trials) % len(cells)]
        store = folder / f"trial{len(trials)}"
        trials.append(trial(workload, way, stage, store, chance))
        if trials[-1].problems:
            print(f"{store}: {trials[-1]}", file=out)
        else:
            shutil.rmtree(store, ignore_errors=True)
    return summary(trials, time.perf_counter() - began)


def summary(trials: Sequence[Trial], seconds: float) -> dict[str, Any]:
    """Counts of all that happened."""
    places = [place for one in trials for place in one.kills]
    ways, stages, named = (collections.Counter[str]() for _ in range(3))
    for place in places:
        way, _, rest = place.partition(" ")
        stage, _, operation = rest.partition(": ")
        ways[way] += 1
        stages[stage] += 1
        named[operation.rpartition(" ")[0] if way != "moment" else "at any moment"] += 1
    return {
        "kills": len(places),
        "trials": len(trials),
        "killed_more_than_once": sum(len(one.kills) > 1 for one in trials),
        "went_on_from_a_checkpoint": sum(bool(one.resumed) for one in trials),
        "resumed_stages": dict(collections.Counter(s for one in trials for s in one.resumed)),
        "ways": dict(ways.most_common()),
        "stages": dict(stages.most_common()),
        "operations": dict(named.most_common()),
        "problems": [problem for one in trials for problem in one.problems],
        "seconds": round(seconds, 1),
    }


def main() -> None:
    """Print the summary as JSON; exit code 1 if anything was wrong."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workflow", action="append", choices=WORKLOADS)
    parser.add_argument("--folder", type=Path, help="where the stores are made")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=given.folder, prefix="crashes-") as folder:
        found = study(given.kills, given.seed, given.workflow or list(WORKLOADS), Path(folder))
    print(json.dumps(found, indent=1))
    sys.stdout.flush()
    os._exit(1 if found["problems"] else 0)


if __name__ == "__main__":
    main()
