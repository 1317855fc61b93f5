"""Figures of the paper that can be drawn, and the runs that each of them needs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from workflows.experiment import Experiment


@dataclass(frozen=True)
class PaperFigure:
    """A figure of the paper.

    Attributes
    ----------
    name
        Name on the command line.
    about
        What it shows, in one line.
    workflow
        Workflow that is run.
    runs
        Label and parameter overrides of each run.
    draw
        Draws from the experiments by label into a folder; gives the file names.
    """

    name: str
    about: str
    workflow: str
    runs: dict[str, tuple[str, ...]]
    draw: Callable[[dict[str, Experiment], Path], Sequence[str]]


def _fig8(experiments: dict[str, Experiment], folder: Path) -> Sequence[str]:
    from workflows.figures import snapshots

    (experiment,) = experiments.values()
    snapshots.write(experiment, folder)
    return "fig8.png", "fig8.svg"


def _fig9(experiments: dict[str, Experiment], folder: Path) -> Sequence[str]:
    from workflows.figures import traces

    traces.draw({label: one.measures for label, one in experiments.items()}, folder)
    return "fig9.png", "fig9.svg"


BOTH_WAVES = ('electrophysiology.stimuli=["S1", "S2"]',)
FIRST_WAVE_ALONE = ('electrophysiology.stimuli=["S1"]',)

FIGURES = (
    PaperFigure(
        "fig8",
        "the film at six times during two planar waves, coloured by the potential",
        "planar-waves",
        {"S1 and S2": BOTH_WAVES},
        _fig8,
    ),
    PaperFigure(
        "fig9",
        "active stress and displacement at the centre and the tip, two waves and the first alone",
        "planar-waves",
        {"S1 and S2": BOTH_WAVES, "S1 alone": FIRST_WAVE_ALONE},
        _fig9,
    ),
)
