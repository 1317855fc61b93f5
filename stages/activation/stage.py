"""Stage `activation`: the cells' active stress, as the shell's quadrature points need it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pipeline.nodes import StageRun, stage
from stages.activation.config import TransferConfig
from stages.artefacts import ActivationHistory, ExcitableSurface, MidSurface, StressSamples

if TYPE_CHECKING:
    from stages.numerics.bsplines import Array


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

    from stages.activation.transfer import SurfaceTransfer, check_covered, resample
    from stages.numerics.quadrature import quadrature_grid

    grid = quadrature_grid(mid_surface.patch, config.points)
    transfer = SurfaceTransfer.between(surface.patch, grid.theta1, grid.theta2)
    wanted = np.linspace(0.0, config.duration, config.n_steps + 1)
    points = grid.theta1.size * grid.theta2.size
    samples = run.stream(StressSamples, frames=wanted.size, shapes={"active_stress": (points,)})

    def frame(index: int) -> Array:
        return np.asarray(history.active_stress[index], dtype=float)

    times = np.asarray(history.time)
    check_covered(times, wanted)
    run.resume()
    for stress in resample(times, wanted[samples.frames_done :], frame):
        samples.append(active_stress=config.scale * transfer(stress))
        run.progress(samples.frames_done, wanted.size)
        run.checkpoint(dict)
    return samples.finish(time=wanted)
