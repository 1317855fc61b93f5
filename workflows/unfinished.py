"""What is not finished yet in an output folder: hidden, and removed by the next command if it never will be."""

from __future__ import annotations

import os
import platform
import re
import shutil
from contextlib import suppress
from pathlib import Path

from pipeline.store.registers import is_process


def temporary_sibling(path: Path) -> Path:
    """Hidden name beside a file, or a folder, for what is not finished; its suffix is the same."""
    return path.with_name(f".{path.stem}.{platform.node()}.{os.getpid()}{path.suffix}")


def remove_unfinished(folder: Path) -> None:
    """Remove what processes of this machine left in a folder that were killed while they wrote there."""
    pattern = re.compile(rf"\..+\.{re.escape(platform.node())}\.(\d+)(\.\w+)?")
    for name in os.listdir(folder):
        match = pattern.fullmatch(name)
        if match and not is_process(int(match[1])):
            path = folder / name
            with suppress(OSError):  # it is in nobody's way
                shutil.rmtree(path) if path.is_dir() else path.unlink()
