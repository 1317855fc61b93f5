"""Tables, overrides and units become one configuration, or one message that says what is wrong."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from pipeline.canonical import digest
from pipeline.config import Parameter, describe, load, read_toml
from pipeline.config.quantities import NoQuantity, to_unit
from pipeline.errors import InputError


def quantity(unit: str, description: str = "", **bounds: Any) -> Any:
    extra = {"unit": unit, "source": "Table 1"}
    return Field(description=description, json_schema_extra=extra, **bounds)


class Section(BaseModel):
    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False)


class Law(Section):
    pass


class Soft(Law):
    name: Literal["soft"] = "soft"
    modulus: float = quantity("kPa", "shear modulus", gt=0)


class Stiff(Law):
    name: Literal["stiff"] = "stiff"
    moduli: tuple[float, ...] = quantity("kPa", "shear moduli")


class OneOf:
    """A choice by name, as the stages have it."""

    package = "laws"
    tag = "name"
    library = None
    laws: dict[str, type[BaseModel]] = {"soft": Soft, "stiff": Stiff}  # noqa: RUF012 - constant

    def names(self) -> list[str]:
        return list(self.laws)

    def load(self, name: str) -> type[BaseModel]:
        return self.laws[name]

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        from pydantic_core import PydanticCustomError, core_schema

        def validate(value: Any) -> Any:
            name = value if isinstance(value, str) else value.get("name")
            if name not in self.laws:
                raise PydanticCustomError(
                    "unknown_name",
                    "no model is called {given}",
                    {"given": name, "allowed": ", ".join(self.laws)},
                )
            return self.laws[name].model_validate({"name": name} if value == name else value)

        return core_schema.no_info_plain_validator_function(validate)


class Flux(Section):
    kind: Literal["flux"]
    duration: float = quantity("ms", "duration", gt=0)


class Current(Section):
    kind: Literal["current"]
    x: tuple[float, float] = quantity("mm", "extent")


Stimulus = Annotated[Flux | Current, Field(discriminator="kind")]


class Film(Section):
    length: float = quantity("mm", "length of the film", gt=0)
    angle: float = quantity("degree", "fibre angle", ge=-180, le=180, default=0.0)
    elements: tuple[int, int] = quantity("", "knot spans", default=(10, 6))
    edge: Literal["X=0", "Y=0"] = quantity("", "clamped edge", default="X=0")
    label: str | None = quantity("", "name of the film", default=None)
    step: float | Literal["auto"] = quantity("ms", "time step", default="auto")

    @field_validator("elements")
    @classmethod
    def _positive(cls, value: tuple[int, int]) -> tuple[int, int]:
        if min(value) < 1:
            raise ValueError("at least one element is needed along each side")
        return value


class Solver(Section):
    duration: float = quantity("ms", "simulated time", default=1.0)
    law: Annotated[Law, OneOf()] = quantity("", "material")
    layers: tuple[Annotated[Law, OneOf()], ...] = quantity("", "materials of layers", default=())
    stimuli: tuple[Stimulus, ...] = quantity("", "stimuli", default=())
    library: dict[str, Stimulus] = quantity("", "stimuli by name", default_factory=dict)
    probes: dict[str, tuple[float, float]] = quantity("mm", "probes", default_factory=dict)

    @model_validator(mode="after")
    def _whole(self) -> Solver:
        if self.duration == 13.0:
            raise ValueError("a duration of 13 ms brings bad luck")
        return self


class Workflow(Section):
    film: Film
    solver: Solver


def base(**film: Any) -> dict[str, Any]:
    return {
        "film": {"length": 3.5, **film},
        "solver": {"law": {"name": "soft", "modulus": 2.0}},
    }


def loaded(*overrides: str, layers: list[Any] | None = None) -> Workflow:
    return load(Workflow, [base(), *(layers or [])], overrides)


def message(*overrides: str, layers: list[Any] | None = None) -> str:
    with pytest.raises(InputError) as caught:
        loaded(*overrides, layers=layers)
    assert caught.value.exit_code == 2
    return str(caught.value)


# --- layers and overrides ---------------------------------------------------------------------


def test_later_layers_win_and_keep_what_they_do_not_mention() -> None:
    config = loaded("film.length=5", layers=[{"film": {"length": 4, "angle": 45.0}}])
    assert (config.film.length, config.film.angle) == (5.0, 45.0)


def test_layers_are_not_changed() -> None:
    below = base()
    load(Workflow, [below, {"film": {"length": 4}}], ["film.angle=1"])
    assert below == base()


def test_a_table_with_another_name_replaces_the_table_below() -> None:
    config = loaded(layers=[{"solver": {"law": {"name": "stiff", "moduli": [1, 2]}}}])
    assert config.solver.law == Stiff(moduli=(1.0, 2.0))


def test_a_table_with_the_same_or_no_name_is_merged() -> None:
    for law in ({"modulus": 3.0}, {"name": "soft", "modulus": 3.0}):
        assert loaded(layers=[{"solver": {"law": law}}]).solver.law == Soft(modulus=3.0)


def test_another_model_may_be_chosen_by_overrides_in_any_order() -> None:
    overrides = ["solver.law.moduli=[1, 2]", "solver.law.name=stiff"]
    for order in (overrides, overrides[::-1]):
        assert loaded(*order).solver.law == Stiff(moduli=(1.0, 2.0))


def test_a_name_alone_keeps_the_parameters_of_the_same_model() -> None:
    assert loaded("solver.law=soft").solver.law == Soft(modulus=2.0)


def test_a_parameter_may_be_added_to_a_model_given_by_name_alone() -> None:
    config = loaded("solver.law.modulus=4", layers=[{"solver": {"law": "soft"}}])
    assert config.solver.law == Soft(modulus=4.0)


def test_an_item_of_a_list_may_be_overridden() -> None:
    stimuli = [{"kind": "flux", "duration": 1.0}, {"kind": "flux", "duration": 2.0}]
    config = loaded("solver.stimuli.1.duration=5 s", layers=[{"solver": {"stimuli": stimuli}}])
    assert [one.duration for one in config.solver.stimuli] == [1.0, 5000.0]  # type: ignore[union-attr]  # both are Flux
    assert "has 2, counted from 0" in message(
        "solver.stimuli.2.duration=5", layers=[{"solver": {"stimuli": stimuli}}]
    )


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("film.label=plain words", "plain words"),
        ('film.label="quoted = [1]"', "quoted = [1]"),
        ("film.label= spaced ", "spaced"),
        ("film.label=a=b", "a=b"),
        ("film.label='1'", "1"),
        ("film.label=", ""),
        ("film.elements=[3, 4]", (3, 4)),
        ("film.angle=-1e1", -10.0),
        ("film.step=auto", "auto"),
        ("film.step=2 s", 2000.0),
    ],
)
def test_the_value_of_an_override_is_toml_or_a_bare_text(text: str, value: Any) -> None:
    name = text.partition("=")[0].partition(".")[2]
    found = getattr(loaded(text).film, name)
    assert (type(found), found) == (type(value), value)


def test_a_whole_table_may_be_overridden_inline() -> None:
    config = loaded('solver.law={name = "stiff", moduli = ["1 MPa"]}')
    assert config.solver.law == Stiff(moduli=(1000.0,))


@pytest.mark.parametrize("text", ["film.length", "=3", "film..length=3", ".=3", ""])
def test_an_override_of_another_form_is_refused(text: str) -> None:
    assert message(text) == f"--set needs SECTION.KEY=VALUE, got {text!r}"


def test_the_last_of_two_overrides_wins() -> None:
    assert loaded("film.length=1", "film.length=2").film.length == 2.0


# --- files -------------------------------------------------------------------------------------


def test_a_toml_file_is_read(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text('[film]\nlength = "18 µm"\n', encoding="utf-8")
    assert read_toml(tmp_path / "a.toml") == {"film": {"length": "18 µm"}}


def test_a_toml_file_may_begin_with_a_byte_order_mark(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text("[film]\nlength = 18.0\n", encoding="utf-8-sig")
    assert read_toml(tmp_path / "a.toml") == {"film": {"length": 18.0}}


@pytest.mark.parametrize(
    ("contents", "expected"),
    [
        (b"[film]\nlength = \n", "line 2"),
        (b"[film]\nlength = 1\nlength = 2\n", "line 3"),
        (b"[film]\n# \xff\n", "line 2"),
    ],
)
def test_a_malformed_file_is_named_with_its_line(
    contents: bytes, expected: str, tmp_path: Path
) -> None:
    path = tmp_path / "bad.toml"
    path.write_bytes(contents)
    with pytest.raises(InputError) as caught:
        read_toml(path)
    assert str(path) in str(caught.value)
    assert expected in str(caught.value)


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    for path in (tmp_path / "absent.toml", tmp_path):
        with pytest.raises(InputError, match="cannot read the configuration"):
            read_toml(path)


# --- units -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("18 um", "mm", 0.018),
        ("18um", "mm", 0.018),
        ("18 µm", "mm", 0.018),
        ("+1.8e1 um", "mm", 0.018),
        ("2 s", "ms", 2000.0),
        ("-80 mV", "mV", -80.0),
        ("1 kg/m^3", "mg/mm^3", 0.001),
        ("0.8 1/ms", "1/ms", 0.8),
        ("0.8/ms", "1/ms", 0.8),
        ("0.8 / ms", "1/ms", 0.8),
        ("800/s", "1/ms", 0.8),
        ("800 Hz", "1/ms", 0.8),
        ("2 uF/cm^2", "nF/mm^2", 20.0),
        ("2 nA/mm", "nF*mV/ms/mm", 2.0),
        ("45 deg", "degree", 45.0),
    ],
)
def test_a_quantity_is_converted_exactly(text: str, unit: str, value: float) -> None:
    # Equality on purpose: a last bit that differs is another key.
    assert to_unit(text, unit) == value


@given(st.decimals(min_value="1e-6", max_value="1e6", places=6))
def test_a_number_means_the_same_with_and_without_its_unit(number: Any) -> None:
    assert to_unit(f"{number} um", "um") == float(number)
    assert to_unit(f"{number * 1000} um", "mm") == float(number)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("18", "not a number with a unit"),
        ("um", "not a number with a unit"),
        ("", "not a number with a unit"),
        ("[1, 2] mm", "not a number with a unit"),
        ("__import__('os')", "not a number with a unit"),
        ("nan mm", "not a number with a unit"),
        ("18 foo", "'foo' is not known"),
        ("3 mm, 4", "'mm, 4' is not known"),
        ("0.8//ms", "'//ms' is not known"),
        ("18 kg", "'kg' has another dimension"),
        ("18/ms", "'/ms' has another dimension"),
        ("18 mm^2", "'mm^2' has another dimension"),
    ],
)
def test_what_is_no_quantity_of_the_dimension_is_refused(text: str, reason: str) -> None:
    with pytest.raises(NoQuantity, match=reason.replace("^", r"\^")):
        to_unit(text, "mm")


def test_units_are_converted_wherever_a_field_declares_one() -> None:
    flux, current = {"kind": "flux", "duration": "1 s"}, {"kind": "current", "x": ["1 um", 2]}
    solver = {
        "law": {"name": "soft", "modulus": "2 MPa"},
        "layers": [{"name": "soft", "modulus": "3 Pa"}, {"name": "stiff", "moduli": ["1 MPa", 2]}],
        "stimuli": [flux, current],
        "library": {"S1": flux},
        "probes": {"A": ["1 cm", 2]},
    }
    config = loaded(layers=[{"solver": solver}]).solver
    assert config.law == Soft(modulus=2000.0)
    assert config.layers == (Soft(modulus=0.003), Stiff(moduli=(1000.0, 2.0)))
    assert config.stimuli == (
        Flux(kind="flux", duration=1000.0),
        Current(kind="current", x=(0.001, 2.0)),
    )
    assert config.library == {"S1": Flux(kind="flux", duration=1000.0)}
    assert config.probes == {"A": (10.0, 2.0)}


def test_equal_configurations_have_equal_keys_however_they_are_written() -> None:
    plain = digest(loaded("film.length=18"))
    for text in ("film.length=18.0", "film.length=18 mm", "film.length=1.8 cm"):
        assert digest(loaded(text)) == plain


def test_a_wrong_dimension_names_field_value_and_unit() -> None:
    assert message("film.length=18 kg") == (
        'film.length = "18 kg": expected a number in mm, or a text with a unit that converts to '
        "mm; 'kg' has another dimension"
    )


def test_reading_a_configuration_without_units_imports_no_unit_library(
    output: Callable[..., str],
) -> None:
    code = (
        "import sys\nfrom typing import Any\nfrom pydantic import BaseModel\n"
        "from pipeline.config import load\n"
        "class C(BaseModel):\n    x: float\n"
        "load(C, [{'x': 1}], ['x=2'])\n"
        "print(*sorted(sys.modules.keys() & {'pint', 'numpy', 'zarr'}))"
    )
    assert output(code).strip() == ""


# --- problems ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("override", "expected"),
    [
        ("film.length=-3", "film.length = -3: must be greater than 0 mm"),
        ("film.angle=181", "film.angle = 181: must be at most 180 degree"),
        ("film.angle=-181.5", "film.angle = -181.5: must be at least -180 degree"),
        ("film.length=true", "film.length = true: must be a number in mm"),
        ("film.length=inf", "film.length = Infinity: must be a finite number"),
        ("film.elements=3", "film.elements = 3: must be a list of 2 whole numbers"),
        ("film.elements=[3]", "film.elements = [3]: must be a list of 2 whole numbers"),
        ("film.elements=[1,2,3]", "film.elements = [1, 2, 3]: must be a list of 2 whole numbers"),
        ("film.elements=[1,2.5]", "film.elements.1 = 2.5: must be a whole number"),
        (
            "film.elements=[0,1]",
            "film.elements = [0, 1]: at least one element is needed along each side",
        ),
        ("film.label=1", "film.label = 1: must be a text or nothing"),
        (
            "film.edge=X=1",
            'film.edge = "X=1": must be one of: "X=0", "Y=0"; did you mean \'X=0\'?',
        ),
        ("film=3", "film = 3: must be a table"),
        (
            "film.lenght=3",
            "film.lenght = 3: no such parameter; did you mean 'film.length'? "
            "(film has: length, angle, elements, edge, label, step)",
        ),
        (
            "solver.length=3",
            "solver.length = 3: no such parameter; did you mean 'film.length'? "
            "(solver has: duration, law, layers, stimuli, library, probes)",
        ),
        ("flim.x=3", "flim: no such parameter; did you mean 'film'? (there are: film, solver)"),
        ("solver.law.modulus=0", "solver.law.modulus = 0: must be greater than 0 kPa"),
        (
            "solver.law.moduls=1",
            "solver.law.moduls = 1: no such parameter; did you mean 'solver.law.modulus'? "
            "(solver.law has: name, modulus)",
        ),
        (
            "solver.law.name=stif",
            "solver.law.name = \"stif\": choose one of: soft, stiff; did you mean 'stiff'?",
        ),
        (
            "solver.law.name=stiff",
            "solver.law.moduli: is missing; give a list of numbers in kPa (shear moduli)",
        ),
        ("solver.duration=13", "solver: a duration of 13 ms brings bad luck"),
        (
            'solver.stimuli=[{kind="flx"}]',
            "solver.stimuli.0: kind must be one of: flux, current; did you mean 'flux'?",
        ),
        ("solver.stimuli=[{duration=1}]", "solver.stimuli.0: needs kind"),
        (
            'solver.stimuli=[{kind="flux", duration=0}]',
            "solver.stimuli.0.duration = 0: must be greater than 0 ms",
        ),
        (
            'solver.library.S1={kind="flux", durtion=1, duration=1}',
            "solver.library.S1.durtion = 1: no such parameter; did you mean "
            "'solver.library.S1.duration'? (solver.library.S1 has: kind, duration)",
        ),
        (
            "film.step=atuo",
            'film.step = "atuo": must be a number in ms or one of: "auto"; did you mean \'auto\'?',
        ),
    ],
)
def test_each_problem_is_told_in_plain_words(override: str, expected: str) -> None:
    assert message(override) == expected


def test_a_missing_section_and_a_missing_field_say_what_to_give() -> None:
    with pytest.raises(InputError) as caught:
        load(Workflow, [{"film": {}}])
    assert str(caught.value).splitlines() == [
        "2 problems in the configuration:",
        "film.length: is missing; give a number in mm (length of the film)",
        "solver: is missing; give a table",
    ]


def test_several_problems_are_all_told_at_once() -> None:
    text = message("film.length=18 kg", "film.angle=999", "film.elements=[1]", "solver.lav=1")
    assert text.splitlines()[0] == "4 problems in the configuration:"
    names = [line.split()[0] for line in text.splitlines()[1:]]
    assert names == ["film.length", "film.angle", "film.elements", "solver.lav"]


# --- description -------------------------------------------------------------------------------


def test_every_parameter_is_described_with_unit_and_source() -> None:
    solver = {"stimuli": [{"kind": "flux", "duration": 2.0}], "probes": {"A": [1.0, 2.0]}}
    rows = {row.name: row for row in describe(loaded(layers=[{"solver": solver}]))}
    assert rows["film.length"] == Parameter(
        "film.length", 3.5, "mm", "length of the film", "Table 1"
    )
    assert rows["solver.law.modulus"].value == 2.0
    assert rows["solver.stimuli.0.duration"].unit == "ms"
    assert rows["solver.probes.A"] == Parameter(
        "solver.probes.A", (1.0, 2.0), "mm", "probes", "Table 1"
    )
    assert "solver.layers" in rows
    assert "solver.law" not in rows


def test_the_choice_of_the_stages_is_recognised() -> None:
    from pipeline.config.fields import Choice
    from stages.configuration import OneOf as StagesOneOf
    from stages.configuration import Section as StagesSection

    assert isinstance(StagesOneOf("stages.mechanics.materials", StagesSection), Choice)


class Mesh(Section):
    picks: ClassVar = {"preset": ("elements", "degree")}
    preset: str | None = None
    elements: int | None = None
    degree: int | None = None


class Meshed(Section):
    mesh: Mesh


LOW = {"mesh": {"elements": 9, "degree": 2}}


@pytest.mark.parametrize(
    ("layers", "overrides", "expected"),
    [
        ([LOW, {"mesh": {"preset": "coarse"}}], [], Mesh(preset="coarse")),
        ([LOW], ["mesh.preset=coarse"], Mesh(preset="coarse")),
        (
            [LOW, {"mesh": {"preset": "coarse"}}],
            ["mesh.degree=3"],
            Mesh(preset="coarse", degree=3),
        ),
        ([LOW, {"mesh": {"preset": "coarse", "degree": 3}}], [], Mesh(preset="coarse", degree=3)),
    ],
)
def test_a_field_that_picks_others_takes_away_only_what_lies_below_it(
    layers: list[dict[str, Any]], overrides: list[str], expected: Mesh
) -> None:
    assert load(Meshed, layers, overrides).mesh == expected
    assert LOW == {"mesh": {"elements": 9, "degree": 2}}
