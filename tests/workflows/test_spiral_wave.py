"""The spiral wave through the command line, on meshes small enough for tests."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from pipeline.canonical import canonical
from tests.workflows.conftest import invoke
from workflows.request import Request
from workflows.rotation import outermost, turn_times
from workflows.tissue_checks import fewest_elements

SMALL = (
    "electrophysiology.elements=[28, 16]",
    "electrophysiology.degree=4",
    "electrophysiology.n_steps=6000",
    "electrophysiology.duration=1200",
    "mechanics.elements=[6, 3]",
    "mechanics.n_steps=60",
    "mechanics.duration=1200",
)


def settings(*more: str) -> list[str]:
    """``--set`` for each."""
    return [part for one in (*SMALL, *more) for part in ("--set", one)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a finished run, and its store."""
    made = tmp_path_factory.mktemp("spiral")
    where = ("--store", made / "store", "--out", made)
    result = invoke("run", "spiral-wave", *where, *settings())
    assert result.exit_code == 0, result.output
    return made


def values(folder: Path) -> dict[str, Any]:
    """Quantities of the run."""
    found = json.loads((folder / "summary.json").read_text())["quantities"]
    return {name: entry["value"] for name, entry in found.items()}


def test_the_spiral_comes_round_at_the_corner(folder: Path) -> None:
    value = values(folder)
    # 196, 775 and 1146 ms on a fine mesh. Here the spans are a third of the front's width: the speed of the
    # front errs by less than 1 %, and a turn that the recovery paces by a few ms.
    assert value["C.activation_times"] == pytest.approx([196, 775, 1146], abs=12)
    assert value["B.activation_count"] == value["C.activation_count"] == 3
    assert value["rotation_periods"] == pytest.approx([371], abs=8)
    assert value["rotation_period"] == pytest.approx(value["rotation_periods"][0], rel=1e-12)
    # at full resolution the turns of the tip take 387 to 391 ms, whatever point they are counted from
    assert value["tip_turn_times"][0] == pytest.approx(389, abs=12)


def test_its_figures_are_there(folder: Path) -> None:
    for name in ("fig10", "fig11", "tips"):
        assert (folder / f"{name}.png").read_bytes().startswith(b"\x89PNG")
        assert "</svg>" in (folder / f"{name}.svg").read_text()


def test_figure_11_sets_the_spiral_beside_the_first_wave_alone(folder: Path) -> None:
    where = ("--store", folder / "store", "--out", folder / "fig11")
    result = invoke("reproduce", "fig11", *where, *settings(), "--quiet")
    assert result.exit_code == 0, result.output
    stages = json.loads((folder / "fig11" / "summary.json").read_text())["stages"]
    hits = {name for name, stage in stages.items() if stage["hit"]}
    assert {name for name in stages if name.startswith("S1 and S3")} <= hits
    drawing = (folder / "fig11" / "fig11.svg").read_text()
    assert "<!-- S1 alone -->" in drawing
    assert "<!-- C: X" in drawing


def test_planar_waves_shares_the_stages_of_equal_settings(folder: Path) -> None:
    alone = "electrophysiology.stimuli=S1"
    where = ("--store", folder / "store")
    told = invoke("explain", "planar-waves", *where, *settings(alone)).output
    assert told.splitlines()[1].split() == ["electrophysiology:", "hit"]  # that of figure 11
    both, spiral = (
        Request.read(name, None, [*SMALL, alone]).nodes()
        for name in ("planar-waves", "spiral-wave")
    )
    assert both["mechanics"].config == spiral["mechanics"].config


def test_turns_are_counted_from_the_first_activation_that_may_be_the_spirals() -> None:
    assert turn_times([196.0, 775.0, 1146.0, 1532.0], 2) == [371.0, 386.0]
    assert turn_times([196.0], 1) == []
    assert turn_times([], 2) == []
    assert turn_times([100.0, 500.0], 0) == [400.0]  # whatever set it off


def test_the_outermost_probe_is_the_corner_wherever_it_is_named() -> None:
    assert outermost(Request.read("spiral-wave").config) == "C"  # type: ignore[arg-type]
    only = 'postprocessing.probes={A="centre", B="tip", C=[0.1, 0.1]}'
    assert outermost(Request.read("spiral-wave", None, [only]).config) == "C"  # type: ignore[arg-type]
    named = ["postprocessing.probes.C=centre"]
    assert outermost(Request.read("spiral-wave", None, named).config) == "B"  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "workflow", ["planar-waves", "spiral-wave", "vulnerable-window", "restitution"]
)
def test_a_mesh_too_coarse_for_the_front_is_refused(workflow: str, tmp_path: Path) -> None:
    line: list[object] = ["run", workflow, "--store", tmp_path / "store", "--out", tmp_path / "out"]
    line += ["--set", "electrophysiology.elements=[20, 60]", "--set", "electrophysiology.degree=2"]
    line += ["--set", "protocol.preparation=cable"] if workflow == "restitution" else []
    result = invoke(*line)
    assert result.exit_code == 2, result.output
    said = " ".join(result.output.split())
    # 3.5 mm between 21 intervals; the front is 0.35 mm wide
    for text in ("elements = [20, 60]", "2.1 collocation points", "along X", "[29, 60] would do"):
        assert text in said
    assert not (tmp_path / "store").exists()
    shown = invoke(
        "show", *line[1:2], *line[6:], "--set", "electrophysiology.allow_coarse_mesh=true"
    )
    assert shown.exit_code == 0, shown.output


def test_a_mesh_may_be_too_coarse_across_the_film() -> None:
    result = invoke("show", "spiral-wave", "--set", "electrophysiology.elements=[102, 4]")
    assert result.exit_code == 2
    assert "along Y" in result.output
    assert "[102, 17]" in result.output


def test_a_mesh_that_is_said_to_do_does() -> None:
    for degree in (2, 3, 4):
        least = fewest_elements(3.5, degree, 0.36)
        assert 0.36 * (least + degree - 1) / 3.5 >= 3.0 > 0.36 * (least + degree - 2) / 3.5


def test_going_on_with_a_coarse_mesh_changes_no_key() -> None:
    plain, allowed = (
        Request.read("spiral-wave", None, settings_).nodes()["electrophysiology"].config
        for settings_ in ([], ["electrophysiology.allow_coarse_mesh=true"])
    )
    assert canonical(plain) == canonical(allowed)
