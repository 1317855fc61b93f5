"""From the free strip to the cylinder: curvature of the active film against its width.

A narrow film curls across (anticlastic) and obeys the free-strip closed form; a wide one cannot and tends to
the cylinder, three quarters of that curvature. In between, only strips along the sides curl across. The shell
is compared with both closed forms and with the theory of these strips (``workflows.theory.anticlastic``):

- a long film, half of its length and width, between planes of symmetry, at its middle;
- the film of the paper, clamped at X = 0, at mid-length.

References
----------
Lamb (1891), Proc. London Math. Soc. 21, 70; Searle (1908), Experimental elasticity; Ashwell (1950), J. R.
Aeronaut. Soc. 54, 708: bent plates. The active film is this project's.
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

    from stages.mechanics.supports.base import Support
    from stages.numerics.bsplines import SplineSpace
    from workflows.theory.bilayer import Ply


class AnticlasticConfig(Section):
    """The film of the paper in several widths."""

    widths: tuple[float, ...] = quantity("mm", "widths, growing", "this project")
    length: float = quantity("mm", "length of the clamped film", "sec. 4.1", gt=0)
    substrate_thickness: float = quantity("mm", "thickness d_s", "sec. 4.1", gt=0)
    active_thickness: float = quantity("mm", "thickness d_a", "sec. 4.1", gt=0)
    substrate_modulus: float = quantity("kPa", "shear modulus mu_s", "Table 1", gt=0)
    active_modulus: float = quantity("kPa", "shear modulus mu_a", "Table 1", gt=0)
    fibre_stiffness: float = quantity("kPa", "fibre stiffness E_p", "Table 1", ge=0)
    fibre_exponent: float = quantity("", "fibre exponent a", "Table 1", gt=0)
    stress: float = quantity("kPa", "active stress", "sec. 4, average of experiments", gt=0)
    degree: int = setting("degree of the splines", "this project", ge=2)
    elements: tuple[Count, Count] = setting(
        "elements along X and across half the width, there finer towards the side", "this project"
    )


@stage
def anticlastic(config: AnticlasticConfig, *, run: StageRun) -> StudyTable:
    """Curvatures along X, mean over the width: long film, its theory, and the clamped film."""
    import numpy as np

    from stages.mechanics.supports.clamped_normal import ClampedNormal
    from stages.mechanics.supports.point import Point
    from stages.mechanics.supports.symmetry import Symmetry
    from workflows.theory.anticlastic import film_of_width
    from workflows.theory.bilayer import cylindrical, free_strip

    plies = _plies(config)
    strip, cylinder = free_strip(plies).curvature_x, cylindrical(plies).curvature_x
    middle = Symmetry(edge="Y=0")
    long_film = {
        "X": Symmetry(edge="X=0"),
        "Y": middle,
        "Z": Point(position=(0.0, 0.0), z=0.0, time_law=None),
    }
    clamped_film = {"clamp": ClampedNormal(edge="X=0"), "Y": middle}
    rows = []
    for width in config.widths:
        half = max(1.5 * width, 0.5)  # far enough from the end: twice as long moves k by 1e-4
        rows.append(
            (
                width,
                _curvature(config, long_film, half, width, 0.0),
                film_of_width(plies, width).curvature,
                _curvature(config, clamped_film, config.length, width, 0.5),
                strip,
                cylinder,
            )
        )
        run.progress(len(rows), len(config.widths))
    return StudyTable(
        columns=("width", "shell", "theory", "clamped", "strip", "cylinder"),
        units=("mm", *("1/mm",) * 5),
        values=np.array(rows),
    )


def _plies(config: AnticlasticConfig) -> list[Ply]:
    from workflows.theory.bilayer import Ply, prescribed

    return [
        Ply(config.substrate_thickness, config.substrate_modulus),
        Ply(
            config.active_thickness,
            config.active_modulus,
            config.fibre_stiffness,
            config.fibre_exponent,
            prescribed(config.stress),
        ),
    ]


def _curvature(
    config: AnticlasticConfig,
    supports: dict[str, Support],
    length: float,
    width: float,
    place: float,
) -> float:
    """Mean curvature along X over half the width, at the fraction ``place`` of the length."""
    import numpy as np

    from stages.artefacts import Laminate, Layer
    from stages.mechanics.body.body import Body
    from stages.mechanics.materials.neo_hookean import NeoHookean
    from stages.mechanics.materials.neo_hookean_fibre import NeoHookeanFibre
    from stages.mechanics.shell.shell import build_shell
    from stages.numerics.patches import Patch
    from stages.numerics.quadrature import quadrature_grid
    from stages.numerics.surface_geometry import frame_on_grid
    from workflows.verification.ramp import ramp

    sheet = Patch.rectangle(length, 0.5 * width)
    along = sheet.first.refine(config.degree, config.elements[0])
    across = _graded(sheet.second, config.degree, config.elements[1])
    embed = sheet.first.embed(along), sheet.second.embed(across)
    patch = Patch(along, across, np.einsum("ai,bj,ijx->abx", *embed, sheet.control_points))
    laminate = Laminate(
        (
            Layer("substrate", "substrate", config.substrate_thickness, 0.0, 0.0),
            Layer("active", "active", config.active_thickness, 0.0, 1.0),
        )
    )
    muscle = NeoHookeanFibre(
        density=1.0,
        shear_modulus=config.active_modulus,
        fibre_stiffness=config.fibre_stiffness,
        fibre_exponent=config.fibre_exponent,
    )
    rubber = NeoHookean(density=1.0, shear_modulus=config.substrate_modulus)
    shell = build_shell(patch, laminate, {"substrate": rubber, "active": muscle})
    body = Body.held(shell, supports)
    pull = body.under(np.full(shell.points, config.stress))
    ((_, u),) = ramp(body, pull, [1.0], first_step=0.1)
    bent = patch.with_net(patch.control_points + u.reshape(patch.control_points.shape))
    grid = quadrature_grid(patch, config.degree + 1)
    frame = frame_on_grid(bent, np.array([place]), grid.theta2)
    return float(grid.weights2 @ (frame.curvature[:, 0, 0] / frame.metric_cov[:, 0, 0]))


def _graded(line: SplineSpace, degree: int, elements: int) -> SplineSpace:
    """Spans that shrink in proportion towards the end, where the film curls across."""
    import numpy as np

    breaks = 1.0 - (1.0 - np.arange(1, elements) / elements) ** 2
    return line.elevate(degree - line.degree).insert(breaks)


def quantities(table: StudyTable) -> dict[str, Quantity]:
    """Both limits, and the distance from the theory in between."""
    width, shell = table.column("width"), table.column("shell")
    strip, cylinder = table.column("strip")[0], table.column("cylinder")[0]
    share = width * shell  # k = k_c (1 + c/width): linear in the width
    wide = (share[-1] - share[-2]) / (width[-1] - width[-2])
    return {
        "theory_error": Quantity(
            float(abs(shell / table.column("theory") - 1.0).max()),
            "",
            "largest relative difference between long film and theory, over all widths",
            limit=2e-3,
        ),
        "strip_error": Quantity(
            float(shell[0] / strip - 1.0),
            "",
            "relative difference between the narrowest film and the free strip",
            limit=1e-3,
        ),
        "cylinder_error": Quantity(
            float(wide / cylinder - 1.0),
            "",
            "relative difference between the two widest films, their sides taken off, and the cylinder",
            limit=2e-3,
        ),
        "ratio": Quantity(
            float(cylinder / strip), "", "curvature of a cylinder over that of a free strip"
        ),
    }


def draw(table: StudyTable, figure: Figure) -> None:
    """Curvature over width between both closed forms; relative difference from the theory."""
    import numpy as np

    values, deviations = figure.subplots(1, 2, width_ratios=(3, 2))
    width = table.column("width")
    strip, cylinder = table.column("strip")[0], table.column("cylinder")[0]
    values.axhline(strip, color="C1", lw=1.2, ls="--", label="free strip (closed form)")
    values.axhline(cylinder, color="C2", lw=1.2, ls="--", label="cylinder (closed form)")
    values.semilogx(width, table.column("theory"), color="C0", lw=1.2, label="theory of the sides")
    values.semilogx(width, table.column("shell"), "o", color="C0", ms=5, label="long film (shell)")
    values.semilogx(
        width, table.column("clamped"), "x", color="C3", ms=6, label="clamped film (shell)"
    )
    values.set(xlabel="width [mm]", ylabel="curvature along X [1/mm]", title="(a)")
    values.legend(fontsize=8)
    difference = np.abs(table.column("shell") / table.column("theory") - 1.0)
    deviations.loglog(width, difference, "o-", ms=4)
    deviations.set(xlabel="width [mm]", title="(b)", ylabel="|long film / theory - 1|")


STUDY = Study(
    name="anticlastic",
    title="Curvature of the active film against its width: shell between the closed forms of the free "
    "strip and of the cylinder (Ashwell, 1950)",
    stage=anticlastic,
    draw=draw,
    quantities=quantities,
)
