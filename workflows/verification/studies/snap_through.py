"""Hinged shallow cylindrical panel under a point load: past its limit points by arc length.

The straight edges are hinged, the curved ones free, and the load pushes the middle inwards: the panel snaps
through. The thick one passes two limit loads, the thin one also snaps back: its deflection decreases in
between. A quarter is computed, with symmetry.

References
----------
K. Y. Sze, X. H. Liu, S. H. Lo, Popular benchmark problems for geometric nonlinear analysis of shells, Finite
Elem. Anal. Des. 40 (2004) 1551-1569, Table 9: P against deflection; the greatest load tabulated on the first
rise is 0.7421 (0.1953) of 3000 N at a deflection of 11.293 (12.892) mm, by thick-shell elements of
Abaqus (S4R). They are points of the path near its limit point, not the limit point itself.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from pipeline.nodes import StageRun, stage
from stages.artefacts import StudyTable
from stages.configuration import Count, Section, quantity, setting
from workflows.verification.study import Study
from workflows.workflow import Quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stages.mechanics.body.body import Body
    from stages.numerics.bsplines import Array

SOURCE = "Sze et al. (2004)"

REGULAR, LIMIT, BIFURCATION = 0.0, 1.0, 2.0


class SnapThroughConfig(Section):
    """The panel, its thicknesses, and the mesh of a quarter."""

    radius: float = quantity("mm", "radius of the cylinder", SOURCE, gt=0)
    length: float = quantity("mm", "length of the straight edges", SOURCE, gt=0)
    half_angle: float = quantity("", "half the opening of the arc, radians", SOURCE, gt=0)
    thicknesses: tuple[float, ...] = quantity("mm", "thicknesses", SOURCE)
    young_modulus: float = quantity("kPa", "Young's modulus; 1 kPa for 1 MPa", SOURCE, gt=0)
    poisson_ratio: float = quantity("", "Poisson's ratio", SOURCE, ge=0, lt=0.5)
    published_loads: tuple[float, ...] = quantity(
        "mN", "tabulated load near the limit, for each thickness", "Sze et al. (2004), Table 9"
    )
    published_deflections: tuple[float, ...] = quantity(
        "mm", "deflection at that load", "Sze et al. (2004), Table 9"
    )
    deflection: float = quantity("mm", "where the path ends", SOURCE, gt=0)
    degree: int = setting("degree of the splines", "this project", ge=2)
    elements: Count = setting("elements per side of a quarter", "this project")


@stage
def snap_through(config: SnapThroughConfig, *, run: StageRun) -> StudyTable:
    """Points of the path for each thickness; limit points and bifurcations marked."""
    import numpy as np

    rows: list[tuple[float, ...]] = []
    for done, thickness in enumerate(config.thicknesses):
        published = config.published_loads[done], config.published_deflections[done]
        for row in _path(config, thickness):
            rows.append((thickness, *row, *published))
            run.tell(f"thickness {thickness:g} mm: load {row[0]:.2f}, deflection {row[1]:.4f} mm")
        run.progress(done + 1, len(config.thicknesses))
    return StudyTable(
        columns=(
            "thickness",
            "load",
            "deflection",
            "kind",
            "unstable_directions",
            "iterations",
            "published_load",
            "published_deflection",
        ),
        units=("mm", "mN", "mm", "", "", "", "mN", "mm"),
        values=np.array(rows),
    )


def _path(config: SnapThroughConfig, thickness: float) -> list[tuple[float, ...]]:
    """Load, deflection, kind of point, unstable directions and iterations."""
    import numpy as np

    from stages.mechanics.statics.loading import Loading
    from stages.numerics.branches import ArcControls, BranchPoint
    from stages.numerics.continuation import Branch
    from stages.numerics.critical import PathEnd, trace
    from stages.numerics.newton import NewtonControls

    body = panel(config, thickness)
    middle = 2  # Z of the first control point, which is the middle of the panel

    def row(point: BranchPoint, kind: float) -> tuple[float, ...]:
        unstable = point.unstable_directions or 0
        return (point.load, -point.x[middle], kind, float(unstable), float(point.iterations))

    size = body.shell.size
    loading = Loading(body, body.nothing(), body.imposed_at(0.0, np.zeros(body.shell.points)))
    controls = NewtonControls(body.shell.extent, 1e-7, 1e-8, 1e-9, max_iterations=15)
    scale = config.young_modulus * thickness**2 / config.radius
    branch, start = Branch.begin(
        loading, np.zeros(size), 0.0, controls, ArcControls(scale, max_turn=20.0)
    )
    rows = [row(start, REGULAR)]
    end = PathEnd.at_unknown(-config.deflection, middle, size)
    for found in trace(branch, start, end, max_points=300):
        kinds = {"limit point": LIMIT, "bifurcation": BIFURCATION}
        rows += [row(critical.point, kinds[critical.kind]) for critical in found.passed]
        rows.append(row(found.point, REGULAR))
    return rows


def panel(config: SnapThroughConfig, thickness: float) -> Body:
    """A quarter of the panel under a quarter of a load of one."""
    import math

    from stages.artefacts import Laminate, Layer
    from stages.mechanics.body.body import Body
    from stages.mechanics.loads.point import PointLoad
    from stages.mechanics.materials.st_venant_kirchhoff import StVenantKirchhoff
    from stages.mechanics.shell.shell import build_shell
    from stages.mechanics.supports.hinged import Hinged
    from stages.mechanics.supports.symmetry import Symmetry
    from stages.numerics.shapes import cylindrical_panel
    from stages.time_laws.constant import Constant

    angles = (0.0, math.degrees(config.half_angle))
    shape = cylindrical_panel(config.radius, 0.5 * config.length, angles)
    patch = shape.refine(config.degree, (config.elements, config.elements))
    solid = StVenantKirchhoff(
        density=1.0, young_modulus=config.young_modulus, poisson_ratio=config.poisson_ratio
    )
    laminate = Laminate((Layer("panel", "solid", thickness, 0.0, 0.0),))
    push = PointLoad(parameters=(0.0, 0.0), force=(0.0, 0.0, -0.25), time_law=Constant())
    return Body.held(
        build_shell(patch, laminate, {"solid": solid}),
        {
            "across": Symmetry(edge="X=0"),
            "along": Symmetry(edge="Y=0"),
            "hinge": Hinged(edge="Y=L2"),
        },
        {"push": push},
    )


def of_thickness(table: StudyTable, thickness: float) -> tuple[Array, Array, Array]:
    """Deflection, load and kind along the path of one thickness."""
    mine = table.column("thickness") == thickness
    return (
        table.column("deflection")[mine],
        table.column("load")[mine],
        table.column("kind")[mine],
    )


def quantities(table: StudyTable) -> dict[str, Quantity]:
    """Limit points of every thickness; the first load against the published one."""
    found = {}
    for thickness in sorted(set(table.column("thickness")), reverse=True):
        deflection, load, kind = of_thickness(table, thickness)
        limits = kind == LIMIT
        label = f"t{thickness:g}".replace(".", "_")
        found[f"limit_loads_{label}"] = Quantity(
            [float(value) for value in load[limits]], "mN", f"limit loads, {thickness:g} mm thick"
        )
        found[f"limit_deflections_{label}"] = Quantity(
            [float(value) for value in deflection[limits]], "mm", "deflections at these loads"
        )
        published = table.column("published_load")[table.column("thickness") == thickness][0]
        found[f"deviation_{label}"] = Quantity(
            float(load[limits][0] / published - 1.0),
            "",
            "first limit load against the greatest published load of the first rise",
            limit=0.02,
        )
    return found


def draw(table: StudyTable, figure: Figure) -> None:
    """Load over deflection, with the limit points."""
    thicknesses = sorted(set(table.column("thickness")), reverse=True)
    for axes, thickness in zip(
        figure.subplots(1, len(thicknesses), squeeze=False)[0], thicknesses, strict=True
    ):
        deflection, load, kind = of_thickness(table, thickness)
        axes.plot(deflection, load, ".-", ms=4, lw=1.0, label="path")
        axes.plot(deflection[kind == LIMIT], load[kind == LIMIT], "o", ms=6, label="limit points")
        mine = table.column("thickness") == thickness
        axes.plot(
            table.column("published_deflection")[mine][0],
            table.column("published_load")[mine][0],
            "x",
            ms=8,
            color="#333333",
            label="Sze et al. (2004), near the limit",
        )
        axes.axhline(0.0, color="#9a9a9a", lw=0.8)
        axes.set(xlabel="deflection [mm]", ylabel="load", title=f"{thickness:g} mm thick")
        axes.legend(loc="upper left", fontsize=7)


STUDY = Study(
    name="snap-through",
    title="Hinged cylindrical panels under a point load: snap-through and snap-back by arc length "
    "(Sze et al. 2004)",
    stage=snap_through,
    draw=draw,
    quantities=quantities,
)
