"""Fields that pick the values of others, such as a preset: given, they replace what lower layers say.

A model declares them with ``picks: ClassVar[Mapping[str, tuple[str, ...]]]``: names of its fields, each
with the fields that it picks. The model fills these in itself; here the values are taken out that
a lower layer has for them. What the same layer or a higher one says of a picked field stays, so that the
model can refuse the contradiction.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from pydantic import BaseModel

from pipeline.config.fields import fields_of
from pipeline.config.layers import merged


def laid_over(model: type[BaseModel], layers: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """One table from several of growing precedence, picked fields taken away where they must be."""
    data: dict[str, Any] = {}
    for layer in layers:
        data = merged([cleared(model, data, layer), layer])
    return data


def cleared(
    model: type[BaseModel], below: Mapping[str, Any], above: Mapping[str, Any]
) -> dict[str, Any]:
    """``below`` without the values that a field given in ``above`` picks, section by section."""
    picked = {
        name
        for field, names in getattr(model, "picks", {}).items()
        if field in above
        for name in names
    }
    kept = {name: value for name, value in below.items() if name not in picked}
    for name, declared in fields_of(model):
        if name not in above:
            continue
        inner, over = kept.get(name), above[name]
        if isinstance(inner, Mapping) and isinstance(over, Mapping):
            for section in declared.models():
                kept[name] = cleared(section, inner, over)
    return kept
