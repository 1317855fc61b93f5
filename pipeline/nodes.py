"""Stages as functions declared by their signature, and the nodes that calling them plans.

Examples
--------
>>> from dataclasses import dataclass
>>> @dataclass(frozen=True)
... class Length:
...     value: float
>>> @stage
... def doubled(config: Length) -> Length:
...     return Length(2 * config.value)
>>> doubled(Length(3.0))
Node(doubled)
>>> doubled.compute(Length(3.0))
Length(value=6.0)
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeAlias, TypeVar

from pipeline.annotations import parameter_hints
from pipeline.canonical import is_structure
from pipeline.records import accepts, has_parts, is_record_type, parts_of
from pipeline.runs import History, StageRun

__all__ = ["History", "Node", "Part", "Source", "Stage", "StageRun", "stage"]

R = TypeVar("R")


@dataclass(frozen=True)
class Signature:
    """What a stage's function declares.

    Attributes
    ----------
    config
        Name and declared type of the configuration.
    roles
        Declared record type of each input.
    optional
        Roles that may be left out.
    record
        Record class of the result.
    wants_run
        Whether the function takes ``run``.
    """

    config: tuple[str, Any]
    roles: Mapping[str, Any]
    optional: frozenset[str]
    record: type
    wants_run: bool


class Stage(Generic[R]):
    """A function whose signature declares configuration, inputs and result.

    Calling it plans a :class:`Node` and computes nothing; :meth:`compute` is the plain function.
    """

    def __init__(self, function: Callable[..., R]) -> None:
        functools.update_wrapper(self, function)
        self.function = function
        self.name = function.__name__
        self.module = function.__module__

    def __call__(self, config: Any, *inputs: Source, **named: Source) -> Node[R]:
        """Plan this stage on a configuration and the nodes (or parts of nodes) it takes as inputs.

        Raises
        ------
        TypeError
            If a role is unknown or missing, or an input is not of the declared record type.
        """
        return Node(self, config, self._inputs(config, inputs, named))

    def compute(self, config: Any, *inputs: Any, run: StageRun | None = None, **named: Any) -> R:
        """Result of the plain function, with an in-memory run unless one is given."""
        if not self.signature.wants_run:
            return self.function(config, *inputs, **named)
        if run is None:
            from pipeline.running.memory import MemoryRun

            run = MemoryRun()
        return self.function(config, *inputs, run=run, **named)

    @functools.cached_property
    def signature(self) -> Signature:
        """The declaration, read from the function.

        Raises
        ------
        TypeError
            If the function is not declared as a stage must be.
        """
        return _signature(self.function)

    def _inputs(
        self, config: Any, inputs: tuple[Source, ...], named: Mapping[str, Source]
    ) -> dict[str, Source]:
        expected = self.signature.config[1]
        if not is_structure(config):
            raise TypeError(f"stage {self.name} needs a configuration first, got {config!r}")
        if isinstance(expected, type) and not isinstance(config, expected):
            raise TypeError(
                f"stage {self.name} is configured by {expected.__name__}, "
                f"got {type(config).__name__}"
            )
        roles = self.signature.roles
        if len(inputs) > len(roles):
            raise TypeError(f"stage {self.name} takes {len(roles)} inputs, got {len(inputs)}")
        given = dict(zip(roles, inputs, strict=False))
        if repeated := sorted(given.keys() & named.keys()):
            raise TypeError(f"stage {self.name} got the input {repeated[0]} twice")
        given.update(named)
        given = {role: source for role, source in given.items() if source is not None}
        if unknown := sorted(given.keys() - roles.keys()):
            raise TypeError(
                f"stage {self.name} has no input {unknown[0]!r}; it takes: "
                f"{', '.join(roles) or 'none'}"
            )
        if missing := [r for r in roles if r not in given and r not in self.signature.optional]:
            raise TypeError(f"stage {self.name} needs the input {missing[0]!r}")
        for role, source in given.items():
            self._check(role, source)
        return given

    def _check(self, role: str, source: Source) -> None:
        if not isinstance(source, Node | Part):
            raise TypeError(
                f"input {role!r} of stage {self.name} must be a planned node or a part of one, "
                f"got {type(source).__name__}"
            )
        expected = self.signature.roles[role]
        if not accepts(expected, source.record):
            raise TypeError(
                f"input {role!r} of stage {self.name} must be "
                f"{getattr(expected, '__name__', expected)}, but {source} is "
                f"{source.record.__name__}"
            )

    def __repr__(self) -> str:
        return f"Stage({self.name})"

    def __reduce__(self) -> str:
        return self.function.__qualname__


@dataclass(frozen=True, eq=False, repr=False)
class Node(Generic[R]):
    """A stage planned on a configuration and inputs. Nothing is computed."""

    stage: Stage[R]
    config: Any
    inputs: Mapping[str, Source]

    @property
    def record(self) -> type:
        """Record class of the result."""
        return self.stage.signature.record

    def part(self, name: str) -> Part:
        """One part of the result, as an input of another stage.

        Raises
        ------
        TypeError
            If the result has no such part.
        """
        parts = parts_of(self.record)
        if not has_parts(self.record) or name not in parts:
            offer = f"it has: {', '.join(parts)}" if has_parts(self.record) else "it is one whole"
            raise TypeError(f"{self.record.__name__} of {self} has no part {name!r}; {offer}")
        return Part(self, name)

    def __repr__(self) -> str:
        return f"Node({self.stage.name})"


@dataclass(frozen=True, eq=False, repr=False)
class Part:
    """One part of the result of a node."""

    node: Node[Any]
    name: str

    @property
    def record(self) -> type:
        """Record class of the part."""
        return parts_of(self.node.record)[self.name]

    def __repr__(self) -> str:
        return f"Part({self.node.stage.name}.{self.name})"


Source: TypeAlias = Node[Any] | Part


def stage(function: Callable[..., R]) -> Stage[R]:
    """The stage that a function declares; its name is the function's.

    The first parameter is the configuration (a pydantic model or frozen dataclass), the further
    ones are inputs by role, annotated with their record classes; a keyword-only ``run`` receives
    the :class:`StageRun`. The return annotation is the record class of the result.
    """
    return Stage(function)


def source_node(source: Source) -> Node[Any]:
    """The node that an input comes from."""
    return source.node if isinstance(source, Part) else source


def in_order(nodes: Mapping[str, Node[Any]]) -> Iterator[tuple[str, Node[Any]]]:
    """Name and node of everything needed, each after all that it needs.

    A node that is not named in ``nodes`` goes by the name of its stage.
    """
    names = {id(node): name for name, node in nodes.items()}
    seen: set[int] = set()

    def visit(node: Node[Any]) -> Iterator[tuple[str, Node[Any]]]:
        if id(node) in seen:
            return
        seen.add(id(node))
        for source in node.inputs.values():
            yield from visit(source_node(source))
        yield names.get(id(node), node.stage.name), node

    for node in nodes.values():
        yield from visit(node)


def _signature(function: Callable[..., Any]) -> Signature:
    name = function.__name__
    hints = parameter_hints(function)
    parameters = list(inspect.signature(function).parameters.values())
    positional = [p for p in parameters if p.kind is p.POSITIONAL_OR_KEYWORD]
    others = [p.name for p in parameters if p.kind is not p.POSITIONAL_OR_KEYWORD]
    if not positional:
        raise TypeError(f"stage {name} must take its configuration as first parameter")
    if set(others) - {"run"}:
        raise TypeError(f"stage {name}: only 'run' may be keyword-only, found {', '.join(others)}")
    if unannotated := [p.name for p in positional if p.name not in hints]:
        raise TypeError(f"stage {name}: parameter {unannotated[0]!r} has no annotation")
    record = hints.get("return")
    if not isinstance(record, type) or not is_record_type(record):
        raise TypeError(f"stage {name} must be annotated to return a record class, not {record!r}")
    config, *roles = positional
    return Signature(
        config=(config.name, hints[config.name]),
        roles={p.name: hints[p.name] for p in roles},
        optional=frozenset(p.name for p in roles if p.default is not p.empty),
        record=record,
        wants_run="run" in others,
    )
