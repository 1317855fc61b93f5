"""Figure of a study."""

from __future__ import annotations

from pathlib import Path

from workflows.experiment import Experiment
from workflows.figures.style import drawing, save
from workflows.verification.catalogue import find


def write(experiment: Experiment, folder: Path, name: str) -> None:
    """Write ``name.png`` and ``name.svg``."""
    study = find(name)
    with drawing(*study.size) as figure:
        study.draw(experiment.load(name), figure)
        figure.tight_layout()
        save(figure, folder, name)
