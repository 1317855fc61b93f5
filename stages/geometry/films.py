"""Layered films and the meshes laid over them."""

from __future__ import annotations

from dataclasses import replace

from stages.artefacts import ExcitableSurface, Laminate, Layer, MidSurface
from stages.geometry.config import FilmConfig, MeshConfig
from stages.numerics.patches import Patch
from stages.numerics.surface_geometry import offset


def laminate_of(film: FilmConfig) -> Laminate:
    """Layers from bottom to top; in the paper's film a passive one below the muscle (eqs. 13-14)."""
    return Laminate(
        tuple(
            Layer(
                layer.name,
                layer.material,
                layer.thickness,
                film.fibre_angle if layer.fibre_angle is None else layer.fibre_angle,
                layer.activity,
            )
            for layer in film.lay_up
        )
    )


def film_patch(film: FilmConfig, mesh: MeshConfig) -> Patch:
    """The film's mid-surface on a mesh; parameters mean the same points of the film on every mesh."""
    patch = film.shape.patch(film.length, film.width, mesh.degree, mesh.elements)
    if film.shape.is_flat:
        return patch
    return replace(patch, closed=film.shape.closed, extent=(film.length, film.width))


def shell_mid_surface(film: FilmConfig, mesh: MeshConfig) -> MidSurface:
    """Mid-surface on the mechanics mesh."""
    return MidSurface(film_patch(film, mesh))


def active_mid_surface(film: FilmConfig, mesh: MeshConfig) -> ExcitableSurface:
    """Electrophysiology mesh on the mid-surface of the topmost active layer.

    The shell's mid-surface moved along its normal, by (d - d_a)/2 where that layer lies on top (eq. 13):
    a translation where the film is flat, else the exact offset interpolated at the Greville points of the
    refined mesh. X and Y go on to be those of the film.

    Raises
    ------
    ValueError
        If no layer is active.
    """
    return ExcitableSurface(offset(film_patch(film, mesh), active_depth(laminate_of(film))))


def active_depth(laminate: Laminate) -> float:
    """theta3 of the middle of the topmost active layer, mm.

    Examples
    --------
    >>> muscle, skin = Layer("muscle", "active", 4.0, 0.0, 1.0), Layer("skin", "pdms", 1.0, 0.0, 0.0)
    >>> active_depth(Laminate((skin, muscle))), active_depth(Laminate((muscle, skin)))
    (0.5, -0.5)

    Raises
    ------
    ValueError
        If no layer is active.
    """
    above = 0.0
    for layer in reversed(laminate.layers):
        if layer.active:
            return 0.5 * (laminate.thickness - layer.thickness) - above
        above += layer.thickness
    raise ValueError(
        "no layer of the film is active, so no cells have a place: give one of "
        f"{', '.join(repr(layer.name) for layer in laminate.layers)} an activity above 0"
    )
