"""What a workflow is: a configuration, a plan of stages, quantities to report, files to export."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from pydantic import BaseModel

from pipeline.errors import MyofilmError
from pipeline.nodes import Node
from workflows.experiment import Experiment
from workflows.tables import number

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
    limit
        Largest size that is allowed, where the quantity is an error that must be small.
    """

    value: Value
    unit: str
    meaning: str
    limit: float | None = None

    @property
    def is_allowed(self) -> bool:
        """Whether the value keeps its limit; NaN does not."""
        if self.limit is None:
            return True
        return isinstance(self.value, float) and abs(self.value) <= self.limit


class LimitError(MyofilmError):
    """A quantity that must be small is not."""


def check_limits(quantities: Mapping[str, Quantity]) -> None:
    """Refuse quantities beyond their limits.

    Raises
    ------
    LimitError
        Naming all of them.
    """
    beyond = [
        f"{name} is {number(quantity.value)} {quantity.unit}".rstrip()
        + f", allowed is {number(quantity.limit)}"
        for name, quantity in quantities.items()
        if not quantity.is_allowed
    ]
    if beyond:
        raise LimitError("\n".join(["not verified:", *beyond]))


def always(config: Any) -> bool:
    """Whatever is configured."""
    return True


@dataclass(frozen=True)
class Export:
    """Files made from results.

    Attributes
    ----------
    files
        Names of the files in the output folder.
    modules
        Module whose ``write(experiment, folder, *arguments)`` makes them, imported only when they are
        made; then those that it picks by the arguments.
    stages
        Stages whose results they show.
    kind
        ``"picture"`` or ``"data"``.
    caption
        What they show, in plain words.
    sections
        Sections of the configuration that they show.
    arguments
        What ``write`` is told.
    shown
        Whether a configuration asks for them.
    """

    files: tuple[str, ...]
    modules: tuple[str, ...]
    stages: tuple[str, ...]
    kind: str
    caption: str
    sections: tuple[str, ...] = ()
    arguments: tuple[str, ...] = ()
    shown: Callable[[Any], bool] = always


def no_remarks(quantities: Mapping[str, Quantity]) -> Sequence[str]:
    """Nothing to add to the numbers."""
    return ()


@dataclass(frozen=True)
class Workflow:
    """A whole experiment.

    Attributes
    ----------
    name
        Name on the command line; its parameters are in ``parameters/<name>.toml``.
    title
        One line that says what happens.
    modules
        Modules that define it.
    config
        Class of its configuration.
    plan
        From a configuration to the planned stages by name.
    quantities
        From an experiment to the numbers to report; they may depend on its configuration and on the
        results of the stages ``measured``.
    measured
        Stages whose results ``quantities`` reads, if they are planned.
    exports
        Files for the output folder, for the configurations that ask for them.
    remarks
        What the numbers of a run mean for its reader, a paragraph each.
    """

    name: str
    title: str
    modules: tuple[str, ...]
    config: type[BaseModel]
    plan: Callable[[Any], Mapping[str, Node[Any]]]
    quantities: Callable[[Experiment], dict[str, Quantity]]
    measured: tuple[str, ...]
    exports: tuple[Export, ...]
    remarks: Callable[[Mapping[str, Quantity]], Sequence[str]] = no_remarks
