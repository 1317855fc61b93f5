"""Keys of real experiments: what matters changes the keys of the stages it matters to, and nothing else does."""

from __future__ import annotations

import json
import math
import os
import random
import subprocess
import sys
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from pipeline.canonical import canonical, digest
from pipeline.config import describe, load, read_toml
from pipeline.errors import InputError
from pipeline.keys import key_of
from pipeline.nodes import in_order
from workflows import registry
from workflows.request import Request

ROOT = Path(__file__).parents[2]

FILMS = ("curling", "twitch", "planar-waves", "spiral-wave")
"""Experiments whose plan is the chain of five stages, or of four without cells."""

WORKFLOWS = tuple(entry.name for entry in registry.ENTRIES)

CHOSEN = {"planar-waves": {"S1", "S2"}, "spiral-wave": {"S1", "S3"}}
"""Stimuli that an experiment uses by default."""

PINNED = (
    ("curling", "geometry", "832d0101439d628f30080239368d2386028fef78"),
    ("curling", "activation", "30176f2002203803ccd4e90de704f2b05b644806"),
    ("curling", "mechanics", "84a5c5e5a4237b083fd2898cdf34da3feb09b100"),
    ("curling", "postprocessing", "c931111207c6e4bfe93ac51485931cd4005c5f2a"),
    ("twitch", "geometry", "832d0101439d628f30080239368d2386028fef78"),
    ("twitch", "activation", "ffe2bb0d83cd6b0b3ce21ad71066e8bad3dc22ef"),
    ("twitch", "mechanics", "370a7e43184ed316010c00de67cbf730f38452b3"),
    ("twitch", "postprocessing", "c931111207c6e4bfe93ac51485931cd4005c5f2a"),
    ("planar-waves", "geometry", "c4252f4e833b962807a9db19a88cf117d254fd90"),
    ("planar-waves", "electrophysiology", "a9ab70bab6ac352b49611eb36bdb6328c2645096"),
    ("planar-waves", "activation", "69f2d945c990dbfbb8e365ac3020cb017e0a54cd"),
    ("planar-waves", "mechanics", "b9b84b98665ca671fdd60fc282981c3bce922367"),
    ("planar-waves", "postprocessing", "91000c788ab961dc9953be5546fbd0d07cb38ae3"),
    ("spiral-wave", "geometry", "c4252f4e833b962807a9db19a88cf117d254fd90"),
    ("spiral-wave", "electrophysiology", "11681877e7342846ae329cbfb652e82182a0a3f6"),
    ("spiral-wave", "activation", "69f2d945c990dbfbb8e365ac3020cb017e0a54cd"),
    ("spiral-wave", "mechanics", "b9b84b98665ca671fdd60fc282981c3bce922367"),
    ("spiral-wave", "postprocessing", "ddcbc0f2851fab6f700f14d62be80fc397485f1e"),
    ("restitution", "restitution", "67fe1265987e7d25de7f971057d6a724a4379083"),
    ("vulnerable-window", "geometry", "76cae0604446f39022335892f8421b6b1cf3a1ce"),
    ("vulnerable-window", "vulnerable_window", "249d23ca49f91ec0d1773ed6e2715e699c8de873"),
)
"""Digest of the configuration that each stage sees by default."""

# No example may take long because of what the machine does besides.
unhurried = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])


def keys(request: Request) -> dict[str, str]:
    """Key of each stage for fixed code and inputs: what its own configuration makes of it."""
    return {
        name: key_of(
            node.stage.name, canonical(node.config), "code", dict.fromkeys(node.inputs, "")
        )
        for name, node in in_order(request.nodes())
    }


@cache
def usual(workflow: str) -> dict[str, str]:
    """Keys by default."""
    return keys(Request.read(workflow))


@cache
def numbers(workflow: str) -> Mapping[str, Any]:
    """Value of every parameter that is a number or a list of numbers."""
    found = {p.name: p.value for p in describe(Request.read(workflow).config)}
    return {name: value for name, value in found.items() if _is_numeric(value)}


def _is_numeric(value: Any) -> bool:
    if isinstance(value, list | tuple):
        return bool(value) and all(map(_is_numeric, value))
    return isinstance(value, int | float) and not isinstance(value, bool)


def matters_to(workflow: str, name: str) -> set[str]:
    """Stages that must see a parameter, by what the experiments are, not by what the code does."""
    section, _, field = name.partition(".")
    first, second = f"{field}..".split(".")[:2]
    if section == "mechanics":
        if first in ("elements", "degree"):  # the film's surface; points where stress is needed
            return {"geometry", "mechanics"} | ({"activation"} if first == "degree" else set())
        return {"mechanics"} | ({"activation"} if first in ("n_steps", "duration") else set())
    if section == "electrophysiology":
        if first == "stimulus_library" and second not in CHOSEN[workflow]:
            return set()
        return {section} | ({"geometry"} if first in ("elements", "degree") else set())
    return {section}


def nudged(value: Any, by: float) -> Any:
    """The nearest other number where ``by`` is zero, else one that much larger; integers by one."""
    if isinstance(value, list | tuple):
        return [nudged(value[0], by), *value[1:]]
    if isinstance(value, int):
        return value + 1
    return math.nextafter(value, math.inf) if by == 0.0 else value * (1 + by) or by


@unhurried
@given(st.data())
def test_a_changed_number_changes_the_keys_of_the_stages_that_it_matters_to_and_of_no_other(
    data: st.DataObject,
) -> None:
    workflow = data.draw(st.sampled_from(FILMS))
    name = data.draw(st.sampled_from(sorted(numbers(workflow))))
    by = data.draw(st.sampled_from([0.0, 1e-12, 1e-3]))
    value = nudged(numbers(workflow)[name], by)
    try:
        changed = keys(Request.read(workflow, None, [f"{name}={json.dumps(value)}"]))
    except InputError:  # such as a hold that ends after the film has stopped
        assume(False)
    before = usual(workflow)
    found = {stage for stage in before if changed[stage] != before[stage]}
    assert found == matters_to(workflow, name) & before.keys() - _new_stage(name), name


def _new_stage(name: str) -> set[str]:
    """The number of buckling modes matters to the stage that computes them, which one more brings in."""
    return {"mechanics"} if name == "mechanics.buckling_modes" else set()


CHOICES = {
    "electrophysiology.stimuli=['S1']": {"electrophysiology"},
    "electrophysiology.cell_model=mitchell-schaeffer": {"electrophysiology"},
    "electrophysiology.cell_model.name=mitchell-schaeffer": {"electrophysiology"},
    "electrophysiology.transverse_conductivity=0.001": {"electrophysiology"},
    "mechanics.loads.tip={kind='area',traction=[0,0,1],time_law={name='constant'}}": {"mechanics"},
    "geometry.fibre_angle=30.0": {"geometry"},
    "postprocessing.probes.D=[1.0,1.0]": {"postprocessing"},
}


@pytest.mark.parametrize("option", CHOICES)
def test_another_choice_changes_the_keys_of_the_stages_that_it_matters_to(option: str) -> None:
    changed, before = keys(Request.read("planar-waves", None, [option])), usual("planar-waves")
    assert {stage for stage in before if changed[stage] != before[stage]} == CHOICES[option]


def test_the_angle_of_the_fibres_matters_to_tissue_that_conducts_better_along_them() -> None:
    tissue = "electrophysiology.transverse_conductivity=0.001"
    before = keys(Request.read("planar-waves", None, [tissue]))
    turned = keys(Request.read("planar-waves", None, [tissue, "geometry.fibre_angle=30.0"]))
    found = {stage for stage in before if turned[stage] != before[stage]}
    assert found == {"geometry", "electrophysiology"}


OPTIONS = {
    "electrophysiology.allow_coarse_mesh=true",
    "electrophysiology.allow_unstable_step=true",
    "electrophysiology.stimulus_library.unused={kind='edge-flux',edge='X=0',start=1.0,"
    "duration=1.0,flux=1.0}",
}


@pytest.mark.parametrize("option", sorted(OPTIONS))
@pytest.mark.parametrize("workflow", ["planar-waves", "spiral-wave"])
def test_what_cannot_matter_changes_no_key(workflow: str, option: str) -> None:
    assert keys(Request.read(workflow, None, [option])) == usual(workflow)


def test_numbers_that_a_preset_picks_have_the_keys_of_the_same_numbers_given() -> None:
    picked = Request.read("planar-waves", None, ["electrophysiology.preset=quick"])
    cells = canonical(picked.config)["electrophysiology"]  # type: ignore[index, call-overload]
    names = ("elements", "degree", "n_steps", "scheme")
    given = [f"electrophysiology.{name}={json.dumps(cells[name])}" for name in names]
    given = [one.replace("{", "{ ").replace('": ', '" = ') for one in given]  # tables in TOML
    assert keys(Request.read("planar-waves", None, given)) == keys(picked) != usual("planar-waves")


def spellings(value: float, unit: str) -> list[str]:
    """Ways to write the same number."""
    found = [repr(value), f"{value:.17g}", f"{value:.20e}", f"{value:+}"]
    if value.is_integer() and abs(value) < 1e15:
        found.append(str(int(value)))
    if unit and "e" not in repr(value):
        found.append(f'"{value!r} {unit}"')
    return found


@unhurried
@given(st.data())
def test_other_spellings_of_a_number_keep_all_keys(data: st.DataObject) -> None:
    workflow = data.draw(st.sampled_from(FILMS))
    rows = [p for p in describe(Request.read(workflow).config) if type(p.value) is float]
    row = data.draw(st.sampled_from(rows))
    text = data.draw(st.sampled_from(spellings(row.value, row.unit)))
    assert keys(Request.read(workflow, None, [f"{row.name}={text}"])) == usual(workflow)


def shuffled(table: Any, order: random.Random) -> Any:
    """The same tables with their entries in another order."""
    if isinstance(table, list):
        return [shuffled(item, order) for item in table]
    if not isinstance(table, dict):
        return table
    names = list(table)
    order.shuffle(names)
    return {name: shuffled(table[name], order) for name in names}


@settings(unhurried, max_examples=40)
@given(st.sampled_from(WORKFLOWS), st.randoms(use_true_random=False))
def test_the_order_of_tables_keeps_all_keys(workflow: str, order: random.Random) -> None:
    layers = [shuffled(read_toml(file), order) for file in registry.parameter_files(workflow)]
    found = registry.find(workflow)
    assert keys(Request(found, load(found.config, layers))) == usual(workflow)


def test_where_a_value_comes_from_keeps_all_keys(tmp_path: Path) -> None:
    file = tmp_path / "film.toml"
    file.write_text('[mechanics]\ndamping = 0.4\n[geometry]\nsubstrate_thickness = "20 um"\n')
    given_there = keys(Request.read("twitch", file))
    given_here = Request.read(
        "twitch", None, ["geometry.substrate_thickness=0.02", "mechanics.damping=0.4"]
    )
    assert given_there == keys(given_here) != usual("twitch")


PROBE = """
import json, sys
from tests.workflows.test_keys import WORKFLOWS, usual
from pipeline.keys import code_of
from pipeline.nodes import in_order
from workflows.request import Request
nodes = [(w, n, node) for w in WORKFLOWS for n, node in in_order(Request.read(w).nodes())]
print(json.dumps({f"{w} {n}": [usual(w)[n], code_of(node.stage.module, node.config).digest]
                  for w, n, node in nodes}))
"""


def probe(folder: Path, seed: str) -> Any:
    """Keys and fingerprints of all stages of all workflows by default, in another process."""
    done = subprocess.run(
        [sys.executable, "-c", PROBE],
        env=os.environ | {"PYTHONPATH": str(ROOT), "PYTHONHASHSEED": seed},
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_keys_and_fingerprints_are_those_of_every_process_and_hash_seed(tmp_path: Path) -> None:
    first, second = probe(tmp_path, "0"), probe(tmp_path, "4294967295")
    assert first == second
    assert {name: key for name, (key, _) in first.items()} == {
        f"{workflow} {stage}": key
        for workflow in WORKFLOWS
        for stage, key in usual(workflow).items()
    }


@pytest.mark.parametrize("workflow", [name for name in WORKFLOWS if name != "verification"])
def test_what_the_stages_see_by_default_stays(workflow: str) -> None:
    # A stage that gets a new field, or another default, is computed anew by everybody: if that is
    # wanted, say so in the commit and write down the new digests.
    found = [
        (workflow, stage, digest(node.config))
        for stage, node in in_order(Request.read(workflow).nodes())
    ]
    assert found == [pin for pin in PINNED if pin[0] == workflow]
