"""Stage `electrophysiology`: the wave of potential and the active stress it leaves behind."""

from __future__ import annotations

from pipeline.nodes import StageRun, stage
from stages.artefacts import ActivationHistory, ExcitableSurface
from stages.electrophysiology.config import ElectrophysiologyConfig


@stage
def electrophysiology(
    config: ElectrophysiologyConfig, surface: ExcitableSurface, *, run: StageRun
) -> ActivationHistory:
    """Monodomain problem on the active layer, frame by frame from rest at t = 0."""
    import numpy as np

    from stages.electrophysiology.fronts import front_velocity
    from stages.electrophysiology.monodomain import build
    from stages.electrophysiology.recording import BeatRecorder

    stepper, state = build(config, surface.patch)
    beats = BeatRecorder(state.potential, config.activation_threshold, config.initial_potential)
    ends = config.frame_steps
    frames = len(ends)
    history = run.stream(
        ActivationHistory,
        frames=frames,
        shapes={"potential": state.potential.shape, "active_stress": state.potential.shape},
    )
    saved = run.resume()
    if saved is not None:
        state.restore(saved)
        beats.restore(saved)
    else:
        history.append(potential=state.potential, active_stress=state.active_stress)
    for frame in range(history.frames_done, frames):
        for steps in beats.blocks(ends[frame] - ends[frame - 1]):
            stepper.advance(state, steps, beats.watch)
        state.check_finite(config.step)
        history.append(potential=state.potential, active_stress=state.active_stress)
        run.progress(frame, frames - 1)
        run.checkpoint(lambda: {**state.arrays(), **beats.arrays()})
    run.note("diffusion_solver", type(stepper).__name__)
    maps = beats.tables()
    return history.finish(
        time=np.array(ends) * config.step,
        **maps,
        conduction_velocity=front_velocity(surface.patch, maps["activation_times"]),
    )
