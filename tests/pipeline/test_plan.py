"""The plan says what would run and why, and computes nothing."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from pipeline.plan import Changed, Hit, Missing, Pending, Verdict, explain
from pipeline.plan.reasons import ABSENT, CodeChanged, ConfigChanged, InputChanged
from pipeline.runner import run
from pipeline.store import LocalStore
from tests.pipeline import toy
from tests.pipeline.test_runner import plan


def verdicts(store: LocalStore, nodes: Any) -> dict[str, Verdict]:
    return {verdict.node: verdict for verdict in explain(nodes, store)}


def test_in_an_empty_store_everything_is_missing(store: LocalStore) -> None:
    found = explain(plan(), store)
    assert [verdict.node for verdict in found] == ["mesh", "wave", "peak", "report"]
    assert all(isinstance(verdict, Missing) for verdict in found)
    assert found[0].key is not None
    assert found[1].key is None  # it depends on what the mesh will be
    assert not store.path.exists()


def test_after_a_run_everything_is_a_hit_with_the_keys_of_the_run(store: LocalStore) -> None:
    outcomes = run(plan(), store)
    found = verdicts(store, plan())
    assert all(isinstance(verdict, Hit) for verdict in found.values())
    assert found["wave"].key == outcomes["wave"].key


def test_a_changed_field_is_named_with_both_values(store: LocalStore) -> None:
    past = run(plan(), store)["wave"]
    verdict = verdicts(store, plan(wave=toy.WaveConfig(gain=2.0)))["wave"]
    assert isinstance(verdict, Changed)
    assert verdict.reasons == (ConfigChanged("gain", 1.0, 2.0),)
    assert str(verdict.reasons[0]) == "gain is 2.0, was 1.0"
    assert verdict.forecast.seconds == past.seconds
    assert verdict.forecast.size == past.manifest.size


def test_an_unkeyed_field_is_no_reason(store: LocalStore) -> None:
    run(plan(), store)
    found = verdicts(store, plan(wave=toy.WaveConfig(pause=1.0)))
    assert isinstance(found["wave"], Hit)


def test_the_nearest_past_result_is_compared(store: LocalStore) -> None:
    run(plan(), store)
    run(plan(wave=toy.WaveConfig(gain=2.0, frames=10)), store)
    verdict = verdicts(store, plan(wave=toy.WaveConfig(gain=2.0, frames=11)))["wave"]
    assert isinstance(verdict, Changed)
    assert verdict.reasons == (ConfigChanged("frames", 10, 11),)


def test_what_comes_after_a_changed_stage_is_pending(store: LocalStore) -> None:
    run(plan(), store)
    found = verdicts(store, plan(wave=toy.WaveConfig(gain=2.0)))
    assert isinstance(found["mesh"], Hit)
    assert isinstance(found["peak"], Pending)
    assert found["peak"].waits_for == ("wave",)
    assert isinstance(found["report"], Pending)
    assert found["report"].waits_for == ("peak",)


def test_a_pending_stage_that_is_changed_itself_says_so(store: LocalStore) -> None:
    run(plan(), store)
    found = verdicts(store, plan(toy.MeshConfig(height=2.0), toy.WaveConfig(gain=2.0)))
    assert isinstance(found["wave"], Changed)
    assert found["wave"].reasons == (ConfigChanged("gain", 1.0, 2.0),)
    assert found["wave"].key is None


def test_a_changed_input_is_named_with_its_stage(store: LocalStore) -> None:
    run(plan(), store)
    run({"mesh": toy.mesh(toy.MeshConfig(height=2.0))}, store)
    verdict = verdicts(store, plan(toy.MeshConfig(height=2.0)))["wave"]
    assert isinstance(verdict, Changed)
    assert verdict.reasons == (InputChanged("surface", "mesh"),)
    assert verdict.key is not None


MODULES = {
    "__init__.py": "",
    "records.py": "from dataclasses import dataclass\n\n"
    "@dataclass(frozen=True)\nclass Number:\n    value: float\n",
    "soft.py": "from pydantic import BaseModel\n\nclass Soft(BaseModel):\n    soft: float = 1.0\n",
    "stiff.py": "from pydantic import BaseModel\n\nclass Stiff(BaseModel):\n    stiff: float = 2.0\n",
    "helper.py": "def value():\n    return 1.0\n",
    "stage.py": "from typing import Any\nfrom pydantic import BaseModel\n"
    "from pipeline.nodes import stage\nfrom numberbox.records import Number\n\n"
    "class Config(BaseModel):\n    law: Any\n\n"
    "@stage\ndef number(config: Config) -> Number:\n"
    "    from numberbox.helper import value\n    return Number(value())\n\n"
    "@stage\ndef again(config: Config, first: Number, second: Number | None = None) -> Number:\n"
    "    return first\n",
}


@pytest.fixture
def numberbox(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    folder = tmp_path / "numberbox"
    folder.mkdir()
    for name, text in MODULES.items():
        (folder / name).write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    yield folder
    for name in [name for name in sys.modules if name.partition(".")[0] == "numberbox"]:
        del sys.modules[name]


def number(law: str = "soft") -> Any:
    stage = importlib.import_module("numberbox.stage")
    model = getattr(importlib.import_module(f"numberbox.{law}"), law.capitalize())
    return stage.number(stage.Config(law=model()))


def test_an_edited_module_is_named(numberbox: Path, store: LocalStore) -> None:
    run({"number": number()}, store)
    (numberbox / "helper.py").write_text("def value():\n    return 2.0\n")
    verdict = verdicts(store, {"number": number()})["number"]
    assert isinstance(verdict, Changed)
    assert verdict.reasons == (CodeChanged("numberbox.helper", "edited"),)


def test_an_added_and_a_removed_module_are_named(numberbox: Path, store: LocalStore) -> None:
    run({"number": number()}, store)
    verdict = verdicts(store, {"number": number("stiff")})["number"]
    assert isinstance(verdict, Changed)
    assert set(verdict.reasons) == {
        CodeChanged("numberbox.soft", "removed"),
        CodeChanged("numberbox.stiff", "added"),
        ConfigChanged("law.soft", 1.0, ABSENT),
        ConfigChanged("law.stiff", ABSENT, 2.0),
    }


def test_the_module_of_a_model_that_is_not_chosen_is_no_reason(
    numberbox: Path, store: LocalStore
) -> None:
    run({"number": number()}, store)
    (numberbox / "stiff.py").write_text("x = 1\n")
    (numberbox / "new.py").write_text("x = 1\n")
    assert isinstance(verdicts(store, {"number": number()})["number"], Hit)


def test_an_added_and_a_removed_input_are_named(numberbox: Path, store: LocalStore) -> None:
    first = number()
    stage = importlib.import_module("numberbox.stage")
    one, two = (stage.again(first.config, first), stage.again(first.config, first, first))
    run({"one": one}, store)
    verdict = verdicts(store, {"two": two})["two"]
    assert isinstance(verdict, Changed)
    assert verdict.reasons == (InputChanged("second", "number"),)
    run({"two": two}, store)
    for manifest in map(store.manifest, list(store.refs("again"))):
        if "second" not in manifest.inputs:
            store.data(manifest.ref).parent.rename(store.path / "forgotten")
    verdict = verdicts(store, {"one": one})["one"]
    assert isinstance(verdict, Changed)
    assert verdict.reasons == (InputChanged("second", "number"),)


def test_a_result_for_fewer_inputs_is_no_hit_for_more(numberbox: Path, store: LocalStore) -> None:
    first = number()
    stage = importlib.import_module("numberbox.stage")
    run({"one": stage.again(first.config, first)}, store)
    two = stage.again(first.config, first, number("stiff"))
    verdict = verdicts(store, {"two": two})["two"]
    assert isinstance(verdict, Changed)
    assert verdict.reasons == (InputChanged("second", "number"),)


def test_damage_to_one_result_does_not_keep_others_from_being_computed(store: LocalStore) -> None:
    ref = run(plan(), store)["wave"].manifest.ref
    (store.data(ref).parent / "manifest.json").write_text("{")
    other = plan(wave=toy.WaveConfig(gain=2.0))
    assert isinstance(verdicts(store, other)["wave"], Missing)
    assert not run(other, store)["wave"].hit


def test_a_cached_run_and_a_plan_import_nothing_heavy(
    store: LocalStore, output: Callable[..., str]
) -> None:
    run(plan(), store)
    code = f"""
import sys
from pipeline.plan import Hit, explain
from pipeline.runner import run
from pipeline.store import LocalStore
from tests.pipeline import toy
film = toy.mesh(toy.MeshConfig())
wave = toy.wave(toy.WaveConfig(), surface=film.part("surface"))
store = LocalStore({str(store.path)!r})
assert all(isinstance(verdict, Hit) for verdict in explain({{"wave": wave}}, store))
assert run({{"wave": wave}}, store)["wave"].hit
assert not isinstance(explain({{"wave": toy.wave(toy.WaveConfig(gain=2.0), film.part("surface"))}},
                              store)[-1], Hit)
print(*sorted({{name.partition(".")[0] for name in sys.modules}}))
"""
    heavy = {"numpy", "scipy", "zarr", "h5py", "numba", "pint", "dask", "asyncio", "pytest"}
    assert heavy & set(output(code).split()) == set()
