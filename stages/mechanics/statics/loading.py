"""The film between two instants of its loading, as a problem that paths are followed through."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from stages.mechanics.body.body import Balance, Body
from stages.mechanics.body.imposed import Imposed
from stages.numerics.bsplines import Array
from stages.numerics.newton import Linearisation


@dataclass(frozen=True)
class Loading:
    """What acts on a body goes from ``start`` at s = ``first`` to ``end`` at s = ``last``, and on.

    The loading is linear in s and may be followed beyond both ends.
    """

    body: Body
    start: Imposed
    end: Imposed
    first: float = 0.0
    last: float = 1.0

    def imposed(self, s: float) -> Imposed:
        """What acts at ``s``."""
        if s == self.last:
            return self.end
        return self.start.towards(self.end, (s - self.first) / (self.last - self.first))

    def linearise(self, x: Array, s: float) -> Linearisation:
        """Residual and tangent; the next ones of the same solve use a predicted tangent."""
        return self._system(self.body.balance(x, self.imposed(s)), s)

    def admissible(self, x: Array, s: float) -> Array:
        """The displacement with supports where they are at ``s``."""
        return self.body.admissible(x, self.imposed(s))

    def rate(self, x: Array, s: float) -> Array:
        """dR/ds at fixed free degrees of freedom, while moved supports go on."""
        body, ties, width = self.body, self.body.ties, self.last - self.first
        now, onward = self.imposed(s), self.imposed(s + width)
        change = body.external_force(x, now) - body.external_force(x, onward)
        if not np.array_equal(now.activation, onward.activation):
            change += body.shell.respond(x, onward.activation).force
            change -= body.shell.respond(x, now.activation).force
        if now.drives.size:
            motion = ties.offsets @ (onward.drives - now.drives)
            change += body.balance(x, now).tangent @ motion
        return np.asarray(ties.collect(change)) / width

    def direction(self, x: Array, s: float) -> Array:
        """dx/ds along the equilibrium path, from an equilibrium at ``s``."""
        onward = self.imposed(s + (self.last - self.first))
        return self.body.rate(x, self.imposed(s), onward) / (self.last - self.first)

    def _system(self, balance: Balance, s: float) -> Linearisation:
        def ahead(correction: Array, parameter: float | None = None) -> Linearisation:
            reached = s if parameter is None else parameter
            return self._system(balance.after(correction, self.imposed(reached)), reached)

        return replace(balance.linearisation(), ahead=ahead)


def in_words(body: Body, imposed: Imposed) -> str:
    """What acts on a body, for a message."""
    parts = [f"activation up to {np.abs(imposed.activation).max(initial=0.0):.4g} kPa"]
    for load, factor in zip(body.loads, imposed.loads, strict=True):
        parts.append(f"{load.label} times {factor:.4g}")
    parts += [f"supports moved by factor {drive:.4g}" for drive in imposed.drives]
    return ", ".join(parts)
