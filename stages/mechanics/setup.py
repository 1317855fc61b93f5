"""From configuration and records to the time loop; checks that the inputs belong together."""

from __future__ import annotations

import numpy as np

from stages.artefacts import Laminate, StressSamples
from stages.mechanics.body.body import Body
from stages.mechanics.body.imposed import Imposed
from stages.mechanics.body.rigid import check_is_held
from stages.mechanics.config import EquilibriumConfig, MechanicsConfig, ShellConfig
from stages.mechanics.controls.arc_length import ArcLength
from stages.mechanics.dynamics.dynamics import ShellDynamics
from stages.mechanics.dynamics.time_loop import TimeLoop
from stages.mechanics.shell.shell import Shell, build_shell
from stages.mechanics.statics.arc_path import ByArcLength
from stages.mechanics.statics.equilibrium import QuasiStatics
from stages.mechanics.statics.frames import ByLoad, Controlled
from stages.numerics.integration import Integrator
from stages.numerics.newton import NewtonControls
from stages.numerics.patches import Patch
from stages.numerics.time_series import FrameReader
from stages.numerics.time_stepping import GeneralizedAlpha


def build_loop(config: MechanicsConfig, patch: Patch, laminate: Laminate) -> TimeLoop:
    """Time loop of the configured shell.

    Raises
    ------
    ValueError
        If the laminate has a layer without material.
    """
    body = body_of(config, patch, laminate)
    dynamics = ShellDynamics.build(
        body, damping=config.damping, stiffness_damping=config.stiffness_damping
    )
    adaptive = config.step_control == "adaptive"
    scheme = GeneralizedAlpha.damping_to(config.spectral_radius)
    return TimeLoop(
        dynamics,
        Integrator(scheme, controls_of(config, body.shell), shifts=adaptive),
        config.step,
        config.max_halvings,
        config.error_tolerance if adaptive else None,
        config.max_substeps,
    )


def build_statics(config: EquilibriumConfig, patch: Patch, laminate: Laminate) -> QuasiStatics:
    """Quasi-static loop of the configured shell.

    Raises
    ------
    ValueError
        If the laminate has a layer without material.
    """
    body = body_of(config, patch, laminate)
    check_is_held(body)
    return QuasiStatics(
        body,
        controls_of(config, body.shell),
        config.step,
        config.max_halvings,
        config.initial_increment,
    )


def build_controlled(
    config: EquilibriumConfig, patch: Patch, laminate: Laminate, stress: StressSamples
) -> Controlled:
    """Quasi-static run of the configured shell under the configured control.

    Raises
    ------
    ValueError
        If nothing would move the film, it is not held, or an input does not fit.
    """
    statics = build_statics(config, patch, laminate)
    check_inputs(config, patch, laminate, stress)
    body, control = statics.body, config.control
    activation = FrameReader(stress.active_stress)

    def imposed(frame: int) -> Imposed:
        return body.imposed_at(frame * config.step, activation(frame))

    if not isinstance(control, ArcLength):
        return ByLoad(statics, imposed, config.n_steps)
    path = ByArcLength(statics, imposed, control, config.n_steps)
    if not path.added.any():
        raise ValueError(
            "nothing is added to the loading up to its last instant, so that there is no path to follow by "
            "arc length: let the time laws end at their full value"
        )
    return path


def body_of(config: ShellConfig, patch: Patch, laminate: Laminate) -> Body:
    """The configured shell with its supports and loads.

    Raises
    ------
    ValueError
        If nothing would move it, or a support or load does not fit it.
    """
    body = Body.held(shell_of(config, patch, laminate), config.supports, config.loads)
    active = any(layer.active for layer in laminate.layers)
    if not active and not body.loads and not body.constraints.drives:
        raise ValueError(
            "nothing would move the film: no layer of it is active (geometry.layers), nothing loads it "
            "(mechanics.loads), and no support moves (mechanics.supports)"
        )
    return body


def shell_of(config: ShellConfig, patch: Patch, laminate: Laminate) -> Shell:
    """Shell with the configured materials, matched to the layers by name."""
    return build_shell(
        patch,
        laminate,
        config.all_materials,
        plane_points=config.points_per_element,
        layer_points=config.layer_points,
        tension=config.tension_law,
    )


def controls_of(config: ShellConfig, shell: Shell) -> NewtonControls:
    """Newton's tolerances, with the film's extent as the scale of displacements."""
    return NewtonControls(
        length=shell.extent,
        displacement_tolerance=config.displacement_tolerance,
        energy_tolerance=config.energy_tolerance,
        force_tolerance=config.force_tolerance,
        max_iterations=config.max_iterations,
    )


def check_inputs(
    config: ShellConfig, patch: Patch, laminate: Laminate, stress: StressSamples
) -> None:
    """Mesh, quadrature and time grid of the inputs are those of the configuration.

    Raises
    ------
    ValueError
        Naming what was expected and what was given.
    """
    given = patch.first.elements, patch.second.elements
    degrees = {space.degree for space in patch.spaces}
    if given != config.elements or degrees != {config.degree}:
        raise ValueError(
            f"the mid-surface has {given[0]} x {given[1]} elements of degree "
            f"{max(degrees)}, but mechanics is configured for {config.elements[0]} x "
            f"{config.elements[1]} of degree {config.degree}: refine the geometry to that mesh"
        )
    expected = np.arange(config.n_steps + 1) * config.step
    times = np.asarray(stress.time, dtype=float)
    if times.shape != expected.shape or np.abs(times - expected).max() > 1e-9 * config.duration:
        raise ValueError(
            f"active stress is sampled at {times.size} times from {times[0]:g} to "
            f"{times[-1]:g} ms, but the mechanics steps through {expected.size} times from 0 to "
            f"{config.duration:g} ms: sample it on that grid"
        )
    points = given[0] * given[1] * config.points_per_element**2
    if stress.active_stress.shape[1] != points:
        raise ValueError(
            f"active stress is given at {stress.active_stress.shape[1]} points, but the shell "
            f"integrates over {points}: use {config.points_per_element} points per element"
        )
    if not any(layer.active for layer in laminate.layers) and np.any(stress.active_stress[...]):
        names = ", ".join(repr(layer.name) for layer in laminate.layers)
        raise ValueError(
            f"no layer of the film is active, so the activation would move nothing: give one of "
            f"{names} an activity above 0, or no activation"
        )
