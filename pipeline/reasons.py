"""Why a result is not in the store: how the most similar past result differs from what is asked."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from pipeline.canonical import leaves
from pipeline.errors import StoreError
from pipeline.keys import SCHEMA, Statement
from pipeline.manifest import InputEntry, Manifest
from pipeline.store import Store


class Absent:
    """Value of a configuration field that is not there."""

    def __repr__(self) -> str:
        return "absent"


ABSENT = Absent()

UNKNOWN = ""
"""Content id of an input that is not known before its stage has run."""


@dataclass(frozen=True)
class ConfigChanged:
    """A parameter has another value."""

    field: str
    was: Any
    now: Any

    def __str__(self) -> str:
        return f"{self.field} is {self.now!r}, was {self.was!r}"


@dataclass(frozen=True)
class InputChanged:
    """The result of an earlier stage is another one."""

    role: str
    stage: str

    def __str__(self) -> str:
        return f"input {self.role} (from {self.stage}) changed"


@dataclass(frozen=True)
class CodeChanged:
    """A module was ``"edited"``, ``"added"`` to the code that is used, or ``"removed"`` from it."""

    module: str
    how: str

    def __str__(self) -> str:
        return f"module {self.module} was {self.how}"


@dataclass(frozen=True)
class SchemaChanged:
    """The store's own version is another one."""

    was: int
    now: int

    def __str__(self) -> str:
        return f"the store's schema is {self.now}, was {self.was}"


Reason: TypeAlias = ConfigChanged | InputChanged | CodeChanged | SchemaChanged


def nearest(
    stated: Statement,
    inputs: Mapping[str, InputEntry],
    store: Store,
    *,
    among: int | None = None,
) -> tuple[Manifest, tuple[Reason, ...]] | None:
    """Past result of a stage with the fewest differences, the latest of these, and the differences.

    Parameters
    ----------
    stated
        What is asked; its ``inputs`` are not looked at.
    inputs
        Inputs by role; the content of one that is not known yet is :data:`UNKNOWN`, which may be
        anything.
    store
        Where past results are.
    among
        Look at so many of the latest results only; ``None`` for all.
    """
    best: tuple[Manifest, tuple[Reason, ...]] | None = None
    refs = store.refs(stated.stage) if among is None else store.newest(stated.stage, among)
    for ref in refs:
        try:
            manifest = store.manifest(ref)
        except StoreError:
            continue  # damage to one result must not keep others from being computed
        reasons = tuple(differences(manifest, stated, inputs))
        if best is None or (-len(reasons), manifest.finished) > (-len(best[1]), best[0].finished):
            best = manifest, reasons
    return best


def differences(
    past: Manifest, stated: Statement, inputs: Mapping[str, InputEntry]
) -> Iterator[Reason]:
    """Why a past result is not the one asked for."""
    if past.schema != SCHEMA:
        yield SchemaChanged(past.schema, SCHEMA)
    was, now = dict(leaves(past.config)), dict(leaves(stated.config))
    for field in {**now, **was}:
        before, after = was.get(field, ABSENT), now.get(field, ABSENT)
        if repr(before) != repr(after):  # 1 and 1.0 differ
            yield ConfigChanged(field, before, after)
    for role in {**inputs, **past.inputs}:
        source, source_before = inputs.get(role), past.inputs.get(role)
        if source is None or source_before is None:
            yield InputChanged(role, (source or past.inputs[role]).stage)
        elif source.content not in (UNKNOWN, source_before.content):
            yield InputChanged(role, source.stage)
    for module in sorted({*past.modules, *stated.code.modules}):
        if module not in past.modules:
            yield CodeChanged(module, "added")
        elif module not in stated.code.modules:
            yield CodeChanged(module, "removed")
        elif past.modules[module] != stated.code.modules[module]:
            yield CodeChanged(module, "edited")
