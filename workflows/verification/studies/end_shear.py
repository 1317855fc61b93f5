"""Cantilever under a dead transverse force at its end, up to P L^2/EI = 4.

The reference is the elastica in elliptic integrals, and sharper still the same strip with the stretching
that the shell has (``workflows.theory.elastica.sheared_shell``).

References
----------
Sze, Liu and Lo (2004), Popular benchmark problems for geometric nonlinear analysis of shells, Finite Elem.
Anal. Des. 40, 1551: cantilever subjected to end shear force, computed with a commercial code (quoted
after the test suite of Elmer FEM); 0.1 % off the elastica. Mattiasson (1981), Int. J. Numer. Meth.
Engng 17, 145, has the elastica at P L^2/EI = 1, 2, ..., 10 (quoted after the test suites of other codes).
Neither table was read in the original.
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


class EndShearConfig(CantileverConfig):
    """The strip and its largest force."""

    force: float = quantity("kPa*mm^2", "largest end force", "Sze, Liu and Lo (2004)", gt=0)


@stage
def end_shear(config: EndShearConfig, *, run: StageRun) -> StudyTable:
    """Tip under growing forces."""
    from stages.mechanics.loads.edge_traction import EdgeTraction
    from stages.time_laws.constant import Constant
    from workflows.theory.elastica import sheared, sheared_shell

    strip, force = config.strip, config.force
    traction = (0.0, 0.0, force / config.width)
    load = EdgeTraction(edge="X=L1", traction=traction, time_law=Constant())
    return compare(
        config,
        load,
        lambda fraction: sheared_shell(strip, fraction * force),
        lambda fraction: sheared(strip, fraction * force),
        run,
    )


def quantities(table: StudyTable) -> dict[str, Quantity]:
    """The published table is 0.1 % off the elastica."""
    return cantilever_quantities(table, exact=1e-7, published=0.005)


def draw(table: StudyTable, figure: Figure) -> None:
    """Tip over force, and convergence."""
    draw_cantilever(table, figure, "end force / 4 EI/L$^2$")


STUDY = Study(
    name="end-shear",
    title="Cantilever under end shear: shell against the elastica (Mattiasson, 1981; Sze, Liu and Lo, "
    "2004)",
    stage=end_shear,
    draw=draw,
    quantities=quantities,
)
