"""The store of write-once artefacts: what every store does, and the kinds of stores."""

from __future__ import annotations

from pipeline.store.labels import RunLabel, process_label
from pipeline.store.local import LocalStore
from pipeline.store.opening import open_store
from pipeline.store.protocol import Store, Workspace

__all__ = ["LocalStore", "RunLabel", "Store", "Workspace", "open_store", "process_label"]
