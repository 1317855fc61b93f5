"""Films that buckle and snap, through the command line with the files that the docs print."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from tests.workflows.conftest import Desk

DOCS = Path(__file__).parents[2] / "docs" / "stability.md"
SNAP, SQUEEZE = re.findall(r"```toml\n(.*?)```", DOCS.read_text(), flags=re.DOTALL)
ARC = ("mechanics.control.kind=arc-length", "mechanics.control.preload=20")


def run(desk: Desk, out: str, *overrides: str) -> dict[str, Any]:
    return desk.run(out, *(word for override in overrides for word in ("--set", override)))


def desk_with(folder: Path, text: str) -> Desk:
    folder.mkdir(exist_ok=True)
    desk = Desk(folder, "curling")
    desk.config.write_text(text)
    return desk


def values(summary: dict[str, Any]) -> dict[str, Any]:
    return {name: entry["value"] for name, entry in summary["quantities"].items()}


def test_a_path_by_arc_length_is_numbered_and_drawn_against_its_load_factor(tmp_path: Path) -> None:
    desk = desk_with(tmp_path, SNAP)
    # up to where the point passes the plane of the film, on a coarse mesh
    end = '{position = [1.6, 0.25], component = "z", displacement = 0.0}'
    few = ("mechanics.elements=[8,1]", f"mechanics.control.until={end}")
    found = values(run(desk, "arc", *ARC, *few))
    assert found["load_factor"] < found["limit_loads"][0]
    assert len(found["limit_loads"]) == 1
    assert found["unstable_directions"] >= 1.0
    folder = desk.folder / "arc"
    with open(folder / "probes.csv", newline="") as file:
        rows = list(csv.reader(file))
    assert rows[0][:2] == ["point", "load_factor"]
    points = np.array([[float(x) for x in row[:2]] for row in rows[1:]])
    np.testing.assert_array_equal(points[:, 0], np.arange(len(points)))
    assert np.diff(points[:, 1]).min() < 0.0 < np.diff(points[:, 1]).max()
    with h5py.File(folder / "film.vtkhdf") as file:
        root = file["VTKHDF"]
        assert root["Steps"].attrs["NSteps"] == len(points)
        load = root["PointData/load_factor"][:].reshape(len(points), -1)
    # single precision in the file
    np.testing.assert_allclose(load, points[:, 1:] * np.ones(load.shape), rtol=1e-6, atol=1e-9)
    assert not (folder / "modes.png").exists()


def test_modes_come_with_a_picture_and_leave_the_shapes_alone(tmp_path: Path) -> None:
    desk = desk_with(tmp_path, SQUEEZE)
    coarse = ("mechanics.elements=[8,2]", "mechanics.n_steps=2")
    with_modes = run(desk, "film", *coarse)
    factors = values(with_modes)["buckling_factors"]
    # the docs' 16 x 6 elements; half as many bend too stiffly by some per cent
    assert factors[0] == pytest.approx(1.398, rel=0.06)
    assert len(factors) == 4
    folder = desk.folder / "film"
    with h5py.File(folder / "modes.vtkhdf") as file:
        assert file["VTKHDF/Steps"].attrs["NSteps"] == 4
    assert (folder / "modes.png").exists()
    assert "modes.vtkhdf" in (folder / "report.html").read_text()

    without = run(desk, "film", *coarse, "mechanics.buckling_modes=0")
    assert without["stages"]["mechanics"]["hit"]
    assert "buckling" not in without["stages"]
    assert not (folder / "modes.png").exists()
    assert "modes.png" not in json.loads((folder / "exports.json").read_text())


@pytest.mark.slow
def test_the_docs_tell_what_these_films_do(tmp_path: Path) -> None:
    snap = values(run(desk_with(tmp_path / "snap", SNAP), "arc", *ARC))
    np.testing.assert_allclose(snap["limit_loads"], [0.0631, -0.0352, 0.0622, -0.0111], atol=1e-4)
    assert (snap["load_factor"], snap["unstable_directions"]) == (1.0, 0.0)
    squeezed = values(run(desk_with(tmp_path / "squeeze", SQUEEZE), "film"))
    np.testing.assert_allclose(squeezed["buckling_factors"], [1.398, 4.38, 4.649, 7.671], rtol=5e-4)
