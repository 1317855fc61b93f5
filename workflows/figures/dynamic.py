"""Figs 6 and 7: the twitching film beside the quasi-static one."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from workflows.experiment import Experiment
from workflows.exports.csvfiles import write_columns, write_csv
from workflows.figures.quasi_static import listed, over_peaks, peaks
from workflows.figures.style import INK, PROBE_COLOURS, drawing, save
from workflows.workflow import Quantity

Runs = Mapping[str, Experiment]
KINDS = {"dynamic": "-", "quasi-static": "--"}


def draw_tips(runs: Runs, folder: Path, name: str) -> dict[str, Quantity]:
    """Fig. 6: displacement of the tip along X and Z over time."""
    time = next(iter(runs.values())).shape.time
    headings, columns = ["time [ms]"], [time]
    for label, run in runs.items():
        headings += [f"{label}: tip {axis} [mm]" for axis in ("ux", "uz")]
        columns += [run.shape.tip[:, 0], run.shape.tip[:, 2]]
    write_csv(folder / f"{name}.csv", headings, np.column_stack(columns))
    with drawing(10.4, 4.1) as figure:
        both = figure.subplots(1, 2)
        for component, axes in zip((0, 2), both, strict=True):
            for label, run in runs.items():
                stress, _, kind = label.partition(", ")
                axes.plot(
                    time,
                    run.shape.tip[:, component],
                    KINDS[kind],
                    color=_colours(runs)[stress],
                    lw=1.8 if kind == "dynamic" else 1.2,
                    label=f"$\\hat P$ = {stress}, {kind}",
                )
            axes.set_xlabel("time $t$ [ms]")
            axes.set_xlim(time[0], time[-1])
            axes.grid(alpha=0.25, linewidth=0.6)
        for letter, axes, text in zip("ab", both, ("$u_x$", "$u_z$"), strict=True):
            axes.set_title(f"({letter})", loc="left", color=INK)
            axes.set_ylabel(f"displacement of the tip {text} [mm]")
        handles, labels = both[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="upper center", ncols=len(labels), fontsize=9)
        figure.tight_layout(w_pad=3, rect=(0, 0, 1, 0.94))
        save(figure, folder, name)
    return _extremes(runs)


def draw_curvatures(runs: Runs, folder: Path, name: str) -> dict[str, Quantity]:
    """Fig. 7: largest curvature of the twitch over peak stress, and that of Fig. 3."""
    kinds = {kind: {k: run for k, run in runs.items() if k.endswith(f" {kind}")} for kind in KINDS}
    found = {
        "peak_stress": peaks(kinds["dynamic"]),
        "max_curvature": Quantity(
            [float(run.shape.curvature.max()) for run in kinds["dynamic"].values()],
            "1/mm",
            "largest curvature of the twitch (eq. 101)",
        ),
        "quasi_static_curvature": Quantity(
            [float(run.shape.curvature[-1]) for run in kinds["quasi-static"].values()],
            "1/mm",
            "curvature at the same stress without inertia (Fig. 3)",
        ),
    }
    write_columns(folder / f"{name}.csv", found)
    with drawing(5.6, 3.9) as figure:
        axes = figure.subplots()
        stress = listed(found["peak_stress"])
        axes.plot(stress, listed(found["max_curvature"]), "o-", label="dynamic, largest over time")
        axes.plot(stress, listed(found["quasi_static_curvature"]), "s--", label="quasi-static")
        over_peaks(axes)
        axes.legend(loc="upper left")
        figure.tight_layout()
        save(figure, folder, name)
    return found


def _colours(runs: Runs) -> dict[str, str]:
    stresses = dict.fromkeys(label.partition(", ")[0] for label in runs)
    return dict(zip(stresses, PROBE_COLOURS, strict=False))


def _extremes(runs: Runs) -> dict[str, Quantity]:
    found = {"peak_stress": peaks({k: v for k, v in runs.items() if k.endswith(" dynamic")})}
    for kind in KINDS:
        series = [run.shape.tip for label, run in runs.items() if label.endswith(f" {kind}")]
        found[f"tip_ux_min_{kind.replace('-', '_')}"] = Quantity(
            [float(tip[:, 0].min()) for tip in series],
            "mm",
            f"how far the tip moves along the film, towards the clamp ({kind})",
        )
        found[f"tip_uz_max_{kind.replace('-', '_')}"] = Quantity(
            [float(tip[:, 2].max()) for tip in series], "mm", f"how far it lifts off ({kind})"
        )
    return found
