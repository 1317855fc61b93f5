"""The film: surfaces where they belong, layers in order."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError

from stages.geometry.config import FilmConfig, GeometryStageConfig, MeshConfig
from stages.geometry.films import active_depth, laminate_of
from stages.geometry.stage import geometry

FILM = FilmConfig(
    length=3.5, width=2.0, substrate_thickness=0.018, active_thickness=0.004, fibre_angle=45.0
)


def config(**film: float) -> GeometryStageConfig:
    return GeometryStageConfig(
        film=FILM.model_copy(update=film),
        excitable_mesh=MeshConfig(elements=(102, 60), degree=2),
        shell_mesh=MeshConfig(elements=(50, 10), degree=2),
    )


def test_the_meshes_have_the_papers_sizes() -> None:
    made = geometry.compute(config())
    assert made.excitable_surface.patch.size == 104 * 62
    assert made.mid_surface.patch.size == 52 * 12


def test_the_active_layer_lies_above_the_mid_surface() -> None:
    """Its mid-surface is (d - d_a)/2 = 9 um above that of the shell (eq. 13)."""
    made = geometry.compute(config())
    centre = made.excitable_surface.patch.evaluate([0.5], [0.5])
    # refinement rounds coordinates of 2 mm by a few 1e-16
    np.testing.assert_allclose(centre, [[1.75, 1.0, 0.009]], rtol=0, atol=2e-15)
    below = made.mid_surface.patch.evaluate([0.5], [0.5])
    np.testing.assert_allclose(below, [[1.75, 1.0, 0.0]], rtol=0, atol=2e-15)


def test_equal_parameters_mean_equal_points_on_both_meshes() -> None:
    made = geometry.compute(config())
    theta = np.linspace(0, 1, 11)
    upper = made.excitable_surface.patch.evaluate(theta, theta)
    lower = made.mid_surface.patch.evaluate(theta, theta)
    # two meshes, each refined with round-off of coordinates up to 3.5 mm
    np.testing.assert_allclose(upper - lower, [[0.0, 0.0, 0.009]] * 121, rtol=0, atol=1e-14)


def test_layers_run_from_the_bottom_to_the_top() -> None:
    layers = geometry.compute(config()).laminate.layers
    assert [layer.name for layer in layers] == ["substrate", "active"]
    assert [layer.active for layer in layers] == [False, True]
    assert sum(layer.thickness for layer in layers) == pytest.approx(0.022, rel=1e-15)  # one sum


@pytest.mark.parametrize("field", ["length", "width", "substrate_thickness", "active_thickness"])
def test_a_film_without_extent_is_refused(field: str) -> None:
    with pytest.raises(ValidationError, match="greater than 0"):
        FilmConfig(**FILM.model_dump() | {field: -0.004})


def test_degree_one_is_refused() -> None:
    with pytest.raises(ValidationError, match="greater than or equal to 2"):
        MeshConfig(elements=(10, 10), degree=1)


def test_micrometres_taken_for_millimetres_are_noticed() -> None:
    with pytest.raises(ValidationError, match=r'substrate_thickness = 18 mm.*write "18 um"'):
        FilmConfig(**FILM.model_dump() | {"substrate_thickness": 18.0})


SKIN = {"name": "skin", "material": "substrate", "thickness": 0.002}
MUSCLE = {"name": "muscle", "material": "active", "thickness": 0.004, "activity": 1.0}
BASE = {"name": "base", "material": "gel", "thickness": 0.010, "fibre_angle": 0.0}


def layered(*layers: dict[str, object]) -> FilmConfig:
    return FilmConfig.model_validate(FILM.model_dump() | {"layers": layers})


def test_a_film_may_have_any_layers() -> None:
    film = layered(BASE, MUSCLE, {**MUSCLE, "name": "lower", "activity": 0.5}, SKIN)
    made = geometry.compute(config().model_copy(update={"film": film})).laminate
    assert [layer.name for layer in made.layers] == ["base", "muscle", "lower", "skin"]
    assert [layer.material for layer in made.layers] == ["gel", "active", "active", "substrate"]
    assert [layer.fibre_angle for layer in made.layers] == [0.0, 45.0, 45.0, 45.0]
    assert [layer.activity for layer in made.layers] == [0.0, 1.0, 0.5, 0.0]
    assert made.thickness == pytest.approx(0.020, rel=1e-15)  # one sum


def test_the_cells_sit_in_the_middle_of_the_topmost_active_layer() -> None:
    """Base 10, muscle 4, skin 2 um: the muscle's middle lies 12 um above the bottom, 4 above d/2."""
    film = layered(BASE, MUSCLE, SKIN)
    made = geometry.compute(config().model_copy(update={"film": film}))
    centre = made.excitable_surface.patch.evaluate([0.5], [0.5])
    np.testing.assert_allclose(centre, [[1.75, 1.0, 0.004]], rtol=0, atol=2e-15)  # as above


def test_the_papers_film_listed_as_layers_is_the_papers_film() -> None:
    below = {"name": "substrate", "material": "substrate", "thickness": 0.018}
    above = {"name": "active", "material": "active", "thickness": 0.004, "activity": 1.0}
    assert laminate_of(layered(below, above)) == laminate_of(FILM)


def test_a_film_without_active_layer_has_no_place_for_cells() -> None:
    with pytest.raises(ValueError, match=r"give one of 'base', 'skin' an activity above 0"):
        active_depth(laminate_of(layered(BASE, SKIN)))


@pytest.mark.parametrize(
    ("layers", "problem"),
    [
        ([{**SKIN, "thickness": 0.0}], r"layers.0.thickness\n.*greater than 0"),
        ([{**SKIN, "thickness": 18.0}], r'layers.0.thickness \(skin\) = 18 mm.*write "18 um"'),
        ([{**SKIN, "thickness": 0.3}, {**BASE, "thickness": 0.3}], "total thickness = 0.6 mm"),
        ([SKIN, SKIN], "2 layers are called 'skin'"),
        ([{**MUSCLE, "activity": -1.0}], r"layers.0.activity\n.*greater than or equal to 0"),
    ],
)
def test_layers_that_make_no_film_are_refused(
    layers: list[dict[str, object]], problem: str
) -> None:
    with pytest.raises(ValidationError, match=problem):
        layered(*layers)
