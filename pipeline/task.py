"""One node with what computing it takes, small enough to be sent to another process."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from pipeline.errors import StageError
from pipeline.fingerprint import Fingerprint
from pipeline.fingerprint.sources import Sources
from pipeline.keys import Ref, Statement, code_of, config_modules, statement
from pipeline.manifest import InputEntry
from pipeline.nodes import Node, Stage, source_node


@dataclass(frozen=True)
class Task:
    """A computation by reference: no result of another stage is in it.

    Attributes
    ----------
    name, stage, config
        What is to be computed.
    inputs, records
        Where each input is, and the record class that it is (or is part of).
    key, code
        Key of the result, and digest of the code that it states.
    expected_seconds
        Duration of a similar run.
    argv
        Command line that asked for it.
    """

    name: str
    stage: Stage[Any]
    config: Any
    inputs: Mapping[str, InputEntry]
    records: Mapping[str, type]
    key: str
    code: str
    expected_seconds: float | None = None
    argv: tuple[str, ...] = field(default_factory=lambda: tuple(sys.argv))

    @classmethod
    def of(
        cls,
        name: str,
        node: Node[Any],
        stated: Statement,
        inputs: Mapping[str, InputEntry],
        expected_seconds: float | None = None,
    ) -> Task:
        """Task of a node whose key statement is known."""
        records = {role: source_node(source).record for role, source in node.inputs.items()}
        _KNOWN[stated.code.digest] = stated.code
        return cls(
            name,
            node.stage,
            node.config,
            inputs,
            records,
            stated.key,
            stated.code.digest,
            expected_seconds,
        )

    @property
    def ref(self) -> Ref:
        """Name of the result in its store."""
        return Ref(self.stage.name, self.key)

    def statement(self) -> Statement:
        """The key statement, made anew from configuration, code and inputs as this process has them.

        Raises
        ------
        StageError
            If that is not what the key states: the code here is another one.
        """
        contents = {role: entry.content for role, entry in self.inputs.items()}
        code = _KNOWN.get(self.code) or code_of(self.stage.module, self.config)
        stated = statement(self.stage.name, self.config, code, contents)
        if stated.key != self.key:
            raise StageError(
                self.stage.name,
                "the code of the process that should compute it is not the code of the process that "
                f"asked for it: its key is {stated.key} here and {self.key} there",
                remedy="install the same version for all, and start the workers again",
            )
        _KNOWN[code.digest] = code
        return stated


_KNOWN: dict[str, Fingerprint] = {}
"""Fingerprints by digest; a file edited since is noticed before and after a stage runs."""


class Codes:
    """Fingerprints as the source files are when each is asked for first; each file is read once."""

    def __init__(self) -> None:
        self._known: dict[frozenset[str], Fingerprint] = {}
        self._sources = Sources()

    def of(self, node: Node[Any]) -> Fingerprint:
        """Fingerprint of the code of a node."""
        roots = frozenset((node.stage.module, *config_modules(node.config)))
        if roots not in self._known:
            self._known[roots] = code_of(node.stage.module, node.config, self._sources)
        return self._known[roots]
