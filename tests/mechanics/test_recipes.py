"""The recipes of the contributing guide work as printed: each is one file that changes nothing else."""

from __future__ import annotations

import re
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter

from stages import time_laws
from stages.mechanics import materials, tension_laws
from stages.mechanics.config import AnyMaterial, AnyTensionLaw
from stages.time_laws.base import AnyTimeLaw
from tests.mechanics import films, points, twin

GUIDE = (Path(__file__).parents[2] / "CONTRIBUTING.md").read_text(encoding="utf-8")


def follow(package: ModuleType, title: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Put the file whose first line holds ``title`` into the folder of a package."""
    (code,) = re.findall(rf'```python\n("""{title}.*?)```', GUIDE, re.DOTALL)
    name = re.search(r'Literal\["(.*?)"\]', code).group(1)
    (folder / f"{name.replace('-', '_')}.py").write_text(code)
    monkeypatch.setattr(package, "__path__", [*package.__path__, str(folder)])


def chosen(kind: Any, **fields: Any) -> Any:
    return TypeAdapter(kind).validate_python(fields)


@pytest.mark.parametrize(
    ("title", "fields", "modulus"),
    [
        # C_1111 = 4 mu with mu = 2 c_1; and 2 modulus, as S = 2 modulus E
        ("Incompressible Yeoh", {"name": "yeoh", "c_1": 30.0, "c_2": 5.0}, 240.0),
        ("Sheet with two moduli", {"name": "fabric", "modulus": 70.0}, 140.0),
    ],
)
def test_a_material_is_one_file(
    title: str,
    fields: dict[str, Any],
    modulus: float,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    follow(materials, title, tmp_path, monkeypatch)
    material = chosen(AnyMaterial, density=1.0, **fields)
    evaluate = points.at(material)
    assert points.tangent(evaluate((0.0, 0.0, 0.0)))[0, 0] == pytest.approx(modulus, rel=1e-14)
    strain = np.array([0.1, -0.05, 0.02])
    slopes = points.differences(evaluate, strain)
    # as in the property tests
    np.testing.assert_allclose(evaluate(strain)[1:4], slopes[:, 0], atol=1e-9 * modulus)
    np.testing.assert_allclose(
        points.tangent(evaluate(strain)), slopes[:, 1:4], atol=1e-8 * modulus
    )


def test_a_tension_law_is_one_file_and_compiles_into_the_shell(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    follow(tension_laws, "Tension with a bell", tmp_path, monkeypatch)
    law = chosen(AnyTensionLaw, name="force-length", best_stretch=1.1, width=0.3)
    body = films.build_shell(films.flat((2, 2)), films.two_layers(), films.MATERIALS, tension=law)
    state, activation = films.random_state(body, seed=14)
    response = body.respond(state, activation)
    force, matrix, _ = twin.respond(body, state, activation)
    # the same sums in another order
    assert np.abs(response.force - force).max() < 1e-12 * np.abs(force).max()
    assert np.abs(body.tangent(response).dense() - matrix).max() < 1e-12 * np.abs(matrix).max()


def test_a_time_law_is_one_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    follow(time_laws, "Regular beats", tmp_path, monkeypatch)
    law = chosen(AnyTimeLaw, name="beat", period=500.0)
    assert law.at(0.0) == 0.0
    assert law.at(250.0) == 1.0
