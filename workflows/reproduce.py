"""Figures of the paper from runs with the paper's parameters."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from workflows import registry
from workflows.figures.catalogue import FIGURES, PaperFigure
from workflows.progress import watching
from workflows.request import Request, open_store, output_folder
from workflows.tables import aligned


def list_figures() -> None:
    """One line for each figure."""
    for line in aligned([(figure.name, figure.about) for figure in FIGURES]):
        print(line)


def draw(
    name: str,
    config: Path | None,
    overrides: Sequence[str],
    out: Path,
    store: Path | None,
    *,
    quiet: bool = False,
    verbose: bool = False,
) -> None:
    """Run what a figure needs, then draw it; runs that are in the store are not repeated."""
    from pipeline.runner import run
    from workflows.exports.outputs import experiment_of

    figure = _figure(name)
    requests = {
        label: Request.read(figure.workflow, config, [*overrides, *own])
        for label, own in figure.runs.items()
    }
    kept = open_store(store)
    folder = output_folder(out)
    experiments = {}
    for label, request in requests.items():
        if not quiet and len(requests) > 1:
            print(f"{label}:")
        with watching(quiet=quiet, verbose=verbose) as listen:
            outcomes = run(request.nodes(), kept, listen=listen)
        experiments[label] = experiment_of(request, outcomes)
    files = figure.draw(experiments, folder)
    if not quiet:
        print("\n".join(["", *(f"picture  {folder / file}" for file in files)]))


def _figure(name: str) -> PaperFigure:
    for figure in FIGURES:
        if figure.name == name:
            return figure
    raise registry.unknown("figure", name, [figure.name for figure in FIGURES])
