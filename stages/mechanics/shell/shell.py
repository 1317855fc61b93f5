"""The discrete shell: internal force, tangent, energy and mass as functions of the displacement."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from stages.artefacts import Laminate
from stages.mechanics.materials.base import Material
from stages.mechanics.shell.assembly import (
    assemble_force,
    assemble_mass,
    assemble_stiffness,
    half_bandwidth,
)
from stages.mechanics.shell.discretisation import Basis, basis_on_grid
from stages.mechanics.shell.fibres import FibreGauge
from stages.mechanics.shell.kinematics import Frames, compute_frames
from stages.mechanics.shell.laminate import LayerPoints, points_through, surface_density
from stages.mechanics.shell.resultants import Resultants, compile_layer
from stages.mechanics.tension_laws.base import TensionLaw
from stages.mechanics.tension_laws.prescribed import Prescribed
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.numerics.sparse import SymmetricBand

PRESCRIBED = Prescribed()


@dataclass(frozen=True)
class ShellResponse:
    """Response of the shell in one configuration.

    Attributes
    ----------
    force
        F_int, kPa mm^2, shape ``(dof,)``.
    energy
        Passive strain energy, kPa mm^3.
    """

    force: Array
    energy: float
    frames: Frames
    resultants: Resultants


@dataclass(frozen=True)
class Shell:
    """Layered Kirchhoff-Love shell on a spline patch (eqs. 40-48).

    Degrees of freedom are numbered ``3 * control point + component``. Build one with
    :func:`build_shell`.
    """

    patch: Patch
    basis: Basis
    weights: Array
    """Gauss weights times the reference area element, mm^2, shape ``(point,)``."""
    reference: Frames
    layers: tuple[LayerPoints, ...]
    tension: TensionLaw
    fibres: FibreGauge
    _add: tuple[Callable[..., None], ...]

    @property
    def size(self) -> int:
        """Number of degrees of freedom."""
        return 3 * self.patch.size

    @property
    def points(self) -> int:
        """Number of in-plane quadrature points."""
        return int(self.weights.size)

    @property
    def extent(self) -> float:
        """Diagonal of the box around the undeformed control net, mm: the scale of displacements."""
        net = self.patch.control_points.reshape(-1, 3)
        return float(np.linalg.norm(np.ptp(net, axis=0)))

    def respond(self, displacement: Array, activation: Array) -> ShellResponse:
        """Internal force and energy (eqs. 30, 34-35).

        Parameters
        ----------
        displacement
            Control displacements, mm, shape ``(dof,)``.
        activation
            What the tension law turns into sigma_a, kPa, per in-plane quadrature point; each layer
            takes it times its activity. Shape ``(point,)``.
        """
        frames = self.frames(displacement)
        resultants = Resultants.zeros(self.points)
        activation = np.ascontiguousarray(activation, dtype=float)
        for points, add in zip(self.layers, self._add, strict=True):
            add(self.reference, frames, points.layer.activity * activation, resultants)
        force = np.zeros((self.patch.size, 3))
        assemble_force(self.basis, self.weights, frames, resultants, force)
        energy = float(self.weights @ resultants.energy)
        return ShellResponse(force.ravel(), energy, frames, resultants)

    def frames(self, displacement: Array) -> Frames:
        """Frames of the mid-surface at the quadrature points."""
        position = self.patch.control_points.reshape(-1, 3) + displacement.reshape(-1, 3)
        frames = Frames.empty(self.points)
        compute_frames(self.basis, position, frames)
        return frames

    def fibre_stretch(self, displacement: Array) -> Array:
        """lambda_f at the gauge of :attr:`fibres`, shape ``(point,)``."""
        return self.fibres.stretch(self.reference, self.frames(displacement))

    def tangent(self, response: ShellResponse) -> SymmetricBand:
        """Tangent stiffness K_int of that configuration (eq. 48)."""
        matrix = SymmetricBand.zeros(self.size, half_bandwidth(self.basis))
        assemble_stiffness(
            self.basis, self.weights, response.frames, response.resultants, matrix.bands
        )
        return matrix

    def stiffness_at_rest(self) -> SymmetricBand:
        """Tangent of the undeformed, inactive shell; Rayleigh damping is built on it."""
        return self.tangent(self.respond(np.zeros(self.size), np.zeros(self.points)))

    def mass(self) -> SymmetricBand:
        """Consistent mass matrix (eq. 46), mg."""
        matrix = SymmetricBand.zeros(self.size, half_bandwidth(self.basis))
        assemble_mass(self.basis, self.weights, surface_density(self.layers), matrix.bands)
        return matrix


def build_shell(
    patch: Patch,
    laminate: Laminate,
    materials: Mapping[str, Material],
    *,
    plane_points: int | None = None,
    layer_points: int = 3,
    tension: TensionLaw = PRESCRIBED,
    thin: bool = False,
) -> Shell:
    """Shell over a mid-surface patch.

    Parameters
    ----------
    patch
        Undeformed mid-surface; C1 at least.
    laminate, materials
        Layers, and the materials that they name.
    plane_points
        In-plane Gauss points per element and direction; default: the higher degree plus one.
    layer_points
        Gauss points through each layer.
    tension
        Tension law of the active layers; a passive one has no active stress whatever the law.
    thin
        Take the metric of the mid-surface at every depth, as classical thin-shell theory does.

    Raises
    ------
    ValueError
        If the patch is not C1, or the laminate is incomplete.
    """
    for direction, space in enumerate(patch.spaces, start=1):
        if space.degree < 2 or space.continuity < 1:
            raise ValueError(
                f"the shell bends, so its splines must be C1: direction {direction} has degree "
                f"{space.degree} and continuity C{space.continuity}; use degree 2 or more and "
                f"simple interior knots"
            )
    points = plane_points or max(space.degree for space in patch.spaces) + 1
    basis, weights = basis_on_grid(patch, points)
    reference = Frames.empty(weights.size)
    compute_frames(basis, patch.control_points.reshape(-1, 3).copy(), reference)
    layers = points_through(laminate, materials, reference, layer_points, thin=thin)
    adders = tuple(
        compile_layer(points, tension if points.layer.active else PRESCRIBED) for points in layers
    )
    fibres = FibreGauge.build(layers, reference, tension)
    area = weights * reference.area
    return Shell(patch, basis, area, reference, layers, tension, fibres, adders)
