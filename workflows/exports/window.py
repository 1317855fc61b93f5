"""Outcomes of a vulnerable-window sweep as a table that any spreadsheet opens."""

from __future__ import annotations

from pathlib import Path

from stages.paced_artefacts import VulnerableWindow
from workflows.experiment import Experiment
from workflows.exports.csvfiles import case_columns, write_csv


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``vulnerable-window.csv``: a row per time of S3."""
    measured: VulnerableWindow = experiment.load("vulnerable_window")
    columns = case_columns(measured)
    for name, counts in zip(measured.probe_names, measured.activations.T, strict=True):
        columns[f"{name}.activations"] = counts
    rows = zip(*columns.values(), strict=True)
    write_csv(folder / "vulnerable-window.csv", list(columns), rows)
