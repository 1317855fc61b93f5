"""What a user means by the name of a run, or by a key, with everything upstream of it."""

from __future__ import annotations

from dataclasses import dataclass

from pipeline.errors import InputError
from pipeline.lineage import Lineage, lineage
from pipeline.store import Store
from pipeline.store.labels import RegisteredRun, runs_called
from workflows.upkeep.names import artefact, artefacts


@dataclass(frozen=True)
class Subject:
    """One result, or the results of a run.

    Attributes
    ----------
    runs
        The runs of that name, the latest last; empty for one result.
    lines
        The results, and what they were made from.
    """

    runs: tuple[RegisteredRun, ...]
    lines: Lineage


def subject(store: Store, name: str) -> Subject:
    """The run of a name or of an output folder, or else the one result whose key starts so.

    Raises
    ------
    InputError
        If there is none, more than one result, or a run that used none.
    """
    try:
        runs = runs_called(store.upkeep.runs(), name)
    except InputError as no_run:
        if not artefacts(store, name):
            raise InputError(f"{no_run}. No key of a result starts with {name!r}, either") from None
        return Subject((), lineage(store, [artefact(store, name)]))
    used = dict.fromkeys(ref for run in runs for ref in store.upkeep.used_by(run.label))
    if not used:
        raise InputError(f"the run {name!r} has used no results yet")
    return Subject(tuple(runs), lineage(store, sorted(used, key=str)))
