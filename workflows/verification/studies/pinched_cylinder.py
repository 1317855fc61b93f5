"""Pinched cylinder on rigid diaphragms: two opposite point forces squeeze it in the middle.

One eighth of the cylinder, exact by NURBS, between three planes of symmetry and a diaphragm. Compared is
the displacement under the force, with the value of the literature and with the double Fourier series of
the same shell theory (:mod:`workflows.theory.pinched_cylinder`).

References
----------
T. Belytschko et al., Stress projection for membrane and shear locking in shell finite elements, Comput.
Methods Appl. Mech. Eng. 51 (1985): 1.8248e-5, that is E t w/F = 164.24. The series sums to 164.54; with 130
waves only, it gives the value of the literature.
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


class PinchedCylinderConfig(LinearShellConfig):
    """The cylinder and its load."""

    radius: float = quantity("mm", "radius of the cylinder", OBSTACLES, gt=0)
    length: float = quantity("mm", "length of the whole cylinder", OBSTACLES, gt=0)
    force: float = quantity("mN", "each of the two forces", OBSTACLES, gt=0)


@stage
def pinched_cylinder(config: PinchedCylinderConfig, *, run: StageRun) -> StudyTable:
    """Displacement under the force, inwards."""
    import numpy as np

    from stages.mechanics.supports.hinged import Hinged
    from stages.mechanics.supports.symmetry import Symmetry
    from stages.numerics.shapes import cylindrical_panel
    from workflows.verification.linear_shells import point

    inwards = 0.0, 0.0, -1.0
    cylinder = LinearShell(
        cylindrical_panel(config.radius, 0.5 * config.length, (0.0, 90.0)),
        {
            "end": Hinged(edge="X=0", components=("y", "z")),
            "middle": Symmetry(edge="X=L1"),
            "top": Symmetry(edge="Y=0"),
            "side": Symmetry(edge="Y=L2"),
        },
        lambda shell: 0.25 * config.force * point(shell.patch, (1.0, 0.0), inwards),
        lambda patch: point(patch, (1.0, 0.0), inwards),
    )
    table = converge(config, cylinder, run)
    return StudyTable(
        columns=(*table.columns, "series"),
        units=(*table.units, "mm"),
        values=np.column_stack((table.values, np.full(len(table.values), _series(config)))),
    )


def _series(config: PinchedCylinderConfig) -> float:
    from workflows.theory.pinched_cylinder import PinchedCylinder

    return PinchedCylinder(
        config.radius,
        config.length,
        config.thickness,
        config.young_modulus,
        config.poisson_ratio,
        config.force,
    ).displacement()


def quantities(table: StudyTable) -> dict[str, Quantity]:
    """All displacements; the finest against the literature and against the series."""
    found, series = float(table.column("displacement")[-1]), float(table.column("series")[-1])
    return common(table) | {
        "relative_error": relative_error(table, "finest against 1.8248e-5", limit=3e-3),
        "series": Quantity(series, "mm", "double Fourier series of the same theory"),
        "series_error": Quantity(found / series - 1.0, "", "finest against the series", limit=5e-4),
    }


STUDY = Study(
    name="pinched-cylinder",
    title="Pinched cylinder with diaphragms: displacement under the force, degrees 2 to 4, against 1.8248e-5 "
    "(Belytschko et al., 1985)",
    stage=pinched_cylinder,
    draw=draw,
    quantities=quantities,
)
