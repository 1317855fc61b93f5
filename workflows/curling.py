"""Curling (sec. 4.1, Figs 3-5): a film curls slowly under a growing activation that is imposed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from stages.mechanics.config import EquilibriumConfig
from workflows.film_quantities import of_flat_films
from workflows.imposed_film import FILM, PROBES, SHAPES, ImposedFilmConfig, plan_film
from workflows.stability import MODES, MODES_FILE, stability_quantities
from workflows.stoney import bias_quantities, bias_remarks, modified_stoney
from workflows.workflow import Export, Quantity, Workflow

if TYPE_CHECKING:
    from pipeline.nodes import Node
    from workflows.experiment import Experiment


class CurlingConfig(ImposedFilmConfig):
    """All parameters of the experiment, section by section."""

    mechanics: EquilibriumConfig


def plan(config: CurlingConfig) -> Mapping[str, Node[Any]]:
    """The four stages, of which the mechanics is quasi-static, and buckling modes on demand."""
    from stages.mechanics.stage import buckling, equilibrium

    shell = config.mechanics
    path = shell.model_copy(update={"buckling_modes": 0})  # they have no influence on it
    nodes = dict(plan_film(config.model_copy(update={"mechanics": path}), equilibrium))
    if shell.buckling_modes:
        film, stress = nodes["geometry"], nodes["activation"]
        nodes["buckling"] = buckling(
            shell,
            mid_surface=film.part("mid_surface"),
            laminate=film.part("laminate"),
            stress=stress,
        )
    return nodes


def quantities(experiment: Experiment) -> dict[str, Quantity]:
    """The numbers that an experimenter would write down, at the end of the loading."""
    shape = experiment.shape
    found = {
        "curvature": of_flat_films(
            shape.curvature[-1],
            "1/mm",
            "curvature, from the length of the film's projection as in experiments",
        ),
        "projected_length": of_flat_films(
            shape.projected_length[-1], "mm", "length of the film seen from above"
        ),
        "tip_ux": Quantity(
            float(shape.tip[-1, 0]),
            "mm",
            "how far the middle of the free edge moves along the film",
        ),
        "tip_uz": Quantity(float(shape.tip[-1, 2]), "mm", "how far it lifts off"),
        "turning_angle": Quantity(
            float(shape.turning[-1]),
            "degree",
            "how far the film turns from the clamp to the tip; beyond 360 it would touch itself",
        ),
        "stoney_curvature": Quantity(
            modified_stoney(experiment.config),
            "1/mm",
            "modified Stoney approximation as published (eq. 102); it contains no peak stress",
        ),
    }
    return found | bias_quantities(experiment) | stability_quantities(experiment)


WORKFLOW = Workflow(
    name="curling",
    title="Curling: a film curls slowly under an imposed activation",
    modules=(__name__,),
    config=CurlingConfig,
    plan=plan,
    quantities=quantities,
    measured=("mechanics", "postprocessing", "buckling"),
    exports=(
        SHAPES,
        Export(
            files=("curling.png", "curling.svg"),
            modules=("workflows.figures.curling",),
            stages=("mechanics", "postprocessing"),
            kind="picture",
            caption="(a) Curvature and (b) displacement of the tip as the active stress grows; along a path "
            "by arc length, against the load factor, with dotted lines at its limit points.",
        ),
        MODES,
        Export(
            files=("stoney.png", "stoney.svg"),
            modules=("workflows.figures.stoney_place",),
            stages=("postprocessing",),
            kind="picture",
            caption="What a narrow-strip (Stoney) formula makes of a film's curvature: the share of "
            "the true active stress that it returns, for films as thick as this one and of any "
            "width. The point is this film.",
            sections=("geometry", "activation", "mechanics"),
        ),
        PROBES,
        FILM,
        MODES_FILE,
    ),
    remarks=bias_remarks,
)
