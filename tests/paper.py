"""Configurations with the paper's numbers (Tables 1 and 3), on meshes small enough for tests."""

from __future__ import annotations

from typing import Any

from stages.electrophysiology.cell_models.aliev_panfilov import AlievPanfilov
from stages.electrophysiology.config import ElectrophysiologyConfig
from stages.electrophysiology.stimuli.edge_flux import EdgeFlux
from stages.electrophysiology.tension_laws.goektepe_kuhl import GoektepeKuhl

CELL = AlievPanfilov(
    k_v=8.0,
    a=0.15,
    b=0.15,
    mu_1=0.2,
    mu_2=0.3,
    e_0=0.002,
    potential_range=100.0,
    potential_rest=-80.0,
    time_scale=12.9,
    initial_recovery=0.0,
)
TENSION = GoektepeKuhl(k_sigma=0.122, v_r=-80.0, zeta_0=0.1, zeta_inf=1.0, xi=1.0, v_bar=0.0)
S1 = EdgeFlux(edge="X=0", start=0.0, duration=5.0, flux=2.0)


def electrophysiology_config(**changes: Any) -> ElectrophysiologyConfig:
    """Monodomain problem of sec. 4.3 with S1 on a coarse mesh, 10 ms in steps of 0.05 ms."""
    fields: dict[str, Any] = {
        "elements": (12, 6),
        "degree": 2,
        "n_steps": 200,
        "duration": 10.0,
        "output_interval": 1.0,
        "activation_threshold": -30.0,
        "conductivity": 0.002,
        "membrane_capacitance": 1.0,
        "initial_potential": -80.0,
        "cell_model": CELL,
        "tension_law": TENSION,
        "stimuli": (S1,),
    }
    return ElectrophysiologyConfig(**{**fields, **changes})
