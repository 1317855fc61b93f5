"""Stages `activation`, `imposed_activation`: active stress as the shell's points need it."""

from __future__ import annotations

from pipeline.nodes import StageRun, stage
from stages.activation.config import ImposedFieldConfig, TransferConfig
from stages.artefacts import ActivationHistory, ExcitableSurface, MidSurface, StressSamples

REMEDY = (
    "Simulate longer cells (electrophysiology.duration) or a shorter shell (mechanics.duration)."
)


@stage
def activation(
    config: TransferConfig,
    history: ActivationHistory,
    surface: ExcitableSurface,
    mid_surface: MidSurface,
    *,
    run: StageRun,
) -> StressSamples:
    """Active stress at the in-plane quadrature points and the time levels of the mechanics.

    Both surfaces share their parameters theta, since refinement preserves the parametrisation.
    """
    import numpy as np

    from stages.numerics.quadrature import quadrature_grid
    from stages.numerics.time_series import TimeSeries
    from stages.numerics.transfer import surface_transfer

    grid = quadrature_grid(mid_surface.patch, config.points)
    transfer = surface_transfer(config.transfer, surface.patch, grid.theta1, grid.theta2)
    wanted = np.linspace(0.0, config.duration, config.n_steps + 1)
    points = grid.theta1.size * grid.theta2.size
    samples = run.stream(StressSamples, frames=wanted.size, shapes={"active_stress": (points,)})
    cells = TimeSeries(
        history.active_stress,
        history.time,
        name="active stress",
        known="the electrophysiology ran",
        remedy=REMEDY,
    )
    cells.check_covers(wanted)
    run.resume()
    for time in wanted[samples.frames_done :]:
        samples.append(active_stress=config.scale * transfer(cells.at(time)))
        run.progress(samples.frames_done, wanted.size)
        run.checkpoint(dict)
    return samples.finish(time=wanted)


@stage
def imposed_activation(config: ImposedFieldConfig, mid_surface: MidSurface) -> StressSamples:
    """Activation P q(t_i), uniform on the film, at t_i = i duration/n_steps (eqs. 96, 103).

    What the muscle makes of it at its length is the tension law's, in the mechanics.
    """
    import numpy as np

    from stages.numerics.quadrature import quadrature_grid

    grid = quadrature_grid(mid_surface.patch, config.points)
    time = np.linspace(0.0, config.duration, config.n_steps + 1)
    course = config.peak_stress * np.array([config.time_law.at(float(t)) for t in time])
    points = grid.theta1.size * grid.theta2.size
    return StressSamples(time, np.repeat(course[:, None], points, axis=1))
