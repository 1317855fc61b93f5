"""Configurations read section by section are those read as a whole."""

from __future__ import annotations

from functools import cache
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import BaseModel, field_validator

from pipeline.canonical import digest
from pipeline.config import load, read_toml
from pipeline.config.variants import Setting, Variants
from pipeline.errors import InputError
from workflows import registry

COARSE = ("electrophysiology.elements=[30, 20]",)

FIELDS: dict[str, st.SearchStrategy[Any]] = {
    "mechanics.damping": st.floats(0.0, 5.0),
    "mechanics.n_steps": st.integers(1, 50),
    "mechanics.elements.0": st.integers(4, 9),
    "mechanics.supports.clamp.edge": st.sampled_from(["X=0", "Y=0"]),
    "mechanics.active.shear_modulus": st.sampled_from([1.5, "900 Pa"]),
    "geometry.fibre_angle": st.sampled_from([0, 30.0, "0.5 rad"]),
    "geometry.length": st.sampled_from([4.0, "3.5 mm"]),
    "electrophysiology.cell_model": st.sampled_from(["aliev-panfilov", "mitchell-schaeffer"]),
    "electrophysiology.cell_models.aliev-panfilov.a": st.sampled_from([0.14, 0.15]),
    "electrophysiology.stimulus_library.S1.flux": st.floats(1.0, 3.0),
    "electrophysiology.stimuli.0.start": st.sampled_from([0.0, 1.0]),
    "electrophysiology.stimuli": st.sampled_from(["S1", "S1, S2"]),
    "electrophysiology.tension_law": st.sampled_from(["goektepe-kuhl", "nash-panfilov"]),
    "electrophysiology.conductivity": st.floats(0.001, 0.004),
    "electrophysiology.initial_potential": st.sampled_from([-81.0, "-79 mV"]),
    "electrophysiology.preset": st.sampled_from(["economical"]),
    "postprocessing.mid_axis": st.sampled_from(["centre", 1.0, 5.0]),
    "activation.scale": st.floats(-1.0, 2.0),
}
"""Of every kind: numbers, texts with units, models by name, libraries, items, presets; some are invalid."""


@cache
def tables() -> tuple[dict[str, Any], ...]:
    """Parameters of the paper."""
    return tuple(read_toml(file) for file in registry.parameter_files("planar-waves"))


@cache
def variants() -> Variants[Any]:
    """Made once, so that what an example leaves behind meets the next one."""
    return Variants(registry.find("planar-waves").config, tables(), COARSE)


def told(read: Any) -> str:
    """Digest of a configuration, or why there is none."""
    try:
        return digest(read())
    except InputError as error:
        return str(error)


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_any_settings_make_the_configuration_that_all_tables_together_make(data: Any) -> None:
    names = data.draw(st.lists(st.sampled_from(sorted(FIELDS)), unique=True, max_size=4))
    found: list[Setting] = [(tuple(name.split(".")), data.draw(FIELDS[name])) for name in names]
    ordered = sorted(found, key=lambda setting: len(setting[0]))
    layer = [f"{'.'.join(path)}={_toml(value)}" for path, value in ordered]
    model = registry.find("planar-waves").config
    whole = told(lambda: load(model, [variants().tables], layer))
    assert told(lambda: variants().load(found)) == whole


def test_sections_that_do_not_change_are_the_same_objects() -> None:
    one = variants().load([(("mechanics", "damping"), 0.3)])
    other = variants().load([(("mechanics", "damping"), 0.4)])
    assert one.geometry is other.geometry
    assert one.electrophysiology is other.electrophysiology
    assert one.mechanics is not other.mechanics


def test_what_a_preset_picks_follows_the_film() -> None:
    """The mesh of a longer film has more elements, though the section of the cells does not change."""
    preset: Setting = (("electrophysiology", "preset"), "economical")
    short, long = (
        variants().load([preset, (("geometry", "length"), length)]) for length in (3.5, 7.0)
    )
    assert long.electrophysiology.elements[0] > 1.9 * short.electrophysiology.elements[0]


def test_an_error_names_field_and_value() -> None:
    with pytest.raises(InputError, match=r"mechanics.damping = -1.0: must be at least 0"):
        variants().load([(("mechanics", "damping"), -1.0)])


def _toml(value: Any) -> str:
    return f'"{value}"' if isinstance(value, str) else repr(value)


class Doubled(BaseModel):
    """A section that changes what it is given."""

    size: float
    count: int = 1

    @field_validator("size")
    @classmethod
    def _double(cls, size: float) -> float:
        return 2 * size


class Whole(BaseModel):
    """A configuration of one section."""

    part: Doubled


def test_a_value_that_a_section_changes_is_changed_once() -> None:
    made = Variants(Whole, [{"part": {"size": 1.0}}])
    assert made.load([(("part", "count"), 3)]) == Whole(part=Doubled(size=1.0, count=3))
