"""Configuration of the active stress on the shell: taken over from the cells, or imposed."""

from __future__ import annotations

from typing import Literal

from stages.configuration import Section, quantity, setting
from stages.time_laws.base import AnyTimeLaw


class ActivationConfig(Section):
    """Section ``activation`` of a coupled workflow."""

    scale: float = quantity(
        "",
        "factor on the active stress (1: as the cells say; a drug may change it)",
        "this project",
        ge=0,
    )
    transfer: Literal["automatic", "spline", "shape-preserving"] = setting(
        "from the cells' points to the shell's: the spline through them, or a curve that stays between "
        "neighbouring values; automatic: the spline for degree 2 and 3 of the cells' mesh",
        "eq. 86",
        default="automatic",
    )

    def transfer_from(self, degree: int) -> Literal["spline", "shape-preserving"]:
        """The transfer to use from a mesh of that degree.

        Degree 4 and more allow meshes on which the tension switches on between two points; there the
        spline swings by half a kilopascal and falls below zero. For degree 2 and 3 the spline is kept,
        as published: fronts that these meet accurately are several points wide.

        Examples
        --------
        >>> ActivationConfig(scale=1.0).transfer_from(2), ActivationConfig(scale=1.0).transfer_from(4)
        ('spline', 'shape-preserving')
        """
        if self.transfer == "automatic":
            return "spline" if degree <= 3 else "shape-preserving"
        return self.transfer


class TransferConfig(Section):
    """What the stage needs: factor, kind of transfer, the shell's time grid and its quadrature."""

    scale: float = quantity("", "factor on the active stress", "this project", ge=0)
    transfer: Literal["spline", "shape-preserving"] = setting(
        "from the cells' points to the shell's", "eq. 86"
    )
    duration: float = quantity("ms", "simulated time of the mechanics", "sec. 4.3", gt=0)
    n_steps: int = setting("time steps of the mechanics", "sec. 4.3", ge=1)
    points: int = setting("in-plane Gauss points per element and direction", "sec. 3.1", ge=1)


class ImposedActivationConfig(Section):
    """Section ``activation`` of a workflow without cells: the same everywhere on the film."""

    peak_stress: float = quantity(
        "kPa", "size P of the imposed activation", "Table 2, eq. 96", ge=0
    )
    time_law: AnyTimeLaw = setting("course q(t) of the activation, by name", "eqs. 96, 103")


class ImposedFieldConfig(ImposedActivationConfig):
    """What the stage needs: the activation, the shell's time grid and its in-plane quadrature."""

    duration: float = quantity("ms", "simulated time of the mechanics", "sec. 4.2", gt=0)
    n_steps: int = setting("time steps of the mechanics", "sec. 4.2", ge=1)
    points: int = setting("in-plane Gauss points per element and direction", "sec. 3.1", ge=1)
