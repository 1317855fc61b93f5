"""All parameters of a configuration, as rows for people."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from pydantic import BaseModel

from pipeline.config.fields import Choice, Declared, fields_of


@dataclass(frozen=True)
class Parameter:
    """One parameter: dotted name, value in ``unit``, and where it comes from."""

    name: str
    value: Any
    unit: str
    description: str
    source: str


def describe(config: BaseModel) -> list[Parameter]:
    """Rows for every parameter of a validated configuration, in the order of declaration."""
    return list(_model_rows(config, ""))


def _model_rows(model: BaseModel, path: str, choice: Choice | None = None) -> Iterator[Parameter]:
    """Rows of a model; ``choice`` tells what else its name could have been."""
    libraries = {one.library for _, field in fields_of(type(model)) if (one := field.any_choice())}
    for name, declared in fields_of(type(model)):
        if choice is not None and name == choice.tag:
            declared = replace(declared, description=offer(choice))
        value = getattr(model, name)
        if name in libraries:  # of many sets one is in use; its values stand with the choice
            value, declared = list(value), replace(declared, hint=list[str])
        yield from _rows(value, declared, f"{path}.{name}".lstrip("."))


def _rows(value: Any, declared: Declared, path: str) -> Iterator[Parameter]:
    if isinstance(value, BaseModel):
        yield from _model_rows(value, path, declared.any_choice())
    elif isinstance(value, list | tuple) and any(isinstance(item, BaseModel) for item in value):
        for i, item in enumerate(value):
            yield from _rows(item, declared.item(i), f"{path}.{i}")
    elif isinstance(value, Mapping) and value:
        for name, item in value.items():
            yield from _rows(item, declared.item(name), f"{path}.{name}")
    else:
        yield Parameter(path, value, declared.unit, _meaning(value, declared), declared.source)


def _meaning(value: Any, declared: Declared) -> str:
    """The description; of an empty table also what its entries could be."""
    choice = declared.item("").any_choice() if isinstance(value, Mapping) else None
    return (
        f"{declared.description}; {choice.tag} {offer(choice)}" if choice else declared.description
    )


def offer(choice: Choice) -> str:
    """The names on offer, in words."""
    return f"one of: {', '.join(choice.names())}"
