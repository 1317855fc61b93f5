"""What a sweep would do: how many different stages there are, which are there, and what the rest costs."""

from __future__ import annotations

import contextlib
from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from pipeline.errors import StoreError
from pipeline.keys import Ref
from pipeline.manifest import InputEntry, Manifest
from pipeline.nodes import Node, Part, Source, in_order, source_node
from pipeline.plan import statement_of
from pipeline.plan.reasons import UNKNOWN, nearest
from pipeline.store import Store
from pipeline.task import Codes
from workflows.sweep.identity import Identities

COMPARED = 32
"""Latest results of a stage among which the most similar one tells what a computation costs."""


@dataclass
class StageForecast:
    """One stage over all cases.

    Attributes
    ----------
    name
        Name of the stage.
    different
        Computations that differ from one another.
    hits
        Those whose results are in the store.
    open
        Those whose inputs are not there yet: where these come out equal, they are one computation, and
        where they come out as some time before, they are hits.
    seconds, size
        Cost of one, after the most similar past one; ``None`` if there is none.
    """

    name: str
    different: int = 0
    hits: int = 0
    open: int = 0
    seconds: float | None = None
    size: int | None = None

    @property
    def to_compute(self) -> int:
        """Computations at most."""
        return self.different - self.hits


class Forecast:
    """Counts the stages of planned cases.

    Parameters
    ----------
    store
        Where results may be; only manifests are read.

    Attributes
    ----------
    stages
        By name.
    cases
        Of each case, in order, a number for each node, the same for nodes that are alike.
    """

    def __init__(self, store: Store) -> None:
        self.stages: dict[str, StageForecast] = {}
        self.cases: list[dict[str, int]] = []
        self._store = store
        self._identities = Identities()
        self._codes = Codes()
        self._found: dict[int, Manifest | None] = {}
        self._there: dict[str, frozenset[str]] = {}

    def add(self, nodes: Mapping[str, Node[Any]]) -> None:
        """Count the stages of one case that no other case has."""
        numbers: dict[int, int] = {}
        case = {}

        def input_of(source: Source) -> Hashable:
            """Content of an input that is there: several nodes may have given the same."""
            number = numbers[id(source_node(source))]
            part = source.name if isinstance(source, Part) else None
            found = self._found[number]
            return (number, part) if found is None else found.content_of(part)

        for name, node in in_order(nodes):
            numbers[id(node)] = case[name] = number = self._identities.of(node, input_of)
            if number not in self._found:
                self._found[number] = self._judge(node, numbers)
        self.cases.append(case)

    def add_all(self, cases: Iterable[Mapping[str, Node[Any]]]) -> Forecast:
        """Count all cases."""
        for nodes in cases:
            self.add(nodes)
        return self

    def _judge(self, node: Node[Any], numbers: Mapping[int, int]) -> Manifest | None:
        """Manifest of a node's result, if it is there, and the node counted."""
        name = node.stage.name
        stage = self.stages.setdefault(name, StageForecast(name))
        stage.different += 1
        origins = (numbers[id(source_node(source))] for source in node.inputs.values())
        is_open = any(self._found[origin] is None for origin in origins)
        stage.open += is_open
        there = self._keys(name)
        if not there or (is_open and stage.seconds is not None):
            return None
        inputs = self._inputs(node, numbers)
        if is_open:
            self._estimate(stage, node, inputs)
            return None
        stated = statement_of(node, self._codes.of(node), inputs)
        if stated.key in there:
            # One that cannot be read, or went just now, is to be computed; the sweep tells of damage.
            with contextlib.suppress(StoreError):
                found = self._store.manifest(Ref(name, stated.key))
                stage.hits += 1
                return found
        self._estimate(stage, node, inputs)
        return None

    def _keys(self, stage: str) -> frozenset[str]:
        if stage not in self._there:
            self._there[stage] = frozenset(ref.key for ref in self._store.refs(stage))
        return self._there[stage]

    def _inputs(self, node: Node[Any], numbers: Mapping[int, int]) -> dict[str, InputEntry]:
        entries = {}
        for role, source in node.inputs.items():
            origin = source_node(source)
            found = self._found[numbers[id(origin)]]
            part = source.name if isinstance(source, Part) else None
            if found is None:
                entries[role] = InputEntry(origin.stage.name, "", part, UNKNOWN)
            else:
                content = found.content_of(part)
                entries[role] = InputEntry(found.stage, found.key, part, content)
        return entries

    def _estimate(
        self, stage: StageForecast, node: Node[Any], inputs: Mapping[str, InputEntry]
    ) -> None:
        """Cost of a stage after the past result most like the first one that is to be computed."""
        if stage.seconds is not None:
            return
        known = {role: e for role, e in inputs.items() if e.content != UNKNOWN}
        stated = statement_of(node, self._codes.of(node), known)
        past = nearest(stated, inputs, self._store, among=COMPARED)
        if past is not None:
            stage.seconds, stage.size = past[0].seconds, past[0].size
