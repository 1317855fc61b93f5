"""Stage `electrophysiology`: the wave of potential and the active stress it leaves behind."""

from __future__ import annotations

from typing import Any

from pipeline.nodes import StageRun, stage
from stages.artefacts import ActivationHistory, ExcitableSurface
from stages.electrophysiology.config import ElectrophysiologyConfig


@stage
def electrophysiology(
    config: ElectrophysiologyConfig, surface: ExcitableSurface, *, run: StageRun
) -> ActivationHistory:
    """Monodomain problem on the active layer, frame by frame from rest at t = 0."""
    import numpy as np

    from stages.electrophysiology.frames import FrameKeeper
    from stages.electrophysiology.front_velocity import front_velocity
    from stages.electrophysiology.monodomain import build
    from stages.electrophysiology.recording import BeatRecorder
    from stages.electrophysiology.tissue import UnstableSolutionError

    stepper, state = build(config, surface.patch)
    beats = BeatRecorder(state.potential, config.activation_threshold, config.initial_potential)
    ends = config.frame_steps
    frames = len(ends)
    history = run.stream(
        ActivationHistory,
        frames=frames,
        shapes={"potential": state.potential.shape, "active_stress": state.potential.shape},
        fewer=config.tolerances is not None,
    )
    keeper = FrameKeeper(history, config.tolerances)
    saved, kept = run.resume(), None
    if saved is not None:
        state.restore(saved)
        beats.restore(saved)
        keeper.restore(saved)
        kept = state.steps
    else:
        keeper.offer(0.0, potential=state.potential, active_stress=state.active_stress)

    def continuation() -> dict[str, Any]:
        nonlocal kept
        kept = state.steps  # called only when it is saved
        return {**state.arrays(), **beats.arrays(), **keeper.arrays()}

    for frame in range(keeper.offered, frames):
        for steps in beats.blocks(ends[frame] - ends[frame - 1]):
            try:
                stepper.advance(state, steps, beats.watch)
            except UnstableSolutionError as error:
                raise error.after(kept) from None
        time = ends[frame] * config.step
        keeper.offer(time, potential=state.potential, active_stress=state.active_stress)
        run.progress(frame, frames - 1)
        run.checkpoint(continuation)
    keeper.flush()
    run.note("diffusion_solver", type(stepper).__name__)
    maps = beats.tables()
    return history.finish(
        time=np.array(keeper.times),
        **maps,
        conduction_velocity=front_velocity(surface.patch, maps["activation_times"]),
    )
