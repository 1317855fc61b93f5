"""What a sweep runs over, as it is written on the command line."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.config import read_toml
from pipeline.config.variants import Variants
from pipeline.errors import InputError
from workflows import registry
from workflows.sweep.asked import Asked, read_design
from workflows.sweep.design import Design
from workflows.sweep.fields import find_field
from workflows.sweep.grammar import values


@cache
def variants(workflow: str = "planar-waves") -> Variants[Any]:
    """The workflow as it is without settings."""
    layers = [read_toml(file) for file in registry.parameter_files(workflow)]
    return Variants(registry.find(workflow).config, layers)


def listed(path: str, text: str) -> tuple[Any, ...]:
    """Values that a text lists for a field."""
    return values(find_field(path, variants(), "--over"), text, "--over")


def design(*over: str, workflow: str = "planar-waves", **more: Any) -> Design:
    """The cases of some options."""
    return read_design(Asked(over, **more), variants(workflow))


def cases(found: Design) -> list[tuple[Any, ...]]:
    """Values of the fields, case by case."""
    return [tuple(case.values.values()) for case in found]


DAMPING = "mechanics.damping"
THICKNESS = "geometry.substrate_thickness"
STEPS = "mechanics.n_steps"


@pytest.mark.parametrize(
    ("path", "text", "expected"),
    [
        (DAMPING, "0.2,0.4, 0.8", (0.2, 0.4, 0.8)),
        (DAMPING, "1", (1.0,)),
        (DAMPING, "800 / s,0.4/ms", (0.8, 0.4)),
        (THICKNESS, "15 um,0.018", (0.015, 0.018)),
        (THICKNESS, '"15 um","18 um"', (0.015, 0.018)),
        (THICKNESS, "15:25:5 um", (0.015, 0.02, 0.025)),
        (THICKNESS, "15 um:0.02 mm:#2", (0.015, 0.02)),
        ("geometry.fibre_angle", "0:90:15", (0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0)),
        ("geometry.fibre_angle", "0:80:15", (0.0, 15.0, 30.0, 45.0, 60.0, 75.0)),
        ("geometry.fibre_angle", "90:0:-45,10", (90.0, 45.0, 0.0, 10.0)),
        ("geometry.fibre_angle", "-10:10:#3", (-10.0, 0.0, 10.0)),
        (DAMPING, "0.1:0.3:0.1", (0.1, 0.2, 0.3)),  # no 0.30000000000000004
        (STEPS, "10:20:5", (10, 15, 20)),
        (STEPS, "10,20:40:#2", (10, 20, 40)),
        ("electrophysiology.cell_model", "aliev-panfilov,fitzhugh-nagumo", None),
        ("electrophysiology.elements.0", "40,60", (40, 60)),
        ("electrophysiology.stimuli.0.start", "0,1", (0.0, 1.0)),
        ("electrophysiology.stimulus_library.S1.flux", "1:2:1", (1.0, 2.0)),
        ("electrophysiology.allow_coarse_mesh", "true,false", (True, False)),
    ],
)
def test_values_are_lists_and_ranges_in_the_unit_of_the_field(
    path: str, text: str, expected: tuple[Any, ...] | None
) -> None:
    found = listed(path, text)
    assert found == (expected or tuple(text.split(",")))
    assert [type(one) for one in found] == [type(one) for one in expected or found]


def test_a_range_may_be_even_in_the_logarithm() -> None:
    assert listed(DAMPING, "0.01:1:#3:log") == pytest.approx((0.01, 0.1, 1.0), rel=1e-15)


@given(first=st.integers(-50, 50), steps=st.integers(0, 40), hundredths=st.integers(1, 300))
def test_a_range_ends_with_its_last_value_if_the_steps_meet_it(
    first: int, steps: int, hundredths: int
) -> None:
    step = hundredths / 100
    last = (first * 100 + steps * hundredths) / 100
    found = listed("geometry.fibre_angle", f"{first}:{last}:{step}")
    assert len(found) == steps + 1
    assert found[0] == first
    assert found[-1] == last  # in decimal arithmetic, without the rounding of binary steps


@pytest.mark.parametrize(
    ("over", "parts"),
    [
        ("mechanics.dampin=1", ["mechanics.dampin", "did you mean 'mechanics.damping'?"]),
        ("mechanic.damping=1", ["mechanic", "did you mean"]),
        ("electrophysiology.stimulus_library.S1.fluxes=1", ["did you mean", "flux"]),
        ("electrophysiology.elements=[28,6],[56,12]", ["a list of 2 whole numbers", "elements.0"]),
        ("electrophysiology.stimuli=S1", ["a list of", "electrophysiology.stimuli.0"]),
        ("geometry=1", ["geometry is a table", "geometry.length"]),
        ("mechanics.supports=1", ["mechanics.supports is a table", "mechanics.supports.clamp"]),
        ("mechanics.damping=[1,2]", ["one value at a time"]),
        ("mechanics.damping=", ["nothing to sweep over"]),
        ("mechanics.damping=1,,2", ["nothing between two commas"]),
        ("mechanics.damping=1:0:0.1", ["the range is empty", "from 1 to 0"]),
        ("mechanics.damping=0:1:0", ["the step is 0"]),
        ("mechanics.damping=0:1:#0", ["the range is empty"]),
        ("mechanics.damping=0:1:#1", ["two values at least"]),
        ("mechanics.damping=0:1:#2.5", ["'2.5' is no number of values"]),
        ("mechanics.damping=0:1:#x", ["'x' is no number of values"]),
        ("mechanics.damping=0:1:#3:log", ["numbers above 0"]),
        ("mechanics.damping=0:1:0.1:log", ["needs a count"]),
        ("mechanics.damping=0:1", ["FIRST:LAST:STEP or FIRST:LAST:#COUNT"]),
        ("mechanics.damping=0:1:1e-12", ["1000000 are the most"]),
        ("mechanics.damping=0:x:1", ["mechanics.damping", '"x"', "a number in 1/ms"]),
        ("mechanics.damping=a", ['mechanics.damping = "a"', "a number in 1/ms"]),
        ("mechanics.damping=1,1.0", ["comes twice"]),
        ("mechanics.damping=0.1..1", ["--sample lhs:N"]),
        ("mechanics.n_steps=10:20:#4", ["takes whole numbers", "13.3333"]),
        ("geometry.substrate_thickness=15 s", ["another dimension"]),
        ("mechanics.damping", ["--over needs SECTION.KEY=VALUES"]),
        ("=1", ["--over needs SECTION.KEY=VALUES"]),
    ],
)
def test_what_cannot_be_swept_over_is_told_with_a_remedy(over: str, parts: Sequence[str]) -> None:
    with pytest.raises(InputError) as told:
        design(over)
    for part in parts:
        assert part in str(told.value)


def test_all_combinations_are_cases_the_last_field_changing_fastest() -> None:
    found = design("mechanics.damping=1,2", "mechanics.n_steps=3,4")
    assert cases(found) == [(1.0, 3), (1.0, 4), (2.0, 3), (2.0, 4)]
    assert [case.name for case in found] == ["1", "2", "3", "4"]
    assert found.is_grid
    assert found.shape == (2, 2)


def test_names_of_cases_sort_as_their_numbers() -> None:
    names = [case.name for case in design("mechanics.n_steps=1:120:1")]
    assert names == sorted(names)
    assert (names[0], names[-1]) == ("001", "120")


def test_fields_may_change_together() -> None:
    together = ("mechanics.damping=1,2,2", "mechanics.n_steps=3,4,5")
    found = design("geometry.fibre_angle=0,90", together=together)
    assert cases(found)[:4] == [(0.0, 1.0, 3), (0.0, 2.0, 4), (0.0, 2.0, 5), (90.0, 1.0, 3)]
    assert len(found) == 6
    assert not found.is_grid


def test_fields_that_change_together_need_as_many_values() -> None:
    with pytest.raises(InputError, match=r"mechanics.damping 2, mechanics.n_steps 3"):
        design(together=("mechanics.damping=1,2", "mechanics.n_steps=3,4,5"))
    with pytest.raises(InputError, match="use --over"):
        design(together=("mechanics.damping=1,2",))


def test_a_field_is_given_once() -> None:
    with pytest.raises(InputError, match=r"mechanics.damping is given twice"):
        design("mechanics.damping=1", "mechanics.damping=2")
    with pytest.raises(InputError, match="set by --set and swept over, too"):
        read_design(Asked(("mechanics.damping=1",)), variants(), ["mechanics. damping =2"])
    with pytest.raises(InputError, match="nothing to sweep over"):
        design()


def test_cases_come_from_a_table(tmp_path: Path) -> None:
    table = tmp_path / "cases.csv"
    table.write_text(
        "case,mechanics.damping,geometry.substrate_thickness [um]\n"
        "soft,0.4,15\n\nas-is,,0.018 mm\n",
        encoding="utf-8-sig",
    )
    found = design(cases=table)
    assert [case.name for case in found] == ["soft", "as-is"]
    assert [case.values for case in found] == [
        {"mechanics.damping": 0.4, "geometry.substrate_thickness": 0.015},
        {"geometry.substrate_thickness": 0.018},
    ]


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("", ["is empty"]),
        ("mechanics.damping\n", ["there are no cases"]),
        ("case\na\n", ["must name fields"]),
        ("mechanics.damping [1/ms\n1\n", ["must name fields", "'mechanics.damping [1/ms'"]),
        ("case;mechanics.damping\na;1\n", ["semicolons", "by commas"]),
        ("case\tmechanics.damping\na\t1\n", ["tabs", "by commas"]),
        ("mechanics.dampin\n1\n", ["did you mean 'mechanics.damping'?"]),
        ("mechanics.damping\nx\n", ["line 2", "a number in 1/ms"]),
        ("mechanics.damping\n1,2\n", ["line 2", "2 cells below 1 headings"]),
        ("mechanics.damping,mechanics.damping\n1,2\n", ["given twice"]),
        ("case,mechanics.damping\na,1\na,2\n", ["two cases are called 'a'"]),
        ("case,mechanics.damping\n../a,1\n", ["cannot name a folder"]),
    ],
)
def test_a_wrong_table_is_told_with_its_line(
    text: str, parts: Sequence[str], tmp_path: Path
) -> None:
    table = tmp_path / "cases.csv"
    table.write_text(text)
    with pytest.raises(InputError) as told:
        design(cases=table)
    for part in parts:
        assert part in str(told.value)


def test_a_table_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot read the cases"):
        design(cases=tmp_path / "none.csv")


@pytest.mark.parametrize("method", ["lhs", "sobol"])
def test_samples_fill_the_space_evenly(method: str) -> None:
    """In each parameter every n-th part holds one sample: the property of both methods for n = 2^k."""
    n = 32
    found = design("mechanics.damping=0..2", f"{THICKNESS}=15..20 um", sample=f"{method}:{n}")
    points = np.array(cases(found))
    for column, low, high in zip(points.T, (0.0, 0.015), (2.0, 0.02), strict=True):
        parts = np.floor((column - low) / (high - low) * n).astype(int)
        assert sorted(parts) == list(range(n))


def test_the_seed_makes_the_samples() -> None:
    over = ("mechanics.damping=0..2",)
    assert cases(design(*over, sample="lhs:5")) == cases(design(*over, sample="lhs:5", seed=0))
    assert cases(design(*over, sample="lhs:5")) != cases(design(*over, sample="lhs:5", seed=1))


def test_a_seed_without_samples_is_refused() -> None:
    with pytest.raises(InputError, match="--seed 3 makes samples"):
        design("mechanics.damping=1,2", seed=3)


def test_samples_of_whole_numbers_are_whole_and_reach_both_ends() -> None:
    found = cases(design("mechanics.n_steps=10..12", sample="lhs:30"))
    assert sorted({value for (value,) in found}) == [10, 11, 12]


def test_samples_may_be_even_in_the_logarithm() -> None:
    found = np.array(cases(design("mechanics.damping=0.01..1:log", sample="lhs:40")))
    assert (found < 0.1).sum() == 20


def test_lists_and_samples_combine() -> None:
    found = design("mechanics.n_steps=10,20", "mechanics.damping=0..2", sample="lhs:3")
    assert found.shape == (2, 3)


@pytest.mark.parametrize(
    ("over", "sample", "part"),
    [
        ("mechanics.damping=0..1", "grid:3", "choose lhs:N or sobol:N"),
        ("mechanics.damping=0..1", "lhs", "the number of samples"),
        ("mechanics.damping=0..1", "lhs:0", "the number of samples"),
        ("mechanics.damping=1,2", "lhs:3", "LOW..HIGH"),
        ("mechanics.damping=1..1", "lhs:3", "the interval is empty"),
        ("mechanics.damping=2..1", "lhs:3", "the interval is empty"),
        ("mechanics.damping=0..1:log", "lhs:3", "numbers above 0"),
    ],
)
def test_wrong_samples_are_told(over: str, sample: str, part: str) -> None:
    with pytest.raises(InputError, match=part.replace("(", r"\(")):
        design(over, sample=sample)
