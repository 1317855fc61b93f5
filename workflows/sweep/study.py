"""A sweep as it was asked for: the workflow, what all cases have in common, and the cases."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pipeline.canonical import digest
from pipeline.config import read_toml
from pipeline.config.variants import Variants
from pipeline.errors import InputError
from workflows import registry
from workflows.request import Request
from workflows.sweep.asked import Asked, read_design
from workflows.sweep.design import CaseSettings, Design
from workflows.sweep.fields import value_at

if TYPE_CHECKING:
    from pipeline.nodes import Node
    from workflows.workflow import Workflow

TOLD = 5
"""Invalid cases that are told in full."""


@dataclass(frozen=True)
class Study:
    """All cases of a sweep over one workflow.

    Attributes
    ----------
    workflow
        What is run.
    variants
        Makes the configurations of the cases.
    design
        The cases.
    """

    workflow: Workflow
    variants: Variants[Any]
    design: Design

    @classmethod
    def read(cls, name: str, config: Path | None, overrides: Sequence[str], asked: Asked) -> Study:
        """From the command line.

        Raises
        ------
        InputError
            If anything about it is wrong.
        """
        workflow = registry.find(name)
        layers = [read_toml(file) for file in registry.parameter_files(name)]
        if config is not None:
            layers.append(read_toml(config))
        variants = Variants(workflow.config, layers, overrides)
        return cls(workflow, variants, read_design(asked, variants, overrides))

    @cached_property
    def common(self) -> str:
        """The tables that all cases have in common, as text."""
        return json.dumps(self.variants.tables, sort_keys=True)

    @cached_property
    def id(self) -> str:
        """Digest of the workflow and of what the cases have in common."""
        return digest({"workflow": self.workflow.name, "tables": self.common})

    def id_of(self, case: CaseSettings) -> str:
        """Digest of a case, the same in another sweep in which it occurs."""
        return digest({"study": self.id, "values": case.values})[:16]

    def request(self, case: CaseSettings) -> Request:
        """The run that a case is.

        Raises
        ------
        InputError
            If it has no valid configuration.
        """
        return Request(self.workflow, self.variants.load(case.settings))

    def nodes(self, case: CaseSettings) -> Mapping[str, Node[Any]]:
        """Planned stages of a case."""
        return self.workflow.plan(self.variants.load(case.settings))

    def parameters(self, case: CaseSettings) -> list[Any]:
        """Value of each swept field in a case, also where the workflow's own one is left."""
        return [
            case.values[field.path]
            if field.path in case.values
            else value_at(self.variants.common, field.path)
            for field in self.design.fields
        ]

    def checked(self) -> Iterator[tuple[CaseSettings, Mapping[str, Node[Any]]]]:
        """Each case with its planned stages, after which all cases are known to be valid.

        Raises
        ------
        InputError
            At the end, naming the cases that are not, and why.
        """
        problems: list[str] = []
        count = 0
        for case in self.design:
            try:
                nodes = self.nodes(case)
            except InputError as error:
                count += 1
                if len(problems) < TOLD:
                    problems.append(f"{case}: {error}")
                continue
            if not count:
                yield case, nodes
        if count > len(problems):
            problems.append(f"and {count - len(problems)} more")
        if count == 1:
            raise InputError(problems[0])
        if problems:
            total = len(self.design)
            raise InputError("\n".join([f"{count} of {total} cases are not valid:", *problems]))
