"""What results were made from, however their inputs came to be there."""

from __future__ import annotations

import shutil
from typing import Any

from pipeline.keys import Ref
from pipeline.lineage import Lineage, lineage
from pipeline.nodes import Node
from pipeline.runner import run
from pipeline.store import LocalStore
from tests.pipeline.toy import MeshConfig, WaveConfig, mesh, peak, wave


def nodes(label: str = "flat") -> dict[str, Node[Any]]:
    film = mesh(MeshConfig(label=label))
    history = wave(WaveConfig(), surface=film.part("surface"))
    return {"mesh": film, "wave": history, "peak": peak(MeshConfig(), history=history)}


def refs(store: LocalStore, label: str = "flat") -> dict[str, Ref]:
    return {name: one.manifest.ref for name, one in run(nodes(label), store).items()}


def edges(lines: Lineage) -> set[tuple[Ref, Ref, tuple[str, ...]]]:
    return {(use.source, use.reader, use.parts) for use in lines.uses}


def test_everything_upstream_stands_before_what_was_made_from_it(store: LocalStore) -> None:
    made = refs(store)
    lines = lineage(store, [made["peak"]])
    assert list(lines.manifests) == [made["mesh"], made["wave"], made["peak"]]
    assert edges(lines) == {
        (made["mesh"], made["wave"], ("surface",)),
        (made["wave"], made["peak"], ()),
    }
    assert lines.ends == (made["peak"],)


def test_a_run_hangs_together_though_its_input_was_made_again_under_another_key(
    store: LocalStore,
) -> None:
    first = refs(store)
    second = refs(store, label="other")  # the surface is the same, so the wave is found
    assert second["mesh"] != first["mesh"]
    assert second["wave"] == first["wave"]
    lines = lineage(store, second.values())
    assert first["mesh"] not in lines.manifests
    assert (second["mesh"], second["wave"], ("surface",)) in edges(lines)


def test_what_is_gone_is_said_to_be(store: LocalStore) -> None:
    made = refs(store)
    shutil.rmtree(store.data(made["mesh"]).parent)
    lines = lineage(store, [made["peak"]])
    assert lines.manifests[made["mesh"]] is None
    assert lines.problems == {}


def test_what_is_damaged_is_said_to_be(store: LocalStore) -> None:
    made = refs(store)
    next(store.data(made["mesh"]).iterdir()).write_bytes(b"")
    lines = lineage(store, [made["peak"]])
    assert "damaged" in lines.problems[made["mesh"]]
    assert lines.manifests[made["mesh"]] is not None
