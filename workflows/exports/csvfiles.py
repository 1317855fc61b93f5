"""Tables as files that any spreadsheet opens."""

from __future__ import annotations

import csv
import dataclasses
import io
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from stages.numerics.bsplines import Array
from stages.paced_artefacts import PacedBeats, VulnerableWindow
from workflows.exports.files import write_text
from workflows.workflow import Quantity


def write_csv(
    path: Path, headings: Sequence[str], rows: Iterable[Iterable[float | str]], digits: int = 10
) -> None:
    """Write numbers (with so many significant digits) and words below headings."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(headings)
    for row in rows:
        writer.writerow([v if isinstance(v, str) else f"{v:.{digits}g}" for v in row])
    write_text(path, text.getvalue())


def write_columns(path: Path, quantities: Mapping[str, Quantity]) -> None:
    """Write quantities that are lists of equal length, a column each."""
    headings, columns = [], []
    for name, quantity in quantities.items():
        assert isinstance(quantity.value, list)
        headings.append(_heading(name, quantity.unit))
        columns.append([math.nan if value is None else value for value in quantity.value])
    write_csv(path, headings, zip(*columns, strict=True))


def case_columns(record: PacedBeats | VulnerableWindow) -> dict[str, Array]:
    """Fields with one value per case, shape ``(case,)``, by their headings."""
    return {
        _heading(field.name, field.metadata["unit"]): getattr(record, field.name)
        for field in dataclasses.fields(record)
        if field.metadata.get("axes") == ("case",)
    }


def _heading(name: str, unit: str) -> str:
    return name if unit in ("", "1") else f"{name} [{unit}]"
