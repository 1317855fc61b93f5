"""Pinched hemisphere: two pairs of opposite radial forces at the equator, outwards and inwards.

A quarter of the hemisphere, exact by NURBS, between two planes of symmetry; the equator is free. The patch
shrinks to a point at the pole unless there is a hole. Compared is the radial displacement under the force.

References
----------
L. S. D. Morley, A. J. Morris, Conflict between finite elements and shell theory, Royal Aircraft Establishment
(1978); T. Belytschko et al., Comput. Methods Appl. Mech. Eng. 51 (1985): 0.0924 for the closed hemisphere.
R. H. MacNeal, R. L. Harder, Finite Elem. Anal. Des. 1 (1985): 0.0940 with a hole of 18 degrees.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

from pipeline.nodes import StageRun, stage
from stages.artefacts import StudyTable
from stages.configuration import quantity
from stages.mechanics.supports.base import Support
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

if TYPE_CHECKING:
    from stages.numerics.patches import Patch
    from stages.numerics.ties import Relation


class HemisphereConfig(LinearShellConfig):
    """The hemisphere and its load."""

    radius: float = quantity("mm", "radius of the sphere", OBSTACLES, gt=0)
    hole: float = quantity(
        "", "opening at the pole, degrees from the axis; 0: closed", OBSTACLES, ge=0, lt=90
    )
    force: float = quantity("mN", "each of the four forces", OBSTACLES, gt=0)


class Pole(Support):
    """Planes of symmetry Y = 0 and X = 0 of an octant that shrinks to a point at the pole.

    There the edges have no frame, so the general support cannot find their planes. All control points of
    the last parallel are the pole; by symmetry it moves along Z only, which holds the whole, and the
    tangent plane there stays horizontal: the next parallel's control points keep the pole's height.
    """

    kind: Literal["pole"] = "pole"

    def relations(self, patch: Patch) -> Iterator[Relation]:
        """Even or odd displacements next to both meridians; the pole and its neighbours."""
        import numpy as np

        from stages.mechanics.actions.edges import control_rows
        from stages.mechanics.actions.relations import held, together

        for edge, normal, even in (("X=0", "y", (0, 2)), ("X=L1", "x", (1, 2))):
            first, second = control_rows(patch, edge)
            yield from held(first, normal)
            for k in even:
                yield from together(first, second, np.tile(np.eye(3)[k], (first.size, 1)))
        pole, next_to_it = control_rows(patch, "Y=L2")
        yield from held(pole)
        yield from held(next_to_it, "z")


@stage
def hemisphere(config: HemisphereConfig, *, run: StageRun) -> StudyTable:
    """Radial displacement under the force that pulls outwards."""
    from stages.mechanics.supports.point import Point
    from stages.mechanics.supports.symmetry import Symmetry
    from stages.numerics.shapes import spherical_panel
    from workflows.verification.linear_shells import point

    outwards, inwards = (1.0, 0.0, 0.0), (0.0, -1.0, 0.0)
    planes = {"Y=0": Symmetry(edge="X=0"), "X=0": Symmetry(edge="X=L1")}
    rim = config.radius * math.sin(math.radians(config.hole))
    quarter = LinearShell(
        spherical_panel(config.radius, (0.0, 90.0), (0.0, 90.0 - config.hole)),
        {**planes, "height": Point(position=(rim, 0.0), z=0.0)} if rim else {"pole": Pole()},
        lambda shell: (
            0.5
            * config.force
            * (point(shell.patch, (0.0, 0.0), outwards) + point(shell.patch, (1.0, 0.0), inwards))
        ),
        lambda patch: point(patch, (0.0, 0.0), outwards),
    )
    return converge(config, quarter, run)


def quantities(table: StudyTable) -> dict[str, Quantity]:
    """All displacements; the finest against the reference, which has three digits."""
    error = relative_error(table, "finest displacement against the reference", limit=1e-3)
    return common(table) | {"relative_error": error}


STUDY = Study(
    name="hemisphere",
    title="Pinched hemisphere: radial displacement under the force, degrees 2 to 4, against 0.0924 (Morley "
    "and Morris, 1978; Belytschko et al., 1985)",
    stage=hemisphere,
    draw=draw,
    quantities=quantities,
)
