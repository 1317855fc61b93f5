"""Order of convergence in time, on a large motion of the shell made up beforehand.

A clamped film of two layers is bent, twisted and stretched along a chosen path u(t) under a chosen
activation, by the nodal forces f = M u'' + C u' + F_int(u, activation) that this path needs. As u solves
the equations of the mesh exactly, the error of the time steps is known; between two times the forces
are interpolated to t_alpha as an activation is (eq. 68). The motion is as fast as the film's stretching
waves: steps that follow bending alone are too long for those, and orders would be mixed. Generalized-alpha is of second order for every
rho_inf, with and without Rayleigh damping, and with an active stress that follows the fibre stretch.

References
----------
Chung and Hulbert (1993), A time integration algorithm for structural dynamics with improved numerical
dissipation: the generalized-alpha method; eqs. 53-67.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from pipeline.nodes import StageRun, stage
from stages.artefacts import StudyTable
from stages.configuration import Count, Section, quantity, setting
from stages.mechanics.config import AnyMaterial, AnyTensionLaw
from workflows.verification.study import Study
from workflows.workflow import Quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stages.mechanics.dynamics.dynamics import LoadedShell, ShellDynamics
    from stages.numerics.bsplines import Array
    from stages.numerics.newton import Linearisation
    from stages.numerics.patches import Patch
    from stages.numerics.time_stepping import GeneralizedAlpha, Motion, StepWeights

CASES = ("no damping, given stress", "Rayleigh damping", "Rayleigh damping, stress follows stretch")


class DynamicsConfig(Section):
    """The film, its made-up motion, and the steps."""

    length: float = quantity("mm", "length of the film", "sec. 4.1", gt=0)
    width: float = quantity("mm", "width of the film", "sec. 4.1", gt=0)
    substrate_thickness: float = quantity("mm", "thickness of the substrate", "sec. 4.1", gt=0)
    active_thickness: float = quantity("mm", "thickness of the muscle", "sec. 4.1", gt=0)
    fibre_angle: float = quantity("deg", "angle of the fibres from X", "this project")
    substrate: AnyMaterial = setting("material of the substrate", "Table 1")
    active: AnyMaterial = setting("material of the muscle", "Table 1")
    tension_law: AnyTensionLaw = setting("law of the stress that follows the stretch", "Table 2")
    elements: tuple[Count, Count] = setting("elements along X and Y", "this project")
    deflection: float = quantity("mm", "largest deflection, about", "this project", gt=0)
    period: float = quantity("ms", "period of the motion", "this project", gt=0)
    activation: float = quantity("kPa", "largest activation", "this project", ge=0)
    damping: float = quantity("1/ms", "damping per mass", "eq. 105", ge=0)
    stiffness_damping: float = quantity("ms", "damping per stiffness at rest", "sec. 3.2", ge=0)
    radii: tuple[float, ...] = setting("spectral radii rho_inf", "eq. 65")
    steps: tuple[Count, ...] = setting("time steps over the period, growing", "this project")


@stage
def dynamics(config: DynamicsConfig, *, run: StageRun) -> StudyTable:
    """Errors of displacement, for every case, spectral radius and step length."""
    import numpy as np

    rows = []
    total = len(CASES) * len(config.radii) * len(config.steps)
    for case in range(len(CASES)):
        path = _path(config, case)
        for radius in config.radii:
            for steps in config.steps:
                rows.append((case, radius, config.period / steps, *_error(path, radius, steps)))
                run.progress(len(rows), total)
    return StudyTable(
        columns=("case", "spectral_radius", "step", "error", "last_error"),
        units=("", "", "ms", "mm", "mm"),
        values=np.array(rows, dtype=float),
    )


@dataclass(frozen=True)
class Path:
    """The film and the motion that it is made to follow."""

    dynamics: ShellDynamics
    shapes: Array
    period: float
    activation: float

    def motion(self, time: float) -> Motion:
        """Displacement, velocity and acceleration: each shape with its own course."""
        import numpy as np

        from stages.numerics.time_stepping import Motion

        w = 2.0 * np.pi / self.period
        s, c = np.sin(w * time), np.cos(w * time)
        s2, c2 = np.sin(1.7 * w * time), np.cos(1.7 * w * time)
        courses = (
            (s, s * s, 1.0 - c2),
            (w * c, 2.0 * w * s * c, 1.7 * w * s2),
            (-w * w * s, 2.0 * w * w * (c * c - s * s), (1.7 * w) ** 2 * c2),
        )
        return Motion(*(np.array(course) @ self.shapes for course in courses))

    def field(self, time: float) -> Array:
        """Activation, kPa."""
        import numpy as np

        shell = self.dynamics.shell
        factor = np.sin(np.pi * time / self.period) ** 2
        return np.full(shell.points, self.activation * factor)

    def force(self, time: float) -> Array:
        """What moves the film along its path, kPa mm^2."""
        motion, film = self.motion(time), self.dynamics
        internal = film.shell.respond(motion.displacement, self.field(time)).force
        inertia = film.mass @ motion.acceleration
        return inertia + film.damping @ motion.velocity + internal


@dataclass(frozen=True)
class Driven:
    """The film of one step with nodal forces besides."""

    film: LoadedShell
    force: Array

    def linearise(self, motion: Motion, weights: StepWeights) -> Linearisation:
        """That of the film, less the forces."""
        ties = self.film.dynamics.body.ties
        system = self.film.linearise(motion, weights)
        return replace(system, residual=system.residual - ties.collect(self.force))


def _path(config: DynamicsConfig, case: int) -> Path:
    from stages.artefacts import Laminate, Layer
    from stages.mechanics.body.body import Body
    from stages.mechanics.dynamics.dynamics import ShellDynamics
    from stages.mechanics.shell.shell import build_shell
    from stages.mechanics.supports.clamped import Clamped
    from stages.mechanics.tension_laws.prescribed import Prescribed
    from stages.numerics.patches import Patch

    patch = Patch.rectangle(config.length, config.width).refine(2, config.elements)
    laminate = Laminate(
        (
            Layer("substrate", "substrate", config.substrate_thickness, config.fibre_angle, 0.0),
            Layer("muscle", "active", config.active_thickness, config.fibre_angle, 1.0),
        )
    )
    shell = build_shell(
        patch,
        laminate,
        {"substrate": config.substrate, "active": config.active},
        tension=config.tension_law if case == 2 else Prescribed(),
    )
    film = ShellDynamics.build(
        Body.held(shell, {"clamp": Clamped(edge="X=0")}),
        damping=config.damping if case else 0.0,
        stiffness_damping=config.stiffness_damping if case else 0.0,
    )
    return Path(film, _shapes(config, patch), config.period, config.activation)


def _shapes(config: DynamicsConfig, patch: Patch) -> Array:
    """Bent, lengthened, twisted; all clamped at X = 0. Shape (3, dof).

    The film is lengthened by more than bending shortens it: in compression it would buckle away from the
    path, which would then solve the equations and nobody could follow it.
    """
    import numpy as np

    points = patch.evaluate(patch.first.greville(), patch.second.greville())
    x, y = points[:, 0] / config.length, points[:, 1] / config.width - 0.5
    w, zero = config.deflection, np.zeros_like(x)
    shortening = w**2 / config.length * (2.0 / 3.0 * x**3 - 0.5 * x**4 + 0.1 * x**5)
    margin = 0.01 * config.length * x**2
    bent = np.stack((zero, zero, w * x**2 * (1.0 - x / 3.0)), axis=-1)
    lengthened = np.stack((margin - shortening, -0.2 * margin * y, zero), axis=-1)
    twisted = np.stack((margin, zero, 0.2 * w * x**2 * y), axis=-1)
    found = []
    for shape in (bent, lengthened, twisted):
        net = patch.interpolate(shape).control_points
        net[:2] = 0.0
        found.append(net.ravel())
    return np.array(found)


def _error(path: Path, radius: float, steps: int) -> tuple[float, float]:
    """Largest error of a control displacement over all times, and at the end, mm."""
    import numpy as np

    from stages.numerics.newton import NewtonControls
    from stages.numerics.time_stepping import GeneralizedAlpha

    scheme: GeneralizedAlpha = GeneralizedAlpha.damping_to(radius)
    controls = NewtonControls(path.dynamics.shell.extent, 1e-9, 1.0, 1e-9, max_iterations=25)
    dt, motion, errors = path.period / steps, path.motion(0.0), []
    under = path.dynamics.body.under
    for i in range(steps):
        start, end = i * dt, (i + 1) * dt
        film = path.dynamics.between(
            under(path.field(start)), under(path.field(end)), scheme.alpha_f
        )
        step = Driven(film, scheme.blend(path.force(start), path.force(end)))
        exact = path.motion(end).displacement
        motion, _ = scheme.step(step, motion, dt, exact, controls)
        errors.append(np.abs(motion.displacement - exact).max())
    return float(max(errors)), float(errors[-1])


def orders(table: StudyTable) -> dict[tuple[int, float], float]:
    """Observed orders by case and spectral radius, between the two shortest steps."""
    import numpy as np

    found = {}
    for case, radius in sorted({(int(row[0]), float(row[1])) for row in table.values}):
        chosen = (table.column("case") == case) & (table.column("spectral_radius") == radius)
        step, error = (np.log(table.column(name)[chosen][-2:]) for name in ("step", "error"))
        found[case, radius] = float((error[1] - error[0]) / (step[1] - step[0]))
    return found


def quantities(table: StudyTable) -> dict[str, Quantity]:
    """Observed orders, and how far they fall behind two at most."""
    found = orders(table)
    listed = {
        f"order_{'abc'[case]}_rho_{radius:g}": Quantity(
            order, "", f"order in time at rho_inf = {radius:g}: {CASES[case]}"
        )
        for (case, radius), order in found.items()
    }
    behind = max(2.0 - min(found.values()), 0.0)
    return listed | {
        "order_deficit": Quantity(
            behind, "", "how far an order in time falls behind two at most", limit=0.1
        )
    }


def draw(table: StudyTable, figure: Figure) -> None:
    """Error over step length, a panel for each case; the dotted line has slope two."""
    for case, axes in enumerate(figure.subplots(1, len(CASES), sharey=True)):
        for radius in sorted(set(table.column("spectral_radius").tolist())):
            chosen = (table.column("case") == case) & (table.column("spectral_radius") == radius)
            step, error = table.column("step")[chosen], table.column("error")[chosen]
            axes.loglog(step, error, "o-", ms=4, label=rf"$\rho_\infty$ = {radius:g}")
        axes.loglog(step, error[-1] * (step / step[-1]) ** 2, "k:", lw=0.8, label="order 2")
        axes.set(xlabel="time step [ms]", title=CASES[case])
        axes.title.set_fontsize(9)
        axes.legend(fontsize=8)
    figure.axes[0].set_ylabel("largest error of displacement [mm]")


STUDY = Study(
    name="dynamics",
    title="Order in time of generalized-alpha on a made-up large motion of the shell, for every rho_inf",
    stage=dynamics,
    draw=draw,
    quantities=quantities,
    size=(11.0, 4.0),
)
