"""The stage: frames, activation times, and a stopped run that goes on as if nothing had happened."""

from __future__ import annotations

import numpy as np
import pytest

from pipeline.testing import interrupted_and_resumed
from stages.artefacts import ExcitableSurface
from stages.electrophysiology.stage import electrophysiology
from stages.numerics.patches import Patch
from stages.numerics.time_series import TimeSeries
from tests.paper import S1, electrophysiology_config
from tests.problems import parabolic_sheet

SURFACE = ExcitableSurface(Patch.rectangle(3.5, 2.0).refine(2, (24, 4)))


def test_frames_fall_on_the_output_times() -> None:
    config = electrophysiology_config(duration=6.0, n_steps=120, output_interval=0.5)
    history = electrophysiology.compute(config, SURFACE)
    np.testing.assert_allclose(history.time, np.arange(13) * 0.5, rtol=1e-14)
    assert np.asarray(history.potential).shape == (13, SURFACE.patch.size)
    np.testing.assert_array_equal(np.asarray(history.potential[0]), -80.0)


def test_the_output_interval_does_not_change_the_solution() -> None:
    """Frames shared by two runs are equal to the last bit, and so are all maps of beats."""
    config = electrophysiology_config(duration=500.0, n_steps=5000)
    fine, coarse = (
        electrophysiology.compute(config.model_copy(update={"output_interval": t}), SURFACE)
        for t in (4.0, 20.0)
    )
    np.testing.assert_array_equal(np.asarray(fine.potential)[::5], np.asarray(coarse.potential))
    for name in set(vars(fine)) - {"time", "potential", "active_stress"}:
        found = np.asarray(getattr(fine, name))
        np.testing.assert_array_equal(found, np.asarray(getattr(coarse, name)))
        assert np.isfinite(found).any()


def test_activation_times_are_those_of_the_potential() -> None:
    """Crossings noted while stepping equal those of the parabolas through densely stored frames."""
    config = electrophysiology_config(duration=30.0, n_steps=600, output_interval=0.05)
    history = electrophysiology.compute(config, SURFACE)
    potential = np.asarray(history.potential, dtype=float)
    for point in range(0, SURFACE.patch.size, 7):
        v = potential[:, point]
        rise = np.flatnonzero((v[:-1] < -30.0) & (v[1:] >= -30.0))
        roots = [
            np.roots(np.polyfit([-1, 0, 1], v[k - 1 : k + 2], 2) - [0, 0, -30.0])
            for k in rise[rise > 0]
        ]
        exact = [
            0.05 * (k + next(r.real for r in root if -1e-3 <= r.real <= 1.001))
            for k, root in zip(rise[rise > 0], roots, strict=True)
        ]
        found = history.activation_times[point][: len(exact)]
        # frames are float32: 4e-6 mV over a rise of 0.1 mV or more per step
        np.testing.assert_allclose(found[np.isfinite(found)], exact, atol=1e-4)


def test_the_wave_arrives_later_farther_from_the_stimulus() -> None:
    config = electrophysiology_config(duration=60.0, n_steps=1200)
    history = electrophysiology.compute(config, SURFACE)
    first_beat = history.activation_times[:, 0].reshape(26, 6)
    reached = np.isfinite(first_beat[:, 3])
    assert reached.sum() > 6
    assert np.all(np.diff(first_beat[reached, 3]) > 0)


def test_stimuli_may_be_named() -> None:
    library = {"S1": S1, "S2": S1.model_copy(update={"start": 430.0})}
    fields = electrophysiology_config().model_dump() | {
        "cell_model": electrophysiology_config().cell_model,
        "tension_law": electrophysiology_config().tension_law,
        "stimulus_library": library,
    }
    for given in ("S1,S2", "[S1, S2]", ["S1", "S2"], [library["S1"], "S2"]):
        config = electrophysiology_config(
            **fields | {"stimuli": given, "duration": 500.0, "n_steps": 1000}
        )
        assert [s.start for s in config.stimuli] == [0.0, 430.0]
    with pytest.raises(ValueError, match=r"no stimulus is called 'S11'.*did you mean 'S1'"):
        electrophysiology_config(**fields | {"stimuli": "S11"})


def test_frames_fall_on_whole_steps_and_on_the_end() -> None:
    """Steps of 0.08 ms and an interval of 1 ms: every 12 steps (0.96 ms), and the last, the 250th."""
    config = electrophysiology_config(duration=20.0, n_steps=250, output_interval=1.0)
    history = electrophysiology.compute(config, SURFACE)
    np.testing.assert_allclose(history.time[:3], [0.0, 0.96, 1.92], rtol=1e-15)
    np.testing.assert_allclose(history.time[-2:], [240 * 0.08, 20.0], rtol=1e-15)
    assert np.asarray(history.potential).shape[0] == history.time.size == 22


def test_frames_may_be_stored_only_as_densely_as_a_tolerance_demands() -> None:
    config = electrophysiology_config(duration=500.0, n_steps=5000)
    thin = config.model_copy(update={"output_tolerance": 1.0, "output_stress_tolerance": 0.2})
    every, few = (electrophysiology.compute(c, SURFACE) for c in (config, thin))
    assert few.time.size < 0.5 * every.time.size
    assert (few.time[0], few.time[-1]) == (0.0, 500.0)
    for name, allowed in (("potential", 1.0), ("active_stress", 0.2)):
        kept = TimeSeries(getattr(few, name), few.time)
        frames = np.asarray(getattr(every, name), dtype=float)
        off = max(np.abs(kept.at(t) - frames[k]).max() for k, t in enumerate(every.time))
        assert off <= allowed + 1e-4  # kept in single precision
    for name in set(vars(every)) - {"time", "potential", "active_stress"}:
        np.testing.assert_array_equal(getattr(few, name), getattr(every, name))
    with pytest.raises(ValueError, match="both, or neither"):
        electrophysiology_config(output_tolerance=1.0)


@pytest.mark.parametrize(
    ("after", "tolerance"),
    [(2, None), (5, None), (13, None), (2, 2.0), (4, 2.0)],
    ids=["first frame", "in between", "last frame", "first of few frames", "some of few frames"],
)
@pytest.mark.parametrize(
    "patch",
    [SURFACE.patch, parabolic_sheet(0.5, 3.5, 2.0).refine(2, (24, 4))],
    ids=["flat", "curved"],
)
def test_a_stopped_run_goes_on_as_if_nothing_had_happened(
    patch: Patch, after: int, tolerance: float | None
) -> None:
    stress = tolerance and 0.1 * tolerance
    config = electrophysiology_config(
        duration=12.0, n_steps=240, output_tolerance=tolerance, output_stress_tolerance=stress
    )
    surface = ExcitableSurface(patch)
    unbroken = electrophysiology.compute(config, surface)
    resumed = interrupted_and_resumed(electrophysiology, config, surface, after=after)
    assert np.isfinite(unbroken.activation_times).any()
    for field in vars(unbroken):
        np.testing.assert_array_equal(
            np.asarray(getattr(resumed, field)), np.asarray(getattr(unbroken, field))
        )
