"""One run: computes what is not in the store and hands back all that was asked for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pipeline.computing.obtaining import CHECKPOINT_INTERVAL, Policy
from pipeline.events import Listener, ignore
from pipeline.executors import Executor
from pipeline.nodes import Node
from pipeline.scheduling.cases import Case, CaseFailed
from pipeline.scheduling.outcome import Outcome
from pipeline.store import Store
from pipeline.store.labels import RunLabel
from pipeline.sweep import sweep

__all__ = ["CHECKPOINT_INTERVAL", "Outcome", "run"]


def run(
    nodes: Mapping[str, Node[Any]],
    store: Store,
    *,
    executor: Executor | None = None,
    listen: Listener = ignore,
    checkpoint_interval: float = CHECKPOINT_INTERVAL,
    label: RunLabel | None = None,
    recompute_damaged: bool = False,
    accept_code: bool = False,
) -> dict[str, Outcome]:
    """Outcome of each node, computed unless the store holds it.

    Parameters
    ----------
    nodes
        Planned nodes by name; what they need is found or computed as well.
    store
        Where results are kept.
    executor
        Where stages run; without one here, one after the other.
    listen
        Receives the events.
    checkpoint_interval
        Seconds between two checkpoints of a stage that makes them.
    label
        Under which what is used is registered with the store, so that nobody removes it; the caller
        calls ``store.finish(label)`` once all else is done. Without one it is that of this process.
    recompute_damaged
        Check every byte of the stored results first; set damaged ones aside and compute them again.
    accept_code
        Accept stored results whose configuration and inputs are equal and whose code alone differs.

    Raises
    ------
    StageError
        If a stage fails, or its code was edited after the process that runs it had loaded it; what
        was published before stays.
    InputError
        If the store may not be written to from the beginning.
    StoreError
        If the store cannot be read or written.
    Stopped
        If a signal asked to stop: Ctrl-C, SIGTERM or SIGHUP.
    """
    policy = Policy(checkpoint_interval, label, recompute_damaged, accept_code)
    (result,) = sweep([Case("", nodes)], store, executor, listen=listen, policy=policy)
    if isinstance(result, CaseFailed):
        raise result.error
    return dict(result.outcomes)
