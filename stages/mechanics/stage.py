"""Stage `mechanics`: the film bends under the active stress of its cells."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pipeline.nodes import History, StageRun, stage
from stages.artefacts import Deformation, Laminate, MidSurface, StressSamples
from stages.mechanics.config import MechanicsConfig

if TYPE_CHECKING:
    from stages.mechanics.dynamics import TimeLoop
    from stages.numerics.time_stepping import Motion


@stage
def mechanics(
    config: MechanicsConfig,
    mid_surface: MidSurface,
    laminate: Laminate,
    stress: StressSamples,
    *,
    run: StageRun,
) -> Deformation:
    """Motion of the film from rest, step by step (secs. 3.1-3.2)."""
    import numpy as np

    from stages.mechanics.setup import build_loop, check_inputs
    from stages.numerics.time_series import FrameReader
    from stages.numerics.time_stepping import Motion

    loop = build_loop(config, mid_surface.patch, laminate)
    check_inputs(config, mid_surface.patch, stress)
    vector = (mid_surface.patch.size, 3)
    history = run.stream(
        Deformation,
        frames=config.n_steps + 1,
        shapes={
            "displacement": vector,
            "velocity": vector,
            "acceleration": vector,
            "kinetic_energy": (),
            "strain_energy": (),
            "newton_iterations": (),
        },
    )
    saved = run.resume()
    if saved is None:
        motion, halved = loop.dynamics.at_rest(), 0
        _append(history, loop, motion, iterations=0)
    else:
        motion = Motion(saved["displacement"], saved["velocity"], saved["acceleration"])
        halved = int(saved["halved_steps"])
    steps = loop.run(
        FrameReader(stress.active_stress),
        motion,
        first=history.frames_done - 1,
        last=config.n_steps,
    )
    for result in steps:
        motion = result.state
        _append(history, loop, motion, result.iterations)
        done = history.frames_done - 1
        if result.halvings:
            halved += 1
            run.warn(
                f"time step {done} (to t = {done * config.step:g} ms) converged only in parts of "
                f"{config.step / 2**result.halvings:g} ms"
            )
        run.progress(done, config.n_steps)
        run.checkpoint(
            lambda motion=motion, halved=halved: {  # type: ignore[misc]  # defaults bind the loop
                "displacement": motion.displacement,
                "velocity": motion.velocity,
                "acceleration": motion.acceleration,
                "halved_steps": halved,
            }
        )
    run.note("halved_steps", halved)
    return history.finish(time=np.arange(config.n_steps + 1) * config.step)


def _append(history: History[Deformation], loop: TimeLoop, motion: Motion, iterations: int) -> None:
    kinetic, strain = loop.dynamics.energies(motion)
    history.append(
        displacement=motion.displacement.reshape(-1, 3),
        velocity=motion.velocity.reshape(-1, 3),
        acceleration=motion.acceleration.reshape(-1, 3),
        kinetic_energy=kinetic,
        strain_energy=strain,
        newton_iterations=float(iterations),
    )
