"""The rules of the house hold in the code as it stands."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import get_args

import pytest
from importlinter.cli import lint_imports

from stages.configuration import Edge
from stages.numerics.collocation import EDGES

ROOT = Path(__file__).parents[2]
PACKAGES = ("pipeline", "stages", "workflows")
FILES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))


def test_every_import_contract_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    assert lint_imports(no_cache=True) == 0


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_module_says_what_it_is_for(path: Path) -> None:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    assert ast.get_docstring(tree), f"{path} has no docstring"


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_everything_public_has_a_docstring(path: Path) -> None:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    public = [
        node
        for node in tree.body
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_")
    ]
    bare = [node.name for node in public if not ast.get_docstring(node)]
    assert not bare, f"{path.relative_to(ROOT)}: no docstring on {', '.join(bare)}"


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_no_module_is_too_long_to_be_read_at_once(path: Path) -> None:
    lines = len(path.read_text(encoding="utf-8").splitlines())
    assert lines <= 300, f"{path.relative_to(ROOT)} has {lines} lines: give part of it its own file"


def test_the_configuration_and_the_numerics_name_the_same_edges() -> None:
    """The numerics do not import the configuration, so the four names stand in both."""
    assert get_args(Edge) == EDGES


def test_no_room_is_called_after_nothing() -> None:
    vague = {"utils.py", "helpers.py", "common.py", "misc.py"}
    assert not [path for path in FILES if path.name in vague]


@pytest.mark.parametrize("package", ["pipeline", "workflows"])
def test_every_room_is_on_the_map(package: str) -> None:
    """Whoever wants to change something finds the folder in CONTRIBUTING.md."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    (plan,) = re.findall(rf"^{package}/ .*\n((?:  .*\n)+)", text, flags=re.MULTILINE)
    rooms = {path.parent.name for path in (ROOT / package).glob("*/__init__.py")}
    assert rooms <= set(re.findall(r"([a-z_]+)/", plan))
