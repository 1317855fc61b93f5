"""Orders of convergence in space, on a smooth large deformation made up beforehand.

A square film is bent and stretched into a chosen smooth shape u by the forces that
this shape needs: a spline of degree 8 whose internal forces, integrated with 9 x 9 points per element, load
every mesh. As u solves the problem exactly, the error of a mesh is known. For degree p and element size h
it falls as

- h^(p-1) in the energy norm (e . K(u) e)^(1/2),
- h^(2(p-1)) in the potential energy,
- h^min(p+1, 2(p-1)) in displacement, L2 norm.

The last holds for the deflection, which is nearly all of the displacement here. Displacements in the plane
are much smaller, and fall as h^p in the end: the film is bent, so that stretching feels an error in
curvature (as the thickness times the curvature, 0.1 here).

References
----------
Strang and Fix (1973), An analysis of the finite element method, for problems of fourth order.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from pipeline.nodes import StageRun, stage
from stages.artefacts import StudyTable
from stages.configuration import Count, Section, quantity, setting
from stages.mechanics.config import AnyMaterial
from workflows.verification.study import Study
from workflows.workflow import Quantity

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from stages.mechanics.shell.shell import Shell
    from stages.numerics.bsplines import Array
    from stages.numerics.patches import Patch

EXACT_DEGREE = 8
NORMS = ("displacement", "energy_norm", "potential")


class MeshConvergenceConfig(Section):
    """The film, its made-up shape, and the meshes."""

    side: float = quantity("mm", "side of the square", "this project", gt=0)
    thickness: float = quantity("mm", "thickness", "this project", gt=0)
    material: AnyMaterial = setting("material of the film", "Table 1")
    fibre_angle: float = quantity("deg", "angle of its fibres from X", "this project")
    deflection: float = quantity("mm", "largest deflection of the shape, about", "this project")
    spans: Count = setting("knot spans of the shape per side", "this project")
    degrees: tuple[int, ...] = setting("degrees of the splines", "Figs B.1, C.1")
    elements: tuple[Count, ...] = setting("elements per side, multiples of `spans`", "this project")


@stage
def mesh_convergence(config: MeshConvergenceConfig, *, run: StageRun) -> StudyTable:
    """Errors of every mesh."""
    import numpy as np

    meshes = [(degree, n) for degree in config.degrees for n in config.elements]
    rows = []
    for degree, n in meshes:
        rows.append((degree, n, config.side / n, *_errors(config, degree, n)))
        run.progress(len(rows), len(meshes))
    return StudyTable(
        columns=("degree", "elements", "size", *NORMS),
        units=("", "", "mm", "mm^2", "(kPa mm^3)^1/2", "kPa mm^3"),
        values=np.array(rows, dtype=float),
    )


def _shape(config: MeshConvergenceConfig) -> Patch:
    """Control displacements of the exact solution, as the net of a patch."""
    import numpy as np

    from stages.numerics.patches import Patch

    square = Patch.rectangle(config.side, config.side)
    patch = square.refine(EXACT_DEGREE, (config.spans, config.spans))
    x, y = np.meshgrid(patch.first.greville(), patch.second.greville(), indexing="ij")
    sx, sy = np.sin(np.pi * x), np.sin(np.pi * y)
    u = config.deflection * np.stack(
        (
            0.15 * sx * np.cos(2 * np.pi * y),
            -0.1 * np.cos(np.pi * x) * sy,
            sx**2 * sy**2 * (1.0 + 0.5 * np.cos(np.pi * x)),
        ),
        axis=-1,
    )
    net = patch.interpolate(u.reshape(-1, 3)).control_points
    net[_held(patch)] = 0.0
    return patch.with_net(net)


def _held(patch: Patch) -> NDArray[np.bool_]:
    """Clamped all around, but free to slide along each edge, shape ``(m1, m2, 3)``.

    Held edges that may not slide would make the plane problem singular in the corners (as r^1.5), and
    displacements would converge no faster than h^(p + 1/2).
    """
    import numpy as np

    held = np.zeros(patch.control_points.shape, dtype=bool)
    held[[0, -1], :, 0] = held[:, [0, -1], 1] = True
    held[[0, 1, -2, -1], :, 2] = held[:, [0, 1, -2, -1], 2] = True
    return held


def _shell(config: MeshConvergenceConfig, patch: Patch) -> Shell:
    from stages.artefacts import Laminate, Layer
    from stages.mechanics.shell.shell import build_shell

    layer = Layer("film", "film", config.thickness, config.fibre_angle, 0.0)
    return build_shell(patch, Laminate((layer,)), {"film": config.material})


def _errors(config: MeshConvergenceConfig, degree: int, n: int) -> tuple[float, float, float]:
    """L2 norm of the displacement error, its energy norm, and the error of the potential energy."""
    import numpy as np

    from stages.numerics.patches import Patch
    from stages.numerics.quadrature import quadrature_grid

    patch = Patch.rectangle(config.side, config.side).refine(degree, (n, n))
    line = patch.first.elevate(
        EXACT_DEGREE - degree
    )  # holds the mesh's splines and the exact shape
    raise_ = patch.first.embed(line)

    def raised(net: Array) -> Array:
        return np.einsum("ai,bj,ijx->abx", raise_, raise_, net, optimize=True)

    fine = Patch(line, line, raised(patch.control_points))
    shape, judge = _shape(config), _shell(config, fine)
    refine = shape.first.embed(line)
    exact = np.einsum("ai,bj,ijx->abx", refine, refine, shape.control_points, optimize=True)
    silent = np.zeros(judge.points)
    target = judge.respond(exact.ravel(), silent)
    force = target.force.reshape(exact.shape)
    load = np.einsum("ai,bj,abx->ijx", raise_, raise_, force, optimize=True)
    start = patch.interpolate(shape.evaluate(patch.first.greville(), patch.second.greville()))
    found = raised(_solve(config, patch, load.ravel(), start.control_points))
    error = found - exact

    grid = quadrature_grid(fine, EXACT_DEGREE + 1)
    weights = (grid.weights1[:, None] * grid.weights2).ravel() * config.side**2
    distance = (fine.with_net(error).evaluate(grid.theta1, grid.theta2) ** 2).sum(axis=1)
    step = 1e-3  # of the error itself: K e as a central difference of the internal force
    ahead, behind = (
        judge.respond((exact + sign * step * error).ravel(), silent).force for sign in (1.0, -1.0)
    )
    energy = error.ravel() @ (ahead - behind) / (2.0 * step)
    gained = judge.respond(found.ravel(), silent).energy - target.energy
    return (
        float(np.sqrt(weights @ distance)),
        float(np.sqrt(energy)),
        float(gained - force.ravel() @ error.ravel()),
    )


def _solve(config: MeshConvergenceConfig, patch: Patch, load: Array, start: Array) -> Array:
    """Equilibrium of a mesh under fixed forces, from the interpolated exact shape."""
    import numpy as np

    from stages.numerics.newton import Linearisation, NewtonControls, newton

    shell, held = _shell(config, patch), _held(patch).ravel()
    silent = np.zeros(shell.points)

    def linearise(u: Array) -> Linearisation:
        response = shell.respond(u, silent)
        tangent = shell.tangent(response)
        return Linearisation(
            np.where(held, 0.0, response.force - load),
            lambda b: tangent.supported(held).factorise().solve(b),
            float(np.abs(tangent.diagonal).max()),
        )

    guess = np.where(held, 0.0, start.ravel())
    controls = NewtonControls(config.side, 1e-10, 1.0, 1e-9, max_iterations=25)
    return newton(linearise, guess, controls).x.reshape(start.shape)


def theory(degree: int) -> dict[str, int]:
    """Orders of convergence by norm.

    Examples
    --------
    >>> theory(2), theory(4)["displacement"]
    ({'displacement': 2, 'energy_norm': 1, 'potential': 2}, 5)
    """
    energy = degree - 1
    return {
        "displacement": min(degree + 1, 2 * energy),
        "energy_norm": energy,
        "potential": 2 * energy,
    }


def orders(table: StudyTable) -> dict[tuple[int, str], float]:
    """Observed orders by degree and norm, between the two finest meshes."""
    import numpy as np

    found = {}
    for degree in sorted(set(table.column("degree").astype(int).tolist())):
        chosen = table.column("degree") == degree
        size = np.log(table.column("size")[chosen][-2:])
        for norm in NORMS:
            error = np.log(table.column(norm)[chosen][-2:])
            found[degree, norm] = float((error[1] - error[0]) / (size[1] - size[0]))
    return found


def quantities(table: StudyTable) -> dict[str, Quantity]:
    """Observed orders, and how far they fall behind the theory at most."""
    found = orders(table)
    behind = max(theory(degree)[norm] - order for (degree, norm), order in found.items())
    listed = {
        f"{norm}_order_p{degree}": Quantity(
            order, "", f"order of the {norm.replace('_', ' ')}, theory {theory(degree)[norm]}"
        )
        for (degree, norm), order in found.items()
    }
    return listed | {
        "order_deficit": Quantity(
            max(behind, 0.0), "", "how far an order falls behind the theory at most", limit=0.1
        )
    }


def draw(table: StudyTable, figure: Figure) -> None:
    """Error over element size, a panel for each norm; thin lines have the theoretical slopes."""
    titles = {
        "displacement": "displacement, L2 [mm$^2$]",
        "energy_norm": "energy norm [(kPa mm$^3$)$^{1/2}$]",
        "potential": "potential energy [kPa mm$^3$]",
    }
    for axes, (norm, title) in zip(figure.subplots(1, 3), titles.items(), strict=True):
        for degree in sorted(set(table.column("degree").astype(int).tolist())):
            chosen = table.column("degree") == degree
            size, error = table.column("size")[chosen], table.column(norm)[chosen]
            order = theory(degree)[norm]
            (line,) = axes.loglog(size, error, "o-", ms=4, label=f"p = {degree}: order {order}")
            ideal = error[-1] * (size / size[-1]) ** order
            axes.loglog(size, ideal, color=line.get_color(), lw=0.8, ls=":")
        axes.set(xlabel="element size [mm]", title=f"error in {title}")
        axes.set_xticks(size, [f"{value:.2g}" for value in size])
        axes.minorticks_off()
        axes.legend(fontsize=8)


STUDY = Study(
    name="mesh-convergence",
    title="Convergence in space for degrees 2, 3 and 4 on a made-up smooth shape: shell against "
    "theory",
    stage=mesh_convergence,
    draw=draw,
    quantities=quantities,
    size=(11.0, 4.0),
)
