"""What happens during a run, as values: a listener is any callable that takes one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias


@dataclass(frozen=True)
class Holder:
    """The process that holds the lock of a key."""

    host: str
    pid: int
    stage: str

    def __str__(self) -> str:
        return f"process {self.pid} on {self.host} (stage {self.stage})"


@dataclass(frozen=True)
class StageHit:
    """The result is in the store already."""

    node: str
    stage: str
    key: str


@dataclass(frozen=True)
class StageWaiting:
    """Another process computes the same result; this one waits for it."""

    node: str
    stage: str
    key: str
    holder: Holder


@dataclass(frozen=True)
class StageStarted:
    """The stage begins, or goes on after ``resumed_frames`` frames of an interrupted run.

    ``expected_seconds`` is the duration of the most similar past run, if there is one.
    """

    node: str
    stage: str
    key: str
    resumed_frames: int | None = None
    expected_seconds: float | None = None


@dataclass(frozen=True)
class StageProgress:
    """``done`` of ``total`` steps, ``seconds`` after the start of this process's share."""

    node: str
    stage: str
    done: int
    total: int
    seconds: float


@dataclass(frozen=True)
class StageWarned:
    """Something the user should know; also kept in the manifest."""

    node: str
    stage: str
    message: str


@dataclass(frozen=True)
class StageTold:
    """A line about what the stage does, for those who want to follow it closely; kept nowhere."""

    node: str
    stage: str
    message: str


@dataclass(frozen=True)
class StageStopping:
    """An interrupt came; the stage stops at its next checkpoint (a second one stops it at once).

    If no checkpoint follows, the stage finishes and the run stops after it.
    """

    node: str
    stage: str


@dataclass(frozen=True)
class StageFinished:
    """The result is published."""

    node: str
    stage: str
    key: str
    seconds: float
    size: int


@dataclass(frozen=True)
class StageFailed:
    """The stage raised; the error follows."""

    node: str
    stage: str
    message: str


@dataclass(frozen=True)
class CaseEvent:
    """What happens in one case of several."""

    case: str
    event: Event


Event: TypeAlias = (
    StageHit
    | StageWaiting
    | StageStarted
    | StageProgress
    | StageWarned
    | StageTold
    | StageStopping
    | StageFinished
    | StageFailed
    | CaseEvent
)

Listener: TypeAlias = Callable[[Event], None]


def ignore(event: Event) -> None:
    """The listener that hears nothing."""
