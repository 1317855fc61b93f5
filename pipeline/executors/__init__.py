"""Where jobs run: one after the other in this process, or at once in others."""

from __future__ import annotations

from pipeline.executors.protocol import Completion, Executor
from pipeline.executors.serial import SerialExecutor

__all__ = ["Completion", "Executor", "SerialExecutor"]
