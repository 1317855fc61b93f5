"""Stages `mechanics` and `equilibrium`: the film bends under the active stress of its cells."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pipeline.nodes import History, StageRun, stage
from stages.artefacts import Deformation, Equilibria, Laminate, MidSurface, StressSamples
from stages.mechanics.config import EquilibriumConfig, MechanicsConfig

if TYPE_CHECKING:
    from stages.mechanics.dynamics import TimeLoop
    from stages.mechanics.equilibrium import QuasiStatics, Rest
    from stages.mechanics.imposed import Imposed
    from stages.numerics.bsplines import Array
    from stages.numerics.halving import Advance
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
    body = loop.dynamics.body
    vector, points = (mid_surface.patch.size, 3), (body.shell.points,)
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
            "fibre_stretch": points,
            "active_stress": points,
        },
    )
    activation = FrameReader(stress.active_stress)
    saved = run.resume()
    if saved is None:
        motion, halved = loop.dynamics.at_rest(), 0
        _append_motion(history, loop, motion, activation(0), iterations=0)
    else:
        motion = Motion(saved["displacement"], saved["velocity"], saved["acceleration"])
        halved = int(saved["halved_steps"])
    steps = loop.run(
        lambda i: body.imposed_at(i * config.step, activation(i)),
        motion,
        first=history.frames_done - 1,
        last=config.n_steps,
    )
    for result in steps:
        motion = result.state
        done = history.frames_done
        _append_motion(history, loop, motion, activation(done), result.iterations)
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


@stage
def equilibrium(
    config: EquilibriumConfig,
    mid_surface: MidSurface,
    laminate: Laminate,
    stress: StressSamples,
    *,
    run: StageRun,
) -> Equilibria:
    """Shapes of the film in balance with a slowly changing activation (eqs. 45, 52).

    Frame i belongs to t_i = i duration/n_steps. Frame 0 is reached from the unloaded film, every further
    one from the frame before it.
    """
    import numpy as np

    from stages.mechanics.equilibrium import Rest
    from stages.mechanics.setup import build_statics, check_inputs
    from stages.numerics.time_series import FrameReader

    statics = build_statics(config, mid_surface.patch, laminate)
    check_inputs(config, mid_surface.patch, stress)
    body = statics.body
    points = (body.shell.points,)
    history = run.stream(
        Equilibria,
        frames=config.n_steps + 1,
        shapes={
            "displacement": (mid_surface.patch.size, 3),
            "strain_energy": (),
            "external_work": (),
            "newton_iterations": (),
            "load_step": (),
            "unstable_directions": (),
            "fibre_stretch": points,
            "active_stress": points,
        },
    )
    activation = FrameReader(stress.active_stress)
    saved = run.resume()
    shape, divided = statics.unloaded(), 0
    if saved is not None:
        shape = Rest(saved["displacement"], saved["rate"], float(saved["work"]))
        divided = int(saved["divided_steps"])

    def imposed(frame: int) -> Imposed:
        return body.imposed_at(frame * config.step, activation(frame))

    for result in statics.run(imposed, shape, first=history.frames_done, last=config.n_steps):
        shape = result.state
        done = history.frames_done
        _append_shape(history, statics, result, imposed(done))
        if result.halvings:
            divided += 1
            run.warn(
                f"load step {done} (to t = {done * config.step:g} ms) converged only in parts of "
                f"{config.step / 2**result.halvings:g} ms"
            )
        run.progress(done, config.n_steps)
        run.checkpoint(
            lambda shape=shape, divided=divided: {  # type: ignore[misc]  # defaults bind the loop
                "displacement": shape.displacement,
                "rate": shape.rate,
                "work": shape.work,
                "divided_steps": divided,
            }
        )
    run.note("divided_steps", divided)
    return history.finish(time=np.arange(config.n_steps + 1) * config.step)


def _append_motion(
    history: History[Deformation],
    loop: TimeLoop,
    motion: Motion,
    activation: Array,
    iterations: int,
) -> None:
    shell = loop.dynamics.shell
    response = shell.respond(motion.displacement, activation)
    stretch = shell.fibres.stretch(shell.reference, response.frames)
    history.append(
        displacement=motion.displacement.reshape(-1, 3),
        velocity=motion.velocity.reshape(-1, 3),
        acceleration=motion.acceleration.reshape(-1, 3),
        kinetic_energy=loop.dynamics.kinetic_energy(motion),
        strain_energy=response.energy,
        newton_iterations=float(iterations),
        fibre_stretch=stretch,
        active_stress=shell.fibres.stress(activation, stretch),
    )


def _append_shape(
    history: History[Equilibria],
    statics: QuasiStatics,
    result: Advance[Rest],
    imposed: Imposed,
) -> None:
    shell, displacement = statics.body.shell, result.state.displacement
    balance = statics.body.balance(displacement, imposed)
    stretch = shell.fibres.stretch(shell.reference, balance.response.frames)
    history.append(
        displacement=displacement.reshape(-1, 3),
        strain_energy=balance.response.energy,
        external_work=result.state.work,
        newton_iterations=float(result.iterations),
        load_step=statics.step / 2**result.halvings,
        unstable_directions=float(balance.unstable_directions),
        fibre_stretch=stretch,
        active_stress=shell.fibres.stress(imposed.activation, stretch),
    )
