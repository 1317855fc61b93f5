"""Files written from results: tables, ParaView series, and how they replace older ones."""

from __future__ import annotations

import csv
import os
import platform
import resource
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from stages.artefacts import TipPaths
from tests.workflows.synthetic import synthetic_experiment
from workflows.experiment import Experiment
from workflows.exports import beats, paraview, paraview_maps, probes, tips, vtkhdf
from workflows.exports.files import ExportError, replacing
from workflows.exports.sampling import FilmGrid
from workflows.request import output_folder
from workflows.unfinished import temporary_sibling


@pytest.fixture(scope="module")
def experiment() -> Experiment:
    return synthetic_experiment(starts=(0.0,), duration=300.0, elements=(12, 4), cells=(40, 6))


def test_the_probe_table_has_the_agreed_columns(experiment: Experiment, tmp_path: Path) -> None:
    probes.write(experiment, tmp_path)
    rows = list(csv.reader((tmp_path / "probes.csv").open()))
    expected = ["time [ms]"]
    for name in "ABC":
        expected += [f"{name}.{axis} [mm]" for axis in ("ux", "uy", "uz")]
        expected += [f"{name}.active_stress [kPa]", f"{name}.potential [mV]"]
    assert rows[0] == expected
    table = np.array(rows[1:], dtype=float)
    measures = experiment.measures
    # Ten digits are written.
    np.testing.assert_allclose(table[:, 0], measures.time, rtol=1e-9)
    np.testing.assert_allclose(table[:, 6:9], measures.displacement[:, 1], rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(table[:, 4], measures.active_stress[:, 0], rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(table[:, 15], measures.potential[:, 2], rtol=1e-9)


def test_the_paraview_series_holds_every_frame(experiment: Experiment, tmp_path: Path) -> None:
    paraview.write(experiment, tmp_path)
    deformation, measures = experiment.deformation, experiment.measures
    with h5py.File(tmp_path / "film.vtkhdf") as file:
        root = file["VTKHDF"]
        assert root.attrs["Type"] == b"UnstructuredGrid"
        steps = root["Steps"]
        assert steps.attrs["NSteps"] == deformation.time.size
        np.testing.assert_array_equal(steps["Values"], deformation.time)
        n = int(root["NumberOfPoints"][0])
        assert n == 25 * 15  # 24 cells of 0.146 mm along X, 14 of the same size across 2 mm
        assert root["Points"].shape == (n * deformation.time.size, 3)
        assert int(root["Connectivity"][...].max()) == n - 1
        assert set(root["PointData"]) == {"displacement", "potential", "active_stress"}
        frame = 40
        first = int(steps["PointOffsets"][frame])
        assert int(steps["PointDataOffsets/potential"][frame]) == first == frame * n
        tip = first + 24 * 15 + 7  # X = L1, Y = 1: probe B
        # Single precision.
        moved = measures.probe_points[1] + measures.displacement[frame, 1]
        np.testing.assert_allclose(root["Points"][tip], moved, rtol=1e-6)
        shown = root["PointData/potential"][tip]
        np.testing.assert_allclose(shown, measures.potential[frame, 1], rtol=1e-6)


def test_the_table_of_beats_has_a_row_for_every_beat_of_every_probe(
    experiment: Experiment, tmp_path: Path
) -> None:
    nan = np.nan
    measures = replace(
        experiment.measures,
        activation_times=np.array([[100.0, 568.0], [195.0, nan], [nan, nan]]),
        repolarisation_times=np.array([[420.0, 860.0], [nan, nan], [nan, nan]]),
        apd50=np.array([[280.0, 250.0], [270.0, nan], [nan, nan]]),
        apd90=np.array([[320.0, 292.0], [nan, nan], [nan, nan]]),
        peak_potential=np.array([[19.0, 18.0], [19.5, nan], [nan, nan]]),
        peak_active_stress=np.array([[11.0, 10.0], [11.5, nan], [nan, nan]]),
    )
    beats.write(Experiment(None, {"postprocessing": measures}.__getitem__), tmp_path)
    rows = list(csv.reader((tmp_path / "beats.csv").open()))
    assert rows[0] == list(beats.HEADINGS)
    assert rows[1:] == [
        ["A", "1", "100", "420", "280", "320", "nan", "19", "11"],
        ["A", "2", "568", "860", "250", "292", "148", "18", "10"],
        ["B", "1", "195", "nan", "270", "nan", "nan", "19.5", "11.5"],
    ]


def test_the_table_of_tips_has_a_row_for_every_tip_in_every_frame(
    experiment: Experiment, tmp_path: Path
) -> None:
    paths = TipPaths(
        time=np.array([430.5, 431.5]),
        number=np.ones(2),
        position=np.array([[1.5, 0.25, 0.0], [1.75, 0.5, 0.0]]),
        chirality=-np.ones(2),
        heading=np.array([10.0, 9.0]),
    )
    measures = replace(experiment.measures, tips=paths)
    tips.write(Experiment(None, {"postprocessing": measures}.__getitem__), tmp_path)
    rows = list(csv.reader((tmp_path / "tips.csv").open()))
    assert rows[0] == list(tips.HEADINGS)
    assert rows[1:] == [
        ["430.5", "1", "1.5", "0.25", "0", "-1", "10"],
        ["431.5", "1", "1.75", "0.5", "0", "-1", "9"],
    ]


def test_maps_for_paraview_hold_what_was_measured_at_the_collocation_points(
    experiment: Experiment, tmp_path: Path
) -> None:
    paraview_maps.write(experiment, tmp_path)
    patch, history = experiment.geometry.excitable_surface.patch, experiment.history
    with h5py.File(tmp_path / "maps.vtkhdf") as file:
        root = file["VTKHDF"]
        np.testing.assert_array_equal(root["Steps/Values"], [1.0])  # one beat
        assert set(root["PointData"]) == set(paraview_maps.FIELDS)
        places = patch.evaluate(*(space.greville() for space in patch.spaces))
        np.testing.assert_allclose(root["Points"], places, rtol=1e-6)
        shown = root["PointData/activation_times"]
        np.testing.assert_allclose(shown, history.activation_times[:, 0], rtol=1e-6)
        np.testing.assert_allclose(root["PointData/conduction_velocity"][:, 0], 0.0175, rtol=1e-6)
        assert np.isnan(root["PointData/apd50"]).all()
    silent = replace(history, **{n: getattr(history, n)[:, :0] for n in paraview_maps.FIELDS})
    records = {"geometry": experiment.geometry, "electrophysiology": silent}
    paraview_maps.write(Experiment(None, records.__getitem__), tmp_path)
    with h5py.File(tmp_path / "maps.vtkhdf") as file:
        assert np.isnan(file["VTKHDF/PointData/activation_times"]).all()


def test_the_paraview_file_is_the_same_every_time(experiment: Experiment, tmp_path: Path) -> None:
    (tmp_path / "again").mkdir()
    for folder in (tmp_path, tmp_path / "again"):
        paraview.write(experiment, folder)
    first, second = (tmp_path / part / "film.vtkhdf" for part in ("", "again"))
    assert first.read_bytes() == second.read_bytes()


def test_cells_turn_counter_clockwise_seen_from_above(experiment: Experiment) -> None:
    grid = FilmGrid.square(experiment, 24)
    x, y = grid.reference.reshape(-1, 3)[:, :2].T
    corners = vtkhdf.quads(grid.shape)
    ahead = np.roll(corners, -1, axis=1)
    area = 0.5 * (x[corners] * y[ahead] - x[ahead] * y[corners]).sum(axis=1)
    assert (area > 0).all()
    assert area.sum() == pytest.approx(7.0, rel=1e-12)


@pytest.mark.parametrize(("along", "across"), [(100, 58), (24, 14), (2, 2)])
def test_the_probes_are_points_of_the_grid(along: int, across: int, experiment: Experiment) -> None:
    grid = FilmGrid.square(experiment, along)
    assert grid.shape == (along + 1, across + 1)
    points = grid.reference.reshape(-1, 3)
    for probe in experiment.measures.probe_points:
        # Splines with degree 2 give a linear field up to rounding.
        assert np.linalg.norm(points - probe, axis=1).min() < 1e-14


def test_fields_of_both_meshes_are_sampled_at_the_same_material_points(
    experiment: Experiment,
) -> None:
    grid = FilmGrid.square(experiment, 14)
    patch = experiment.geometry.excitable_surface.patch
    places = patch.evaluate(*(space.greville() for space in patch.spaces))
    # X at the collocation points, sampled as a field, is X of the film: both are in their spaces.
    np.testing.assert_allclose(grid.cell_field(places[:, 0]), grid.reference[..., 0], atol=1e-13)


@contextmanager
def files_up_to(size: int) -> Iterator[None]:
    """Writing more than this into one file fails, as it does on a full disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.parametrize(
    ("write", "name"), [(probes.write, "probes.csv"), (paraview.write, "film.vtkhdf")]
)
def test_a_disk_without_room_is_told_with_the_path_and_what_to_do(
    write: Callable[[Experiment, Path], None], name: str, experiment: Experiment, tmp_path: Path
) -> None:
    with files_up_to(1000), pytest.raises(ExportError) as caught:
        write(experiment, tmp_path)
    assert str(caught.value) == (
        f"cannot write {tmp_path / name}: file too large\n"
        "Remedy: run again with --out elsewhere; all results are kept, and nothing is computed again"
    )
    assert not list(tmp_path.iterdir())


def test_a_file_that_cannot_be_read_is_not_taken_for_the_one_that_is_written(
    tmp_path: Path,
) -> None:
    with pytest.raises(FileNotFoundError), replacing(tmp_path / "table.csv"):
        (tmp_path / "store").read_text()


def test_a_failed_write_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text("old")

    def fail() -> None:
        with replacing(path) as temporary:
            temporary.write_text("half of the ne")
            raise RuntimeError("disk full")

    with pytest.raises(RuntimeError):
        fail()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


KILLED = """
import os, signal, sys
from pathlib import Path
from workflows.unfinished import temporary_sibling
temporary_sibling(Path(sys.argv[1], "fig8.png")).write_text("half")
folder = temporary_sibling(Path(sys.argv[1], "sweep.zarr"))
folder.mkdir()
(folder / "zarr.json").write_text("{")
folder.with_suffix(".former").mkdir()
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_the_next_run_removes_what_a_killed_one_left_half_written(tmp_path: Path) -> None:
    subprocess.run([sys.executable, "-c", KILLED, str(tmp_path)], check=False)
    assert len(list(tmp_path.iterdir())) == 3
    mine = temporary_sibling(tmp_path / "fig8.png")  # of a process that lives
    elsewhere = tmp_path / f".fig8.another-{platform.node()}.4711.png"  # nobody can tell here
    others = [mine, elsewhere, tmp_path / "fig8.png", tmp_path / f".notes.{os.getpid()}.txt"]
    for path in others:
        path.touch()
    output_folder(tmp_path)
    assert sorted(tmp_path.iterdir()) == sorted(others)
