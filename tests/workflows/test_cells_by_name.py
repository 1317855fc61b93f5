"""A cell model or tension law is chosen on the command line by the name of its parameter set."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

from pipeline.canonical import canonical
from pipeline.errors import InputError
from stages.electrophysiology.config import ElectrophysiologyConfig
from tests.cells import CELL_MODELS, LIBRARY, TENSION_LAWS
from tests.paper import CELL, TENSION
from tests.workflows.conftest import invoke
from workflows.request import Request


def cells(*settings: str, config: Path | None = None) -> ElectrophysiologyConfig:
    overrides = [f"electrophysiology.{setting}" for setting in settings]
    request = Request.read("planar-waves", config=config, overrides=overrides)
    found: ElectrophysiologyConfig = request.config.electrophysiology  # type: ignore[attr-defined]
    return found


FINE = ("elements=[204, 120]",)  # fine enough for the thinnest front


@pytest.mark.parametrize("name", CELL_MODELS)
def test_a_name_is_all_that_a_cell_model_needs(name: str) -> None:
    config = cells(*FINE, f"cell_model={name}")
    assert config.initial_potential == config.cell_model.rest_potential()
    assert config.tension_law.constants()[1] == config.initial_potential  # v_r: no stress at rest


@pytest.mark.parametrize("name", TENSION_LAWS)
def test_a_name_is_all_that_a_tension_law_needs(name: str) -> None:
    assert cells(f"tension_law={name}").tension_law.name == name


def test_the_paper_s_cells_are_those_of_its_tables() -> None:
    config = cells()
    assert (config.cell_model, config.tension_law) == (CELL, TENSION)
    assert config.initial_potential == -80.0


def test_a_set_may_be_changed_and_the_start_moved() -> None:
    config = cells("cell_model=mitchell-schaeffer", "cell_model.tau_close=0.13 s")
    assert config.cell_model.model_dump()["tau_close"] == 130.0
    assert cells("initial_potential=-70 mV").initial_potential == -70.0


def test_a_set_of_one_s_own_is_chosen_like_the_others(tmp_path: Path) -> None:
    values = LIBRARY["cell_models"]["mitchell-schaeffer"] | {"tau_close": 111.0}
    file = tmp_path / "mine.toml"
    rows = "\n".join(
        f'{key} = "{value}"' if isinstance(value, str) else f"{key} = {value}"
        for key, value in values.items()
    )
    file.write_text(f"[electrophysiology.cell_models.short]\n{rows}\n")
    assert cells("cell_model=short", config=file).cell_model.model_dump()["tau_close"] == 111.0


def test_what_the_sets_are_called_does_not_matter_to_the_key(tmp_path: Path) -> None:
    """A run with a set, and one with the same numbers in a table, share their result."""
    file = tmp_path / "table.toml"
    dumped = CELL.model_dump()
    rows = "\n".join(f"{k} = {v!r}".replace("'", '"') for k, v in dumped.items())
    file.write_text(
        f"[electrophysiology.cell_model]\n{rows}\n"
        "[electrophysiology.cell_models.mitchell-schaeffer]\ntau_close = 99.0\n"
    )
    assert canonical(cells(config=file)) == canonical(cells())
    assert canonical(cells("cell_model.a=0.14")) != canonical(cells())


def test_an_unknown_name_is_answered_with_the_nearest() -> None:
    result = invoke(
        "explain", "planar-waves", "--set", "electrophysiology.cell_model=mitchel-schaefer"
    )
    assert result.exit_code == 2
    assert "did you mean 'mitchell-schaeffer'?" in result.output
    assert "bueno-orovio-endo" in result.output


def test_only_the_chosen_model_counts_for_the_code_of_a_result() -> None:
    from pipeline.keys import code_of

    stage = "stages.electrophysiology.stage"
    modules = code_of(stage, cells("cell_model=mitchell-schaeffer")).modules
    folder = "stages.electrophysiology.cell_models"
    assert f"{folder}.mitchell_schaeffer" in modules
    assert f"{folder}.bueno_orovio" not in modules
    assert importlib.util.find_spec(f"{folder}.bueno_orovio") is not None


@pytest.mark.parametrize("threshold", [-90, -84, 60])
def test_a_threshold_that_no_action_potential_crosses_is_refused(threshold: int) -> None:
    message = (
        rf"activation_threshold = {threshold} mV does not lie between rest \(-84 mV\) and peak"
    )
    with pytest.raises(InputError, match=message):
        cells(*FINE, "cell_model=bueno-orovio", f"activation_threshold={threshold}")


@pytest.mark.parametrize("level", [-80, 900])
def test_a_tip_potential_that_no_action_potential_passes_is_refused(level: int) -> None:
    message = (
        rf"tip_potential = {level} mV does not lie between rest \(-80 mV\) and peak .* is -30 mV"
    )
    with pytest.raises(InputError, match=message):
        Request.read("spiral-wave", overrides=[f"postprocessing.tip_potential={level}"])
