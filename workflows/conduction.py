"""What the cells of a film take from its lay-up: where the fibres run that conduct better."""

from __future__ import annotations

from stages.electrophysiology.config import ElectrophysiologyConfig
from stages.geometry.config import FilmConfig


def conducting(cells: ElectrophysiologyConfig, film: FilmConfig) -> ElectrophysiologyConfig:
    """The same with the angle of the conducting fibres told, where it matters.

    An isotropic tissue stays as it is, so that its result serves every fibre angle.
    """
    if cells.is_isotropic or cells.diffusion_angle is not None:
        return cells
    return cells.model_copy(update={"diffusion_angle": film.conducting_angle})
