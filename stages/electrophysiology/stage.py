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

    from stages.electrophysiology.monodomain import build
    from stages.electrophysiology.recording import Crossings, frame_blocks

    stepper, state = build(config, surface.patch)
    crossings = Crossings(surface.patch.size)
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
        crossings.restore(saved)
    else:
        history.append(potential=state.potential, active_stress=state.active_stress)
    for frame in range(history.frames_done, frames):
        for steps in frame_blocks(ends[frame] - ends[frame - 1], config.step):
            stepper.advance(state, steps, crossings.fresh())
            crossings.collect()
        state.check_finite(config.step)
        history.append(potential=state.potential, active_stress=state.active_stress)
        run.progress(frame, frames - 1)
        run.checkpoint(lambda: {**state.arrays(), **crossings.arrays()})
    run.note("diffusion_solver", type(stepper).__name__)
    times = crossings.table()
    unknown = np.full_like(times, np.nan)
    return history.finish(
        time=np.array(ends) * config.step,
        activation_times=times,
        repolarisation_times=unknown,
        apd50=unknown,
        apd90=unknown,
        peak_potential=unknown,
        conduction_velocity=np.full((*times.shape, 3), np.nan),
    )
