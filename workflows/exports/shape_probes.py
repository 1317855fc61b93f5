"""Probe series of a film without cells, as a table that any spreadsheet opens."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from workflows.experiment import Experiment
from workflows.exports.csvfiles import write_csv
from workflows.exports.probes import probe_columns


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``probes.csv``: one row per frame, five columns per probe.

    Along a path, frames have a number and a load factor instead of a time.
    """
    shape = experiment.shape
    frames, places = ["time [ms]"], [shape.time]
    if shape.along_path:
        frames = ["point", "load_factor"]
        places = [np.arange(float(shape.time.size)), shape.load_factor]
    heading, columns = probe_columns(shape, "fibre_stretch", shape.fibre_stretch)
    table = np.column_stack([*places, *columns])
    write_csv(folder / "probes.csv", [*frames, *heading], table)
