"""Tissue that conducts better along its fibres: fast solver, turned fibres, closed films."""

from __future__ import annotations

import numpy as np
import pytest

from stages.electrophysiology.general_stepper import GeneralStepper
from stages.electrophysiology.monodomain import build
from stages.electrophysiology.separable_stepper import SeparableStepper
from stages.numerics.patches import Patch
from tests.electrophysiology.test_monodomain import advance, film
from tests.paper import S1, electrophysiology_config

FIBRES = {"transverse_conductivity": 0.0005}


@pytest.mark.parametrize("angle", [0.0, 90.0, -90.0, 180.0])
def test_fibres_along_x_or_y_keep_the_fast_solver_of_a_flat_film(angle: float) -> None:
    config = electrophysiology_config(**FIBRES, diffusion_angle=angle)
    assert isinstance(build(config, film())[0], SeparableStepper)


def test_oblique_fibres_take_the_general_solver() -> None:
    config = electrophysiology_config(**FIBRES, diffusion_angle=30.0)
    assert isinstance(build(config, film())[0], GeneralStepper)


@pytest.mark.parametrize("angle", [0.0, 90.0])
def test_the_fast_solver_equals_the_general_one_with_fibres(angle: float) -> None:
    stimuli = (S1, S1.model_copy(update={"edge": "Y=L2", "start": 1.0}))
    changes = {**FIBRES, "diffusion_angle": angle, "stimuli": stimuli}
    fast, general = (advance(film(), 200, general, **changes) for general in (False, True))
    # 200 steps of round-off 1e-14 relative to 100 mV
    np.testing.assert_allclose(fast.potential, general.potential, rtol=0, atol=1e-10)


def test_equal_conduction_along_and_across_is_isotropic_tissue() -> None:
    """Nearly equal: the operators agree, although the general solver is needed; equal: it is not."""
    one = advance(film(), 200)
    equal = electrophysiology_config(transverse_conductivity=0.002)
    assert isinstance(build(equal, film())[0], SeparableStepper)
    near = 0.002 * (1.0 + 1e-12)
    other = advance(film(), 200, transverse_conductivity=near, diffusion_angle=30.0)
    # operators that agree to 1e-12, 200 steps on 100 mV
    np.testing.assert_allclose(one.potential, other.potential, rtol=0, atol=1e-9)


def test_a_wave_across_the_fibres_is_one_in_a_tissue_that_conducts_less() -> None:
    """S1 on X = 0 with fibres along Y: only the transverse conductivity counts, in the flux too."""
    across = advance(film(), 200, **FIBRES, diffusion_angle=90.0)
    slow = advance(film(), 200, conductivity=0.0005)
    # the same numbers but for the order of a few products
    np.testing.assert_allclose(across.potential, slow.potential, rtol=0, atol=1e-10)


def test_turning_film_and_fibres_together_changes_nothing() -> None:
    """Fibres at 30 degrees on a film, and at 60 degrees on the same film with its sides exchanged."""
    one = advance(Patch.rectangle(3.5, 2.0).refine(2, (12, 6)), 200, **FIBRES, diffusion_angle=30.0)
    stimulus = (S1.model_copy(update={"edge": "Y=0"}),)
    other = advance(
        Patch.rectangle(2.0, 3.5).refine(2, (6, 12)),
        200,
        **FIBRES,
        diffusion_angle=60.0,
        stimuli=stimulus,
    )
    turned = other.potential.reshape(8, 14).T
    # the same sums in another order, 200 times, on 100 mV
    np.testing.assert_allclose(one.potential.reshape(14, 8), turned, rtol=0, atol=1e-10)
    assert np.ptp(turned[4]) > 0.01  # mV: oblique fibres bend the front; this is no plane wave


def test_fibres_without_an_angle_are_refused() -> None:
    with pytest.raises(ValueError, match="give their diffusion_angle"):
        build(electrophysiology_config(**FIBRES), film())
