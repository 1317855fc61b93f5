"""Named sets of parameters: a model may be chosen by the name of a set in a table beside it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel

from pipeline.config.fields import Choice, fields_of
from pipeline.config.problems import nearest, shown


def expanded(
    model: type[BaseModel], data: Mapping[str, Any], path: str = ""
) -> tuple[dict[str, Any], dict[str, str]]:
    """Table in which every model that is chosen by the name of a set has that set's parameters.

    Where a field's choice has a library, its value may be the name of a set there, or a table that
    has this name and some parameters of its own. The second value tells, by dotted name, of names
    that are neither a set's nor a model's.
    """
    result, problems = dict(data), {}
    for name, declared in fields_of(model):
        if name not in data:
            continue
        value, place = data[name], f"{path}.{name}".lstrip(".")
        choice = declared.any_choice()
        sets = data.get(choice.library) if choice is not None and choice.library else None
        if choice is not None and isinstance(sets, Mapping):
            result[name], problem = _chosen(value, sets, choice)
            if problem:
                problems[place] = f"{place}{problem}"
        elif isinstance(value, list | tuple):
            items = enumerate(value)
            result[name] = [_changed(one, data, declared.item(i).any_choice()) for i, one in items]
        elif isinstance(value, Mapping) and (inner := declared.model(value)) is not None:
            result[name], found = expanded(inner, value, place)
            problems |= found
    return {key: result[key] for key in data}, problems


def _changed(item: Any, data: Mapping[str, Any], choice: Choice | None) -> Any:
    """An item of a list; a table with the ``name`` of a set is that set with what else the table says.

    Items that are names alone stay: the model looks them up.
    """
    sets = data.get(choice.library) if choice is not None and choice.library else None
    name = item.get("name") if isinstance(item, Mapping) else None
    if not isinstance(sets, Mapping) or not isinstance(sets.get(name), Mapping):
        return item
    return sets[name] | {key: one for key, one in item.items() if key != "name"}


def _chosen(value: Any, sets: Mapping[str, Any], choice: Choice) -> tuple[Any, str]:
    """A choice with the parameters of its set, and what is wrong with its name."""
    table = {choice.tag: value} if isinstance(value, str) else value
    name = table.get(choice.tag) if isinstance(table, Mapping) else None
    if not isinstance(name, str):
        return value, ""
    if isinstance(sets.get(name), Mapping):
        return sets[name] | {key: one for key, one in table.items() if key != choice.tag}, ""
    allowed = sorted({*sets, *choice.names()})
    if name in allowed:
        return value, ""
    tag = "" if isinstance(value, str) else f".{choice.tag}"
    words = f"choose one of: {', '.join(allowed)}{nearest(name, allowed)}"
    return value, f"{tag} = {shown(name)}: {words}"
