"""Everything that a sweep leaves in its output folder."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workflows.exports.files import write_text
from workflows.sweep.results import Column, Results
from workflows.sweep.tables import tidy, write_csv, write_parquet
from workflows.unfinished import remove_unfinished

if TYPE_CHECKING:
    from pipeline.scheduling.outcome import Outcome
    from workflows.request import Request

PICTURE = "cases.png"


def write_results(results: Results, folder: Path) -> None:
    """Write tables, arrays, figure, report and summary of the cases that are done by now."""
    from workflows.sweep.arrays import write_arrays
    from workflows.sweep.page import write_page
    from workflows.sweep.picture import write_picture

    columns = tidy(results)
    write_csv(columns, folder / "cases.csv")
    files = ["summary.json", "cases.csv", "sweep.zarr"]
    if write_parquet(columns, folder / "cases.parquet"):
        files.append("cases.parquet")
    write_arrays(results, folder / "sweep.zarr")
    shown = write_picture(results, folder)
    write_text(folder / "summary.json", json.dumps(summary(results), indent=2) + "\n")
    write_page(results, folder, files, shown)


def write_case(request: Request, outcomes: Mapping[str, Outcome], folder: Path, name: str) -> None:
    """Write what a run of this one case would leave, in a folder of its own."""
    from workflows.exports.outputs import write_outputs

    own = folder / "cases" / name
    own.mkdir(parents=True, exist_ok=True)
    remove_unfinished(own)
    write_outputs(request, outcomes, own)


def summary(results: Results) -> dict[str, Any]:
    """Plain data: what was varied, what came out, what was computed, what failed."""
    design = results.study.design
    return {
        "workflow": results.study.workflow.name,
        "cases": len(design),
        "done": len(results.quantities),
        "parameters": {
            column.name: {"unit": column.unit, **_extent(column)} for column in results.parameters()
        },
        "quantities": {
            column.name if column.place is None else f"{column.name} {column.place}": {
                "unit": column.unit,
                **_extent(column),
            }
            for column in results.measured()
        },
        "stages": {
            name: {
                "computed": stage.computed,
                "hits": stage.found,
                "seconds": round(stage.seconds, 3),
            }
            for name, stage in results.stages.items()
        },
        "warnings": [
            {"warning": text, "cases": [design.name(i) for i in cases]}
            for text, cases in results.kinds_of_warnings()
        ],
        "failed": [
            {"case": design.name(i), "parameters": design[i].values, "error": results.errors[i]}
            for i in sorted(results.errors)
        ],
    }


def _extent(column: Column) -> dict[str, Any]:
    """Smallest and largest number, or all the different values that are no numbers."""
    cells = [cell for cell in column.cells if cell is not None]
    if column.is_numeric:
        numbers = [float(cell) for cell in cells]
        return {"min": min(numbers, default=None), "max": max(numbers, default=None)}
    return {"values": list(dict.fromkeys(cells))}
