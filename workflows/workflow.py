"""What a workflow is: a configuration, a plan of stages, quantities to report, files to export."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from pydantic import BaseModel

from pipeline.nodes import Node

Value: TypeAlias = float | list[float | None] | None
"""A number, a list of them, or nothing where there was nothing to measure."""


@dataclass(frozen=True)
class Quantity:
    """One result of an experiment.

    Attributes
    ----------
    value
        In the unit; ``None`` where there was nothing to measure.
    unit
        Unit of the value.
    meaning
        What it is, in plain words.
    """

    value: Value
    unit: str
    meaning: str


@dataclass(frozen=True)
class Export:
    """Files made from results.

    Attributes
    ----------
    files
        Names of the files in the output folder.
    module
        Module whose ``write(experiment, folder)`` makes them; imported only when they are made.
    stages
        Stages whose results they show.
    kind
        ``"picture"`` or ``"data"``.
    caption
        What they show, in plain words.
    """

    files: tuple[str, ...]
    module: str
    stages: tuple[str, ...]
    kind: str
    caption: str


@dataclass(frozen=True)
class Workflow:
    """A whole experiment.

    Attributes
    ----------
    name
        Name on the command line; its parameters are in ``parameters/<name>.toml``.
    title
        One line that says what happens.
    module
        Module that defines it.
    config
        Class of its configuration.
    plan
        From a configuration to the planned stages by name.
    quantities
        From the result of the last stage, ``measured``, to the numbers to report.
    measured
        Stage whose record ``quantities`` reads.
    exports
        Files for the output folder.
    """

    name: str
    title: str
    module: str
    config: type[BaseModel]
    plan: Callable[[Any], Mapping[str, Node[Any]]]
    quantities: Callable[[Any], dict[str, Quantity]]
    measured: str
    exports: tuple[Export, ...]
