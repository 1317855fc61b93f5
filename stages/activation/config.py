"""Configuration of the transfer of active stress to the shell."""

from __future__ import annotations

from stages.configuration import Section, quantity, setting


class ActivationConfig(Section):
    """Section ``activation`` of a coupled workflow."""

    scale: float = quantity(
        "",
        "factor on the active stress (1: as the cells say; a drug may change it)",
        "this project",
        ge=0,
    )


class TransferConfig(Section):
    """What the stage needs: the factor, the shell's time grid and its in-plane quadrature."""

    scale: float = quantity("", "factor on the active stress", "this project", ge=0)
    duration: float = quantity("ms", "simulated time of the mechanics", "sec. 4.3", gt=0)
    n_steps: int = setting("time steps of the mechanics", "sec. 4.3", ge=1)
    points: int = setting("in-plane Gauss points per element and direction", "sec. 3.1", ge=1)
