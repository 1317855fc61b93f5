"""What runs jobs. A job is a function of values; what it computes is none of the executor's business."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Any, Protocol, TypeAlias

from pipeline.errors import MyofilmError

Hear: TypeAlias = Callable[[Hashable, Any], None]
"""Receives the tag of a job and a message that the job told while it ran."""


class LostJob(MyofilmError):  # noqa: N818 - it says what happened to the job
    """Every process that ran a job died of it, or so it seems."""


class LostExecutor(MyofilmError):  # noqa: N818 - likewise
    """There is no way any more to have jobs run."""


@dataclass(frozen=True)
class Completion:
    """A job has ended: with a value, or with an error."""

    tag: Hashable
    value: Any = None
    error: Exception | KeyboardInterrupt | None = None


class Executor(Protocol):
    """Runs jobs and hands back how they ended, in whatever order they end.

    A job is ``function(*arguments, tell=tell)``, where ``tell(message)`` sends a value to whoever waits
    in :meth:`next`. Function, arguments, messages and result must be picklable and small: they
    travel through one process. Large data go through files that all can read.
    """

    @property
    def slots(self) -> int:
        """Jobs worth keeping submitted: enough that none who could work waits."""
        ...

    @property
    def in_process(self) -> bool:
        """Whether jobs run inside :meth:`next`, in the thread that calls it."""
        ...

    def submit(self, tag: Hashable, function: Callable[..., Any], *arguments: Any) -> None:
        """Hand over a job.

        Raises
        ------
        InputError
            If function or arguments cannot be sent to where jobs run.
        """
        ...

    def next(self, hear: Hear, timeout: float | None = None) -> Completion | None:
        """A job that has ended; ``None`` if none did within ``timeout`` seconds, or none is left.

        Messages of running jobs are passed to ``hear`` meanwhile, in this thread.

        A job whose processes died again and again ends with :class:`LostJob`.

        Raises
        ------
        LostExecutor
            If no job can be run any more.
        """
        ...

    def stop(self) -> None:
        """End all jobs soon: those that run save a checkpoint, others do not begin.

        All are still handed out by :meth:`next`, those that did not finish with the error
        :class:`pipeline.running.interrupts.Stopped`.
        """
        ...

    def close(self) -> None:
        """Let go of processes and connections, without waiting for jobs."""
        ...
