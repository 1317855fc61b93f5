"""Fields that a sweep may run over: one number, text or switch each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, get_origin

from pydantic import BaseModel

from pipeline.config.fields import Declared
from pipeline.config.layers import literal
from pipeline.config.problems import expected
from pipeline.config.quantities import NoQuantity, to_unit
from pipeline.config.variants import Variants
from pipeline.errors import InputError

Scalar = float | int | str | bool


@dataclass(frozen=True)
class Field:
    """A field of the configuration.

    Attributes
    ----------
    path
        Dotted name.
    unit
        Unit of its numbers; empty for none.
    declared
        What the configuration declares there.
    """

    path: str
    unit: str
    declared: Declared = field(compare=False, repr=False)

    @property
    def names(self) -> tuple[str, ...]:
        """The parts of the dotted name."""
        return tuple(self.path.split("."))

    @property
    def is_whole(self) -> bool:
        """Whether its numbers are whole ones."""
        origins = self.declared.origins()
        return int in origins and float not in origins

    @property
    def takes_numbers(self) -> bool:
        """Whether numbers are allowed."""
        return bool({int, float, Any} & set(self.declared.origins()))

    @property
    def takes_texts(self) -> bool:
        """Whether texts are allowed, such as the names of models."""
        texts = any(isinstance(value, str) for value in self.declared.literals())
        choice = self.declared.any_choice()
        return texts or choice is not None or bool({str, Any} & set(self.declared.origins()))

    def value(self, text: str) -> Scalar:
        """Value of a text, numbers in the field's unit.

        Raises
        ------
        InputError
            If it is no single value, or a number of another dimension.
        """
        value = literal(text)
        if isinstance(value, str) and self.unit and value not in self.declared.literals():
            try:
                number = to_unit(value, self.unit)
            except NoQuantity as reason:
                if self.takes_texts:
                    return value
                raise InputError(
                    f'{self.path} = "{value}": expected a number in {self.unit}, or one with a unit '
                    f"that converts to {self.unit}; {reason}"
                ) from reason
            return int(number) if self.is_whole and number.is_integer() else number
        if isinstance(value, bool | str):
            return value
        if isinstance(value, int | float):
            return float(value) if float in self.declared.origins() else value
        raise InputError(f"{self.path} = {text}: a sweep takes one value at a time")


def find_field(path: str, variants: Variants[Any], option: str) -> Field:
    """The field of a dotted name.

    Raises
    ------
    InputError
        If there is none, or it does not hold one value.
    """
    names = [name.strip() for name in path.split(".")]
    path = ".".join(names)
    if not all(names):
        raise InputError(f"{option} needs SECTION.KEY=VALUES, got {path!r}")
    declared = _declared(type(variants.common), variants.common, names)
    if declared is None:
        # The nearest name is told where configurations are read; a model that a sweep chooses, too,
        # may have fields of which nothing is known yet.
        _refuse_unknown(variants, names)
        return Field(path, "", Declared(Any))
    if not _holds_one_value(declared):
        raise InputError(_not_scalar(path, declared, _value(variants.common, names)))
    return Field(path, declared.unit, declared)


def _declared(model: type[BaseModel], data: Any, names: Sequence[str]) -> Declared | None:
    """Declaration along the validated values, whose models are known."""
    declared: Declared | None = Declared(model)
    for name in names:
        if declared is None:
            return None
        if isinstance(data, BaseModel):
            declared = Declared.of(type(data), name)
        elif isinstance(data, Mapping):
            declared = declared.item(name)
        elif isinstance(data, list | tuple) and name.isdigit() and int(name) < len(data):
            declared = declared.item(int(name))
        else:
            return None
        data = _item(data, name)
    return declared


def _value(data: Any, names: Sequence[str]) -> Any:
    for name in names:
        data = _item(data, name)
    return data


def _item(data: Any, name: str) -> Any:
    if isinstance(data, BaseModel):
        return getattr(data, name, None)
    if isinstance(data, Mapping):
        return data.get(name)
    if isinstance(data, list | tuple) and name.isdigit() and int(name) < len(data):
        return data[int(name)]
    return None


def value_at(config: BaseModel, path: str) -> Any:
    """Value of a validated configuration at a dotted name, ``None`` if there is nothing."""
    value = _value(config, path.split("."))
    return getattr(value, "name", None) if isinstance(value, BaseModel) else value


def _holds_one_value(declared: Declared) -> bool:
    scalars = (float, int, str, bool, Any)
    return any(
        member.choice is not None or member.hint in scalars or get_origin(member.hint) is Literal
        for member in declared.members()
    )


def _not_scalar(path: str, declared: Declared, value: Any) -> str:
    if isinstance(value, BaseModel):
        items = [f"{path}.{name}" for name in type(value).model_fields]
    elif isinstance(value, Mapping):
        items = [f"{path}.{name}" for name in value]
    elif isinstance(value, list | tuple):
        items = [f"{path}.{i}" for i in range(len(value))]
    else:
        items = []
    kind = expected(declared) if items or declared.models() else "not one value"
    remedy = f": sweep over one of its values: {', '.join(items)}" if items else ""
    return f"{path} is {kind}, and a sweep runs over single values{remedy}"


def _refuse_unknown(variants: Variants[Any], names: Sequence[str]) -> None:
    """Let the configuration say what is wrong with a name."""
    try:
        variants.load([(tuple(names), "?")])
    except InputError as error:
        if "no such parameter" in str(error) or "there is no such item" in str(error):
            lines = str(error).splitlines()
            told = [one for one in lines if "no such" in one] or lines
            raise InputError(told[0].replace(' = "?"', "")) from error
