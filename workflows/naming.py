"""Names of parameters as users set them, for the fields of a stage's configuration.

A plan hands the sections of a workflow's configuration on to the stages: whole, inside another section, or
field by field. What is the very same object has the name of that object; a changed copy has the
name of the only section of its class; a single field that of the only parameter with its name and value.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from typing import Any

from pipeline.canonical import canonical, is_structure, keyed_fields


class Naming:
    """User's names for the fields that one stage sees.

    Parameters
    ----------
    config
        Configuration of the workflow.
    seen
        Configuration of the stage.
    """

    def __init__(self, config: Any, seen: Any) -> None:
        sections = list(_sections(config))
        same = {id(section): place for place, section in reversed(sections)}
        classes = defaultdict(list)
        for place, section in sections:
            classes[type(section)].append(place)
        self._places: dict[str, str] = {}
        for place, section in _sections(seen):
            found = [same[id(section)]] if id(section) in same else classes[type(section)]
            if len(found) == 1:
                self._places[place] = found[0]
        self._values = [
            (_joined(place, name), canonical(value))
            for place, section in sections
            for name, value, _ in keyed_fields(section)
        ]

    def __call__(self, field: str, value: Any = None) -> str:
        """User's name of a field with a value, or two of them; its own where that cannot be told."""
        names = field.split(".")
        for count in reversed(range(len(names) + 1)):
            place = self._places.get(".".join(names[:count]))
            if place is not None:
                return ".".join(filter(None, (place, *names[count:])))
        found = [place for place, _ in self._values if place.rpartition(".")[2] == names[-1]]
        if len(found) > 1:
            found = [
                place
                for place, kept in self._values
                if place in found and repr(kept) == repr(value)
            ]
        return " or ".join(found) if 1 <= len(found) <= 2 else field


def _sections(value: Any, place: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted name and object of every section in a configuration, itself included."""
    if is_structure(value):
        yield place, value
        items = [(name, item) for name, item, _ in keyed_fields(value)]
    elif isinstance(value, Mapping):
        items = list(value.items())
    elif isinstance(value, list | tuple):
        items = [(str(i), item) for i, item in enumerate(value)]
    else:
        return
    for name, item in items:
        yield from _sections(item, _joined(place, name))


def _joined(place: str, name: str) -> str:
    return f"{place}.{name}" if place else name
