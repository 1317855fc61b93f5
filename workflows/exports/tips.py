"""Paths of the tips of spiral waves as a table: one row per tip and frame."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from workflows.experiment import Experiment
from workflows.exports.csvfiles import write_csv

HEADINGS = ("time [ms]", "tip", "x [mm]", "y [mm]", "z [mm]", "chirality", "heading [degree]")


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``tips.csv``."""
    tips = experiment.measures.tips
    columns = (tips.time, tips.number, tips.position, tips.chirality, tips.heading)
    write_csv(folder / "tips.csv", HEADINGS, np.column_stack(columns))
