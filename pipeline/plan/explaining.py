"""The plan: for each stage whether its result is there, and if not, why.

Nothing is computed or loaded; a plan reads manifests only.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pipeline.fingerprint import Fingerprint
from pipeline.fingerprint.sources import Sources
from pipeline.keys import Ref, Statement, code_of, statement
from pipeline.manifest import InputEntry, Manifest
from pipeline.nodes import Node, Part, Source, in_order, source_node
from pipeline.plan.reasons import UNKNOWN, code_changes, nearest
from pipeline.plan.verdicts import (
    Acceptable,
    Changed,
    Damaged,
    Forecast,
    Hit,
    Missing,
    Pending,
    Verdict,
)
from pipeline.provenance import version_changes
from pipeline.running.checkpoint_summary import CheckpointSummary, summary
from pipeline.store import Store
from pipeline.verification import DamagedError

COMPARED = 256
"""Latest results of a stage that a plan compares with; a study leaves thousands of them."""


def explain(
    nodes: Mapping[str, Node[Any]], store: Store, *, accept_code: bool = False
) -> list[Verdict]:
    """Verdict on each node that is needed, in the order in which they would run.

    Parameters
    ----------
    nodes
        Planned nodes by name.
    store
        Where results are kept.
    accept_code
        Whether results that differ by their code alone are to be accepted.

    Raises
    ------
    StoreError
        If the store cannot be read.
    InputError
        If source code cannot be read.
    """
    verdicts: dict[int, Verdict] = {}
    found: dict[int, Manifest] = {}
    sources = Sources()
    for name, node in in_order(nodes):
        code = fingerprint_of(node, sources)
        verdicts[id(node)] = verdict = _judge(name, node, code, store, found, accept_code)
        if isinstance(verdict, Hit | Acceptable):
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


def fingerprint_of(node: Node[Any], sources: Sources | None = None) -> Fingerprint:
    """Fingerprint of the code of a node, as its files are now or were read before."""
    return code_of(node.stage.module, node.config, sources)


def statement_of(node: Node[Any], code: Fingerprint, inputs: Mapping[str, InputEntry]) -> Statement:
    """Key statement of a node."""
    contents = {role: entry.content for role, entry in inputs.items()}
    return statement(node.stage.name, node.config, code, contents)


def _judge(
    name: str,
    node: Node[Any],
    code: Fingerprint,
    store: Store,
    found: Mapping[int, Manifest],
    accept_code: bool,
) -> Verdict:
    stage = node.stage.name
    nodes = {role: source_node(source) for role, source in node.inputs.items()}
    known = {role: source for role, source in node.inputs.items() if id(nodes[role]) in found}
    waits_for = tuple(dict.fromkeys(n.stage.name for role, n in nodes.items() if role not in known))
    inputs = input_entries(known, found)
    stated = statement_of(node, code, inputs)
    if not waits_for and (verdict := _obtainable(name, stated, store, accept_code)):
        return verdict
    key = None if waits_for else stated.key
    resume = None if waits_for else _resume(stated.ref, store)
    unknown = {role: InputEntry(n.stage.name, "", None, UNKNOWN) for role, n in nodes.items()}
    past = nearest(stated, {**unknown, **inputs}, store, among=COMPARED)
    if past is None:
        return Missing(name, stage, key, resume)
    manifest, reasons = past
    forecast = Forecast(manifest.seconds, manifest.size)
    if waits_for and not reasons:
        return Pending(name, stage, waits_for, forecast)
    return Changed(name, stage, key, reasons, forecast, resume)


def _obtainable(
    name: str, stated: Statement, store: Store, accept_code: bool
) -> Hit | Damaged | Acceptable | None:
    """Verdict on a result whose inputs are known, ``None`` if it would have to be computed."""
    try:
        manifest = store.find(stated.ref)
    except DamagedError as error:
        return Damaged(name, stated.stage, stated.key, error.problems)
    if manifest is not None:
        return Hit(name, stated.stage, stated.key, manifest, _versions(manifest))
    if not accept_code:
        return None
    from pipeline.plan.acceptance import acceptable

    other = acceptable(stated, store)
    if other is None:
        return None
    changes = tuple(code_changes(other.modules, stated.code.modules))
    return Acceptable(name, stated.stage, stated.key, other, changes, _versions(other))


def _versions(manifest: Manifest) -> tuple[str, ...]:
    return tuple(version_changes(manifest.environment.get("versions", {})))


def _resume(ref: Ref, store: Store) -> CheckpointSummary | None:
    path = store.checkpoint(ref)
    return None if path is None else summary(path, ref.key)
