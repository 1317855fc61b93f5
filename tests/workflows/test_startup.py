"""Commands import no more than they need: heavy libraries cost a second and more."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from pipeline.store import LocalStore
from pipeline.testing.stores import example, publish
from tests.workflows.conftest import Desk

ROOT = Path(__file__).parents[2]

PROBE = """
import sys
from workflows.cli import app
try:
    app(sys.argv[1:], prog_name="myofilm")
except SystemExit as end:
    assert not end.code, end.code
finally:
    print(*sorted({name.partition(".")[0] for name in sys.modules}), file=sys.stderr)
"""

LIGHT = {"numba", "zarr", "h5py", "matplotlib", "pandas", "jinja2", "pint", "dask", "xarray"}
"""Not for reading, checking and telling."""

NUMERICS = {"numpy", "scipy"}


def imported(*arguments: object) -> set[str]:
    """Top-level modules that a command has imported when it ends."""
    done = subprocess.run(
        [sys.executable, "-c", PROBE, *map(str, arguments)],
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return set(done.stderr.splitlines()[-1].split())


def test_help_needs_nothing_but_typer() -> None:
    heavy = LIGHT | NUMERICS | {"rich", "pipeline", "stages", "platformdirs"}
    assert not imported("--help") & (heavy | {"pydantic"})
    assert not imported("run", "--help") & heavy  # typer itself may look at pydantic here


@pytest.mark.parametrize(
    "command",
    [
        ["list"],
        ["show", "planar-waves"],
        ["show", "spiral-wave"],
        ["show", "restitution"],
        ["show", "vulnerable-window"],
        ["show", "curling"],
        ["show", "twitch"],
        ["reproduce"],
        ["verification"],
        ["show", "verification"],
    ],
)
def test_reading_commands_need_no_numerics(command: list[str]) -> None:
    assert not imported(*command) & (LIGHT | NUMERICS)


@pytest.mark.parametrize("command", [["ls"], ["runs"], ["gc", "--unreachable"], ["verify"]])
def test_looking_after_the_store_needs_no_numerics(command: list[str], tmp_path: Path) -> None:
    publish(LocalStore(tmp_path), example())
    assert not imported("store", *command, "--store", tmp_path) & (LIGHT | NUMERICS)


def test_a_store_below_a_url_needs_its_driver_and_no_numerics(tmp_path: Path) -> None:
    heavy = LIGHT | NUMERICS
    assert not imported("store", "ls", "--store", tmp_path) & {"fsspec", "s3fs"}
    assert not imported("store", "ls", "--store", "memory://here") & (heavy | {"s3fs"})


@pytest.mark.parametrize(
    "workflow",
    [
        "planar-waves",
        "spiral-wave",
        "restitution",
        "vulnerable-window",
        "curling",
        "twitch",
        "verification",
    ],
)
def test_explaining_needs_no_heavy_library(workflow: str, tmp_path: Path) -> None:
    assert not imported("explain", workflow, "--store", tmp_path) & (LIGHT | NUMERICS)


def test_planning_a_sweep_needs_no_heavy_library(tmp_path: Path) -> None:
    over = ("--over", "mechanics.damping=0.2,0.4", "--over", "geometry.fibre_angle=0:90:15")
    command = ("sweep", "planar-waves", *over, "--store", tmp_path, "--dry-run")
    assert not imported(*command) & (LIGHT | NUMERICS)


def test_a_run_that_computes_nothing_needs_no_heavy_library(desk: Desk) -> None:
    desk.run("out")
    where = ("--config", desk.config, "--store", desk.store, "--out", desk.folder / "out")
    assert not imported("run", "planar-waves", *where) & (LIGHT | NUMERICS)


def test_garbage_is_collected_from_when_a_store_is_opened(tmp_path: Path) -> None:
    code = f"""
import gc
from workflows.request import open_store
from workflows.startup import start
start()
assert not gc.isenabled()
open_store({str(tmp_path)!r})
assert gc.isenabled()
gc.disable()  # whoever wants that in a program of their own
open_store({str(tmp_path)!r})
assert not gc.isenabled()
"""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    subprocess.run([sys.executable, "-c", code], env=environment, check=True)


COUNTING = """
import collections, os, sys
opened = collections.Counter()
def note(event, arguments):
    if event == "open" and isinstance(arguments[0], str):
        opened[os.path.abspath(arguments[0])] += 1
sys.addaudithook(note)
import pipeline.fingerprint.sources
parsed = pipeline.fingerprint.sources.parsed
def counted(contents, package):
    opened["<parsed>"] += 1
    return parsed(contents, package)
pipeline.fingerprint.sources.parsed = counted
from workflows.cli import app
try:
    app(sys.argv[1:], prog_name="myofilm")
except SystemExit as end:
    assert not end.code, end.code
finally:
    print(*(f"{count} {name}" for name, count in opened.items()), sep="\\n", file=sys.stderr)
"""


def opened(cache: Path, *arguments: object) -> dict[str, int]:
    """How often a command opens each file; ``<parsed>`` counts the source files that it parses."""
    done = subprocess.run(
        [sys.executable, "-c", COUNTING, *map(str, arguments)],
        env=os.environ | {"PYTHONPATH": str(ROOT), "XDG_CACHE_HOME": str(cache)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    counts = (line.partition(" ") for line in done.stderr.splitlines())
    return {name: int(count) for count, _, name in counts if count.isdigit()}


@pytest.mark.parametrize("command", ["explain", "run"])
def test_what_was_computed_is_found_by_manifests_and_known_sources_alone(
    desk: Desk, command: str
) -> None:
    out = desk.folder / "out"
    desk.run("out")
    where = ["--config", desk.config, "--store", desk.store]
    if command == "run":
        where += ["--out", out]
    cache = desk.folder / "cache"
    opened(cache, command, "planar-waves", *where)
    files = {p: p.stat().st_mtime_ns for p in out.iterdir()}
    counts = opened(cache, command, "planar-waves", *where)
    # Every source file was parsed before, by whatever process; each is read once as it is loaded (and
    # by Python, where it keeps no bytecode), once for all keys, and once for all that is exported, and
    # never parsed.
    assert counts.pop("<parsed>", 0) == 0
    sources = {n: c for n, c in counts.items() if n.startswith(str(ROOT)) and n.endswith(".py")}
    assert len(sources) > 100
    assert max(sources.values()) <= (4 if sys.dont_write_bytecode else 3)
    # The size of results does not matter: none of their data is opened.
    objects = str(desk.store / "objects")
    assert {Path(n).name for n in counts if n.startswith(objects)} == {"manifest.json"}
    # What is up to date is not written again.
    assert {p: p.stat().st_mtime_ns for p in out.iterdir()} == files
