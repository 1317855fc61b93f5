"""Figures that can be drawn by name, and the runs that each of them needs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from workflows.figures import parametric
from workflows.figures.parametric import Run

if TYPE_CHECKING:
    from workflows.experiment import Experiment
    from workflows.workflow import Quantity

Runs: TypeAlias = Mapping[str, "Experiment"]


@dataclass(frozen=True)
class Drawn:
    """What drawing a figure has left in the folder: files, and the numbers that it shows."""

    pictures: tuple[str, ...]
    tables: tuple[str, ...]
    quantities: Mapping[str, Quantity]


@dataclass(frozen=True)
class PaperFigure:
    """A figure of the paper, or one that goes with it.

    Attributes
    ----------
    name
        Name on the command line.
    about
        What it shows, in one line.
    runs
        Runs by label; they may be of several workflows.
    draw
        Draws from the experiments by label into a folder.
    """

    name: str
    about: str
    runs: Mapping[str, Run]
    draw: Callable[[Runs, Path], Drawn]


def _fig3(runs: Runs, folder: Path) -> Drawn:
    from workflows.figures import quasi_static

    return _drawn("fig3", quasi_static.draw_stresses(runs, folder, "fig3"))


def _fig4(runs: Runs, folder: Path) -> Drawn:
    from workflows.figures import quasi_static

    return _drawn("fig4", quasi_static.draw_shapes(runs, folder, "fig4"))


def _fig5(runs: Runs, folder: Path) -> Drawn:
    from workflows.figures import quasi_static

    return _drawn("fig5", quasi_static.draw_thicknesses(runs, folder, "fig5"))


def _fig6(runs: Runs, folder: Path) -> Drawn:
    from workflows.figures import dynamic

    return _drawn("fig6", dynamic.draw_tips(runs, folder, "fig6"))


def _fig7(runs: Runs, folder: Path) -> Drawn:
    from workflows.figures import dynamic

    return _drawn("fig7", dynamic.draw_curvatures(runs, folder, "fig7"))


def _snapshots(name: str, runs: Runs, folder: Path) -> Drawn:
    from workflows.figures import snapshots

    (experiment,) = runs.values()
    snapshots.write(experiment, folder, name)
    return Drawn((f"{name}.png", f"{name}.svg"), (), {})


def _traces(name: str, runs: Runs, folder: Path) -> Drawn:
    from workflows.figures import traces

    traces.draw({label: one.measures for label, one in runs.items()}, folder, name)
    return Drawn((f"{name}.png", f"{name}.svg"), (), {})


def _stoney_bias(runs: Runs, folder: Path) -> Drawn:
    from workflows.figures import stoney_bias

    return _drawn("stoney-bias", stoney_bias.draw(runs, folder, "stoney-bias"))


def _drawn(name: str, quantities: Mapping[str, Quantity]) -> Drawn:
    return Drawn((f"{name}.png", f"{name}.svg"), (f"{name}.csv",), quantities)


BOTH_WAVES = Run("planar-waves", ('electrophysiology.stimuli=["S1", "S2"]',))
FIRST_WAVE_ALONE = Run("planar-waves", ('electrophysiology.stimuli=["S1"]',))
SPIRAL = Run("spiral-wave", ('electrophysiology.stimuli=["S1", "S3"]',))
SPIRAL_WITHOUT_S3 = Run("spiral-wave", ('electrophysiology.stimuli=["S1"]',))

FIGURES = (
    PaperFigure(
        "fig3",
        "curvature of the curled film over the peak stress",
        parametric.stresses(),
        _fig3,
    ),
    PaperFigure(
        "fig4",
        "shapes of the curled film at six peak stresses, coloured by the displacement",
        parametric.shapes(),
        _fig4,
    ),
    PaperFigure(
        "fig5",
        "curvature of the curled film over the thickness of the substrate, with modified Stoney",
        parametric.thicknesses(),
        _fig5,
    ),
    PaperFigure(
        "fig6",
        "displacement of the tip over time, dynamic and quasi-static",
        parametric.tips(),
        _fig6,
    ),
    PaperFigure(
        "fig7",
        "largest curvature over the peak stress, dynamic and quasi-static",
        parametric.twitches(),
        _fig7,
    ),
    PaperFigure(
        "fig8",
        "the film at six times during two planar waves, coloured by the potential",
        {"S1 and S2": BOTH_WAVES},
        partial(_snapshots, "fig8"),
    ),
    PaperFigure(
        "fig9",
        "active stress and displacement at the centre and the tip, two waves and the first alone",
        {"S1 and S2": BOTH_WAVES, "S1 alone": FIRST_WAVE_ALONE},
        partial(_traces, "fig9"),
    ),
    PaperFigure(
        "fig10",
        "the film at eight times of a spiral wave, coloured by the potential",
        {"S1 and S3": SPIRAL},
        partial(_snapshots, "fig10"),
    ),
    PaperFigure(
        "fig11",
        "active stress and displacement at the centre and the corner, spiral and first wave alone",
        {"S1 and S3": SPIRAL, "S1 alone": SPIRAL_WITHOUT_S3},
        partial(_traces, "fig11"),
    ),
    PaperFigure(
        "stoney-bias",
        "stress that a narrow-strip formula reads off films of any width, over the true one",
        parametric.widths(),
        _stoney_bias,
    ),
)
