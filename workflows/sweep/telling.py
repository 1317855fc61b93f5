"""What a sweep prints: before it begins, and when it has ended."""

from __future__ import annotations

from pathlib import Path

from workflows.progress import duration, size
from workflows.sweep.forecast import Forecast
from workflows.sweep.results import Results
from workflows.sweep.study import Study
from workflows.tables import aligned


def tell_forecast(study: Study, forecast: Forecast) -> None:
    """Print what would be computed, stage by stage."""
    print(heading(study))
    rows = [("STAGE", "DIFFERENT", "IN THE STORE", "TO COMPUTE", "ABOUT")]
    for stage in forecast.stages.values():
        cost = "unknown" if stage.to_compute else "-"
        if stage.to_compute and stage.seconds is not None and stage.size is not None:
            seconds = duration(stage.to_compute * stage.seconds)
            cost = f"{seconds}, {size(stage.to_compute * stage.size)}"
        missing = f"at most {stage.to_compute}" if stage.open else str(stage.to_compute)
        rows.append((stage.name, str(stage.different), str(stage.hits), missing, cost))
    print(*aligned(rows), sep="\n")
    left = [stage for stage in forecast.stages.values() if stage.to_compute]
    known = [stage for stage in left if stage.seconds is not None]
    if not left:
        print("nothing is left to compute")
    elif known:
        total = sum(stage.to_compute * (stage.seconds or 0.0) for stage in known)
        but = "" if len(known) == len(left) else ", and what is unknown"
        most = "at most " if any(stage.open for stage in known) else ""
        print(f"{most}about {duration(total)} of computing, after similar runs{but}")
    if any(stage.open for stage in forecast.stages.values()):
        print(
            "at most: the stages before them must run first, and where these give the same, one "
            "computation serves many cases"
        )


def heading(study: Study) -> str:
    """Cases and what is varied.

    Counts of blocks are joined as they are combined: ``a (3) x b, c (4 together)``.
    """
    blocks = []
    for block in study.design.blocks:
        names = ", ".join(field.path for field in block.fields)
        together = " together" if len(block.fields) > 1 else ""
        blocks.append(f"{names} ({len(block.rows)}{together})")
    count = len(study.design)
    cases = "1 case" if count == 1 else f"{count} cases"
    return f"{cases} of {study.workflow.name}: {' x '.join(blocks)}"


def tell_results(results: Results, folder: Path) -> None:
    """Print what was done, and where it is."""
    print()
    print(f"{len(results.quantities)} of {len(results.study.design)} cases are done")
    rows = [
        (name, f"{stage.computed} computed", f"{stage.found} in the store")
        for name, stage in results.stages.items()
    ]
    if rows:
        print(*aligned(rows, indent="  "), sep="\n")
    print()
    print(f"report    {folder / 'report.html'}")
    print(f"pictures  {folder / 'cases.png'}")
    tables = ["cases.csv", "cases.parquet", "sweep.zarr", "summary.json"]
    there = [str(folder / name) for name in tables if (folder / name).exists()]
    print(f"data      {', '.join(there)}")
