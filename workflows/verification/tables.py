"""Table of a study as a file that any spreadsheet opens."""

from __future__ import annotations

from pathlib import Path

from workflows.experiment import Experiment
from workflows.exports.csvfiles import write_csv


def write(experiment: Experiment, folder: Path, name: str) -> None:
    """Write ``name.csv``, with all digits: small differences are what a study is about."""
    table = experiment.load(name)
    headings = [
        f"{column} [{unit}]" if unit else column
        for column, unit in zip(table.columns, table.units, strict=True)
    ]
    write_csv(folder / f"{name}.csv", headings, table.values, digits=17)
