"""Where a value of a table belongs in the model: its declared type, unit and choices."""

from __future__ import annotations

import typing
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Annotated, Any, Literal, Protocol, get_args, get_origin, runtime_checkable

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from pipeline.annotations import item_hints


@runtime_checkable
class Choice(Protocol):
    """Annotation of a field whose model is picked by name, such as ``OneOf``.

    ``tag`` is the key of a table that holds the name; ``library`` that of the table, beside the field,
    whose named sets of parameters may be chosen too.
    """

    package: str
    tag: str
    library: str | None

    def names(self) -> list[str]:
        """Names on offer."""
        ...

    def load(self, name: str) -> type[BaseModel]:
        """Model of a name."""
        ...


ITEMS = 100
"""Items of a list or dict whose declarations are kept."""


@dataclass(frozen=True)
class Declared:
    """Declaration of a value: its type, its unit (that of the field it is in) and its choice.

    What follows from these is found once for each declaration: thousands of tables of one model may be
    read in a row.
    """

    hint: Any
    unit: str = ""
    description: str = ""
    source: str = ""
    choice: Choice | None = None

    @classmethod
    def of(cls, model: type[BaseModel], name: str) -> Declared | None:
        """Declaration of the field of a model, ``None`` if it has no such field."""
        return _fields(model).get(name)

    @classmethod
    def of_field(cls, info: FieldInfo) -> Declared:
        """Declaration of a model's field."""
        extra = info.json_schema_extra
        known: Mapping[str, Any] = extra if isinstance(extra, Mapping) else {}
        return cls(
            info.annotation,
            unit=str(known.get("unit", "")),
            description=info.description or "",
            source=str(known.get("source", "")),
            choice=_choice(info.metadata),
        ).opened()

    def opened(self) -> Declared:
        """The same with ``Annotated`` taken off."""
        hint = getattr(self.hint, "__value__", self.hint)
        if get_origin(hint) is not Annotated:
            return replace(self, hint=hint)
        inner, *metadata = get_args(hint)
        return replace(self, hint=inner, choice=_choice(metadata) or self.choice).opened()

    def members(self) -> tuple[Declared, ...]:
        """Members of a union, or the declaration itself."""
        return self._members

    @cached_property
    def _members(self) -> tuple[Declared, ...]:
        if get_origin(self.hint) in _UNIONS:
            return tuple(
                one
                for hint in get_args(self.hint)
                for one in replace(self, hint=hint).opened().members()
            )
        return (self,)

    def any_choice(self) -> Choice | None:
        """Choice of the first member that has one."""
        return next((member.choice for member in self.members() if member.choice), None)

    def item(self, place: int | str) -> Declared:
        """Declaration of an item of a list or dict."""
        found = self._items.get(place)
        if found is None:
            found = replace(self, hint=item_hints(self.hint, place), choice=None).opened()
            if len(self._items) < ITEMS:
                self._items[place] = found
        return found

    @cached_property
    def _items(self) -> dict[int | str, Declared]:
        return {}

    def literals(self) -> list[Any]:
        """Values on offer, if only certain ones are allowed."""
        return [
            value
            for member in self.members()
            if get_origin(member.hint) is Literal
            for value in get_args(member.hint)
        ]

    def origins(self) -> list[Any]:
        """Classes of the members: ``tuple`` for ``tuple[int, int]``."""
        return self._origins

    @cached_property
    def _origins(self) -> list[Any]:
        return list(dict.fromkeys(get_origin(m.hint) or m.hint for m in self.members()))

    def models(self) -> list[type[BaseModel]]:
        """Members that are models."""
        return self._models

    @cached_property
    def _models(self) -> list[type[BaseModel]]:
        return [
            one for one in self.origins() if isinstance(one, type) and issubclass(one, BaseModel)
        ]

    def model(self, data: Any) -> type[BaseModel] | None:
        """Model that a table is for; ``None`` if there is none or its name is not on offer."""
        for member in self.members():
            if member.choice is not None:
                name = data if isinstance(data, str) else _entry(data, member.choice.tag)
                if isinstance(name, str) and (found := _picked(member.choice, name)):
                    return found
        if not isinstance(data, Mapping):
            return None
        fitting = [model for model in self.models() if _tags_fit(model, data)]
        return max(
            fitting or self.models(),
            key=lambda model: len(model.model_fields.keys() & data.keys()),
            default=None,
        )


def fields_of(model: type[BaseModel]) -> Iterator[tuple[str, Declared]]:
    """Name and declaration of each field of a model."""
    yield from _fields(model).items()


@cache
def _fields(model: type[BaseModel]) -> dict[str, Declared]:
    return {name: Declared.of_field(info) for name, info in model.model_fields.items()}


def _choice(metadata: Sequence[Any]) -> Choice | None:
    return next((item for item in metadata if isinstance(item, Choice)), None)


def _picked(choice: Choice, name: str) -> type[BaseModel] | None:
    """Model of a name, if it is on offer; looked for on disk until it has been found once."""
    found = _PICKED.get((choice, name))
    if found is None and name in choice.names():
        found = _PICKED[choice, name] = choice.load(name)
    return found


_PICKED: dict[tuple[Choice, str], type[BaseModel]] = {}


def _entry(data: Any, key: str) -> Any:
    return data.get(key) if isinstance(data, Mapping) else None


def _tags_fit(model: type[BaseModel], data: Mapping[str, Any]) -> bool:
    """Whether the tags of a table (fields with certain values, such as ``kind``) are the model's."""
    return all(
        data[name] in allowed
        for name, declared in fields_of(model)
        if name in data and (allowed := declared.literals())
    )


_UNIONS = (typing.Union, type(int | str))
