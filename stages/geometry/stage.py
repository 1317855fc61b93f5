"""Stages `geometry` and `shell_geometry`: from the film's measures to refined surfaces and lay-up."""

from __future__ import annotations

from pipeline.nodes import stage
from stages.artefacts import FilmGeometry, ShellGeometry
from stages.geometry.config import GeometryStageConfig, ShellGeometryConfig


@stage
def geometry(config: GeometryStageConfig) -> FilmGeometry:
    """Refined surfaces of both sub-problems and the film's layers.

    The three parts are kept apart, so that another fibre angle leaves the electrophysiology alone.
    """
    from stages.geometry.films import (
        active_mid_surface,
        laminate_of,
        shell_mid_surface,
    )

    return FilmGeometry(
        excitable_surface=active_mid_surface(config.film, config.excitable_mesh),
        mid_surface=shell_mid_surface(config.film, config.shell_mesh),
        laminate=laminate_of(config.film),
    )


@stage
def shell_geometry(config: ShellGeometryConfig) -> ShellGeometry:
    """Refined mid-surface of the shell and the film's layers, where no cells need a surface."""
    from stages.geometry.films import laminate_of, shell_mid_surface

    return ShellGeometry(
        shell_mid_surface(config.film, config.shell_mesh), laminate_of(config.film)
    )
