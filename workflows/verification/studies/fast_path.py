"""One result from both solvers of a flat film, and from any number of threads.

Two waves cross on the film of section 4.3. The fast solver works with products of one-dimensional modes, the
general one with a sparse factorisation: they solve the same discrete equations, so they differ by rounding
alone. A run gives its linear algebra one thread, whatever the machine offers, and is then the same to the last
bit; with more threads sums are split otherwise, and rounding differs again.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, NamedTuple

from pydantic import Field

from pipeline.nodes import StageRun, stage
from stages.artefacts import StudyTable
from stages.configuration import Count, Section, quantity, setting
from stages.electrophysiology.config import ElectrophysiologyConfig
from stages.electrophysiology.schemes.base import AnyScheme
from workflows.verification.study import Study
from workflows.workflow import Quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stages.numerics.bsplines import Array


class FastPathConfig(Section):
    """Film, tissue, meshes, schemes and threads."""

    length: float = quantity("mm", "length of the film", "sec. 4.1", gt=0)
    width: float = quantity("mm", "width of the film", "sec. 4.1", gt=0)
    samples: Count = setting("times at which the solutions are compared, evenly over the run")
    degrees: tuple[Annotated[int, Field(ge=2)], ...] = setting("degrees of the splines")
    schemes: tuple[AnyScheme, ...] = setting("schemes in time")
    transverse_conductivity: float = quantity(
        "nF/ms", "across the fibres, which run along Y, in the anisotropic tissue", "this project"
    )
    threads: Count = setting("threads offered, against one")
    thread_elements: tuple[Count, Count] = setting(
        "mesh on which threads are compared: small matrices stay on one thread anyway"
    )
    electrophysiology: ElectrophysiologyConfig = setting("tissue, mesh, steps and stimuli")


class Case(NamedTuple):
    """One problem: number of the scheme, degree, and whether the tissue has fibres."""

    scheme: int
    degree: int
    fibres: bool


class Sample(NamedTuple):
    """The solution at one time: ms, mV and kPa at every point."""

    time: float
    potential: Array
    active_stress: Array


COLUMNS = (
    "scheme",
    "degree",
    "fibres",
    "time",
    "potential_difference",
    "stress_difference",
    "thread_difference",
    "free_thread_difference",
)


@stage
def fast_path(config: FastPathConfig, *, run: StageRun) -> StudyTable:
    """Largest differences over the film at every sampled time.

    ``potential_difference`` and ``stress_difference`` are those between both solvers, on one thread;
    ``thread_difference`` is that of the fast one offered one thread and several, in a run, and
    ``free_thread_difference`` the same if it took what is offered. The number of the scheme counts from
    0 in the order of the configuration.
    """
    import numpy as np
    from threadpoolctl import threadpool_limits

    from pipeline.threads import one_blas_thread

    cases = list(cases_of(config))
    larger = config.electrophysiology.model_copy(update={"elements": config.thread_elements})
    finer = config.model_copy(update={"electrophysiology": larger})
    rows = []
    for number, case in enumerate(cases, start=1):
        with one_blas_thread():
            fast, general = (list(_samples(config, case, way)) for way in (False, True))
            single = list(_samples(finer, case))
        with threadpool_limits(config.threads, user_api="blas"):
            free = list(_samples(finer, case))
            with one_blas_thread():
                limited = list(_samples(finer, case))
        for one, other, alone, in_a_run, unbound in zip(
            fast, general, single, limited, free, strict=True
        ):
            apart = (*_apart(one, other), _apart(alone, in_a_run)[0], _apart(alone, unbound)[0])
            rows.append((*case, one.time, *apart))
        run.progress(number, len(cases))
    return StudyTable(
        COLUMNS, ("", "", "", "ms", "mV", "kPa", "mV", "mV"), np.array(rows, dtype=float)
    )


def cases_of(config: FastPathConfig) -> Iterator[Case]:
    """Every scheme, degree and tissue."""
    for scheme in range(len(config.schemes)):
        for degree in config.degrees:
            for fibres in (False, True):
                yield Case(scheme, degree, fibres)


def _samples(config: FastPathConfig, case: Case, general: bool = False) -> Iterator[Sample]:
    """The solution at every sampled time."""
    from stages.electrophysiology.monodomain import build
    from stages.numerics.patches import Patch

    cells = cells_of(config, case)
    patch = Patch.rectangle(config.length, config.width).refine(case.degree, cells.elements)
    stepper, state = build(cells, patch, general)
    for _ in range(config.samples):
        stepper.advance(state, cells.n_steps // config.samples)
        yield Sample(state.steps * cells.step, state.potential.copy(), state.active_stress.copy())


def _apart(one: Sample, other: Sample) -> tuple[float, float]:
    """Largest differences of potential and active stress."""
    import numpy as np

    return (
        float(np.abs(other.potential - one.potential).max()),
        float(np.abs(other.active_stress - one.active_stress).max()),
    )


def cells_of(config: FastPathConfig, case: Case) -> ElectrophysiologyConfig:
    """The tissue of a case."""
    changes = {"degree": case.degree, "scheme": config.schemes[case.scheme]}
    if case.fibres:
        changes |= {
            "transverse_conductivity": config.transverse_conductivity,
            "diffusion_angle": 90.0,
        }
    return config.electrophysiology.model_copy(update=changes)


def quantities(table: StudyTable) -> dict[str, Quantity]:
    """The largest differences of all cases and times."""
    largest = {name: float(table.column(name).max()) for name in COLUMNS[4:]}
    return {
        "potential_difference": Quantity(
            largest["potential_difference"], "mV", "potential of both solvers apart", limit=1e-8
        ),
        "stress_difference": Quantity(
            largest["stress_difference"], "kPa", "active stress of both solvers apart", limit=1e-8
        ),
        "thread_difference": Quantity(
            largest["thread_difference"],
            "mV",
            "potentials apart between runs that are offered one thread and several",
            limit=0.0,
        ),
        "free_thread_difference": Quantity(
            largest["free_thread_difference"],
            "mV",
            "the same if the linear algebra took all threads, which no run does",
        ),
    }


def draw(table: StudyTable, figure: Figure) -> None:
    """Differences of both solvers over time, a line for each case."""
    potential, stress = figure.subplots(1, 2, sharex=True, sharey=True)
    keys = sorted({(int(s), int(p), bool(f)) for s, p, f in table.values[:, :3]})
    schemes = sorted({scheme for scheme, _, _ in keys})
    for scheme, degree, fibres in keys:
        chosen = (
            (table.column("scheme") == scheme)
            & (table.column("degree") == degree)
            & (table.column("fibres") == fibres)
        )
        tissue = "along Y" if fibres else "isotropic"
        label = f"p = {degree}, {tissue}" if scheme == schemes[0] else None
        for axes, name in ((potential, "potential_difference"), (stress, "stress_difference")):
            axes.semilogy(
                table.column("time")[chosen],
                table.column(name)[chosen],
                "-" if scheme == schemes[0] else ":",
                color=f"C{degree % 10}",
                lw=1.8 if fibres else 1.0,
                label=label,
            )
    potential.set(xlabel="time [ms]", ylabel="potential [mV]", title="(a)", ylim=(1e-14, 1e-7))
    stress.set(xlabel="time [ms]", ylabel="active stress [kPa]", title="(b)")
    stress.legend(fontsize=7, loc="upper right", ncols=2)


STUDY = Study(
    name="fast-path",
    title="Fast and general solver of a flat film apart, and the effect of threads: rounding alone "
    "(solid: first scheme, dotted: the others)",
    stage=fast_path,
    draw=draw,
    quantities=quantities,
)
