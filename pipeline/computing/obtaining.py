"""Getting a result: from the store if it is there, else by computing it, once for all who ask."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass

from pipeline.events import Holder, Listener, StageHit, StageWaiting, StageWarned
from pipeline.keys import Ref, Statement
from pipeline.manifest import InputEntry, Manifest
from pipeline.plan.reasons import nearest
from pipeline.provenance import version_changes
from pipeline.store import Store
from pipeline.store.labels import RunLabel
from pipeline.task import Task

CHECKPOINT_INTERVAL = 5.0
"""Seconds of work that a kill may cost at most."""

COMPARED = 32
"""Latest results that the duration of a stage is guessed from."""


@dataclass(frozen=True)
class Policy:
    """How results are obtained; nothing in it changes a result.

    Attributes
    ----------
    checkpoint_interval
        Seconds between two checkpoints of a stage that makes them.
    label
        Run that registers what it uses with the store, so that nobody removes it.
    recompute_damaged
        Whether every byte of a stored result is checked before it is used, and a damaged one set
        aside and computed again; otherwise a damaged one is an error.
    accept_code
        Whether a result that differs by its code alone is accepted instead of computing another.
    """

    checkpoint_interval: float = CHECKPOINT_INTERVAL
    label: RunLabel | None = None
    recompute_damaged: bool = False
    accept_code: bool = False


READ = Policy()
"""How a result is looked at that was looked for before."""


@dataclass(frozen=True)
class Obtained:
    """What others need to know of a result; ``hit`` tells that it was there already."""

    stage: str
    key: str
    hit: bool
    content: str
    parts: Mapping[str, str]
    seconds: float
    size: int

    @classmethod
    def of(cls, manifest: Manifest, *, hit: bool) -> Obtained:
        """The few facts of a manifest."""
        return cls(
            manifest.stage,
            manifest.key,
            hit,
            manifest.content,
            manifest.parts,
            manifest.seconds,
            manifest.size,
        )

    def entry(self, part: str | None) -> InputEntry:
        """The result, or a part of it, as an input."""
        content = self.content if part is None else self.parts[part]
        return InputEntry(self.stage, self.key, part, content)


def look(
    name: str, ref: Ref, store: Store, tell: Listener, policy: Policy = READ
) -> Obtained | None:
    """A result that is in the store, told as a hit; ``None`` if it is not there.

    With the label of a run it is registered as one that the run needs, whether it is there or not.

    Raises
    ------
    StoreError
        If it is damaged, unless such are to be computed again.
    """
    if policy.recompute_damaged:
        from pipeline.computing.mending import find_sound

        manifest = find_sound(name, ref, store, tell, policy.label)
    else:
        manifest = store.find(ref, policy.label)
    if manifest is None:
        return None
    tell(StageHit(name, ref.stage, ref.key))
    if changes := version_changes(manifest.environment.get("versions", {})):
        tell(StageWarned(name, ref.stage, f"the stored result is of {', '.join(changes)}"))
    return Obtained.of(manifest, hit=True)


def obtain(task: Task, store: Store, policy: Policy, *, tell: Listener) -> Obtained:
    """The result of a task: check, lock, check again, compute.

    Raises
    ------
    StageError
        If the stage fails, or the code of this process is not that of the key.
    InputError
        If the store may not be written to from the beginning.
    StoreError
        If the store cannot be read or written.
    Stopped
        If a signal or the executor asked to stop.
    """
    ref = task.ref
    if (found := look(task.name, ref, store, tell)) is not None:
        return found
    began = time.perf_counter()

    def waiting(holder: Holder) -> None:
        tell(StageWaiting(task.name, ref.stage, ref.key, holder))

    with store.writing(ref, waiting) as work:
        waited = time.perf_counter() - began
        found = look(task.name, ref, store, tell)
        if found is None and policy.accept_code:
            from pipeline.plan.acceptance import accepted

            if (other := accepted(task, store, work, tell)) is not None:
                return Obtained.of(other, hit=True)
        if found is None:
            from pipeline.computing.execution import execute

            manifest = execute(task, store, work, tell, policy.checkpoint_interval, waited)
            return Obtained.of(manifest, hit=False)
    return found


def expected_seconds(
    stated: Statement, inputs: Mapping[str, InputEntry], store: Store
) -> float | None:
    """Duration of the most similar past run, ``None`` if there is none."""
    past = nearest(stated, inputs, store, among=COMPARED)
    return past[0].seconds if past else None
