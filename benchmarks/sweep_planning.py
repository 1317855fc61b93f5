"""Time to plan sweeps without computing anything: the whole process of `myofilm sweep --dry-run`.

Other load on the machine lengthens the wall time more than the processor time.

python benchmarks/sweep_planning.py [CASES]
"""

from __future__ import annotations

import math
import resource
import subprocess
import sys
import tempfile
import time

DAMPING = "mechanics.damping"
ANGLE = "geometry.fibre_angle"
CONDUCTIVITY = "electrophysiology.conductivity"


def designs(cases: int) -> dict[str, list[str]]:
    """Options of the sweeps by what they show."""
    side = math.isqrt(cases)
    return {
        "grid of two parameters": [
            "--over",
            f"{DAMPING}=0.1:1:#{side}",
            "--over",
            f"{ANGLE}=0:90:#{side}",
        ],
        "one parameter": ["--over", f"{DAMPING}=0.1:1:#{cases}"],
        "Latin hypercube in two": [
            *("--sample", f"lhs:{cases}"),
            *("--over", f"{DAMPING}=0.1..1", "--over", f"{ANGLE}=0..90"),
        ],
        "conductivities": ["--over", f"{CONDUCTIVITY}=0.001:0.003:#{cases}"],
        "conductivities and dampings": [
            *("--sample", f"lhs:{cases}"),
            *("--over", f"{CONDUCTIVITY}=0.001..0.003", "--over", f"{DAMPING}=0.1..1"),
        ],
    }


def seconds(options: list[str], store: str) -> tuple[float, float, int]:
    """Wall and processor time of one dry run, and its number of cases."""
    command = [sys.executable, "-m", "workflows.cli", "sweep", "planar-waves", *options]
    began, used = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        [*command, "--store", store, "--dry-run"], check=True, capture_output=True, text=True
    )
    now = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = now.ru_utime + now.ru_stime - used.ru_utime - used.ru_stime
    return time.perf_counter() - began, processor, int(done.stdout.split()[0])


def main() -> None:
    """Print a table."""
    cases = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    print(f"{'sweep':28}{'cases':>8}{'seconds':>10}{'CPU s':>10}")
    with tempfile.TemporaryDirectory() as store:
        for name, options in designs(cases).items():
            taken, processor, count = seconds(options, store)
            print(f"{name:28}{count:8d}{taken:10.2f}{processor:10.2f}")


if __name__ == "__main__":
    main()
