"""A result of other code is accepted on request only, as it is, and never without leaving a trace."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from pipeline.events import StageStarted, StageWarned
from pipeline.manifest import Manifest
from pipeline.plan import Acceptable, Changed, Hit, explain
from pipeline.runner import run
from pipeline.scheduling.outcome import Outcome
from pipeline.store import LocalStore
from pipeline.verification import DamagedError

MODULES = {
    "__init__.py": "",
    "factor.py": "def factor():\n    return 2.0\n",
    "stages.py": """
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pipeline.nodes import stage


@dataclass(frozen=True)
class Config:
    gain: float = 1.0


@dataclass(frozen=True)
class Values:
    values: NDArray[np.float64]


@stage
def first(config: Config) -> Values:
    from tidying.factor import factor
    return Values(factor() * config.gain * np.arange(4.0))


@stage
def second(config: Config, values: Values) -> Values:
    return Values(config.gain + values.values)
""",
}
TIDIED = "def factor():\n    result = 2.0\n    return result\n"


class Box:
    """A package of two stages whose code is edited."""

    def __init__(self, folder: Path, store: LocalStore) -> None:
        self.folder, self.store = folder, store
        self.events: list[Any] = []

    def write(self, name: str, text: str) -> None:
        """Save a module; what was loaded of it is forgotten, as in a new process."""
        (self.folder / name).write_text(text)
        importlib.invalidate_caches()
        forget()

    def nodes(self, gain: float = 1.0) -> dict[str, Any]:
        """The two stages, planned."""
        stages = importlib.import_module("tidying.stages")
        first = stages.first(stages.Config(gain))
        return {"first": first, "second": stages.second(stages.Config(1.0), first)}

    def run(self, gain: float = 1.0, *, accept_code: bool = False) -> dict[str, Outcome]:
        """Outcomes; the events are in ``events``."""
        self.events.clear()
        nodes = self.nodes(gain)
        return run(nodes, self.store, listen=self.events.append, accept_code=accept_code)

    def computed(self) -> list[str]:
        """Stages that the last run computed."""
        return [event.node for event in self.events if isinstance(event, StageStarted)]


def forget() -> None:
    """Let modules be loaded anew."""
    for name in [name for name in sys.modules if name.partition(".")[0] == "tidying"]:
        del sys.modules[name]


@pytest.fixture
def box(tmp_path: Path, store: LocalStore, monkeypatch: pytest.MonkeyPatch) -> Iterator[Box]:
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    folder = tmp_path / "tidying"
    folder.mkdir()
    monkeypatch.syspath_prepend(tmp_path)
    made = Box(folder, store)
    for name, text in MODULES.items():
        made.write(name, text)
    yield made
    forget()


def test_after_a_tidying_edit_results_are_computed_again_unless_they_are_accepted(box: Box) -> None:
    before = box.run()
    box.write("factor.py", TIDIED)
    after = box.run(accept_code=True)
    assert box.computed() == []
    assert after["first"].key != before["first"].key
    assert after["first"].hit
    assert after["first"].content == before["first"].content
    assert after["second"].hit  # it comes after a result that is the same
    assert list(after["first"].load().values) == [0.0, 2.0, 4.0, 6.0]
    assert {e.message for e in box.events if isinstance(e, StageWarned)} == {
        "accepted a result of other code (module tidying.factor was edited)"
    }


def test_what_was_accepted_is_a_hit_from_then_on(box: Box) -> None:
    box.run()
    box.write("factor.py", TIDIED)
    box.run(accept_code=True)
    assert all(outcome.hit for outcome in box.run().values())
    assert all(isinstance(verdict, Hit) for verdict in explain(box.nodes(), box.store))
    assert [box.store.verify(ref, full=True) for ref in box.store.refs()] == [()] * 4


def test_without_the_wish_nothing_is_accepted(box: Box) -> None:
    box.run()
    box.write("factor.py", TIDIED)
    box.run()
    assert box.computed() == ["first", "second"]


def manifest(box: Box) -> Manifest:
    return box.run()["first"].manifest


def test_the_manifest_keeps_what_was_accepted_and_by_which_command(
    box: Box, monkeypatch: pytest.MonkeyPatch
) -> None:
    original = manifest(box)
    box.write("factor.py", TIDIED)
    monkeypatch.setattr(sys, "argv", ["myofilm", "run", "--accept-code"])
    box.run(accept_code=True)
    once = manifest(box)
    (entry,) = once.environment["accepted"]
    assert entry["key"] == original.key
    assert entry["code"] == original.code
    assert entry["command"] == ["myofilm", "run", "--accept-code"]
    assert entry["modules"] == {
        "tidying.factor": [original.modules["tidying.factor"], once.modules["tidying.factor"]]
    }
    assert once.stated_key() == once.key
    assert once.seconds == original.seconds
    assert once.started == original.started
    box.write("factor.py", TIDIED.replace("result", "value"))
    box.run(accept_code=True)
    assert len(manifest(box).environment["accepted"]) == 2


def test_results_of_other_parameters_are_not_accepted(box: Box) -> None:
    box.run(gain=1.0)
    box.write("factor.py", TIDIED)
    box.run(gain=2.0, accept_code=True)
    assert box.computed() == ["first", "second"]


def test_results_of_other_inputs_are_not_accepted(box: Box) -> None:
    box.run(gain=1.0)
    box.write("stages.py", MODULES["stages.py"].replace("config.gain + values", "values"))
    box.run(gain=2.0, accept_code=True)
    assert box.computed() == ["first", "second"]


def test_of_several_the_one_with_the_most_similar_code_is_accepted(box: Box) -> None:
    box.run()
    box.write("factor.py", "X = 1\n\ndef factor():\n    return 3.0\n")
    box.write("stages.py", MODULES["stages.py"] + "\nEDITED = 1\n")
    box.run()
    box.write("stages.py", MODULES["stages.py"])
    box.write("factor.py", TIDIED)
    assert list(box.run(accept_code=True)["first"].load().values) == [0.0, 2.0, 4.0, 6.0]


def test_a_damaged_result_is_never_accepted(box: Box) -> None:
    ref = box.run()["first"].manifest.ref
    (file,) = box.store.data(ref).iterdir()
    contents = bytearray(file.read_bytes())
    contents[-1] ^= 1  # of the same size: only its checksum tells
    file.write_bytes(bytes(contents))
    box.write("factor.py", TIDIED)
    with pytest.raises(DamagedError):
        box.run(accept_code=True)
    file.write_bytes(b"")  # of another size: it is passed over
    box.run(accept_code=True)
    assert "first" in box.computed()


def test_the_plan_tells_what_would_be_accepted_and_writes_nothing(box: Box) -> None:
    key = manifest(box).key
    box.write("factor.py", TIDIED)
    assert isinstance(explain(box.nodes(), box.store)[0], Changed)
    first, second = explain(box.nodes(), box.store, accept_code=True)
    assert isinstance(first, Acceptable)
    assert first.manifest.key == key
    assert [str(change) for change in first.changes] == ["module tidying.factor was edited"]
    assert isinstance(second, Acceptable)
    assert len(list(box.store.refs())) == 2
    assert box.run(accept_code=True)["first"].key == first.key


def test_the_accepted_result_outlives_the_one_it_was_taken_from(box: Box) -> None:
    import shutil

    ref = box.run()["first"].manifest.ref
    box.write("factor.py", TIDIED)
    box.run(accept_code=True)
    shutil.rmtree(box.store.data(ref).parent)
    outcome = box.run()["first"]
    assert box.store.verify(outcome.manifest.ref, full=True) == ()
    assert list(outcome.load().values) == [0.0, 2.0, 4.0, 6.0]
