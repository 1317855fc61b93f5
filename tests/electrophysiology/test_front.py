"""Speed and width of a front are known before anything is simulated."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stages.artefacts import ExcitableSurface
from stages.electrophysiology.front import plane_front, tissue_front
from stages.electrophysiology.stage import electrophysiology
from stages.numerics.patches import Patch
from tests.paper import electrophysiology_config
from tests.problems import CubicFront


def cubic(k: float, a: float, height: float, v: float) -> float:
    u = v / height
    return -height * k * u * (u - a) * (1.0 - u)


@given(
    k=st.floats(0.01, 10.0),
    a=st.floats(0.02, 0.45),
    height=st.floats(20.0, 200.0),
    diffusivity=st.floats(1e-5, 0.1),
)
def test_a_cubic_current_carries_the_logistic_front(
    k: float, a: float, height: float, diffusivity: float
) -> None:
    """Closed form: speed sqrt(k D/2) (1 - 2 a), width 2 ln 9 sqrt(2 D/k)."""
    front = plane_front(lambda v: cubic(k, a, height, v), 0.0, diffusivity)
    assert front is not None
    # 300 steps of a fourth-order method, first order at the start only; width by trapezoids
    assert front.speed == pytest.approx(math.sqrt(k * diffusivity / 2) * (1 - 2 * a), rel=2e-3)
    assert front.width == pytest.approx(2 * math.log(9) * math.sqrt(2 * diffusivity / k), rel=2e-3)


def test_the_paper_s_cells_at_rest_carry_that_front() -> None:
    front, exact = tissue_front(electrophysiology_config()), CubicFront()
    assert front is not None
    assert front.width == pytest.approx(2.0 * math.log(9.0) * exact.width, rel=1e-3)  # as above
    assert front.speed == pytest.approx(exact.speed, rel=1e-3)


@pytest.mark.parametrize("current", [lambda v: 0.1 * v, lambda v: cubic(0.6, 0.6, 100.0, v)])
def test_tissue_without_excitation_carries_no_front(current: Callable[[float], float]) -> None:
    """A passive membrane, and a threshold beyond half of the height: such a front runs backwards."""
    assert plane_front(current, 0.0, 0.002) is None


def test_the_paper_s_tissue_carries_the_front_that_is_simulated() -> None:
    """With recovery moving the front is 0.3 % slower than this; the mesh adds 0.15 %."""
    config = electrophysiology_config()
    front = tissue_front(config)
    assert front is not None
    assert front.speed == pytest.approx(0.01741, rel=5e-3)
    config = config.model_copy(
        update={"elements": (102, 2), "duration": 100.0, "n_steps": 1000, "degree": 4}
    )
    patch = Patch.rectangle(3.5, 2.0).refine(4, (102, 2))
    history = electrophysiology.compute(config, ExcitableSurface(patch))
    profile = np.asarray(history.potential)[-1].reshape(patch.first.size, patch.second.size)[:, 1]
    top = profile.max()
    x = np.interp(
        [0.9, 0.1], (profile[::-1] + 80.0) / (top + 80.0), 3.5 * patch.first.greville()[::-1]
    )
    # behind the front recovery bends the potential down, which shortens the distance to 90 %
    assert x[1] - x[0] == pytest.approx(front.width, rel=0.1)


def test_across_its_fibres_tissue_has_the_thinner_and_slower_front() -> None:
    config = electrophysiology_config()
    along = tissue_front(config)
    across = tissue_front(config.model_copy(update={"transverse_conductivity": 0.0005}))
    assert along is not None
    assert across is not None
    assert across.width == pytest.approx(0.5 * along.width, rel=1e-12)  # sqrt(1/4)
    assert across.rise_time == pytest.approx(along.rise_time, rel=1e-12)
