"""Helpers for the tests of stages, stores and executors.

:func:`interrupted_and_resumed` shows that a stage continues where it was stopped. Tests of a store inherit
``StoreConformance`` of :mod:`pipeline.testing.stores` and ``UpkeepConformance`` of
:mod:`pipeline.testing.upkeep`, those of an executor ``ExecutorConformance`` of
:mod:`pipeline.testing.executors`.
"""

from __future__ import annotations

from typing import Any, TypeVar

from pipeline.nodes import Stage
from pipeline.running.memory import MemoryHistory, MemoryRun, Stopped

__all__ = ["MemoryHistory", "MemoryRun", "Stopped", "interrupted_and_resumed"]

R = TypeVar("R")


def interrupted_and_resumed(
    stage: Stage[R], config: Any, *inputs: Any, after: int, **named: Any
) -> R:
    """Result of a stage that is stopped after a number of frames and then run again.

    It must equal, bit for bit, the result of ``stage.compute(config, *inputs)``.

    Raises
    ------
    AssertionError
        If the stage never calls ``run.checkpoint`` with that many frames done.
    """
    run = MemoryRun(stop_after=after)
    try:
        stage.compute(config, *inputs, run=run, **named)
    except Stopped:
        return stage.compute(config, *inputs, run=run, **named)
    raise AssertionError(f"stage {stage.name} made no checkpoint after {after} frames")
