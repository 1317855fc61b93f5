"""Which frames are kept: all of them, or only those that interpolation between others does not give."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np

from stages.numerics.bsplines import Array


class Sink(Protocol):
    """Where frames go."""

    def append(self, **fields: Array) -> None:
        """Keep one more."""


class FrameKeeper:
    """Passes frames on to a history, and knows their times.

    With tolerances, a frame is left out if the straight line between the two kept ones around it comes as
    near as the tolerance in every field at every point. From the last kept frame on, each frame that
    is left out bounds the slope of that line at each point; the first frame that the bounds do not admit
    makes the one before it a kept one ("swinging door").

    Parameters
    ----------
    sink
        Takes the frames that are kept.
    tolerances
        By the fields' names, in their units; none: every frame is kept.

    References
    ----------
    Bristol (1990), Swinging door trending: adaptive trend recording, ISA National Conf. Proc., 749-756.
    """

    def __init__(self, sink: Sink, tolerances: Mapping[str, float] | None) -> None:
        self._sink, self._tolerances = sink, tolerances
        self.offered = 0
        self.times: list[float] = []
        self._waiting: dict[str, Any] = {}

    def offer(self, time: float, **fields: Array) -> None:
        """The next frame; the fields may change afterwards."""
        self.offered += 1
        if self._tolerances is None or not self.times:
            self._keep(time, fields)
            if self._tolerances is not None:
                self._begin(time, fields)
        elif not self._admits(time, fields):
            self.flush()
            self._admits(time, fields)

    def flush(self) -> None:
        """Keep the frame that still waits for the next one; to be called at the end."""
        if self._waiting and "last" in self._waiting:
            time = float(self._waiting["last"])
            fields = {name: self._waiting[f"last_{name}"] for name in self._tolerances or {}}
            self._keep(time, fields)
            self._begin(time, fields)

    def arrays(self) -> dict[str, Any]:
        """Everything that a continuation needs."""
        waiting = {f"frames_{name}": value for name, value in self._waiting.items()}
        return {"frame_times": np.array(self.times), "frames_offered": self.offered, **waiting}

    def restore(self, saved: Mapping[str, Any]) -> None:
        """Go on from :meth:`arrays`; other entries of ``saved`` are ignored."""
        self.times = [float(t) for t in saved["frame_times"]]
        self.offered = int(saved["frames_offered"])
        mark = "frames_"
        self._waiting = {
            name.removeprefix(mark): np.array(value)
            for name, value in saved.items()
            if name.startswith(mark) and name != "frames_offered"
        }

    def _keep(self, time: float, fields: Mapping[str, Array]) -> None:
        self._sink.append(**fields)
        self.times.append(time)

    def _begin(self, time: float, fields: Mapping[str, Array]) -> None:
        """Lines start from this frame, and nothing bounds them yet."""
        self._waiting = {"start": np.array(time)}
        for name, values in fields.items():
            self._waiting[f"start_{name}"] = np.array(values)
            self._waiting[f"low_{name}"] = np.full(values.shape, -np.inf)
            self._waiting[f"high_{name}"] = np.full(values.shape, np.inf)

    def _admits(self, time: float, fields: Mapping[str, Array]) -> bool:
        """Whether a line to this frame keeps to all bounds; then the frame waits, and bounds, too."""
        w, span = self._waiting, time - float(self._waiting["start"])
        slopes = {name: (values - w[f"start_{name}"]) / span for name, values in fields.items()}
        if not all(
            ((slope >= w[f"low_{name}"]) & (slope <= w[f"high_{name}"])).all()
            for name, slope in slopes.items()
        ):
            return False
        w["last"] = np.array(time)
        for name, allowed in (self._tolerances or {}).items():
            w[f"last_{name}"] = np.array(fields[name])
            w[f"low_{name}"] = np.maximum(w[f"low_{name}"], slopes[name] - allowed / span)
            w[f"high_{name}"] = np.minimum(w[f"high_{name}"], slopes[name] + allowed / span)
        return True
