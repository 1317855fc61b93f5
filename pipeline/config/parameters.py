"""All parameters of a configuration, as rows for people."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from pipeline.config.fields import Declared, fields_of


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


def _model_rows(model: BaseModel, path: str) -> Iterator[Parameter]:
    for name, declared in fields_of(type(model)):
        yield from _rows(getattr(model, name), declared, f"{path}.{name}".lstrip("."))


def _rows(value: Any, declared: Declared, path: str) -> Iterator[Parameter]:
    if isinstance(value, BaseModel):
        yield from _model_rows(value, path)
    elif isinstance(value, list | tuple) and any(isinstance(item, BaseModel) for item in value):
        for i, item in enumerate(value):
            yield from _rows(item, declared.item(i), f"{path}.{i}")
    elif isinstance(value, Mapping):
        for name, item in value.items():
            yield from _rows(item, declared.item(name), f"{path}.{name}")
    else:
        yield Parameter(path, value, declared.unit, declared.description, declared.source)
