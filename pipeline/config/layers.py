"""Tables of parameters: reading, merging, overriding."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from functools import reduce
from pathlib import Path
from typing import Any

from pipeline.errors import InputError


def read_toml(path: Path) -> dict[str, Any]:
    """Tables of a TOML file, which may begin with a byte-order mark, as some editors write it.

    Where a table names a ``file`` that is not an absolute path, it lies beside the TOML file.

    Raises
    ------
    InputError
        If the file cannot be read or is malformed; names file and line.
    """
    try:
        tables: dict[str, Any] = _beside(
            path.parent, tomllib.loads(path.read_text(encoding="utf-8-sig"))
        )
        return tables
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path} is not valid TOML: {error}") from error
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise InputError(f"{path} is not valid UTF-8 text (at line {line})") from error
    except OSError as error:
        raise InputError(f"cannot read the configuration {path}: {error.strerror}") from error


def _beside(folder: Path, value: Any, name: str = "") -> Any:
    """The same with every path called ``file`` taken from a folder."""
    if isinstance(value, dict):
        return {key: _beside(folder, item, key) for key, item in value.items()}
    if isinstance(value, list):
        return [_beside(folder, item) for item in value]
    return str(folder / value) if name == "file" and isinstance(value, str) else value


def merged(layers: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """One table from several; later values win.

    Examples
    --------
    >>> merged([{"law": {"name": "a", "k": 1}, "n": 1}, {"law": {"name": "b"}}])
    {'law': {'name': 'b'}, 'n': 1}
    >>> merged([{"law": {"name": "a", "k": 1}}, {"law": {"k": 2}}])
    {'law': {'name': 'a', 'k': 2}}
    """
    return reduce(_merge_tables, layers, {})


def overridden(data: Mapping[str, Any], overrides: Sequence[str]) -> dict[str, Any]:
    """Table with ``SECTION.KEY=VALUE`` strings applied, the last one winning.

    Raises
    ------
    InputError
        If a string is not of that form, or a place in a list does not exist.
    """
    return _merge_tables(data, nested(_parsed(override) for override in overrides))


def nested(settings: Iterable[tuple[Sequence[str], Any]]) -> dict[str, Any]:
    """Tables with values at dotted names, each given as a sequence; the last one wins.

    Examples
    --------
    >>> nested([(("law",), "linear"), (("law", "k"), 2)])
    {'law': {'name': 'linear', 'k': 2}}
    """
    layer: dict[str, Any] = {}
    for names, value in settings:
        table = layer
        for name in names[:-1]:
            above = table.get(name)
            if not isinstance(above, dict):  # a model given by its name alone keeps it
                table[name] = {"name": above} if isinstance(above, str) else {}
            table = table[name]
        table[names[-1]] = value
    return layer


def _parsed(override: str) -> tuple[list[str], Any]:
    key, equals, text = override.partition("=")
    names = [name.strip() for name in key.split(".")]
    if not equals or not all(names):
        raise InputError(f"--set needs SECTION.KEY=VALUE, got {override!r}")
    return names, literal(text.strip())


def literal(text: str) -> Any:
    """Value of a text: TOML if it is valid TOML, else the text itself.

    Examples
    --------
    >>> literal("0.5"), literal("[1, 2]"), literal("15 um"), literal('"S1"')
    (0.5, [1, 2], '15 um', 'S1')
    """
    try:
        table = tomllib.loads(f"value = {text}")
    except tomllib.TOMLDecodeError:
        return text
    return table["value"] if len(table) == 1 else text


def _merge_tables(
    below: Mapping[str, Any], above: Mapping[str, Any], path: str = ""
) -> dict[str, Any]:
    result = dict(below)
    for name, value in above.items():
        place = f"{path}.{name}".lstrip(".")
        result[name] = _merge(result[name], value, place) if name in result else value
    return result


def _merge(below: Any, above: Any, path: str) -> Any:
    """``above`` laid over ``below``; a model may be given by its name alone, as a string."""
    if isinstance(above, Mapping):
        if isinstance(below, str) and "name" not in above:
            below = {"name": below}
        if isinstance(below, list | tuple) and above and all(key.isdigit() for key in above):
            return _merge_items(below, above, path)
        if isinstance(below, Mapping) and above.get("name", below.get("name")) == below.get("name"):
            return _merge_tables(below, above, path)
    elif isinstance(above, str) and isinstance(below, Mapping) and below.get("name") == above:
        return below
    return above


def _merge_items(below: Sequence[Any], above: Mapping[str, Any], path: str) -> list[Any]:
    result = list(below)
    for key, value in above.items():
        if int(key) >= len(result):
            raise InputError(
                f"{path}.{key}: there is no such item; {path} has {len(result)}, counted from 0"
            )
        result[int(key)] = _merge(result[int(key)], value, f"{path}.{key}")
    return result
