"""The film with everything that holds and loads it: what statics, dynamics and buckling solve for."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from stages.mechanics.actions.forces.base import Force
from stages.mechanics.body.constraints import Constraints, constrain
from stages.mechanics.body.imposed import Imposed
from stages.mechanics.loads.base import Load
from stages.mechanics.shell.prediction import predict_resultants
from stages.mechanics.shell.resultants import Resultants
from stages.mechanics.shell.shell import Shell, ShellResponse
from stages.mechanics.supports.base import Support
from stages.numerics.bands import Band, GeneralBand
from stages.numerics.bsplines import Array
from stages.numerics.inertia import negative_pivots
from stages.numerics.newton import Linearisation
from stages.numerics.sparse import BandFactor, SingularMatrixError
from stages.time_laws.base import TimeLaw

if TYPE_CHECKING:
    from stages.numerics.ties import Ties


@dataclass(frozen=True)
class AppliedLoad:
    """A load by its label: the force of size one, and the law of its factor."""

    label: str
    force: Force
    law: TimeLaw


@dataclass(frozen=True)
class Body:
    """A shell, what holds it and what loads it: R(u) = F_int(u) - sum_k factor_k F_k(u).

    Displacements are those of the control points, mm, shape ``(dof,)``. A vector of forces on the
    *independent* degrees of freedom has zeros at the others.
    """

    shell: Shell
    constraints: Constraints
    loads: tuple[AppliedLoad, ...] = ()

    @classmethod
    def held(
        cls,
        shell: Shell,
        supports: Mapping[str, Support],
        loads: Mapping[str, Load] | None = None,
    ) -> Body:
        """A shell on its supports, under loads by label.

        Raises
        ------
        ValueError
            If a support or a load does not fit the film.
        """
        return cls(shell, constrain(shell.patch, supports), tuple(_applied(shell, loads or {})))

    @property
    def ties(self) -> Ties:
        """Dependent degrees of freedom."""
        return self.constraints.ties

    def nothing(self) -> Imposed:
        """No activation, no load, supports in their places."""
        return self.under(np.zeros(self.shell.points))

    def under(self, activation: Array) -> Imposed:
        """An activation alone."""
        loads, drives = np.zeros(len(self.loads)), np.zeros(len(self.constraints.drives))
        return Imposed(np.asarray(activation, dtype=float), loads, drives)

    def imposed_at(self, time: float, activation: Array) -> Imposed:
        """What acts at a time (ms), under the activation of that time."""
        return Imposed(
            np.asarray(activation, dtype=float),
            np.array([load.law.at(time) for load in self.loads], dtype=float),
            np.array([drive.law.at(time) for drive in self.constraints.drives], dtype=float),
        )

    def admissible(self, displacement: Array, imposed: Imposed) -> Array:
        """The displacement with every dependent degree of freedom in its place."""
        return self.ties.admissible(displacement, imposed.drives)

    def external_force(self, displacement: Array, imposed: Imposed) -> Array:
        """Sum of all loads, kPa mm^2, shape ``(dof,)``."""
        force = np.zeros(self.shell.size)
        position = self._position(displacement)
        for load, factor in zip(self.loads, imposed.loads, strict=True):
            if factor:
                force += factor * load.force.at(position)
        return force

    def balance(self, displacement: Array, imposed: Imposed) -> Balance:
        """Forces and tangent of one configuration."""
        response = self.shell.respond(displacement, imposed.activation)
        force = response.force
        if self.loads:
            force = force - self.external_force(displacement, imposed)
        return Balance(self, displacement, imposed, response, force)

    def linearise(self, displacement: Array, imposed: Imposed) -> Linearisation:
        """Residual and tangent for Newton's method, whose unknown is the whole displacement.

        From a displacement that violates the constraints, as when a support moves on, the correction of
        a full step leads to one that does not, with the film following: the residual foresees it. The
        prescribed motion therefore never shows up as a strain of the outermost elements alone.
        """
        return self.balance(displacement, imposed).linearisation()

    def rate(self, displacement: Array, start: Imposed, end: Imposed) -> Array:
        """du/ds of the equilibrium path at s = 0, where what acts goes from ``start`` to ``end`` over s.

        ``displacement`` is in equilibrium under ``start``. Exact, since residuals are linear in what is
        imposed.
        """
        return self.balance(displacement, start).rate(end)

    def work_between(self, old: Array, before: Imposed, new: Array, after: Imposed) -> float:
        """Work of loads and moved supports between two equilibria, kPa mm^3, by the trapezoidal rule.

        In equilibrium the internal force equals loads and reactions, so it does their work.
        """
        if not self.loads and not self.constraints.drives:
            return 0.0
        forces = [
            self.shell.respond(u, imposed.activation).force
            for u, imposed in ((old, before), (new, after))
        ]
        return 0.5 * float((forces[0] + forces[1]) @ (new - old))

    def tangent_of(self, response: ShellResponse, displacement: Array, imposed: Imposed) -> Band:
        """dR/du before constraints; without symmetry where a load follows the film."""
        tangent = self.shell.tangent(response)
        following = [
            (load.force, factor)
            for load, factor in zip(self.loads, imposed.loads, strict=True)
            if factor and load.force.follows
        ]
        if not following:
            return tangent
        general = GeneralBand.of(tangent)
        position = self._position(displacement)
        for force, factor in following:
            force.add_stiffness(position, -factor, general)
        return general

    def _position(self, displacement: Array) -> Array:
        return self.shell.patch.control_points.reshape(-1, 3) + displacement.reshape(-1, 3)


def _applied(shell: Shell, loads: Mapping[str, Load]) -> Iterator[AppliedLoad]:
    """Loads in the order of their labels."""
    for label, load in sorted(loads.items()):
        try:
            force = load.on(shell.patch, shell.basis.points)
        except ValueError as error:
            raise ValueError(f"load {label!r} ({load.kind}): {error}") from error
        yield AppliedLoad(label, force, load.time_law)


@dataclass(frozen=True)
class Balance:
    """Forces and tangent of a body in one configuration.

    Attributes
    ----------
    response
        Of the shell.
    force
        R before constraints, shape ``(dof,)``: the reactions, where it is in equilibrium.
    resultants
        Forces and moments of its geometric stiffness, where they are not those of ``response``.
    """

    body: Body
    displacement: Array
    imposed: Imposed
    response: ShellResponse
    force: Array
    resultants: Resultants | None = None

    @cached_property
    def tangent(self) -> Band:
        """dR/du before constraints."""
        response = self.response
        if self.resultants is not None:
            response = replace(response, resultants=self.resultants)
        return self.body.tangent_of(response, self.displacement, self.imposed)

    def after(self, correction: Array, imposed: Imposed) -> Balance:
        """Balance after a correction, whose geometric stiffness has the forces that this one predicts."""
        force, moment = predict_resultants(self.body.shell, self.response, correction)
        balance = self.body.balance(self.displacement + correction, imposed)
        predicted = balance.response.resultants._replace(force=force, moment=moment)
        return replace(balance, resultants=predicted)

    @cached_property
    def reduced(self) -> Band:
        """T^T (dR/du) T."""
        return self.body.ties.reduce(self.tangent)

    @cached_property
    def factor(self) -> BandFactor:
        """Factors of the reduced tangent; raises ``SingularMatrixError``."""
        return self.reduced.factorise()

    @cached_property
    def gap(self) -> Array | None:
        """From the displacement to its admissible neighbour; None where it is admissible."""
        gap = self.body.admissible(self.displacement, self.imposed) - self.displacement
        size = np.abs(self.displacement).max(initial=0.0)
        return gap if np.abs(gap).max(initial=0.0) > 1e-14 * size else None

    @cached_property
    def unstable_directions(self) -> int:
        """Negative pivots of the reduced tangent, of its symmetric part where a load follows."""
        with contextlib.suppress(SingularMatrixError):
            if self.factor.positive_definite:
                return 0
        return negative_pivots(self.reduced.symmetric_part())

    def linearisation(self) -> Linearisation:
        """See :meth:`Body.linearise`."""
        ties, gap = self.body.ties, self.gap
        force = self.force if gap is None else self.force + self.tangent @ gap
        stiffness = float(np.abs(self.tangent.diagonal).max())

        def solve(b: Array) -> Array:
            x = ties.expand(self.factor.solve(b))
            return x if gap is None else x + gap

        return Linearisation(
            ties.collect(force), solve, stiffness, lambda: self.unstable_directions
        )

    def rate(self, end: Imposed) -> Array:
        """See :meth:`Body.rate`."""
        body, start = self.body, self.imposed
        change = body.shell.respond(self.displacement, end.activation).force - self.response.force
        change -= body.external_force(self.displacement, end)
        change += body.external_force(self.displacement, start)
        motion = body.ties.offsets @ (end.drives - start.drives)
        right = body.ties.collect(change + self.tangent @ motion)
        return body.ties.expand(self.factor.solve(-right)) + motion
