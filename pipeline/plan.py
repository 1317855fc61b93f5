"""The plan: for each stage whether its result is there, and if not, why.

Nothing is computed or loaded; a plan reads manifests only.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from pipeline.fingerprint import Fingerprint
from pipeline.keys import Statement, code_of, statement
from pipeline.manifest import InputEntry, Manifest
from pipeline.nodes import Node, Part, Source, in_order, source_node
from pipeline.reasons import UNKNOWN, Reason, nearest
from pipeline.store import Store


@dataclass(frozen=True)
class Forecast:
    """Cost of the most similar past run."""

    seconds: float
    size: int


@dataclass(frozen=True)
class Hit:
    """The result is in the store."""

    node: str
    stage: str
    key: str
    manifest: Manifest

    @property
    def forecast(self) -> Forecast:
        """Nothing is left to do."""
        return Forecast(0.0, 0)


@dataclass(frozen=True)
class Missing:
    """The store holds no result of this stage at all."""

    node: str
    stage: str
    key: str | None

    @property
    def forecast(self) -> None:
        """Nothing is known about the cost."""
        return


@dataclass(frozen=True)
class Changed:
    """The store holds other results of this stage; ``reasons`` tell from the most similar one."""

    node: str
    stage: str
    key: str | None
    reasons: tuple[Reason, ...]
    forecast: Forecast


@dataclass(frozen=True)
class Pending:
    """The stages ``waits_for`` must run first; if their results come out the same, this is a hit."""

    node: str
    stage: str
    waits_for: tuple[str, ...]
    forecast: Forecast

    @property
    def key(self) -> None:
        """Not known before the inputs are."""
        return


Verdict: TypeAlias = Hit | Missing | Changed | Pending


def explain(nodes: Mapping[str, Node[Any]], store: Store) -> list[Verdict]:
    """Verdict on each node that is needed, in the order in which they would run.

    Raises
    ------
    StoreError
        If the store cannot be read or an artefact is damaged.
    InputError
        If source code cannot be read.
    """
    verdicts: dict[int, Verdict] = {}
    found: dict[int, Manifest] = {}
    for name, node in in_order(nodes):
        verdicts[id(node)] = verdict = _judge(name, node, store, found)
        if isinstance(verdict, Hit):
            found[id(node)] = verdict.manifest
    return list(verdicts.values())


def input_entries(
    sources: Mapping[str, Source], manifests: Mapping[int, Manifest]
) -> dict[str, InputEntry]:
    """Input table from the manifests (by ``id`` of the node) of what the inputs come from."""
    entries = {}
    for role, source in sources.items():
        manifest = manifests[id(source_node(source))]
        part = source.name if isinstance(source, Part) else None
        content = manifest.content_of(part)
        entries[role] = InputEntry(manifest.stage, manifest.key, part, content)
    return entries


def fingerprint_of(node: Node[Any]) -> Fingerprint:
    """Fingerprint of the code of a node, as its files are now."""
    return code_of(node.stage.module, node.config)


def statement_of(node: Node[Any], code: Fingerprint, inputs: Mapping[str, InputEntry]) -> Statement:
    """Key statement of a node."""
    contents = {role: entry.content for role, entry in inputs.items()}
    return statement(node.stage.name, node.config, code, contents)


def _judge(name: str, node: Node[Any], store: Store, found: Mapping[int, Manifest]) -> Verdict:
    stage = node.stage.name
    nodes = {role: source_node(source) for role, source in node.inputs.items()}
    known = {role: source for role, source in node.inputs.items() if id(nodes[role]) in found}
    waits_for = tuple(dict.fromkeys(n.stage.name for role, n in nodes.items() if role not in known))
    inputs = input_entries(known, found)
    stated = statement_of(node, fingerprint_of(node), inputs)
    if not waits_for and (manifest := store.find(stated.ref)):
        return Hit(name, stage, stated.key, manifest)
    key = None if waits_for else stated.key
    unknown = {role: InputEntry(n.stage.name, "", None, UNKNOWN) for role, n in nodes.items()}
    past = nearest(stated, {**unknown, **inputs}, store)
    if past is None:
        return Missing(name, stage, key)
    manifest, reasons = past
    forecast = Forecast(manifest.seconds, manifest.size)
    if waits_for and not reasons:
        return Pending(name, stage, waits_for, forecast)
    return Changed(name, stage, key, reasons, forecast)
