"""Canonical form of plain values and configurations, and its digest.

Two configurations have the same digest exactly when every keyed field is equal *as the type that
the field declares*: ``1`` in a float field is ``1.0``, while ``1``, ``1.0``, ``True`` and ``"1"``
are otherwise four different values. Nothing depends on memory addresses, hash seeds, field order or
the version of a library.
"""

from __future__ import annotations

import dataclasses
import hashlib
import math
import struct
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any, TypeAlias

from pipeline.annotations import alternatives, field_hints, item_hints

Canonical: TypeAlias = "bool | int | float | str | list[Canonical] | dict[str, Canonical] | None"

DIGEST_BYTES = 20
"""160 bits: a collision needs about 2^80 artefacts."""


def digest(value: Any) -> str:
    """BLAKE2b digest (hexadecimal) of the canonical form of a value.

    Raises
    ------
    TypeError
        For a type that has no canonical form.
    ValueError
        For NaN and infinite numbers.

    Examples
    --------
    >>> digest({"a": 1, "b": 2}) == digest({"b": 2, "a": 1})
    True
    >>> len({digest(1), digest(1.0), digest(True), digest("1")})
    4
    """
    return canonical_digest(canonical(value))


def canonical_digest(value: Canonical) -> str:
    """The same digest of a value that is in canonical form already."""
    parts: list[bytes] = []
    _encode(value, parts)
    return hashlib.blake2b(b"".join(parts), digest_size=DIGEST_BYTES).hexdigest()


def canonical(value: Any, hint: Any = Any, path: str = "") -> Canonical:
    """Canonical form of a value: ``None``, bool, int, float, str, and lists and dicts of these.

    The order of a dict is not part of a value: two orders have one key, so the result of a stage must
    not depend on it. Sort where it matters, or declare a list.

    Parameters
    ----------
    value
        A plain value, a numpy scalar, a pydantic model or dataclass instance, or lists, tuples and
        string-keyed mappings of these.
    hint
        Declared type; decides whether an integer stands for a float.
    path
        Dotted name of the value, for messages.

    Raises
    ------
    TypeError
        For any other type.
    ValueError
        For NaN and infinite numbers.
    """
    try:
        return _canonical(value, hint)
    except _Refused as refused:
        place = ".".join(filter(None, (path, *reversed(refused.path))))
        raise refused.kind(f"{place or 'value'} {refused.words}") from None


class _Refused(Exception):  # noqa: N818 - never leaves this module
    """What is wrong with a value; ``path`` grows on the way up, so that it costs nothing otherwise."""

    def __init__(self, kind: type[Exception], words: str) -> None:
        self.kind, self.words, self.path = kind, words, list[str]()


def is_structure(value: Any) -> bool:
    """Whether a value is a pydantic model or a dataclass instance."""
    return not isinstance(value, type) and _is_structure_type(type(value))  # type: ignore[arg-type]  # every class is hashable


@cache
def _is_structure_type(kind: Any) -> bool:
    return dataclasses.is_dataclass(kind) or hasattr(kind, "model_fields")


def keyed_fields(structure: Any) -> Iterator[tuple[str, Any, Any]]:
    """Name, value and declared type of every field that can change a result.

    A field opts out by ``json_schema_extra={"keyed": False}`` (pydantic) or
    ``metadata={"keyed": False}`` (dataclass).
    """
    for name, hint in _keyed_names(type(structure)):  # type: ignore[arg-type]
        yield name, getattr(structure, name), hint


@cache
def _keyed_names(structure: Any) -> tuple[tuple[str, Any], ...]:
    fields = field_hints(structure)
    return tuple((name, hint) for name, hint, extra in fields if extra.get("keyed", True))


def leaves(value: Canonical, path: str = "") -> Iterator[tuple[str, Canonical]]:
    """Dotted name and value of everything in a canonical form that holds no names itself.

    Examples
    --------
    >>> dict(leaves({"law": {"modulus": 1.5}, "size": [2, 3], "parts": [{"a": 1}], "none": {}}))
    {'law.modulus': 1.5, 'size': [2, 3], 'parts.0.a': 1, 'none': {}}
    """
    if isinstance(value, dict) and value:
        for name, item in value.items():
            yield from leaves(item, f"{path}.{name}".lstrip("."))
    elif isinstance(value, list) and any(isinstance(item, dict | list) for item in value):
        for i, item in enumerate(value):
            yield from leaves(item, f"{path}.{i}")
    else:
        yield path, value


def _canonical(value: Any, hint: Any) -> Canonical:
    kind = type(value)
    if kind is float or kind is str or kind is bool or kind is int or value is None:
        return _scalar(value, hint)
    place: Any = ""
    try:
        if is_structure(value):
            fields: dict[str, Canonical] = {}
            for place, item, item_hint in keyed_fields(value):
                fields[place] = _canonical(item, item_hint)
            return fields
        if isinstance(value, Mapping):
            entries: dict[str, Canonical] = {}
            item_hint = item_hints(hint, "")
            for name, item in value.items():
                place = ""
                place = _text(name) if type(name) is str else _refuse_name(name)
                entries[place] = _canonical(item, item_hint)
            return entries
        if isinstance(value, list | tuple):
            items: list[Canonical] = []
            for place, item in enumerate(value):
                items.append(_canonical(item, item_hints(hint, place)))
            return items
    except _Refused as refused:
        refused.path.append(str(place))
        raise
    if kind.__module__ == "numpy" and getattr(value, "ndim", None) == 0:
        value = value.item()
    return _scalar(value, hint)


def _scalar(value: Any, hint: Any) -> Canonical:
    kind = type(value)
    if kind is float:
        if not math.isfinite(value):
            raise _Refused(ValueError, f"is {value}; a key needs finite numbers")
        return float(value + 0.0)  # -0.0 becomes 0.0
    if kind is str:
        return _text(value)
    if kind is int:
        declared = alternatives(hint)
        return float(value) if float in declared and int not in declared else int(value)
    if value is None or value is True or value is False:
        return value
    raise _Refused(TypeError, f"is of type {kind.__name__}, which has no key")


def _text(value: str) -> str:
    try:
        value.encode()
    except UnicodeEncodeError as error:
        raise _Refused(ValueError, f"is not valid Unicode text: {value!r}") from error
    return value


def _refuse_name(name: object) -> str:
    raise _Refused(TypeError, f"has the key {name!r}; only strings name entries")


def _encode(value: Canonical, parts: list[bytes]) -> None:
    """Unambiguous bytes: a type tag, then a fixed width, or a length and the contents."""
    if value is None:
        parts.append(b"n")
    elif isinstance(value, bool):
        parts.append(b"b1" if value else b"b0")
    elif isinstance(value, int):
        parts.append(_sized(b"i", str(value).encode()))
    elif isinstance(value, float):
        parts.append(b"f" + struct.pack(">d", value))
    elif isinstance(value, str):
        parts.append(_sized(b"s", value.encode()))
    elif isinstance(value, list):
        parts.append(b"l%d:" % len(value))
        for item in value:
            _encode(item, parts)
    else:
        parts.append(b"d%d:" % len(value))
        for key in sorted(value):
            parts.append(_sized(b"s", key.encode()))
            _encode(value[key], parts)


def _sized(tag: bytes, contents: bytes) -> bytes:
    return b"%s%d:%s" % (tag, len(contents), contents)
