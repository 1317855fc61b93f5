"""Planar waves (sec. 4.3, Figs 8-9): electrical stimulation at the clamped edge makes a film beat."""

from __future__ import annotations

from workflows.coupled_film import ALL_BUT_TRANSFER, DATA, MAPS, CoupledFilmConfig, plan
from workflows.film_quantities import quantities
from workflows.workflow import Export, Workflow

WORKFLOW = Workflow(
    name="planar-waves",
    title="Planar waves: electrical stimulation at the clamped edge makes a film beat",
    modules=(__name__,),
    config=CoupledFilmConfig,
    plan=plan,
    quantities=lambda experiment: quantities(experiment.measures),
    measured=("postprocessing",),
    exports=(
        Export(
            files=("fig8.png", "fig8.svg"),
            modules=("workflows.figures.snapshots",),
            stages=ALL_BUT_TRANSFER,
            kind="picture",
            caption="The deformed film at six times, coloured by the transmembrane potential "
            "(layout of Fig. 8). A thick edge is held; the dashed outline is the film at rest.",
            arguments=("fig8",),
        ),
        Export(
            files=("fig9.png", "fig9.svg"),
            modules=("workflows.figures.traces",),
            stages=("postprocessing",),
            kind="picture",
            caption="(a) Active stress and (b) size of the displacement over time, at the centre "
            "and at the tip of the film (layout of Fig. 9).",
            arguments=("fig9",),
        ),
        MAPS,
        *DATA,
    ),
)
