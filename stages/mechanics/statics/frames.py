"""Stored shapes of a quasi-static run, whatever controls it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from stages.mechanics.body.body import Balance, Body
from stages.mechanics.body.imposed import Imposed
from stages.mechanics.statics.equilibrium import QuasiStatics, Rest
from stages.mechanics.statics.loading_log import LoadingLog
from stages.numerics.stepping import Attempt


@dataclass(frozen=True)
class Frame:
    """A shape to be stored.

    Attributes
    ----------
    balance
        The equilibrium.
    factor
        Load factor.
    work
        What loads and moved supports have done since the unloaded film, kPa mm^3.
    iterations, smallest_step
        Newton iterations since the last frame, and the shortest load step, ms.
    state
        What the frames after this one depend on, for a checkpoint.
    warnings
        What is new about it.
    """

    balance: Balance
    factor: float
    work: float
    iterations: int
    smallest_step: float
    state: Mapping[str, Any]
    warnings: tuple[str, ...] = ()


class Controlled(Protocol):
    """A run under some control."""

    log: LoadingLog

    @property
    def body(self) -> Body:
        """The film with its supports and loads."""
        ...

    def frames(
        self, saved: Mapping[str, Any] | None, first: int, tell: Callable[[str], None]
    ) -> Iterator[Frame]:
        """Frames from ``first`` on; ``saved`` is the state of the one before, if there is one."""
        ...


@dataclass
class ByLoad:
    """Frames at equal intervals of a loading.

    Parameters
    ----------
    statics
        Finds the equilibria.
    imposed
        What acts in a frame.
    last
        Number of the last frame.
    """

    statics: QuasiStatics
    imposed: Callable[[int], Imposed]
    last: int
    log: LoadingLog = field(default_factory=LoadingLog)

    @property
    def body(self) -> Body:
        """The film."""
        return self.statics.body

    def frames(
        self, saved: Mapping[str, Any] | None, first: int, tell: Callable[[str], None]
    ) -> Iterator[Frame]:
        """See :class:`Controlled`."""
        rest, interval = self.statics.unloaded(), self.statics.step
        if saved is not None:
            rest = Rest(
                saved["displacement"], saved["rate"], float(saved["work"]), float(saved["step"])
            )
            self.log = LoadingLog.restored(saved)

        def listen(attempt: Attempt) -> None:
            tell(f"{_span(attempt.start, attempt.end, interval)}: {attempt}")

        shapes = self.statics.run(self.imposed, rest, first, self.last, listen)
        for number, shape in enumerate(shapes, start=first):
            rest = shape.state
            balance = self.body.balance(rest.displacement, self.imposed(number))
            look = self.log.look_at_frame(number * interval, interval, balance, shape)
            warnings = tuple(look)
            state = {
                "displacement": rest.displacement,
                "rate": rest.rate,
                "work": rest.work,
                "step": rest.step,
                **self.log.saved(),
            }
            yield Frame(
                balance, 1.0, rest.work, shape.iterations, shape.smallest_step, state, warnings
            )


def _span(start: float, end: float, interval: float) -> str:
    """A load step in words; those before t = 0 lead from the unloaded film to what acts then.

    Examples
    --------
    >>> _span(4.0, 8.0, 4.0)
    't = 4 to 8 ms'
    >>> _span(-2.0, 0.0, 4.0)
    'from 50 to 100 % of what acts at t = 0 ms'
    """
    if start < 0.0:
        first, last = (100.0 * (1.0 + time / interval) for time in (start, end))
        return f"from {first:.4g} to {last:.4g} % of what acts at t = 0 ms"
    return f"t = {start:.6g} to {end:.6g} ms"
