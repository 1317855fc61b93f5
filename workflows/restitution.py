"""Restitution: beats after one early or late stimulus S2, by how long the tissue has rested."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from stages.electrophysiology.config import ElectrophysiologyConfig
from stages.electrophysiology.protocols.config import RestitutionConfig, RestitutionProtocol
from stages.geometry.config import FilmConfig
from workflows.conduction import conducting
from workflows.film_checks import extent, interval, stimulus_off_the_film
from workflows.film_quantities import listed
from workflows.surfaces import excitable_film
from workflows.tissue_checks import threshold_out_of_reach, unfit_tissue
from workflows.tissue_experiment import TissueExperiment
from workflows.workflow import Export, Quantity, Workflow

if TYPE_CHECKING:
    from pipeline.nodes import Node
    from stages.paced_artefacts import PacedBeats, Restitution


class RestitutionWorkflowConfig(TissueExperiment):
    """All parameters of the experiment, section by section."""

    geometry: FilmConfig
    electrophysiology: ElectrophysiologyConfig
    protocol: RestitutionProtocol

    @model_validator(mode="after")
    def _sections_fit_together(self) -> RestitutionWorkflowConfig:
        for problem in _misfits(self):
            raise PydanticCustomError("misfit", "{problem}", {"problem": problem})
        return self


def _misfits(config: RestitutionWorkflowConfig) -> Iterator[str]:
    """What contradicts across sections, in words."""
    film, protocol = config.geometry, config.protocol
    if config.electrophysiology.stimuli:
        yield (
            "electrophysiology.stimuli must be empty here: protocol.pulses says what paces the "
            "tissue, and protocol.count, period and intervals say when"
        )
    if protocol.preparation == "cell":
        yield from threshold_out_of_reach(config.electrophysiology)
        return
    yield from stimulus_off_the_film("protocol.pulses.cable", protocol.pulse, film)
    yield from unfit_tissue(film, config.electrophysiology)
    window = protocol.window
    if window[0] < 0 or window[1] > film.length:
        yield f"protocol.window = {interval(window)} mm reaches outside the strip {extent(film)}"


def plan(config: RestitutionWorkflowConfig) -> Mapping[str, Node[Any]]:
    """One stage for a cell; for a strip the geometry, too."""
    from stages.electrophysiology.protocols.stage import restitution

    protocol = config.protocol
    chosen = protocol.model_copy(update={"pulses": {protocol.preparation: protocol.pulse}})
    if protocol.preparation == "cell":
        paced = RestitutionConfig(tissue=config.electrophysiology, protocol=chosen)
        return {"restitution": restitution(paced)}
    tissue = conducting(config.electrophysiology, config.geometry)
    film = excitable_film(config.geometry, tissue)
    paced = RestitutionConfig(tissue=tissue, protocol=chosen)
    return {
        "geometry": film,
        "restitution": restitution(paced, surface=film.part("excitable_surface")),
    }


def quantities(measured: Restitution) -> dict[str, Quantity]:
    """The curve point by point, and what stands out on it."""
    beats = measured.s2
    shortest = shortest_interval(beats)
    slope = largest_slope(beats)
    return {
        "s1_apd90": Quantity(
            listed(measured.s1_apd90),
            "ms",
            "how long each beat of the train lasts, from activation to 90 % repolarisation",
        ),
        "shortest_interval": Quantity(
            shortest,
            "ms",
            "shortest time from the last S1 to an S2 that makes a beat, where shorter ones make none",
        ),
        "largest_slope": Quantity(
            slope,
            "",
            "by how much APD90 grows at most per ms that the tissue has rested longer",
        ),
        **_columns(beats),
    }


def _columns(beats: PacedBeats) -> dict[str, Quantity]:
    found = {
        "interval": Quantity(
            listed(beats.interval), "ms", "time from the last S1 to S2, case by case"
        ),
        "diastolic_interval": Quantity(
            listed(beats.diastolic_interval),
            "ms",
            "how long the tissue has rested before each: since 90 % repolarisation of the last S1 beat",
        ),
        "apd90": Quantity(
            listed(beats.apd90), "ms", "how long the beat lasts, to 90 % repolarisation"
        ),
        "apd50": Quantity(
            listed(beats.apd50), "ms", "how long the beat lasts, to 50 % repolarisation"
        ),
        "peak_active_stress": Quantity(
            listed(beats.peak_active_stress), "kPa", "how hard the muscle pulls in it at most"
        ),
    }
    speeds = listed(beats.conduction_velocity)
    if any(speed is not None for speed in speeds):
        found["conduction_velocity"] = Quantity(
            speeds, "mm/ms", "how fast its wave runs along the strip"
        )
    return found


def shortest_interval(beats: PacedBeats) -> float | None:
    """Interval of the first beat behind the last case without one; ``None`` where no case is without."""
    made = [time is not None for time in listed(beats.activation_time)]
    for i in reversed(range(1, len(made))):
        if made[i] and not made[i - 1]:
            return float(beats.interval[i])
    return None


def largest_slope(beats: PacedBeats) -> float | None:
    """Largest dAPD90/dDI between neighbouring cases with a whole beat each.

    Only where the diastolic interval follows that of S2, by half at least: near the shortest interval a
    wave (or a graded response) takes ever longer to come, so that the tissue rests no less, or even
    longer, and the ratio has no meaning.
    """
    columns = (beats.interval, beats.diastolic_interval, beats.apd90)
    cases = [case for case in zip(*map(listed, columns), strict=True) if None not in case]
    slopes = [
        (longer - shorter) / (after - before)
        for (first, before, shorter), (second, after, longer) in pairwise(cases)
        if after - before >= 0.5 * (second - first)
    ]
    return max(slopes, default=None)


WORKFLOW = Workflow(
    name="restitution",
    title="Restitution: how long and how strong a beat is, by how long the tissue has rested",
    modules=(__name__,),
    config=RestitutionWorkflowConfig,
    plan=plan,
    quantities=lambda experiment: quantities(experiment.load("restitution")),
    measured=("restitution",),
    exports=(
        Export(
            files=("restitution.png", "restitution.svg"),
            modules=("workflows.figures.restitution",),
            stages=("restitution",),
            kind="picture",
            caption="Duration and force of a beat, by the time that the tissue has rested before it, and "
            "the beats themselves. Of a strip also the speed of the wave.",
        ),
        Export(
            files=("restitution.csv",),
            modules=("workflows.exports.paced",),
            stages=("restitution",),
            kind="data",
            caption="A row for each interval of S2: what its beat is like.",
            arguments=("s2", "restitution.csv"),
        ),
        Export(
            files=("steady.csv",),
            modules=("workflows.exports.paced",),
            stages=("restitution",),
            kind="data",
            caption="The same for the last beat of trains of several periods.",
            arguments=("steady", "steady.csv"),
        ),
    ),
)
