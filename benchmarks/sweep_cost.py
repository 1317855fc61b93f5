"""What a study of many cases costs besides its computations: a simulation in which nothing is computed.

    python benchmarks/sweep_cost.py [--cases N]

Cases of planar waves, each conductivity with a hundred dampings, are planned, keyed, looked up and scheduled
as ever, by an executor that hands back made-up results at once and a store that holds nothing. Printed
are calls, bytes and time per case of the client; and, by one real case that is kept on disk, what a
case leaves there.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import pickle
import resource
import tempfile
import time
from collections import Counter, deque
from collections.abc import Callable, Hashable, Iterator
from pathlib import Path
from typing import Any

from pipeline.computing.obtaining import Obtained, obtain
from pipeline.executors.protocol import Completion, Hear
from pipeline.keys import Ref
from pipeline.manifest import Manifest
from pipeline.records import parts_of
from pipeline.runner import run
from pipeline.scheduling.cases import Case
from pipeline.store import LocalStore
from pipeline.sweep import sweep
from pipeline.task import Task
from workflows.request import Request
from workflows.sweep.asked import Asked
from workflows.sweep.study import Study

DAMPINGS = 100

QUICK = (
    "electrophysiology.elements=[30, 18]",
    "electrophysiology.n_steps=40000",
    "mechanics.elements=[8, 3]",
    "mechanics.n_steps=400",
)
"""A real case in seconds; the number of its files is that of any case."""

counted: Counter[str] = Counter()


class EmptyStore(LocalStore):
    """Holds nothing and counts what it is asked."""

    def find(self, ref: Ref, *arguments: Any, **named: Any) -> Manifest | None:
        """Nothing is there."""
        counted["store look-ups"] += 1
        return None

    def newest(self, stage: str, count: int) -> list[Ref]:
        """Would list the folder of a stage."""
        counted["store listings"] += 1
        return []

    def refs(self, stage: str | None = None) -> Iterator[Ref]:
        """Would list the folder of a stage."""
        counted["store listings"] += 1
        return iter(())


class Pretending:
    """Ends every job at once, with results that are made up from their keys."""

    slots = 1000
    in_process = False

    def __init__(self) -> None:
        self._ended: deque[Completion] = deque()

    def submit(self, tag: Hashable, function: Callable[..., Any], *arguments: Any) -> None:
        """Count, and make up how it ended."""
        value = _made_up(arguments[0]) if function is obtain else {}
        there, back = pickle.dumps((function, arguments)), pickle.dumps(value)
        counted["jobs"] += 1
        counted["bytes to workers"] += len(there)
        counted["bytes back"] += len(back)
        self._ended.append(Completion(tag, value))

    def next(self, hear: Hear, timeout: float | None = None) -> Completion | None:
        """The oldest."""
        return self._ended.popleft() if self._ended else None

    def stop(self) -> None:
        """Nothing runs."""

    def close(self) -> None:
        """Nothing is held."""


def _made_up(task: Task) -> Obtained:
    content = hashlib.blake2b(task.key.encode(), digest_size=20).hexdigest()
    parts = dict.fromkeys(parts_of(task.stage.signature.record), content)
    return Obtained(task.stage.name, task.key, False, content, parts, 60.0, 10**7)


def cases(count: int) -> Iterator[Case]:
    """Planned as the command ``sweep`` plans them."""
    rows = max(1, count // DAMPINGS)
    over = (
        f"electrophysiology.conductivity=0.001:0.003:#{max(2, rows)}",
        f"mechanics.damping=0.1:0.9:#{DAMPINGS}",
    )
    study = Study.read("planar-waves", None, (), Asked(over=over))
    for case, _ in zip(study.design, range(count), strict=False):
        yield Case(case.name, study.nodes(case), case)


def finish(about: Any, outcomes: Any) -> dict[str, Any]:
    """Stands for reading the quantities."""
    return {}


def simulate(count: int) -> None:
    """Print what the client does for so many cases."""
    with tempfile.TemporaryDirectory() as folder:
        began, done = time.perf_counter(), 0
        for _ in sweep(cases(count), EmptyStore(folder), Pretending(), finish=finish):
            done += 1
            if done == count // 10:
                early = _memory()
        seconds = time.perf_counter() - began
    print(f"{done} cases: {seconds:.0f} s of the client, {1e3 * seconds / done:.2f} ms per case")
    print(f"memory after a tenth of them {early:.0f} MB, after all {_memory():.0f} MB")
    for name, number in sorted(counted.items()):
        print(f"{name:20} {number:12}   {number / done:10.3f} per case")


def real_case() -> None:
    """Print what one case leaves in a store on disk."""
    with tempfile.TemporaryDirectory() as folder:
        run(Request.read("planar-waves", None, QUICK).nodes(), LocalStore(folder))
        print("\nleft in the store by one case")
        for place in (*sorted(Path(folder, "objects").iterdir()), Path(folder)):
            found = list(place.rglob("*"))
            files = [path for path in found if path.is_file()]
            size = sum(path.stat().st_size for path in files) / 1e6
            name = "everything" if place == Path(folder) else place.name
            folders = len(found) - len(files)
            print(f"{name:20} {len(files):4} files, {folders:4} folders, {size:8.2f} MB")


def _memory() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3


def main() -> None:
    """Print both."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--cases", type=int, default=10_000)
    with contextlib.suppress(BrokenPipeError):
        simulate(parser.parse_args().cases)
        real_case()


if __name__ == "__main__":
    main()
