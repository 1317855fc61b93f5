"""Which planned stages of different cases are the same, found without keys, which need inputs."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from typing import Any

from pipeline.canonical import is_structure, keyed_fields
from pipeline.nodes import Node, Source

REMEMBERED = 200_000
"""Configurations whose identity is remembered by the object that they are."""


class Identities:
    """Numbers, one for each different node: equal stage, keyed configuration and inputs."""

    def __init__(self) -> None:
        self._numbers: dict[Hashable, int] = {}
        self._known: dict[int, tuple[Any, int]] = {}

    def of(self, node: Node[Any], input_of: Callable[[Source], Hashable]) -> int:
        """Number of a node.

        Parameters
        ----------
        node
            The node.
        input_of
            What tells an input from others: its content, or the number of the node that it comes from.
        """
        inputs = tuple((role, input_of(source)) for role, source in node.inputs.items())
        return self._number(("node", node.stage.name, self._value(node.config), inputs))

    def _number(self, identity: Hashable) -> int:
        return self._numbers.setdefault(identity, len(self._numbers))

    def _value(self, value: Any) -> Hashable:
        if is_structure(value):
            return self._structure(value)
        if isinstance(value, Mapping):
            items = ((name, self._value(item)) for name, item in value.items())
            return ("table", frozenset(items))
        if isinstance(value, list | tuple):
            return ("list", *map(self._value, value))
        return (type(value), value)

    def _structure(self, value: Any) -> int:
        """Cases share the sections that they do not change, object by object."""
        known = self._known.get(id(value))
        if known is not None:
            return known[1]
        fields = tuple(self._value(item) for _, item, _ in keyed_fields(value))
        number = self._number((type(value), fields))
        if len(self._known) >= REMEMBERED:
            self._known.clear()
        self._known[id(value)] = (value, number)
        return number
