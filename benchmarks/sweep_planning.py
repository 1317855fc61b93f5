"""Time to plan sweeps without computing anything: the whole process of `myofilm sweep --dry-run`.

python benchmarks/sweep_planning.py [CASES]
"""

from __future__ import annotations

import math
import subprocess
import sys
import tempfile
import time

DAMPING = "mechanics.damping"
ANGLE = "geometry.fibre_angle"


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
    }


def seconds(options: list[str], store: str) -> tuple[float, int]:
    """Wall time of one dry run, and its number of cases."""
    command = [sys.executable, "-m", "workflows.cli", "sweep", "planar-waves", *options]
    began = time.perf_counter()
    done = subprocess.run(
        [*command, "--store", store, "--dry-run"], check=True, capture_output=True, text=True
    )
    return time.perf_counter() - began, int(done.stdout.split()[0])


def main() -> None:
    """Print a table."""
    cases = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    print(f"{'sweep':26}{'cases':>8}{'seconds':>10}")
    with tempfile.TemporaryDirectory() as store:
        for name, options in designs(cases).items():
            taken, count = seconds(options, store)
            print(f"{name:26}{count:8d}{taken:10.2f}")


if __name__ == "__main__":
    main()
