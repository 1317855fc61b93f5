"""Damage of every kind is found, told with its place, set aside on request, and never used."""

from __future__ import annotations

import errno
import os
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pipeline.durable import sync_tree
from pipeline.errors import StoreError
from pipeline.events import Event, StageStarted, StageWarned
from pipeline.manifest import hash_files
from pipeline.nodes import Node, source_node
from pipeline.runner import run
from pipeline.running.checkpoints import ChunkFiles
from pipeline.store import LocalStore
from pipeline.verification import DamagedError
from tests.faults.damages import CHUNK, DAMAGES, UNREAD, Damage, flipped, told
from tests.pipeline import toy


def plan() -> dict[str, Node[Any]]:
    """A wave on a film, and its peak."""
    film = toy.mesh(toy.MeshConfig())
    history = toy.wave(toy.WaveConfig(), surface=film.part("surface"))
    return {"mesh": film, "wave": history, "peak": toy.peak(toy.MeshConfig(), history=history)}


@pytest.fixture(scope="module")
def original(tmp_path_factory: pytest.TempPathFactory) -> LocalStore:
    """A sound store; it holds a second film, too."""
    store = LocalStore(tmp_path_factory.mktemp("original") / "store")
    run(plan(), store)
    run({"other": toy.mesh(toy.MeshConfig(height=9.0))}, store)
    return store


@pytest.fixture
def copy(original: LocalStore, tmp_path: Path) -> LocalStore:
    """A copy to damage."""
    shutil.copytree(original.path, tmp_path / "copy")
    return LocalStore(tmp_path / "copy")


@pytest.fixture(params=DAMAGES)
def kind(request: pytest.FixtureRequest) -> str:
    """Name of a kind of damage."""
    return str(request.param)


def apply(damage: Damage, store: LocalStore) -> Path:
    """Damage an artefact of the plan; its folder."""
    stage, file, act, _ = damage
    used = run({stage: plan()[stage]}, store)[stage].manifest.ref
    folder = store.data(used).parent
    act(folder / file)
    return folder


def assert_as_computed_first(store: LocalStore, original: LocalStore) -> None:
    assert list(store.refs()) == list(original.refs())
    for ref in original.refs():
        assert store.verify(ref, full=True) == ()
        assert hash_files(store.data(ref)) == hash_files(original.data(ref))


def test_full_verification_finds_it_and_names_artefact_and_file(
    kind: str, copy: LocalStore
) -> None:
    damage = DAMAGES[kind]
    folder = apply(damage, copy)
    found = {ref: problems for ref in copy.refs() if (problems := copy.verify(ref, full=True))}
    ((ref, problems),) = found.items()
    assert folder == copy.data(ref).parent
    assert told(damage) in "; ".join(problems)


def test_it_is_never_used(kind: str, copy: LocalStore) -> None:
    stage = DAMAGES[kind][0]
    folder = apply(DAMAGES[kind], copy)
    nodes = plan()
    consumer = {
        "mesh": toy.wave(toy.WaveConfig(gain=2.0), nodes["mesh"].part("surface")),
        "wave": toy.peak(toy.MeshConfig(height=2.0), nodes["wave"]),
    }[stage]
    if kind in UNREAD:
        assert not run({"consumer": consumer}, copy)["consumer"].hit
        return
    for _ in range(2):  # the first failure mends nothing, and spoils nothing
        with pytest.raises(DamagedError) as caught:
            run({"consumer": consumer}, copy)
        assert str(folder) in str(caught.value)
        assert "--recompute-damaged" in str(caught.value)
    assert not any((copy.path / "tmp").iterdir())


def test_it_is_set_aside_and_computed_again_on_request(
    kind: str, copy: LocalStore, original: LocalStore
) -> None:
    stage = DAMAGES[kind][0]
    folder = apply(DAMAGES[kind], copy)
    events: list[Event] = []
    outcomes = run(plan(), copy, listen=events.append, recompute_damaged=True)
    assert {name for name, outcome in outcomes.items() if not outcome.hit} == {stage}
    assert [event.stage for event in events if isinstance(event, StageStarted)] == [stage]
    (warning,) = [event.message for event in events if isinstance(event, StageWarned)]
    (aside,) = (copy.path / "quarantine" / stage).glob(f"{folder.name}.*Z")
    assert warning.endswith(f"; it was moved to {aside} and is computed again")
    assert_as_computed_first(copy, original)
    assert all(outcome.hit for outcome in run(plan(), copy).values())


def test_a_sound_store_is_checked_and_left_alone(copy: LocalStore) -> None:
    events: list[Event] = []
    outcomes = run(plan(), copy, listen=events.append, recompute_damaged=True)
    assert all(outcome.hit for outcome in outcomes.values())
    assert not any(isinstance(event, StageWarned) for event in events)
    assert not (copy.path / "quarantine").exists()


def test_damage_to_one_artefact_disturbs_no_other(kind: str, copy: LocalStore) -> None:
    apply(DAMAGES[kind], copy)
    assert not run({"new": toy.mesh(toy.MeshConfig(height=3.0))}, copy)["new"].hit
    assert run({"other": toy.mesh(toy.MeshConfig(height=9.0))}, copy)["other"].hit


def test_a_lost_description_of_the_store_is_written_again(copy: LocalStore) -> None:
    (copy.path / "store.json").unlink()
    store = LocalStore(copy.path)
    assert all(outcome.hit for outcome in run(plan(), store).values())
    run({"new": toy.mesh(toy.MeshConfig(height=3.0))}, store)
    assert (store.path / "store.json").is_file()


def test_what_is_looked_at_lazily_is_told_when_it_is_looked_at(copy: LocalStore) -> None:
    outcome = run(plan(), copy)["wave"]
    flipped(copy.data(outcome.manifest.ref) / CHUNK)
    potential = outcome.load().potential
    assert np.isfinite(potential[:64]).all()  # the other chunks are sound
    with pytest.raises(ValueError, match="checksum"):
        potential[64:128]


def test_a_damaged_input_of_a_damaged_result_is_mended_first(copy: LocalStore) -> None:
    nodes = plan()
    for stage in ("mesh", "wave"):
        apply(DAMAGES["bit of a table" if stage == "mesh" else "lost chunk"], copy)
    source = source_node(nodes["wave"].inputs["surface"])
    assert source is nodes["mesh"]
    outcomes = run(nodes, copy, recompute_damaged=True)
    assert [outcomes[name].hit for name in ("mesh", "wave", "peak")] == [False, False, True]


def test_an_artefact_that_cannot_be_set_aside_is_told_with_the_reason(
    copy: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = apply(DAMAGES["lost table"], copy)

    def refuse(*arguments: Any) -> None:
        raise PermissionError(13, "Permission denied", str(folder))

    monkeypatch.setattr("os.rename", refuse)
    with pytest.raises(StoreError, match=re.escape(f"no permission to use the store: {folder}")):
        run(plan(), copy, recompute_damaged=True)


@pytest.mark.parametrize("code", [errno.EACCES, errno.ESTALE, errno.EMFILE])
@pytest.mark.parametrize("what", ["a manifest", "a folder", "a file"])
def test_what_cannot_be_looked_at_is_not_called_damaged(
    what: str, code: int, copy: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Otherwise a moment without file descriptors would cost sound results.
    real = os.scandir

    def refuse(path: Any = ".") -> Any:
        if str(copy.path) in str(path):
            raise OSError(code, os.strerror(code))
        return real(path)

    places = {
        "a manifest": "pipeline.store.local._read_manifest",
        "a folder": "os.scandir",
        "a file": "pipeline.verification.sha256",
    }
    (ref,) = copy.refs("wave")
    monkeypatch.setattr(places[what], refuse)
    for act in (
        lambda: copy.verify(ref, full=True),
        lambda: copy.quarantine(ref),
        lambda: run(plan(), copy, recompute_damaged=True),
    ):
        with pytest.raises(StoreError) as caught:
            act()
        assert not isinstance(caught.value, DamagedError)
    assert not (copy.path / "quarantine").exists()


def test_a_file_that_the_disk_has_lost_is_damaged(
    copy: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    def lost(path: Path) -> str:
        raise OSError(errno.EIO, "Input/output error")

    monkeypatch.setattr("pipeline.verification.sha256", lost)
    (ref,) = copy.refs("peak")
    (told,) = copy.verify(ref, full=True)
    assert told == "record.h5 cannot be read (Input/output error)"


def test_a_folder_that_cannot_be_read_is_never_taken_for_an_empty_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # A manifest made so would lack files, and a checkpoint would, too.
    (tmp_path / "record.zarr").mkdir()
    (tmp_path / "record.zarr" / "zarr.json").write_text("{}")
    real = os.scandir

    def refuse(path: Any) -> Any:
        if os.fspath(path).endswith(".zarr"):
            raise OSError(errno.EMFILE, "Too many open files", os.fspath(path))
        return real(path)

    monkeypatch.setattr(os, "scandir", refuse)
    for act in (hash_files, sync_tree, lambda path: ChunkFiles(path).digests()):
        with pytest.raises(OSError, match="Too many open files"):
            act(tmp_path)
