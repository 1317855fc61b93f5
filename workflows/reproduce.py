"""Figures of the paper from runs with the paper's parameters."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workflows import registry
from workflows.exports.files import write_text
from workflows.figures.catalogue import FIGURES, Drawn, PaperFigure
from workflows.progress import watching
from workflows.request import Request, open_store, output_folder
from workflows.tables import aligned, fitted, number
from workflows.ways import USUAL, Way

if TYPE_CHECKING:
    from pipeline.executors import Executor
    from pipeline.nodes import Node
    from pipeline.runner import Outcome
    from pipeline.store import Store
    from pipeline.store.labels import RunLabel


def list_figures() -> None:
    """One line for each figure."""
    for line in aligned([(figure.name, figure.about) for figure in FIGURES]):
        print(line)


def draw(
    figure: str,
    config: Path | None,
    overrides: Sequence[str],
    out: Path | None,
    store: str | None,
    way: Way = USUAL,
) -> None:
    """Run what a figure needs, then draw it; runs that are in the store are not repeated."""
    from workflows.exports.outputs import experiment_of, reading, summary_text
    from workflows.labels import label_of, registered

    wanted = _figure(figure)
    requests = {
        label: Request.read(
            planned.workflow, config, [*overrides, *planned.overrides], planned.defaults
        )
        for label, planned in wanted.runs.items()
    }
    kept = open_store(store)
    folder = output_folder(out or Path("results/reproduce") / figure)
    label = label_of(way.name, folder, f"reproduce {figure}", requests.values())
    with registered(kept, label):
        with way.executor(kept, label) as executor:
            runs = _run_all(requests, kept, label, way, executor)
        experiments = {t: experiment_of(request, runs[t]) for t, request in requests.items()}
        stages = {f"{title}: {s}": o for title, stages in runs.items() for s, o in stages.items()}
        with reading(stages.values()):
            drawn = wanted.draw(experiments, folder)
        summary = summary_text({"figure": figure}, drawn.quantities, stages)
        write_text(folder / "summary.json", summary)
    if not way.quiet:
        _tell(drawn, folder)


def _run_all(
    requests: Mapping[str, Request],
    store: Store,
    label: RunLabel,
    way: Way,
    executor: Executor | None,
) -> dict[str, dict[str, Outcome]]:
    """Outcomes of some runs by title: one after the other in this process, all at once elsewhere."""
    from pipeline.runner import run

    def outcomes(nodes: Mapping[str, Node[Any]]) -> dict[str, Outcome]:
        with watching(quiet=way.quiet, verbose=way.verbose) as listen:
            return run(
                nodes,
                store,
                executor=executor,
                listen=listen,
                label=label,
                recompute_damaged=way.recompute_damaged,
            )

    if executor is not None:
        nodes = {title: request.nodes() for title, request in requests.items()}
        found = outcomes({f"{t}: {s}": node for t in nodes for s, node in nodes[t].items()})
        return {t: {s: found[f"{t}: {s}"] for s in nodes[t]} for t in nodes}
    runs = {}
    for title, request in requests.items():
        if not way.quiet and len(requests) > 1:
            print(f"{title}:")
        runs[title] = outcomes(request.nodes())
    return runs


def _tell(drawn: Drawn, folder: Path) -> None:
    rows = [(name, f"{number(q.value)} {q.unit}") for name, q in drawn.quantities.items()]
    print()
    for line in fitted(rows, max(shutil.get_terminal_size().columns, 60)) if rows else ():
        print(f"  {line}")
    for label, files in (
        ("picture", drawn.pictures),
        ("data", (*drawn.tables, "summary.json")),
    ):
        for file in files:
            print(f"{label:8} {folder / file}")


def _figure(name: str) -> PaperFigure:
    for figure in FIGURES:
        if figure.name == name:
            return figure
    raise registry.unknown("figure", name, [figure.name for figure in FIGURES])
