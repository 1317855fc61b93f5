"""Where results come from, as a user is told: tree, picture, archives."""

from __future__ import annotations

import itertools
import shutil
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from pipeline.keys import Ref
from pipeline.lineage import Lineage, lineage
from pipeline.store import LocalStore
from pipeline.testing.stores import example, publish
from tests.workflows.conftest import invoke
from workflows.provenance.layout import layout
from workflows.provenance.picture import picture
from workflows.provenance.tree import tree_rows


@pytest.fixture
def store(tmp_path: Path) -> LocalStore:
    """A store with two results."""
    made = LocalStore(tmp_path / "store")
    for gain in (1.0, 2.0):
        publish(made, example(gain=gain))
    return made


def lines_of(store: LocalStore) -> Lineage:
    return lineage(store, store.refs())


def test_boxes_stand_right_of_what_they_were_made_from_and_nothing_overlaps() -> None:
    boxes = "abcde"
    lines = [("a", "b"), ("a", "c"), ("b", "c"), ("a", "d"), ("c", "d"), ("a", "e"), ("d", "e")]
    places = layout(boxes, lines, dict.fromkeys(boxes, 10.0), 4.0)
    assert all(places.columns[start] < places.columns[end] for start, end in lines)
    for column in range(5):
        taken = [(places.heights[box], 10.0) for box in boxes if places.columns[box] == column]
        for start, end in lines:
            inside = places.columns[start] < column < places.columns[end]
            if inside:
                bend = places.bends[start, end][column - places.columns[start] - 1]
                taken.append((bend, 4.0))
        taken.sort()
        for (one, high), (other, tall) in itertools.pairwise(taken):
            assert other - one >= 0.5 * (high + tall) - 1e-9  # rounding


def test_a_picture_is_well_formed_shows_every_result_and_is_always_the_same(
    store: LocalStore,
) -> None:
    drawn = picture(lines_of(store))
    assert drawn == picture(lines_of(store))
    words = {element.text for element in ElementTree.fromstring(drawn).iter()}
    assert {ref.key[:12] for ref in store.refs()} <= words


def test_a_tree_names_what_is_gone(store: LocalStore) -> None:
    ref = next(store.refs())
    gone = lineage(store, [ref, Ref("mechanics", "0" * 40)])
    rows = {row[0]: row for row in tree_rows(gone)}
    assert rows["mechanics/000000000000"][2] == "no longer kept"


def test_show_export_and_import_through_the_command_line(store: LocalStore, tmp_path: Path) -> None:
    ref = next(store.refs())
    where = ("--store", store.path)
    archive, drawn = tmp_path / "one.tar", tmp_path / "one.svg"
    shown = invoke("store", "show", ref.key[:10], "--picture", drawn, *where)
    assert shown.exit_code == 0, shown.output
    assert ref.key in shown.output
    assert drawn.read_text().startswith("<svg")
    assert invoke("store", "export", ref.key[:10], archive, *where).exit_code == 0
    theirs = ("--store", tmp_path / "theirs")
    taken = invoke("store", "import", archive, *theirs)
    assert taken.exit_code == 0, taken.output
    assert "1 result taken in" in taken.output
    assert "one" in invoke("store", "runs", *theirs).output
    assert ref.key in invoke("store", "show", "one", *theirs).output


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("show", "nothing"), "no run is called 'nothing'"),
        (("export", "nothing", "x.tar"), "no run is called 'nothing'"),
        (("import", "absent.tar"), "no such file"),
    ],
)
def test_bad_requests_end_with_one_message(
    arguments: tuple[str, ...], told: str, store: LocalStore
) -> None:
    result = invoke("store", *arguments, "--store", store.path)
    assert result.exit_code == 2
    assert told in result.output


def test_a_name_that_stands_for_other_results_is_not_taken(
    store: LocalStore, tmp_path: Path
) -> None:
    theirs = ("--store", tmp_path / "theirs")
    for number, ref in enumerate(store.refs()):
        archive = tmp_path / f"{number}.tar"
        invoke("store", "export", ref.key, archive, "--store", store.path)
        result = invoke("store", "import", archive, "--name", "mine", *theirs)
    assert result.exit_code == 2
    assert "choose another name" in result.output
    shutil.rmtree(tmp_path / "theirs")


@pytest.mark.parametrize("command", ["show", "rm"])
def test_a_folder_outside_of_the_store_is_never_taken_for_a_result(
    command: str, store: LocalStore, tmp_path: Path
) -> None:
    mine = tmp_path / "mine" / "thesis"
    mine.mkdir(parents=True)
    for name in (str(mine), f"../../{mine.parent.name}/thesis"):
        result = invoke("store", command, name, "--store", store.path)
        assert result.exit_code == 2, result.output
        assert mine.is_dir()
