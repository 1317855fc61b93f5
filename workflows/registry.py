"""Workflows by name; none is imported before it is asked for.

A new workflow is a module that defines ``WORKFLOW``, a file ``parameters/<name>.toml``, and one entry
here, which names the parameter files that it shares with others.
"""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from workflows.workflow import Workflow


@dataclass(frozen=True)
class Entry:
    """Where a workflow is, what it is in one line, and the parameter files below its own."""

    name: str
    module: str
    about: str
    shared: tuple[str, ...] = ()


TISSUE = ("film", "cells", "tissue")
"""Parameter files of experiments with cells."""

FILM_WITH_CELLS = (*TISSUE, "coupled-film")
"""The same where the film moves (section 4.3)."""

ENTRIES = (
    Entry(
        "curling",
        "workflows.curling",
        "a film curls slowly under an imposed activation (section 4.1, Figs 3-5)",
    ),
    Entry(
        "twitch",
        "workflows.twitch",
        "a film swings under one pulse of an imposed activation (section 4.2, Figs 6 and 7)",
    ),
    Entry(
        "planar-waves",
        "workflows.planar_waves",
        "electrical waves S1 and S2 cross a film and make it beat (section 4.3, Figs 8 and 9)",
        FILM_WITH_CELLS,
    ),
    Entry(
        "spiral-wave",
        "workflows.spiral_wave",
        "a wave S3 across the tail of S1 turns into a spiral (section 4.3, Figs 10 and 11)",
        FILM_WITH_CELLS,
    ),
    Entry(
        "restitution",
        "workflows.restitution",
        "how long and how strong a beat is, by how long the tissue has rested (S1-S2)",
        TISSUE,
    ),
    Entry(
        "vulnerable-window",
        "workflows.vulnerable_window",
        "when S3 must come for its wave to turn into a spiral: sweep and bisection",
        TISSUE,
    ),
    Entry(
        "verification",
        "workflows.verification.experiment",
        "the solvers against closed forms and published values (Appendices B and C, and more)",
    ),
)


def find(name: str) -> Workflow:
    """The workflow of that name.

    Raises
    ------
    InputError
        If there is none.
    """
    workflow: Workflow = importlib.import_module(_entry(name).module).WORKFLOW
    return workflow


def parameter_files(name: str) -> tuple[Path, ...]:
    """Files with a workflow's parameters as the paper gives them, each laid over the one before."""
    folder = Path(__file__).parent / "parameters"
    return tuple(folder / f"{file}.toml" for file in (*_entry(name).shared, name))


def _entry(name: str) -> Entry:
    for entry in ENTRIES:
        if entry.name == name:
            return entry
    raise unknown("workflow", name, [entry.name for entry in ENTRIES])


def unknown(kind: str, name: str, names: list[str], owner: str = "") -> Exception:
    """Error for a name that does not exist (in the owner's list), with the nearest one that does.

    Examples
    --------
    >>> print(unknown("workflow", "planar-wave", ["planar-waves"]))
    there is no workflow 'planar-wave'; did you mean 'planar-waves'? Known: planar-waves
    >>> print(unknown("stage", "electrophysiology", ["geometry"], "curling"))
    curling has no stage 'electrophysiology'. Known: geometry
    """
    from pipeline.errors import InputError

    near = get_close_matches(name, names, n=1, cutoff=0.5)
    hint = f"; did you mean {near[0]!r}?" if near else "."
    lack = f"{owner} has no" if owner else "there is no"
    return InputError(f"{lack} {kind} {name!r}{hint} Known: {', '.join(names)}")
