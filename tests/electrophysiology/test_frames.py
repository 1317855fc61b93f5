"""Frames that are left out are given by those around them, within the tolerance."""

from __future__ import annotations

import numpy as np
import pytest

from stages.electrophysiology.frames import FrameKeeper
from stages.numerics.bsplines import Array


class Kept:
    """Frames that were passed on."""

    def __init__(self) -> None:
        self.frames: list[dict[str, Array]] = []

    def append(self, **fields: Array) -> None:
        self.frames.append({name: np.array(values) for name, values in fields.items()})


def kept_of(
    times: Array, tolerances: dict[str, float] | None, **series: Array
) -> tuple[Array, dict[str, Array]]:
    """Times and fields of the kept frames."""
    sink = Kept()
    keeper = FrameKeeper(sink, tolerances)
    for k, time in enumerate(times):
        keeper.offer(float(time), **{name: values[k] for name, values in series.items()})
    keeper.flush()
    fields = {name: np.array([frame[name] for frame in sink.frames]) for name in series}
    return np.array(keeper.times), fields


def between(times: Array, kept: Array, frames: Array) -> Array:
    return np.stack([np.interp(times, kept, column) for column in frames.T], axis=1)


def test_without_tolerances_every_frame_is_kept() -> None:
    times = np.arange(5.0)
    kept, fields = kept_of(times, None, v=np.sin(times)[:, None])
    np.testing.assert_array_equal(kept, times)
    np.testing.assert_array_equal(fields["v"][:, 0], np.sin(times))


@pytest.mark.parametrize("seed", range(5))
def test_every_frame_is_within_the_tolerance_of_the_line_between_kept_ones(seed: int) -> None:
    random = np.random.default_rng(seed)
    times = np.cumsum(random.uniform(0.5, 2.0, 300))
    smooth = np.cumsum(np.cumsum(random.normal(size=(300, 4)), axis=0), axis=0)
    rough = random.normal(size=(300, 3))
    tolerances = {"v": 3.0, "s": 2.5}
    kept, fields = kept_of(times, tolerances, v=smooth, s=rough)
    assert kept.size < 300
    assert (kept[0], kept[-1]) == (times[0], times[-1])
    for name, series in (("v", smooth), ("s", rough)):
        np.testing.assert_array_equal(fields[name], series[np.isin(times, kept)])
        # slopes are divided and multiplied by spans: round-off of values below 1e4
        off = np.abs(between(times, kept, fields[name]) - series).max()
        assert off <= tolerances[name] * (1 + 1e-9)
        assert off > 0.5 * tolerances[name]  # the tolerance is made use of


def test_straight_lines_need_their_ends_and_their_corners() -> None:
    times = np.arange(21.0)
    bent = np.maximum(times - 10.0, 0.0)[:, None]
    kept, _ = kept_of(times, {"v": 1e-9}, v=bent)
    np.testing.assert_array_equal(kept, [0.0, 10.0, 20.0])


def test_a_stopped_keeper_goes_on_as_if_nothing_had_happened() -> None:
    times = np.linspace(0.0, 12.0, 200)
    series = np.sin(times[:, None] + np.arange(3.0))
    whole, fields = kept_of(times, {"v": 0.01}, v=series)
    sink = Kept()
    keeper = FrameKeeper(sink, {"v": 0.01})
    for k, time in enumerate(times):
        keeper.offer(float(time), v=series[k])
        saved = {name: np.copy(value) for name, value in keeper.arrays().items()}
        keeper = FrameKeeper(sink, {"v": 0.01})
        keeper.restore({"steps": np.array(3), **saved})
    assert keeper.offered == 200
    keeper.flush()
    np.testing.assert_array_equal(keeper.times, whole)
    np.testing.assert_array_equal([frame["v"] for frame in sink.frames], fields["v"])
