"""What two workers gain over one process, and what a sweep costs where there is hardly anything to compute.

    python benchmarks/sweep_throughput.py [--workers N] [--cases N] [--rounds N] [--tiny N]

The first table computes independent cases of electrophysiology, no two alike, in this process and on
workers, in turns; all have compiled what they need before. The second one computes tiny geometries
likewise: their time is that of the engine, the store and the scheduler. Other load on the machine slows
workers more than one process: compare the best rounds, and look at the processor time per case, of this
process and its workers together, from which follows the ratio that idle cores would give.
"""

from __future__ import annotations

import argparse
import itertools
import tempfile
import time
from collections.abc import Iterator

import psutil

from pipeline.executors import Executor
from pipeline.executors.opening import opened
from pipeline.scheduling.cases import Case, CaseDone
from pipeline.store import LocalStore
from pipeline.store.labels import process_label
from pipeline.sweep import sweep
from workflows.request import Request

SMALL = (
    "electrophysiology.elements=[30, 18]",
    "electrophysiology.n_steps=40000",
    "electrophysiology.output_interval=4",
)
"""Some seconds of work for each case."""


def waves() -> Iterator[Case]:
    """Cases of electrophysiology, each with a conductivity of its own."""
    for number in itertools.count():
        conductivity = f"electrophysiology.conductivity={0.002 + 1e-6 * number}"
        request = Request.read("planar-waves", None, [*SMALL, conductivity])
        nodes = request.nodes("electrophysiology")
        yield Case(f"wave {number}", {"electrophysiology": nodes["electrophysiology"]})


def geometries() -> Iterator[Case]:
    """Cases of geometry alone."""
    for number in itertools.count():
        request = Request.read("planar-waves", None, [f"geometry.length={3.5 + 1e-4 * number}"])
        yield Case(f"film {number}", request.nodes("geometry"))


def cost(
    cases: Iterator[Case], count: int, store: LocalStore, executor: Executor | None
) -> tuple[float, float]:
    """Time and processor time per case, of so many cases that are planned before."""
    planned = list(itertools.islice(cases, count))
    began, used = time.perf_counter(), processor_seconds()
    for result in sweep(planned, store, executor):
        assert isinstance(result, CaseDone), result
    return (time.perf_counter() - began) / count, (processor_seconds() - used) / count


def processor_seconds() -> float:
    """Processor time of this process and of those that it has started."""
    this = psutil.Process()
    times = [process.cpu_times() for process in (this, *this.children(recursive=True))]
    return sum(each.user + each.system for each in times)


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--cases", type=int, default=8, help="of electrophysiology in each round")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--tiny", type=int, default=1000, help="geometries")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        store = LocalStore(folder)
        began = time.perf_counter()
        with opened(asked.workers, None, store, process_label()) as executor:
            print(f"starting {asked.workers} workers: {time.perf_counter() - began:.2f} s")
            cases, films = waves(), geometries()
            cost(cases, 1, store, None)
            cost(cases, 2 * asked.workers, store, executor)
            print("                    this process      workers   ratio   on idle cores")
            for number in range(asked.rounds):
                tell(f"round {number + 1}", cases, asked.cases, store, executor, asked.workers)
            tell("tiny cases", films, asked.tiny, store, executor, asked.workers)


def tell(
    title: str,
    cases: Iterator[Case],
    count: int,
    store: LocalStore,
    executor: Executor,
    workers: int,
) -> None:
    """One line: so many cases here, then so many on workers."""
    here, used_here = cost(cases, count, store, None)
    there, used_there = cost(cases, count, store, executor)
    ideal = workers * used_here / used_there
    print(
        f"{title:19} {1e3 * here:9.1f} ms {1e3 * there:9.1f} ms {here / there:7.2f} {ideal:15.2f}"
    )


if __name__ == "__main__":
    main()
