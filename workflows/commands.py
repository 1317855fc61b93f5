"""What the commands about workflows do."""

from __future__ import annotations

import contextlib
import shutil
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workflows.progress import on_terminal, watching
from workflows.registry import ENTRIES
from workflows.request import Request, open_store, output_folder
from workflows.tables import aligned, fitted, number, parameter
from workflows.ways import USUAL, Way
from workflows.workflow import check_limits

if TYPE_CHECKING:
    from pipeline.nodes import Node
    from pipeline.runner import Outcome
    from pipeline.store import Store
    from workflows.workflow import Quantity


def run_workflow(
    workflow: str,
    config: Path | None,
    overrides: Sequence[str],
    out: Path | None,
    store: str | None,
    way: Way = USUAL,
) -> None:
    """Compute all stages, write everything, and say where it is."""
    request = Request.read(workflow, config, overrides)
    folder = out or Path("results") / workflow
    carry_out(request, folder, store, way)


def carry_out(
    request: Request,
    out: Path,
    store: str | None,
    way: Way = USUAL,
) -> None:
    """The same for a request.

    Raises
    ------
    LimitError
        If a quantity exceeds its limit; everything has been written then.
    """
    from workflows.exports.outputs import write_outputs

    nodes = request.nodes()
    kept = open_store(store)
    folder = output_folder(out)
    with _computed(request, nodes, kept, folder, way) as outcomes:
        quantities = write_outputs(request, outcomes, folder)
    if not way.quiet:
        _tell_results(request, quantities, folder)
    check_limits(quantities)


def run_stage(
    stage: str,
    workflow: str,
    config: Path | None,
    overrides: Sequence[str],
    out: Path | None,
    store: str | None,
    way: Way = USUAL,
) -> None:
    """Compute one stage and what it needs, and write the summary of that.

    Raises
    ------
    InputError
        If the output folder holds a whole run, whose summary would be lost.
    """
    from pipeline.errors import InputError
    from workflows.exports.ledger import Ledger
    from workflows.exports.outputs import read_quantities, write_summary

    request = Request.read(workflow, config, overrides)
    nodes = request.nodes(stage)
    kept = open_store(store)
    folder = output_folder(out or Path("results") / workflow / stage)
    ledger = Ledger(folder)
    if ledger.holds_files():
        raise InputError(
            f"the output folder {folder} holds a whole run, and the summary of {stage} alone would "
            "replace its summary.json; choose another folder with --out"
        )
    with _computed(request, nodes, kept, folder, way) as outcomes:
        quantities = {}
        if set(request.measured) <= outcomes.keys():
            quantities = read_quantities(request, outcomes, ledger)
        write_summary(request, outcomes, quantities, folder)
    if not way.quiet:
        ref = outcomes[stage].manifest.ref
        # A remote store would have to copy the data here first.
        place = kept.data(ref) if "://" not in kept.location else kept.where(ref)
        print(f"\nresult   {place}")
        print(f"summary  {folder / 'summary.json'}")


@contextlib.contextmanager
def _computed(
    request: Request, nodes: Mapping[str, Node[Any]], store: Store, folder: Path, way: Way
) -> Iterator[dict[str, Outcome]]:
    """Outcomes of nodes; their run ends well when the block has written what it makes of them."""
    from pipeline.runner import run
    from workflows.labels import label_of, registered

    label = label_of(way.name, folder, request.workflow.name, [request])
    with registered(store, label):
        with (
            way.executor(store, label) as executor,
            watching(quiet=way.quiet, verbose=way.verbose) as listen,
        ):
            outcomes = run(
                nodes,
                store,
                executor=executor,
                listen=listen,
                label=label,
                recompute_damaged=way.recompute_damaged,
                accept_code=way.accept_code,
            )
        yield outcomes


def list_all() -> None:
    """One line for each workflow."""
    for line in aligned([(entry.name, entry.about) for entry in ENTRIES]):
        print(line)


def show_parameters(name: str, config: Path | None, overrides: Sequence[str]) -> None:
    """Every parameter with value, unit, source and description."""
    from pipeline.config import describe

    request = Request.read(name, config, overrides)
    rows = [("PARAMETER", "VALUE", "UNIT", "SOURCE", "MEANING")]
    rows += [
        (p.name, parameter(p.value), p.unit, p.source, p.description)
        for p in describe(request.config)
    ]
    print(request.workflow.title)
    lines = fitted(rows, shutil.get_terminal_size().columns) if on_terminal() else aligned(rows)
    for line in lines:
        print(line)


def _tell_results(request: Request, quantities: dict[str, Quantity], folder: Path) -> None:
    rows = [(name, _told(quantity)) for name, quantity in quantities.items()]
    print()
    for line in aligned(rows, indent="  "):
        print(line)
    exports = request.exports
    pictures = [e.files[0] for e in exports if e.kind == "picture"]
    data = ["summary.json", *(e.files[0] for e in exports if e.kind == "data")]
    width = shutil.get_terminal_size().columns
    print()
    print(f"report    {folder / 'report.html'}")
    for label, files in (("pictures", pictures), ("data", data)):
        paths = ", ".join(str(folder / file) for file in files)
        lines = textwrap.wrap(
            f"{label:10}{paths}",
            max(width, 60),
            subsequent_indent=" " * 10,
            break_long_words=False,
            break_on_hyphens=False,
        )
        print(*lines, sep="\n")


def _told(quantity: Quantity) -> str:
    if quantity.value in (None, []):
        return "-"
    text = f"{number(quantity.value)} {quantity.unit}".rstrip()
    if quantity.limit is None:
        return text
    return (
        f"{text} ({'allowed' if quantity.is_allowed else 'ALLOWED ONLY'} {number(quantity.limit)})"
    )
