"""A plan compares with the past result that tells most, and knows of damage, checkpoints and versions."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from pipeline import provenance
from pipeline.errors import StageError
from pipeline.plan import Changed, Damaged, Hit, Missing, Pending, explain, explaining
from pipeline.plan.reasons import ABSENT, ConfigChanged, config_changes
from pipeline.runner import run
from pipeline.running import checkpoint_summary
from pipeline.running.checkpoint_summary import CheckpointSummary, summary
from pipeline.running.checkpoints import Checkpoint
from pipeline.running.streams import SavedStream
from pipeline.store import LocalStore
from tests.pipeline import toy


def nodes(**wave: Any) -> dict[str, Any]:
    """A mesh, and a wave on it."""
    film = toy.mesh(toy.MeshConfig())
    return {"mesh": film, "wave": toy.wave(toy.WaveConfig(**wave), surface=film.part("surface"))}


def changes(was: Any, now: Any) -> list[tuple[str, Any, Any]]:
    return [(c.field, c.was, c.now) for c in config_changes(was, now)]


def test_a_table_that_came_is_told_once_and_an_empty_one_before_it_is_not() -> None:
    load = {"kind": "area", "size": 1.0}
    assert changes({"loads": {}}, {"loads": {"tip": load}}) == [("loads.tip", ABSENT, load)]
    assert changes({"loads": {"tip": load}}, {"loads": {}}) == [("loads.tip", load, ABSENT)]


def test_another_model_is_told_as_a_whole_and_another_parameter_of_it_alone() -> None:
    soft, stiff = {"name": "soft", "k": 1.0}, {"name": "stiff", "m": 1.0, "n": 2.0}
    assert changes({"law": soft}, {"law": stiff}) == [("law", soft, stiff)]
    assert changes({"law": soft}, {"law": soft | {"k": 2.0}}) == [("law.k", 1.0, 2.0)]
    assert str(ConfigChanged("law", soft, stiff)) == "law is stiff (m=1.0, n=2.0), was soft (k=1.0)"


def test_lists_of_tables_are_compared_item_by_item_and_lists_of_numbers_as_a_whole() -> None:
    one, two = {"start": 1.0}, {"start": 2.0}
    assert changes({"s": [one, one]}, {"s": [one, two]}) == [("s.1.start", 1.0, 2.0)]
    assert changes({"s": [one]}, {"s": [one, two]}) == [("s.1", ABSENT, two)]
    assert changes({"s": [1, 2]}, {"s": [1, 3]}) == [("s", [1, 2], [1, 3])]
    assert changes({"s": [1.0]}, {"s": [1]}) == [("s", [1.0], [1])]


def test_the_same_request_by_other_code_is_nearer_than_another_request_by_this_code(
    store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    run(nodes(gain=1.0), store)
    real = explaining.fingerprint_of

    def edited(*arguments: Any) -> Any:
        code = real(*arguments)
        modules = {name: digest[::-1] for name, digest in code.modules.items()}
        return type(code)("edited", modules, code.bare)

    run(nodes(gain=2.0), store)
    monkeypatch.setattr(explaining, "fingerprint_of", edited)
    (mesh, wave) = explain(nodes(gain=1.0), store)
    assert isinstance(mesh, Changed)
    assert isinstance(wave, Changed)
    assert not [reason for reason in wave.reasons if isinstance(reason, ConfigChanged)]


def test_only_the_latest_results_are_compared_with(
    store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(explaining, "COMPARED", 2)
    for gain in (1.0, 2.0, 3.0):
        run(nodes(gain=gain, frames=10 if gain == 1.0 else 11), store)
    read = []
    real = store.manifest
    monkeypatch.setattr(store, "manifest", lambda ref: read.append(ref) or real(ref))
    verdict = explain(nodes(gain=9.0, frames=10), store)[-1]
    assert isinstance(verdict, Changed)
    assert {str(reason) for reason in verdict.reasons} == {
        "gain is 9.0, was 3.0",
        "frames is 10, was 11",
    }
    assert len({ref for ref in read if ref.stage == "wave"}) == 2


def test_a_damaged_result_is_told_and_what_follows_depends_on_it(store: LocalStore) -> None:
    ref = run(nodes(), store)["mesh"].manifest.ref
    next(store.data(ref).rglob("*.h5")).unlink()
    damaged, wave = explain(nodes(), store)
    assert isinstance(damaged, Damaged)
    assert damaged.key == ref.key
    assert "missing" in damaged.problems[0]
    assert isinstance(wave, Pending)


def test_a_hit_of_other_library_versions_says_so(
    store: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    run(nodes(), store)
    (hit, _) = explain(nodes(), store)
    assert isinstance(hit, Hit)
    assert hit.versions == ()
    now = dict(provenance.versions())
    monkeypatch.setattr(provenance, "versions", lambda: now | {"numpy": "99.0"})
    (hit, _) = explain(nodes(), store)
    assert isinstance(hit, Hit)
    assert hit.versions == (f"numpy {now['numpy']} (installed: 99.0)",)


def test_a_checkpoint_that_will_be_resumed_is_told_with_what_it_saves(store: LocalStore) -> None:
    with pytest.raises(StageError):
        run(nodes(fail_at=100), store, checkpoint_interval=0.0)
    wave = explain(nodes(fail_at=100), store)[-1]
    assert isinstance(wave, Missing)
    assert wave.resume is not None
    assert wave.resume.obstacle == ""
    assert wave.resume.frames is not None
    assert 0 < wave.resume.frames <= 100
    assert wave.resume.seconds > 0
    assert str(wave.resume).startswith(
        f"a checkpoint after {wave.resume.frames} frames will be resumed"
    )
    assert getattr(explain(nodes(fail_at=101), store)[-1], "resume", None) is None


def test_the_summary_of_a_checkpoint_says_what_loading_it_would(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "state.npz"
    streams = {"a": SavedStream(12, {}), "b": SavedStream(30, {})}
    Checkpoint("key", {}, streams, {}, seconds=2.5).save(path)
    assert summary(path, "key") == CheckpointSummary(30, 2.5)
    other = summary(path, "other")
    assert other is not None
    assert "another result" in other.obstacle
    monkeypatch.setattr(checkpoint_summary, "processor", lambda: "another kind")
    elsewhere = summary(path, "key")
    assert elsewhere is not None
    assert "processor" in str(elsewhere)
    Checkpoint("key", {}, {}, {}, seconds=0.0).save(path)
    found = summary(path, "key")
    assert found is not None
    assert found.frames is None


@pytest.mark.parametrize("keep", [0, 1, 30, 200, -30, -1])
def test_a_damaged_checkpoint_has_no_summary(keep: int, tmp_path: Path) -> None:
    path = tmp_path / "state.npz"
    Checkpoint("key", {}, {}, {}).save(path)
    path.write_bytes(path.read_bytes()[:keep])
    assert summary(path, "key") is None
    assert summary(tmp_path / "absent.npz", "key") is None
