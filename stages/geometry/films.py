"""Flat layered films and the meshes refined from them."""

from __future__ import annotations

from stages.artefacts import ExcitableSurface, Laminate, Layer, MidSurface
from stages.geometry.config import FilmConfig, MeshConfig
from stages.numerics.patches import Patch
from stages.numerics.surface_geometry import offset


def flat_film(film: FilmConfig) -> Patch:
    """Mid-surface [0, L1] x [0, L2] at Z = 0 as one bilinear patch; theta in the unit square."""
    return Patch.rectangle(film.length, film.width)


def two_layers(film: FilmConfig) -> Laminate:
    """Passive substrate below, active layer above (eqs. 13-14)."""
    return Laminate(
        (
            Layer("substrate", "substrate", film.substrate_thickness, film.fibre_angle, 0.0),
            Layer("active", "active", film.active_thickness, film.fibre_angle, 1.0),
        )
    )


def shell_mid_surface(base: Patch, mesh: MeshConfig) -> MidSurface:
    """Mechanics mesh: ``base`` after degree elevation and knot insertion."""
    return MidSurface(base.refine(mesh.degree, mesh.elements))


def active_mid_surface(base: Patch, film: FilmConfig, mesh: MeshConfig) -> ExcitableSurface:
    """Electrophysiology mesh on the mid-surface of the active layer.

    The shell's mid-surface moved by (d - d_a)/2 along its normal (eq. 13): a translation where the
    film is flat, else the offset interpolated at the Greville points of the refined mesh.
    """
    total = film.substrate_thickness + film.active_thickness
    distance = 0.5 * (total - film.active_thickness)
    return ExcitableSurface(offset(base.refine(mesh.degree, mesh.elements), distance))
