"""What a manifest tells, as rows of text."""

from __future__ import annotations

import datetime
import shlex
from collections.abc import Iterator

from pipeline.canonical import leaves
from pipeline.manifest import Manifest
from pipeline.provenance import version_changes
from pipeline.store import Store
from pipeline.store.labels import RegisteredRun
from workflows.progress import duration, size
from workflows.tables import parameter

Row = tuple[str, str]


def about_run(runs: tuple[RegisteredRun, ...]) -> Iterator[Row]:
    """What is known of a run."""
    label = runs[-1].label
    began = datetime.datetime.fromtimestamp(label.began, datetime.UTC)
    yield "run", label.name
    yield "workflow", label.workflow or "-"
    yield "began", f"{began:%Y-%m-%d %H:%M} UTC"
    yield "on", f"{label.host} (process {label.process})"
    yield "command", shlex.join(label.command)
    yield "folder", label.folder or "-"


def about_result(store: Store, manifest: Manifest) -> Iterator[Row]:
    """What a result is."""
    yield "stage", manifest.stage
    yield "key", manifest.key
    yield "content", manifest.content
    yield "size", f"{size(manifest.size)} in {len(manifest.files)} files"
    yield "folder", str(store.where(manifest.ref))


def how_made(manifest: Manifest) -> Iterator[Row]:
    """How a result came about: when, where, by what, from what."""
    around = manifest.environment
    cost = f"{duration(manifest.seconds)} ({duration(manifest.cpu_seconds)} of CPU)"
    yield "computed in", f"{cost}, at most {size(manifest.peak_memory)} of memory"
    yield "finished", f"{manifest.finished[:16].replace('T', ' ')} UTC"
    yield "on", f"{around.get('host', '-')}, {around.get('platform', '-')}"
    yield "command", shlex.join(around.get("argv", ()))
    yield "code", f"{manifest.code[:12]}, {len(manifest.modules)} modules{_revision(manifest)}"
    versions = around.get("versions", {})
    yield "with", ", ".join(f"{name} {version}" for name, version in versions.items())
    if changes := version_changes(versions):
        yield "differs", ", ".join(changes)
    for role, entry in manifest.inputs.items():
        part = f", its {entry.part}" if entry.part else ""
        yield f"input {role}", f"{entry.stage}/{entry.key[:12]}{part}"
    known = {"host", "platform", "argv", "versions", "git", "pid"}
    for name, value in leaves({k: v for k, v in around.items() if k not in known and v != {}}):
        yield f"run {name}", parameter(value)
    yield from (("warning", warning) for warning in manifest.warnings)
    yield from ((f"note {name}", parameter(value)) for name, value in manifest.notes.items())


def configuration(manifest: Manifest) -> Iterator[Row]:
    """The configuration that the key states."""
    yield from ((f"config {name}", parameter(value)) for name, value in leaves(manifest.config))


def _revision(manifest: Manifest) -> str:
    git = manifest.environment.get("git")
    if not git:
        return ""
    return f", git {git['revision'][:12]}{' with changes' if git['dirty'] else ''}"
