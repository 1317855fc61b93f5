"""Workflows restitution and vulnerable-window through the command line."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pipeline.canonical import canonical
from pipeline.errors import InputError
from stages.paced_artefacts import PacedBeats
from tests.workflows.conftest import invoke
from workflows.request import Request
from workflows.restitution import largest_slope, shortest_interval

RESTITUTION = (
    "electrophysiology.n_steps=6000",
    "protocol.count=1",
    "protocol.intervals=[200, 360, 450]",
    "protocol.periods=[500]",
    "protocol.tolerance=50",
)
WINDOW = (
    "electrophysiology.elements=[28, 16]",
    "electrophysiology.n_steps=4000",
    "protocol.times=[400, 480, 600]",
    "protocol.tolerance=30",
)


def line(workflow: str, folder: Path, *settings: str) -> list[str]:
    """Arguments of a run in a folder."""
    where = ["--store", str(folder / "store"), "--out", str(folder / "out")]
    return ["run", workflow, *where, *(part for one in settings for part in ("--set", one))]


def summary(folder: Path) -> dict[str, Any]:
    """What a run has left."""
    found: dict[str, Any] = json.loads((folder / "out" / "summary.json").read_text())
    return found


def test_a_cell_is_paced_and_its_curve_written(tmp_path: Path) -> None:
    result = invoke(*line("restitution", tmp_path, *RESTITUTION))
    assert result.exit_code == 0, result.output
    found = summary(tmp_path)
    assert list(found["stages"]) == ["restitution"]
    value = {name: entry["value"] for name, entry in found["quantities"].items()}
    assert value["interval"][0] == 200.0
    assert value["interval"][-1] == 450.0
    assert value["apd90"][0] is None
    assert 360.0 < value["shortest_interval"] <= 450.0
    # Fig. C.2 with 20 mV/ms: 340.95 ms, by an independent integrator
    assert value["s1_apd90"] == pytest.approx([340.95], abs=0.01)
    rows = list(csv.reader((tmp_path / "out" / "restitution.csv").open()))
    assert rows[0][:3] == ["interval [ms]", "activation_time [ms]", "diastolic_interval [ms]"]
    assert len(rows) == 1 + len(value["interval"])
    assert len(list(csv.reader((tmp_path / "out" / "steady.csv").open()))) == 2
    assert (tmp_path / "out" / "restitution.png").read_bytes().startswith(b"\x89PNG")
    again = invoke(*line("restitution", tmp_path, *RESTITUTION))
    assert again.exit_code == 0
    assert summary(tmp_path)["stages"]["restitution"]["hit"] is True


def test_what_does_not_concern_the_preparation_leaves_the_result_alone(tmp_path: Path) -> None:
    invoke(*line("restitution", tmp_path, *RESTITUTION))
    key = summary(tmp_path)["stages"]["restitution"]["key"]
    other = (*RESTITUTION, "protocol.pulses.cable.flux=3.0", "geometry.length=4.0")
    invoke(*line("restitution", tmp_path, *other))
    assert summary(tmp_path)["stages"]["restitution"]["key"] == key


def test_the_window_is_found_and_drawn(tmp_path: Path) -> None:
    result = invoke(*line("vulnerable-window", tmp_path, *WINDOW))
    assert result.exit_code == 0, result.output
    found = summary(tmp_path)
    assert list(found["stages"]) == ["geometry", "vulnerable_window"]
    value = {name: entry["value"] for name, entry in found["quantities"].items()}
    assert 400.0 < value["window_start"] <= 480.0 <= value["window_end"] < 600.0
    assert value["window_length"] == value["window_end"] - value["window_start"]
    assert value["outcome"][0] == 0.0
    assert value["outcome"][-1] == 1.0
    assert len(value["C.activation_count"]) == len(value["time"])
    rows = list(csv.reader((tmp_path / "out" / "vulnerable-window.csv").open()))
    assert rows[0][-1] == "C.activations"
    assert len(rows) == 1 + len(value["time"])
    assert (tmp_path / "out" / "vulnerable-window.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("workflow", "setting", "expected"),
    [
        (
            "restitution",
            "electrophysiology.stimuli=S1",
            ("electrophysiology.stimuli", "protocol.pulses"),
        ),
        ("restitution", "protocol.intervals=[300, 200]", ("intervals", "200 ms follows 300 ms")),
        ("restitution", "protocol.intervals=[]", ("intervals", "at least one")),
        ("restitution", "protocol.intervals=[1, 200]", ("pulses of 2 ms overlap", "intervals")),
        ("restitution", "protocol.preparation=cabel", ("preparation", "cell", "cable")),
        ("restitution", "protocol.pulses.cell.repeats=2", ("pulses.cell", "period")),
        (
            "restitution",
            "protocol.pulses.cell={repeats=2, period=500}",
            ("pulses.cell.repeats is 2", "protocol.count"),
        ),
        ("restitution", "protocol.period=0", ("period", "greater than 0")),
        ("vulnerable-window", "electrophysiology.stimuli=S1", ("stimuli", "two or more", "S3")),
        ("vulnerable-window", "protocol.times=[-5.0, 3.0]", ("times", "0 ms or more", "-5")),
        ("vulnerable-window", "protocol.least_share=1.5", ("least_share", "less than 1")),
        ("vulnerable-window", "protocol.probes.D=[4.0, 1.0]", ("protocol.probes.D", "outside")),
    ],
)
def test_misfits_are_refused_before_anything_is_computed(
    workflow: str, setting: str, expected: tuple[str, ...], tmp_path: Path
) -> None:
    result = invoke(*line(workflow, tmp_path, setting))
    assert result.exit_code == 2, result.output
    said = " ".join(result.output.split())
    for text in expected:
        assert text in said
    assert not (tmp_path / "store").exists()


TUBE = 'geometry.shape={name="tube", axis="X"}'
STRIP = ("protocol.preparation=cable", "geometry.width=1.0", "electrophysiology.elements=[102, 9]")


@pytest.mark.parametrize(
    ("workflow", "settings", "expected"),
    [
        ("restitution", (*STRIP, "protocol.pulses.cable.edge=Y=0"), "cable: there is no edge Y=0"),
        ("restitution", (*STRIP, "electrophysiology.elements=[102, 2]"), "too few around a tube"),
        ("vulnerable-window", (), "stimuli.1: there is no edge Y=0"),
        (
            "vulnerable-window",
            ("electrophysiology.stimuli.1.edge=X=L1", "electrophysiology.elements=[51, 4]"),
            "too few around a tube",
        ),
    ],
)
def test_what_a_tube_does_not_allow_is_refused(
    workflow: str, settings: tuple[str, ...], expected: str, tmp_path: Path
) -> None:
    result = invoke(*line(workflow, tmp_path, TUBE, *settings))
    assert result.exit_code == 2, result.output
    assert expected in " ".join(result.output.split())


def test_tubes_may_be_paced(tmp_path: Path) -> None:
    settings = (*STRIP, "electrophysiology.n_steps=3000", "electrophysiology.scheme=strang")
    short = ("protocol.count=1", "protocol.intervals=[600]", "protocol.periods=[]")
    result = invoke(*line("restitution", tmp_path, TUBE, *settings, *short))
    assert result.exit_code == 0, result.output
    (speed,) = summary(tmp_path)["quantities"]["conduction_velocity"]["value"]
    assert 0.014 < speed < 0.0175  # below that of the front at rest


def test_the_window_counts_the_run_from_the_first_stimulus_and_the_watch_from_the_last() -> None:
    """A train that is longer than each case is watched, and a last stimulus that starts wherever."""
    train = "electrophysiology.stimuli.0={name='S1', repeats=4, period=400}"
    late = "protocol.times=[1600, 1700]"
    one, other = (
        Request.read(
            "vulnerable-window", None, [train, late, f"electrophysiology.stimuli.1.start={start}"]
        ).nodes()["vulnerable_window"]
        for start in (0, 1000)
    )
    assert canonical(one.config) == canonical(other.config)
    with pytest.raises(InputError, match=r"stimuli.0: the last of 4 pulses .* ends at 1190 ms"):
        Request.read("vulnerable-window", None, [train, "protocol.times=[390]"])


def test_a_window_beside_the_strip_is_refused(tmp_path: Path) -> None:
    settings = ("protocol.preparation=cable", "protocol.window=[1.0, 9.0]")
    result = invoke(*line("restitution", tmp_path, *settings))
    assert result.exit_code == 2
    assert "protocol.window" in result.output


def beats(interval: list[float], rest: list[float], apd: list[float]) -> PacedBeats:
    """Beats of which only these are known; an APD of NaN: no beat."""
    columns = [np.array(values) for values in (interval, rest, apd)]
    made = np.where(np.isnan(columns[2]), np.nan, 4.0)
    nothing = np.zeros((made.size, 0))
    return PacedBeats(columns[0], made, columns[1], made, columns[2], made, made, nothing, nothing)


def test_the_shortest_interval_lies_behind_the_last_case_without_a_beat() -> None:
    nan = float("nan")
    assert shortest_interval(beats([1, 2, 3, 4], [1, 2, 3, 4], [nan, 9, nan, 9])) == 4.0
    assert shortest_interval(beats([1, 2], [1, 2], [8, 9])) is None
    assert shortest_interval(beats([1, 2], [1, 2], [nan, nan])) is None


def test_a_slope_counts_where_the_rest_follows_the_interval() -> None:
    # slopes 30 (left out: the rest grows by 1 only), 2 and 0.5
    found = largest_slope(beats([0, 10, 20, 30], [5, 6, 16, 26], [10, 40, 60, 65]))
    assert found == pytest.approx(2.0)
    assert largest_slope(beats([0], [5], [10])) is None
