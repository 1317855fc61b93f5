"""Estimates of what a cell model demands, against closed forms and simulated fronts."""

from __future__ import annotations

import math

import pytest

from stages.electrophysiology.limits import excitation, front_width
from tests.paper import CELL, electrophysiology_config
from tests.problems import CubicFront


def test_the_front_of_the_cubic_current_is_as_wide_as_its_closed_form_says() -> None:
    """10 to 90 % of the logistic profile with length l are 2 ln 9 l."""
    exact = 2.0 * math.log(9.0) * CubicFront().width
    # one factor serves all models; it is 4 % above the one of this current
    assert front_width(electrophysiology_config()) == pytest.approx(exact, rel=0.05)


def test_a_front_narrows_with_poorer_conduction() -> None:
    wide = front_width(electrophysiology_config())
    config = electrophysiology_config(transverse_conductivity=0.0005, diffusion_angle=30.0)
    assert wide is not None
    assert front_width(config) == pytest.approx(0.5 * wide, rel=1e-12)


def test_the_upstroke_of_the_cubic_current_is_found() -> None:
    """Inward between a = 0.15 and 1: it is largest at ((1 + a) + sqrt(1 - a + a^2))/3 = 0.6938."""
    found = excitation(electrophysiology_config())
    assert found is not None
    # potentials are scanned in steps of 0.5 mV
    assert found.peak == pytest.approx(20.0, abs=0.51)
    assert found.steepest == pytest.approx(-80.0 + 69.38, abs=0.5)


def test_cells_without_inward_current_carry_no_front() -> None:
    silent = CELL.model_copy(update={"k_v": 0.0})
    config = electrophysiology_config(cell_model=silent)
    assert excitation(config) is None
    assert front_width(config) is None
