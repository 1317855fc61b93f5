"""Cantilever rolled into a full circle by a moment at its end.

The shell's own solution is exact for this problem too (``workflows.theory.elastica.rolled_shell``): an arc
that closes a little early, since a bent strip of St. Venant-Kirchhoff material shortens by (t/R)^2/12.

References
----------
Sze, Liu and Lo (2004), Popular benchmark problems for geometric nonlinear analysis of shells, Finite Elem.
Anal. Des. 40, 1551: cantilever subjected to end moment; their table is the elastica to three decimals (quoted
after the test suite of Elmer FEM).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from pipeline.nodes import StageRun, stage
from stages.artefacts import StudyTable
from stages.configuration import quantity
from workflows.verification.cantilever import (
    CantileverConfig,
    cantilever_quantities,
    compare,
    draw_cantilever,
)
from workflows.verification.study import Study
from workflows.workflow import Quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class RollUpConfig(CantileverConfig):
    """The strip and its largest moment."""

    moment: float = quantity(
        "kPa*mm^3", "largest end moment, 2 pi EI/L", "Sze, Liu and Lo (2004)", gt=0
    )


@stage
def roll_up(config: RollUpConfig, *, run: StageRun) -> StudyTable:
    """Tip under growing moments."""
    from stages.mechanics.loads.edge_moment import EdgeMomentLoad
    from stages.time_laws.constant import Constant
    from workflows.theory.elastica import rolled, rolled_shell

    strip, moment = config.strip, config.moment
    load = EdgeMomentLoad(edge="X=L1", moment=moment / config.width, time_law=Constant())
    return compare(
        config,
        load,
        lambda fraction: rolled_shell(strip, fraction * moment),
        lambda fraction: rolled(strip, fraction * moment),
        run,
    )


def quantities(table: StudyTable) -> dict[str, Quantity]:
    """The published table ignores the stretching, which moves the tip by 0.0055."""
    return cantilever_quantities(table, exact=1e-7, published=0.008)


def draw(table: StudyTable, figure: Figure) -> None:
    """Tip over moment, and convergence."""
    draw_cantilever(table, figure, "end moment / moment of a full circle")


STUDY = Study(
    name="roll-up",
    title="Cantilever rolled into a full circle by an end moment: shell against the exact arc (Sze, Liu "
    "and Lo, 2004)",
    stage=roll_up,
    draw=draw,
    quantities=quantities,
)
