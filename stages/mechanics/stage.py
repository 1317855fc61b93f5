"""Stages `mechanics`, `equilibrium`, `buckling`: the film bends under its muscle and its loads."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pipeline.nodes import History, StageRun, stage
from stages.artefacts import (
    BucklingModes,
    Deformation,
    Equilibria,
    Laminate,
    MidSurface,
    StressSamples,
)
from stages.mechanics.config import EquilibriumConfig, MechanicsConfig

if TYPE_CHECKING:
    from stages.mechanics.body.imposed import Imposed
    from stages.mechanics.dynamics.time_loop import Arrival, TimeLoop
    from stages.mechanics.statics.frames import Frame
    from stages.numerics.bsplines import Array


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

    from stages.mechanics.dynamics.resumption import packed, unpacked
    from stages.mechanics.dynamics.time_loop import Arrival
    from stages.mechanics.setup import build_loop, check_inputs
    from stages.mechanics.shell.locking import locked
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
        run.tell(f"to t = {done * config.step:.6g} ms: {arrival}")
        run.progress(done, config.n_steps)
        run.checkpoint(
            lambda arrival=arrival, halved=halved: {  # type: ignore[misc]  # defaults bind the loop
                **packed(arrival.travel, arrival.control),
                "halved_steps": halved,
            }
        )
    run.note("halved_steps", halved)
    deformation = history.finish(time=np.arange(config.n_steps + 1) * config.step)
    for warning in locked(body.shell, deformation.displacement):
        run.warn(warning)
    return deformation


@stage
def equilibrium(
    config: EquilibriumConfig,
    mid_surface: MidSurface,
    laminate: Laminate,
    stress: StressSamples,
    *,
    run: StageRun,
) -> Equilibria:
    """Shapes of the film in balance with a slow loading (eqs. 45, 52).

    By load, frame i belongs to t_i = i duration/n_steps; frame 0 is reached from the unloaded film, every
    further one from the frame before it. By arc length, frames are points of the path on which what acts at
    the last instant acts times a load factor, frame 0 the unloaded film.
    """
    import numpy as np

    from stages.mechanics.setup import build_controlled
    from stages.mechanics.shell.locking import locked

    controlled = build_controlled(config, mid_surface.patch, laminate, stress)
    points = (controlled.body.shell.points,)
    history = run.stream(
        Equilibria,
        frames=config.n_steps + 1,
        shapes={
            "displacement": (mid_surface.patch.size, 3),
            **dict.fromkeys(("fibre_stretch", "active_stress"), points),
            **dict.fromkeys(_SHAPE_SCALARS, ()),
        },
        fewer=config.control.kind != "load",
    )
    for frame in controlled.frames(run.resume(), history.frames_done, run.tell):
        _append_shape(history, frame)
        for warning in frame.warnings:
            run.warn(warning)
        run.progress(history.frames_done - 1, config.n_steps)
        run.checkpoint(lambda frame=frame: frame.state)  # type: ignore[misc]  # binds the loop
    log = controlled.log
    run.note("divided_steps", log.divided)
    shapes = history.finish(
        time=np.arange(history.frames_done) * config.step,
        limit_loads=np.array(log.limits),
        bifurcation_loads=np.array(log.bifurcations),
    )
    for warning in locked(controlled.body.shell, shapes.displacement):
        run.warn(warning)
    return shapes


@stage
def buckling(
    config: EquilibriumConfig,
    mid_surface: MidSurface,
    laminate: Laminate,
    stress: StressSamples,
    *,
    run: StageRun,
) -> BucklingModes:
    """Factors of what acts at the last instant that buckle the film, linearised at the film at rest."""
    from stages.mechanics.setup import build_statics, check_inputs
    from stages.mechanics.statics.buckling import motion_before, scaled_modes
    from stages.numerics.time_series import FrameReader

    body = build_statics(config, mid_surface.patch, laminate).body
    check_inputs(config, mid_surface.patch, laminate, stress)
    activation = FrameReader(stress.active_stress)(config.n_steps)
    full = body.imposed_at(config.duration, activation)
    factors, shapes = scaled_modes(body, full, config.buckling_modes)
    motion = motion_before(body, full, float(factors[0]))
    if motion > _FLAT * laminate.thickness:
        run.warn(
            f"the buckling factors are not to be relied on: they belong to a film that stays flat, but "
            f"this one would have bent by {motion / laminate.thickness:.2g} of its thickness before; "
            f"follow it by arc length (mechanics.control.kind = arc-length)"
        )
    return BucklingModes(factors, shapes)


_FLAT = 0.01
"""Motion across a film, relative to its thickness, that a linearisation at the flat film may neglect."""

_SHAPE_SCALARS = (
    "strain_energy",
    "external_work",
    "newton_iterations",
    "load_step",
    "load_factor",
    "unstable_directions",
)
"""Fields of equilibria that have one number for each frame."""

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


def _append_shape(history: History[Equilibria], frame: Frame) -> None:
    balance = frame.balance
    shell = balance.body.shell
    stretch = shell.fibres.stretch(shell.reference, balance.response.frames)
    history.append(
        displacement=balance.displacement.reshape(-1, 3),
        strain_energy=balance.response.energy,
        external_work=frame.work,
        newton_iterations=float(frame.iterations),
        load_step=frame.smallest_step,
        load_factor=frame.factor,
        unstable_directions=float(balance.unstable_directions),
        fibre_stretch=stretch,
        active_stress=shell.fibres.stress(balance.imposed.activation, stretch),
    )
