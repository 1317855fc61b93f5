"""What is wrong with a configuration is told once, where it was said, with the nearest name."""

from __future__ import annotations

from pathlib import Path

import pytest

from pipeline.errors import InputError
from workflows.request import Request


def told(*overrides: str) -> str:
    """Message about settings of planar waves."""
    with pytest.raises(InputError) as caught:
        Request.read("planar-waves", None, overrides)
    return str(caught.value)


def test_an_error_in_a_named_stimulus_is_told_once_and_in_the_library() -> None:
    assert told("electrophysiology.stimulus_library.S1.edge=Z=0") == (
        'electrophysiology.stimulus_library.S1.edge = "Z=0": must be one of: '
        '"X=0", "X=L1", "Y=0", "Y=L2"; did you mean \'Y=0\'?'
    )


def test_an_error_in_a_named_stimulus_that_is_not_applied_is_told_once() -> None:
    assert told("electrophysiology.stimulus_library.S3.flux=x").count("S3.flux") == 1


def test_an_error_in_a_stimulus_changed_in_its_place_is_told_there() -> None:
    assert told("electrophysiology.stimuli.0.edge=Z=0").startswith(
        'electrophysiology.stimuli.0.edge = "Z=0": must be one of: '
    )


def test_the_edge_of_an_applied_stimulus_can_be_set_by_its_place_and_by_its_name() -> None:
    by_place = Request.read("planar-waves", None, ["electrophysiology.stimuli.0.edge=Y=0"])
    library = ["electrophysiology.stimulus_library.S1.edge=Y=0"]
    by_name = Request.read("planar-waves", None, library)
    assert by_place.config.electrophysiology.stimuli == by_name.config.electrophysiology.stimuli  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("setting", "meant"),
    [
        ("electrophysiology.tension_law=nash", "nash-panfilov"),
        ("electrophysiology.cell_model=aliev", "aliev-panfilov"),
        ("mechanics.tension_law=length", "length-dependent"),
        ("mechanics.damp=1", "mechanics.damping"),
    ],
)
def test_the_beginning_of_a_name_is_enough_to_guess_it(setting: str, meant: str) -> None:
    assert f"did you mean '{meant}'?" in told(setting)


def test_a_file_named_in_a_configuration_lies_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "here").mkdir()
    (tmp_path / "there").mkdir()
    (tmp_path / "here" / "film.toml").write_text(
        '[activation.time_law]\nname = "table"\nfile = "beat.csv"\n'
    )
    (tmp_path / "here" / "beat.csv").write_text("0,0\n10,1\n")
    monkeypatch.chdir(tmp_path / "there")
    law = Request.read("twitch", tmp_path / "here" / "film.toml").config.activation.time_law  # type: ignore[attr-defined]
    assert law.factor == (0.0, 1.0)
    (tmp_path / "there" / "beat.csv").write_text("0,0\n10,2\n")  # that of the command is another
    setting = "activation.time_law={name='table',file='beat.csv'}"
    law = Request.read("twitch", None, [setting]).config.activation.time_law  # type: ignore[attr-defined]
    assert law.factor == (0.0, 2.0)
    absolute = tmp_path / "there" / "beat.csv"
    (tmp_path / "here" / "film.toml").write_text(
        f'[activation.time_law]\nname = "table"\nfile = "{absolute}"\n'
    )
    law = Request.read("twitch", tmp_path / "here" / "film.toml").config.activation.time_law  # type: ignore[attr-defined]
    assert law.factor == (0.0, 2.0)
