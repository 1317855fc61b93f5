"""The part of the internal force that is due to the active stress alone (eqs. 35, 37-39)."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from stages.mechanics.shell.assembly import assemble_force
from stages.mechanics.shell.kinematics import Frames, strains_at
from stages.mechanics.shell.resultants import Resultants
from stages.mechanics.shell.shell import Shell
from stages.mechanics.tension_laws.base import TensionLaw, functions_of
from stages.numerics.bsplines import Array
from stages.numerics.compiled import inlined, kernel


def active_force(shell: Shell, frames: Frames, activation: Array) -> Array:
    """F_int with the activation less F_int without it, at the same displacement.

    It costs about a quarter of :meth:`~stages.mechanics.shell.shell.Shell.respond`: no material is evaluated.

    Parameters
    ----------
    shell
        The shell.
    frames
        Frames of its mid-surface in that displacement.
    activation
        As for the shell, kPa, shape ``(point,)``.

    Returns
    -------
    Array
        kPa mm^2, shape ``(dof,)``; minus it is the force that the muscle exerts.
    """
    resultants = Resultants.zeros(shell.points)
    add, constants = _kernel(type(shell.tension)), shell.tension.constants()
    for points in shell.layers:
        if points.layer.active:
            arrays = points.depth, points.weights, points.reference
            field = points.layer.activity * np.asarray(activation, dtype=float)
            add(*arrays, constants, shell.reference, frames, field, resultants)
    force = np.zeros((shell.patch.size, 3))
    assemble_force(shell.basis, shell.weights, frames, resultants, force)
    return force.ravel()


@functools.cache
def _kernel(tension: type[TensionLaw]) -> Callable[..., None]:
    law = inlined(functions_of(tension).tension)

    @kernel
    def add(
        depth: Any,
        weights: Any,
        table: Any,
        constants: Any,
        reference: Any,
        current: Any,
        activation: Any,
        resultants: Any,
    ) -> None:
        for p in range(activation.size):
            eps11, eps22, eps12, kap11, kap22, kap12 = strains_at(reference, current, p)
            for k in range(depth.size):
                z, w = depth[k], weights[k]
                f11, f22, f12 = table[p, k, 4], table[p, k, 5], table[p, k, 6]
                squared = 1.0 + 2.0 * (
                    f11 * (eps11 + z * kap11)
                    + f22 * (eps22 + z * kap22)
                    + 2.0 * f12 * (eps12 + z * kap12)
                )
                pull = w * law(activation[p], squared**0.5, constants)[0] / squared
                resultants.force[p, 0] += pull * f11
                resultants.force[p, 1] += pull * f22
                resultants.force[p, 2] += pull * f12
                resultants.moment[p, 0] += z * pull * f11
                resultants.moment[p, 1] += z * pull * f22
                resultants.moment[p, 2] += z * pull * f12

    return add
