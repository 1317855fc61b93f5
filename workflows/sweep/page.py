"""One page about a sweep that needs no other file."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pipeline.config import describe
from workflows.exports.files import write_text
from workflows.pages import page
from workflows.sweep.design import Design
from workflows.sweep.results import Column, Results
from workflows.tables import parameter
from workflows.version import version

ROWS = 500
"""Cases that the page lists at most."""
NAMES = 50
"""Cases that it names for one warning at most."""
COLUMNS = 8
"""Quantities in its table at most."""

DATA = {
    "summary.json": "What was varied, the range of each quantity, what was computed, what failed.",
    "cases.csv": "A row per case, a column per parameter and quantity, with all digits.",
    "cases.parquet": "The same table as Parquet.",
    "sweep.zarr": "Quantities as arrays over the parameters: xarray.open_zarr opens it.",
}


def write_page(results: Results, folder: Path, files: Sequence[str], shown: str) -> None:
    """Write ``report.html`` with the picture of the folder inside.

    Parameters
    ----------
    results
        What came of the cases.
    folder
        Output folder.
    files
        Data files beside the page.
    shown
        What the picture shows.
    """
    study = results.study
    design = study.design
    parameters, measured = results.parameters(), _listed(results.scalars())
    picture = base64.b64encode((folder / "cases.png").read_bytes()).decode()
    text = page(
        "sweep.html",
        workflow=study.workflow,
        version=version(),
        counts={
            "all": len(design),
            "done": len(results.quantities),
            "failed": len(results.errors),
        },
        parameters=parameters,
        varied=[_varied(column) for column in parameters],
        measured=measured,
        ranges=[_range(column) for column in results.scalars()],
        cases=[_case(results, i, parameters, measured) for i in range(min(len(design), ROWS))],
        failures=[
            {"case": str(design[i]), "error": results.errors[i]} for i in sorted(results.errors)
        ],
        warnings=[
            {"text": text, "cases": _named(design, cases), "count": len(cases)}
            for text, cases in results.kinds_of_warnings()
        ],
        stages=results.stages,
        picture=f"data:image/png;base64,{picture}",
        shown=shown,
        data=[(name, DATA[name]) for name in files],
        common=[
            row
            for row in describe(study.variants.common)
            if row.name not in {column.name for column in parameters}
        ],
    )
    write_text(folder / "report.html", text)


def _named(design: Design, cases: Sequence[int]) -> str:
    """Names of cases, the first ones if there are many."""
    more = ", ..." if len(cases) > NAMES else ""
    return ", ".join(map(design.name, cases[:NAMES])) + more


def _listed(columns: Sequence[Column]) -> list[Column]:
    """Those that change come first."""
    changing = [column for column in columns if len(set(map(repr, column.cells))) > 1]
    return [*changing, *(column for column in columns if column not in changing)][:COLUMNS]


def _case(
    results: Results, i: int, parameters: Sequence[Column], measured: Sequence[Column]
) -> dict[str, Any]:
    return {
        "name": results.study.design.name(i),
        "status": "failed" if i in results.errors else "",
        "parameters": [column.cells[i] for column in parameters],
        "quantities": [column.cells[i] for column in measured],
    }


def _varied(column: Column) -> dict[str, Any]:
    values = list(dict.fromkeys(column.cells))
    if len(values) <= 12:
        words = ", ".join(parameter(value) for value in values)
    else:
        words = f"{len(values)} values"
        if column.is_numeric:
            words += f" from {parameter(min(column.numbers))} to {parameter(max(column.numbers))}"
    return {"name": column.name, "unit": column.unit, "meaning": column.meaning, "values": words}


def _range(column: Column) -> dict[str, Any]:
    numbers = [one for one in column.numbers if one == one] if column.is_numeric else []
    return {
        "name": column.name if column.place is None else f"{column.name} {column.place}",
        "unit": column.unit,
        "meaning": column.meaning,
        "low": min(numbers, default=None),
        "high": max(numbers, default=None),
    }
