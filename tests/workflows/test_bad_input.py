"""Whatever is wrong with a request: one clear message, exit code 2, no traceback, nothing computed."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import Result

from tests.workflows.conftest import invoke
from workflows.exports.ledger import Ledger


def refused(result: Result, *parts: str) -> None:
    """The command ended with 2 and one message with all parts in it."""
    assert result.exit_code == 2, result.output
    assert "Traceback" not in result.output
    assert result.stdout == ""
    for part in parts:
        assert part in result.stderr


@pytest.mark.parametrize(
    ("setting", "parts"),
    [
        ("geometry.length=true", ["geometry.length", "must be a number in mm"]),
        ('geometry.length="long"', ["geometry.length", '"long"', "a number in mm"]),
        ("geometry.substrate_thickness=-0.018", ["geometry.substrate_thickness", "greater than 0"]),
        ('geometry.substrate_thickness="18 ms"', ["another dimension"]),
        ("geometry.thickness=1", ["geometry.thickness", "substrate_thickness"]),
        ("geometry.lenght=1", ["did you mean 'geometry.length'?"]),
        ("geometrie.length=1", ["did you mean 'geometry'?"]),
        ("electrophysiology.stimuli=S9", ["'S9'", "S1, S2, S3"]),
        ("electrophysiology.cell_model=aliev-panfilow", ["did you mean 'aliev-panfilov'?"]),
        ("electrophysiology.degree=1", ["electrophysiology.degree", "at least 2"]),
        ("mechanics.degree=1", ["mechanics.degree", "at least 2"]),
        ("electrophysiology.elements=[0, 6]", ["electrophysiology.elements", "at least 1"]),
        ("electrophysiology.elements=[-3, 6]", ["electrophysiology.elements", "at least 1"]),
        ("mechanics.elements=[50, 0]", ["mechanics.elements", "at least 1"]),
        ("electrophysiology.elements=[102]", ["a list of 2 whole numbers"]),
        ("electrophysiology.output_interval=0", ["output_interval", "greater than 0"]),
        ("electrophysiology.duration=1000", ["1000 ms", "mechanics.duration = 2000 ms"]),
        ("postprocessing.probes.D=[3.6,1]", ["probes.D = (3.6, 1)", "[0, 3.5] x [0, 2] mm"]),
        ("postprocessing.probes.A=[3.5000001,1]", ["(3.5000001, 1)", "[0, 3.5] x [0, 2] mm"]),
        ("geometry.length=3.4999999", ["(3.5, 1)", "[0, 3.4999999] x [0, 2] mm"]),
        ("mechanics.duration=2000.0005", ["2000 ms", "mechanics.duration = 2000.0005 ms"]),
        ("postprocessing.velocity_window=[1,3.5000001]", ["[1, 3.5000001]", "outside"]),
        ("postprocessing.mid_axis=2.0000001", ["mid_axis = 2.0000001 mm", "outside the film"]),
        ("postprocessing.mid_axis=2.1", ["mid_axis = 2.1 mm", "outside the film"]),
        ("postprocessing.velocity_window=[1,4]", ["velocity_window = [1, 4]", "outside"]),
        (
            'electrophysiology.stimuli=[{kind="patch-current", x=[3.0, 4.0], y=[0.0, 1.0], '
            "start=0.0, duration=5.0, current=20.0}]",
            ["stimulated rectangle [3, 4] x [0, 1] mm", "outside the film"],
        ),
        (
            "electrophysiology.stimuli.1.start=2000",
            ["electrophysiology.stimuli.1: begins at 2000 ms, but the run ends at 2000 ms"],
        ),
        ("mechanics.supports.clamp.edge=X=1", ["mechanics.supports.clamp.edge", "'X=L1'"]),
        ("mechanics.supports.clamp.kind=clamp", ["choose one of", "clamped-normal", "symmetry"]),
        (
            'mechanics.supports.grip={kind="point", position=[1.0, 2.1], z=0.0}',
            ["mechanics.supports.grip.position = (1, 2.1) mm", "outside the film"],
        ),
        (
            'mechanics.loads.tip={kind="point", position=[4, 1], force=[0, 0, 1], time_law="constant"}',
            ["mechanics.loads.tip.position = (4, 1) mm", "outside the film"],
        ),
        ("mechanics.loads.wind=pressure", ["mechanics.loads.wind.time_law", "missing", "kPa"]),
        ("mechanics.substrate.name=neo-hooke", ['mechanics.substrate.name = "neo-hooke"', "ean'?"]),
        ("mechanics.loads.wind.kind=wind", ["choose one of", "area", "pressure"]),
        ("mechanics.plane_points=1", ["plane_points 1 is too few for degree 2"]),
        (
            'geometry.layers=[{name="a", material="substrat", thickness="9 um", activity=1.0}]',
            [
                "geometry.layers.0 (a)",
                "'substrat'; did you mean 'substrate'?",
                "mechanics.materials",
            ],
        ),
        (
            'geometry.layers=[{name="a", material="substrate", thickness="9 um"}]',
            ["no layer is active", "activity above 0"],
        ),
        (
            'geometry.layers=[{name="a", material="active", thickness=-0.009, activity=1.0}]',
            ["geometry.layers.0.thickness = -0.009", "greater than 0"],
        ),
        (
            'geometry.layers=[{name="a", material="active", thickness=9, activity=1.0}]',
            ["layers.0.thickness (a) = 9 mm", '"9 um"'],
        ),
        ("mechanics.materials.skin=neo-hokean", ["mechanics.materials.skin", "'neo-hookean'?"]),
        (
            'mechanics.materials.active={name="neo-hookean", density=1.0, shear_modulus=1.0}',
            ["materials.active is taken", "as mechanics.active"],
        ),
        ("mechanics.tension_law=length-dependend", ["did you mean 'length-dependent'?"]),
        ("geometry.length=nan", ["geometry.length", "finite"]),
        ("mechanics.damping", ["SECTION.KEY=VALUE", "'mechanics.damping'"]),
    ],
)
def test_a_wrong_parameter_is_named_with_what_is_allowed(
    setting: str, parts: list[str], tmp_path: Path
) -> None:
    store, out = tmp_path / "store", tmp_path / "out"
    result = invoke("run", "planar-waves", "--set", setting, "--store", store, "--out", out)
    refused(result, *parts)
    assert not store.exists()
    assert not out.exists()


def test_every_command_checks_its_parameters() -> None:
    for command in ("explain", "show", "geometry", "electrophysiology", "postprocessing"):
        refused(invoke(command, "planar-waves", "--set", "geometry.length=-1"), "greater than 0")


def test_several_problems_are_told_together() -> None:
    result = invoke("show", "planar-waves", "--set", "geometry.length=-1", "--set", "mechanics.x=1")
    refused(result, "2 problems", "geometry.length", "mechanics.x")


def test_a_misspelt_workflow_gets_the_nearest_name() -> None:
    for command in ("run", "explain", "show", "mechanics"):
        refused(invoke(command, "planar-wave"), "'planar-wave'", "did you mean 'planar-waves'?")


def test_a_misspelt_command_or_option_gets_the_nearest_name() -> None:
    refused(invoke("mechanic", "planar-waves"), "No such command 'mechanic'", "mechanics")
    refused(invoke("run", "planar-waves", "--confg", "x"), "No such option", "--config")


def test_a_misspelt_figure_gets_the_nearest_name() -> None:
    refused(invoke("reproduce", "fig88"), "there is no figure 'fig88'", "did you mean 'fig8'?")


def test_a_parameter_file_that_is_missing_or_malformed_is_named(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    refused(invoke("run", "planar-waves", "--config", path), str(path), "cannot read")
    path.write_text("[geometry\nlength = 3")
    refused(invoke("run", "planar-waves", "--config", path), str(path), "line 1")


def test_a_store_that_is_a_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "store"
    path.write_text("")
    for command in (["run", "planar-waves"], ["explain", "planar-waves"], ["store", "ls"]):
        refused(invoke(*command, "--store", path), "must be a folder", str(path))


def test_an_output_folder_that_cannot_be_written_is_refused_before_computing(
    tmp_path: Path,
) -> None:
    path = tmp_path / "results"
    path.write_text("")
    store = tmp_path / "store"
    for out in (path, path / "below"):
        result = invoke("run", "planar-waves", "--out", out, "--store", store)
        refused(result, "output folder", str(out), "--out")
    assert not store.exists()


def test_a_single_stage_does_not_replace_the_summary_of_a_whole_run(tmp_path: Path) -> None:
    store, out = tmp_path / "store", tmp_path / "out"
    out.mkdir()
    (out / "report.html").write_text("")
    (out / "summary.json").write_text("whole")
    Ledger(out).made("report.html", "source")
    for stage in ("geometry", "postprocessing"):
        result = invoke(stage, "planar-waves", "--out", out, "--store", store)
        refused(result, str(out), "whole run", "--out")
    assert (out / "summary.json").read_text() == "whole"
    assert not store.exists()


def test_an_empty_path_is_not_taken_for_the_current_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for command in (["run", "planar-waves"], ["mechanics", "planar-waves"], ["reproduce", "fig9"]):
        for option in ("--config", "--out", "--store"):
            refused(invoke(*command, option, ""), option, "empty")
    for command in (["explain", "planar-waves"], ["store", "ls"], ["store", "show", "ab"]):
        refused(invoke(*command, "--store", ""), "--store", "empty")
    assert not list(tmp_path.iterdir())


def test_an_unknown_or_ambiguous_key_is_refused(tmp_path: Path) -> None:
    refused(invoke("store", "show", "abc", "--store", tmp_path), "starts with 'abc'")
    for key in ("aa11", "aa22"):
        (tmp_path / "objects" / "geometry" / key).mkdir(parents=True)
    refused(invoke("store", "show", "aa", "--store", tmp_path), "2 results", "geometry/aa11")
