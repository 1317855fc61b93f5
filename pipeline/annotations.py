"""Declared types of fields and parameters, read without importing what only type checkers need.

A module may import numpy under ``if TYPE_CHECKING`` alone, so that planning stays light. Names that
are then unknown at run time stand for :class:`Unknown`, which is compatible with everything.
"""

from __future__ import annotations

import ast
import builtins
import dataclasses
import inspect
import sys
import types
import typing
from collections.abc import Callable, Iterator, Mapping
from functools import cache, lru_cache
from pathlib import Path
from typing import Annotated, Any, TypeAlias, Union, get_args, get_origin


class Unknown:
    """Stands for a type that is not imported at run time."""

    def __getattr__(self, name: str) -> Unknown:
        if name.startswith("__"):
            raise AttributeError(name)
        return self

    def __getitem__(self, item: Any) -> Unknown:
        return self

    def __call__(self, *args: Any, **kwargs: Any) -> Unknown:
        return self

    def __or__(self, other: Any) -> Any:
        return Union[Any, other]  # noqa: UP007

    __ror__ = __or__


class _Names(dict[str, Any]):
    """Names seen by an annotation: those of its module, then builtins, then :class:`Unknown`."""

    def __init__(self, module: Mapping[str, Any]) -> None:
        self.module = module

    def __missing__(self, name: str) -> Any:
        if name in self.module:
            return self.module[name]
        return getattr(builtins, name, Unknown())


def parameter_hints(function: Callable[..., Any]) -> dict[str, Any]:
    """Declared type of each parameter of a function, and of ``"return"``."""
    names = _Names(getattr(function, "__globals__", {}))
    return {name: _resolve(hint, names) for name, hint in function.__annotations__.items()}


Fields: TypeAlias = tuple[tuple[str, Any, Mapping[str, Any]], ...]
"""Name, declared type and extra information of each field."""


def field_hints(structure: type[Any]) -> Fields:
    """Declared fields of a dataclass or pydantic model, without those derived from others."""
    return _field_hints(structure)  # type: ignore[arg-type]  # every class is hashable


@cache
def _field_hints(structure: Any) -> Fields:
    if hasattr(structure, "model_fields"):
        return tuple(
            (name, info.annotation, _mapping(info.json_schema_extra))
            for name, info in structure.model_fields.items()
        )
    hints = _dataclass_hints(structure)
    return tuple(
        (f.name, hints[f.name], f.metadata) for f in dataclasses.fields(structure) if f.init
    )


def complete_field_hints(structure: type[Any]) -> dict[str, Any]:
    """Declared type of each field of a dataclass, names for type checkers imported after all.

    For reading a record, when its modules are needed anyway.
    """
    return _dataclass_hints(structure, _type_checking_imports)


def alternatives(hint: Any) -> tuple[Any, ...]:
    """Members of a union, with ``Annotated`` and type aliases taken off.

    Examples
    --------
    >>> alternatives(float | None)
    (<class 'float'>, <class 'NoneType'>)
    """
    return _remembered(_alternatives, hint)


def item_hints(hint: Any, place: int | str) -> Any:
    """Declared type of the item at an index or key of a container declared as ``hint``."""
    # All keys of a mapping are declared alike.
    return _remembered(_item_hints, hint, "" if isinstance(place, str) else place)


def _remembered(function: Any, *arguments: Any) -> Any:
    """What a cached function gives, also for annotations that cannot be hashed."""
    try:
        return function(*arguments)
    except TypeError:
        return function.__wrapped__(*arguments)


@lru_cache(maxsize=1024)
def _alternatives(hint: Any) -> tuple[Any, ...]:
    hint = getattr(hint, "__value__", hint)
    if get_origin(hint) is Annotated:
        return alternatives(get_args(hint)[0])
    if get_origin(hint) in (Union, types.UnionType):
        return tuple(one for member in get_args(hint) for one in alternatives(member))
    return (hint,)


@lru_cache(maxsize=1024)
def _item_hints(hint: Any, place: int | str) -> Any:
    found = tuple(
        one for member in alternatives(hint) for one in _items(member, place) if one is not Any
    )
    return Union[found] if found else Any  # noqa: UP007 - the members are only known here


def _items(member: Any, place: int | str) -> Iterator[Any]:
    arguments = get_args(member)
    origin = get_origin(member)
    if not arguments or not isinstance(origin, type):
        return
    if isinstance(place, str):
        if issubclass(origin, Mapping) and len(arguments) == 2:
            yield arguments[1]
    elif issubclass(origin, tuple) and not (len(arguments) == 2 and arguments[1] is Ellipsis):
        if place < len(arguments):
            yield arguments[place]
    elif not issubclass(origin, Mapping):
        yield arguments[0]


def _dataclass_hints(
    structure: type, more_names: Callable[[str], Mapping[str, Any]] = lambda module: {}
) -> dict[str, Any]:
    hints: dict[str, Any] = {}
    for base in reversed(structure.__mro__):
        module = vars(sys.modules.get(base.__module__, typing))
        names = _Names({**more_names(base.__module__), **module})
        for name, hint in inspect.get_annotations(base).items():
            hints[name] = _resolve(hint, names)
    return hints


def _resolve(hint: Any, names: _Names) -> Any:
    if not isinstance(hint, str):
        return hint
    try:
        return eval(hint, {}, names)
    except TypeError:  # an expression that mixes known and unknown types in an unusual way
        return Unknown()


@cache
def _type_checking_imports(module: str) -> Mapping[str, Any]:
    """Names that a module imports under ``if TYPE_CHECKING``."""
    loaded = sys.modules.get(module)
    path = getattr(loaded, "__file__", None)
    if path is None or not path.endswith(".py"):
        return {}
    names = {"__name__": module, "__package__": getattr(loaded, "__package__", None)}
    for node in ast.parse(Path(path).read_bytes()).body:
        if isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING"):
            imports = [one for one in node.body if isinstance(one, ast.Import | ast.ImportFrom)]
            exec(compile(ast.Module(body=[*imports], type_ignores=[]), path, "exec"), names)
    return names


def _mapping(extra: Any) -> Mapping[str, Any]:
    return extra if isinstance(extra, Mapping) else {}
