"""Which fibre angle the tissue of a film conducts along, and when it counts at all."""

from __future__ import annotations

import pytest
from pydantic import ValidationError

from tests.paper import electrophysiology_config
from workflows.conduction import conducting
from workflows.request import Request

LAYERS = """[
  { name = "lower", material = "active", thickness = "4 um", fibre_angle = 10, activity = 0.5 },
  { name = "upper", material = "active", thickness = "4 um", fibre_angle = -30, activity = 1 },
  { name = "skin", material = "substrate", thickness = "4 um", activity = 0 },
]"""


def film(*settings: str):  # type: ignore[no-untyped-def]
    return Request.read(
        "planar-waves", overrides=[f"geometry.{s}" for s in settings]
    ).config.geometry


def test_isotropic_tissue_does_not_know_the_fibres() -> None:
    """So that its key, and its result, serve every angle."""
    cells = electrophysiology_config()
    assert conducting(cells, film("fibre_angle=20")) is cells


def test_anisotropic_tissue_conducts_along_the_fibres_of_the_film() -> None:
    cells = electrophysiology_config(transverse_conductivity=0.0005)
    assert conducting(cells, film("fibre_angle=20")).diffusion_angle == 20.0


def test_the_topmost_active_layer_gives_its_angle() -> None:
    cells = electrophysiology_config(transverse_conductivity=0.0005)
    assert conducting(cells, film(f"layers={LAYERS}")).diffusion_angle == -30.0


def test_an_angle_of_its_own_is_kept() -> None:
    cells = electrophysiology_config(transverse_conductivity=0.0005, diffusion_angle=70.0)
    assert conducting(cells, film("fibre_angle=20")) is cells


def test_an_angle_without_a_transverse_conductivity_is_refused() -> None:
    with pytest.raises(ValidationError, match="no meaning without transverse_conductivity"):
        electrophysiology_config(diffusion_angle=70.0)
