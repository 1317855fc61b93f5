"""Films that are not flat, from the command line to the pictures."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stages.geometry.shapes.base import AnyShape
from tests.workflows.conftest import SMALL, invoke
from tests.workflows.test_bad_input import refused

CYLINDER = '{name = "cylinder", radius = 1.5, axis = "Y"}'
SPHERE = '{name = "sphere-segment", radius = 2.0}'
TUBE = '{name = "tube", axis = "X"}'


def run(workflow: str, shape: str, folder: Path, *settings: str) -> dict[str, Any]:
    if workflow == "planar-waves":
        (folder / "small.toml").write_text(SMALL)
        settings = (*settings, "geometry.width=1.0", "postprocessing.mid_axis=middle")
        settings = (*settings, "postprocessing.probes.A=centre", "postprocessing.probes.B=tip")
        settings = (*settings, "postprocessing.probes.C=corner")
        files = ("--config", folder / "small.toml")
    else:
        files = ()
    sets = [part for text in (f"geometry.shape={shape}", *settings) for part in ("--set", text)]
    where = ("--store", folder / "store", "--out", folder / "out", "--quiet")
    result = invoke("run", workflow, *files, *sets, *where)
    assert result.exit_code == 0, result.output
    summary: dict[str, Any] = json.loads((folder / "out" / "summary.json").read_text())
    return summary


@pytest.mark.parametrize("shape", [CYLINDER, SPHERE, TUBE], ids=["cylinder", "sphere", "tube"])
def test_waves_beat_a_film_of_any_shape(shape: str, tmp_path: Path) -> None:
    found = run("planar-waves", shape, tmp_path)["quantities"]
    assert len(found["B.activation_times"]["value"]) == 1
    assert found["max_curvature"]["value"] is None
    assert (tmp_path / "out" / "film.vtkhdf").exists()
    assert (tmp_path / "out" / "fig8.png").exists()
    assert "not flat at rest" in (tmp_path / "out" / "report.html").read_text()


def test_a_tube_that_contracts_around_stays_round(tmp_path: Path) -> None:
    """Fibres around it, clamped at one end: by symmetry all points of a section move inwards alike."""
    places = {"s": (3.0, 0.0), "a": (3.0, 0.5), "b": (3.0, 1.0), "c": (3.0, 1.61)}
    summary = run(
        "curling",
        TUBE,
        tmp_path,
        "geometry.fibre_angle=90",
        "mechanics.elements=[8, 20]",
        "mechanics.n_steps=2",
        "activation.peak_stress=3",
        *(f"postprocessing.probes.{name}=[{x}, {y}]" for name, (x, y) in places.items()),
    )
    assert summary["quantities"]["curvature"]["value"] is None
    names, *rows = (tmp_path / "out" / "probes.csv").read_text().splitlines()
    last = dict(zip(names.split(","), map(float, rows[-1].split(",")), strict=True))
    radial = []
    for name, (_, y) in places.items():
        angle = 2.0 * np.pi * (y / 2.0 - 0.5)
        across, up = last[f"{name}.uy [mm]"], last[f"{name}.uz [mm]"]
        radial.append(across * np.sin(angle) - up * np.cos(angle))
        assert abs(across * np.cos(angle) + up * np.sin(angle)) < 2e-2 * abs(radial[-1])
    assert max(radial) < 0
    # a quadratic spline of 20 spans is round to h^4/128 = 8e-5, but bends by spans
    np.testing.assert_allclose(radial, np.mean(radial), rtol=2e-2)


@pytest.mark.parametrize(
    ("settings", "parts"),
    [
        (
            ("geometry.shape=tube",),
            ["geometry.shape.axis", "missing"],
        ),
        (
            (f"geometry.shape={TUBE}", "electrophysiology.stimuli.0.edge=Y=0"),
            ["electrophysiology.stimuli.0: there is no edge Y=0", "tube", "X=0 and X=L1"],
        ),
        (
            (f"geometry.shape={TUBE.replace('X', 'Y')}", "electrophysiology.stimuli.0.edge=Y=0"),
            ["mechanics.supports.clamp: there is no edge X=0"],
        ),
        (
            ('geometry.shape={name="cylinder", radius=0.4, axis="Y"}',),
            ["1.39 times around a cylinder", "radius must be above 0.557 mm"],
        ),
        (
            (f"geometry.shape={TUBE}", "mechanics.elements=[20, 2]"),
            ["mechanics.elements: 2 elements along Y are too few around a tube", "need 3 at least"],
        ),
        (("geometry.shape=sphere",), ["did you mean 'sphere-segment'?"]),
    ],
)
def test_a_film_that_cannot_be_is_refused(settings: tuple[str, ...], parts: list[str]) -> None:
    sets = [part for text in settings for part in ("--set", text)]
    refused(invoke("show", "planar-waves", *sets), *parts)


def test_the_printed_shapes_are_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = (Path(__file__).parents[2] / "docs" / "films.md").read_text()
    lines = [f"{i},{j},{1.75 * i},{j},0.1\n" for i in range(3) for j in range(3)]
    (tmp_path / "surface.csv").write_text("".join(lines))
    monkeypatch.chdir(tmp_path)
    commands = re.findall(r"^myofilm run (\S+) --set '(geometry.shape=.*)'$", page, re.MULTILINE)
    assert len(commands) == 4
    for workflow, setting in commands:
        result = invoke("show", workflow, "--set", setting)
        assert result.exit_code == 0, result.output
    assert all(f"`{name}`" in page for name in AnyShape.__metadata__[0].names())
