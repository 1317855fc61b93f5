"""Beats of paced tissue as a table that any spreadsheet opens."""

from __future__ import annotations

from pathlib import Path

from workflows.experiment import Experiment
from workflows.exports.csvfiles import case_columns, write_csv


def write(experiment: Experiment, folder: Path, part: str, file: str) -> None:
    """Write a row per case of one part of a ``Restitution``, by the length of its interval."""
    columns = case_columns(getattr(experiment.load("restitution"), part))
    write_csv(folder / file, list(columns), zip(*columns.values(), strict=True))
