"""A model may be chosen by the name of a set of parameters in a table beside it."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

import pytest
from pydantic import BaseModel, ConfigDict, Field, GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from pipeline.config import describe, load
from pipeline.errors import InputError


class Spring(BaseModel):
    model_config = ConfigDict(extra="forbid")
    name: str = "spring"
    stiffness: float = Field(json_schema_extra={"unit": "mN/mm"})
    rest: float = Field(json_schema_extra={"unit": "mm"})


class OneOf:
    package = "springs"
    tag = "name"
    library = "springs"
    known: ClassVar[dict[str, type[BaseModel]]] = {"spring": Spring}

    def names(self) -> list[str]:
        return ["spring"]

    def load(self, name: str) -> type[BaseModel]:
        return self.known[name]

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(Spring.model_validate)


AnySpring = Annotated[Spring, OneOf()]


class Machine(BaseModel):
    spring: AnySpring
    springs: dict[str, AnySpring] = {}


class Plant(BaseModel):
    machine: Machine


SETS = {
    "machine": {
        "spring": "soft",
        "springs": {
            "soft": {"name": "spring", "stiffness": 1.0, "rest": 2.0},
            "stiff": {"name": "spring", "stiffness": "9 N/m", "rest": 3.0},
        },
    }
}


def spring(*overrides: str, **changes: Any) -> Spring:
    layers = [SETS, {"machine": changes}]
    return load(Plant, layers, overrides).machine.spring


def test_a_name_takes_its_set() -> None:
    assert spring() == Spring(stiffness=1.0, rest=2.0)
    assert spring("machine.spring=stiff") == Spring(stiffness=9.0, rest=3.0)


def test_a_set_may_be_taken_with_changes_in_any_unit() -> None:
    changed = Spring(stiffness=9.0, rest=0.5)
    assert spring("machine.spring=stiff", "machine.spring.rest=500 um") == changed
    assert spring(spring={"name": "stiff", "rest": "500 um"}) == changed
    assert spring("machine.spring.rest=500 um") == Spring(stiffness=1.0, rest=0.5)


def test_a_whole_table_needs_no_set() -> None:
    table = {"name": "spring", "stiffness": 4.0, "rest": 1.0}
    assert spring(spring=table) == Spring(stiffness=4.0, rest=1.0)


@pytest.mark.parametrize("given", ["stif", {"name": "stif", "rest": 1.0}])
def test_an_unknown_name_is_answered_with_sets_and_models(given: Any) -> None:
    with pytest.raises(InputError, match=r'= "stif": choose one of: soft, spring, stiff; did you'):
        spring(spring=given)


def test_the_sets_are_told_by_name_only() -> None:
    rows = {row.name: row.value for row in describe(load(Plant, [SETS]))}
    assert rows["machine.springs"] == ["soft", "stiff"]
    assert rows["machine.spring.stiffness"] == 1.0
