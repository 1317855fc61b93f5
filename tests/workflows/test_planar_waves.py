"""The whole experiment through the command line: what is computed, when, and what it leaves."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from pipeline.store import LocalStore
from tests.workflows.conftest import Desk, invoke

STAGES = ["geometry", "electrophysiology", "activation", "mechanics", "postprocessing"]
ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def first(desk: Desk) -> dict[str, Any]:
    """Summary of the first run in an empty store."""
    return desk.run("first")


def computed(summary: dict[str, Any]) -> list[str]:
    """Stages that were not in the store."""
    return [name for name, stage in summary["stages"].items() if not stage["hit"]]


def keys(summary: dict[str, Any]) -> dict[str, str]:
    """Key of each stage."""
    return {name: stage["key"] for name, stage in summary["stages"].items()}


def test_the_first_run_computes_every_stage(first: dict[str, Any]) -> None:
    assert first["workflow"] == "planar-waves"
    assert list(first["stages"]) == STAGES
    assert computed(first) == STAGES


def test_the_quantities_have_their_agreed_names_and_units(first: dict[str, Any]) -> None:
    units = {name: entry["unit"] for name, entry in first["quantities"].items()}
    expected = {"conduction_velocity": "mm/ms", "max_curvature": "1/mm"}
    for probe in "ABC":
        expected |= {
            f"{probe}.activation_times": "ms",
            f"{probe}.peak_active_stress": "kPa",
            f"{probe}.peak_active_stresses": "kPa",
            f"{probe}.repolarisation_times": "ms",
            f"{probe}.apd50": "ms",
            f"{probe}.apd90": "ms",
            f"{probe}.max_displacement": "mm",
        }
    assert units == expected


def test_the_wave_crosses_the_film_and_bends_it(first: dict[str, Any]) -> None:
    value = {name: entry["value"] for name, entry in first["quantities"].items()}
    # The speed grows with the root of the conductivity: 5 times the paper's 0.0174 mm/ms, within the
    # 20 % that a front only a few spans wide is off.
    assert value["conduction_velocity"] == pytest.approx(0.087, rel=0.2)
    (at_centre,), (at_tip,) = value["A.activation_times"], value["B.activation_times"]
    # From A to B the front takes less time than its speed says: near the free edge, closer than the
    # front is wide (1 mm here), nothing flows ahead any more and the tissue fires early.
    delay = 1.75 / value["conduction_velocity"]
    assert 0.5 * delay < at_tip - at_centre < delay
    assert 5.0 < value["A.peak_active_stress"] < 12.2  # k_sigma times 100 mV bounds it
    assert value["A.peak_active_stresses"] == [value["A.peak_active_stress"]]
    assert 0.0 < value["A.max_displacement"] < value["B.max_displacement"]
    assert value["max_curvature"] > 0.0


def test_everything_agreed_is_in_the_output_folder(desk: Desk, first: dict[str, Any]) -> None:
    names = {path.name for path in (desk.folder / "first").iterdir()}
    drawn = ("fig8", "fig9", "activation_maps")
    figures = {f"{figure}.{kind}" for figure in drawn for kind in ("png", "svg")}
    assert names == figures | {
        "summary.json",
        "probes.csv",
        "beats.csv",
        "maps.vtkhdf",
        "film.vtkhdf",
        "report.html",
        "exports.json",
    }


def test_the_probe_table_starts_at_rest(desk: Desk, first: dict[str, Any]) -> None:
    rows = list(csv.reader((desk.folder / "first" / "probes.csv").open()))
    assert len(rows) == 1 + 13
    assert rows[0][:6] == [
        "time [ms]",
        "A.ux [mm]",
        "A.uy [mm]",
        "A.uz [mm]",
        "A.active_stress [kPa]",
        "A.potential [mV]",
    ]
    start = [float(cell) for cell in rows[1]]
    assert start[:5] == [0.0] * 5
    assert start[5] == pytest.approx(-80.0, abs=1e-5)  # kept in single precision


def test_the_report_needs_no_other_file(desk: Desk, first: dict[str, Any]) -> None:
    page = (desk.folder / "first" / "report.html").read_text()
    assert page.count('src="data:image/png;base64,') == 3
    assert 'src="http' not in page
    assert "<link" not in page
    assert "<script" not in page
    for stage in first["stages"].values():
        assert stage["key"] in page
    for text in ("conduction_velocity", "mechanics.damping", "How to cite", "Torre"):
        assert text in page


def test_a_second_run_computes_nothing_and_gives_the_same_files(
    desk: Desk, first: dict[str, Any]
) -> None:
    second = desk.run("second")
    assert computed(second) == []
    assert keys(second) == keys(first)
    assert second["quantities"] == first["quantities"]
    for name in ("probes.csv", "film.vtkhdf", "fig8.png", "fig8.svg", "fig9.png", "fig9.svg"):
        one, two = ((desk.folder / out / name).read_bytes() for out in ("first", "second"))
        assert one == two, name


def test_files_that_are_up_to_date_are_left_alone(desk: Desk, first: dict[str, Any]) -> None:
    desk.run("kept")
    folder = desk.folder / "kept"
    before = {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}
    (folder / "fig9.png").write_bytes(b"spoilt")
    again = desk.run("kept")
    after = {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}
    changed = {name for name in before if before[name] != after[name]}
    # The two files of a figure are made together; the summary says the same as before.
    assert changed == {"fig9.png", "fig9.svg", "exports.json"}
    assert list(again["quantities"]) == list(first["quantities"])


def test_a_mechanical_parameter_leaves_the_electrophysiology_alone(
    desk: Desk, first: dict[str, Any]
) -> None:
    setting = ("--set", "mechanics.damping=0.9")
    told = desk.call("explain", *setting).output
    assert "damping is 0.9, was 0.8" in told
    assert computed(desk.run("damped", *setting)) == ["mechanics", "postprocessing"]


def test_the_fibre_angle_leaves_the_electrophysiology_alone(
    desk: Desk, first: dict[str, Any]
) -> None:
    summary = desk.run("turned", "--set", "geometry.fibre_angle=0")
    # Only the lay-up changes; surfaces keep their content, and what was made from them stays valid.
    assert computed(summary) == ["geometry", "mechanics", "postprocessing"]


def test_another_probe_is_measured_without_computing_anything_else(
    desk: Desk, first: dict[str, Any]
) -> None:
    summary = desk.run("probed", "--set", "postprocessing.probes.D=[1,0.5]")
    assert computed(summary) == ["postprocessing"]
    assert "D.max_displacement" in summary["quantities"]


def test_a_stage_command_computes_what_the_stage_needs(desk: Desk, first: dict[str, Any]) -> None:
    summary = desk.run("part", command="electrophysiology")
    assert list(summary["stages"]) == ["geometry", "electrophysiology"]
    assert computed(summary) == []
    assert summary["quantities"] == {}
    for _ in range(2):  # the second time into a folder that the first has left
        whole = desk.run("measured", command="postprocessing")
        assert whole["quantities"] == first["quantities"]


def test_the_spelling_of_a_value_does_not_change_a_key(desk: Desk, first: dict[str, Any]) -> None:
    same = (
        'geometry.substrate_thickness="18 um"',
        "electrophysiology.stimuli=S1,S2",
        "mechanics.duration=60",
    )
    summary = desk.run("spelt", *(part for text in same for part in ("--set", text)))
    assert keys(summary) == keys(first)


def test_another_process_gets_the_same_keys_and_the_same_bytes(
    desk: Desk, first: dict[str, Any], tmp_path: Path
) -> None:
    command = [sys.executable, "-m", "workflows.cli", "run", "planar-waves", "--quiet"]
    where = ["--config", desk.config, "--store", tmp_path / "store", "--out", tmp_path / "out"]
    environment = os.environ | {"PYTHONHASHSEED": "7", "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [*command, *map(str, where)],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout) == (0, ""), done.stderr
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert computed(summary) == STAGES
    assert keys(summary) == keys(first)
    here, there = LocalStore(desk.store), LocalStore(tmp_path / "store")
    for ref in there.refs():
        assert there.manifest(ref).files == here.manifest(ref).files, ref


def test_a_closed_output_is_no_error(desk: Desk, first: dict[str, Any]) -> None:
    command = [sys.executable, "-m", "workflows.cli", "run", "planar-waves"]
    where = ["--config", desk.config, "--store", desk.store, "--out", desk.folder / "closed"]
    done = subprocess.run(
        ["sh", "-c", 'exec "$@" >&-', "sh", *command, *map(str, where)],
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stderr=subprocess.PIPE,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert (desk.folder / "closed" / "summary.json").exists()


def test_the_store_tells_what_it_holds(desk: Desk, first: dict[str, Any]) -> None:
    listed = invoke("store", "ls", "mechanics", "--store", desk.store).output
    key = first["stages"]["mechanics"]["key"]
    assert key[:12] in listed
    assert "electrophysiology" not in listed
    shown = invoke("store", "show", key[:10], "--store", desk.store).output
    assert key in shown
    assert "config damping" in shown
    assert "input mid_surface" in shown
    upstream = shown[shown.index("input mid_surface") :]
    for stage in ("activation", "electrophysiology", "geometry"):
        assert f"{stage}/{first['stages'][stage]['key'][:12]}" in upstream


def test_figure_9_lays_both_runs_over_one_another(desk: Desk, first: dict[str, Any]) -> None:
    out = desk.folder / "figures"
    where = ("--config", desk.config, "--store", desk.store, "--out", out)
    result = invoke("reproduce", "fig9", *where)
    assert result.exit_code == 0, result.output
    picture = (out / "fig9.svg").read_text()
    assert "<!-- S1 and S2 -->" in picture
    assert "<!-- S1 alone -->" in picture
    assert str(out / "fig9.png") in result.output


def test_figure_8_is_that_of_the_run(desk: Desk, first: dict[str, Any]) -> None:
    out = desk.folder / "figures"
    where = ("--config", desk.config, "--store", desk.store, "--out", out)
    assert invoke("reproduce", "fig8", *where).exit_code == 0
    one, two = (path / "fig8.png" for path in (out, desk.folder / "first"))
    assert one.read_bytes() == two.read_bytes()
