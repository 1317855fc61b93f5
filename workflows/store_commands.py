"""What the commands about the store do; they read manifests only."""

from __future__ import annotations

from pipeline.canonical import leaves
from pipeline.errors import InputError
from pipeline.keys import Ref
from pipeline.store import LocalStore
from workflows.progress import duration, size
from workflows.registry import unknown
from workflows.request import open_store
from workflows.tables import aligned, parameter

SHORT = 12
"""Characters of a key that are shown in lists."""


def list_artefacts(stage: str | None, location: str | None) -> None:
    """One line for each result kept: stage, key, size, cost, age."""
    store = open_store(location)
    refs = list(store.refs())
    stages = sorted({ref.stage for ref in refs})
    if stage is not None and refs and stage not in stages:
        raise unknown("kept result of a stage", stage, stages)
    manifests = [store.manifest(ref) for ref in refs if stage in (None, ref.stage)]
    if not manifests:
        print(f"{store.path} holds no results")
        return
    rows = [("STAGE", "KEY", "SIZE", "COMPUTED IN", "FINISHED (UTC)")]
    rows += [
        (m.stage, m.key[:SHORT], size(m.size), duration(m.seconds), m.finished[:16])
        for m in manifests
    ]
    for line in aligned(rows):
        print(line)
    print(f"{len(manifests)} results, {size(sum(m.size for m in manifests))} in {store.path}")


def show_artefact(key: str, location: str | None) -> None:
    """Everything that the manifest of one result tells."""
    store = open_store(location)
    manifest = store.manifest(_ref(store, key))
    rows = [
        ("stage", manifest.stage),
        ("key", manifest.key),
        ("content", manifest.content),
        ("size", size(manifest.size)),
        ("computed in", f"{duration(manifest.seconds)} ({duration(manifest.cpu_seconds)} of CPU)"),
        ("peak memory", size(manifest.peak_memory)),
        ("finished", manifest.finished),
        ("folder", str(store.data(manifest.ref))),
    ]
    rows += [
        (
            f"input {role}",
            f"{entry.stage}/{entry.key[:SHORT]}" + ((entry.part and f" {entry.part}") or ""),
        )
        for role, entry in manifest.inputs.items()
    ]
    rows += [("warning", warning) for warning in manifest.warnings]
    rows += [(f"note {name}", parameter(value)) for name, value in manifest.notes.items()]
    for title, values in (("config", manifest.config), ("run", dict(manifest.environment))):
        rows += [(f"{title} {name}", parameter(value)) for name, value in leaves(values)]
    for line in aligned(rows):
        print(line)


def _ref(store: LocalStore, key: str) -> Ref:
    stage, _, start = key.rpartition("/")
    refs = [ref for ref in store.refs() if ref.key.startswith(start) and stage in ("", ref.stage)]
    if not refs or not start:
        raise InputError(f"{store.path} holds no result whose key starts with {start!r}")
    if len(refs) > 1:
        several = ", ".join(f"{ref.stage}/{ref.key[:SHORT]}" for ref in refs[:5])
        raise InputError(f"{len(refs)} results have a key that starts with {start!r}: {several}")
    return refs[0]
