"""Scordelis-Lo roof: a cylindrical roof on rigid diaphragms under its own weight.

The whole roof, exact by NURBS, with as many elements along the axis as along the arc. Compared is the
vertical displacement, downwards, of the middle of the free edge.

References
----------
A. C. Scordelis, K. S. Lo, Computer analysis of cylindrical shells, J. Am. Concr. Inst. 61 (1964): 0.3024 by
deep-shell theory; T. Belytschko et al., Comput. Methods Appl. Mech. Eng. 51 (1985); J. Kiendl et al., Comput.
Methods Appl. Mech. Eng. 198 (2009): 0.3006 for Kirchhoff-Love shells of NURBS.
"""

from __future__ import annotations

from pipeline.nodes import StageRun, stage
from stages.artefacts import StudyTable
from stages.configuration import quantity
from workflows.verification.linear_shells import (
    OBSTACLES,
    LinearShell,
    LinearShellConfig,
    converge,
    draw,
    relative_error,
)
from workflows.verification.linear_shells import quantities as common
from workflows.verification.study import Study
from workflows.workflow import Quantity


class ScordelisLoConfig(LinearShellConfig):
    """The roof and its load."""

    radius: float = quantity("mm", "radius of the cylinder", OBSTACLES, gt=0)
    length: float = quantity("mm", "length along the axis", OBSTACLES, gt=0)
    opening: float = quantity("", "opening of the arc, degrees", OBSTACLES, gt=0, lt=180)
    load: float = quantity("kPa", "dead load per area, downwards", OBSTACLES, gt=0)


@stage
def scordelis_lo(config: ScordelisLoConfig, *, run: StageRun) -> StudyTable:
    """Displacement of the middle of the free edge, downwards.

    The walls at both ends are stiff in their own plane and free along X; the top of the middle arc
    keeps the roof from sliding.
    """
    from stages.mechanics.supports.hinged import Hinged
    from stages.mechanics.supports.point import Point
    from stages.numerics.shapes import cylindrical_panel
    from workflows.verification.linear_shells import area_load, point

    half = 0.5 * config.opening
    roof = LinearShell(
        cylindrical_panel(config.radius, config.length, (-half, half)),
        {
            "front": Hinged(edge="X=0", components=("y", "z")),
            "back": Hinged(edge="X=L1", components=("y", "z")),
            "middle": Point(position=(0.5 * config.length, 0.0), x=0.0),
        },
        lambda shell: area_load(shell, (0.0, 0.0, -config.load)),
        lambda patch: point(patch, (0.5, 1.0), (0.0, 0.0, -1.0)),
    )
    return converge(config, roof, run)


def quantities(table: StudyTable) -> dict[str, Quantity]:
    """All displacements; the finest against the reference, which has six digits."""
    error = relative_error(table, "finest displacement against 0.300592", limit=5e-6)
    return common(table) | {"relative_error": error}


STUDY = Study(
    name="scordelis-lo",
    title="Scordelis-Lo roof: vertical displacement of the free edge, degrees 2 to 4, against 0.300592 of "
    "Kirchhoff-Love theory",
    stage=scordelis_lo,
    draw=draw,
    quantities=quantities,
)
