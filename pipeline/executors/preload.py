"""Loaded by local workers when they start: signals of the terminal are for the process that started them.

It asks them to stop so that they can save their work; they end themselves if it dies.
"""

from __future__ import annotations

import os
from typing import Any


def dask_setup(worker: Any) -> None:
    """Leave the process group, to which a terminal sends its signals."""
    os.setpgid(0, 0)
