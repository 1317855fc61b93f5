"""Frames are read once by blocks, fields are linear in time, and nothing is extrapolated."""

from __future__ import annotations

import numpy as np
import pytest

from stages.numerics.time_series import (
    BLOCK,
    FrameReader,
    TimeSeries,
    TimesNotCoveredError,
    blocks,
)


class Counted:
    """Stored frames 0, 1, 2, ... in single precision; counts the blocks that are read."""

    def __init__(self, count: int, chunk: int | None = None) -> None:
        self.shape = (count, 1)
        self.reads = 0
        if chunk is not None:
            self.chunks = (chunk, 1)

    def __getitem__(self, part: slice) -> np.ndarray:
        self.reads += 1
        return np.arange(self.shape[0], dtype=np.float32)[part, None]


def test_fields_are_linear_between_two_frames_and_exact_on_them() -> None:
    series = TimeSeries(
        np.array([[0.0], [10.0], [20.0], [0.0]]),
        np.array([0.0, 1.0, 2.0, 4.0]),
    )
    wanted = {0.0: 0.0, 0.25: 2.5, 1.0: 10.0, 3.0: 10.0, 4.0: 0.0}  # binary fractions: no rounding
    assert {time: float(series.at(time)[0]) for time in wanted} == wanted


@pytest.mark.parametrize("wanted", [[-0.1, 1.0], [0.0, 4.1], [4.1, 0.0], [np.nan]])
def test_times_outside_the_history_are_refused(wanted: list[float]) -> None:
    series = TimeSeries(np.zeros((5, 1)), np.arange(5.0), known="cells ran", remedy="run longer")
    with pytest.raises(TimesNotCoveredError, match="but cells ran from 0 to 4 ms only") as refusal:
        series.check_covers(np.array(wanted))
    assert refusal.value.given == (0.0, 4.0)
    assert refusal.value.remedy == "run longer"


def test_one_time_outside_the_history_is_named() -> None:
    with pytest.raises(TimesNotCoveredError, match=r"^the field is needed at 4\.1 ms") as refusal:
        TimeSeries(np.zeros((5, 1)), np.arange(5.0)).at(4.1)
    assert refusal.value.wanted == (4.1, 4.1)


@pytest.mark.parametrize("time", [0.1 * 3, 10.0 * (1 + 1e-12), -1e-12])
def test_a_time_that_differs_by_rounding_is_the_frame_s_own(time: float) -> None:
    """0.1 * 3 is not 0.3, and a last time may lie a rounding beyond the last frame."""
    times = np.array([0.0, 0.3, 10.0])
    found = TimeSeries(np.array([[1.0], [2.0], [3.0]]), times).at(time)
    assert float(found[0]) == {0: 1.0, 3: 2.0, 100: 3.0}[round(10 * time)]


def test_a_single_frame_is_known_at_its_own_time_only() -> None:
    series = TimeSeries(np.array([[7.0]]), np.array([0.0]))
    assert float(series.at(0.0)[0]) == 7.0
    with pytest.raises(TimesNotCoveredError):
        series.at(1e-3)


@pytest.mark.parametrize("chunk", [None, 64, 10])
def test_growing_times_read_every_block_once(chunk: int | None) -> None:
    """Also where many times fall between the last frame of a block and the first of the next."""
    frames = Counted(200, chunk)
    series = TimeSeries(frames, 0.5 * np.arange(200.0))
    times = np.linspace(0.0, 99.5, 1001)
    found = [float(series.at(time)[0]) for time in times]
    # linear data: round-off of values up to 200
    np.testing.assert_allclose(found, 2.0 * times, rtol=1e-13, atol=1e-13)
    assert frames.reads == -(-200 // (chunk or BLOCK))


def test_blocks_cover_all_frames_once_in_double_precision() -> None:
    frames = Counted(23, chunk=10)
    parts = list(blocks(frames))
    assert [(part.start, part.stop) for part, _ in parts] == [(0, 10), (10, 20), (20, 23)]
    assert all(block.dtype == np.float64 for _, block in parts)
    np.testing.assert_array_equal(np.concatenate([b for _, b in parts])[:, 0], np.arange(23.0))
    assert frames.reads == 3


def test_an_array_without_chunks_is_read_by_blocks_of_the_usual_length() -> None:
    lengths = [len(block) for _, block in blocks(np.zeros((2 * BLOCK + 3, 1)))]
    assert lengths == [BLOCK, BLOCK, 3]


def test_frames_are_read_by_number() -> None:
    frames = Counted(100)
    read = FrameReader(frames)
    assert [float(read(i)[0]) for i in (0, 63, 64, 99, 63)] == [0.0, 63.0, 64.0, 99.0, 63.0]
    assert frames.reads == 2
