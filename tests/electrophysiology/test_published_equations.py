"""Cell models and tension laws as their papers print them: normalised, with step functions and tanh."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from stages.numerics.bsplines import Array
from tests.cells import CELL_MODELS, cells, module_of

Published = Callable[[Array, Array, dict[str, float]], tuple[Array, Array]]


def step(x: Array) -> Array:
    return np.heaviside(x, 1.0)


def aliev_panfilov(u: Array, s: Array, p: dict[str, float]) -> tuple[Array, Array]:
    """In normalised time of 12.9 ms."""
    (w,) = s
    du = -p["k_v"] * u * (u - p["a"]) * (u - 1) - u * w
    dw = (p["e_0"] + p["mu_1"] * w / (u + p["mu_2"])) * (-w - p["k_v"] * u * (u - p["b"] - 1))
    return du / p["time_scale"], np.array([dw]) / p["time_scale"]


def fitzhugh_nagumo(u: Array, s: Array, p: dict[str, float]) -> tuple[Array, Array]:
    """In mV as printed: s there is w times the amplitude."""
    amplitude, rest = p["potential_range"], p["potential_rest"]
    v, threshold, peak = u * amplitude + rest, rest + p["a"] * amplitude, rest + amplitude
    recovery = s[0] * amplitude
    current = p["c_1"] / amplitude**2 * (v - rest) * (v - threshold) * (peak - v)
    current -= p["c_2"] / amplitude * (v - rest) * recovery
    return current / amplitude, np.array([p["b"] * (v - rest - p["c_3"] * recovery)]) / amplitude


def mitchell_schaeffer(u: Array, s: Array, p: dict[str, float]) -> tuple[Array, Array]:
    (h,) = s
    du = h * u**2 * (1 - u) / p["tau_in"] - u / p["tau_out"]
    dh = np.where(u < p["gate_potential"], (1 - h) / p["tau_open"], -h / p["tau_close"])
    return du, np.array([dh])


def bueno_orovio(u: Array, s: Array, p: dict[str, float]) -> tuple[Array, Array]:
    v, w, third = s
    above_v, above_w = step(u - p["theta_v"]), step(u - p["theta_w"])
    above_vm, above_o = step(u - p["theta_v_minus"]), step(u - p["theta_o"])

    def between(low: float, high: float, k: float, middle: float) -> Array:
        return np.asarray(low + (high - low) * (1 + np.tanh(k * (u - middle))) / 2)

    tau_v = (1 - above_vm) * p["tau_v1_minus"] + above_vm * p["tau_v2_minus"]
    tau_w = between(p["tau_w1_minus"], p["tau_w2_minus"], p["k_w_minus"], p["u_w_minus"])
    tau_so = between(p["tau_so1"], p["tau_so2"], p["k_so"], p["u_so"])
    tau_s = (1 - above_w) * p["tau_s1"] + above_w * p["tau_s2"]
    tau_o = (1 - above_o) * p["tau_o1"] + above_o * p["tau_o2"]
    v_inf = np.where(u < p["theta_v_minus"], 1.0, 0.0)
    w_inf = (1 - above_o) * (1 - u / p["tau_w_inf"]) + above_o * p["w_inf_star"]
    fast = -v * above_v * (u - p["theta_v"]) * (p["u_u"] - u) / p["tau_fi"]
    outward = (u - p["u_o"]) * (1 - above_w) / tau_o + above_w / tau_so
    inward = -above_w * w * third / p["tau_si"]
    dv = (1 - above_v) * (v_inf - v) / tau_v - above_v * v / p["tau_v_plus"]
    dw = (1 - above_w) * (w_inf - w) / tau_w - above_w * w / p["tau_w_plus"]
    ds = ((1 + np.tanh(p["k_s"] * (u - p["u_s"]))) / 2 - third) / tau_s
    return -(fast + outward + inward), np.array([dv, dw, ds])


PUBLISHED: dict[str, Published] = {
    "aliev-panfilov": aliev_panfilov,
    "fitzhugh-nagumo": fitzhugh_nagumo,
    "mitchell-schaeffer": mitchell_schaeffer,
    "bueno-orovio": bueno_orovio,
}


@pytest.mark.parametrize("name", CELL_MODELS)
def test_a_cell_model_is_the_printed_one(name: str) -> None:
    model = cells(name).cell_model
    equations, constants, p = module_of(model), model.constants(), model.model_dump()
    random = np.random.default_rng(11)
    u = np.concatenate((random.uniform(-0.1, 1.5, 300), random.uniform(-0.01, 0.02, 100)))
    s = random.uniform(0.0, 1.0, (len(model.initial_states()), u.size))
    du, ds = PUBLISHED[model.name](u, s, p)
    scale, rest = p["potential_range"], p["potential_rest"]
    for i in range(u.size):
        v, states = u[i] * scale + rest, tuple(s[:, i].tolist())
        # round-off of u from v, which the steepest switch (k = 200) enlarges
        assert equations.ionic_current(v, states, constants) == pytest.approx(
            -scale * du[i], rel=1e-11, abs=1e-10
        )
        np.testing.assert_allclose(
            equations.state_rates(v, states, constants), ds[:, i], rtol=1e-11, atol=1e-13
        )


@pytest.mark.parametrize("v", [-80.0, -76.0, -74.9, -30.0, 0.0, 20.0])
def test_the_tension_laws_are_the_printed_ones(v: float) -> None:
    law = cells("aliev-panfilov", "nash-panfilov").tension_law
    u = (v + 80.0) / 100.0
    rate = (1.0 if u < 0.05 else 10.0) / 12.9
    assert module_of(law).relaxation(v, law.constants()) == pytest.approx((rate, 47.9 * u))
    law = cells("aliev-panfilov", "goektepe-kuhl").tension_law
    rate = 0.1 + 0.9 * np.exp(-np.exp(-v))
    found = module_of(law).relaxation(v, law.constants())
    assert found == pytest.approx((rate, 0.122 * (v + 80.0)))
