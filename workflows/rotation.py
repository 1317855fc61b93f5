"""How fast a spiral turns, and how often it passes the probes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from workflows.film_quantities import listed
from workflows.tables import number
from workflows.workflow import Quantity

if TYPE_CHECKING:
    from stages.artefacts import Measures
    from stages.electrophysiology.config import ElectrophysiologyConfig
    from workflows.coupled_film import CoupledFilmConfig


def spiral_quantities(config: CoupledFilmConfig, measures: Measures) -> dict[str, Quantity]:
    """Turns of the spiral, and how often each probe was activated."""
    arrivals = {
        name: [time for time in listed(times) if time is not None]
        for name, times in zip(measures.probe_names, measures.activation_times, strict=True)
    }
    probe = outermost(config)
    turns = turn_times(arrivals[probe], pulses(config.electrophysiology))
    threshold = number(config.electrophysiology.activation_threshold)
    found = {
        "rotation_period": Quantity(
            sum(turns) / len(turns) if turns else None,
            "ms",
            f"how long a turn of the spiral takes, as {probe} sees it, on average",
        ),
        "rotation_periods": Quantity(
            list(turns), "ms", f"the same turn by turn, from activation to activation of {probe}"
        ),
    }
    if config.postprocessing.tip_potential is not None:
        from stages.postprocessing.tip_paths import turn_times as turns_of_the_tip

        found["tip_turn_times"] = Quantity(
            listed(turns_of_the_tip(measures.tips)),
            "ms",
            "how long each turn of the spiral's tip takes, by the direction of the front there",
        )
    for name, times in arrivals.items():
        found[f"{name}.activation_count"] = Quantity(
            float(len(times)),
            "",
            f"how often the potential at {name} rises through {threshold} mV, the threshold",
        )
    return found


def pulses(cells: ElectrophysiologyConfig) -> int:
    """How many times the tissue is stimulated, trains pulse by pulse."""
    return sum(len(stimulus.starts) for stimulus in cells.stimuli)


def turn_times(arrivals: Sequence[float], stimuli: int) -> list[float]:
    """Intervals between activations of a point that no stimulus can have caused.

    A stimulus activates a point once at most, so that of the activations the first ``stimuli`` may
    be theirs, and each later one is a wave that has come round: it ends a turn that began with the
    activation before it. Without a spiral the list is empty.

    Examples
    --------
    Two stimuli, of which the second makes the spiral:

    >>> turn_times([196.0, 775.0, 1146.0, 1532.0], stimuli=2)
    [371.0, 386.0]
    >>> turn_times([196.0, 685.0], stimuli=2)
    []
    """
    started = list(arrivals[max(stimuli - 1, 0) :])
    return [after - before for before, after in pairwise(started)]


def outermost(config: CoupledFilmConfig) -> str:
    """Name of the probe farthest from the middle of the film: of the paper's, the corner C.

    Beside the core of a spiral the potential rises and falls by less than an action potential, and
    whether it passes the threshold depends on the threshold. The core drifts about the middle of the
    film, so that all is clear far from there.
    """
    return max(config.postprocessing.probes, key=lambda name: _off_centre(config, name))


def _off_centre(config: CoupledFilmConfig, name: str) -> float:
    from stages.postprocessing.probes import NAMED_PLACES

    film, place = config.geometry, config.postprocessing.probes[name]
    if isinstance(place, str):
        x, y = NAMED_PLACES[place]
        place = (x * film.length, y * film.width)
    return math.hypot(place[0] - 0.5 * film.length, place[1] - 0.5 * film.width)
