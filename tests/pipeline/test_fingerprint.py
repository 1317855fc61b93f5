"""The fingerprint follows imports to every module that can matter, and sees only code."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from pipeline.errors import InputError
from pipeline.fingerprint import Fingerprint, fingerprint
from pipeline.keys import code_of

FILES = {
    "__init__.py": '"""A package."""\n',
    "steps/__init__.py": "",
    "steps/stage.py": "from toybox.steps import helper\n\ndef run():\n    return helper.one()\n",
    "steps/helper.py": "from ..numerics.deep import two\n\ndef one():\n    return two()\n",
    "numerics/__init__.py": "",
    "numerics/deep.py": '"""Deep."""\n\ndef two():\n    """Two."""\n    return 2  # two\n',
    "numerics/unrelated.py": "x = 1\n",
    "laws/__init__.py": "",
    "laws/base.py": "from pydantic import BaseModel\n\nclass Law(BaseModel):\n    k: float = 1.0\n",
    "laws/soft.py": "from toybox.laws.base import Law\n\nclass Soft(Law):\n    pass\n",
    "laws/stiff.py": "from toybox.laws.base import Law\n\nclass Stiff(Law):\n    pass\n",
}


class Toybox:
    """A throw-away package on the search path."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def write(self, name: str, text: str) -> None:
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def fingerprint(self) -> Fingerprint:
        return fingerprint(["toybox.steps.stage"], ["toybox"])


@pytest.fixture
def toybox(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Toybox]:
    box = Toybox(tmp_path / "toybox")
    for name, text in FILES.items():
        box.write(name, text)
    monkeypatch.syspath_prepend(tmp_path)
    yield box
    for name in [name for name in sys.modules if name.partition(".")[0] == "toybox"]:
        del sys.modules[name]


def test_the_closure_holds_the_modules_reached_by_imports(toybox: Toybox) -> None:
    assert list(toybox.fingerprint().modules) == [
        "toybox.numerics.deep",
        "toybox.steps.helper",
        "toybox.steps.stage",
    ]


def test_nothing_is_imported(toybox: Toybox) -> None:
    toybox.write("numerics/deep.py", "raise SystemExit\n")
    toybox.fingerprint()
    assert not [name for name in sys.modules if name.startswith("toybox")]


@pytest.mark.parametrize(
    "text",
    [
        '"""Another text."""\n\ndef two():\n    """2."""\n    return 2\n',
        "def two():\n\n    return (2)  # no docstrings at all\n",
        'def two():\n    return 2\n\n"""A text that stands alone."""\n',
    ],
)
def test_comments_docstrings_and_layout_do_not_count(toybox: Toybox, text: str) -> None:
    before = toybox.fingerprint()
    toybox.write("numerics/deep.py", text)
    assert toybox.fingerprint() == before


@pytest.mark.parametrize(
    "text",
    [
        "def two():\n    return 3\n",
        "def two():\n    return 2.0\n",
        "def two():\n    return '2'\n",
        "def two():\n    return True\n",
        "def two():\n    return None\n",
        "def two():\n    return\n",
        "def two():\n    return b'2'\n",
        "def two(x=1):\n    return 2\n",
        "async def two():\n    return 2\n",
        "def two():\n    return -2\n",
        "def two():\n    return [2]\n",
        "def two():\n    return 2\nimport os\n",
    ],
)
def test_any_change_of_code_two_imports_away_counts(toybox: Toybox, text: str) -> None:
    before = toybox.fingerprint()
    toybox.write("numerics/deep.py", text)
    after = toybox.fingerprint()
    assert after.digest != before.digest
    changed = {name for name in after.modules if after.modules[name] != before.modules[name]}
    assert changed == {"toybox.numerics.deep"}


def test_a_new_file_that_nothing_imports_does_not_count(toybox: Toybox) -> None:
    before = toybox.fingerprint()
    toybox.write("numerics/new.py", "x = 1\n")
    toybox.write("numerics/unrelated.py", "x = 2\n")
    assert toybox.fingerprint() == before


@pytest.mark.parametrize(
    "statement",
    [
        "import toybox.numerics.unrelated",
        "from toybox.numerics import unrelated",
        "from toybox.numerics.unrelated import x",
        "from ..numerics import unrelated as other",
        "from ..numerics.unrelated import *",
        "def late():\n    from toybox.numerics import unrelated",
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import toybox.numerics.unrelated",
        "try:\n    import toybox.numerics.unrelated\nexcept ImportError:\n    pass",
    ],
)
def test_every_form_of_import_is_followed(toybox: Toybox, statement: str) -> None:
    toybox.write("steps/helper.py", f"{statement}\n")
    assert "toybox.numerics.unrelated" in toybox.fingerprint().modules


def test_the_code_of_a_package_counts_with_its_modules(toybox: Toybox) -> None:
    toybox.write("numerics/__init__.py", "from toybox.numerics import unrelated\n")
    modules = toybox.fingerprint().modules
    assert "toybox.numerics" in modules
    assert "toybox.numerics.unrelated" in modules


def test_a_package_without_code_does_not_count(toybox: Toybox) -> None:
    before = toybox.fingerprint()
    toybox.write("numerics/__init__.py", '"""Only words."""\n')
    assert toybox.fingerprint() == before


def test_imports_that_go_round_in_circles_end(toybox: Toybox) -> None:
    toybox.write("numerics/deep.py", "import toybox.steps.stage\n")
    assert "toybox.steps.stage" in toybox.fingerprint().modules


def test_other_packages_are_not_followed(toybox: Toybox) -> None:
    toybox.write("steps/helper.py", "import json, numpy, pipeline.store\n")
    assert set(toybox.fingerprint().modules) == {"toybox.steps.helper", "toybox.steps.stage"}


def test_the_file_of_a_chosen_model_counts_and_that_of_another_does_not(toybox: Toybox) -> None:
    soft = importlib.import_module("toybox.laws.soft").Soft()
    before = code_of("toybox.steps.stage", soft)
    assert {"toybox.laws.soft", "toybox.laws.base"} <= before.modules.keys()
    toybox.write("laws/stiff.py", "# edited\nclass Stiff:\n    k = 2\n")
    assert code_of("toybox.steps.stage", soft) == before
    toybox.write(
        "laws/soft.py", "from toybox.laws.base import Law\n\nclass Soft(Law):\n    x = 1\n"
    )
    assert code_of("toybox.steps.stage", soft) != before


def test_models_inside_lists_and_dicts_are_chosen_too(toybox: Toybox) -> None:
    soft = importlib.import_module("toybox.laws.soft").Soft()
    stiff = importlib.import_module("toybox.laws.stiff").Stiff()
    modules = code_of("toybox.steps.stage", {"a": [soft], "b": (stiff,)}).modules
    assert {"toybox.laws.soft", "toybox.laws.stiff"} <= modules.keys()


def test_a_file_that_is_not_python_is_named_with_its_line(toybox: Toybox) -> None:
    toybox.write("numerics/deep.py", "x = 1\ndef (:\n")
    with pytest.raises(InputError, match=r"deep\.py, line 2"):
        toybox.fingerprint()


def test_code_without_a_file_cannot_be_keyed() -> None:
    with pytest.raises(InputError, match="no source file"):
        fingerprint(["absent_module"], ["absent_module"])


def test_the_fingerprint_is_the_same_in_another_folder_and_process(
    toybox: Toybox, tmp_path: Path, output: Callable[..., str]
) -> None:
    copied = tmp_path / "elsewhere" / "toybox"
    for name, text in FILES.items():
        (copied / name).parent.mkdir(parents=True, exist_ok=True)
        (copied / name).write_text(text)
    code = (
        f"import sys; sys.path.insert(0, {str(copied.parent)!r})\n"
        "from pipeline.fingerprint import fingerprint\n"
        "print(fingerprint(['toybox.steps.stage'], ['toybox']).digest)"
    )
    assert output(code).strip() == toybox.fingerprint().digest
