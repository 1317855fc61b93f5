"""The serial runner: computes what is not in the store, in order, one stage at a time."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pipeline.events import Listener, StageHit, StageWaiting, StageWarned, ignore
from pipeline.interrupts import deferred_interrupts
from pipeline.keys import Statement
from pipeline.manifest import InputEntry, Manifest
from pipeline.nodes import Node, in_order
from pipeline.plan import fingerprint_of, input_entries, statement_of
from pipeline.provenance import version_changes
from pipeline.reasons import nearest
from pipeline.store import Store

CHECKPOINT_INTERVAL = 5.0
"""Seconds of work that a kill may cost at most."""

COMPARED = 32
"""Latest results that the duration of a stage is guessed from."""


@dataclass(frozen=True)
class Outcome:
    """Result of a node.

    Attributes
    ----------
    node, stage, key
        What it is.
    hit
        Whether it was in the store already.
    manifest
        All that is known about it.
    """

    node: str
    stage: str
    key: str
    hit: bool
    manifest: Manifest
    store: Store
    record: type

    @property
    def seconds(self) -> float:
        """Duration of the computation, whenever it took place."""
        return self.manifest.seconds

    @property
    def parts(self) -> Mapping[str, str]:
        """Content id of each part."""
        return self.manifest.parts

    @property
    def content(self) -> str:
        """Content id of the whole."""
        return self.manifest.content

    def load(self, part: str | None = None) -> Any:
        """The record, or one part of it.

        Raises
        ------
        StoreError
            If it cannot be read or is damaged.
        """
        from pipeline.loading import load_result

        return load_result(self.store, self.manifest.ref, self.record, part)


def run(
    nodes: Mapping[str, Node[Any]],
    store: Store,
    *,
    listen: Listener = ignore,
    checkpoint_interval: float = CHECKPOINT_INTERVAL,
) -> dict[str, Outcome]:
    """Outcome of each node, computed unless the store holds it.

    Parameters
    ----------
    nodes
        Planned nodes by name; what they need is found or computed as well.
    store
        Where results are kept.
    listen
        Receives the events.
    checkpoint_interval
        Seconds between two checkpoints of a stage that makes them.

    Raises
    ------
    StageError
        If a stage fails, or its code was edited after this process had loaded it; what was
        published before stays.
    InputError
        If the store may not be written to from the beginning.
    StoreError
        If the store cannot be read or written.
    Stopped
        If a signal asked to stop: Ctrl-C, SIGTERM or SIGHUP.
    """
    manifests: dict[int, Manifest] = {}
    outcomes: dict[int, Outcome] = {}
    # Of all nodes now: a file saved while the first stage computes must not enter a later key.
    codes = {id(node): fingerprint_of(node) for _, node in in_order(nodes)}
    # Outside a stage nothing is deferred, but a signal still leaves no folders behind.
    with deferred_interrupts():
        for name, node in in_order(nodes):
            inputs = input_entries(node.inputs, manifests)
            stated = statement_of(node, codes[id(node)], inputs)
            manifest, hit = _obtain(name, node, stated, inputs, store, listen, checkpoint_interval)
            manifests[id(node)] = manifest
            outcomes[id(node)] = Outcome(
                name, node.stage.name, manifest.key, hit, manifest, store, node.record
            )
    return {name: outcomes[id(node)] for name, node in nodes.items()}


def _obtain(
    name: str,
    node: Node[Any],
    stated: Statement,
    inputs: Mapping[str, InputEntry],
    store: Store,
    listen: Listener,
    checkpoint_interval: float,
) -> tuple[Manifest, bool]:
    """Manifest of a node's result, and whether it was there: check, lock, check again, compute."""
    stage, key = node.stage.name, stated.key
    manifest = store.find(stated.ref)
    if manifest is None:
        began = time.perf_counter()
        with store.writing(
            stated.ref, lambda holder: listen(StageWaiting(name, stage, key, holder))
        ) as work:
            waited = time.perf_counter() - began
            manifest = store.find(stated.ref)
            if manifest is None:
                from pipeline.execution import Task, execute

                expected = _expected_seconds(stated, inputs, store)
                task = Task(name, node, stated, inputs, expected, waited)
                return execute(task, store, work, listen, checkpoint_interval), False
    listen(StageHit(name, stage, key))
    if changes := version_changes(manifest.environment.get("versions", {})):
        listen(StageWarned(name, stage, f"the stored result is of {', '.join(changes)}"))
    return manifest, True


def _expected_seconds(
    stated: Statement, inputs: Mapping[str, InputEntry], store: Store
) -> float | None:
    past = nearest(stated, inputs, store, among=COMPARED)
    return past[0].seconds if past else None
