"""Twitch (sec. 4.2, Figs 6-7): a film swings under one imposed pulse of activation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from stages.mechanics.config import MechanicsConfig
from workflows.film_quantities import of_flat_films
from workflows.imposed_film import FILM, PROBES, SHAPES, ImposedFilmConfig, plan_film
from workflows.workflow import Export, Quantity, Workflow

if TYPE_CHECKING:
    from pipeline.nodes import Node
    from workflows.experiment import Experiment


class TwitchConfig(ImposedFilmConfig):
    """All parameters of the experiment, section by section."""

    mechanics: MechanicsConfig


def plan(config: TwitchConfig) -> Mapping[str, Node[Any]]:
    """The four stages; the mechanics is dynamic."""
    from stages.mechanics.stage import mechanics

    return plan_film(config, mechanics)


def quantities(experiment: Experiment) -> dict[str, Quantity]:
    """The numbers that an experimenter would write down, the largest over time."""
    shape = experiment.shape
    return {
        "max_curvature": of_flat_films(
            shape.curvature.max(),
            "1/mm",
            "largest curvature, from the length of the film's projection as in experiments",
        ),
        "tip_ux_min": Quantity(
            float(shape.tip[:, 0].min()),
            "mm",
            "how far the middle of the free edge moves along the film, towards the clamp",
        ),
        "tip_uz_max": Quantity(float(shape.tip[:, 2].max()), "mm", "how far it lifts off at most"),
    }


WORKFLOW = Workflow(
    name="twitch",
    title="Twitch: a film swings under one pulse of an imposed activation",
    modules=(__name__,),
    config=TwitchConfig,
    plan=plan,
    quantities=quantities,
    measured=("postprocessing",),
    exports=(
        SHAPES,
        Export(
            files=("twitch.png", "twitch.svg"),
            modules=("workflows.figures.twitch",),
            stages=("postprocessing",),
            kind="picture",
            caption="(a) Active stress and (b) displacement of the tip over time.",
        ),
        PROBES,
        FILM,
    ),
)
