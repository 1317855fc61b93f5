"""Tables as files that any spreadsheet opens."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from pathlib import Path

from workflows.exports.files import write_text


def write_csv(
    path: Path, headings: Sequence[str], rows: Iterable[Iterable[float]], digits: int = 10
) -> None:
    """Write numbers below headings, with so many significant digits."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(headings)
    for row in rows:
        writer.writerow([f"{value:.{digits}g}" for value in row])
    write_text(path, text.getvalue())
