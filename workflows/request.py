"""What a command asks for: workflow, configuration, store and output folder, all checked."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pipeline.errors import InputError
from workflows import registry

if TYPE_CHECKING:
    from pydantic import BaseModel

    from pipeline.nodes import Node
    from pipeline.store import Store
    from workflows.workflow import Export, Workflow

NOTHING: Mapping[str, Any] = {}


@dataclass(frozen=True)
class Request:
    """A workflow with its validated configuration."""

    workflow: Workflow
    config: BaseModel

    @classmethod
    def read(
        cls,
        name: str,
        config: Path | None = None,
        overrides: Sequence[str] = (),
        defaults: Mapping[str, Any] = NOTHING,
    ) -> Request:
        """The paper's parameters, a file's over them, and ``SECTION.KEY=VALUE`` strings over both.

        ``defaults`` are tables that stand in for the paper's parameters, below the file.

        Raises
        ------
        InputError
            If anything about these is wrong.
        """
        from pipeline.config import load, read_toml

        workflow = registry.find(name)
        layers: list[Mapping[str, Any]] = [
            *(read_toml(file) for file in registry.parameter_files(name)),
            defaults,
        ]
        if config is not None:
            layers.append(read_toml(config))
        return cls(workflow, load(workflow.config, layers, overrides))

    @property
    def exports(self) -> tuple[Export, ...]:
        """Files that this configuration asks for."""
        return tuple(export for export in self.workflow.exports if export.shown(self.config))

    @property
    def measured(self) -> tuple[str, ...]:
        """Planned stages whose results the quantities read."""
        planned = self.workflow.plan(self.config)
        return tuple(stage for stage in self.workflow.measured if stage in planned)

    def nodes(self, last: str | None = None) -> Mapping[str, Node[Any]]:
        """Planned stages by name, all or those that the stage ``last`` needs, itself included.

        Raises
        ------
        InputError
            If the workflow has no such stage.
        """
        nodes = self.workflow.plan(self.config)
        if last is None:
            return nodes
        if last not in nodes:
            raise registry.unknown("stage", last, list(nodes), self.workflow.name)
        from pipeline.nodes import in_order

        needed = {id(node) for _, node in in_order({last: nodes[last]})}
        return {name: node for name, node in nodes.items() if id(node) in needed}


def open_store(location: str | None) -> Store:
    """The store that ``--store`` names, or the one in the user's cache folder.

    Raises
    ------
    InputError
        If there can be no store.
    """
    from pipeline.store import open_store as opened
    from workflows.startup import under_way

    under_way()  # whatever takes long has a store
    return opened(location)


def output_folder(path: Path) -> Path:
    """The folder, made if it is not there; what killed processes left half written in it is removed.

    Raises
    ------
    InputError
        If it cannot be written: better known before hours of computing than after.
    """
    from workflows.unfinished import remove_unfinished, temporary_sibling

    if path.exists() and not path.is_dir():
        raise InputError(f"the output folder {path} is a file; choose another with --out")
    try:
        path.mkdir(parents=True, exist_ok=True)
        probe = temporary_sibling(path / "writable")
        probe.touch()
        probe.unlink()
        remove_unfinished(path)
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else str(error)
        raise InputError(
            f"cannot write to the output folder {path}: {reason.lower()}; choose another with --out"
        ) from error
    return path
