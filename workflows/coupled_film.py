"""A film with cells: configuration and plan of the experiments of section 4.3.

geometry -> electrophysiology -> activation -> mechanics -> postprocessing. The electrophysiology
does not depend on the motion, so a mechanical parameter leaves its result alone. Experiments differ in
their stimuli; where settings are equal, they share the results of the stages.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from stages.activation.config import ActivationConfig, TransferConfig
from stages.electrophysiology.config import ElectrophysiologyConfig
from stages.geometry.config import FilmConfig, GeometryStageConfig, MeshConfig
from stages.mechanics.config import MechanicsConfig
from stages.postprocessing.config import PostprocessingConfig
from workflows.conduction import conducting
from workflows.film_checks import (
    acting_off_the_film,
    extent,
    interval,
    places_off_the_film,
    unfit_meshes,
    unusable_layers,
)
from workflows.tables import exact
from workflows.tissue_checks import tip_potential_out_of_reach, unfit_stimuli, unfit_tissue
from workflows.tissue_experiment import TissueExperiment
from workflows.workflow import Export

if TYPE_CHECKING:
    from pipeline.nodes import Node


class CoupledFilmConfig(TissueExperiment):
    """All parameters of the experiment, section by section."""

    geometry: FilmConfig
    electrophysiology: ElectrophysiologyConfig
    activation: ActivationConfig
    mechanics: MechanicsConfig
    postprocessing: PostprocessingConfig

    @model_validator(mode="after")
    def _sections_fit_together(self) -> CoupledFilmConfig:
        for problem in _misfits(self):
            raise PydanticCustomError("misfit", "{problem}", {"problem": problem})
        return self


def _misfits(config: CoupledFilmConfig) -> Iterator[str]:
    """What contradicts across sections, in words."""
    film, cells, shell = config.geometry, config.electrophysiology, config.mechanics
    measured = config.postprocessing
    if cells.duration < shell.duration:
        yield (
            f"electrophysiology.duration = {exact(cells.duration)} ms ends before mechanics.duration = "
            f"{exact(shell.duration)} ms: the film would move without knowing its active stress"
        )
    yield from places_off_the_film(film, measured)
    yield from unusable_layers(film, shell)
    yield from acting_off_the_film(film, shell)
    yield from unfit_meshes(film, {"mechanics": (shell.degree, shell.elements)})
    yield from unfit_stimuli(film, cells.stimuli, cells.duration)
    yield from unfit_tissue(film, cells)
    yield from tip_potential_out_of_reach(cells, measured.tip_potential)
    window = measured.velocity_window
    if window[0] < 0 or window[1] > film.length:
        yield (
            f"postprocessing.velocity_window = {interval(window)} mm reaches outside the film "
            f"{extent(film)}"
        )


def plan(config: CoupledFilmConfig) -> Mapping[str, Node[Any]]:
    """The five stages and what each takes from the others."""
    from stages.activation.stage import activation
    from stages.electrophysiology.stage import electrophysiology
    from stages.geometry.stage import geometry
    from stages.mechanics.stage import mechanics
    from stages.postprocessing.stage import postprocessing

    cells, shell = conducting(config.electrophysiology, config.geometry), config.mechanics
    film = geometry(
        GeometryStageConfig(
            film=config.geometry,
            excitable_mesh=MeshConfig(elements=cells.elements, degree=cells.degree),
            shell_mesh=MeshConfig(elements=shell.elements, degree=shell.degree),
        )
    )
    surface, mid_surface = film.part("excitable_surface"), film.part("mid_surface")
    history = electrophysiology(cells, surface=surface)
    transfer = TransferConfig(
        scale=config.activation.scale,
        transfer=config.activation.transfer_from(cells.degree),
        duration=shell.duration,
        n_steps=shell.n_steps,
        points=shell.points_per_element,
    )
    stress = activation(transfer, history=history, surface=surface, mid_surface=mid_surface)
    deformation = mechanics(
        shell, mid_surface=mid_surface, laminate=film.part("laminate"), stress=stress
    )
    measures = postprocessing(
        config.postprocessing,
        history=history,
        surface=surface,
        mid_surface=mid_surface,
        deformation=deformation,
    )
    return {
        "geometry": film,
        "electrophysiology": history,
        "activation": stress,
        "mechanics": deformation,
        "postprocessing": measures,
    }


ALL_BUT_TRANSFER = ("geometry", "electrophysiology", "mechanics")

MAPS = Export(
    files=("activation_maps.png", "activation_maps.svg"),
    modules=("workflows.figures.activation_maps",),
    stages=("geometry", "electrophysiology"),
    kind="picture",
    caption="Beat by beat, left: activation time with isochrones and the velocity of the front (an arrow "
    "of usual speed is 0.7 of the arrows' spacing long); right: action potential duration to 90 % "
    "repolarisation. Beats are counted at each point, so that beside a block or a core one panel shows "
    "several waves. White: no such beat, or cut short by the next one.",
)
"""What every beat does over the film."""

DATA = (
    Export(
        files=("probes.csv",),
        modules=("workflows.exports.probes",),
        stages=("postprocessing",),
        kind="data",
        caption="Displacement, active stress and potential of each probe over time.",
    ),
    Export(
        files=("beats.csv",),
        modules=("workflows.exports.beats",),
        stages=("postprocessing",),
        kind="data",
        caption="Activation, repolarisation, durations and peaks of every beat at each probe.",
    ),
    Export(
        files=("tips.csv",),
        modules=("workflows.exports.tips",),
        stages=("postprocessing",),
        kind="data",
        caption="Paths of the tips of spiral waves, frame by frame.",
        shown=lambda config: config.postprocessing.tip_potential is not None,
    ),
    Export(
        files=("maps.vtkhdf",),
        modules=("workflows.exports.paraview_maps",),
        stages=("geometry", "electrophysiology"),
        kind="data",
        caption="Activation, repolarisation, durations, peaks and velocity of every beat over the "
        "film, for ParaView 5.12 or newer.",
    ),
    Export(
        files=("film.vtkhdf",),
        modules=("workflows.exports.paraview",),
        stages=ALL_BUT_TRANSFER,
        kind="data",
        caption="The moving film with its fields, for ParaView 5.12 or newer.",
    ),
)
"""Files that every such experiment leaves."""
