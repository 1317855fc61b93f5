"""The commands that look after the store."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from pipeline.keys import Ref
from pipeline.store import LocalStore, RunLabel
from pipeline.testing.stores import example, forge, publish
from tests.workflows.conftest import invoke


@pytest.fixture
def store(tmp_path: Path) -> LocalStore:
    """A store with three artefacts of two stages, of which a named run uses the first."""
    kept = LocalStore(tmp_path / "store")
    label = RunLabel.of("thesis", tmp_path / "thesis", "curling")
    kept.begin(label)
    kept.find(publish(kept, example("geometry", 1.0)).ref, label)
    kept.finish(label)
    for stage, gain, contents in (("geometry", 2.0, b"some"), ("mechanics", 3.0, b"more of it")):
        publish(kept, example(stage, gain), contents)
    return kept


def call(store: LocalStore, *arguments: object, code: int = 0) -> str:
    """What ``myofilm store ...`` tells."""
    result = invoke("store", *arguments, "--store", store.path)
    assert result.exit_code == code, result.output
    return result.output


def key(stage: str, gain: float) -> str:
    return example(stage, gain).key[:12]


def listed(told: str) -> list[str]:
    """Short keys in a list, in order."""
    known = {key("geometry", 1.0), key("geometry", 2.0), key("mechanics", 3.0)}
    return [word for line in told.splitlines() for word in line.split() if word in known]


def leave_work(store: LocalStore, gain: float, days: float) -> None:
    """Work on an artefact that was given up so many days ago."""
    with store.writing(example(gain=gain).ref, lambda holder: None) as work:
        work.begin(resume=False)
        (work.data / "record.h5").write_bytes(b"half")
    then = time.time() - days * 86400
    for path in (work.folder, work.data, work.data / "record.h5"):
        os.utime(path, (then, then))


def test_the_list_tells_size_cost_age_use_and_tags(store: LocalStore) -> None:
    call(store, "tag", key("mechanics", 3.0), "figure-9")
    told = call(store, "ls")
    head, *lines, last = told.splitlines()
    assert head.split("  ")[0] == "STAGE"
    assert len(lines) == 3
    assert "10 B" in lines[2]
    assert "1.5 s" in lines[2]
    assert lines[2].endswith("figure-9")
    assert last == f"3 results, 22 B in {store.path}"


def test_the_list_is_sorted_and_chosen_as_asked(store: LocalStore, tmp_path: Path) -> None:
    first, second, third = key("geometry", 1.0), key("geometry", 2.0), key("mechanics", 3.0)
    assert listed(call(store, "ls", "--sort", "size")) == [third, first, second]
    assert listed(call(store, "ls", "--sort", "worth")) == [third, first, second]
    assert listed(call(store, "ls", "mechanics")) == [third]
    assert listed(call(store, "ls", "--run", "thesis")) == [first]
    assert listed(call(store, "ls", "--run", tmp_path / "thesis")) == [first]
    assert set(listed(call(store, "ls", "--unreachable"))) == {second, third}
    assert set(listed(call(store, "ls", "--older-than", "1d"))) == {second, third}  # of 2024
    call(store, "tag", third, "figure-9")
    assert listed(call(store, "ls", "--tag", "figure-9")) == [third]
    assert "no such results" in call(store, "ls", "geometry", "--tag", "figure-9")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["ls", "mechanic"], "did you mean 'mechanics'"),
        (["ls", "--sort", "colour"], "choose one of stage, size"),
        (["ls", "--run", "thesi"], "did you mean 'thesis'"),
        (["ls", "--tag", "x"], "there is no tag 'x'"),
        (["ls", "--older-than", "30"], "'30' is not a time"),
        (["gc", "--older-than", "a month"], "'a month' is not a time"),
        (["gc", "--max-size", "10 gigs"], "'10 gigs' is not a size"),
        (["rm", "nothing"], "knows no run 'nothing'"),
        (["rm", "abc"], "at least 4 characters"),
        (["verify", "ffff"], "holds no result whose key starts with 'ffff'"),
        (["tag", "ffff", "x"], "holds no result whose key starts with 'ffff'"),
    ],
)
def test_what_is_not_there_is_bad_input(
    store: LocalStore, arguments: list[str], message: str
) -> None:
    assert message in call(store, *arguments, code=2)


def test_nothing_is_removed_before_it_is_asked_twice(store: LocalStore) -> None:
    told = call(store, "gc", "--unreachable")
    assert set(listed(told)) == {key("geometry", 2.0), key("mechanics", 3.0)}
    assert "2 results (computed in 3 s)" in told
    assert "--yes" in told
    assert len(list(store.refs())) == 3
    assert "removed 2 results" in call(store, "gc", "--unreachable", "--yes")
    assert list(store.refs()) == [example("geometry", 1.0).ref]


def test_without_a_reason_results_stay_and_old_unfinished_work_goes(store: LocalStore) -> None:
    leave_work(store, 8.0, days=0.1)
    leave_work(store, 9.0, days=9.0)
    told = call(store, "gc", "--yes")
    assert "removed 0 results and 1 leftover" in told
    assert len(list(store.refs())) == 3
    assert [each.key for each in store.upkeep.leftovers()] == [example(gain=8.0).key]


def test_a_size_that_cannot_be_reached_is_told(store: LocalStore) -> None:
    told = call(store, "gc", "--max-size", "5B", "--yes")
    assert "removed 2 results" in told
    assert "8 B of results stay, more than 5 B" in told


def test_the_runs_are_listed_with_what_they_keep_and_why(store: LocalStore, tmp_path: Path) -> None:
    label = RunLabel.of(None, tmp_path / "gone", "twitch")
    store.begin(label)
    store.finish(label)
    told = call(store, "runs").splitlines()
    assert [line.split()[:2] for line in told[1:]] == [
        ["thesis", "curling"],
        [str(tmp_path / "gone"), "twitch"],
    ]
    assert told[1].endswith("finished  1        8 B   by its name")
    assert told[2].endswith("finished  0        0 B   no longer")


def test_a_result_is_removed_by_its_key_unless_a_name_or_a_tag_keeps_it(
    store: LocalStore, tmp_path: Path
) -> None:
    first, second, third = key("geometry", 1.0), key("geometry", 2.0), key("mechanics", 3.0)
    assert "myofilm store rm 'thesis'" in call(store, "rm", first, code=2)
    call(store, "tag", second, "figure-9")
    refused = call(store, "rm", second, code=2)
    assert f"myofilm store tag geometry/{second} figure-9 --remove" in refused
    label = RunLabel.of(None, tmp_path, "curling")
    store.begin(label)
    store.find(example("mechanics", 3.0).ref, label)
    assert "wait for the run" in call(store, "rm", third, code=2)
    store.finish(label)
    told = call(store, "rm", third)
    assert f"{tmp_path} would need it computed again" in told
    call(store, "tag", second, "figure-9", "--remove")
    call(store, "rm", f"geometry/{second}")
    assert list(store.refs()) == [example("geometry", 1.0).ref]


def test_a_forgotten_run_keeps_nothing_and_removes_nothing(store: LocalStore) -> None:
    told = call(store, "rm", "thesis")
    assert "3 results (22 B) that nothing keeps" in told
    assert len(list(store.refs())) == 3
    assert "knows no runs" in call(store, "runs")


def test_a_run_that_goes_on_is_not_forgotten(store: LocalStore) -> None:
    label = RunLabel("now", named=True)
    store.begin(label)
    assert "goes on" in call(store, "rm", "now", code=2)
    store.finish(label)
    call(store, "rm", "now")


def test_a_tag_that_is_not_there_cannot_be_taken_away(store: LocalStore) -> None:
    assert "has no tag 'x'. It has: none" in call(
        store, "tag", key("geometry", 1.0), "x", "--remove", code=2
    )


def test_verifying_names_every_damaged_result_and_its_file(store: LocalStore) -> None:
    assert "3 results checked (checksums and keys), 0 damaged" in call(store, "verify")
    flipped, cut = example("geometry", 1.0).ref, example("mechanics", 3.0).ref
    (store.data(flipped) / "record.h5").write_bytes(b"cOntents")
    (store.data(cut) / "record.h5").write_bytes(b"more")
    told = call(store, "verify", code=1)
    assert f"{flipped}: the checksum of record.h5 is wrong" in told
    assert f"{cut}: record.h5 has 4 bytes instead of 10" in told
    assert "2 of 3 results are damaged" in told
    assert "--recompute-damaged" in told
    quick = call(store, "verify", "--quick", code=1)
    assert "1 of 3 results are damaged" in quick
    assert "1 results checked" in call(store, "verify", key("geometry", 2.0))
    call(store, "verify", key("geometry", 1.0), code=1)


def test_verifying_tells_of_work_that_is_half_done(store: LocalStore) -> None:
    leave_work(store, 9.0, days=2.0)
    told = call(store, "verify")
    assert f"left over: {example(gain=9.0).key[:12]}, 4 B, changed 2 d ago: given up" in told


def test_what_was_set_aside_as_damaged_is_told_and_goes_in_time(store: LocalStore) -> None:
    ref = example("mechanics", 3.0).ref
    (store.data(ref) / "record.h5").write_bytes(b"more")
    aside = store.quarantine(ref)
    assert aside is not None
    assert "set aside as damaged" in call(store, "verify")
    assert "removed 0 results and 0 leftovers" in call(store, "gc", "--yes")
    then = time.time() - 40 * 86400
    for path in (aside.with_name(f"{aside.name}.json"), *aside.rglob("*"), aside):
        os.utime(path, (then, then))
    assert "set aside as damaged 40 days ago" in call(store, "gc")
    assert "removed 0 results and 1 leftover" in call(store, "gc", "--yes")
    assert list((store.path / "quarantine" / "mechanics").iterdir()) == []


def test_a_damaged_manifest_is_listed_and_can_be_removed(store: LocalStore) -> None:
    ref = Ref("mechanics", example("mechanics", 3.0).key)
    forge(store, ref, stage="geometry")
    (store.data(ref).parent / "manifest.json").write_bytes(b"{")
    assert "damaged: " in call(store, "ls", "mechanics")
    call(store, "gc", "--unreachable", "--yes")
    assert ref in set(store.refs())
    call(store, "rm", ref.key[:8])
    assert ref not in set(store.refs())


def test_an_absent_store_holds_nothing_and_is_not_made(tmp_path: Path) -> None:
    absent = LocalStore(tmp_path / "absent")
    for command in (["ls"], ["runs"], ["gc"], ["gc", "--unreachable", "--yes"], ["verify"]):
        call(absent, *command)
    assert not absent.path.exists()
