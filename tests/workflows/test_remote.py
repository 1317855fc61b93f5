"""Commands on a store on S3, from two machines."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.pipeline.conftest import bucket, s3_server
from tests.workflows.conftest import Desk, invoke

__all__ = ["bucket", "s3_server"]  # fixtures


def test_a_second_machine_finds_what_the_first_has_computed(
    desk: Desk, bucket: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    where = ("--config", desk.config, "--store", f"{bucket}/lab")
    for machine, hit in (("one", False), ("other", True)):
        monkeypatch.setenv("MYOFILM_CACHE", str(tmp_path / machine))
        result = invoke("geometry", "planar-waves", *where, "--out", tmp_path / machine / "out")
        assert result.exit_code == 0, result.output
        summary = json.loads((tmp_path / machine / "out" / "summary.json").read_text())
        assert summary["stages"]["geometry"]["hit"] is hit
    listed = invoke("store", "ls", "--store", f"{bucket}/lab")
    assert listed.output.splitlines()[1].startswith("geometry ")
    assert invoke("store", "verify", "--store", f"{bucket}/lab").exit_code == 0
    told = invoke("explain", "planar-waves", *where).output
    assert told.splitlines()[0].split() == ["geometry:", "hit"]


def test_a_store_that_is_not_there_is_bad_input(desk: Desk, bucket: str) -> None:
    result = invoke(
        "run", "planar-waves", "--config", desk.config, "--store", f"{bucket}-absent/lab"
    )
    assert result.exit_code == 2
    assert "there is no bucket" in result.output
