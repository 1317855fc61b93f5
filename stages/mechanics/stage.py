"""Stages `mechanics` and `equilibrium`: the film bends under the active stress of its cells."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pipeline.nodes import History, StageRun, stage
from stages.artefacts import Deformation, Equilibria, Laminate, MidSurface, StressSamples
from stages.mechanics.config import EquilibriumConfig, MechanicsConfig

if TYPE_CHECKING:
    from stages.mechanics.body import Balance
    from stages.mechanics.equilibrium import Shape
    from stages.mechanics.imposed import Imposed
    from stages.mechanics.time_loop import Arrival, TimeLoop
    from stages.numerics.bsplines import Array
    from stages.numerics.stepping import Attempt


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

    from stages.mechanics.resumption import packed, unpacked
    from stages.mechanics.setup import build_loop, check_inputs
    from stages.mechanics.time_loop import Arrival
    from stages.numerics.step_control import Control
    from stages.numerics.time_series import FrameReader

    loop = build_loop(config, mid_surface.patch, laminate)
    check_inputs(config, mid_surface.patch, laminate, stress)
    body = loop.dynamics.body
    vector, points = (mid_surface.patch.size, 3), (body.shell.points,)
    history = run.stream(
        Deformation,
        frames=config.n_steps + 1,
        shapes={
            **dict.fromkeys(("displacement", "velocity", "acceleration"), vector),
            **dict.fromkeys(("fibre_stretch", "active_stress"), points),
            **dict.fromkeys(_SCALARS, ()),
        },
    )
    activation = FrameReader(stress.active_stress)

    def imposed(frame: int) -> Imposed:
        return body.imposed_at(frame * config.step, activation(frame))

    saved = run.resume()
    if saved is None:
        halved, start = 0, loop.dynamics.at_rest(imposed(0))
        travel, control = start, Control(config.step)
        _append_motion(history, loop, Arrival(start, control, 0, 0), activation(0))
    else:
        travel, control = unpacked(saved)
        halved = int(saved["halved_steps"])
    first = history.frames_done - 1
    for arrival in loop.run(imposed, travel, first, config.n_steps, control):
        done = history.frames_done
        _append_motion(history, loop, arrival, activation(done))
        if arrival.halvings:
            halved += 1
            run.warn(
                f"time step {done} (to t = {done * config.step:g} ms) converged only in parts of "
                f"{config.step / 2**arrival.halvings:g} ms"
            )
        run.progress(done, config.n_steps)
        run.checkpoint(
            lambda arrival=arrival, halved=halved: {  # type: ignore[misc]  # defaults bind the loop
                **packed(arrival.travel, arrival.control),
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
    from stages.mechanics.loading_log import LoadingLog
    from stages.mechanics.setup import build_statics, check_inputs
    from stages.numerics.time_series import FrameReader

    statics = build_statics(config, mid_surface.patch, laminate)
    check_inputs(config, mid_surface.patch, laminate, stress)
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
    shape, log = statics.unloaded(), LoadingLog()
    if saved is not None:
        shape = Rest(
            saved["displacement"], saved["rate"], float(saved["work"]), float(saved["step"])
        )
        log = LoadingLog.restored(saved)

    def imposed(frame: int) -> Imposed:
        return body.imposed_at(frame * config.step, activation(frame))

    def tell(attempt: Attempt) -> None:
        run.tell(f"t = {attempt.start:.6g} to {attempt.end:.6g} ms: {attempt}")

    frames = statics.run(
        imposed, shape, first=history.frames_done, last=config.n_steps, listen=tell
    )
    for result in frames:
        shape, done = result.state, history.frames_done
        balance = body.balance(shape.displacement, imposed(done))
        _append_shape(history, balance, result)
        for warning in log.look_at(done * config.step, config.step, balance, result):
            run.warn(warning)
        seen = log.saved()
        run.progress(done, config.n_steps)
        run.checkpoint(
            lambda shape=shape, seen=seen: {  # type: ignore[misc]  # defaults bind the loop
                "displacement": shape.displacement,
                "rate": shape.rate,
                "work": shape.work,
                "step": shape.step,
                **seen,
            }
        )
    run.note("divided_steps", log.divided)
    return history.finish(time=np.arange(config.n_steps + 1) * config.step)


_SCALARS = (
    "kinetic_energy",
    "strain_energy",
    "active_work",
    "external_work",
    "dissipated_energy",
    "energy_imbalance",
    "newton_iterations",
    "sub_steps",
    "shortest_step",
    "local_error",
)
"""Fields of a deformation that have one number for each frame."""


def _append_motion(
    history: History[Deformation], loop: TimeLoop, arrival: Arrival, activation: Array
) -> None:
    shell, travel = loop.dynamics.shell, arrival.travel
    motion, works, tally = travel.motion, travel.works, travel.tally
    kinetic, strain = loop.dynamics.kinetic_energy(motion), travel.forces.strain_energy
    stretch = shell.fibre_stretch(motion.displacement)
    history.append(
        displacement=motion.displacement.reshape(-1, 3),
        velocity=motion.velocity.reshape(-1, 3),
        acceleration=motion.acceleration.reshape(-1, 3),
        kinetic_energy=kinetic,
        strain_energy=strain,
        active_work=works.activation,
        external_work=works.external,
        dissipated_energy=works.dissipated,
        energy_imbalance=works.imbalance(kinetic, strain),
        newton_iterations=float(arrival.iterations),
        sub_steps=float(tally.steps),
        shortest_step=min(tally.shortest, loop.step),
        local_error=tally.error,
        fibre_stretch=stretch,
        active_stress=shell.fibres.stress(activation, stretch),
    )


def _append_shape(history: History[Equilibria], balance: Balance, shape: Shape) -> None:
    shell = balance.body.shell
    stretch = shell.fibres.stretch(shell.reference, balance.response.frames)
    history.append(
        displacement=balance.displacement.reshape(-1, 3),
        strain_energy=balance.response.energy,
        external_work=shape.state.work,
        newton_iterations=float(shape.iterations),
        load_step=shape.smallest_step,
        unstable_directions=float(balance.unstable_directions),
        fibre_stretch=stretch,
        active_stress=shell.fibres.stress(balance.imposed.activation, stretch),
    )
