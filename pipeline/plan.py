"""The plan: for each stage whether its result is there, and if not, why.

Nothing is computed or loaded; a plan reads manifests only.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from pipeline.canonical import Canonical, canonical
from pipeline.fingerprint import Fingerprint
from pipeline.keys import SCHEMA, Statement, code_of, statement
from pipeline.manifest import InputEntry, Manifest
from pipeline.nodes import Node, Part, in_order, source_node
from pipeline.store import Store


class Absent:
    """Value of a configuration field that is not there."""

    def __repr__(self) -> str:
        return "absent"


ABSENT = Absent()


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


@dataclass(frozen=True)
class Forecast:
    """Cost of the most similar past run."""

    seconds: float
    size: int


@dataclass(frozen=True)
class Hit:
    """The result is in the store."""

    node: str
    stage: str
    key: str
    manifest: Manifest

    @property
    def forecast(self) -> Forecast:
        """Nothing is left to do."""
        return Forecast(0.0, 0)


@dataclass(frozen=True)
class Missing:
    """The store holds no result of this stage at all."""

    node: str
    stage: str
    key: str | None

    @property
    def forecast(self) -> None:
        """Nothing is known about the cost."""
        return


@dataclass(frozen=True)
class Changed:
    """The store holds other results of this stage; ``reasons`` tell from the most similar one."""

    node: str
    stage: str
    key: str | None
    reasons: tuple[Reason, ...]
    forecast: Forecast


@dataclass(frozen=True)
class Pending:
    """The stages ``waits_for`` must run first; if their results come out the same, this is a hit."""

    node: str
    stage: str
    waits_for: tuple[str, ...]
    forecast: Forecast

    @property
    def key(self) -> None:
        """Not known before the inputs are."""
        return


Verdict: TypeAlias = Hit | Missing | Changed | Pending


def explain(nodes: Mapping[str, Node[Any]], store: Store) -> list[Verdict]:
    """Verdict on each node that is needed, in the order in which they would run.

    Raises
    ------
    StoreError
        If the store cannot be read or an artefact is damaged.
    InputError
        If source code cannot be read.
    """
    verdicts: dict[int, Verdict] = {}
    found: dict[int, Manifest] = {}
    for name, node in in_order(nodes):
        verdicts[id(node)] = verdict = _judge(name, node, store, found)
        if isinstance(verdict, Hit):
            found[id(node)] = verdict.manifest
    return list(verdicts.values())


def input_entries(node: Node[Any], manifests: Mapping[int, Manifest]) -> dict[str, InputEntry]:
    """Input table of a node from the manifests (by ``id``) of the nodes it needs."""
    entries = {}
    for role, source in node.inputs.items():
        manifest = manifests[id(source_node(source))]
        part = source.name if isinstance(source, Part) else None
        entries[role] = InputEntry(manifest.stage, manifest.key, part, manifest.content_of(part))
    return entries


def statement_of(node: Node[Any], inputs: Mapping[str, InputEntry]) -> Statement:
    """Key statement of a node."""
    contents = {role: entry.content for role, entry in inputs.items()}
    return statement(node.stage.name, node.stage.module, node.config, contents)


def nearest(
    stage: str, config: Canonical, code: Fingerprint, inputs: Mapping[str, str], store: Store
) -> tuple[Manifest, tuple[Reason, ...]] | None:
    """Past result of a stage with the fewest differences, the latest of these, and the differences.

    Roles that are not in ``inputs`` are not compared.
    """
    best: tuple[Manifest, tuple[Reason, ...]] | None = None
    for ref in store.refs(stage):
        manifest = store.manifest(ref)
        reasons = tuple(differences(manifest, config, code, inputs))
        if best is None or (-len(reasons), manifest.finished) > (-len(best[1]), best[0].finished):
            best = manifest, reasons
    return best


def differences(
    past: Manifest, config: Canonical, code: Fingerprint, inputs: Mapping[str, str]
) -> Iterator[Reason]:
    """Why a past result is not the one asked for."""
    if past.schema != SCHEMA:
        yield SchemaChanged(past.schema, SCHEMA)
    was, now = dict(_leaves(past.config)), dict(_leaves(config))
    for field in {**now, **was}:
        before, after = was.get(field, ABSENT), now.get(field, ABSENT)
        if (type(before), before) != (type(after), after):
            yield ConfigChanged(field, before, after)
    for role, content in inputs.items():
        entry = past.inputs.get(role)
        if entry is None or entry.content != content:
            yield InputChanged(role, entry.stage if entry else "")
    for module in sorted({*past.modules, *code.modules}):
        if module not in past.modules:
            yield CodeChanged(module, "added")
        elif module not in code.modules:
            yield CodeChanged(module, "removed")
        elif past.modules[module] != code.modules[module]:
            yield CodeChanged(module, "edited")


def _judge(name: str, node: Node[Any], store: Store, found: Mapping[int, Manifest]) -> Verdict:
    stage = node.stage.name
    waits_for = tuple(
        dict.fromkeys(
            source_node(source).stage.name
            for source in node.inputs.values()
            if id(source_node(source)) not in found
        )
    )
    if waits_for:
        config, code = canonical(node.config), code_of(node.stage.module, node.config)
        known = {
            role: source for role, source in node.inputs.items() if id(source_node(source)) in found
        }
        contents: Mapping[str, str] = {
            role: entry.content
            for role, entry in input_entries(Node(node.stage, node.config, known), found).items()
        }
        key = None
    else:
        stated = statement_of(node, input_entries(node, found))
        if manifest := store.find(stated.ref):
            return Hit(name, stage, stated.key, manifest)
        config, code, contents, key = stated.config, stated.code, stated.inputs, stated.key
    past = nearest(stage, config, code, contents, store)
    if past is None:
        return Missing(name, stage, key)
    forecast = Forecast(past[0].seconds, past[0].size)
    if waits_for and not past[1]:
        return Pending(name, stage, waits_for, forecast)
    return Changed(name, stage, key, past[1], forecast)


def _leaves(value: Canonical, path: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict) and value:
        for name, item in value.items():
            yield from _leaves(item, f"{path}.{name}".lstrip("."))
    elif isinstance(value, list) and any(isinstance(item, dict | list) for item in value):
        for i, item in enumerate(value):
            yield from _leaves(item, f"{path}.{i}")
    else:
        yield path, value
