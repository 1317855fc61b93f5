"""What is told about one kept result; its manifest is all that is read."""

from __future__ import annotations

from pipeline.canonical import leaves
from workflows.progress import duration, size
from workflows.request import open_store
from workflows.tables import aligned, parameter
from workflows.upkeep.names import SHORT, artefact


def show_artefact(key: str, location: str | None) -> None:
    """Everything that the manifest of one result tells."""
    store = open_store(location)
    manifest = store.manifest(artefact(store, key))
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
