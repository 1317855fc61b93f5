"""Where a result was computed: host, command line, versions, state of the source tree."""

from __future__ import annotations

import hashlib
import importlib.metadata
import itertools
import os
import platform
import subprocess
import sys
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

LIBRARIES = ("numpy", "scipy", "numba", "h5py", "zarr")
"""Libraries whose version can change the last bits of a result."""

CPU_LINES = ("vendor_id", "cpu family", "model", "flags", "CPU implementer", "CPU part", "Features")
"""What tells kinds of processor apart: compiled kernels and BLAS use all that a processor can do."""


@cache
def versions() -> dict[str, str]:
    """Versions of Python and of the numerical libraries; nothing is imported."""
    found = {"python": platform.python_version()}
    for name in LIBRARIES:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            found[name] = "absent"
    return found


@cache
def processor() -> str:
    """Kind of processor: its architecture, and a digest of its model and features where known."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8", errors="replace") as file:
            first = itertools.takewhile(str.strip, file)  # a blank line ends each processor
            about = sorted(line.strip() for line in first if line.startswith(CPU_LINES))
    except OSError:
        about = [platform.processor()]
    digest = hashlib.sha256("\n".join(about).encode()).hexdigest()
    return f"{platform.machine()} {digest[:16]}"


def version_changes(past: Mapping[str, str]) -> list[str]:
    """Libraries whose version differs from that of a past run, in words."""
    return [
        f"{name} {past[name]} (installed: {now})"
        for name, now in versions().items()
        if name != "python" and past.get(name, now) != now
    ]


def environment(source: Path | None) -> dict[str, Any]:
    """Host, process and versions, and the git state of the folder that holds a source file."""
    return {
        "host": platform.node(),
        "pid": os.getpid(),
        "argv": list(sys.argv),
        "platform": platform.platform(),
        "cpus": os.cpu_count(),
        "threads": {k: v for k, v in sorted(os.environ.items()) if k.endswith("_NUM_THREADS")},
        "versions": dict(versions()),
        "git": None if source is None else _first_git_state(_repository(source)),
    }


@cache
def _first_git_state(folder: Path) -> dict[str, Any] | None:
    """State when this process asked first: that is nearest to the code it loaded."""
    return git_state(folder)


def _repository(source: Path) -> Path:
    """Root of the repository that a file lies in, or the file's folder."""
    return next((one for one in source.parents if (one / ".git").exists()), source.parent)


def git_state(folder: Path) -> dict[str, Any] | None:
    """Revision, whether it is dirty, and a digest of the changes; ``None`` outside a repository."""
    revision = _git(folder, "rev-parse", "HEAD")
    if revision is None:
        return None
    changes = _git(folder, "diff", "HEAD") or b""
    return {
        "revision": revision.decode().strip(),
        "dirty": bool(_git(folder, "status", "--porcelain")),
        "diff": hashlib.sha256(changes).hexdigest() if changes else None,
    }


def _git(folder: Path, *arguments: str) -> bytes | None:
    try:
        done = subprocess.run(
            ["git", "-C", str(folder), *arguments], capture_output=True, timeout=10, check=False
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout if done.returncode == 0 else None
