"""Poisson's problem by collocation on a distorted square: orders of convergence (Appendix C, Fig. C.1).

Lap v = q on the square [0.3, 1.3]^2 with the skewed coordinates of Table C.1 and v = sin(pi x) sin(pi y); v
is given on the left edge, its normal derivative on the others. Collocation at Greville points converges at
order p for even and p - 1 for odd degree.

References
----------
Appendix C, eqs. C.1-C.3; Auricchio, Beirao da Veiga, Hughes, Reali, Sangalli (2010), Isogeometric collocation
methods, Math. Models Methods Appl. Sci. 20, 2075, for the orders.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from pipeline.nodes import StageRun, stage
from stages.artefacts import StudyTable
from stages.configuration import Count, Section, setting
from workflows.verification.collocated import edge_data, observed_order, relative_error, theory
from workflows.verification.study import Study
from workflows.workflow import Quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from stages.numerics.bsplines import Array
    from stages.numerics.patches import Patch


class PoissonConfig(Section):
    """Control points and meshes."""

    control_points: tuple[tuple[float, float], ...] = setting(
        "X and Y of the 3 x 3 control points of one biquadratic span, Y by Y", "Table C.1"
    )
    degrees: tuple[int, ...] = setting("degrees of the splines", "Fig. C.1")
    elements: tuple[Count, ...] = setting("knot spans per direction", "Fig. C.1")


@stage
def poisson(config: PoissonConfig, *, run: StageRun) -> StudyTable:
    """Relative L2 errors (eq. C.2) of every mesh; the field is that of the last."""
    import numpy as np

    square = _square(config)
    meshes = [(degree, n) for degree in config.degrees for n in config.elements]
    rows, sampled = [], np.empty(0)
    for degree, n in meshes:
        patch = square.refine(degree, (n, n))
        control = _solve(patch)
        error = relative_error(patch, control, lambda position: _solution(position)[0])
        rows.append((degree, n, error))
        sampled = _sampled(patch, control)
        run.progress(len(rows), len(meshes))
    table = np.array(rows, dtype=float)
    return StudyTable(("degree", "elements", "error"), ("", "", ""), table, sampled)


def _sampled(patch: Patch, control: Array) -> Array:
    """Position and field at 65 x 65 parameters, shape ``(65, 65, 4)``."""
    import numpy as np

    theta = np.linspace(0.0, 1.0, 65)
    n1, n2 = patch.first.evaluate(theta), patch.second.evaluate(theta)
    field = n1 @ control.reshape(patch.first.size, -1) @ n2.T
    position = patch.evaluate(theta, theta).reshape(65, 65, 3)
    return np.concatenate((position, field[..., None]), axis=2)


def _square(config: PoissonConfig) -> Patch:
    """The distorted square; the first direction runs along X."""
    import numpy as np

    from stages.numerics.bsplines import SplineSpace
    from stages.numerics.patches import Patch

    line = SplineSpace.uniform(2, 1)
    net = np.zeros((3, 3, 3))
    net[:, :, :2] = np.array(config.control_points).reshape(3, 3, 2).transpose(1, 0, 2)
    return Patch(line, line, net)


def _solve(patch: Patch) -> Array:
    """Control values of the solution."""
    import numpy as np
    from scipy.sparse import diags_array
    from scipy.sparse.linalg import spsolve

    from stages.numerics.collocation import collocate

    operators = collocate(patch)
    exact, slopes = _solution(operators.frame.position)
    given = np.zeros(patch.size, dtype=bool)
    given[operators.edges["X=0"]] = True
    matrix = (
        diags_array(operators.interior.astype(float)) @ operators.laplacian
        + diags_array((~given).astype(float)) @ operators.flux
        + diags_array(given.astype(float)) @ operators.values
    )
    right = np.where(operators.interior, -2.0 * np.pi**2 * exact, 0.0)
    right += edge_data(operators, slopes)
    return np.asarray(spsolve(matrix.tocsc(), np.where(given, exact, right)))


def _solution(position: Array) -> tuple[Array, Array]:
    """v and its gradient."""
    import numpy as np

    x, y = np.pi * position[:, 0], np.pi * position[:, 1]
    slopes = np.pi * np.stack((np.cos(x) * np.sin(y), np.sin(x) * np.cos(y), 0 * x), axis=1)
    return np.sin(x) * np.sin(y), slopes


def orders(table: StudyTable) -> dict[int, float]:
    """Observed order by degree, between the two finest meshes above round-off."""
    found = {}
    for degree in sorted(set(table.column("degree").astype(int).tolist())):
        chosen = table.column("degree") == degree
        found[degree] = observed_order(
            table.column("elements")[chosen], table.column("error")[chosen]
        )
    return found


def quantities(table: StudyTable) -> dict[str, Quantity]:
    """Observed orders, and how far they fall behind the theory at most."""
    found = orders(table)
    listed = {
        f"order_p{degree}": Quantity(order, "", f"observed order, theory {theory(degree)}")
        for degree, order in found.items()
    }
    behind = max(0.0, *(theory(degree) - order for degree, order in found.items()))
    return listed | {
        "order_deficit": Quantity(
            behind,
            "",
            "how far an order falls behind the theory at most; degrees 6 and 7 reach round-off first",
            limit=0.5,
        )
    }


def draw(table: StudyTable, figure: Figure) -> None:
    """Fig. C.1: (a) error over the number of spans, dotted with the slopes of theory; (b) the field."""
    axes, square = figure.subplots(1, 2, width_ratios=(1.2, 1.0))
    for degree in orders(table):
        chosen = table.column("degree") == degree
        n, error = table.column("elements")[chosen], table.column("error")[chosen]
        label = f"p = {degree}: order {theory(degree)}"
        (line,) = axes.loglog(n, error, "o-", ms=4, label=label)
        ideal = error[1] * (n[1] / n[1:]) ** theory(degree)
        axes.loglog(n[1:], ideal, color=line.get_color(), lw=0.8, ls=":")
    axes.set(xlabel="knot spans per direction", ylabel="relative L2 error", ylim=(1e-12, 1.0))
    axes.set_xticks(n, [f"{int(count)}" for count in n])
    axes.minorticks_off()
    axes.legend(fontsize=8)
    axes.set_title("(a)")
    if table.sampled is not None:
        _draw_field(table.sampled, square, figure)
        degree, n, _ = table.values[-1]
        square.set_title(f"(b) v with p = {int(degree)} on {int(n)} x {int(n)} spans")


def _draw_field(sampled: Array, axes: Axes, figure: Figure) -> None:
    """Field of the last mesh; the lines are every eighth part of the distorted parameters."""
    x, y, _, v = sampled.transpose(2, 0, 1)
    colours = axes.pcolormesh(x, y, v, shading="gouraud", rasterized=True)
    for i in range(0, len(x), 8):
        axes.plot(x[i], y[i], color="white", lw=0.5)
        axes.plot(x[:, i], y[:, i], color="white", lw=0.5)
    axes.set(aspect="equal", xlabel="X", ylabel="Y")
    figure.colorbar(colours, ax=axes, shrink=0.8)


STUDY = Study(
    name="poisson",
    title="Poisson's problem on a distorted square: collocation against the exact solution (Fig. C.1)",
    stage=poisson,
    draw=draw,
    quantities=quantities,
    size=(10.0, 4.4),
)
