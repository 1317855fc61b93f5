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


def test_a_run_that_computes_nothing_needs_no_heavy_library(desk: Desk) -> None:
    desk.run("out")
    where = ("--config", desk.config, "--store", desk.store, "--out", desk.folder / "out")
    assert not imported("run", "planar-waves", *where) & (LIGHT | NUMERICS)
