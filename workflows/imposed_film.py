"""What `curling` and `twitch` share: a film under imposed activation (secs. 4.1, 4.2).

geometry -> activation -> mechanics -> postprocessing. There are no cells: the activation is the same
everywhere, and follows a time law.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from stages.activation.config import ImposedActivationConfig, ImposedFieldConfig
from stages.configuration import Section
from stages.geometry.config import FilmConfig, MeshConfig, ShellGeometryConfig
from stages.mechanics.config import ShellConfig
from stages.postprocessing.config import ShapeConfig
from workflows.film_checks import (
    acting_off_the_film,
    places_off_the_film,
    unfit_meshes,
    unusable_layers,
)
from workflows.workflow import Export

if TYPE_CHECKING:
    from pipeline.nodes import Node, Stage


class ImposedFilmConfig(Section):
    """Sections of both experiments; each adds its own kind of mechanics."""

    geometry: FilmConfig
    activation: ImposedActivationConfig
    mechanics: ShellConfig
    postprocessing: ShapeConfig

    @model_validator(mode="after")
    def _sections_fit_together(self) -> ImposedFilmConfig:
        problems = (
            *unusable_layers(self.geometry, self.mechanics),
            *places_off_the_film(self.geometry, self.postprocessing),
            *acting_off_the_film(self.geometry, self.mechanics),
            *unfit_meshes(
                self.geometry,
                {"mechanics": (self.mechanics.degree, self.mechanics.elements)},
            ),
        )
        for problem in problems:
            raise PydanticCustomError("misfit", "{problem}", {"problem": problem})
        return self


def plan_film(config: ImposedFilmConfig, mechanics: Stage[Any]) -> Mapping[str, Node[Any]]:
    """The four stages; ``mechanics`` finds the shapes."""
    from stages.activation.stage import imposed_activation
    from stages.geometry.stage import shell_geometry
    from stages.postprocessing.stage import shape

    shell = config.mechanics
    film = shell_geometry(
        ShellGeometryConfig(
            film=config.geometry,
            shell_mesh=MeshConfig(elements=shell.elements, degree=shell.degree),
        )
    )
    mid_surface = film.part("mid_surface")
    field = ImposedFieldConfig(
        peak_stress=config.activation.peak_stress,
        time_law=config.activation.time_law,
        duration=shell.duration,
        n_steps=shell.n_steps,
        points=shell.points_per_element,
    )
    stress = imposed_activation(field, mid_surface=mid_surface)
    shapes = mechanics(
        shell, mid_surface=mid_surface, laminate=film.part("laminate"), stress=stress
    )
    measures = shape(config.postprocessing, mid_surface=mid_surface, deformation=shapes)
    return {
        "geometry": film,
        "activation": stress,
        "mechanics": shapes,
        "postprocessing": measures,
    }


PROBES = Export(
    files=("probes.csv",),
    modules=("workflows.exports.shape_probes",),
    stages=("postprocessing",),
    kind="data",
    caption="Displacement, active stress and fibre stretch of each probe over time, or along a path by "
    "arc length.",
)

FILM = Export(
    files=("film.vtkhdf",),
    modules=("workflows.exports.paraview_shapes",),
    stages=("geometry", "mechanics", "postprocessing"),
    kind="data",
    caption="The moving film with active stress and fibre stretch, for ParaView 5.12 or newer.",
)

SHAPES = Export(
    files=("shapes.png", "shapes.svg"),
    modules=("workflows.figures.shapes",),
    stages=("geometry", "mechanics", "postprocessing"),
    kind="picture",
    caption="The film at six times, coloured by the size of its displacement. A thick edge is "
    "held; the dashed outline is the film at rest.",
)
