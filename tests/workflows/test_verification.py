"""Verification studies through the command line."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import pytest

from tests.workflows.conftest import invoke
from workflows.verification.catalogue import all_studies
from workflows.workflow import LimitError, Quantity, check_limits

FEW = ("--set", "tension.increments=2")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the store and the outputs."""
    return tmp_path_factory.mktemp("verification")


def verify(folder: Path, *arguments: str) -> dict[str, Any]:
    """Summary of the study `tension`."""
    where = ("--store", folder / "store", "--out", folder / "out")
    result = invoke("verification", "tension", *where, *arguments)
    assert result.exit_code == 0, result.output
    summary: dict[str, Any] = json.loads((folder / "out" / "summary.json").read_text())
    return summary


def test_a_study_leaves_table_figure_and_report(folder: Path) -> None:
    summary = verify(folder, *FEW)
    names = {path.name for path in (folder / "out").iterdir()}
    files = {"tension.csv", "tension.png", "tension.svg"}
    assert names == files | {"summary.json", "report.html", "exports.json"}
    assert summary["workflow"] == "verification"
    assert summary["quantities"]["tension.stress_error"]["value"] < 1e-12
    assert summary["stages"]["tension"]["hit"] is False
    rows = list(csv.reader((folder / "out" / "tension.csv").open()))
    assert rows[0][:2] == ["stretch", "stress [kPa]"]
    assert [float(row[0]) for row in rows[1:]] == [2.0, 3.0]
    page = (folder / "out" / "report.html").read_text()
    assert page.count('src="data:image/png;base64,') == 1
    assert "allowed 1e-09" in page


def test_a_study_is_computed_once(folder: Path) -> None:
    verify(folder, *FEW)
    assert verify(folder, *FEW)["stages"]["tension"]["hit"] is True
    told = invoke("explain", "verification", *FEW, "--store", folder / "store").output
    assert "tension:            hit" in told
    more = ("--set", "tension.increments=3")
    told = invoke("explain", "verification", *more, "--store", folder / "store").output
    assert "increments is 3, was 2" in told


def test_without_a_name_the_studies_are_listed() -> None:
    told = invoke("verification").output
    assert [line.split()[0] for line in told.splitlines()] == list(all_studies())


def test_an_unknown_study_is_bad_input() -> None:
    result = invoke("verification", "tensoin")
    assert result.exit_code == 2
    assert "did you mean 'tension'" in result.output


def test_file_name_section_and_stage_of_a_study_agree() -> None:
    for study in all_studies().values():
        assert study.module.rpartition(".")[2] == study.section
        assert study.stage.name == study.section


def test_a_broken_limit_is_an_error_that_names_it() -> None:
    kept = Quantity(1e-10, "", "an error", limit=1e-9)
    lost = Quantity(float("nan"), "", "an error", limit=1e-9)
    check_limits({"a": kept, "b": Quantity(5.0, "mm", "a length")})
    with pytest.raises(LimitError, match="b is nan, allowed is 1e-09"):
        check_limits({"a": kept, "b": lost})
