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
from collections.abc import Iterator, Mapping, Sequence
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
    encoded = b"".join(_encode(canonical(value)))
    return hashlib.blake2b(encoded, digest_size=DIGEST_BYTES).hexdigest()


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
    if is_structure(value):
        return {
            name: canonical(item, item_hint, f"{path}.{name}".lstrip("."))
            for name, item, item_hint in keyed_fields(value)
        }
    if isinstance(value, Mapping):
        return {
            _text(key, path): canonical(item, item_hints(hint, key), f"{path}.{key}".lstrip("."))
            for key, item in value.items()
        }
    if isinstance(value, list | tuple):
        return [
            canonical(item, item_hints(hint, i), f"{path}.{i}".lstrip("."))
            for i, item in enumerate(value)
        ]
    return _scalar(value, hint, path)


def is_structure(value: Any) -> bool:
    """Whether a value is a pydantic model or a dataclass instance."""
    return not isinstance(value, type) and (
        dataclasses.is_dataclass(value) or hasattr(type(value), "model_fields")
    )


def keyed_fields(structure: Any) -> Iterator[tuple[str, Any, Any]]:
    """Name, value and declared type of every field that can change a result.

    A field opts out by ``json_schema_extra={"keyed": False}`` (pydantic) or
    ``metadata={"keyed": False}`` (dataclass).
    """
    for name, hint, extra in field_hints(type(structure)):
        if extra.get("keyed", True):
            yield name, getattr(structure, name), hint


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


def _scalar(value: Any, hint: Any, path: str) -> Canonical:
    if type(value).__module__ == "numpy" and getattr(value, "ndim", None) == 0:
        value = value.item()
    if value is None or isinstance(value, bool):
        return value
    if type(value) is int:
        declared = alternatives(hint)
        return float(value) if float in declared and int not in declared else value
    if type(value) is float:
        if not math.isfinite(value):
            raise ValueError(f"{path or 'value'} is {value}; a key needs finite numbers")
        return value + 0.0  # -0.0 becomes 0.0
    if type(value) is str:
        return _text(value, path)
    raise TypeError(f"{path or 'value'} is of type {type(value).__name__}, which has no key")


def _text(value: Any, path: str) -> str:
    if type(value) is not str:
        raise TypeError(f"{path or 'value'} has the key {value!r}; only strings name entries")
    try:
        value.encode()
    except UnicodeEncodeError as error:
        raise ValueError(f"{path or 'value'} is not valid Unicode text: {value!r}") from error
    return value


def _encode(value: Canonical) -> Iterator[bytes]:
    """Unambiguous bytes: a type tag, then a fixed width, or a length and the contents."""
    if value is None:
        yield b"n"
    elif isinstance(value, bool):
        yield b"b1" if value else b"b0"
    elif isinstance(value, int):
        yield from _sized(b"i", str(value).encode())
    elif isinstance(value, float):
        yield b"f" + struct.pack(">d", value)
    elif isinstance(value, str):
        yield from _sized(b"s", value.encode())
    elif isinstance(value, Sequence):
        yield b"l%d:" % len(value)
        for item in value:
            yield from _encode(item)
    else:
        yield b"d%d:" % len(value)
        for key in sorted(value):
            yield from _sized(b"s", key.encode())
            yield from _encode(value[key])


def _sized(tag: bytes, contents: bytes) -> Iterator[bytes]:
    yield tag + b"%d:" % len(contents)
    yield contents
