"""Spiral wave (sec. 4.3, Figs 10-11): a wave across the tail of another one curls up and keeps turning."""

from __future__ import annotations

from typing import TYPE_CHECKING

from workflows.coupled_film import ALL_BUT_TRANSFER, DATA, MAPS, CoupledFilmConfig, plan
from workflows.film_quantities import quantities
from workflows.rotation import spiral_quantities
from workflows.workflow import Export, Quantity, Workflow

if TYPE_CHECKING:
    from workflows.experiment import Experiment


def _quantities(experiment: Experiment) -> dict[str, Quantity]:
    """Those of any film with cells, and the turns of the spiral."""
    measures = experiment.measures
    return quantities(measures) | spiral_quantities(experiment.config, measures)


WORKFLOW = Workflow(
    name="spiral-wave",
    title="Spiral wave: a wave across the tail of another one keeps turning and makes a film beat",
    modules=(__name__,),
    config=CoupledFilmConfig,
    plan=plan,
    quantities=_quantities,
    measured=("postprocessing",),
    exports=(
        Export(
            files=("fig10.png", "fig10.svg"),
            modules=("workflows.figures.snapshots",),
            stages=ALL_BUT_TRANSFER,
            kind="picture",
            caption="The deformed film at eight times, coloured by the transmembrane potential "
            "(layout of Fig. 10). A thick edge is held; the dashed outline is the film at rest.",
            arguments=("fig10",),
        ),
        Export(
            files=("fig11.png", "fig11.svg"),
            modules=("workflows.figures.traces",),
            stages=("postprocessing",),
            kind="picture",
            caption="(a) Active stress and (b) size of the displacement over time, at the centre "
            "and at the corner of the film (layout of Fig. 11).",
            arguments=("fig11",),
        ),
        Export(
            files=("tips.png", "tips.svg"),
            modules=("workflows.figures.tips",),
            stages=("geometry", "postprocessing"),
            kind="picture",
            caption="(a) Path of the spiral's tip, where the front ends, coloured by time; a dot where it was "
            "seen last. A short path beside S3's edge is the other end of its front. (b) How long each turn takes: of the tip, and as the probes see it.",
            sections=("electrophysiology",),
            shown=lambda config: config.postprocessing.tip_potential is not None,
        ),
        MAPS,
        *DATA,
    ),
)
