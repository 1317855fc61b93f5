"""Beats of the probes as a table that any spreadsheet opens: one row per probe and beat."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from stages.artefacts import Measures
from workflows.experiment import Experiment
from workflows.exports.csvfiles import write_csv

HEADINGS = (
    "probe",
    "beat",
    "activation [ms]",
    "repolarisation [ms]",
    "APD50 [ms]",
    "APD90 [ms]",
    "diastolic interval [ms]",
    "peak potential [mV]",
    "peak active stress [kPa]",
)


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``beats.csv``."""
    write_csv(folder / "beats.csv", HEADINGS, rows(experiment.measures))


def rows(measures: Measures) -> Iterator[tuple[str | float, ...]]:
    """Beats in the order of probes and of time.

    The diastolic interval is the time from the repolarisation of the beat before to the activation.
    """
    fields = (
        measures.activation_times,
        measures.repolarisation_times,
        measures.apd50,
        measures.apd90,
        measures.peak_potential,
        measures.peak_active_stress,
    )
    for name, *table in zip(measures.probe_names, *fields, strict=True):
        beats = np.column_stack(table)
        beats = beats[np.isfinite(beats[:, 0])]
        recovered = np.nan
        for number, (start, end, half, full, peak, stress) in enumerate(beats, start=1):
            yield name, float(number), start, end, half, full, start - recovered, peak, stress
            recovered = end
