"""Study: several processes at once in one store, some of them killed, one of them collecting garbage.

    python -m tests.faults.crowds FOLDER

It prints a JSON object for each scene: how many processes took part, how often each key was computed,
and all that went wrong.
"""

from __future__ import annotations

import collections
import contextlib
import io
import json
import os
import random
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.manifest import hash_files
from pipeline.nodes import Node
from pipeline.runner import run
from pipeline.scheduling.outcome import Outcome
from pipeline.store import LocalStore
from tests.faults.victims import Ending, Victim
from tests.pipeline import toy
from workflows.upkeep.cleaning import collect_garbage

PATIENCE = 120.0
"""Seconds after which a process is said to hang; the scenes take a few."""


def plan(*gains: float) -> dict[str, Node[Any]]:
    """One film, a slow history for each gain, and its peak."""
    surface = toy.mesh(toy.MeshConfig()).part("surface")
    nodes: dict[str, Node[Any]] = {}
    for gain in gains:
        history = toy.wave(toy.WaveConfig(gain=gain, frames=70, pause=0.003), surface=surface)
        nodes[f"wave {gain}"] = history
        nodes[f"peak {gain}"] = toy.peak(toy.MeshConfig(), history=history)
    return nodes


def contents(store: LocalStore) -> dict[str, Any]:
    """Files of all artefacts, with their checksums."""
    return {str(ref): hash_files(store.data(ref)) for ref in store.refs()}


def awaited(victims: Sequence[Victim]) -> list[Ending]:
    """How they ended; one that hangs is killed and told as such."""
    deadline = time.perf_counter() + PATIENCE
    for victim in victims:
        while not victim.ended and time.perf_counter() < deadline:
            time.sleep(0.005)
    hung = [victim for victim in victims if not victim.ended]
    for victim in hung:
        victim.kill()
    endings = [victim.wait() for victim in victims]
    for victim, ending in zip(victims, endings, strict=True):
        if victim in hung:
            ending.error = f"it hung at {ending.place}"
    return endings


def together(folder: Path, plans: Sequence[Mapping[str, Node[Any]]]) -> dict[str, Any]:
    """Processes that begin at once, each with a plan of its own."""
    store = LocalStore(folder)
    endings = awaited([Victim(nodes, folder, 0.02) for nodes in plans])
    return _told(store, endings, plans)


def with_deaths(
    folder: Path, plans: Sequence[Mapping[str, Node[Any]]], deaths: int, chance: random.Random
) -> dict[str, Any]:
    """The same, while processes are killed and others begin in their place."""
    store = LocalStore(folder)
    victims = [Victim(nodes, folder, 0.02) for nodes in plans]
    killed: list[Ending] = []
    for _ in range(deaths):
        time.sleep(chance.uniform(0.0, 0.15))
        place = chance.randrange(len(victims))
        victims[place].kill()
        killed.append(victims[place].wait())
        victims[place] = Victim(plans[place], folder, 0.02)
    told = _told(store, [*killed, *awaited(victims)], plans)
    return {**told, "killed": sum(ending.killed for ending in killed)}


def look(outcome: Outcome) -> None:
    """Read all of a result."""
    record = outcome.load()
    if isinstance(record, toy.Wave):
        assert np.isfinite(record.potential[...]).all()


def with_collection(
    folder: Path, plans: Sequence[Mapping[str, Node[Any]]], rounds: int
) -> dict[str, Any]:
    """Processes that compute or find, and read, while all that nobody needs is removed again and again.

    In each round one plan is left out: what it alone needs is garbage until the next one asks for it.
    """
    store = LocalStore(folder)
    endings: list[Ending] = []
    removals = 0
    for number in range(rounds):
        wanted = [nodes for i, nodes in enumerate(plans) if i != number % len(plans)]
        victims = [Victim(nodes, folder, 0.02, look=look) for nodes in wanted]
        while not all(victim.ended for victim in victims):
            told = io.StringIO()
            with contextlib.redirect_stdout(told):
                collect_garbage(str(folder), "0s", None, unreachable=True, yes=True)
            removals += int(told.getvalue().split()[1])
        endings.extend(awaited(victims))
    problems = [ending.error for ending in endings if ending.error]
    problems += [p for ref in store.refs() for p in store.verify(ref, full=True)]
    return {"processes": len(endings), "removals": removals, "problems": problems}


def _told(
    store: LocalStore, endings: Sequence[Ending], plans: Sequence[Mapping[str, Node[Any]]]
) -> dict[str, Any]:
    counts = collections.Counter(key for ending in endings for key in ending.keys)
    problems = [ending.error for ending in endings if ending.error]
    problems += [f"{key} was computed {n} times" for key, n in counts.items() if n > 1]
    problems += [p for ref in store.refs() for p in store.verify(ref, full=True)]
    problems += [f"{path} is left" for path in (store.path / "tmp").glob("*")]
    alone = LocalStore(store.path.with_name(f"{store.path.name}-alone"))
    for nodes in plans:
        run(nodes, alone)
    if contents(store) != contents(alone):
        problems.append("the artefacts are not those of a process alone")
    return {
        "processes": len(endings),
        "artefacts": len(list(store.refs())),
        "computed": sum(counts.values()),
        "problems": problems,
    }


def main() -> None:
    """All scenes."""
    folder, chance = Path(sys.argv[1]), random.Random(0)
    run(plan(0.5), LocalStore(folder / "warm")).popitem()[1].load()
    same, gains = plan(1.0), (1.0, 1.25, 1.5, 1.75)
    overlapping = [plan(*gains[i % 4 :], *gains[: i % 4]) for i in range(4)]
    apart = [plan(gain) for gain in gains[:3]]
    scenes = {
        "two with the same": together(folder / "two", [same] * 2),
        "eight with the same": together(folder / "eight", [same] * 8),
        "four that overlap": together(folder / "four", overlapping),
        "four with deaths": with_deaths(folder / "deaths", overlapping, 12, chance),
        "two with a collector": with_collection(folder / "collected", apart, 6),
    }
    print(json.dumps(scenes, indent=1))
    sys.stdout.flush()
    os._exit(any(scene["problems"] for scene in scenes.values()))


if __name__ == "__main__":
    main()
