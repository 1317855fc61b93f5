"""Error of the activation times against computing time, over scheme, degree, mesh and step.

    python benchmarks/work_precision.py [--quick] [--out DIR]

Two plane waves (S1-S2) on the film of section 4.3, first 760 ms. Errors are those of both beats at all
collocation points beyond 0.25 mm (nearer to the stimulated edge the pulse drives the cells, and ends while
the front forms, so that arrival times have a kink), against a reference that this script computes: degree 6 on 204 spans,
extrapolated in time. Plane waves do not depend on Y, so errors come from two spans along Y; the CPU seconds are those
of the whole film, steps times the measured time of a step there. Besides the error of each setting the
table has its two parts, which may cancel: that of the mesh (in short steps) and that of the step (on a
fine mesh). About ten minutes on one idle core, one with --quick. Timings are noisy: compare the
ratios of one run. Writes work_precision.csv and work_precision.png and .svg to the folder DIR.
"""

from __future__ import annotations

import argparse
import csv
import itertools
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from pipeline.threads import one_blas_thread
from stages.artefacts import ExcitableSurface
from stages.electrophysiology.config import ElectrophysiologyConfig
from stages.electrophysiology.front import tissue_front
from stages.electrophysiology.monodomain import build
from stages.electrophysiology.recording import BeatRecorder
from stages.electrophysiology.stage import electrophysiology
from stages.numerics.patches import Patch
from workflows.request import Request

SPANS = {
    2: (51, 72, 102, 144, 204),
    3: (51, 72, 102, 144, 204),
    4: (26, 35, 43, 51, 72, 102),
    5: (26, 35, 43, 51, 72),
    6: (26, 30, 35, 43, 51, 61, 72),
}
STEPS = {"cn-ab2": (0.02, 0.05, 0.1, 0.25), "strang": (0.05, 0.1, 0.25, 0.5, 1.0)}
DURATION = 760.0
BEATS = 2
NEXT_TO_EDGE = 0.25
"""mm."""
PAPER = ("cn-ab2", 2, 102, 0.02)


@dataclass(frozen=True)
class Setting:
    """What is varied: scheme, degree, spans along X, and the step in ms."""

    scheme: str
    degree: int
    spans: int
    step: float

    @property
    def elements(self) -> tuple[int, int]:
        """Spans along X and Y, in the proportion of the paper's 102 x 60."""
        return self.spans, round(self.spans * 60 / 102)


class Film:
    """The film and its cells at any setting."""

    def __init__(self) -> None:
        config = Request.read("planar-waves").config
        self.length, self.width = config.geometry.length, config.geometry.width
        self.cells: ElectrophysiologyConfig = config.electrophysiology
        self.patch = Patch.rectangle(self.length, self.width)
        front = tissue_front(self.cells)
        assert front is not None
        self.front = front

    def config(self, setting: Setting, elements: tuple[int, int]) -> ElectrophysiologyConfig:
        """The cells' configuration at a setting."""
        given = {name: getattr(self.cells, name) for name in type(self.cells).model_fields}
        given |= {"elements": elements, "degree": setting.degree, "scheme": setting.scheme}
        given |= {"duration": DURATION, "n_steps": round(DURATION / setting.step)}
        given |= {"output_interval": DURATION}
        return ElectrophysiologyConfig.model_validate(given)

    def arrivals(self, setting: Setting) -> tuple[np.ndarray, np.ndarray]:
        """X of the collocation points and activation times of both beats there, ``(point, beat)``."""
        config = self.config(setting, (setting.spans, 2))
        patch = self.patch.refine(setting.degree, config.elements)
        history = electrophysiology.compute(config, ExcitableSurface(patch))
        table = np.asarray(history.activation_times)
        middle = table.reshape(patch.first.size, patch.second.size, -1)[:, 1, :BEATS]
        return patch.first.greville() * self.length, middle

    def seconds_per_step(self, setting: Setting, least: float) -> float:
        """CPU time of one step on the whole film, best of several blocks."""
        config = self.config(setting, setting.elements)
        patch = self.patch.refine(setting.degree, config.elements)
        stepper, state = build(config, patch)
        beats = BeatRecorder(state.potential, config.activation_threshold, config.initial_potential)
        stepper.advance(state, 2, beats.watch)  # compiles
        best, spent, steps = np.inf, 0.0, 5
        while spent < least:
            start = time.process_time()
            stepper.advance(state, steps, beats.watch)
            taken = time.process_time() - start
            spent += taken
            best = min(best, taken / steps)
            steps = 20
        return best


class Study:
    """Errors and costs, each part computed once."""

    def __init__(self, quick: bool) -> None:
        self.film = Film()
        self.least = 0.2 if quick else 1.0
        self.reference_spans = 102 if quick else 204
        coarse = self._reference(0.02)
        fine = self._reference(0.01)
        self._reference_x, extrapolated = fine[0], 2.0 * fine[1] - coarse[1]
        # the flux of the published scheme acts half a step late: its error is of first order
        self._exact = CubicSpline(self._reference_x, extrapolated, axis=0)
        self._parts: dict[Setting, np.ndarray] = {}
        self._costs: dict[tuple[str, int, int], float] = {}

    def _reference(self, step: float) -> tuple[np.ndarray, np.ndarray]:
        return self.film.arrivals(Setting("cn-ab2", 6, self.reference_spans, step))

    def errors(self, setting: Setting) -> np.ndarray:
        """Errors in ms, ``(point, beat)``; NaN where there was no beat."""
        if setting not in self._parts:
            x, times = self.film.arrivals(setting)
            found = np.full((x.size, BEATS), np.nan)
            found[:, : times.shape[1]] = times - self._exact(x)[:, : times.shape[1]]
            self._parts[setting] = found[x > NEXT_TO_EDGE]
        return self._parts[setting]

    def row(self, setting: Setting) -> dict[str, object]:
        """Everything about a setting, as the table has it."""
        error = self.errors(setting)
        mesh = self.errors(Setting("strang", setting.degree, setting.spans, 0.05))
        step = self.errors(Setting(setting.scheme, 6, 51, setting.step)) - self.errors(
            Setting("strang", 6, 51, 0.05)
        )
        key = (setting.scheme, setting.degree, setting.spans)
        if key not in self._costs:
            self._costs[key] = self.film.seconds_per_step(setting, self.least)
        steps = DURATION / setting.step
        n1, n2 = setting.elements
        unknowns = (n1 + setting.degree) * (n2 + setting.degree)
        front = self.film.front
        return {
            "scheme": setting.scheme,
            "degree": setting.degree,
            "elements_x": n1,
            "elements_y": n2,
            "step_ms": setting.step,
            "spans_per_front": setting.spans * front.width / self.film.length,
            "steps_per_rise": front.rise_time / setting.step,
            "cpu_s": self._costs[key] * steps,
            "unknown_steps": unknowns * steps,
            "error_max_ms": _largest(error),
            "error_rms_ms": float(np.sqrt(np.mean(error**2))),
            "mesh_part_ms": _largest(mesh),
            "step_part_ms": _largest(step),
        }


def _largest(errors: np.ndarray) -> float:
    return float(np.abs(errors).max())  # NaN, where a beat is missing


def settings(quick: bool) -> Iterator[Setting]:
    """All that is measured; the paper's first."""
    yield Setting(*PAPER)
    for scheme, degree in itertools.product(STEPS, SPANS):
        spans, steps = SPANS[degree], STEPS[scheme]
        if quick:
            spans, steps = spans[::2], steps[1::2]
        for n, step in itertools.product(spans, steps):
            if (scheme, degree, n, step) != PAPER:
                yield Setting(scheme, degree, n, step)


def draw(rows: list[dict[str, object]], path: Path) -> None:
    """Error against CPU seconds: a mark for every setting, a line along the best of each degree."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, panels = plt.subplots(
        1, len(STEPS), figsize=(9, 4.2), sharex=True, sharey=True, layout="constrained"
    )
    for axes, scheme in zip(panels, STEPS, strict=True):
        for i, degree in enumerate(SPANS):
            points = sorted(
                (float(r["cpu_s"]), float(r["mesh_part_ms"]) + float(r["step_part_ms"]))
                for r in rows
                if (r["scheme"], r["degree"]) == (scheme, degree)
            )
            cost, error = np.array(points).T
            axes.loglog(cost, error, ".", color=f"C{i}", ms=4, alpha=0.5)
            best = error <= np.fmin.accumulate(error)
            axes.loglog(cost[best], error[best], "-", color=f"C{i}", label=f"degree {degree}")
        paper = rows[0]
        axes.loglog(
            float(paper["cpu_s"]),
            float(paper["mesh_part_ms"]) + float(paper["step_part_ms"]),
            "k*",
            ms=11,
            label="as published",
        )
        axes.set(title=scheme, xlabel="CPU time for 760 ms [s]")
        axes.grid(which="both", alpha=0.2)
    panels[0].set_ylabel("largest error of activation times [ms]\n(mesh + step)")
    panels[-1].legend(fontsize="small")
    for suffix in (".png", ".svg"):
        figure.savefig(path.with_suffix(suffix), dpi=130)


def main() -> None:
    """Measure everything, print the best, write table and figure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="fewer settings, coarser reference")
    parser.add_argument("--out", type=Path, default=Path("results/benchmark"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    with one_blas_thread():
        study = Study(options.quick)
        rows = []
        for setting in settings(options.quick):
            rows.append(study.row(setting))
            print("  ".join(_cell(value) for value in rows[-1].values()), flush=True)
    with (options.out / "work_precision.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    draw(rows, options.out / "work_precision")


def _cell(value: object) -> str:
    return f"{value:9.4g}" if isinstance(value, float) else f"{value!s:>6}"


if __name__ == "__main__":
    main()
