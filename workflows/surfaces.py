"""The excitable surface of a film whose motion is not asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stages.electrophysiology.config import ElectrophysiologyConfig
from stages.geometry.config import FilmConfig, GeometryStageConfig, MeshConfig

if TYPE_CHECKING:
    from pipeline.nodes import Node
    from stages.artefacts import FilmGeometry


def excitable_film(film: FilmConfig, tissue: ElectrophysiologyConfig) -> Node[FilmGeometry]:
    """The film with the mesh of its cells, which is that of the shell too: any shape allows it."""
    from stages.geometry.stage import geometry

    mesh = MeshConfig(elements=tissue.elements, degree=tissue.degree)
    return geometry(GeometryStageConfig(film=film, excitable_mesh=mesh, shell_mesh=mesh))
