"""The spiral moves smoothly under refinement, and two discretisations agree on where it goes."""

from __future__ import annotations

import numpy as np
import pytest

from tests.verification.studies import broken_limits, table_of
from workflows.verification.studies.spiral_refinement import activations, deviations

SHORT = (
    "cells.duration=900",
    'runs=[{scheme="strang",degree=6,elements=[51,30],step=0.25},'
    '{scheme="strang",degree=4,elements=[51,30],step=0.5}]',
)


def test_the_wave_across_the_tail_comes_round_the_corner() -> None:
    table = table_of("spiral-refinement", *SHORT)
    corner = activations(table, "C")[0]
    assert np.isfinite(corner).sum() == 2
    # of 196 and 775 ms, the latter shortly after the start of S3 at 430 ms: not a plane wave
    assert corner[:2] == pytest.approx([195.7, 774.2], abs=0.3)
    off = deviations(table)[1]
    # quartic splines on 51 spans are early by 0.1 to 0.2 ms
    assert np.nanmax(np.abs(off)) < 0.3


@pytest.mark.paper
def test_the_published_and_the_economical_spiral_tend_to_the_same() -> None:
    table = table_of("spiral-refinement")
    assert broken_limits("spiral-refinement", table) == []
