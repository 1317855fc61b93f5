"""Imposed activation: P q(t) at every quadrature point and every time of the mechanics."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError

from stages.activation.config import ImposedFieldConfig
from stages.activation.stage import imposed_activation
from stages.artefacts import MidSurface
from stages.numerics.patches import Patch

SURFACE = MidSurface(Patch.rectangle(3.5, 2.0).refine(2, (4, 2)))


def config(**changes: object) -> ImposedFieldConfig:
    fields = {"peak_stress": 21.6, "duration": 500.0, "n_steps": 100, "points": 3}
    pulse = {"name": "smooth-pulse", "time_to_peak": 210.0}
    return ImposedFieldConfig.model_validate({**fields, "time_law": pulse, **changes})


def test_the_twitch_of_the_paper_is_uniform_and_peaks_at_210_ms() -> None:
    samples = imposed_activation.compute(config(), SURFACE)
    field = np.asarray(samples.active_stress)
    np.testing.assert_allclose(samples.time, np.arange(101) * 5.0, rtol=1e-15)
    assert field.shape == (101, 4 * 3 * 2 * 3)
    assert np.ptp(field, axis=1).max() == 0.0
    assert field[0].max() == 0.0
    assert field[42, 0] == field.max() == 21.6
    # eq. 103 at 100 ms
    square = (100.0 / 210.0) ** 2
    assert field[20, 0] == pytest.approx(21.6 * square * np.exp(1 - square), rel=1e-14)


def test_a_constant_activation_acts_from_the_first_frame() -> None:
    samples = imposed_activation.compute(config(time_law="constant", n_steps=2), SURFACE)
    np.testing.assert_array_equal(samples.active_stress, np.full((3, 72), 21.6))


def test_a_negative_stress_is_refused() -> None:
    with pytest.raises(ValidationError, match="peak_stress"):
        config(peak_stress=-1.0)
