"""Whole sweeps through the command line, on an experiment of a few seconds."""

from __future__ import annotations

import csv
import errno
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
from typer.testing import Result

from pipeline.store import LocalStore
from tests.workflows.conftest import Desk, invoke
from workflows.sweep.journal import NAME

ROOT = Path(__file__).parents[3]

TINY = """
# The wave has begun to cross the film, which hardly moves yet: every stage takes less than a second.
[electrophysiology]
elements = [28, 6]
n_steps = 400
duration = 20.0
conductivity = 0.05
stimuli = ["S1"]

[electrophysiology.stimulus_library.S1]
flux = 10.0

[mechanics]
elements = [4, 2]
n_steps = 2
duration = 20.0
"""

VARIANTS = ("--over", "mechanics.damping=0.2,0.4,0.8", "--over", "geometry.fibre_angle=0:90:15")
"""21 variants of the mechanics."""

FAILING = ("--over", "mechanics.max_iterations=1,15", "--set", "mechanics.max_halvings=0")
"""With one iteration of Newton's method there is no solution."""


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> Desk:
    """A store that all sweeps here share."""
    made = Desk(tmp_path_factory.mktemp("tiny"))
    made.config.write_text(TINY)
    return made


def swept(desk: Desk, out: str, *more: object) -> dict[str, Any]:
    """Summary of a sweep that must succeed."""
    return desk.run(out, *more, command="sweep")


def rows(folder: Path) -> list[dict[str, str]]:
    """Rows of the table of cases."""
    with open(folder / "cases.csv", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def computations(store: Path, stage: str) -> int:
    """Results of a stage that were ever published."""
    return len(list(LocalStore(store).refs(stage)))


@pytest.fixture(scope="module")
def grid(tiny: Desk) -> dict[str, Any]:
    """Summary of 21 variants in an empty store."""
    return swept(tiny, "grid", *VARIANTS)


def test_what_cases_share_is_computed_once(tiny: Desk, grid: dict[str, Any]) -> None:
    """A fibre angle changes the geometry, but not the part of it that the cells see."""
    computed = {name: stage["computed"] for name, stage in grid["stages"].items()}
    assert computed == {
        "geometry": 7,
        "electrophysiology": 1,
        "activation": 1,
        "mechanics": 21,
        "postprocessing": 21,
    }
    assert {name: computations(tiny.store, name) for name in computed} == computed


def test_every_case_is_a_row_with_parameters_and_quantities(
    tiny: Desk, grid: dict[str, Any]
) -> None:
    table = rows(tiny.folder / "grid")
    assert [row["case"] for row in table] == [f"{i:02d}" for i in range(1, 22)]
    assert {row["status"] for row in table} == {"done"}
    assert [row["mechanics.damping [1/ms]"] for row in table[::7]] == ["0.2", "0.4", "0.8"]
    angles = [float(row["geometry.fibre_angle [degree]"]) for row in table]
    assert angles == [15.0 * i for i in range(7)] * 3
    assert all(float(row["B.max_displacement [mm]"]) > 0 for row in table)


def test_a_case_has_the_numbers_of_the_run_that_it_is(tiny: Desk, grid: dict[str, Any]) -> None:
    settings = ("--set", "mechanics.damping=0.4", "--set", "geometry.fibre_angle=30")
    alone = tiny.run("alone", *settings, command="postprocessing")
    assert all(stage["hit"] for stage in alone["stages"].values())
    (row,) = (row for row in rows(tiny.folder / "grid") if row["case"] == "10")
    for name in ("B.max_displacement", "C.max_displacement", "A.peak_active_stress"):
        quantity = alone["quantities"][name]
        assert float(row[f"{name} [{quantity['unit']}]"]) == quantity["value"]


def test_the_report_tells_what_stages_warned_of_though_they_are_in_the_store(tiny: Desk) -> None:
    strong = ("--over", "mechanics.damping=0.4,0.8", "--set", "activation.scale=200")
    coarse = ("--set", "mechanics.elements=[3,2]", "--set", "mechanics.n_steps=4")
    first = swept(tiny, "strong", *strong, *coarse)
    again = swept(tiny, "strong", *strong, *coarse)
    assert any("the mesh is too coarse" in one["warning"] for one in first["warnings"])
    assert again["warnings"] == first["warnings"]
    page = (tiny.folder / "strong" / "report.html").read_text(encoding="utf-8")
    assert "What to be careful about" in page
    assert all("the mesh is too coarse" in row["warnings"] for row in rows(tiny.folder / "strong"))


def test_xarray_reads_quantities_over_the_parameters(tiny: Desk, grid: dict[str, Any]) -> None:
    xarray = pytest.importorskip("xarray")
    data = xarray.open_zarr(tiny.folder / "grid" / "sweep.zarr")
    assert dict(data["max_curvature"].sizes) == {
        "mechanics.damping": 3,
        "geometry.fibre_angle": 7,
    }
    assert list(data["mechanics.damping"].values) == [0.2, 0.4, 0.8]
    assert data["geometry.fibre_angle"].attrs["units"] == "degree"
    assert bool(data["done"].all())
    one = data["B.max_displacement"].sel({"mechanics.damping": 0.4, "geometry.fibre_angle": 30.0})
    (row,) = (row for row in rows(tiny.folder / "grid") if row["case"] == "10")
    assert float(one) == float(row["B.max_displacement [mm]"])
    assert data["A.activation_times"].dims[-1] == "item"


def test_the_table_is_there_as_parquet(tiny: Desk, grid: dict[str, Any]) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    table = parquet.read_table(tiny.folder / "grid" / "cases.parquet")
    written = [float(row["B.max_displacement [mm]"]) for row in rows(tiny.folder / "grid")]
    assert table["B.max_displacement [mm]"].to_pylist() == written
    assert table.schema.field("geometry.fibre_angle [degree]").metadata[b"unit"] == b"degree"


def test_picture_and_report_show_the_sweep(tiny: Desk, grid: dict[str, Any]) -> None:
    folder = tiny.folder / "grid"
    assert (folder / "cases.png").stat().st_size > 20_000
    page = (folder / "report.html").read_text(encoding="utf-8")
    for part in (
        "data:image/png;base64,",
        "geometry.fibre_angle",
        "21 cases are done",
        "sweep.zarr",
    ):
        assert part in page


def test_the_same_sweep_again_computes_nothing_and_writes_the_same(
    tiny: Desk, grid: dict[str, Any]
) -> None:
    table = (tiny.folder / "grid" / "cases.csv").read_bytes()
    picture = (tiny.folder / "grid" / "cases.png").read_bytes()
    again = swept(tiny, "grid", *VARIANTS)
    assert not any(stage["computed"] for stage in again["stages"].values())
    assert (tiny.folder / "grid" / "cases.csv").read_bytes() == table
    assert (tiny.folder / "grid" / "cases.png").read_bytes() == picture


def test_a_dry_run_tells_what_is_left_and_computes_nothing(
    tiny: Desk, grid: dict[str, Any]
) -> None:
    before = computations(tiny.store, "mechanics")
    more = ("--over", "mechanics.damping=0.4,0.8,1.6", "--over", "geometry.fibre_angle=0,90")
    result = tiny.call("sweep", *more, "--dry-run")
    assert result.exit_code == 0, result.output
    lines = {line.split()[0]: line.split() for line in result.output.splitlines()}
    assert lines["6"][:2] == ["6", "cases"]
    assert lines["geometry"][1:4] == ["2", "2", "0"]
    assert lines["electrophysiology"][1:4] == ["1", "1", "0"]
    assert lines["mechanics"][1:4] == ["6", "4", "2"]
    assert lines["postprocessing"][1:6] == ["6", "4", "at", "most", "2"]
    assert computations(tiny.store, "mechanics") == before


def test_cases_are_planned_without_a_store_with_every_stage_counted_once(tiny: Desk) -> None:
    more = ("--over", "mechanics.damping=0.1:1:#20", "--over", "geometry.fibre_angle=0:90:#20")
    result = invoke("sweep", "planar-waves", *more, "--store", tiny.folder / "none", "--dry-run")
    assert result.exit_code == 0, result.output
    lines = {line.split()[0]: line.split() for line in result.output.splitlines()}
    assert lines["geometry"][1:4] == ["20", "0", "20"]
    assert lines["mechanics"][1:6] == ["400", "0", "at", "most", "400"]
    assert not (tiny.folder / "none").exists()


def test_a_failed_case_does_not_stop_the_others(tiny: Desk) -> None:
    result = tiny.call("sweep", *FAILING, "--out", tiny.folder / "failing")
    assert result.exit_code == 1
    told = "\n".join(result.stderr.splitlines())
    assert "1 of 2 cases failed:" in told
    assert "case 1 (mechanics.max_iterations = 1):" in told
    assert "Newton's method did not converge within 1 iterations" in told
    assert "--retry-failed" in told
    statuses = [row["status"] for row in rows(tiny.folder / "failing")]
    assert statuses == ["failed", "done"]
    assert "did not converge" in rows(tiny.folder / "failing")[0]["error"]
    summary = json.loads((tiny.folder / "failing" / "summary.json").read_text())
    assert [one["case"] for one in summary["failed"]] == ["1"]
    assert "did not converge" in (tiny.folder / "failing" / "report.html").read_text()


def test_failures_are_remembered_and_tried_again_on_request(tiny: Desk) -> None:
    """The journal counts the attempts."""
    out = ("--out", tiny.folder / "remembered")
    journal = tiny.folder / "remembered" / NAME

    def attempts() -> int:
        return sum('"failed", "at"' in line for line in journal.read_text().splitlines())

    def failed(result: Result) -> bool:
        assert result.exit_code == 1
        return "1 of 2 cases failed" in result.stderr

    assert failed(tiny.call("sweep", *FAILING, *out))
    assert attempts() == 1
    assert failed(tiny.call("sweep", *FAILING, *out))
    assert attempts() == 1
    assert failed(tiny.call("sweep", *FAILING, *out, "--retry-failed"))
    assert attempts() == 2


def test_a_case_that_the_store_failed_is_tried_again_by_the_next_call(tiny: Desk) -> None:
    """A full disk, or a damaged result, says nothing of the case."""
    call = ("sweep", "--over", "mechanics.damping=5,6", "--out", tiny.folder / "refilled")
    with pytest.MonkeyPatch.context() as patch:
        full = OSError(errno.ENOSPC, "No space left on device")
        patch.setattr("pipeline.store.workspace.sync_tree", Mock(side_effect=full))
        result = tiny.call(*call)
    assert result.exit_code == 1
    assert "no space left on the disk of the store" in result.stderr
    assert tiny.call(*call).exit_code == 0
    assert {row["status"] for row in rows(tiny.folder / "refilled")} == {"done"}


def test_a_damaged_manifest_is_told_with_what_to_do_and_mended_on_request(tiny: Desk) -> None:
    """The forecast, which reads manifests before anything runs, must not end the sweep."""
    call = ("sweep", "--over", "mechanics.damping=7,8", "--out", tiny.folder / "damaged")
    mechanics = tiny.store / "objects" / "mechanics"
    before = set(mechanics.glob("*/manifest.json"))
    assert tiny.call(*call).exit_code == 0
    made = set(mechanics.glob("*/manifest.json")) - before
    assert len(made) == 2
    for manifest in made:
        manifest.write_bytes(manifest.read_bytes()[:99])
    result = tiny.call(*call)
    assert result.exit_code == 1
    assert "2 of 2 cases failed" in result.stderr
    assert "--recompute-damaged" in result.stderr
    assert tiny.call(*call, "--recompute-damaged").exit_code == 0
    assert {row["status"] for row in rows(tiny.folder / "damaged")} == {"done"}


def test_another_setting_is_another_case_to_the_journal(tiny: Desk) -> None:
    out = ("--out", tiny.folder / "mended")
    assert tiny.call("sweep", *FAILING, *out).exit_code == 1
    mended = ("--over", "mechanics.max_iterations=14,15", "--set", "mechanics.max_halvings=0")
    assert tiny.call("sweep", *mended, *out).exit_code == 0
    assert {row["status"] for row in rows(tiny.folder / "mended")} == {"done"}


def test_a_journal_cut_short_by_a_crash_is_read_and_continued(tiny: Desk) -> None:
    out = tiny.folder / "crashed"
    assert tiny.call("sweep", *FAILING, "--out", out).exit_code == 1
    with open(out / NAME, "ab") as file:
        file.write(b'{"event": "failed", "ca')
    assert tiny.call("sweep", *FAILING, "--out", out).exit_code == 1
    *_, last = (out / NAME).read_text().splitlines()
    assert json.loads(last)["event"] == "ended"


def test_an_unreachable_scheduler_is_told_before_anything_is_computed(tiny: Desk) -> None:
    nobody = "tcp://127.0.0.1:9"
    more = ("--over", "mechanics.damping=3,4", "--cluster", nobody, "--out", tiny.folder / "far")
    before = computations(tiny.store, "mechanics")
    result = tiny.call("sweep", *more)
    assert result.exit_code == 2
    assert nobody in result.stderr
    assert computations(tiny.store, "mechanics") == before


def test_each_case_may_have_its_own_report(tiny: Desk) -> None:
    table = tiny.folder / "named.csv"
    table.write_text("case,mechanics.damping\nusual,0.4\n")
    swept(tiny, "each", "--cases", table, "--each")
    own = tiny.folder / "each" / "cases" / "usual"
    assert {"report.html", "summary.json", "probes.csv", "fig9.png"} <= set(os.listdir(own))


@pytest.mark.slow
def test_samples_are_arrays_over_the_cases(tiny: Desk) -> None:
    xarray = pytest.importorskip("xarray")
    more = ("--sample", "lhs:3", "--over", "mechanics.damping=0.2..0.8", "--zip")
    together = ("mechanics.n_steps=2,3", "--zip", "mechanics.max_iterations=15,14")
    swept(tiny, "samples", *more, *together)
    data = xarray.open_zarr(tiny.folder / "samples" / "sweep.zarr")
    assert data["max_curvature"].dims == ("case",)
    assert list(data["mechanics.n_steps"].values) == [2, 2, 2, 3, 3, 3]
    assert set(data["max_curvature"].coords) >= {"case", "mechanics.damping"}
    assert np.isfinite(data["max_curvature"]).all()


def test_cells_are_swept_by_the_names_of_their_parameters(tiny: Desk) -> None:
    models = "electrophysiology.cell_model=aliev-panfilov,mitchell-schaeffer"
    more = ("--over", models, "--over", "electrophysiology.stimulus_library.S1.flux=9,10")
    mesh = ("--set", "electrophysiology.elements=[28, 7]")
    swept(tiny, "cells", *more, *mesh)
    table = rows(tiny.folder / "cells")
    assert [row["electrophysiology.cell_model"] for row in table[::2]] == [
        "aliev-panfilov",
        "mitchell-schaeffer",
    ]
    peaks = [float(row["A.peak_active_stress [kPa]"]) for row in table]
    assert len(set(peaks)) == 4
    xarray = pytest.importorskip("xarray")
    data = xarray.open_zarr(tiny.folder / "cells" / "sweep.zarr")
    assert list(data["electrophysiology.cell_model"].values) == [
        "aliev-panfilov",
        "mitchell-schaeffer",
    ]


@pytest.mark.parametrize(
    ("over", "part"),
    [
        ("mechanics.dampin=1", "did you mean 'mechanics.damping'?"),
        ("mechanics.damping=-1,0.4,-2", "2 of 3 cases are not valid:"),
        ("postprocessing.mid_axis=1,2.5", "case 2 (postprocessing.mid_axis = 2.5)"),
        ("electrophysiology.elements=[28,6]", "a sweep runs over single values"),
    ],
)
def test_a_sweep_that_cannot_be_is_refused_before_anything_is_computed(
    over: str, part: str, tmp_path: Path
) -> None:
    out, store = tmp_path / "out", tmp_path / "store"
    result = invoke("sweep", "planar-waves", "--over", over, "--out", out, "--store", store)
    assert result.exit_code == 2
    assert part in result.stderr
    assert result.stdout == ""
    assert not out.exists()
    assert not store.exists()


@pytest.mark.slow
def test_an_interrupt_keeps_what_is_done_and_the_same_command_goes_on(
    tiny: Desk, grid: dict[str, Any]
) -> None:
    """In a process of its own; n_steps makes the last case last for minutes."""
    out, store = tiny.folder / "stopped", str(tiny.store)
    steps = "mechanics.n_steps=2,2000"
    where = ("--config", str(tiny.config), "--store", store, "--out", str(out))
    process = subprocess.Popen(
        [sys.executable, "-m", "workflows.cli", "sweep", "planar-waves", "--over", steps, *where],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    checkpoints = tiny.store / "checkpoints"
    while process.poll() is None and not (checkpoints.is_dir() and any(checkpoints.iterdir())):
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    told, _ = process.communicate(timeout=60)
    assert process.returncode == 130, told
    assert [row["status"] for row in rows(out)] == ["done", "open"]
    again = swept(tiny, "stopped", "--over", "mechanics.n_steps=2", *where[4:])
    assert not any(stage["computed"] for stage in again["stages"].values())
