"""What a plan says of a stage: its result is there, or why not, and what getting it would cost."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from pipeline.manifest import Manifest
from pipeline.plan.reasons import CodeChanged, Reason
from pipeline.running.checkpoint_summary import CheckpointSummary


@dataclass(frozen=True)
class Forecast:
    """Cost of the most similar past run."""

    seconds: float
    size: int


@dataclass(frozen=True)
class Hit:
    """The result is in the store; ``versions`` tells which libraries were others when it was computed."""

    node: str
    stage: str
    key: str
    manifest: Manifest
    versions: tuple[str, ...] = ()

    @property
    def forecast(self) -> Forecast:
        """Nothing is left to do."""
        return Forecast(0.0, 0)


@dataclass(frozen=True)
class Acceptable:
    """Another result differs by its code alone, and would be accepted instead of computing."""

    node: str
    stage: str
    key: str
    manifest: Manifest
    changes: tuple[CodeChanged, ...]
    versions: tuple[str, ...] = ()

    @property
    def forecast(self) -> Forecast:
        """Nothing is left to compute."""
        return Forecast(0.0, 0)


@dataclass(frozen=True)
class Damaged:
    """The result is in the store, but is not what was published; it is not used."""

    node: str
    stage: str
    key: str
    problems: tuple[str, ...]

    @property
    def forecast(self) -> None:
        """What is known of a damaged result is not believed."""
        return


@dataclass(frozen=True)
class Missing:
    """The store holds no result of this stage at all."""

    node: str
    stage: str
    key: str | None
    resume: CheckpointSummary | None = None

    @property
    def forecast(self) -> None:
        """Nothing is known about the cost."""
        return


@dataclass(frozen=True)
class Changed:
    """The store holds other results of this stage; ``reasons`` tell from the most similar one."""

    node: str
    stage: str
    key: str | None
    reasons: tuple[Reason, ...]
    forecast: Forecast
    resume: CheckpointSummary | None = None


@dataclass(frozen=True)
class Pending:
    """The stages ``waits_for`` must run first; if their results come out the same, this is a hit."""

    node: str
    stage: str
    waits_for: tuple[str, ...]
    forecast: Forecast

    @property
    def key(self) -> None:
        """Not known before the inputs are."""
        return


Verdict: TypeAlias = Hit | Acceptable | Damaged | Missing | Changed | Pending
