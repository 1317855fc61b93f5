"""A cell model or tension law is one file, found by its name; nothing else has to change."""

from __future__ import annotations

import re
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.linalg import expm

from stages.artefacts import ExcitableSurface
from stages.electrophysiology import cell_models, tension_laws
from stages.electrophysiology.stage import electrophysiology
from stages.numerics.patches import Patch
from tests.paper import electrophysiology_config

PASSIVE = '''"""Leaky membrane: I_ion = (v - v_rest) / tau."""
from typing import Literal, NamedTuple
from stages.configuration import quantity
from stages.electrophysiology.cell_models.base import CellModel

class Constants(NamedTuple):
    tau: float

class Leak(CellModel):
    name: Literal["leak"] = "leak"
    tau: float = quantity("ms", "time constant", "test", gt=0)
    def constants(self): return Constants(self.tau)
    def initial_states(self): return ()

def ionic_current(v, s, p): return (v + 80.0) / p.tau
def state_rates(v, s, p): return ()
MODEL = Leak
'''

FOLLOWER = '''"""Stress that follows the potential at one rate."""
from typing import Literal, NamedTuple
from stages.configuration import quantity
from stages.electrophysiology.tension_laws.base import TensionLaw

class Constants(NamedTuple):
    rate: float

class Follower(TensionLaw):
    name: Literal["follower"] = "follower"
    rate: float = quantity("1/ms", "rate", "test", gt=0)
    def constants(self): return Constants(self.rate)

def tension_rate(v, sigma, p): return p.rate * (0.1 * (v + 80.0) - sigma)
MODEL = Follower
'''


@pytest.fixture
def new_models(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "leak.py").write_text(PASSIVE)
    (tmp_path / "follower.py").write_text(FOLLOWER)
    monkeypatch.setattr(cell_models, "__path__", [*cell_models.__path__, str(tmp_path)])
    monkeypatch.setattr(tension_laws, "__path__", [*tension_laws.__path__, str(tmp_path)])


@pytest.mark.usefixtures("new_models")
def test_a_new_file_is_a_new_model() -> None:
    """A uniform leak and follower have closed forms: v = v0 exp(-t/tau) above rest."""
    config = electrophysiology_config(
        cell_model={"name": "leak", "tau": 20.0},
        tension_law={"name": "follower", "rate": 0.3},
        stimuli=(),
        initial_potential=-30.0,
        n_steps=2000,
    )
    surface = ExcitableSurface(Patch.rectangle(3.5, 2.0).refine(2, (6, 4)))
    history = electrophysiology.compute(config, surface)
    above_rest = np.asarray(history.potential[-1], dtype=float) + 80.0
    # AB2 at dt = 0.005 ms: relative error about (dt/tau)^2; frames are float32
    np.testing.assert_allclose(above_rest, 50.0 * np.exp(-10.0 / 20.0), rtol=1e-6)
    rate, tau = 0.3, 20.0
    stress = 5.0 * rate / (rate - 1 / tau) * (np.exp(-10.0 / tau) - np.exp(-rate * 10.0))
    np.testing.assert_allclose(np.asarray(history.active_stress[-1]), stress, rtol=1e-6)


def test_an_unknown_model_is_refused_with_the_valid_names() -> None:
    with pytest.raises(ValidationError, match=r"'aliev-panfilof'.*aliev-panfilov"):
        electrophysiology_config(cell_model={"name": "aliev-panfilof"})


def test_a_model_without_its_parameters_is_refused() -> None:
    with pytest.raises(ValidationError, match="zeta_inf"):
        electrophysiology_config(tension_law={"name": "goektepe-kuhl"})


FAULTY = 'Literal["faulty"] = "faulty"'


@pytest.mark.parametrize(
    ("left_out", "message"),
    [
        ("MODEL = Leak", "must set MODEL to its subclass of CellModel"),
        ("def state_rates(v, s, p): return ()", "must define the function state_rates"),
        ('name: Literal["leak"] = "leak"', 'must declare name: Literal["faulty"]'),
    ],
)
def test_a_model_file_with_a_part_missing_says_which(
    left_out: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = PASSIVE.replace(left_out, "").replace('Literal["leak"] = "leak"', FAULTY)
    (tmp_path / "faulty.py").write_text(text)
    monkeypatch.setattr(cell_models, "__path__", [*cell_models.__path__, str(tmp_path)])
    monkeypatch.delitem(sys.modules, f"{cell_models.__name__}.faulty", raising=False)
    with pytest.raises(ValidationError, match=re.escape(message)):
        electrophysiology_config(cell_model={"name": "faulty", "tau": 20.0})


def test_the_recipes_in_the_contributing_guide_work_as_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A leak with a slow current that the stress follows; at the end both are as the equations say."""
    guide = (Path(__file__).parents[2] / "CONTRIBUTING.md").read_text(encoding="utf-8")
    recipes = re.findall(r"```python\n(.*?)```.*?```toml\n(.*?)```", guide, re.DOTALL)
    chosen = {}
    for package, (code, table) in zip((cell_models, tension_laws), recipes, strict=False):
        name = re.search(r'Literal\["(.*?)"\]', code).group(1)
        (tmp_path / f"{name.replace('-', '_')}.py").write_text(code)
        monkeypatch.setattr(package, "__path__", [*package.__path__, str(tmp_path)])
        chosen |= tomllib.loads(table)["electrophysiology"]
    config = electrophysiology_config(
        **chosen, stimuli=(), initial_potential=-60.0, n_steps=2000, duration=40.0
    )
    surface = ExcitableSurface(Patch.rectangle(3.5, 2.0).refine(2, (6, 4)))
    history = electrophysiology.compute(config, surface)
    tau, slow, rate, gain = 20.0, 0.001, 0.3, 0.1
    system = np.array(  # of v - rest, w and sigma
        [[-1 / tau, -1.0, 0.0], [slow / tau, -slow, 0.0], [rate * gain, 0.0, -rate]]
    )
    v, _, stress = expm(40.0 * system) @ [20.0, 0.0, 0.0]
    # AB2 in steps of 0.02 ms; frames are float32
    np.testing.assert_allclose(np.asarray(history.potential[-1]), v - 80.0, rtol=1e-6)
    np.testing.assert_allclose(np.asarray(history.active_stress[-1]), stress, rtol=1e-4)
