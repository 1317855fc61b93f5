"""What a sweep leaves, from made-up quantities: nothing is computed."""

from __future__ import annotations

import csv
import json
import math
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zarr

from workflows.sweep.arrays import write_arrays
from workflows.sweep.asked import Asked
from workflows.sweep.outputs import write_results
from workflows.sweep.picture import worth_showing, write_picture
from workflows.sweep.results import Column, Results
from workflows.sweep.study import Study
from workflows.workflow import Quantity

GRID = (
    "activation.peak_stress=3,9",
    "mechanics.n_steps=10:40:10",
    "mechanics.supports.clamp.edge=X=0,X=L1",
)


def study(*over: str, **more: Any) -> Study:
    """A sweep over curling films."""
    return Study.read("curling", None, (), Asked(over, **more))


def results(found: Study, failed: int | None = None) -> Results:
    """Quantities that tell their case: a number, a list as long as the case number, and nothing."""
    made = Results(found)
    for number in range(len(found.design)):
        if number == failed:
            made.errors[number] = "no convergence\nRemedy: smaller steps"
            continue
        made.quantities[number] = {
            "bend": Quantity(0.5 * number, "1/mm", "how much it bends"),
            "beats": Quantity([float(i) for i in range(number % 3)], "ms", "when it beats"),
            "nothing": Quantity(None, "", "not measured"),
            "constant": Quantity(1.0, "mm", "always the same"),
        }
    return made


def table(folder: Path) -> list[dict[str, str]]:
    """Rows of the table."""
    with open(folder / "cases.csv", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_a_grid_fills_arrays_over_its_parameters(tmp_path: Path) -> None:
    write_results(results(study(*GRID), failed=5), tmp_path)
    group = zarr.open_group(tmp_path / "sweep.zarr", mode="r")
    bend = np.asarray(group["bend"][...])
    assert bend.shape == (2, 4, 2)
    expected = 0.5 * np.arange(16.0)
    expected[5] = math.nan
    np.testing.assert_array_equal(bend.ravel(), expected)
    assert group["bend"].metadata.dimension_names == tuple(text.partition("=")[0] for text in GRID)
    assert list(group["mechanics.n_steps"][...]) == [10, 20, 30, 40]
    assert list(group["mechanics.supports.clamp.edge"][...]) == ["X=0", "X=L1"]
    assert int(np.sum(group["done"][...])) == 15
    assert group["beats"].shape == (2, 4, 2, 2)
    np.testing.assert_array_equal(group["beats"][0, 0, 1], [0.0, math.nan])


def test_the_table_has_a_column_for_each_item_of_a_list(tmp_path: Path) -> None:
    write_results(results(study(*GRID), failed=5), tmp_path)
    rows = table(tmp_path)
    assert [row["status"] for row in rows].count("failed") == 1
    assert rows[5]["error"] == "no convergence; Remedy: smaller steps"
    assert rows[5]["bend [1/mm]"] == ""
    assert (rows[2]["beats 1 [ms]"], rows[2]["beats 2 [ms]"]) == ("0.0", "1.0")
    assert (rows[1]["beats 1 [ms]"], rows[1]["beats 2 [ms]"]) == ("0.0", "")
    assert rows[4]["mechanics.supports.clamp.edge"] == "X=0"


def test_parameters_that_a_table_leaves_out_are_those_of_the_workflow(tmp_path: Path) -> None:
    cases = tmp_path / "cases.csv"
    cases.write_text("case,mechanics.n_steps,activation.peak_stress\nown,,5\nfew,7,\n")
    write_results(results(study(cases=cases)), tmp_path)
    rows = table(tmp_path)
    assert [row["mechanics.n_steps"] for row in rows] == ["42", "7"]
    assert [row["activation.peak_stress [kPa]"] for row in rows] == ["5.0", "9.0"]
    group = zarr.open_group(tmp_path / "sweep.zarr", mode="r")
    assert list(group["case"][...]) == ["own", "few"]
    assert group["bend"].attrs["coordinates"] == "mechanics.n_steps activation.peak_stress"


def test_the_summary_tells_ranges_and_failures(tmp_path: Path) -> None:
    write_results(results(study(*GRID), failed=5), tmp_path)
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert (summary["cases"], summary["done"]) == (16, 15)
    assert summary["quantities"]["bend"] == {"unit": "1/mm", "min": 0.0, "max": 7.5}
    assert summary["quantities"]["nothing"]["max"] is None
    assert summary["parameters"]["mechanics.supports.clamp.edge"]["values"] == ["X=0", "X=L1"]
    (failed,) = summary["failed"]
    assert failed["parameters"]["mechanics.n_steps"] == 30
    assert failed["error"].startswith("no convergence")


def test_warnings_of_stages_are_in_table_summary_and_report(tmp_path: Path) -> None:
    made = results(study(*GRID))
    made.warnings = {
        2: ("mechanics: 6 elements are too few",),
        9: ("mechanics: 4 elements are too few",),
    }
    write_results(made, tmp_path)
    assert [row["warnings"] for row in table(tmp_path)][1:3] == [
        "",
        "mechanics: 6 elements are too few",
    ]
    assert json.loads((tmp_path / "summary.json").read_text())["warnings"] == [
        {"warning": "mechanics: 6 elements are too few", "cases": ["03", "10"]}
    ]
    page = (tmp_path / "report.html").read_text()
    assert "6 elements are too few" in page
    assert "2 of 16 cases: 03, 10" in page
    assert "4 elements are too few" not in page  # of the same kind


@pytest.mark.parametrize(
    ("over", "more", "words"),
    [
        (GRID, {}, ["coloured by activation.peak_stress", "dashed for X=L1"]),
        (GRID[2:], {}, ["Each quantity over mechanics.supports.clamp.edge"]),
        (("activation.peak_stress=1:9:1", "mechanics.n_steps=10:24:2"), {}, ["coloured by"]),
        (("activation.peak_stress=1..9",), {"sample": "lhs:5"}, ["a dot per case"]),
    ],
)
def test_the_picture_suits_the_parameters(
    over: tuple[str, ...], more: dict[str, Any], words: list[str], tmp_path: Path
) -> None:
    told = write_picture(results(study(*over, **more)), tmp_path)
    for part in words:
        assert part in told
    assert (tmp_path / "cases.png").stat().st_size > 5_000


def test_a_sweep_of_which_nothing_is_done_leaves_its_files_all_the_same(tmp_path: Path) -> None:
    write_results(Results(study(*GRID)), tmp_path)
    assert {row["status"] for row in table(tmp_path)} == {"open"}
    assert "0 of\n16 cases are done" in (tmp_path / "report.html").read_text()


def test_quantities_that_change_are_shown_single_numbers_first() -> None:
    listed = Column("beats", "ms", [1.0, 2.0], place=1)
    constant, single = Column("constant", "mm", [1.0, 1.0 + 1e-12]), Column("bend", "", [1.0, 3.0])
    assert worth_showing([listed, constant, single]) == [single, listed]
    assert worth_showing([constant]) == [constant]


def test_two_sweeps_may_write_the_same_arrays_at_once(tmp_path: Path) -> None:
    found = results(study("mechanics.n_steps=10:40:10"))
    path = tmp_path / "sweep.zarr"
    path.mkdir()
    rename, others = os.rename, iter([True, True])

    def another_is_quicker(source: Any, target: Any) -> None:
        if target == path and next(others, False):
            (path / "of-another").mkdir(parents=True)
        rename(source, target)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "rename", another_is_quicker)
        write_arrays(found, path)
    assert "bend" in zarr.open_group(path, mode="r")
    assert list(tmp_path.iterdir()) == [path]
