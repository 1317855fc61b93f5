"""Removal never disturbs those who read: real processes, at once, on one store."""

from __future__ import annotations

import subprocess
from collections.abc import Callable

from pipeline.store import LocalStore
from pipeline.store.cleaning import Limits
from pipeline.store.collection import collect, plan

Start = Callable[..., "subprocess.Popen[str]"]

READER = """
import sys
import numpy as np
from pipeline.runner import run
from pipeline.store import LocalStore, RunLabel
from tests.pipeline import toy
store = LocalStore({store!r})
hits = computed = 0
for turn in range({turns}):
    label = RunLabel(f"turn {{turn}}")
    store.begin(label)
    for height in (1.0, 2.0, 3.0):
        node = toy.mesh(toy.MeshConfig(height=height))
        outcome = run({{"mesh": node}}, store, label=label)["mesh"]
        hits, computed = hits + outcome.hit, computed + (not outcome.hit)
        for part, cls in (("surface", toy.Surface), ("label", toy.Label)):
            assert type(outcome.load(part)) is cls
        assert outcome.load("surface").heights == (height,)
        assert store.verify(outcome.manifest.ref, full=True) == ()
    store.finish(label)
    store.upkeep.forget(label)
print(hits, computed)
"""

COLLECTOR = """
from pipeline.store import LocalStore
from pipeline.store.cleaning import Limits
from pipeline.store.collection import collect, plan
store = LocalStore({store!r})
print("ready", flush=True)
while True:
    gone, _ = collect(store, plan(store, Limits(unreachable=True)))
    print(len(gone), flush=True)
"""


def test_readers_are_never_disturbed_by_removal(store: LocalStore, start: Start) -> None:
    place = str(store.path)
    collector = start(COLLECTOR.format(store=place))
    assert collector.stdout is not None
    assert collector.stdout.readline() == "ready\n"
    readers = [start(READER.format(store=place, turns=20)) for _ in range(2)]
    hits = computed = 0
    for reader in readers:
        out, err = reader.communicate(timeout=120)
        assert reader.returncode == 0, err
        more_hits, more_computed = map(int, out.split())
        hits, computed = hits + more_hits, computed + more_computed
    assert collector.poll() is None, collector.communicate()[1]
    collector.kill()
    removed = sum(map(int, collector.communicate()[0].split()))
    # Else this shows nothing: results were removed and made again, and found by others in between.
    assert computed > 3
    assert hits > 0
    assert removed > 3
    for ref in store.refs():
        assert store.verify(ref, full=True) == ()
    collect(store, plan(store, Limits(unreachable=True)))
    assert list(store.refs()) == []
