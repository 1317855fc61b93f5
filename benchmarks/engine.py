"""What the engine costs when there is nothing to compute: whole processes, and the working out of keys.

    python benchmarks/engine.py [--store DIR] [--rounds N]

The first table times whole commands, a paper-scale run that is in the store among them (it is computed
first if it is not, in about a minute). "others" is the time that a bare Python needs to load the libraries
of others that the command loads; the rest is ours. The second table times keys and fingerprints in
one process. Timings are noisy, so rounds are interleaved and the best of each is kept: compare the
ratios of one call, not the seconds of two.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

OURS = {"pipeline", "stages", "workflows", "__main__", "__mp_main__"}

LOADED = """
import sys
before = set(sys.modules)
from workflows.cli import app
try:
    app(sys.argv[1:], prog_name="myofilm")
except SystemExit:
    pass
print(*(name for name in sys.modules if name not in before), file=sys.stderr)
"""

LOAD = """
import importlib, sys
for name in sys.argv[1:]:
    try:
        importlib.import_module(name)
    except ImportError:
        pass
"""


def seconds(command: list[str]) -> float:
    """CPU time of a process, which on an idle machine is its wall time: nothing here waits."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, capture_output=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        raise SystemExit(f"{' '.join(command)} failed:\n{done.stderr.decode()}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def libraries(arguments: list[str]) -> list[str]:
    """Modules of others that a command loads, in the order in which it does."""
    done = subprocess.run(
        [sys.executable, "-c", LOADED, *arguments], capture_output=True, text=True, check=True
    )
    names = done.stderr.splitlines()[-1].split()
    return [name for name in names if name.partition(".")[0] not in OURS]


def processes(store: Path, out: Path, rounds: int) -> None:
    """Print the table of whole commands."""
    run = ["run", "planar-waves", "--store", str(store), "--out", str(out), "--quiet"]
    cases = {
        "--help": ["--help"],
        "list": ["list"],
        "show planar-waves": ["show", "planar-waves"],
        "explain planar-waves": ["explain", "planar-waves", "--store", str(store)],
        "run, all in the store": run,
    }
    print("computing a paper-scale run unless it is in the store ...", flush=True)
    seconds([sys.executable, "-m", "workflows.cli", *run])
    others = {name: libraries(arguments) for name, arguments in cases.items()}
    best: dict[str, float] = {}

    def take(name: str, command: list[str]) -> None:
        best[name] = min(best.get(name, 1e9), seconds(command))

    for _ in range(rounds):
        take("python", [sys.executable, "-c", "pass"])
        for name, arguments in cases.items():
            take(name, [sys.executable, "-m", "workflows.cli", *arguments])
            take(f"others of {name}", [sys.executable, "-c", LOAD, *others[name]])
    print(f"\n{'whole process':24}{'CPU s':>9}{'/ python':>10}{'others':>9}{'ours':>8}")
    print(f"{'bare python':24}{best['python']:9.3f}{1:10.1f}")
    for name in cases:
        theirs = best[f"others of {name}"]
        share = max(best[name] - theirs, 0.0) / best[name]
        ratio = best[name] / best["python"]
        print(f"{name:24}{best[name]:9.3f}{ratio:10.1f}{theirs:9.3f}{share:8.0%}")


def keys(rounds: int) -> None:
    """Print the table of what planning takes."""
    from pipeline.canonical import canonical
    from pipeline.fingerprint.sources import Sources
    from pipeline.fingerprint.syntax import parsed
    from pipeline.keys import code_of, statement
    from pipeline.nodes import in_order
    from workflows.request import Request

    nodes = [node for _, node in in_order(Request.read("planar-waves").nodes())]
    shared = Sources()
    codes = {id(node): code_of(node.stage.module, node.config, shared) for node in nodes}
    modules = {name for code in codes.values() for name in (*code.modules, *code.bare)}
    files = [Path(file) for name in modules if (file := shared.locate(name)) is not None]

    def parse() -> None:
        for file in files:
            parsed(file.read_bytes(), "")

    def fingerprints() -> None:
        sources = Sources()
        for node in nodes:
            code_of(node.stage.module, node.config, sources)

    def known() -> None:
        for node in nodes:
            code_of(node.stage.module, node.config, shared)

    def forms() -> None:
        for node in nodes:
            canonical(node.config)

    def statements() -> None:
        for node in nodes:
            assert statement(node.stage.name, node.config, codes[id(node)], {}).key

    rows: dict[str, Callable[[], None]] = {
        f"parsing {len(files)} source files": parse,
        "fingerprints, files read": fingerprints,
        "fingerprints, files known": known,
        "canonical forms": forms,
        "keys": statements,
    }
    best = dict.fromkeys(rows, 1e9)
    for _ in range(rounds):
        for name, work in rows.items():
            start = time.perf_counter()
            work()
            best[name] = min(best[name], time.perf_counter() - start)
    unit = best["keys"]
    print(f"\n{'five stages, in a process':32}{'ms':>8}{'/ keys':>10}")
    for name, best_seconds in best.items():
        print(f"{name:32}{1e3 * best_seconds:8.2f}{best_seconds / unit:10.1f}")


def main() -> None:
    """Both tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--store", type=Path, help="store to use; default: a temporary one")
    parser.add_argument("--rounds", type=int, default=7)
    options = parser.parse_args()
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    with tempfile.TemporaryDirectory() as folder:
        processes(options.store or Path(folder, "store"), Path(folder, "out"), options.rounds)
    keys(options.rounds)


if __name__ == "__main__":
    main()
