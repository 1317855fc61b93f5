"""Energy balance of the steps of a moving body, M a + C v + F(u) = F_ext + forces of the supports.

Over a step with displacement increment du, forces act with their value in the middle of the step: the
mean of their values at its two ends, and for the inertia in the forces of the supports the acceleration
A of the balance, moved from t_alpha to the middle. So, with a bar for that value,

    loads           bar F_ext . du
    activation      -bar F_active . du
    dissipated      C bar v . du
    supports        (M bar A + C bar v + bar F - bar F_ext) . du, on moved unknowns

and what they do not account for in the change of kinetic and strain energy,

    imbalance = kinetic + strain + dissipated - work of activation, loads and supports,

is the doing of the method. For a linear body and rho_inf = 1 it is round-off: there the middle of the
step is t_alpha. Otherwise it is of second order in dt, and a free linear body loses by it what the
amplification of the method says, an energy of order dt^3. Forces at t_alpha instead of the middle
would look natural, but their work is of first order only: for rho_inf = 0.5 they are those of two
thirds of the step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

from stages.numerics.bsplines import Array
from stages.numerics.step_error import Balance
from stages.numerics.time_stepping import GeneralizedAlpha, Motion


@dataclass(frozen=True)
class Forces:
    """Forces of a body at one time, which depend on where it is.

    Attributes
    ----------
    internal
        F, passive and active together.
    active
        The part of F that is due to the activation.
    external
        F_ext, the loads.
    strain_energy
        What the passive part has stored.
    """

    internal: Array
    active: Array
    external: Array
    strain_energy: float


class EnergyKeeper(Protocol):
    """A body that knows its forces at the end of a step."""

    def forces(self, displacement: Array) -> Forces:
        """Forces in that displacement, with loads and activation of the end of the step."""
        ...

    def inertia(self, acceleration: Array) -> Array:
        """M a."""
        ...

    def viscous(self, velocity: Array) -> Array:
        """C v."""
        ...

    def work_of_supports(self, force: Array, increment: Array) -> float:
        """Part of force . increment that belongs to unknowns whose values are prescribed."""
        ...


class Works(NamedTuple):
    """Work done since the start, by activation, loads and supports; and energy dissipated.

    Examples
    --------
    >>> (Works(1.0, 2.0, 0.5, 0.25) + Works(1.0, 0.0, 0.0, 0.0)).imbalance(kinetic=2.0, strain=2.0)
    -0.25
    """

    activation: float = 0.0
    loads: float = 0.0
    supports: float = 0.0
    dissipated: float = 0.0

    def __add__(self, other: object) -> Works:
        if not isinstance(other, Works):
            return NotImplemented
        return Works(*(mine + its for mine, its in zip(self, other, strict=True)))

    @property
    def external(self) -> float:
        """Work of loads and supports."""
        return self.loads + self.supports

    def imbalance(self, kinetic: float, strain: float) -> float:
        """Energy that the method made (positive) or lost (negative) since the start.

        ``kinetic`` and ``strain`` are what the body holds now, less what it held at the start.
        """
        return kinetic + strain + self.dissipated - self.activation - self.external


def works_of_step(
    body: EnergyKeeper,
    scheme: GeneralizedAlpha,
    ends: tuple[Motion, Motion],
    forces: tuple[Forces, Forces],
    balance: Balance,
) -> Works:
    """Works over one step (see the module).

    Parameters
    ----------
    body, scheme
        What moves, and the method.
    ends
        Motion at both ends of the step.
    forces
        Forces at both ends.
    balance
        Balance of this step.
    """
    (old, new), (before, after) = ends, forces
    du = new.displacement - old.displacement
    active = 0.5 * (before.active + after.active)
    external = 0.5 * (before.external + after.external)
    internal = 0.5 * (before.internal + after.internal)
    viscous = body.viscous(0.5 * (old.velocity + new.velocity))
    to_middle = (0.5 - scheme.alpha_f) * balance.length
    inertia = body.inertia(balance.acceleration + to_middle * balance.slope)
    return Works(
        activation=-float(active @ du),
        loads=float(external @ du),
        supports=body.work_of_supports(inertia + viscous + internal - external, du),
        dissipated=float(viscous @ du),
    )
