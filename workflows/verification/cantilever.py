"""Cantilever strips bent far by a load at the end: the shell on several meshes beside closed forms."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from stages.artefacts import StudyTable
from stages.configuration import Count, Section, quantity, setting
from workflows.workflow import Quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pipeline.nodes import StageRun
    from stages.mechanics.loads.base import Load
    from stages.numerics.bsplines import Array
    from workflows.theory.elastica import Strip, Tip

CLOSED_FORMS = ("exact", "elastica", "published")


class CantileverConfig(Section):
    """A strip with nu = 0 in the units of its reference, published tips, and the meshes."""

    length: float = quantity("mm", "length", "Sze, Liu and Lo (2004)", gt=0)
    width: float = quantity("mm", "width", "Sze, Liu and Lo (2004)", gt=0)
    thickness: float = quantity("mm", "thickness", "Sze, Liu and Lo (2004)", gt=0)
    young_modulus: float = quantity("kPa", "Young's modulus", "Sze, Liu and Lo (2004)", gt=0)
    published: tuple[tuple[float, float, float], ...] = setting(
        "fraction of the largest load, -U_tip and W_tip, by growing fractions up to 1",
        "Sze, Liu and Lo (2004)",
    )
    degrees: tuple[int, ...] = setting("degrees of the splines", "this project")
    elements: tuple[Count, ...] = setting("elements along the strip", "this project")

    @property
    def strip(self) -> Strip:
        """For the closed forms."""
        from workflows.theory.elastica import Strip

        return Strip(self.length, self.width, self.thickness, self.young_modulus)


def compare(
    config: CantileverConfig,
    load: Load,
    exact: Callable[[float], Tip],
    elastica: Callable[[float], Tip],
    run: StageRun,
) -> StudyTable:
    """Tip of every mesh at every published fraction, beside that of the closed forms.

    Parameters
    ----------
    load
        The largest load.
    exact, elastica
        Tip of the shell and of the strip that does not stretch, at a fraction of the load.
    """
    import numpy as np

    meshes = [(degree, n) for degree in config.degrees for n in config.elements]
    fractions = [fraction for fraction, _, _ in config.published]
    closed = [
        [exact(f).shortening, exact(f).deflection, elastica(f).shortening, elastica(f).deflection]
        for f in fractions
    ]
    rows = []
    for number, (degree, n) in enumerate(meshes, start=1):
        tips = _tips(config, load, degree, n, fractions)
        for tip, forms, (fraction, *published) in zip(tips, closed, config.published, strict=True):
            rows.append((degree, n, fraction, *tip, *forms, *published))
        run.progress(number, len(meshes))
    names = [f"{form}_{way}" for form in CLOSED_FORMS for way in ("shortening", "deflection")]
    return StudyTable(
        columns=("degree", "elements", "load", "shortening", "deflection", *names),
        units=("", "", "", *("mm",) * 8),
        values=np.array(rows, dtype=float),
    )


def _tips(
    config: CantileverConfig, load: Load, degree: int, n: int, fractions: list[float]
) -> list[tuple[float, float]]:
    """Shortening and deflection at the middle of the free edge; one element across."""
    import numpy as np

    from stages.artefacts import Laminate, Layer
    from stages.mechanics.body.body import Body
    from stages.mechanics.materials.st_venant_kirchhoff import StVenantKirchhoff
    from stages.mechanics.shell.shell import build_shell
    from stages.mechanics.supports.clamped_normal import ClampedNormal
    from stages.numerics.patches import Patch
    from workflows.verification.ramp import ramp

    patch = Patch.rectangle(config.length, config.width).refine(degree, (n, 1))
    elastic = StVenantKirchhoff(density=1.0, young_modulus=config.young_modulus, poisson_ratio=0.0)
    laminate = Laminate((Layer("strip", "elastic", config.thickness, 0.0, 0.0),))
    shell = build_shell(patch, laminate, {"elastic": elastic})
    body = Body.held(shell, {"clamp": ClampedNormal(edge="X=0")}, {"load": load})
    whole = body.imposed_at(0.0, np.zeros(shell.points))
    tips = []
    for _, u in ramp(body, whole, fractions, first_step=fractions[0]):
        moved = patch.with_net(u.reshape(patch.control_points.shape))
        tip = moved.evaluate([1.0], [0.5])[0]
        tips.append((-float(tip[0]), float(tip[2])))
    return tips


def tip_errors(table: StudyTable, form: str) -> Array:
    """Distance of each tip from that of a closed form, mm."""
    import numpy as np

    away = [
        table.column(way) - table.column(f"{form}_{way}") for way in ("shortening", "deflection")
    ]
    return np.hypot(*away)


def full_load(table: StudyTable, degree: int) -> tuple[Array, Array]:
    """Elements of the meshes of a degree, and their errors at the full load."""
    chosen = (table.column("degree") == degree) & (table.column("load") == 1.0)
    return table.column("elements")[chosen], tip_errors(table, "exact")[chosen]


def degrees(table: StudyTable) -> list[int]:
    """Degrees in the table."""
    return sorted(set(table.column("degree").astype(int).tolist()))


def finest(table: StudyTable) -> Array:
    """Rows of the finest mesh of the highest degree."""
    return (table.column("degree") == table.column("degree").max()) & (
        table.column("elements") == table.column("elements").max()
    )


def order(table: StudyTable, degree: int) -> float:
    """Observed order of the tip at full load, between the two finest meshes of a degree."""
    import numpy as np

    n, error = full_load(table, degree)
    return float(np.log(error[-2] / error[-1]) / np.log(n[-1] / n[-2]))


def cantilever_quantities(
    table: StudyTable, *, exact: float, published: float
) -> dict[str, Quantity]:
    """Errors of the finest mesh over all loads, with limits in mm, and orders of convergence."""
    best = finest(table)
    largest = {form: float(tip_errors(table, form)[best].max()) for form in CLOSED_FORMS}
    found = {
        "exact_error": Quantity(
            largest["exact"], "mm", "tip of the finest mesh from that of the exact shell", exact
        ),
        "elastica_error": Quantity(
            largest["elastica"], "mm", "the same from the strip that does not stretch"
        ),
        "published_error": Quantity(
            largest["published"], "mm", "the same from the published table", published
        ),
    }
    behind = 0.0
    for degree in degrees(table):
        theory, observed = 2 * (degree - 1), order(table, degree)
        behind = max(behind, theory - observed)
        found[f"order_p{degree}"] = Quantity(
            observed, "", f"order of the tip at full load, theory {theory}"
        )
    found["order_deficit"] = Quantity(
        behind, "", "how far an order falls behind the theory at most", limit=0.1
    )
    return found


def draw_cantilever(table: StudyTable, figure: Figure, load: str) -> None:
    """Tip over load, and convergence at full load."""
    values, convergence = figure.subplots(1, 2)
    best = finest(table)
    fraction = table.column("load")[best]
    for colour, way in zip(("C0", "C1"), ("shortening", "deflection"), strict=True):
        values.plot(
            fraction,
            table.column(f"exact_{way}")[best],
            color=colour,
            lw=1.2,
            label=f"{way}: exact",
        )
        values.plot(fraction, table.column(way)[best], "o", color=colour, ms=4, label="shell")
        values.plot(fraction, table.column(f"published_{way}")[best], "+", color="#222222", ms=7)
    values.plot([], [], "+", color="#222222", ms=7, label="Sze, Liu and Lo (2004)")
    values.set(xlabel=load, ylabel="tip [mm]", title="(a)")
    values.legend(fontsize=8)
    _draw_convergence(table, convergence)


def _draw_convergence(table: StudyTable, axes: Axes) -> None:
    for degree in degrees(table):
        n, error = full_load(table, degree)
        slope = 2 * (degree - 1)
        (line,) = axes.loglog(n, error, "o-", ms=4, label=f"p = {degree}: order {slope}")
        axes.loglog(n, error[-1] * (n[-1] / n) ** slope, color=line.get_color(), lw=0.8, ls=":")
    axes.set(xlabel="elements along the strip", ylabel="error of the tip [mm]", title="(b)")
    axes.set_xticks(n, [f"{int(count)}" for count in n])
    axes.minorticks_off()
    axes.legend(fontsize=8)
