"""Figures: written in both formats, the same bytes every time, for long and short runs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.workflows.synthetic import synthetic_experiment
from workflows.experiment import Experiment
from workflows.figures import activation_maps, snapshots, traces

FIGURES = ("fig8", "fig9", "activation_maps")


@pytest.fixture(scope="module")
def experiment() -> Experiment:
    return synthetic_experiment(starts=(0.0,), duration=60.0, elements=(8, 3), cells=(20, 5))


def test_the_figures_are_the_same_bytes_every_time(experiment: Experiment, tmp_path: Path) -> None:
    names = [f"{figure}.{kind}" for figure in FIGURES for kind in ("png", "svg")]
    written = []
    for _ in range(2):
        snapshots.write(experiment, tmp_path, "fig8")
        traces.write(experiment, tmp_path, "fig9")
        activation_maps.write(experiment, tmp_path)
        written.append([(tmp_path / name).read_bytes() for name in names])
    assert written[0] == written[1]
    assert all(data.startswith(b"\x89PNG") for data in written[0][::2])
    assert all(b"</svg>" in data for data in written[0][1::2])


@pytest.mark.parametrize("fired", [0.0, 0.5, 1.0], ids=["nowhere", "in one half", "everywhere"])
def test_maps_are_drawn_wherever_there_are_beats(
    fired: float, experiment: Experiment, tmp_path: Path
) -> None:
    history = experiment.history
    times = np.array(history.activation_times)
    times[int(fired * len(times)) :] = np.nan
    velocity = np.where(np.isnan(times)[..., None], np.nan, history.conduction_velocity)
    part = replace(
        history,
        activation_times=times,
        apd90=np.full_like(times, np.nan),
        conduction_velocity=velocity,
    )
    records = {"geometry": experiment.geometry, "electrophysiology": part}
    activation_maps.write(Experiment(None, records.__getitem__), tmp_path)
    picture = (tmp_path / "activation_maps.svg").read_text()
    assert ("<!-- (a)  beat 1 -->" in picture) == (fired > 0.0)


def test_several_runs_are_named_in_the_figure(experiment: Experiment, tmp_path: Path) -> None:
    measures = experiment.measures
    traces.draw({"S1 and S2": measures, "S1 alone": measures}, tmp_path, "fig9")
    both = (tmp_path / "fig9.svg").read_text()
    traces.draw({"": measures}, tmp_path, "fig9")
    one = (tmp_path / "fig9.svg").read_text()
    assert "<!-- S1 alone -->" in both
    assert "<!-- S1 alone -->" not in one


def test_the_papers_times_are_shown_when_the_run_covers_them() -> None:
    times = snapshots.PAPER_TIMES["fig8"]
    assert snapshots.snapshot_times(times, 875.0) == (0.0, 100.0, 435.0, 575.0, 775.0, 875.0)
    assert snapshots.snapshot_times(times, 874.0)[-1] == 874.0


def test_the_spiral_has_eight_films_and_the_corner(experiment: Experiment, tmp_path: Path) -> None:
    snapshots.write(experiment, tmp_path, "fig10")
    assert "(h)" in (tmp_path / "fig10.svg").read_text()
    assert "(i)" not in (tmp_path / "fig10.svg").read_text()
    traces.write(experiment, tmp_path, "fig11")
    legend = (tmp_path / "fig11.svg").read_text()
    assert "<!-- A: X" in legend
    assert "<!-- C: X" in legend
    assert "<!-- B: X" not in legend


def test_probes_of_any_name_can_be_drawn(tmp_path: Path) -> None:
    experiment = synthetic_experiment((0.0,), 20.0, (6, 2), (8, 3))
    renamed = replace(experiment.measures, probe_names=("left", "middle", "right"))
    traces.draw({"": renamed}, tmp_path, "fig9")
    assert "<!-- left: X" in (tmp_path / "fig9.svg").read_text()
