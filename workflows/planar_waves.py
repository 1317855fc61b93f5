"""Planar waves (sec. 4.3, Figs 8-9): electrical stimulation at the clamped edge makes a film beat.

geometry -> electrophysiology -> activation -> mechanics -> postprocessing. The electrophysiology
does not depend on the motion, so a mechanical parameter leaves its result alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from stages.activation.config import ActivationConfig, TransferConfig
from stages.configuration import Section
from stages.electrophysiology.config import ElectrophysiologyConfig, PatchCurrent
from stages.geometry.config import FilmConfig, GeometryStageConfig, MeshConfig
from stages.mechanics.config import MechanicsConfig
from stages.postprocessing.config import PostprocessingConfig
from workflows.film_checks import (
    acting_off_the_film,
    extent,
    interval,
    places_off_the_film,
    unusable_layers,
)
from workflows.tables import exact
from workflows.workflow import Export, Quantity, Workflow

if TYPE_CHECKING:
    from pipeline.nodes import Node
    from stages.artefacts import Measures
    from stages.numerics.bsplines import Array


class PlanarWavesConfig(Section):
    """All parameters of the experiment, section by section."""

    geometry: FilmConfig
    electrophysiology: ElectrophysiologyConfig
    activation: ActivationConfig
    mechanics: MechanicsConfig
    postprocessing: PostprocessingConfig

    @model_validator(mode="after")
    def _sections_fit_together(self) -> PlanarWavesConfig:
        for problem in _misfits(self):
            raise PydanticCustomError("misfit", "{problem}", {"problem": problem})
        return self


def _misfits(config: PlanarWavesConfig) -> Iterator[str]:
    """What contradicts across sections, in words."""
    film, measured = config.geometry, config.postprocessing
    covered, needed = config.electrophysiology.duration, config.mechanics.duration
    if covered < needed:
        yield (
            f"electrophysiology.duration = {exact(covered)} ms ends before mechanics.duration = "
            f"{exact(needed)} ms: the film would move without knowing its active stress"
        )
    yield from places_off_the_film(film, measured)
    yield from unusable_layers(film, config.mechanics)
    yield from acting_off_the_film(film, config.mechanics)
    for stimulus in config.electrophysiology.stimuli:
        if isinstance(stimulus, PatchCurrent) and not (
            stimulus.x[0] >= 0
            and stimulus.x[1] <= film.length
            and stimulus.y[0] >= 0
            and stimulus.y[1] <= film.width
        ):
            yield (
                "electrophysiology.stimuli: the stimulated rectangle "
                f"{interval(stimulus.x)} x {interval(stimulus.y)} mm reaches outside the film "
                f"{extent(film)}"
            )
    window = measured.velocity_window
    if window[0] < 0 or window[1] > film.length:
        yield (
            f"postprocessing.velocity_window = {interval(window)} mm reaches outside the film "
            f"{extent(film)}"
        )


def plan(config: PlanarWavesConfig) -> Mapping[str, Node[Any]]:
    """The five stages and what each takes from the others."""
    from stages.activation.stage import activation
    from stages.electrophysiology.stage import electrophysiology
    from stages.geometry.stage import geometry
    from stages.mechanics.stage import mechanics
    from stages.postprocessing.stage import postprocessing

    cells, shell = config.electrophysiology, config.mechanics
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


def quantities(measures: Measures) -> dict[str, Quantity]:
    """The numbers that an experimenter would write down."""
    speeds = _listed(measures.conduction_velocity)
    found = {
        "conduction_velocity": Quantity(
            speeds[0] if speeds else None,
            "mm/ms",
            "speed of the first electrical front along the middle of the film",
        ),
        "max_curvature": Quantity(
            float(measures.curvature.max()),
            "1/mm",
            "largest curvature, from the length of the film's projection as in experiments",
        ),
    }
    for i, name in enumerate(measures.probe_names):
        found |= _probe_quantities(measures, i, name)
    return found


def _probe_quantities(measures: Measures, i: int, name: str) -> dict[str, Quantity]:
    beats = [
        (time, peak)
        for time, peak in zip(
            _listed(measures.activation_times[i]),
            _listed(measures.peak_active_stress[i]),
            strict=True,
        )
        if time is not None
    ]
    reached = [float(measures.active_stress[:, i].max()), *(peak for _, peak in beats if peak)]
    motion = (measures.displacement[:, i] ** 2).sum(axis=-1) ** 0.5
    return {
        f"{name}.activation_times": Quantity(
            [time for time, _ in beats],
            "ms",
            f"when the electrical front arrives at {name}, beat by beat",
        ),
        f"{name}.peak_active_stress": Quantity(
            max(reached), "kPa", f"how hard the muscle pulls at {name} at most"
        ),
        f"{name}.peak_active_stresses": Quantity(
            [peak for _, peak in beats], "kPa", f"the same for each beat at {name}"
        ),
        f"{name}.max_displacement": Quantity(
            float(motion.max()), "mm", f"how far {name} moves from its place at rest at most"
        ),
    }


def _listed(values: Array) -> list[float | None]:
    """Plain numbers, ``None`` for NaN."""
    return [float(v) if math.isfinite(v) else None for v in values]


ALL_BUT_TRANSFER = ("geometry", "electrophysiology", "mechanics")

WORKFLOW = Workflow(
    name="planar-waves",
    title="Planar waves: electrical stimulation at the clamped edge makes a film beat",
    modules=(__name__,),
    config=PlanarWavesConfig,
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
        ),
        Export(
            files=("fig9.png", "fig9.svg"),
            modules=("workflows.figures.traces",),
            stages=("postprocessing",),
            kind="picture",
            caption="(a) Active stress and (b) size of the displacement over time, at the centre "
            "and at the tip of the film (layout of Fig. 9).",
        ),
        Export(
            files=("probes.csv",),
            modules=("workflows.exports.probes",),
            stages=("postprocessing",),
            kind="data",
            caption="Displacement, active stress and potential of each probe over time.",
        ),
        Export(
            files=("film.vtkhdf",),
            modules=("workflows.exports.paraview",),
            stages=ALL_BUT_TRANSFER,
            kind="data",
            caption="The moving film with its fields, for ParaView 5.12 or newer.",
        ),
    ),
)
