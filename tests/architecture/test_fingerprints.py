"""Fingerprints of the real code: words and layout do not count, every number and name does, and an edited
model concerns those alone who chose it."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from pipeline.fingerprint.sources import Sources
from pipeline.fingerprint.syntax import parsed
from pipeline.keys import code_of, config_modules
from pipeline.nodes import in_order
from workflows import registry
from workflows.request import Request

ROOT = Path(__file__).parents[2]

FILES = sorted(file for top in ("stages", "workflows") for file in (ROOT / top).rglob("*.py"))

MODELS = sorted(
    file
    for folder in (
        "activation",
        "electrophysiology/cell_models",
        "electrophysiology/schemes",
        "electrophysiology/stimuli",
        "electrophysiology/tension_laws",
        "geometry/shapes",
        "mechanics/loads",
        "mechanics/materials",
        "mechanics/supports",
        "mechanics/tension_laws",
        "time_laws",
    )
    for file in (ROOT / "stages" / folder).glob("*.py")
    if file.stem not in ("__init__", "base", "config", "stage", "abc")
)
"""One file for each model that is chosen by name, and a few besides."""


def digest(text: str) -> str | None:
    """Digest of the code in a text."""
    return parsed(text.encode(), "package").digest


def without_texts(tree: ast.Module) -> ast.Module:
    """The same without docstrings and other strings that stand alone."""
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            kept = [one for one in body if not _is_text(one)]
            node.body = kept or [ast.Pass()] if _had_code(body) else body  # type: ignore[attr-defined]
    return tree


def _is_text(node: ast.AST) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def _had_code(body: list[ast.AST]) -> bool:
    return any(not _is_text(one) for one in body)


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_comments_docstrings_and_layout_of_real_code_do_not_count(file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    assert digest(ast.unparse(without_texts(ast.parse(text)))) == digest(text)


def places(tree: ast.AST) -> Iterator[ast.AST]:
    """Numbers and names, and operators and comparisons, of a module."""
    texts = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        is_number = isinstance(node, ast.Constant) and isinstance(node.value, int | float)
        if id(node) not in texts and (
            is_number or isinstance(node, ast.Name | ast.BinOp | ast.arg)
        ):
            yield node


def mutate(node: ast.AST) -> None:
    """Change a node a little."""
    if isinstance(node, ast.Constant):
        node.value = not node.value if isinstance(node.value, bool) else node.value + 1  # type: ignore[operator]
    elif isinstance(node, ast.Name):
        node.id += "_"
    elif isinstance(node, ast.arg):
        node.arg += "_"
    elif isinstance(node, ast.BinOp):
        node.op = ast.Sub() if isinstance(node.op, ast.Add) else ast.Add()


SMALL = [file for file in FILES if 500 < file.stat().st_size < 6000]
"""Files that are parsed quickly; the others are of the same language."""


@settings(deadline=None, max_examples=60)
@given(st.data())
def test_every_number_name_and_operator_of_real_code_counts(data: st.DataObject) -> None:
    text = data.draw(st.sampled_from(SMALL)).read_text(encoding="utf-8")
    tree = ast.parse(text)
    found = list(places(tree))
    assume(found)
    mutate(found[data.draw(st.integers(0, len(found) - 1))])
    assert digest(ast.unparse(tree)) != digest(text)


class Edited(Sources):
    """Sources in which one file has one statement more."""

    def __init__(self, file: Path) -> None:
        super().__init__()
        self._file = str(file)

    def _bytes(self, file: str) -> bytes:
        return super()._bytes(file) + (b"\nEDITED = 1\n" if file == self._file else b"")

    def keep(self) -> None:
        """Nothing: no such file is on the disk."""


def fingerprints(sources: Sources) -> dict[tuple[str, str], str]:
    """Digest of the code of every stage of every workflow, by default."""
    return {
        place: code_of(node.stage.module, node.config, sources).digest
        for place, node in _nodes().items()
    }


@cache
def _nodes() -> dict:  # type: ignore[type-arg]
    return {
        (entry.name, name): node
        for entry in registry.ENTRIES
        for name, node in in_order(Request.read(entry.name).nodes())
    }


@cache
def _usual() -> dict[tuple[str, str], str]:
    return fingerprints(Sources())


@pytest.mark.parametrize("file", MODELS, ids=lambda file: f"{file.parent.name}-{file.stem}")
def test_an_edited_model_changes_only_what_used_it(file: Path) -> None:
    module = ".".join(file.relative_to(ROOT).with_suffix("").parts)
    now = fingerprints(Edited(file))
    changed = {place for place in now if now[place] != _usual()[place]}
    chosen = {
        place for place, node in _nodes().items() if module in set(config_modules(node.config))
    }
    assert chosen <= changed
    for place in changed - chosen:  # those import it themselves, whatever is chosen
        node = _nodes()[place]
        assert module in code_of(node.stage.module, None).modules
