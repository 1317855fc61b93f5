"""Where the time of the main job goes: cold store, warm store, and one changed mechanical parameter.

    python benchmarks/main_job.py [--set SECTION.KEY=VALUE]... [--out DIR]

Each case is a whole process, import and compilation included. Timings are noisy: compare the ratios
of one run, not the seconds of two. Prints a table and writes it with a bar chart to the folder DIR.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from pathlib import Path

CASES = (
    ("cold store", []),
    ("warm store", []),
    ("other damping", ["--set", "mechanics.damping=0.4"]),
)


def measure(arguments: list[str], out: Path, store: Path) -> dict[str, object]:
    """Run the command line in a child process: wall and CPU seconds, peak memory, seconds by stage."""
    command = [sys.executable, "-m", "workflows.cli", "run", "planar-waves", "--quiet", *arguments]
    command += ["--out", str(out), "--store", str(store)]
    start = time.perf_counter()
    child = os.spawnv(os.P_NOWAIT, sys.executable, command)
    _, status, usage = os.wait4(child, 0)
    wall = time.perf_counter() - start
    if status:
        raise SystemExit(f"{' '.join(command)} failed")
    stages = json.loads((out / "summary.json").read_text())["stages"]
    return {
        "wall_seconds": wall,
        "cpu_seconds": usage.ru_utime + usage.ru_stime,
        "peak_memory_MB": usage.ru_maxrss / 1024,
        "computed": {name: s["seconds"] for name, s in stages.items() if not s["hit"]},
    }


def chart(results: dict[str, dict[str, object]], path: Path) -> None:
    """Stacked bars: computed stages of each case, and everything else."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(8, 2.6), layout="constrained")
    for row, result in enumerate(results.values()):
        left = 0.0
        stages = dict(result["computed"])
        stages["everything else"] = result["wall_seconds"] - sum(stages.values())
        for i, (stage, seconds) in enumerate(stages.items()):
            colour = "0.8" if stage == "everything else" else f"C{i}"
            axes.barh(row, seconds, left=left, color=colour, label=stage if row == 0 else None)
            left += seconds
    axes.set_yticks(range(len(results)), list(results))
    axes.invert_yaxis()
    axes.set_xlabel("wall time [s]")
    axes.legend(ncols=3, fontsize="small", loc="lower right")
    figure.savefig(path)


def main() -> None:
    """Run all cases and report."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--set", action="append", default=[], metavar="SECTION.KEY=VALUE")
    parser.add_argument("--out", type=Path, default=Path("results/benchmark"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    common = [part for value in options.set for part in ("--set", value)]
    results: dict[str, dict[str, object]] = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, extra in CASES:
            out = Path(folder) / "out" if not extra else Path(folder) / "other"
            results[name] = measure([*common, *extra], out, Path(folder) / "store")
            stages = ", ".join(f"{s} {t:.1f} s" for s, t in results[name]["computed"].items())
            print(
                f"{name:15} {results[name]['wall_seconds']:7.1f} s wall "
                f"{results[name]['cpu_seconds']:7.1f} s CPU "
                f"{results[name]['peak_memory_MB']:6.0f} MB   {stages or 'all hits'}",
                flush=True,
            )
    (options.out / "main_job.json").write_text(json.dumps(results, indent=2) + "\n")
    chart(results, options.out / "main_job.png")


if __name__ == "__main__":
    main()
