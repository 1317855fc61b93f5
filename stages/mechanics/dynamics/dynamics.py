"""The film as a moving body: inertia, Rayleigh damping, supports, energies (sec. 3.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stages.mechanics.body.body import Body
from stages.mechanics.body.imposed import Imposed
from stages.mechanics.shell.active_part import active_force
from stages.mechanics.shell.shell import Shell
from stages.numerics.bands import combined
from stages.numerics.bsplines import Array
from stages.numerics.energy_balance import Forces
from stages.numerics.integration import Travel
from stages.numerics.newton import Linearisation
from stages.numerics.sparse import SymmetricBand
from stages.numerics.time_stepping import Motion, StepWeights


@dataclass(frozen=True)
class ShellDynamics:
    """Body with inertia and Rayleigh damping C = c M + d K_0 (eq. 105)."""

    body: Body
    mass: SymmetricBand
    damping: SymmetricBand

    @classmethod
    def build(cls, body: Body, *, damping: float, stiffness_damping: float = 0.0) -> ShellDynamics:
        """Dynamics with ``damping`` c in 1/ms and ``stiffness_damping`` d in ms."""
        shell = body.shell
        mass = shell.mass()
        matrix = mass.scaled(damping)
        if stiffness_damping:
            matrix = matrix + shell.stiffness_at_rest().scaled(stiffness_damping)
        return cls(body, mass, matrix)

    @property
    def shell(self) -> Shell:
        """What moves."""
        return self.body.shell

    def at_rest(self, imposed: Imposed) -> Travel:
        """Undeformed shell without motion, a = 0, and what acts then.

        Raises
        ------
        ValueError
            If a support is out of its place then.
        """
        for drive, moved in zip(self.body.constraints.drives, imposed.drives, strict=True):
            if moved:
                raise ValueError(
                    f"support {drive.label!r} is {moved:g} times its motion away at t = 0, while the "
                    f"film starts undeformed: choose a time law that begins with 0"
                )
        zero = np.zeros(self.shell.size)
        return self.starting_from(Motion(zero, zero, zero), imposed)

    def starting_from(self, motion: Motion, imposed: Imposed) -> Travel:
        """Beginning of a run from a given motion, whose displacement supports admit."""
        here = self.between(imposed, imposed, 1.0)
        return Travel.start(motion, here.forces(motion.displacement))

    def between(self, start: Imposed, end: Imposed, alpha_f: float) -> LoadedShell:
        """The problem of one step: what acts at its start and at its end, and the weight of its end."""
        return LoadedShell(self, start, end, start.towards(end, alpha_f))

    def kinetic_energy(self, motion: Motion) -> float:
        """v . M v / 2, kPa mm^3."""
        return 0.5 * float(motion.velocity @ (self.mass @ motion.velocity))


@dataclass(frozen=True)
class LoadedShell:
    """Balance of forces of the moving shell over one step (eqs. 62, 64).

    Attributes
    ----------
    dynamics
        What moves.
    start, end
        What acts at t_i and t_{i+1}.
    imposed
        What acts at t_alpha, where the balance holds. The tension law takes the activation at the stretch
        of t_alpha, so that a stress that depends on the stretch is implicit in the step.
    """

    dynamics: ShellDynamics
    start: Imposed
    end: Imposed
    imposed: Imposed

    def linearise(self, motion: Motion, weights: StepWeights) -> Linearisation:
        """R = M a + C v + F_int(u) - F_ext and its derivative by the new displacement.

        Supports hold at t_{i+1}: they did at t_i, and what they ask for at t_alpha is linear in between.
        A displacement that violates them is led to one that does not by the first full correction,
        with the film following, as in :meth:`~stages.mechanics.body.body.Body.linearise`.
        """
        dynamics, ties = self.dynamics, self.dynamics.body.ties
        balance = dynamics.body.balance(motion.displacement, self.imposed)
        force = dynamics.mass @ motion.acceleration + dynamics.damping @ motion.velocity
        force += balance.force
        tangent = combined(
            (weights.stiffness, balance.tangent),
            (weights.mass, dynamics.mass),
            (weights.damping, dynamics.damping),
        )
        stiffness = float(np.abs(tangent.diagonal).max())
        gap = None if balance.gap is None else balance.gap / weights.stiffness
        if gap is not None:
            force += tangent @ gap

        def solve(b: Array) -> Array:
            x = ties.expand(ties.reduce(tangent).factorise().solve(b))
            return x if gap is None else x + gap

        return Linearisation(ties.collect(force), solve, stiffness)

    def forces(self, displacement: Array) -> Forces:
        """Forces with what acts at the end of the step."""
        body = self.dynamics.body
        response = body.shell.respond(displacement, self.end.activation)
        active = active_force(body.shell, response.frames, self.end.activation)
        external = body.external_force(displacement, self.end)
        return Forces(response.force, active, external, response.energy)

    def inertia(self, acceleration: Array) -> Array:
        """M a."""
        return self.dynamics.mass @ acceleration

    def viscous(self, velocity: Array) -> Array:
        """C v."""
        return self.dynamics.damping @ velocity

    def work_of_supports(self, force: Array, increment: Array) -> float:
        """Work along the motion that supports prescribe; the rest of the increment is free."""
        if not self.end.drives.size:
            return 0.0
        motion = self.dynamics.body.ties.offsets @ (self.end.drives - self.start.drives)
        return float(force @ motion)

    def size(self, error: Array) -> float:
        """Largest component of a displacement error relative to the film's diagonal."""
        free = np.where(self.dynamics.body.ties.dependent, 0.0, error)
        return float(np.abs(free).max() / self.dynamics.shell.extent)
