"""Beats of paced tissue as a table that any spreadsheet opens."""

from __future__ import annotations

from pathlib import Path

from stages.paced_artefacts import PacedBeats
from workflows.experiment import Experiment
from workflows.exports.csvfiles import write_csv

COLUMNS = {
    "interval": "ms",
    "activation_time": "ms",
    "diastolic_interval": "ms",
    "apd50": "ms",
    "apd90": "ms",
    "peak_active_stress": "kPa",
    "conduction_velocity": "mm/ms",
}


def write(experiment: Experiment, folder: Path, part: str, file: str) -> None:
    """Write a row per case of one part of a ``Restitution``, by the length of its interval."""
    beats: PacedBeats = getattr(experiment.load("restitution"), part)
    columns = [getattr(beats, name) for name in COLUMNS]
    headings = [f"{name} [{unit}]" for name, unit in COLUMNS.items()]
    write_csv(folder / file, headings, zip(*columns, strict=True))
