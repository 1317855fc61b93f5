"""Active stress arrives at the shell's points and times as the spline says, and is never guessed."""

from __future__ import annotations

import numpy as np
import pytest

from pipeline.testing import interrupted_and_resumed
from stages.activation.config import TransferConfig
from stages.activation.stage import activation
from stages.artefacts import ActivationHistory, ExcitableSurface, MidSurface
from stages.numerics.patches import Patch
from stages.numerics.time_series import TimesNotCoveredError
from tests.histories import history_with

FILM = Patch.rectangle(3.5, 2.0)
SURFACE = FILM.refine(2, (20, 12))
SHELL = FILM.refine(2, (8, 4))


def history_of(times: np.ndarray, frames: np.ndarray) -> ActivationHistory:
    return history_with(times, frames, frames, np.full((frames.shape[1], 0), np.nan))


def test_the_stage_samples_the_mechanics_times_and_scales() -> None:
    times = np.arange(0.0, 21.0)
    frames = times[:, None] * np.ones((1, SURFACE.size))
    config = TransferConfig(scale=0.5, transfer="spline", duration=20.0, n_steps=8, points=3)
    samples = activation.compute(
        config, history_of(times, frames), ExcitableSurface(SURFACE), MidSurface(SHELL)
    )
    np.testing.assert_array_equal(samples.time, np.arange(9) * 2.5)  # binary fractions
    stress = np.asarray(samples.active_stress)
    assert stress.shape == (9, 8 * 3 * 4 * 3)
    exact = 0.5 * np.arange(9) * 2.5
    # constant in space, linear in time: round-off of values up to 10
    np.testing.assert_allclose(
        stress, np.broadcast_to(exact[:, None], stress.shape), rtol=0, atol=1e-13
    )


def test_a_shell_that_outlasts_the_cells_is_refused() -> None:
    times = np.arange(0.0, 11.0)
    config = TransferConfig(scale=1.0, transfer="spline", duration=20.0, n_steps=8, points=3)
    expected = (
        "^active stress is needed from 0 to 20 ms, "
        "but the electrophysiology ran from 0 to 10 ms only$"
    )
    with pytest.raises(TimesNotCoveredError, match=expected) as refusal:
        activation.compute(
            config,
            history_of(times, np.zeros((11, SURFACE.size))),
            ExcitableSurface(SURFACE),
            MidSurface(SHELL),
        )
    assert "electrophysiology.duration" in refusal.value.remedy
    assert "mechanics.duration" in refusal.value.remedy


@pytest.mark.parametrize("after", [1, 4, 9], ids=["first frame", "in between", "last frame"])
def test_a_stopped_transfer_goes_on_as_if_nothing_had_happened(after: int) -> None:
    times = np.arange(0.0, 21.0)
    frames = np.random.default_rng(2).normal(size=(21, SURFACE.size))
    config = TransferConfig(scale=0.5, transfer="spline", duration=20.0, n_steps=8, points=3)
    inputs = (history_of(times, frames), ExcitableSurface(SURFACE), MidSurface(SHELL))
    unbroken = activation.compute(config, *inputs)
    resumed = interrupted_and_resumed(activation, config, *inputs, after=after)
    np.testing.assert_array_equal(
        np.asarray(resumed.active_stress), np.asarray(unbroken.active_stress)
    )
