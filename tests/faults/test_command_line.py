"""What a user sees of a damaged store, and how it is mended."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from pipeline.store import LocalStore
from tests.faults.damages import flipped
from tests.workflows.conftest import invoke

SMALL = ("--set", "mechanics.elements=[4, 2]", "--set", "mechanics.n_steps=4")


@pytest.fixture
def run(tmp_path: Path) -> tuple[object, ...]:
    """Arguments of a small run."""
    return ("run", "curling", *SMALL, "--store", tmp_path / "store", "--out", tmp_path / "out")


def test_a_damaged_result_ends_a_run_with_the_remedy_that_mends_it(
    run: tuple[object, ...], tmp_path: Path
) -> None:
    assert invoke(*run).exit_code == 0
    first = json.loads((tmp_path / "out" / "summary.json").read_text())
    store = LocalStore(tmp_path / "store")
    (ref,) = store.refs("equilibrium")
    flipped(next(store.data(ref).rglob("c.0.0")))
    # The next run finds all it needs, and would not look at this byte, but a new picture does.
    for file in (tmp_path / "out").iterdir():
        file.unlink()
    broken = invoke(*run)
    assert broken.exit_code == 1
    assert f"artefact {ref} is damaged (the checksum of " in broken.stderr
    assert "Remedy: run the same command with --recompute-damaged" in broken.stderr
    mended = invoke(*run, "--recompute-damaged")
    assert mended.exit_code == 0
    assert "the stored result was damaged" in mended.output
    assert store.verify(ref, full=True) == ()
    again = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert again["quantities"] == first["quantities"]
    assert [name for name, stage in again["stages"].items() if not stage["hit"]] == ["mechanics"]


def test_a_store_of_a_newer_version_is_refused_by_its_version(
    run: tuple[object, ...], tmp_path: Path
) -> None:
    (tmp_path / "store").mkdir()
    (tmp_path / "store" / "store.json").write_text('{"version": 7}')
    result = invoke(*run)
    assert result.exit_code == 2
    assert "has layout version 7; this program knows versions up to 1: update it" in result.stderr
