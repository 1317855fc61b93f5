"""Orders of schemes for waves in space and time, from tables of errors.

A table has the columns degree, elements, steps, scheme and general, and errors. Rows with 0 steps hold
errors in space alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from workflows.verification.collocated import observed_order, theory
from workflows.workflow import Quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from stages.artefacts import StudyTable
    from stages.electrophysiology.schemes.base import Scheme
    from stages.numerics.bsplines import Array

SCHEMES = ("cn-ab2", "strang")
"""Schemes in time by their number in the tables."""

TIME_ORDER = 2
"""Of every scheme."""


def space_errors(table: StudyTable, column: str, degree: int) -> tuple[Array, Array]:
    """Spans per direction, and errors."""
    chosen = (table.column("steps") == 0) & (table.column("degree") == degree)
    return table.column("elements")[chosen], table.column(column)[chosen]


def time_errors(table: StudyTable, column: str, scheme: int, general: bool) -> tuple[Array, Array]:
    """Numbers of steps, and errors."""
    chosen = (table.column("steps") > 0) & (table.column("scheme") == scheme)
    chosen &= table.column("general") == general
    return table.column("steps")[chosen], table.column(column)[chosen]


def ways(table: StudyTable) -> list[tuple[int, bool]]:
    """Schemes and solvers in the table."""
    timed = table.column("steps") > 0
    pairs = zip(table.column("scheme")[timed], table.column("general")[timed], strict=True)
    return sorted({(int(scheme), bool(general)) for scheme, general in pairs})


def degrees(table: StudyTable) -> list[int]:
    """Degrees for which there are errors in space."""
    return sorted(set(table.column("degree")[table.column("steps") == 0].astype(int).tolist()))


def number_of(scheme: Scheme) -> int:
    """What stands for a scheme in a table."""
    return SCHEMES.index(scheme.name)


def order_quantities(table: StudyTable, column: str, round_off: float) -> dict[str, Quantity]:
    """Every order, with what theory says."""
    found = {
        f"order_p{degree}": Quantity(
            observed_order(*space_errors(table, column, degree), round_off),
            "",
            f"order in space, theory {theory(degree)}",
        )
        for degree in degrees(table)
    }
    for scheme, general in ways(table):
        solver = "general" if general else "fast"
        name = SCHEMES[scheme]
        found[f"time_order_{name}_{solver}"] = Quantity(
            observed_order(*time_errors(table, column, scheme, general), round_off),
            "",
            f"order in time of {name}, {solver} solver, theory {TIME_ORDER}",
        )
    return found


def behind(table: StudyTable, column: str, round_off: float) -> float:
    """How far an order falls behind the theory at most."""
    in_space = [
        theory(degree) - observed_order(*space_errors(table, column, degree), round_off)
        for degree in degrees(table)
    ]
    in_time = [
        TIME_ORDER - observed_order(*time_errors(table, column, *way), round_off)
        for way in ways(table)
    ]
    return max(0.0, *in_space, *in_time)


def draw_orders(table: StudyTable, figure: Figure, column: str, label: str) -> None:
    """Errors over spans and over steps, beside the slopes of the theory."""
    import numpy as np

    space, time = figure.subplots(1, 2)
    for degree in degrees(table):
        order = theory(degree)
        _draw(space, *space_errors(table, column, degree), order, f"p = {degree}: order {order}")
    for scheme, general in ways(table):
        solver = "general" if general else "fast"
        n, error = time_errors(table, column, scheme, general)
        _draw(time, n, error, TIME_ORDER, f"{SCHEMES[scheme]}, {solver}", "x" if general else "o")
    space.set(xlabel="knot spans", ylabel=label)
    time.set(xlabel="time steps")
    for axes, column in ((space, "elements"), (time, "steps")):
        timed = table.column("steps") > 0
        ticks = np.unique(table.column(column)[timed if axes is time else ~timed]).astype(int)
        axes.set_xticks(ticks, [str(n) for n in ticks])
        axes.minorticks_off()
        axes.legend(fontsize=8)


def _draw(axes: Axes, n: Array, error: Array, order: int, label: str, marker: str = "o") -> None:
    style = "none" if marker == "x" else "-"  # solvers agree: crosses lie on the circles
    (line,) = axes.loglog(n, error, marker, ls=style, ms=5, label=label)
    axes.loglog(n, error[0] * (n[0] / n) ** order, color=line.get_color(), lw=0.8, ls=":")
