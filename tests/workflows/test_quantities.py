"""The numbers reported from measures, also where there was nothing to measure."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from stages.artefacts import Measures
from stages.postprocessing.tip_paths import no_tips
from workflows.film_quantities import quantities

NAN = float("nan")

MEASURES = Measures(
    probe_names=("A", "B"),
    time=np.array([0.0, 5.0]),
    probe_points=np.zeros((2, 3)),
    displacement=np.array([[[0.0, 0.0, 0.0]] * 2, [[0.3, 0.0, 0.4], [0.0, 0.0, 0.0]]]),
    active_stress=np.array([[0.0, 0.0], [3.0, 0.5]]),
    potential=np.full((2, 2), -80.0),
    projected_length=np.array([3.5, 3.4]),
    curvature=np.array([0.0, 0.2]),
    activation_times=np.array([[1.0, NAN, 4.0], [NAN, NAN, NAN]]),
    repolarisation_times=np.array([[301.0, NAN, NAN], [NAN, NAN, NAN]]),
    apd50=np.array([[250.0, NAN, NAN], [NAN, NAN, NAN]]),
    apd90=np.array([[300.0, NAN, NAN], [NAN, NAN, NAN]]),
    peak_potential=np.array([[19.0, NAN, NAN], [NAN, NAN, NAN]]),
    peak_active_stress=np.array([[7.0, NAN, NAN], [NAN, NAN, NAN]]),
    conduction_velocity=np.array([0.0175, NAN, NAN]),
    tips=no_tips(),
)


def test_each_number_is_read_off_the_measures() -> None:
    value = {name: q.value for name, q in quantities(MEASURES).items()}
    assert value["conduction_velocity"] == 0.0175
    assert value["max_curvature"] == 0.2
    assert value["A.max_displacement"] == pytest.approx(0.5, rel=1e-15)
    assert value["A.peak_active_stress"] == 7.0  # between two mechanics times
    assert value["B.peak_active_stress"] == 0.5  # never activated: the largest seen


def test_beats_that_did_not_come_are_left_out_and_times_keep_their_peaks() -> None:
    value = {name: q.value for name, q in quantities(MEASURES).items()}
    assert value["A.activation_times"] == [1.0, 4.0]
    assert value["A.peak_active_stresses"] == [7.0, None]
    assert value["A.repolarisation_times"] == [301.0, None]
    assert value["A.apd50"] == [250.0, None]
    assert value["A.apd90"] == [300.0, None]
    assert value["B.activation_times"] == value["B.apd90"] == []


def test_a_wave_that_never_came_has_no_speed() -> None:
    nothing = np.empty((2, 0))
    silent = replace(
        MEASURES,
        activation_times=nothing,
        repolarisation_times=nothing,
        apd50=nothing,
        apd90=nothing,
        peak_potential=nothing,
        peak_active_stress=nothing,
        conduction_velocity=np.empty(0),
    )
    assert quantities(silent)["conduction_velocity"].value is None
    lost = replace(MEASURES, conduction_velocity=np.array([NAN]))
    assert quantities(lost)["conduction_velocity"].value is None


def test_every_quantity_says_what_it_means() -> None:
    assert all(q.meaning and q.unit for q in quantities(MEASURES).values())
