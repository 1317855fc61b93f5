"""The files that docs/films.md prints, through the command line."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from stages.mechanics import config as mechanics
from stages.time_laws.base import AnyTimeLaw
from tests.workflows.conftest import Desk, invoke

PAGE = (Path(__file__).parents[2] / "docs" / "films.md").read_text()
FILES = re.findall(r"```toml\n(.*?)```", PAGE, flags=re.DOTALL)


@pytest.mark.parametrize("text", FILES, ids=["layers", "supports and loads"])
def test_the_printed_films_run(text: str, tmp_path: Path) -> None:
    desk = Desk(tmp_path, "curling")
    desk.config.write_text(text)
    coarse = ("--set", "mechanics.elements=[6,2]", "--set", "mechanics.n_steps=6")
    found = desk.run("out", *coarse)["quantities"]
    assert found["projected_length"]["value"] > 0.0
    assert (
        found["strip_share"]["value"] is None
    )  # no strip of two layers that only its muscle bends


@pytest.mark.parametrize("text", FILES, ids=["layers", "supports and loads"])
def test_the_printed_films_move(text: str, tmp_path: Path) -> None:
    (tmp_path / "film.toml").write_text(text)
    result = invoke("explain", "twitch", "--config", tmp_path / "film.toml", "--store", tmp_path)
    assert result.exit_code == 0, result.output


def test_another_material_is_told_by_name(tmp_path: Path) -> None:
    [setting] = re.findall(r"--set '(mechanics.active=.*?)'", PAGE)
    result = invoke("show", "curling", "--set", setting)
    assert result.exit_code == 0, result.output
    assert re.search(r"mechanics.active.shear_modulus +2 +kPa", result.output)


@pytest.mark.parametrize(
    "choice",
    [
        mechanics.AnyMaterial,
        mechanics.AnyTensionLaw,
        mechanics.AnySupport,
        mechanics.AnyLoad,
        AnyTimeLaw,
    ],
    ids=["material", "tension law", "support", "load", "time law"],
)
def test_every_name_on_offer_is_in_the_table(choice: object) -> None:
    [one_of] = choice.__metadata__  # type: ignore[attr-defined]
    assert all(f"`{name}`" in PAGE for name in one_of.names())
