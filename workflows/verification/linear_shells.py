"""Linear shell problems on finer and finer meshes: what the studies of the shell obstacle course share.

Small displacements: one solve with the tangent at rest. The reference values of these problems belong to
classical thin-shell theory, where the section is integrated over the metric of the mid-surface (bending
stiffness E t^3/12). Films are computed with the metric of each depth; that model's result stands beside
in the tables, and differs by a few times (thickness/radius)^2, which neither theory resolves.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from pipeline.nodes import StageRun
from stages.artefacts import StudyTable
from stages.configuration import Count, Section, quantity, setting
from workflows.workflow import Quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stages.mechanics.shell.shell import Shell
    from stages.mechanics.supports.base import Support
    from stages.numerics.bsplines import Array
    from stages.numerics.patches import Patch

Degree = Annotated[int, Field(ge=2)]

OBSTACLES = "Belytschko et al. (1985), shell obstacle course"


class LinearShellConfig(Section):
    """An elastic shell, its reference value, and the meshes."""

    thickness: float = quantity("mm", "thickness", OBSTACLES, gt=0)
    young_modulus: float = quantity("kPa", "Young's modulus", OBSTACLES, gt=0)
    poisson_ratio: float = quantity("", "Poisson's ratio", OBSTACLES, ge=0, lt=0.5)
    reference: float = quantity("mm", "displacement to be found", OBSTACLES, gt=0)
    degrees: tuple[Degree, ...] = setting("degrees of the splines", "App. B")
    elements: tuple[Count, ...] = setting("elements per side", "App. B")


@dataclass(frozen=True)
class LinearShell:
    """One problem, mesh by mesh.

    Attributes
    ----------
    shape
        Exact geometry, refined to every mesh.
    supports
        How it is held, by label.
    load
        Nodal forces of a shell, mN, shape ``(dof,)``.
    probe
        Weights of the displacement that is compared, shape ``(dof,)``.
    """

    shape: Patch
    supports: Mapping[str, Support]
    load: Callable[[Shell], Array]
    probe: Callable[[Patch], Array]


def converge(config: LinearShellConfig, problem: LinearShell, run: StageRun) -> StudyTable:
    """Displacement of the probe for all degrees and meshes, by both models of the section."""
    import numpy as np

    meshes = [(degree, elements) for degree in config.degrees for elements in config.elements]
    rows = []
    for degree, elements in meshes:
        patch = problem.shape.refine(degree, (elements, elements))
        found = [_displacement(config, problem, patch, thin) for thin in (True, False)]
        rows.append((degree, elements, *found, config.reference))
        run.progress(len(rows), len(meshes))
    return StudyTable(
        columns=("degree", "elements", "displacement", "varying_metric", "reference"),
        units=("", "", "mm", "mm", "mm"),
        values=np.array(rows),
    )


def _displacement(
    config: LinearShellConfig, problem: LinearShell, patch: Patch, thin: bool
) -> float:
    from stages.artefacts import Laminate, Layer
    from stages.mechanics.materials.st_venant_kirchhoff import StVenantKirchhoff
    from stages.mechanics.shell.shell import build_shell

    solid = StVenantKirchhoff(
        density=1.0, young_modulus=config.young_modulus, poisson_ratio=config.poisson_ratio
    )
    laminate = Laminate((Layer("shell", "solid", config.thickness, 0.0, 0.0),))
    shell = build_shell(patch, laminate, {"solid": solid}, thin=thin)
    solution = solve(shell, problem.supports, problem.load(shell))
    return float(problem.probe(patch) @ solution)


def solve(shell: Shell, supports: Mapping[str, Support], force: Array) -> Array:
    """Small displacements under nodal forces: K(0) u = f on the supports, shape ``(dof,)``."""
    from stages.mechanics.body.body import Body

    ties = Body.held(shell, supports).ties
    factor = ties.reduce(shell.stiffness_at_rest()).factorise()
    return ties.expand(factor.solve(ties.collect(force)))


def point(patch: Patch, theta: tuple[float, float], direction: tuple[float, float, float]) -> Array:
    """Displacement of a point in a direction, as weights; or a force there. Shape ``(dof,)``."""
    import numpy as np

    functions = patch.functions(np.array([theta]))[0]
    return np.outer(functions, direction).ravel()


def area_load(shell: Shell, load: tuple[float, float, float]) -> Array:
    """Nodal forces of a dead load per undeformed area, kPa, shape ``(dof,)``."""
    import numpy as np

    from stages.numerics.quadrature import moments, quadrature_grid

    grid = quadrature_grid(shell.patch, shell.basis.points)
    return np.outer(moments(shell.patch, grid, shell.weights), load).ravel()


def quantities(table: StudyTable) -> dict[str, Quantity]:
    """The finest result, its distance from the reference, and all results for each degree."""
    found = {
        "displacement": Quantity(
            float(table.column("displacement")[-1]), "mm", "highest degree, finest mesh"
        ),
        "varying_metric": Quantity(
            float(table.column("varying_metric")[-1]),
            "mm",
            "the same with the metric of each depth, as for films",
        ),
    }
    degrees = table.column("degree")
    for degree in sorted(set(degrees)):
        values = table.column("displacement")[degrees == degree]
        found[f"displacements_p{int(degree)}"] = Quantity(
            [float(value) for value in values], "mm", f"degree {int(degree)}, mesh by mesh"
        )
    return found


def relative_error(table: StudyTable, meaning: str, limit: float) -> Quantity:
    """Distance of the finest result from the reference, relative."""
    error = table.column("displacement")[-1] / table.column("reference")[-1] - 1.0
    return Quantity(float(error), "", meaning, limit=limit)


def draw(table: StudyTable, figure: Figure) -> None:
    """Displacement over the mesh for each degree, and how fast it settles."""
    import numpy as np

    values, settling = figure.subplots(1, 2)
    degrees, elements = table.column("degree"), table.column("elements")
    displacement, reference = table.column("displacement"), table.column("reference")[0]
    limit = displacement[-1]
    for marker, degree in zip("os^Dv", sorted(set(degrees)), strict=False):
        mine = degrees == degree
        label = f"degree {int(degree)}"
        values.semilogx(elements[mine], displacement[mine] / reference, f"{marker}-", label=label)
        distance = np.abs(displacement[mine] / limit - 1.0)
        shown = distance > 0
        settling.loglog(elements[mine][shown], distance[shown], f"{marker}-", label=label)
    values.axhline(1.0, color="#9a9a9a", lw=0.8, ls="--")
    values.set(xlabel="elements per side", ylabel="displacement / reference", title="(a)")
    settling.set(xlabel="elements per side", ylabel="distance from the finest result", title="(b)")
    for axes in (values, settling):
        axes.set_xticks(sorted(set(elements)), [f"{int(n)}" for n in sorted(set(elements))])
        axes.minorticks_off()
    values.legend(loc="lower right")
