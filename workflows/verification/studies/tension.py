"""Uniaxial tension of an incompressible Neo-Hookean sheet with four quadratic elements (Fig. B.2).

A square is pulled along X by moving its edge, and is free to contract. At the stretch l the exact state is
uniform: axial Cauchy stress mu (l^2 - 1/l), thickness t l^-1/2, all other stresses zero.

References
----------
Appendix B, after Kiendl, Hsu, Wu, Reali (2015), Isogeometric Kirchhoff-Love shell formulations for general
hyperelastic materials.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from pipeline.nodes import StageRun, stage
from stages.artefacts import StudyTable
from stages.configuration import Section, quantity, setting
from workflows.verification.study import Study
from workflows.workflow import Quantity

if TYPE_CHECKING:
    from collections.abc import Iterator

    from matplotlib.figure import Figure

    from stages.mechanics.shell.shell import Shell, ShellResponse
    from stages.numerics.bsplines import Array


class TensionConfig(Section):
    """The sheet, and how far it is pulled."""

    side: float = quantity("mm", "side of the square", "this project", gt=0)
    thickness: float = quantity("mm", "thickness at rest", "this project", gt=0)
    shear_modulus: float = quantity("kPa", "shear modulus mu", "Table 1", gt=0)
    largest_stretch: float = quantity("", "stretch at the end", "Fig. B.2", gt=1)
    increments: int = setting("increments of the stretch", "Fig. B.2", ge=1)
    elements: int = setting("elements per side", "App. B", ge=1)
    degree: int = setting("degree of the splines", "App. B", ge=2)


@stage
def tension(config: TensionConfig, *, run: StageRun) -> StudyTable:
    """Stresses and thickness at every stretch, worst over all quadrature points."""
    import numpy as np

    rows = []
    for stretch, shell, response in _pulled(config):
        stress = _cauchy(config, response)
        axial, exact = stress[:, 0, 0].copy(), config.shear_modulus * (stretch**2 - 1.0 / stretch)
        stress[:, 0, 0] = 0.0
        thinning = shell.reference.area / response.frames.area
        worst = _farthest(axial, exact), _farthest(thinning, stretch**-0.5)
        rows.append((stretch, worst[0], exact, worst[1], stretch**-0.5, np.abs(stress).max()))
        run.progress(len(rows), config.increments)
    return StudyTable(
        columns=("stretch", "stress", "stress_exact", "thinning", "thinning_exact", "other"),
        units=("", "kPa", "kPa", "", "", "kPa"),
        values=np.array(rows),
    )


def _pulled(config: TensionConfig) -> Iterator[tuple[float, Shell, ShellResponse]]:
    """Equilibria at growing stretches: one edge stays in its plane, the opposite one moves away."""
    import numpy as np

    from stages.artefacts import Laminate, Layer
    from stages.mechanics.body.body import Body
    from stages.mechanics.materials.neo_hookean import NeoHookean
    from stages.mechanics.shell.shell import build_shell
    from stages.mechanics.supports.displacement import Displacement
    from stages.numerics.patches import Patch
    from stages.time_laws.ramp import Ramp
    from workflows.verification.ramp import ramp

    sheet = Patch.rectangle(config.side, config.side)
    patch = sheet.refine(config.degree, (config.elements, config.elements))
    rubber = NeoHookean(density=1.0, shear_modulus=config.shear_modulus)
    laminate = Laminate((Layer("sheet", "rubber", config.thickness, 0.0, 0.0),))
    shell = build_shell(patch, laminate, {"rubber": rubber})
    growth = config.largest_stretch - 1.0
    supports = {
        "held": Displacement(edge="X=0", x=0.0, z=0.0),
        "pulled": Displacement(
            edge="X=L1", x=growth * config.side, z=0.0, time_law=Ramp(rise_time=1.0)
        ),
        "guided": Displacement(edge="Y=0", y=0.0),
    }
    body = Body.held(shell, supports)
    silent = np.zeros(shell.points)
    fractions = [i / config.increments for i in range(1, config.increments + 1)]
    whole = body.imposed_at(1.0, silent)
    for fraction, u in ramp(body, whole, fractions, first_step=1.0 / config.increments):
        yield 1.0 + fraction * growth, shell, shell.respond(u, silent)


def _cauchy(config: TensionConfig, response: ShellResponse) -> Array:
    """Cauchy stresses n^ab a_a (x) a_b / t in X and Y, kPa, shape ``(point, 2, 2)``; the volume stays."""
    import numpy as np

    n11, n22, n12 = response.resultants.force.T / config.thickness
    tensor = np.stack((np.stack((n11, n12), -1), np.stack((n12, n22), -1)), -2)
    tangents = response.frames.tangents[:, :, :2]
    return np.einsum("pab,pax,pby->pxy", tensor, tangents, tangents)


def _farthest(values: Array, exact: float) -> float:
    """The value that is farthest from the exact one."""
    return float(values[abs(values - exact).argmax()])


def errors(table: StudyTable) -> tuple[Array, Array]:
    """Relative errors of axial stress and thickness at every stretch."""
    import numpy as np

    stress = np.abs(table.column("stress") / table.column("stress_exact") - 1.0)
    thinning = np.abs(table.column("thinning") / table.column("thinning_exact") - 1.0)
    return stress, thinning


def quantities(table: StudyTable) -> dict[str, Quantity]:
    """Worst errors over all stretches."""
    stress, thinning = errors(table)
    other = table.column("other").max() / table.column("stress_exact").max()
    return {
        "stress_error": Quantity(
            float(stress.max()), "", "largest relative error of the axial stress", limit=1e-9
        ),
        "thickness_error": Quantity(
            float(thinning.max()), "", "largest relative error of the thickness", limit=1e-9
        ),
        "other_stresses": Quantity(
            float(other), "", "largest other stress, relative to the largest axial one", limit=1e-9
        ),
    }


def draw(table: StudyTable, figure: Figure) -> None:
    """Fig. B.2: stress and thickness over the stretch, and the relative errors."""
    import numpy as np

    values, deviations = figure.subplots(1, 2)
    stretch = table.column("stretch")
    twin = values.twinx()
    twin.spines["right"].set_visible(True)
    fine = np.linspace(1.0, stretch[-1], 200)
    mu = table.column("stress_exact")[-1] / (stretch[-1] ** 2 - 1 / stretch[-1])
    values.plot(fine, mu * (fine**2 - 1 / fine), color="C0", lw=1.2, label="exact")
    values.plot(stretch, table.column("stress"), "o", color="C0", ms=4, label="shell")
    twin.plot(fine, fine**-0.5, color="C1", lw=1.2)
    twin.plot(stretch, table.column("thinning"), "s", color="C1", ms=4)
    values.set(xlabel="stretch", title="(a)")
    values.set_ylabel("axial stress [kPa]", color="C0")
    twin.set_ylabel("thickness / thickness at rest", color="C1")
    values.legend(loc="upper center")
    floor = np.finfo(float).eps
    for marker, error, label in zip("os", errors(table), ("stress", "thickness"), strict=True):
        deviations.semilogy(stretch, np.maximum(error, floor), f"{marker}-", ms=4, label=label)
    deviations.axhline(1e-9, color="#9a9a9a", lw=0.8, ls="--")
    deviations.set(xlabel="stretch", ylabel="relative error", title="(b)", ylim=(1e-17, 1e-7))
    deviations.legend()


STUDY = Study(
    name="tension",
    title="Uniaxial tension of an incompressible Neo-Hookean sheet, four quadratic elements: shell "
    "against the exact solution (Fig. B.2)",
    stage=tension,
    draw=draw,
    quantities=quantities,
)
