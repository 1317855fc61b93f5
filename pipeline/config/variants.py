"""Configurations that differ in few fields, read so fast that thousands of them can be checked first.

What a section holds is read, converted and validated once, and the validated section then serves every
configuration that has the same values there. A model that fills in fields across sections, before they
are validated, does this in a class method ``completed(data)``, which leaves validated sections alone; one
that has another validator of that kind is read as a whole each time.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any, Generic, TypeAlias, TypeVar

from pydantic import BaseModel, ValidationError, create_model
from pydantic_core import PydanticCustomError

from pipeline.config import load
from pipeline.config.fields import Declared, fields_of
from pipeline.config.layers import nested, overridden
from pipeline.config.libraries import expanded
from pipeline.config.picks import laid_over
from pipeline.config.quantities import converted
from pipeline.errors import InputError

M = TypeVar("M", bound=BaseModel)

Setting: TypeAlias = tuple[tuple[str, ...], Any]
"""Dotted name, as a sequence, and value of one field."""

REMEMBERED = 20_000
"""Validated sections that are kept at most, some 10 kB each."""


class Variants(Generic[M]):
    """Configurations made from the same tables by setting few fields.

    Parameters
    ----------
    model, layers, overrides
        As those of :func:`pipeline.config.load`: what all have in common.

    Raises
    ------
    InputError
        If these make no valid configuration.
    """

    def __init__(
        self,
        model: type[M],
        layers: Sequence[Mapping[str, Any]],
        overrides: Sequence[str] = (),
    ) -> None:
        self._model = model
        self.tables: dict[str, Any] = laid_over(model, (*layers, overridden({}, overrides)))
        self.common: M = load(model, [self.tables])
        self._converted = self._read(self.tables)[0]
        self._sections = {
            name: one for name in self.tables if (one := _section(model, name)) is not None
        }
        self._validated: dict[tuple[str, str], BaseModel] = {}
        self._needing_tables = {
            name
            for name, section in self._sections.items()
            if _reads_whole(section) or section.__pydantic_decorators__.field_validators
        }
        self._whole = _unsectioned(model, self._sections)
        self._apart = hasattr(model, "completed") or not _reads_whole(model)
        self._apart &= not hasattr(model, "picks")

    def load(self, settings: Sequence[Setting]) -> M:
        """Configuration with some fields set, shorter names first.

        Raises
        ------
        InputError
            As :func:`pipeline.config.load`.
        """
        settings = sorted(settings, key=lambda setting: len(setting[0]))
        layer = nested(settings)
        if self._apart:
            try:
                found = self._by_sections(layer)
            except (ValidationError, PydanticCustomError, InputError):
                found = None  # the whole tells what is wrong, in its words
            if found is not None:
                return found
        return load(self._model, [self.tables, layer])

    def _by_sections(self, layer: Mapping[str, Any]) -> M | None:
        data, keys = dict(self._converted), dict.fromkeys(self._sections, "")
        for name, changes in layer.items():
            section = self._sections.get(name)
            if section is None or not isinstance(changes, Mapping):
                return None
            changed = self._changed(name, section, changes)
            if changed is None:
                return None
            data[name], keys[name] = changed, json.dumps(changes, sort_keys=True, default=repr)
        completed = getattr(self._model, "completed", None)
        if completed is not None:
            before, data = data, completed(data)
            for name in self._sections:
                if data[name] is not before[name]:
                    keys[name] = json.dumps(data[name], default=repr)
        for name, section in self._sections.items():
            data[name] = self._validate(name, section, data[name], keys[name])
        self._whole.model_validate(data)
        return self._model.model_construct(**data)

    def _changed(
        self, name: str, section: type[BaseModel], changes: Mapping[str, Any]
    ) -> dict[str, Any] | None:
        """Table of a section; only the fields that change are converted, and validated, anew."""
        tables = laid_over(section, (self.tables[name], changes))
        has_library = any(
            (choice := declared.any_choice()) and choice.library
            for _, declared in fields_of(section)
        )
        whole = has_library and not all(_is_plain(section, field) for field in changes)
        part = tables if whole else {field: tables[field] for field in changes}
        read, problems = self._read({name: part})
        if problems:
            return None
        if whole:
            return dict(read[name])
        kept: Mapping[str, Any] = self._converted[name]
        if name not in self._needing_tables:
            kept = vars(getattr(self.common, name))
        elif not whole:
            kept = {**kept, **self._libraries(name, section)}
        return {**{field: kept[field] for field in tables if field not in changes}, **read[name]}

    def _libraries(self, name: str, section: type[BaseModel]) -> dict[str, Any]:
        """Tables of named models in a section, validated: that takes longer than all else in it."""
        valid = getattr(self.common, name)
        fields = [field for field, declared in fields_of(section) if declared.origins() == [dict]]
        return {field: getattr(valid, field) for field in fields if field in self._converted[name]}

    def _validate(self, name: str, section: type[BaseModel], data: Any, key: str) -> Any:
        found = self._validated.get((name, key))
        if found is None:
            if len(self._validated) >= REMEMBERED:
                self._validated.clear()
            found = self._validated[name, key] = section.model_validate(data)
        return found

    def _read(self, tables: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, str]]:
        data, problems = expanded(self._model, tables)
        data, unread = converted(self._model, data)
        return data, problems | unread


def _section(model: type[BaseModel], name: str) -> type[BaseModel] | None:
    """Model of a field, if it is one plain model."""
    declared = Declared.of(model, name)
    if declared is None or len(declared.members()) != 1 or declared.choice is not None:
        return None
    return next(iter(declared.models()), None)


def _is_plain(model: type[BaseModel], name: str) -> bool:
    """Whether a field holds a number, a text or a truth value: no other field's meaning hangs on it."""
    declared = Declared.of(model, name)
    return declared is not None and set(declared.origins()) <= _PLAIN


_PLAIN = {int, float, bool, str, type(None)}


def _unsectioned(model: type[M], sections: Mapping[str, Any]) -> type[M]:
    """The same model with the same checks, which takes its sections as they are.

    A section that is validated already would be checked again otherwise.
    """
    fields: dict[str, Any] = dict.fromkeys(sections, (Any, ...))
    return create_model(model.__name__, __base__=model, **fields)


def _reads_whole(model: type[BaseModel]) -> bool:
    """Whether something looks at the model's table before its fields are validated."""
    validators = model.__pydantic_decorators__.model_validators.values()
    return any(validator.info.mode != "after" for validator in validators)
