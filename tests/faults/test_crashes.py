"""Runs that are killed leave nothing half-published, and the next one completes with the same bytes.

The whole study, 200 kills over three workflows, is ``python -m tests.faults.crashes`` or the slow test.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]


def study(folder: Path, *arguments: str) -> dict[str, Any]:
    """Summary of the study, run in a process of its own, from which others can be forked safely."""
    command = [sys.executable, "-m", "tests.faults.crashes", "--folder", str(folder), *arguments]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.stdout, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    assert found["problems"] == [], done.stderr
    return found


def test_twenty_killed_runs_leave_a_sound_store_and_complete(tmp_path: Path) -> None:
    found = study(tmp_path, "--kills", "20", "--workflow", "planar-waves")
    assert found["kills"] >= 20
    assert found["went_on_from_a_checkpoint"] > 0


@pytest.mark.slow
def test_two_hundred_killed_runs_of_all_stages_leave_a_sound_store_and_complete(
    tmp_path: Path,
) -> None:
    found = study(tmp_path, "--kills", "200")
    assert found["kills"] >= 200
    assert found["stages"].keys() >= {
        "geometry",
        "electrophysiology",
        "activation",
        "mechanics",
        "postprocessing",
    }
    assert found["operations"].keys() >= {
        "chunk rename",
        "checkpoint open",
        "manifest open",
        "artefact rename",
    }
