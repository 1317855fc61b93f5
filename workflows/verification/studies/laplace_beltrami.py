"""Diffusion on curved surfaces by collocation: cylinder, tube and sphere, with and without fibres.

v - R^2 div(D grad v) = q with D grad v given on every edge, where v is a wave in closed form: an eigenfunction
of the Laplace-Beltrami operator where the tissue is isotropic, and a manufactured solution where it conducts
better along fibres that wind around the tube or climb the sphere. The tube is closed: nothing is given on its
seam. Collocation at Greville points converges at order p for even and p - 1 for odd degree.

References
----------
Eqs. 8-9 and 75-77; Auricchio, Beirao da Veiga, Hughes, Reali, Sangalli (2010), Isogeometric collocation
methods, Math. Models Methods Appl. Sci. 20, 2075, for the orders.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from pipeline.nodes import StageRun, stage
from stages.artefacts import StudyTable
from stages.configuration import Count, Section, quantity, setting
from workflows.verification.collocated import observed_order, theory
from workflows.verification.study import Study
from workflows.workflow import Quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    from stages.numerics.bsplines import Array
    from stages.numerics.diffusivity import Diffusivity
    from stages.numerics.patches import Patch
    from workflows.theory.surface_waves import Wave

PROBLEMS = ("cylinder", "tube", "sphere", "tube with fibres", "sphere with fibres")
"""By their number in the table."""

Degree = Annotated[int, Field(ge=2)]


class LaplaceBeltramiConfig(Section):
    """Surfaces, fibres and meshes."""

    radius: float = quantity("mm", "radius of cylinder, tube and sphere", "this project", gt=0)
    length: float = quantity("mm", "length of cylinder and tube", "this project", gt=0)
    arc: tuple[float, float] = quantity("degree", "arc of the open cylinder", "this project")
    longitudes: tuple[float, float] = quantity("degree", "part of the sphere", "this project")
    latitudes: tuple[float, float] = quantity("degree", "part of the sphere", "this project")
    waves_along: float = quantity("", "waves along the cylinder", "this project", gt=0)
    waves_around: Count = setting("waves around the cylinder", "this project")
    transverse_ratio: float = quantity(
        "", "diffusivity across the fibres over that along them", "this project", gt=0
    )
    fibre_angle: float = quantity("degree", "angle of the fibres from theta1", "this project")
    degrees: tuple[Degree, ...] = setting("degrees of the splines", "this project")
    elements: tuple[Count, ...] = setting("knot spans along; twice as many around a tube")


@stage
def laplace_beltrami(config: LaplaceBeltramiConfig, *, run: StageRun) -> StudyTable:
    """Relative L2 error of every problem and mesh."""
    import numpy as np

    meshes = [
        (problem, degree, n)
        for problem in range(len(PROBLEMS))
        for degree in config.degrees
        for n in config.elements
    ]
    rows = []
    for problem, degree, n in meshes:
        rows.append((problem, degree, n, _error(config, PROBLEMS[problem], degree, n)))
        run.progress(len(rows), len(meshes))
    return StudyTable(
        ("problem", "degree", "elements", "error"), ("", "", "", ""), np.array(rows, dtype=float)
    )


def _error(config: LaplaceBeltramiConfig, problem: str, degree: int, n: int) -> float:
    import numpy as np
    from scipy.sparse import diags_array
    from scipy.sparse.linalg import spsolve

    from stages.numerics.collocation import collocate
    from workflows.verification.collocated import edge_data, relative_error

    patch = surface(config, problem.split()[0], degree, n)
    diffusivity, wave = tissue(config, problem)
    operators = collocate(patch, diffusivity)
    exact = wave.at(operators.frame.position)
    inside = diags_array(operators.interior.astype(float))
    square = config.radius**2
    matrix = inside @ (operators.values - square * operators.laplacian) + operators.flux
    right = np.where(operators.interior, exact.value - square * exact.diffused, 0.0)
    control = spsolve(matrix.tocsc(), right + edge_data(operators, exact.flux))
    return relative_error(patch, control, lambda position: wave.at(position).value)


def surface(config: LaplaceBeltramiConfig, shape: str, degree: int, n: int) -> Patch:
    """The surface of a problem on its mesh."""
    from stages.numerics.bsplines import SplineSpace
    from stages.numerics.shapes import cylindrical_panel, spherical_panel
    from stages.numerics.tubes import closed_tube

    if shape == "tube":
        spaces = SplineSpace.uniform(degree, n), SplineSpace.uniform(degree, 2 * n)
        return closed_tube(config.radius, config.length, *spaces)
    if shape == "cylinder":
        panel = cylindrical_panel(config.radius, config.length, config.arc)
    else:
        panel = spherical_panel(config.radius, config.longitudes, config.latitudes)
    return panel.refine(degree, (n, n))


def tissue(config: LaplaceBeltramiConfig, problem: str) -> tuple[Diffusivity, Wave]:
    """Diffusivity and exact solution of a problem."""
    import math

    from stages.numerics.diffusivity import along_fibres, isotropic
    from workflows.theory.surface_waves import CylinderWave, SphereWave

    fibres = problem.endswith("fibres")
    ratio = config.transverse_ratio if fibres else 1.0
    angle = math.radians(config.fibre_angle) if fibres else 0.0
    wave: Wave
    if problem.startswith("sphere"):
        wave = SphereWave(config.radius, ratio, angle)
    else:
        along = 2.0 * math.pi * config.waves_along / config.length
        wave = CylinderWave(config.radius, along, config.waves_around, ratio, angle)
    return along_fibres(ratio, config.fibre_angle) if fibres else isotropic, wave


def series(table: StudyTable, problem: int, degree: int) -> tuple[Array, Array]:
    """Elements and errors of one problem and degree."""
    chosen = (table.column("problem") == problem) & (table.column("degree") == degree)
    return table.column("elements")[chosen], table.column("error")[chosen]


def orders(table: StudyTable) -> dict[tuple[int, int], float]:
    """Observed order by problem and degree."""
    pairs = sorted({(int(row[0]), int(row[1])) for row in table.values})
    return {pair: observed_order(*series(table, *pair)) for pair in pairs}


def quantities(table: StudyTable) -> dict[str, Quantity]:
    """Observed orders, and how far they fall behind the theory at most."""
    found = orders(table)
    listed = {
        f"{PROBLEMS[problem].replace(' ', '_')}.order_p{degree}": Quantity(
            order, "", f"observed order on the {PROBLEMS[problem]}, theory {theory(degree)}"
        )
        for (problem, degree), order in found.items()
    }
    behind = max(0.0, *(theory(degree) - order for (_, degree), order in found.items()))
    return listed | {
        "order_deficit": Quantity(
            behind, "", "how far an order falls behind the theory at most", limit=0.3
        )
    }


def draw(table: StudyTable, figure: Figure) -> None:
    """A panel for each problem: error over the number of spans; dotted lines have the slopes of theory."""
    panels = figure.subplots(2, 3, sharex=True, sharey=True).ravel()
    handles: list[Line2D] = []
    for problem, (axes, name) in enumerate(zip(panels, PROBLEMS, strict=False)):
        handles = []
        for degree in sorted(set(table.column("degree").astype(int).tolist())):
            n, error = series(table, problem, degree)
            label = f"p = {degree}: order {theory(degree)}"
            (line,) = axes.loglog(n, error, "o-", ms=4, label=label)
            ideal = error[-1] * (n[-1] / n) ** theory(degree)
            axes.loglog(n, ideal, color=line.get_color(), lw=0.8, ls=":")
            handles.append(line)
        axes.set(title=name, ylim=(1e-12, 2.0))
        axes.set_xticks(n, [f"{int(count)}" for count in n])
        axes.minorticks_off()
    for axes in (panels[0], panels[3]):
        axes.set_ylabel("relative L2 error")
    for axes in panels[2:5]:
        axes.set_xlabel("knot spans")
        axes.tick_params(labelbottom=True)
    panels[-1].axis("off")
    panels[-1].legend(handles=handles, loc="center", fontsize=9)


STUDY = Study(
    name="laplace-beltrami",
    title="Diffusion on a cylinder, a tube and a sphere, isotropic and along fibres: collocation against "
    "eigenfunctions and manufactured solutions",
    stage=laplace_beltrami,
    draw=draw,
    quantities=quantities,
    size=(9.5, 6.2),
)
