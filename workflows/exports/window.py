"""Outcomes of a vulnerable-window sweep as a table that any spreadsheet opens."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from stages.paced_artefacts import VulnerableWindow
from workflows.experiment import Experiment
from workflows.exports.csvfiles import write_csv

COLUMNS = {
    "time": "time [ms]",
    "outcome": "outcome",
    "activated_share": "activated_share",
    "reactivated_share": "reactivated_share",
    "life_time": "life_time [ms]",
}


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``vulnerable-window.csv``: a row per time of S3."""
    measured: VulnerableWindow = experiment.load("vulnerable_window")
    columns = [getattr(measured, name) for name in COLUMNS]
    headings = [*COLUMNS.values(), *(f"{name}.activations" for name in measured.probe_names)]
    rows = np.column_stack([*columns, measured.activations])
    write_csv(folder / "vulnerable-window.csv", headings, rows)
