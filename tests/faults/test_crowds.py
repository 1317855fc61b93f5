"""Several processes in one store: each key is computed once, nobody waits for the dead or is disturbed."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, Any]]:
    """What came of each scene."""
    folder = tmp_path_factory.mktemp("crowds")
    command = [sys.executable, "-m", "tests.faults.crowds", str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.stdout, done.stderr
    found: dict[str, dict[str, Any]] = json.loads(done.stdout)
    return found


def test_processes_that_want_the_same_compute_it_once(scenes: dict[str, dict[str, Any]]) -> None:
    for scene, processes in (("two with the same", 2), ("eight with the same", 8)):
        told = {"processes": processes, "artefacts": 3, "computed": 3, "problems": []}
        assert scenes[scene] == told


def test_processes_whose_wants_overlap_compute_each_artefact_once(
    scenes: dict[str, dict[str, Any]],
) -> None:
    told = {"processes": 4, "artefacts": 9, "computed": 9, "problems": []}
    assert scenes["four that overlap"] == told


def test_nobody_waits_for_a_process_that_died(scenes: dict[str, dict[str, Any]]) -> None:
    scene = scenes["four with deaths"]
    assert scene["problems"] == []
    assert scene["artefacts"] == 9
    assert scene["killed"] >= 4


def test_readers_are_not_disturbed_by_a_collector(scenes: dict[str, dict[str, Any]]) -> None:
    scene = scenes["two with a collector"]
    assert scene["problems"] == []
    assert scene["removals"] > 0
