"""Curling and twitch through the command line, on small films."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from pipeline.nodes import Node
from pipeline.testing import interrupted_and_resumed
from tests.workflows.conftest import Desk, invoke
from workflows.request import Request
from workflows.stoney import modified_stoney, strip_stress

STAGES = ["geometry", "activation", "mechanics", "postprocessing"]
CURLING = """
[mechanics]
elements = [8, 3]
n_steps = 14
"""
TWITCH = """
[mechanics]
elements = [8, 3]
n_steps = 40
duration = 200.0
"""
QUANTITIES = {
    "curling": {
        "curvature": "1/mm",
        "projected_length": "mm",
        "tip_ux": "mm",
        "tip_uz": "mm",
        "turning_angle": "degree",
        "stoney_curvature": "1/mm",
        "active_stress": "kPa",
        "strip_stress": "kPa",
        "strip_share": "",
    },
    "twitch": {"max_curvature": "1/mm", "tip_ux_min": "mm", "tip_uz_max": "mm"},
}
PICTURES = {"curling": ("shapes", "curling", "stoney"), "twitch": ("shapes", "twitch")}


@pytest.fixture(scope="module", params=["curling", "twitch"])
def film(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Desk:
    """A store and a small film for each workflow."""
    desk = Desk(tmp_path_factory.mktemp(request.param), request.param)
    desk.config.write_text({"curling": CURLING, "twitch": TWITCH}[request.param])
    return desk


@pytest.fixture(scope="module")
def first(film: Desk) -> dict[str, Any]:
    """Summary of the first run in an empty store."""
    return film.run("first")


def computed(summary: dict[str, Any]) -> list[str]:
    """Stages that were not in the store."""
    return [name for name, stage in summary["stages"].items() if not stage["hit"]]


def values(summary: dict[str, Any]) -> dict[str, Any]:
    """Quantities without their units."""
    return {name: entry["value"] for name, entry in summary["quantities"].items()}


def table(folder: Path) -> dict[str, np.ndarray]:
    """Columns of ``probes.csv``."""
    rows = list(csv.reader((folder / "probes.csv").open()))
    return dict(zip(rows[0], np.array(rows[1:], dtype=float).T, strict=True))


def test_the_first_run_computes_four_stages(film: Desk, first: dict[str, Any]) -> None:
    assert first["workflow"] == film.workflow
    assert list(first["stages"]) == computed(first) == STAGES
    units = {name: entry["unit"] for name, entry in first["quantities"].items()}
    assert units == QUANTITIES[film.workflow]


def test_everything_agreed_is_in_the_output_folder(film: Desk, first: dict[str, Any]) -> None:
    names = {path.name for path in (film.folder / "first").iterdir()}
    figures = {f"{n}.{kind}" for n in PICTURES[film.workflow] for kind in ("png", "svg")}
    others = {"summary.json", "probes.csv", "film.vtkhdf", "report.html", "exports.json"}
    assert names == figures | others


def test_the_tip_is_probe_b_and_fibres_shorten(film: Desk, first: dict[str, Any]) -> None:
    found, series = values(first), table(film.folder / "first")
    assert [name for name in series if name[0] == "A"] == [
        "A.ux [mm]",
        "A.uy [mm]",
        "A.uz [mm]",
        "A.active_stress [kPa]",
        "A.fibre_stretch",
    ]
    ux, uz = series["B.ux [mm]"], series["B.uz [mm]"]
    if film.workflow == "curling":
        # ten digits are written
        assert found["tip_ux"] == pytest.approx(ux[-1], rel=1e-9)
        assert found["tip_uz"] == pytest.approx(uz[-1], rel=1e-9)
        assert found["tip_uz"] > 1.0
    else:
        assert found["tip_ux_min"] == pytest.approx(ux.min(), rel=1e-9)
        assert found["tip_uz_max"] == pytest.approx(uz.max(), rel=1e-9)
    # at rest eq. 96 gives P q (1 - (0.1/0.24)^2); shortened fibres pull less
    assert 0.9 < series["A.fibre_stretch"].min() < 1.0
    np.testing.assert_array_equal(series["A.fibre_stretch"][0], 1.0)


def test_the_moving_film_carries_its_fields(film: Desk, first: dict[str, Any]) -> None:
    with h5py.File(film.folder / "first" / "film.vtkhdf") as file:
        data = file["VTKHDF/PointData"]
        assert set(data) == {"displacement", "active_stress", "fibre_stretch"}
        steps = file["VTKHDF/Steps"]
        last = int(steps["PointOffsets"][-1])
        shown = data["active_stress"][last:]
        series = table(film.folder / "first")
        # the projected field overshoots its range near the clamp a little
        middle = series["A.active_stress [kPa]"][-1]
        assert np.median(shown) == pytest.approx(middle, rel=0.01)


def test_a_second_run_computes_nothing(film: Desk, first: dict[str, Any]) -> None:
    second = film.run("second")
    assert computed(second) == []
    assert second["quantities"] == first["quantities"]
    for file in ("probes.csv", "film.vtkhdf", "shapes.svg"):
        one, two = ((film.folder / out / file).read_bytes() for out in ("first", "second"))
        assert one == two, file


def test_a_mechanical_parameter_leaves_the_activation_alone(
    film: Desk, first: dict[str, Any]
) -> None:
    summary = film.run("softer", "--set", "mechanics.substrate.shear_modulus=600")
    assert computed(summary) == ["mechanics", "postprocessing"]


def test_another_probe_is_measured_without_computing_anything_else(
    film: Desk, first: dict[str, Any]
) -> None:
    summary = film.run("probed", "--set", "postprocessing.probes.D=[1,0.5]")
    assert computed(summary) == ["postprocessing"]
    assert "D.ux [mm]" in table(film.folder / "probed")


def test_named_probes_follow_a_longer_film(film: Desk, first: dict[str, Any]) -> None:
    settings = ("geometry.length=4.0", "geometry.width=3.0")
    config: Any = Request.read(film.workflow, overrides=settings).config
    assert config.postprocessing.probes["B"] == "tip"
    told = film.call("explain", "--set", "postprocessing.probes.D=[3.6,1]")
    assert told.exit_code == 2
    assert "probes.D = (3.6, 1) mm lies outside the film [0, 3.5] x [0, 2] mm" in told.stderr
    told = film.call("explain", "--set", "postprocessing.probes.D=tp")
    assert told.exit_code == 2
    assert "'tip'" in told.stderr


def test_a_stage_that_the_workflow_has_not_is_refused(film: Desk) -> None:
    told = film.call("electrophysiology")
    assert told.exit_code == 2
    assert f"{film.workflow} has no stage 'electrophysiology'" in told.stderr
    assert "geometry, activation, mechanics, postprocessing" in told.stderr


def test_a_stopped_run_goes_on_bit_for_bit(film: Desk) -> None:
    settings = ["mechanics.elements=[6, 3]", "mechanics.n_steps=8", "activation.peak_stress=2.0"]
    nodes = Request.read(film.workflow, film.config, settings).nodes()
    geometry = nodes["geometry"].stage.compute(nodes["geometry"].config)
    stress = nodes["activation"].stage.compute(nodes["activation"].config, geometry.mid_surface)
    node: Node[Any] = nodes["mechanics"]
    inputs = {"mid_surface": geometry.mid_surface, "laminate": geometry.laminate, "stress": stress}
    whole = node.stage.compute(node.config, **inputs)
    resumed = interrupted_and_resumed(node.stage, node.config, **inputs, after=4)
    for name in ("displacement", "fibre_stretch", "active_stress", "strain_energy"):
        np.testing.assert_array_equal(getattr(whole, name), getattr(resumed, name))


def test_the_parameters_have_sources(film: Desk) -> None:
    told = invoke("show", film.workflow).output
    for text in ("activation.peak_stress", "eq. 96", "mechanics.tension_law.prestretch", "1.14"):
        assert text in told


def test_modified_stoney_is_that_of_the_paper() -> None:
    config: Any = Request.read("curling").config
    # eq. 102 by hand: 6 (3 0.767 + 21) ln 1.24/(3 500 0.018) (4/18) (1 + 4/18)
    assert modified_stoney(config) == pytest.approx(0.3025, abs=5e-5)
    turned: Any = Request.read("curling", overrides=["geometry.fibre_angle=45"]).config
    assert strip_stress(turned, 0.3) is None


def test_the_strip_formula_inverts_the_strip() -> None:
    from workflows.stoney import plies
    from workflows.theory.bilayer import free_strip

    config: Any = Request.read("curling").config
    layers = plies(config, 7.0)
    assert layers is not None
    # the root is sought to 1e-9 of the stress
    assert strip_stress(config, free_strip(layers).curvature_x) == pytest.approx(7.0, rel=1e-8)


def test_a_film_held_otherwise_is_not_read_as_a_strip(tmp_path: Path) -> None:
    held = tmp_path / "held.toml"
    held.write_text('[mechanics.supports.far]\nkind = "hinged"\nedge = "X=L1"\n')
    config: Any = Request.read("curling", held).config
    assert strip_stress(config, 0.3) is None
    assert modified_stoney(config) is None
