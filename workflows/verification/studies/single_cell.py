"""A single cell, its potential and active stress over one second, against SciPy (Appendix C, Fig. C.2).

The cell rests for 50 ms, is stimulated for 2 ms, and recovers. The paper does not print the strength of
the stimulus; 20 mV/ms lifts the potential by 40 mV, well above the threshold of 15 mV. Three ways in time are
compared with a reference at tolerances of 1e-10: Runge-Kutta 4 in all variables (fourth order); the
published scheme without diffusion, Adams-Bashforth 2 for the potential, whose pulse is late by half a
step, since it is taken at levels of time (first order); and the same with the pulse's mean over each
step (second order).

References
----------
Appendix C; Göktepe and Kuhl (2010), Electromechanics of the heart, Computational Mechanics 45, 227-243.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from pipeline.nodes import StageRun, stage
from stages.artefacts import StudyTable
from stages.configuration import Count, quantity, setting
from stages.electrophysiology.cell_config import CellConfig
from workflows.verification.study import Study
from workflows.workflow import Quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from stages.electrophysiology.single_cell import Pulse, Trace
    from stages.numerics.bsplines import Array

METHODS = ("SciPy", "Runge-Kutta 4", "published scheme", "published, mean pulse")
ORDERS = (4, 1, 2)
"""Theory, for all methods but the reference."""

PAPER_STEP = 0.02
"""ms, sec. 4.3; numbers are reported for the step next to it."""


class SingleCellConfig(CellConfig):
    """The cell, its stimulus, and the steps in time."""

    duration: float = quantity("ms", "simulated time", "App. C", gt=0)
    pulse_start: float = quantity("ms", "begin of the stimulus", "App. C", ge=0)
    pulse_duration: float = quantity("ms", "length of the stimulus", "App. C", gt=0)
    pulse_rate: float = quantity("mV/ms", "stimulus over capacitance", "this project")
    threshold: float = quantity("mV", "potential whose crossing is the activation", "this project")
    sampling: float = quantity("ms", "time between compared values", "this project", gt=0)
    steps: tuple[Count, ...] = setting("numbers of time steps, growing", "this project")

    @model_validator(mode="after")
    def _steps_fit(self) -> SingleCellConfig:
        for steps in self.steps:
            step = self.duration / steps
            for name in ("pulse_start", "pulse_duration", "sampling"):
                ratio = getattr(self, name) / step
                if abs(ratio - round(ratio)) > 1e-6:
                    raise PydanticCustomError(
                        "steps",
                        "{name} must be a whole number of time steps, of {step} ms too",
                        {"name": name, "step": f"{step:g}"},
                    )
        return self


class Beat(NamedTuple):
    """Largest potential in mV, time of activation in ms, and APD90 counted from it in ms."""

    peak: float
    activation: float
    apd90: float


@stage
def single_cell(config: SingleCellConfig, *, run: StageRun) -> StudyTable:
    """Potential and stress at the sampled times, for the reference and every method and step."""
    import numpy as np

    from stages.electrophysiology.single_cell import Pulse, follow, follow_as_published

    pulse = Pulse(config.pulse_start, config.pulse_duration, config.pulse_rate)
    finest = np.linspace(0.0, config.duration, max(config.steps) + 1)
    rows = [_rows(config, 0, 0.0, _reference(config, pulse, finest))]
    for steps in config.steps:
        step = config.duration / steps
        traces = (
            follow(config, [pulse], config.duration, step),
            follow_as_published(config, [pulse], config.duration, steps),
            follow_as_published(config, [pulse], config.duration, steps, mean=True),
        )
        rows += [_rows(config, i, step, trace) for i, trace in enumerate(traces, start=1)]
        run.progress(len(rows), 1 + len(ORDERS) * len(config.steps))
    return StudyTable(
        columns=("method", "step", "time", "potential", "stress", *Beat._fields),
        units=("", "ms", "ms", "mV", "kPa", "mV", "ms", "ms"),
        values=np.concatenate(rows),
    )


def _rows(config: SingleCellConfig, method: int, step: float, trace: Trace) -> Array:
    """The sampled trace, with the numbers of its beat in every row."""
    import numpy as np

    count = round(config.duration / config.sampling)
    every = (trace.time.size - 1) // count
    sampled = [values[::every] for values in (trace.time, trace.potential, trace.stress)]
    same = [np.full(count + 1, value) for value in (method, step)]
    beat = [np.full(count + 1, value) for value in beat_of(config, trace)]
    return np.stack((*same, *sampled, *beat), axis=1)


def beat_of(config: SingleCellConfig, trace: Trace) -> Beat:
    """First action potential of a trace; crossings by linear interpolation, NaN where there is none."""
    import numpy as np

    v, t = trace.potential, trace.time
    top = int(v.argmax())
    level = config.initial_potential + 0.1 * (v[top] - config.initial_potential)
    up, down = v[: top + 1] >= config.threshold, v[top:] <= level
    if not up.any() or not down.any():
        return Beat(float(v[top]), np.nan, np.nan)
    i, j = int(up.argmax()), top + int(down.argmax())
    begin = float(np.interp(config.threshold, v[i - 1 : i + 1], t[i - 1 : i + 1]))
    end = float(np.interp(-level, -v[j - 1 : j + 1], t[j - 1 : j + 1]))
    return Beat(float(v[top]), begin, end - begin)


def _reference(config: SingleCellConfig, pulse: Pulse, time: Array) -> Trace:
    """SciPy's Dormand-Prince 8(5,3), begun anew where the stimulus begins and ends."""
    import numpy as np
    from scipy.integrate import solve_ivp

    from stages.electrophysiology.single_cell import Trace, plain_rates, rest

    start, rates = rest(config), plain_rates(config)
    y = np.array([start.potential, *start.states, start.stress])
    columns = [y]
    stop = pulse.start + pulse.duration
    pieces = (
        (0.0, pulse.start, 0.0),
        (pulse.start, stop, pulse.rate),
        (stop, config.duration, 0.0),
    )
    for low, high, on in pieces:

        def slope(_: float, y: Array, on: float = on) -> Array:
            return rates(y, on)

        inside = time[(time > low + 1e-9) & (time < high - 1e-9)]
        instants = [*inside.tolist(), high]
        found = solve_ivp(
            slope, (low, high), y, method="DOP853", t_eval=instants, rtol=1e-10, atol=1e-10
        )
        columns += list(found.y.T)
        y = found.y[:, -1]
    table = np.stack(columns, axis=1)
    return Trace(time, table[0], table[1:-1], table[-1])


def _of(table: StudyTable, method: int, step: float, column: str) -> Array:
    import numpy as np

    chosen = (table.column("method") == method) & np.isclose(table.column("step"), step)
    return table.column(column)[chosen]


def steps_of(table: StudyTable) -> Array:
    """Lengths of the time steps, falling, ms."""
    import numpy as np

    return np.unique(table.column("step"))[:0:-1]


def errors(table: StudyTable, column: str, method: int) -> Array:
    """Largest error over the sampled times by step: ``potential`` in mV or ``stress`` in kPa."""
    import numpy as np

    exact = _of(table, 0, 0.0, column)
    worst = [np.abs(_of(table, method, h, column) - exact).max() for h in steps_of(table)]
    return np.array(worst)


def orders(table: StudyTable, method: int) -> Array:
    """Observed orders of the potential between neighbouring steps whose errors stand above the reference's."""
    import numpy as np

    steps, error = steps_of(table), errors(table, "potential", method)
    clear = error > 1e-7
    return np.asarray(np.diff(np.log(error[clear])) / np.diff(np.log(steps[clear])))


def quantities(table: StudyTable) -> dict[str, Quantity]:
    """The beat, errors with the paper's step, and how far orders fall behind the theory."""
    import numpy as np

    exact = Beat(*(float(_of(table, 0, 0.0, name)[0]) for name in Beat._fields))
    stress = _of(table, 0, 0.0, "stress")
    found = {
        "peak": Quantity(exact.peak, "mV", "largest potential, reference"),
        "apd90": Quantity(
            exact.apd90, "ms", "from the activation to 90 % repolarisation, reference"
        ),
        "peak_stress": Quantity(float(stress.max()), "kPa", "largest active stress, reference"),
    }
    where = int(np.abs(steps_of(table) - PAPER_STEP).argmin())
    step = float(steps_of(table)[where])
    limits = {1: (1e-6, 1e-5, 1e-4), 2: (0.5, 0.1, 0.05), 3: (2e-3, 2e-4, 1e-3)}
    for method, (potential, tension, time) in limits.items():
        name = ("", "runge_kutta", "published", "mean_pulse")[method]
        apd = float(_of(table, method, step, "apd90")[0])
        found |= {
            f"{name}_potential_error": Quantity(
                float(errors(table, "potential", method)[where]),
                "mV",
                f"{METHODS[method]}, step of {step:g} ms: largest error of the potential",
                limit=potential,
            ),
            f"{name}_stress_error": Quantity(
                float(errors(table, "stress", method)[where]),
                "kPa",
                "the same of the active stress",
                limit=tension,
            ),
            f"{name}_apd90_error": Quantity(apd - exact.apd90, "ms", "error of APD90", limit=time),
            f"{name}_order": Quantity(
                float(orders(table, method)[-1]),
                "",
                f"observed order of the potential, theory {ORDERS[method - 1]}",
            ),
        }
    behind = max(ORDERS[m - 1] - float(orders(table, m)[-1]) for m in limits)
    return found | {
        "order_deficit": Quantity(
            max(behind, 0.0), "", "how far an order falls behind the theory at most", limit=0.2
        )
    }


def draw(table: StudyTable, figure: Figure) -> None:
    """Fig. C.2: potential and active stress over time, and errors over the step."""
    traces, convergence = figure.subplots(1, 2, width_ratios=(1.3, 1.0))
    _draw_traces(table, traces)
    steps = steps_of(table)
    for method in range(1, len(METHODS)):
        error, order = errors(table, "potential", method), ORDERS[method - 1]
        label = f"{METHODS[method]}: order {order}"
        (line,) = convergence.loglog(steps, error, "o-", ms=4, label=label)
        ideal = error[0] * (steps / steps[0]) ** order
        convergence.loglog(steps, ideal, color=line.get_color(), lw=0.8, ls=":")
    convergence.set(
        xlabel="time step [ms]", ylabel="largest error of the potential [mV]", title="(b)"
    )
    convergence.legend(fontsize=8, loc="lower right")


def _draw_traces(table: StudyTable, axes: Axes) -> None:
    finest = float(steps_of(table)[-1])
    time, twin = _of(table, 0, 0.0, "time"), axes.twinx()
    twin.spines["right"].set_visible(True)
    every = slice(None, None, max(time.size // 40, 1))
    for place, name, color in ((axes, "potential", "C0"), (twin, "stress", "C1")):
        place.plot(time, _of(table, 1, finest, name), color=color, lw=1.4)
        exact = _of(table, 0, 0.0, name)[every]
        place.plot(time[every], exact, "o", color=color, ms=3, mfc="none", label=METHODS[0])
    axes.set(xlabel="time [ms]", title="(a)")
    axes.set_ylabel("potential [mV]", color="C0")
    twin.set_ylabel("active stress [kPa]", color="C1")


STUDY = Study(
    name="single-cell",
    title="A single cell, stimulated for 2 ms: potential and active stress against SciPy (Fig. C.2)",
    stage=single_cell,
    draw=draw,
    quantities=quantities,
)
