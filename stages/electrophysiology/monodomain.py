"""The monodomain problem in time (sec. 3.4): its stepper, by the scheme chosen, and the state at rest."""

from __future__ import annotations

import numpy as np

from stages.electrophysiology.cell_models.base import equations_of
from stages.electrophysiology.config import ElectrophysiologyConfig
from stages.electrophysiology.limits import decay
from stages.electrophysiology.reaction import compile_reaction
from stages.electrophysiology.sources import sources
from stages.electrophysiology.tissue import Problem, Stepper, TissueState
from stages.numerics.collocation import collocate
from stages.numerics.diffusivity import Diffusivity, along_fibres, isotropic
from stages.numerics.patches import Patch


def build(
    config: ElectrophysiologyConfig, patch: Patch, general: bool = False
) -> tuple[Stepper, TissueState]:
    """Stepper of a patch and the resting state.

    Parameters
    ----------
    config
        Mesh-independent data; the mesh is that of ``patch``.
    general
        Use the solver for any patch even where the fast one would do.
    """
    operators = collocate(patch, diffusivity_of(config))
    problem = Problem(
        config.step,
        config.membrane_capacitance,
        config.conductivity,
        sources(config.stimuli, patch),
        compile_reaction(config.cell_model, config.tension_law),
        (config.cell_model.constants(), config.tension_law.constants()),
        decay(config),
        operators.frame.position,
    )
    stepper = config.scheme.stepper(problem, patch, operators, general)
    return stepper, rest(config, stepper, patch.size)


def diffusivity_of(config: ElectrophysiologyConfig) -> Diffusivity:
    """Tensor field relative to the conductivity along the fibres.

    Raises
    ------
    ValueError
        If the tissue is anisotropic and nobody said where its fibres run.
    """
    if config.is_isotropic:
        return isotropic
    if config.transverse_conductivity is None or config.diffusion_angle is None:
        raise ValueError(
            "transverse_conductivity differs along and across fibres: give their diffusion_angle"
        )
    return along_fibres(
        config.transverse_conductivity / config.conductivity, config.diffusion_angle
    )


def rest(config: ElectrophysiologyConfig, stepper: Stepper, points: int) -> TissueState:
    """All cells alike at the initial potential, no active stress (initial conditions of Table 3)."""
    states = config.cell_model.initial_states()
    potential = np.full(points, config.initial_potential)
    current = equations_of(config.cell_model).ionic_current(
        config.initial_potential, states, config.cell_model.constants()
    )
    return TissueState(
        potential=potential,
        states=np.repeat(np.reshape(states, (-1, 1)), points, axis=1),
        active_stress=np.zeros(points),
        ionic=np.full(points, current),
        ionic_before=np.full(points, current),
        diffusion=stepper.diffusion_state(potential),
        steps=0,
    )
