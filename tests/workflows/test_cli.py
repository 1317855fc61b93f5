"""Commands that compute nothing, and how errors end."""

from __future__ import annotations

import errno
from pathlib import Path

import pytest

from pipeline.errors import StageError
from tests.workflows.conftest import invoke


def test_the_workflows_are_listed() -> None:
    result = invoke("list")
    assert result.exit_code == 0
    names = [line.split()[0] for line in result.output.splitlines()]
    assert names == [
        "curling",
        "twitch",
        "planar-waves",
        "spiral-wave",
        "restitution",
        "vulnerable-window",
        "verification",
    ]


def test_every_parameter_is_shown_with_unit_and_source() -> None:
    result = invoke("show", "planar-waves", "--set", "mechanics.damping=1.5")
    lines = {line.split()[0]: line for line in result.output.splitlines() if "." in line}
    assert lines["geometry.substrate_thickness"].split()[1:3] == ["0.018", "mm"]
    assert lines["mechanics.damping"].split()[1] == "1.5"
    assert "Table 3" in lines["electrophysiology.tension_law.k_sigma"]
    assert "[102, 60]" in lines["electrophysiology.elements"]
    assert "[1.75, 1]" in lines["postprocessing.probes.A"]


def test_what_is_picked_by_name_is_shown_with_the_names_on_offer() -> None:
    result = invoke("show", "curling")
    lines = {line.split()[0]: line for line in result.output.splitlines() if "." in line}
    assert "one of: clamped, clamped-normal, disp" in lines["mechanics.supports.clamp.kind"]
    assert "one of: constant, ramp" in lines["activation.time_law.name"]
    assert "kind one of: area, edge-moment" in lines["mechanics.loads"]  # there are none yet
    assert "name one of: holzapfel-ogden" in lines["mechanics.materials"]


@pytest.mark.parametrize("width", [50, 80, 130])
def test_parameters_fit_the_terminal(width: int, monkeypatch: pytest.MonkeyPatch) -> None:
    plain = invoke("show", "planar-waves").output
    monkeypatch.setattr("workflows.commands.on_terminal", lambda: True)
    monkeypatch.setenv("COLUMNS", str(width))
    fitted = invoke("show", "planar-waves").output
    title, *lines = fitted.splitlines()
    assert title == plain.splitlines()[0]
    assert max(len(line) for line in lines) <= width
    assert sorted(fitted.split()) == sorted(plain.split())  # nothing is lost


def test_a_stage_tells_where_its_result_is_and_copies_nothing_for_that(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    url, out = (tmp_path / "shared").as_uri(), tmp_path / "out"
    for machine in ("one", "other"):
        monkeypatch.setenv("MYOFILM_CACHE", str(tmp_path / machine))
        result = invoke("geometry", "twitch", "--store", url, "--out", out)
        assert f"result   {url}/objects/shell_geometry/" in result.output
    assert list(tmp_path.glob("one/remote/*/artefacts/shell_geometry-*"))
    assert not list(tmp_path.glob("other/remote/*/artefacts/shell_geometry-*"))
    there = tmp_path / "store"
    assert (
        f"result   {there}" in invoke("geometry", "twitch", "--store", there, "--out", out).output
    )


def test_a_unit_may_be_given_with_a_parameter() -> None:
    result = invoke("show", "planar-waves", "--set", 'geometry.substrate_thickness="20 um"')
    assert " 0.02 " in result.output


def test_the_figures_are_listed() -> None:
    result = invoke("reproduce")
    names = [line.split()[0] for line in result.output.splitlines()]
    assert names[:7] == [f"fig{number}" for number in range(3, 10)]


def test_an_empty_store_is_no_error(tmp_path: Path) -> None:
    result = invoke("store", "ls", "--store", tmp_path / "nothing")
    assert result.exit_code == 0
    assert "holds no results" in result.output
    assert not (tmp_path / "nothing").exists()


def test_an_empty_variable_counts_as_unset(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("platformdirs.user_cache_dir", lambda name: str(tmp_path / name))
    monkeypatch.setenv("MYOFILM_STORE", "")
    assert str(tmp_path / "myofilm") in invoke("store", "ls").output
    monkeypatch.setenv("MYOFILM_STORE", str(tmp_path / "mine"))
    assert str(tmp_path / "mine") in invoke("store", "ls").output


def test_explaining_computes_nothing(tmp_path: Path) -> None:
    result = invoke("explain", "planar-waves", "--store", tmp_path / "store")
    assert result.exit_code == 0
    assert [line.split()[1] for line in result.output.splitlines()] == ["miss:"] * 5
    assert not (tmp_path / "store").exists()


def fail_with(monkeypatch: pytest.MonkeyPatch, error: BaseException) -> None:
    """Make the runner raise."""

    def run(*args: object, **kwargs: object) -> None:
        raise error

    monkeypatch.setattr("pipeline.runner.run", run)


def test_a_failed_stage_ends_with_one(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    error = StageError("mechanics", "no convergence", place="t = 5 ms", remedy="halve the step")
    fail_with(monkeypatch, error)
    result = invoke("run", "planar-waves", "--out", tmp_path, "--store", tmp_path / "store")
    assert result.exit_code == 1
    assert result.stderr == (
        "Error: stage mechanics failed at t = 5 ms: no convergence\nRemedy: halve the step\n"
    )


@pytest.mark.parametrize("place", [0, 2])
def test_the_traceback_is_shown_on_demand(
    place: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    fail_with(monkeypatch, StageError("mechanics", "no convergence"))
    line: list[object] = ["run", "planar-waves", "--out", tmp_path, "--store", tmp_path / "store"]
    result = invoke(*line[:place], "--traceback", *line[place:])
    assert result.exit_code == 1
    assert "Traceback (most recent call last)" in result.stderr
    assert result.stderr.endswith("\nError: stage mechanics failed: no convergence\n")


def test_the_traceback_leaves_the_exit_code_of_bad_input() -> None:
    result = invoke("show", "planar-waves", "--set", "geometry.length=-1", "--traceback")
    assert result.exit_code == 2
    assert "Traceback (most recent call last)" in result.stderr
    assert "Error: " in result.stderr
    assert "greater than 0" in result.stderr


def test_a_full_disk_is_told_in_one_line(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    fail_with(monkeypatch, OSError(errno.ENOSPC, "No space left on device", "/out/film.vtkhdf"))
    result = invoke("run", "planar-waves", "--out", tmp_path, "--store", tmp_path / "store")
    assert result.exit_code == 1
    assert result.stderr == (
        "Error: no space left on device: /out/film.vtkhdf. Results computed so far are kept.\n"
    )


def test_a_mistake_of_the_program_is_said_to_be_one(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    fail_with(monkeypatch, ZeroDivisionError("division by zero"))
    result = invoke("run", "planar-waves", "--out", tmp_path, "--store", tmp_path / "store")
    assert result.exit_code == 1
    assert "unexpected ZeroDivisionError: division by zero" in result.stderr
    assert "--traceback" in result.stderr
    assert "Traceback" not in result.output


def test_ctrl_c_ends_with_130_and_says_how_to_go_on(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    fail_with(monkeypatch, KeyboardInterrupt())
    result = invoke("run", "planar-waves", "--out", tmp_path, "--store", tmp_path / "store")
    assert result.exit_code == 130
    assert "the same command goes on from there" in result.stderr


def test_quiet_and_verbose_contradict_each_other() -> None:
    result = invoke("list", "--quiet", "--verbose")
    assert result.exit_code == 2
    assert "contradict" in result.output
