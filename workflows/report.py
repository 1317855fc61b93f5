"""One page about a run that needs no other file: what was done, what came out, how to cite it."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from pipeline.config import describe
from pipeline.lineage import Lineage, lineage
from workflows.pages import page
from workflows.progress import duration, size
from workflows.provenance.picture import picture
from workflows.version import version
from workflows.workflow import Quantity

if TYPE_CHECKING:
    from pipeline.runner import Outcome
    from workflows.request import Request


def render(
    request: Request,
    outcomes: Mapping[str, Outcome],
    quantities: Mapping[str, Quantity],
    folder: Path,
) -> str:
    """HTML text with the pictures of the output folder inside."""
    workflow = request.workflow
    return page(
        "report.html",
        workflow=workflow,
        version=version(),
        quantities=quantities,
        pictures=[
            {"caption": export.caption, "source": _inlined(folder / export.files[0])}
            for export in request.exports
            if export.kind == "picture"
        ],
        remarks=workflow.remarks(quantities),
        data=[export for export in request.exports if export.kind == "data"],
        stages=[_stage(name, outcome) for name, outcome in outcomes.items()],
        sections=_sections(request),
        lineage=Markup(picture(_lineage(outcomes))),  # its texts are escaped
    )


def _stage(name: str, outcome: Outcome) -> dict[str, Any]:
    return {
        "name": name,
        "key": outcome.key,
        "origin": "from the store" if outcome.hit else "computed",
        "seconds": duration(outcome.seconds),
        "size": size(outcome.manifest.size),
        "warnings": outcome.manifest.warnings,
    }


def _lineage(outcomes: Mapping[str, Outcome]) -> Lineage:
    """The results of the run, and what they were made from."""
    store = next(iter(outcomes.values())).store
    return lineage(store, [outcome.manifest.ref for outcome in outcomes.values()])


def _sections(request: Request) -> dict[str, list[Any]]:
    """Parameters by section, in the order of the configuration."""
    sections: dict[str, list[Any]] = {}
    for row in describe(request.config):
        sections.setdefault(row.name.partition(".")[0], []).append(row)
    return sections


def _inlined(picture: Path) -> str:
    return "data:image/png;base64," + base64.b64encode(picture.read_bytes()).decode()
