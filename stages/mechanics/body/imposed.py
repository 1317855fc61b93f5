"""What acts on the film at an instant."""

from __future__ import annotations

from dataclasses import dataclass

from stages.numerics.bsplines import Array


@dataclass(frozen=True)
class Imposed:
    """Activation and factors of loads and moved supports; linear between two instants.

    Attributes
    ----------
    activation
        At the in-plane quadrature points, kPa, shape ``(point,)``.
    loads
        Factor of each load, shape ``(load,)``.
    drives
        Factor of each moved support, shape ``(drive,)``.
    """

    activation: Array
    loads: Array
    drives: Array

    def any(self) -> bool:
        """Whether anything acts at all."""
        return bool(self.activation.any() or self.loads.any() or self.drives.any())

    def minus(self, other: Imposed) -> Imposed:
        """What acts in addition to another one."""
        return Imposed(
            self.activation - other.activation, self.loads - other.loads, self.drives - other.drives
        )

    def towards(self, other: Imposed, weight: float) -> Imposed:
        """Between this (weight 0) and another one (weight 1); beyond, it goes on."""
        rest = 1.0 - weight
        return Imposed(
            weight * other.activation + rest * self.activation,
            weight * other.loads + rest * self.loads,
            weight * other.drives + rest * self.drives,
        )
