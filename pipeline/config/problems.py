"""Validation errors in the user's words: field, value, what is allowed, the nearest valid name."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any, Literal

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from pipeline.config.fields import Declared, fields_of

BOUNDS = {
    "greater_than": ("gt", "greater than"),
    "greater_than_equal": ("ge", "at least"),
    "less_than": ("lt", "less than"),
    "less_than_equal": ("le", "at most"),
    "multiple_of": ("multiple_of", "a multiple of"),
}

KINDS = {
    float: ("a number", "numbers"),
    int: ("a whole number", "whole numbers"),
    bool: ("true or false", "true or false"),
    str: ("a text", "texts"),
    type(None): ("nothing", "nothing"),
}


@dataclass(frozen=True)
class Place:
    """Where an error lies: dotted name, declaration, and the model that the name is in."""

    path: str
    declared: Declared
    owner: type[BaseModel] | None


def told(
    model: type[BaseModel], data: Any, error: ValidationError, known: Mapping[str, str]
) -> list[str]:
    """One line for each field that is wrong; ``known`` holds lines that are there already."""
    found: dict[str, dict[str, None]] = {}
    for item in map(_whole_list, error.errors(include_url=False)):
        place = locate(model, data, item["loc"])
        if place.path not in known:
            found.setdefault(_head(place, item), {})[_words(place, item, model)] = None
    return [*known.values(), *(f"{head}{_joined(words)}" for head, words in found.items())]


def locate(model: type[BaseModel], data: Any, loc: Sequence[int | str]) -> Place:
    """Follow an error's location; parts of it that are only members of a union are left out.

    An error in an item of a list that is the name of a set in a library lies in that set.
    """
    names: list[str] = []
    declared, owner = Declared(model), None
    table: tuple[list[str], Any] = ([], data)
    for i, step in enumerate(loc):
        inner: Declared | None = declared.item(step)
        if isinstance(step, int) and (found := _set_named(inner, _item(data, step), table[1])):
            names, data, declared = [*table[0], *found[0]], found[1], declared.item(step)
            continue
        if isinstance(step, str):
            table = list(names), data
            owner_now = declared.model(data) or next(iter(declared.models()), None)
            named = isinstance(data, Mapping) and step in data
            inner = (Declared.of(owner_now, step) if owner_now else None) or (
                inner if named else None
            )
            if inner is None:
                if tagged := _tagged(declared, step):
                    declared = Declared(tagged)
                if tagged or owner_now is None or i < len(loc) - 1:
                    continue
                inner = Declared(Any)
            owner = owner_now
        assert inner is not None
        names.append(str(step))
        declared, data = inner, _item(data, step)
    return Place(".".join(names), declared, owner)


def nearest(name: str, valid: Sequence[str]) -> str:
    """``"; did you mean ...?"`` if a valid name begins with this one or is near, else nothing.

    Examples
    --------
    >>> nearest("nash", ["goektepe-kuhl", "nash-panfilov"])
    "; did you mean 'nash-panfilov'?"
    """
    begun = [one for one in valid if len(name) > 1 and one.lower().startswith(name.lower())]
    near = begun or get_close_matches(name, valid, n=1, cutoff=0.5)
    return f"; did you mean {near[0]!r}?" if near else ""


def _head(place: Place, item: ErrorDetails) -> str:
    kind, value = item["type"], item["input"]
    if not place.path:
        return ""
    if kind == "unknown_name":
        choice = place.declared.any_choice()
        tag = f".{choice.tag}" if choice and isinstance(value, Mapping) else ""
        return f"{place.path}{tag} = {shown(item['ctx']['given'])}: "
    if kind == "missing" or isinstance(value, Mapping | BaseModel):
        return f"{place.path}: "
    return f"{place.path} = {shown(value)}: "


def _words(place: Place, item: ErrorDetails, root: type[BaseModel]) -> str:
    kind, context = item["type"], item.get("ctx", {})
    unit = f" {place.declared.unit}" if place.declared.unit else ""
    if kind == "missing":
        about = f" ({place.declared.description})" if place.declared.description else ""
        return f"is missing; give {expected(place.declared)}{about}"
    if kind == "extra_forbidden":
        return _unknown_key(place, root)
    if kind in BOUNDS:
        name, words = BOUNDS[kind]
        return f"must be {words} {context[name]:g}{unit}"
    if kind == "unknown_name":  # a model picked by name
        names = str(context["allowed"]).split(", ")
        return f"choose one of: {', '.join(names)}{nearest(str(context['given']), names)}"
    if kind == "literal_error":
        literals = [str(value) for value in place.declared.literals()]
        return f"must be {expected(place.declared)}{nearest(str(item['input']), literals)}"
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        tags = str(context.get("expected_tags", "")).replace("'", "")
        near = nearest(str(context.get("tag", "")), tags.split(", "))
        name = str(context["discriminator"]).strip("'")
        return f"{name} must be one of: {tags}{near}" if tags else f"needs {name}"
    if kind == "finite_number":
        return "must be a finite number"
    if kind.endswith(("_type", "_parsing", "_from_float", "too_long", "too_short")):
        return f"must be {expected(place.declared)}"
    return item["msg"].removeprefix("Value error, ").removeprefix("Assertion failed, ")


def expected(declared: Declared) -> str:
    """What a declaration allows, in words.

    Examples
    --------
    >>> expected(Declared(tuple[int, int]))
    'a list of 2 whole numbers'
    >>> expected(Declared(float, unit="mm"))
    'a number in mm'
    """
    unit = f" in {declared.unit}" if declared.unit else ""
    return " or ".join(dict.fromkeys(_kind(member, unit) for member in declared.members()))


def _kind(member: Declared, unit: str) -> str:
    origin = member.origins()[0]
    if member.choice is not None:
        return f"a table with a {member.choice.tag}, one of: {', '.join(member.choice.names())}"
    if origin is Literal:
        return f"one of: {', '.join(shown(value) for value in member.literals())}"
    if origin in KINDS:
        return KINDS[origin][0] + (unit if origin in (int, float) else "")
    if origin in (tuple, list):
        length = _length(member)
        item = member.item(0).origins()[0]
        items = KINDS[item][1] if item in KINDS else "items"
        return f"a list of {length}{items}{unit if item in (int, float) else ''}"
    return "a table"


def _length(member: Declared) -> str:
    arguments = getattr(member.hint, "__args__", ())
    fixed = member.origins()[0] is tuple and Ellipsis not in arguments
    return f"{len(arguments)} " if fixed and arguments else ""


def _unknown_key(place: Place, root: type[BaseModel]) -> str:
    section, _, name = place.path.rpartition(".")
    valid = list(place.owner.model_fields) if place.owner is not None else []
    elsewhere = [path for path in _all_names(root) if path.rpartition(".")[2] == name]
    here = [f"{section}.{one}".lstrip(".") for one in valid]
    near = f"; did you mean {elsewhere[0]!r}?" if elsewhere else nearest(place.path, here)
    where = f"{section} has" if section else "there are"
    return f"no such parameter{near} ({where}: {', '.join(valid)})"


def _all_names(model: type[BaseModel], path: str = "") -> Iterator[str]:
    for name, declared in fields_of(model):
        inner = f"{path}.{name}".lstrip(".")
        yield inner
        if tuple not in declared.origins():
            for section in declared.models():
                yield from _all_names(section, inner)


def _joined(words: Collection[str]) -> str:
    """What the members of a union have to say; what another one says more fully is left out."""
    kept = [one for one in words if not any(o != one and o.startswith(one) for o in words)]
    return " or ".join(kept)


def _whole_list(item: ErrorDetails) -> ErrorDetails:
    """A missing item of a list is an error of the list."""
    if item["type"] == "missing" and isinstance(item["loc"][-1], int):
        return {**item, "type": "too_short", "loc": item["loc"][:-1]}
    return item


def _tagged(declared: Declared, tag: str) -> type[BaseModel] | None:
    """Member of a union that a tag, such as the value of ``kind``, stands for."""
    for model in declared.models():
        if any(tag in field.literals() for _, field in fields_of(model)):
            return model
    return None


def _set_named(
    declared: Declared | None, name: Any, table: Any
) -> tuple[tuple[str, str], Mapping[str, Any]] | None:
    """Place below a table, and values, of the set of a library that an item of a list names."""
    choice = declared.any_choice() if declared is not None and isinstance(name, str) else None
    if choice is None or choice.library is None or not isinstance(table, Mapping):
        return None
    found = _item(table.get(choice.library), name)
    return ((choice.library, name), found) if isinstance(found, Mapping) else None


def _item(data: Any, step: int | str) -> Any:
    try:
        return data[step]
    except (TypeError, LookupError):
        return None


def shown(value: Any) -> str:
    """A value as it stands in a table, cut short."""
    try:
        text = json.dumps(value, ensure_ascii=False)
    except (TypeError, ValueError):
        text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
