"""Why a result is not in the store: how the most similar past result differs from what is asked."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

from pipeline.errors import StoreError
from pipeline.keys import SCHEMA, Statement
from pipeline.manifest import InputEntry, Manifest
from pipeline.store import Store


class Absent:
    """Value of a configuration field that is not there."""

    def __repr__(self) -> str:
        return "absent"


ABSENT = Absent()

LONGEST = 100
"""Characters of a value in a message."""


def _told(value: Any) -> str:
    """A value as it stands in messages: of a model its name, then what it holds, cut short."""
    if not isinstance(value, dict):
        text = repr(value)
    else:
        tag = next((value[one] for one in ("name", "kind") if one in value), None)
        rest = ", ".join(f"{k}={v!r}" for k, v in value.items() if k not in ("name", "kind"))
        text = f"{{{rest}}}" if tag is None else f"{tag} ({rest})" if rest else str(tag)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."


UNKNOWN = ""
"""Content id of an input that is not known before its stage has run."""


@dataclass(frozen=True)
class ConfigChanged:
    """A parameter has another value."""

    field: str
    was: Any
    now: Any

    def named(self, name: str) -> ConfigChanged:
        """The same with another name of the field."""
        return replace(self, field=name)

    def __str__(self) -> str:
        return f"{self.field} is {_told(self.now)}, was {_told(self.was)}"


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
    """Past result of a stage that is most like the one asked for, and the differences.

    That is the one with the fewest differences in its configuration, of these the one with the fewest
    in its inputs, then in its code, then the latest: a result of the same request by older code tells more
    than one of another request by the present code.

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
        found = manifest, tuple(differences(manifest, stated, inputs))
        if best is None or _likeness(*found) > _likeness(*best):
            best = found
    return best


def _likeness(manifest: Manifest, reasons: tuple[Reason, ...]) -> tuple[Any, ...]:
    kinds = (SchemaChanged, ConfigChanged, InputChanged, CodeChanged)
    counts = (-sum(isinstance(reason, kind) for reason in reasons) for kind in kinds)
    return (*counts, manifest.finished)


def differences(
    past: Manifest, stated: Statement, inputs: Mapping[str, InputEntry]
) -> Iterator[Reason]:
    """Why a past result is not the one asked for."""
    if past.schema != SCHEMA:
        yield SchemaChanged(past.schema, SCHEMA)
    yield from config_changes(past.config, stated.config)
    for role in {**inputs, **past.inputs}:
        source, source_before = inputs.get(role), past.inputs.get(role)
        if source is None or source_before is None:
            yield InputChanged(role, (source or past.inputs[role]).stage)
        elif source.content not in (UNKNOWN, source_before.content):
            yield InputChanged(role, source.stage)
    yield from code_changes(past.modules, stated.code.modules)


def config_changes(was: Any, now: Any, field: str = "") -> Iterator[ConfigChanged]:
    """Differences between two canonical configurations, each told once and at its root.

    What came or went is told as a whole, as is a table that is now of another model (its ``name`` or
    ``kind`` differs), and a list of numbers.
    """
    if isinstance(was, dict) and isinstance(now, dict) and _are_of_one_model(was, now):
        for name in {**now, **was}:
            place = f"{field}.{name}".lstrip(".")
            yield from config_changes(was.get(name, ABSENT), now.get(name, ABSENT), place)
    elif isinstance(was, list) and isinstance(now, list) and _has_tables(was) and _has_tables(now):
        for i in range(max(len(was), len(now))):
            before = was[i] if i < len(was) else ABSENT
            after = now[i] if i < len(now) else ABSENT
            yield from config_changes(before, after, f"{field}.{i}")
    elif repr(was) != repr(now):  # 1 and 1.0 differ
        yield ConfigChanged(field, was, now)


def _are_of_one_model(was: Mapping[str, Any], now: Mapping[str, Any]) -> bool:
    return all(was.get(tag) == now.get(tag) for tag in ("name", "kind"))


def _has_tables(items: list[Any]) -> bool:
    return any(isinstance(item, dict | list) for item in items)


def code_changes(was: Mapping[str, str], now: Mapping[str, str]) -> Iterator[CodeChanged]:
    """Modules that differ between two fingerprints, by their digests."""
    for module in sorted({*was, *now}):
        if module not in was:
            yield CodeChanged(module, "added")
        elif module not in now:
            yield CodeChanged(module, "removed")
        elif was[module] != now[module]:
            yield CodeChanged(module, "edited")
