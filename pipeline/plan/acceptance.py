"""Accepting a result of other code: after an edit that, as its author knows, changes no result.

The code fingerprint sees every edit of a statement, also one that only tidies up. Who asks for it may have
results accepted whose configuration and inputs are equal and whose code alone differs. They are
published again under the key of the present code; the manifest keeps what was accepted, and by whom.
"""

from __future__ import annotations

import dataclasses
import datetime
import os
import platform
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path

from pipeline.durable import storing
from pipeline.errors import StoreError
from pipeline.events import Listener, StageHit, StageWarned
from pipeline.keys import SCHEMA, Statement
from pipeline.manifest import InputEntry, Manifest
from pipeline.plan.reasons import code_changes
from pipeline.store import Store, Workspace
from pipeline.task import Task
from pipeline.verification import DamagedError

ACCEPTED = "accepted"
"""Entry of a manifest's environment: what was accepted, the latest last."""


def acceptable(stated: Statement, store: Store) -> Manifest | None:
    """Whole result with the configuration and inputs that are stated, and with the most similar code.

    ``None`` if there is none. Its files are not read: :func:`accept` does that.
    """
    found = [
        manifest
        for ref in store.refs(stated.stage)
        if (manifest := _whole(stated, ref.key, store)) is not None
    ]
    if not found:
        return None
    count = {id(m): sum(1 for _ in code_changes(m.modules, stated.code.modules)) for m in found}
    return max(found, key=lambda manifest: (-count[id(manifest)], manifest.finished))


def accepted(task: Task, store: Store, work: Workspace, tell: Listener) -> Manifest | None:
    """Result of other code, published for a task; ``None`` if there is none to accept.

    Raises
    ------
    StoreError
        If it is damaged, or cannot be written again.
    """
    stated = task.statement()
    found = acceptable(stated, store)
    if found is None:
        return None
    manifest = accept(found, stated, task.inputs, store, work, task.argv)
    tell(StageHit(task.name, stated.stage, stated.key))
    edits = ", ".join(map(str, code_changes(found.modules, stated.code.modules)))
    tell(StageWarned(task.name, stated.stage, f"accepted a result of other code ({edits})"))
    return manifest


def accept(
    found: Manifest,
    stated: Statement,
    inputs: Mapping[str, InputEntry],
    store: Store,
    work: Workspace,
    argv: Sequence[str],
) -> Manifest:
    """Publish a result of other code under the key that is stated, and tell of it in the manifest.

    Parameters
    ----------
    found
        Result to accept.
    stated, inputs
        What it is accepted for.
    store, work
        Where it is, and the workspace of the new key.
    argv
        Command that asked for it.

    Raises
    ------
    StoreError
        If the result is damaged, or cannot be written again.
    """
    data = store.data(found.ref)
    if problems := store.verify(found.ref, full=True):
        raise DamagedError(found.ref, data.parent, problems)
    work.begin(resume=False)
    with storing(work.folder):
        for file in found.files:
            _link(data / file.path, work.data / file.path)
    modules = {
        change.module: [found.modules.get(change.module), stated.code.modules.get(change.module)]
        for change in code_changes(found.modules, stated.code.modules)
    }
    entry = {
        "key": found.key,
        "code": found.code,
        "modules": modules,
        "command": list(argv),
        "host": platform.node(),
        "at": datetime.datetime.now(datetime.UTC).isoformat(timespec="milliseconds"),
    }
    earlier = found.environment.get(ACCEPTED, [])
    manifest = dataclasses.replace(
        found,
        key=stated.key,
        code=stated.code.digest,
        modules=stated.code.modules,
        inputs=inputs,
        environment={**found.environment, ACCEPTED: [*earlier, entry]},
    )
    return work.publish(manifest)


def _whole(stated: Statement, key: str, store: Store) -> Manifest | None:
    """Manifest of a result that differs by its code alone and has all its files."""
    ref = dataclasses.replace(stated.ref, key=key)
    try:
        manifest = store.manifest(ref)
        contents = {role: entry.content for role, entry in manifest.inputs.items()}
        same = Statement(stated.stage, manifest.config, stated.code, contents).key == stated.key
        if manifest.schema != SCHEMA or not same or store.verify(ref):
            return None
    except StoreError:
        return None
    return manifest


def _link(source: Path, target: Path) -> None:
    """The same file under a second name where the disk can do that: artefacts are never modified."""
    target.parent.mkdir(parents=True, exist_ok=True)
    try:
        os.link(source, target)
    except OSError:
        shutil.copyfile(source, target)
