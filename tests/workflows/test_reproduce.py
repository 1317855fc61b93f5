"""Figures of several runs, on films small enough for tests."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from pipeline.runner import run
from pipeline.store import LocalStore
from tests.workflows.conftest import invoke
from workflows.experiment import Experiment
from workflows.exports.outputs import experiment_of
from workflows.figures import dynamic, quasi_static, stoney_bias
from workflows.figures.catalogue import FIGURES
from workflows.figures.parametric import PULSE, Run
from workflows.request import Request
from workflows.workflow import Quantity

SMALL = ("mechanics.elements=[6, 3]", "mechanics.n_steps=8")
SHORT = ("mechanics.n_steps=40", "mechanics.duration=200.0")


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> LocalStore:
    return LocalStore(tmp_path_factory.mktemp("reproduce") / "store")


def experiments(store: LocalStore, runs: Mapping[str, Run]) -> dict[str, Experiment]:
    """Results of runs, by label."""
    found = {}
    for label, one in runs.items():
        request = Request.read(one.workflow, None, [*SMALL, *one.overrides], one.defaults)
        found[label] = experiment_of(request, run(request.nodes(), store))
    return found


def peak(stress: float) -> str:
    """Override of the peak stress."""
    return f"activation.peak_stress={stress}"


def written(folder: Path, name: str) -> list[list[str]]:
    """Rows of a table; both pictures are there, too."""
    assert (folder / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    assert "</svg>" in (folder / f"{name}.svg").read_text()
    return list(csv.reader((folder / f"{name}.csv").open()))


def listed(quantity: Quantity) -> list[Any]:
    assert isinstance(quantity.value, list)
    return quantity.value


def test_figures_3_and_4_are_of_growing_curvature(store: LocalStore, tmp_path: Path) -> None:
    runs = experiments(store, {f"{p} kPa": Run("curling", (peak(p),)) for p in (1.0, 3.0)})
    found = quasi_static.draw_stresses(runs, tmp_path, "fig3")
    assert listed(found["peak_stress"]) == [1.0, 3.0]
    small, large = listed(found["curvature"])
    # a little less than in proportion: the weaker film curls more across, and so resists less
    assert 2.0 < large / small < 3.0
    rows = written(tmp_path, "fig3")
    assert rows[0] == ["peak_stress [kPa]", "curvature [1/mm]"]
    assert [float(cell) for cell in rows[2]] == pytest.approx([3.0, large], rel=1e-9)
    shapes = quasi_static.draw_shapes(runs, tmp_path, "fig4")
    assert written(tmp_path, "fig4")[0][1:3] == ["tip_ux [mm]", "tip_uz [mm]"]
    assert listed(shapes["tip_uz"])[1] > listed(shapes["tip_uz"])[0] > 0.0


def test_figure_5_compares_with_modified_stoney(store: LocalStore, tmp_path: Path) -> None:
    thick = {
        f"{d} um": Run("curling", (peak(2.0), f'geometry.substrate_thickness="{d} um"'))
        for d in (18, 28)
    }
    found = quasi_static.draw_thicknesses(experiments(store, thick), tmp_path, "fig5")
    assert listed(found["substrate_thickness"]) == [0.018, 0.028]
    assert listed(found["stoney_curvature"])[0] == pytest.approx(0.3025, abs=5e-5)  # eq. 102
    assert listed(found["curvature"])[0] > listed(found["curvature"])[1]
    assert len(written(tmp_path, "fig5")) == 3


def test_figures_6_and_7_set_dynamic_beside_quasi_static(store: LocalStore, tmp_path: Path) -> None:
    runs = experiments(
        store,
        {
            "2 kPa, dynamic": Run("twitch", (peak(2.0), *SHORT)),
            "2 kPa, quasi-static": Run("curling", (peak(2.0), *SHORT), PULSE),
        },
    )
    found = dynamic.draw_tips(runs, tmp_path, "fig6")
    rows = written(tmp_path, "fig6")
    assert rows[0][1::2] == ["2 kPa, dynamic: tip ux [mm]", "2 kPa, quasi-static: tip ux [mm]"]
    assert len(rows) == 1 + 41
    # the film swings around its quasi-static course, by some 10 % near the peak
    (swung,), (slow,) = (
        listed(found[f"tip_uz_max_{kind}"]) for kind in ("dynamic", "quasi_static")
    )
    assert swung == pytest.approx(slow, rel=0.2)
    found = dynamic.draw_curvatures(runs, tmp_path, "fig7")
    assert listed(found["peak_stress"]) == [2.0]
    assert len(written(tmp_path, "fig7")[0]) == 3


def test_a_strip_formula_reads_less_from_a_wide_film(store: LocalStore, tmp_path: Path) -> None:
    runs = experiments(
        store,
        {
            f"{width}": Run(
                "curling", (peak(4.0), f"geometry.width={width}", "mechanics.elements=[10, 6]")
            )
            for width in (0.2, 2.0)
        },
    )
    found = stoney_bias.draw(runs, tmp_path, "stoney-bias")
    narrow, wide = listed(found["strip_share"])
    # on this mesh the clamp holds the film flat over much of an element, a tenth of its length
    assert 0.9 < narrow < 1.0
    assert 0.72 < wide < 0.81
    assert written(tmp_path, "stoney-bias")[0][-1] == "strip_share"


def test_a_figure_is_drawn_by_name_with_its_numbers(tmp_path: Path) -> None:
    where = ("--store", tmp_path / "store", "--out", tmp_path / "out")
    small = [part for setting in SMALL for part in ("--set", setting)]
    result = invoke("reproduce", "fig5", *where, *small, "--set", "mechanics.n_steps=12", "--quiet")
    assert result.exit_code == 0, result.output
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["figure"] == "fig5"
    assert len(summary["quantities"]["curvature"]["value"]) == 6
    assert summary["stages"]["18 um: mechanics"]["hit"] is False
    # the six films differ in their layers alone
    hits = [entry["hit"] for name, entry in summary["stages"].items() if "activation" in name]
    assert hits == [False, True, True, True, True, True]


def test_the_figures_are_those_of_the_paper_and_one_more() -> None:
    assert [figure.name for figure in FIGURES] == [
        *(f"fig{i}" for i in range(3, 12)),
        "stoney-bias",
    ]
