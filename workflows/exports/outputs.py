"""Everything a finished run leaves in its output folder; only what is out of date is made."""

from __future__ import annotations

import contextlib
import dataclasses
import importlib
import json
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pipeline.canonical import canonical
from pipeline.verification import telling_damage
from workflows.experiment import Experiment
from workflows.exports.files import holds, write_text
from workflows.exports.ledger import Ledger, source_id
from workflows.pages import sources
from workflows.workflow import Export, Quantity

if TYPE_CHECKING:
    from pipeline.runner import Outcome
    from workflows.request import Request

Outcomes = Mapping[str, "Outcome"]


def write_outputs(request: Request, outcomes: Outcomes, folder: Path) -> dict[str, Quantity]:
    """Write pictures, data, report and summary; give the quantities.

    Raises
    ------
    DamagedError
        If that fails because a result is damaged.
    """
    ledger = Ledger(folder)
    experiment = experiment_of(request, outcomes)
    with reading(outcomes.values()):
        for export in request.workflow.exports:
            if export not in request.exports:
                ledger.remove(export.files)
        for export in request.exports:
            _make(export, request, outcomes, experiment, ledger, folder)
        quantities = read_quantities(request, outcomes, ledger)
        _make_report(request, outcomes, quantities, ledger, folder)
    write_summary(request, outcomes, quantities, folder)
    return quantities


@contextlib.contextmanager
def reading(outcomes: Iterable[Outcome]) -> Iterator[None]:
    """Tell of a damaged result instead of the failure that it leads to in the block."""
    with contextlib.ExitStack() as stack:
        for outcome in outcomes:
            stack.enter_context(telling_damage(outcome.store, [outcome.manifest.ref]))
        yield


def experiment_of(request: Request, outcomes: Outcomes) -> Experiment:
    """The results of a run, loaded on demand."""
    return Experiment(request.config, lambda stage: outcomes[stage].load())


def read_quantities(request: Request, outcomes: Outcomes, ledger: Ledger) -> dict[str, Quantity]:
    """Quantities of a run, from the ledger if they are known for this very result."""
    workflow = request.workflow
    results = _contents(outcomes, request.measured)
    config = canonical(request.config)
    source = source_id(workflow.modules, {"results": results, "config": config}, ledger.sources)
    kept = ledger.value("quantities", source)
    if kept is None:
        with reading(outcomes.values()):
            found = workflow.quantities(experiment_of(request, outcomes))
        kept = {k: dataclasses.asdict(q) for k, q in found.items()}
        ledger.keep("quantities", source, kept)
    return {name: Quantity(**entry) for name, entry in kept.items()}


def write_summary(
    request: Request, outcomes: Outcomes, quantities: Mapping[str, Quantity], folder: Path
) -> None:
    """Write ``summary.json``: the quantities, and what this run did for each stage.

    ``seconds`` is the time that this run spent on a stage: none if its result was in the store.
    """
    text = summary_text({"workflow": request.workflow.name}, quantities, outcomes)
    if not holds(folder / "summary.json", text):
        write_text(folder / "summary.json", text)


def summary_text(
    heading: Mapping[str, str], quantities: Mapping[str, Quantity], outcomes: Outcomes
) -> str:
    """Text of a ``summary.json``, which begins with the heading."""
    summary = {
        **heading,
        "quantities": {name: _summarised(quantity) for name, quantity in quantities.items()},
        "stages": {
            name: {
                "key": outcome.key,
                "hit": outcome.hit,
                "seconds": 0.0 if outcome.hit else round(outcome.seconds, 3),
            }
            for name, outcome in outcomes.items()
        },
    }
    return json.dumps(summary, indent=2) + "\n"


def _summarised(quantity: Quantity) -> dict[str, Any]:
    entry: dict[str, Any] = {"value": quantity.value, "unit": quantity.unit}
    return entry if quantity.limit is None else entry | {"limit": quantity.limit}


def _source(export: Export, request: Request, outcomes: Outcomes, ledger: Ledger) -> str:
    shown = {section: getattr(request.config, section) for section in export.sections}
    contents = {
        "results": _contents(outcomes, export.stages),
        "config": canonical(shown),
        "arguments": export.arguments,
    }
    return source_id(export.modules, contents, ledger.sources)


def _make(
    export: Export,
    request: Request,
    outcomes: Outcomes,
    experiment: Experiment,
    ledger: Ledger,
    folder: Path,
) -> None:
    source = _source(export, request, outcomes, ledger)
    if all(ledger.is_current(file, source) for file in export.files):
        return
    importlib.import_module(export.modules[0]).write(experiment, folder, *export.arguments)
    for file in export.files:
        ledger.made(file, source)


def _make_report(
    request: Request,
    outcomes: Outcomes,
    quantities: Mapping[str, Quantity],
    ledger: Ledger,
    folder: Path,
) -> None:
    contents: dict[str, Any] = {
        "config": canonical(request.config),
        "stages": {name: outcome.key for name, outcome in outcomes.items()},
        "results": _contents(outcomes, tuple(outcomes)),
        "quantities": {name: repr(quantity) for name, quantity in quantities.items()},
        "remarks": list(request.workflow.remarks(quantities)),
        "template": sources("report.html"),
        "exports": [_source(export, request, outcomes, ledger) for export in request.exports],
    }
    source = source_id(["workflows.report"], contents, ledger.sources)
    if not ledger.is_current("report.html", source):
        from workflows.report import render

        write_text(folder / "report.html", render(request, outcomes, quantities, folder))
        ledger.made("report.html", source)


def _contents(outcomes: Outcomes, stages: tuple[str, ...]) -> dict[str, str]:
    return {stage: outcomes[stage].content for stage in stages}
