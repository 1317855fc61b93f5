"""Flat layered films and the meshes refined from them."""

from __future__ import annotations

from stages.artefacts import ExcitableSurface, Laminate, Layer, MidSurface
from stages.geometry.config import FilmConfig, MeshConfig
from stages.numerics.patches import Patch
from stages.numerics.surface_geometry import offset


def flat_film(film: FilmConfig) -> Patch:
    """Mid-surface [0, L1] x [0, L2] at Z = 0 as one bilinear patch; theta in the unit square."""
    return Patch.rectangle(film.length, film.width)


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


def shell_mid_surface(base: Patch, mesh: MeshConfig) -> MidSurface:
    """Mechanics mesh: ``base`` after degree elevation and knot insertion."""
    return MidSurface(base.refine(mesh.degree, mesh.elements))


def active_mid_surface(base: Patch, film: FilmConfig, mesh: MeshConfig) -> ExcitableSurface:
    """Electrophysiology mesh on the mid-surface of the topmost active layer.

    The shell's mid-surface moved along its normal, by (d - d_a)/2 where that layer lies on top (eq. 13):
    a translation where the film is flat, else the offset interpolated at the Greville points of the
    refined mesh.

    Raises
    ------
    ValueError
        If no layer is active.
    """
    distance = active_depth(laminate_of(film))
    return ExcitableSurface(offset(base.refine(mesh.degree, mesh.elements), distance))


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
