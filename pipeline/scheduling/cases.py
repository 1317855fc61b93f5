"""The cases of a study: sets of nodes that are wanted, and what becomes of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from pipeline.computing.obtaining import Obtained
from pipeline.fingerprint import Fingerprint
from pipeline.manifest import InputEntry
from pipeline.nodes import Node, Part, in_order, source_node
from pipeline.scheduling.outcome import Outcome
from pipeline.store import Store
from pipeline.task import Codes


@dataclass(frozen=True)
class Case:
    """Nodes that are wanted together.

    Attributes
    ----------
    name
        What the case is called; empty for a run that is no part of a study.
    nodes
        Planned nodes by name.
    about
        Anything small and picklable, handed to ``finish``.
    """

    name: str
    nodes: Mapping[str, Node[Any]]
    about: Any = None


@dataclass(frozen=True)
class CaseDone:
    """All nodes of a case are there; ``value`` is what ``finish`` made of them."""

    name: str
    outcomes: Mapping[str, Outcome]
    value: Any = None


@dataclass(frozen=True)
class CaseFailed:
    """A node of a case, or ``finish`` (then ``stage`` is empty), raised ``error``.

    ``outcomes`` holds the named nodes that were there by then.
    """

    name: str
    stage: str
    error: Exception
    outcomes: Mapping[str, Outcome]


CaseResult: TypeAlias = CaseDone | CaseFailed


@dataclass
class OpenCase:
    """A case under way: what is there, and what each node still waits for.

    Nodes go by their position in :func:`pipeline.nodes.in_order`; the position after the last one
    stands for ``finish``.
    """

    case: Case
    order: list[tuple[str, Node[Any]]]
    codes: list[Fingerprint]
    sources: list[set[int]]
    obtained: dict[int, Obtained] = field(default_factory=dict)

    @classmethod
    def of(cls, case: Case, codes: Codes) -> OpenCase:
        """Nothing is there yet; fingerprints are taken of all nodes now.

        Raises
        ------
        InputError
            If source code cannot be read.
        """
        order = list(in_order(case.nodes))
        position = {id(node): i for i, (_, node) in enumerate(order)}
        sources = [{position[id(source_node(s))] for s in n.inputs.values()} for _, n in order]
        return cls(case, order, [codes.of(node) for _, node in order], sources)

    @property
    def last(self) -> int:
        """Position of ``finish``."""
        return len(self.order)

    def first_ready(self) -> list[int]:
        """Positions that wait for nothing."""
        return [i for i, sources in enumerate(self.sources) if not sources] or [self.last]

    def add(self, position: int, obtained: Obtained) -> list[int]:
        """Note that a node is there; positions that became ready."""
        self.obtained[position] = obtained
        there = self.obtained.keys()
        if len(there) == self.last:
            return [self.last]
        return [i for i, needs in enumerate(self.sources) if position in needs and needs <= there]

    def inputs(self, position: int) -> dict[str, InputEntry]:
        """Input table of a node that is ready."""
        places = {id(node): i for i, (_, node) in enumerate(self.order)}
        return {
            role: self.obtained[places[id(source_node(source))]].entry(
                source.name if isinstance(source, Part) else None
            )
            for role, source in self.order[position][1].inputs.items()
        }

    def outcomes(self, store: Store) -> dict[str, Outcome]:
        """Outcomes of the nodes that were asked for by name and are there."""
        there = {id(self.order[i][1]): obtained for i, obtained in self.obtained.items()}
        return {
            name: Outcome(name, there[id(node)], store, node.record)
            for name, node in self.case.nodes.items()
            if id(node) in there
        }
