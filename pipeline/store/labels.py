"""Who uses artefacts: the label under which a run registers them, and what is known of past runs."""

from __future__ import annotations

import dataclasses
import os
import platform
import re
import sys
import time
from collections.abc import Iterable
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import cache
from pathlib import Path

from pipeline.canonical import digest
from pipeline.errors import InputError

UNSEEN_DAYS = 30.0
"""Days for which a run keeps its artefacts though nobody can tell here whether its folder is there."""


def _generation() -> str:
    return f"{time.time_ns():020d}-{os.urandom(4).hex()}"


@dataclass(frozen=True)
class RunLabel:
    """Name under which a run registers what it uses; small, and the same in all its processes.

    Attributes
    ----------
    name
        Name given by the user, or else the output folder, or else the process.
    named
        Whether the user gave it: such a run keeps its artefacts until it is removed.
    folder
        Output folder: a run without a name keeps its artefacts while that is there. A run that has
        neither keeps them while its process lives.
    workflow, config, command
        What ran: name of the workflow, digest of its configuration, command line.
    host, process
        Where it was begun.
    began
        Seconds since 1970.
    generation
        Tells the runs of one name apart; the latest sorts last.
    """

    name: str
    named: bool = False
    folder: str | None = None
    workflow: str = ""
    config: str = ""
    command: tuple[str, ...] = field(default_factory=lambda: tuple(sys.argv))
    host: str = field(default_factory=platform.node)
    process: int = field(default_factory=os.getpid)
    began: float = field(default_factory=time.time)
    generation: str = field(default_factory=_generation)

    @classmethod
    def of(
        cls, name: str | None, folder: str | os.PathLike[str], workflow: str = "", config: str = ""
    ) -> RunLabel:
        """Label of a run that writes to a folder, under a name or under that of the folder.

        Raises
        ------
        InputError
            If the name is empty or of several lines.
        """
        path = str(Path(folder).expanduser().absolute())
        if name is None:
            return cls(path, folder=path, workflow=workflow, config=config)
        if not name.strip() or not name.isprintable():
            raise InputError(f"a run cannot have the name {name!r}; choose another with --name")
        return cls(name, named=True, folder=path, workflow=workflow, config=config)

    @property
    def slug(self) -> str:
        """Name as the name of a file: readable, and different for different names."""
        readable = re.sub(r"[^A-Za-z0-9]+", "-", self.name)[-40:].strip("-")
        return f"{readable or 'run'}.{digest(self.name)[:16]}"


@dataclass(frozen=True)
class RegisteredRun:
    """What a store knows of a run.

    Attributes
    ----------
    label
        Under which it registered.
    finished
        When it ended well, seconds since 1970; ``None`` if it did not, or not yet.
    alive
        Whether its process still runs.
    """

    label: RunLabel
    finished: float | None
    alive: bool

    def keeps(self, now: float) -> bool:
        """Whether the run keeps what it registered from being removed.

        Examples
        --------
        >>> there = RunLabel("/", folder="/")
        >>> gone = RunLabel("/removed", folder="/removed")
        >>> [RegisteredRun(label, None, False).keeps(gone.began) for label in (there, gone)]
        [True, False]
        """
        label = self.label
        if self.alive or label.named:
            return True
        if label.folder is None:
            return False
        if os.path.isdir(label.folder):
            return True
        # The folder may be on another machine, or on a disk that is not there today.
        unseen = label.host != platform.node() or not os.path.isdir(os.path.dirname(label.folder))
        return unseen and now - label.began < UNSEEN_DAYS * 86400


@cache
def _label_of(process: int) -> RunLabel:
    return RunLabel(f"process {process} on {platform.node()}")


def process_label() -> RunLabel:
    """Label of whatever this process does without a name and an output folder."""
    return _label_of(os.getpid())


def to_json(label: RunLabel) -> dict[str, object]:
    """Plain data of a label."""
    return dataclasses.asdict(label)


def from_json(data: dict[str, object]) -> RunLabel:
    """Label read back; what a later version may have added is left out.

    Raises
    ------
    ValueError
        If the data are not those of a label.
    """
    names = {one.name for one in dataclasses.fields(RunLabel)}
    try:
        known = {name: value for name, value in data.items() if name in names}
        known["command"] = tuple(known["command"])  # type: ignore[arg-type]
        label = RunLabel(**known)  # type: ignore[arg-type]
    except (TypeError, KeyError, AttributeError) as error:
        raise ValueError(f"not the label of a run: {error}") from error
    if not isinstance(label.name, str) or not isinstance(label.generation, str):
        raise ValueError("not the label of a run: it has no name")
    return label


def runs_called(runs: Iterable[RegisteredRun], name: str) -> list[RegisteredRun]:
    """All runs of a name, the latest last: the name itself, or that of an output folder.

    Raises
    ------
    InputError
        If there is none.
    """
    known = sorted(runs, key=lambda run: run.label.generation)
    path = str(Path(name).expanduser().absolute())
    for wanted in (name, path):
        if found := [run for run in known if run.label.name == wanted]:
            return found
    if found := [run for run in known if run.label.folder == path]:
        return [run for run in found if run.label.name == found[-1].label.name]
    near = get_close_matches(name, [run.label.name for run in known], n=1, cutoff=0.5)
    hint = f"; did you mean {near[0]!r}?" if near else "."
    raise InputError(
        f"no run is called {name!r}{hint} `myofilm store runs` lists {len(known)} runs"
    )
