"""``explain`` speaks the user's language: names as they are set, edits in short, nothing twice."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from pipeline import keys
from pipeline.canonical import canonical, leaves
from pipeline.fingerprint import Fingerprint
from pipeline.nodes import in_order
from pipeline.plan.reasons import CodeChanged
from tests.workflows.conftest import invoke
from workflows import registry
from workflows.explanation import _edits
from workflows.naming import Naming
from workflows.request import Request

AMBIGUOUS = {"excitable_mesh.degree", "shell_mesh.degree", "duration", "points"}
"""Fields of which two parameters have the name and value, and one that follows from another."""


@pytest.mark.parametrize("workflow", [entry.name for entry in registry.ENTRIES])
def test_fields_that_stages_see_have_names_that_users_set(workflow: str) -> None:
    request = Request.read(workflow)
    names = {name for name, _ in leaves(canonical(request.config))}
    for stage, node in in_order(request.nodes()):
        naming = Naming(request.config, node.config)
        for field, value in leaves(canonical(node.config)):
            found = naming(field, value)
            assert set(found.split(" or ")) <= names or field in AMBIGUOUS, f"{stage}: {field}"


@pytest.mark.parametrize(
    ("setting", "stage", "field", "name"),
    [
        ("geometry.length=4.0", "geometry", "film.length", "geometry.length"),
        ("geometry.layers=[]", "geometry", "film.layers", "geometry.layers"),
        ("electrophysiology.degree=3", "geometry", "excitable_mesh.degree", "electrophysiology.degree"),
        ("mechanics.elements=[40,8]", "geometry", "shell_mesh.elements", "mechanics.elements"),
        ("mechanics.duration=1500.0", "activation", "duration", "mechanics.duration"),
        ("electrophysiology.transverse_conductivity=0.001", "electrophysiology", "scheme.name",
         "electrophysiology.scheme.name"),
        ("mechanics.damping=0.4", "mechanics", "damping", "mechanics.damping"),
    ],
)  # fmt: skip
def test_a_field_of_a_stage_is_named_as_the_user_set_it(
    setting: str, stage: str, field: str, name: str
) -> None:
    request = Request.read("planar-waves", None, [setting])
    node = dict(in_order(request.nodes()))[stage]
    value = dict(leaves(canonical(node.config)))[field]
    assert Naming(request.config, node.config)(field, value) == name


def test_dozens_of_edited_modules_are_told_in_short() -> None:
    lines = list(_edits([CodeChanged(f"stages.m{i}", "edited") for i in range(30)]))
    assert len(lines) == 5
    assert lines[-1] == "26 more modules changed"


def test_explain_names_parameters_with_their_section(tmp_path: Path) -> None:
    store = ("--store", tmp_path)
    assert invoke("geometry", "twitch", *store, "--out", tmp_path / "out").exit_code == 0
    told = invoke("explain", "twitch", *store, "--set", "geometry.length=3.0").output
    assert "- geometry.length is 3.0, was " in told
    assert "film.length" not in told


def test_explain_tells_what_would_be_accepted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = ("--store", tmp_path)
    assert invoke("geometry", "twitch", *store, "--out", tmp_path / "out").exit_code == 0
    real = keys.fingerprint

    def edited(*arguments: Any) -> Fingerprint:
        code = real(*arguments)
        modules = {name: digest[::-1] for name, digest in code.modules.items()}
        return Fingerprint(code.digest[::-1], modules, code.bare)

    monkeypatch.setattr(keys, "fingerprint", edited)
    assert "\ngeometry:           miss" in "\n" + invoke("explain", "twitch", *store).output
    told = invoke("explain", "twitch", *store, "--accept-code").output
    assert "geometry:           a result of other code is accepted: " in told
