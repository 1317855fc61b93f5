"""When an exported file counts as up to date."""

from __future__ import annotations

import os
from pathlib import Path

from workflows.exports.ledger import NAME, Ledger, source_id


def made(folder: Path) -> Ledger:
    (folder / "table.csv").write_text("1,2,3")
    ledger = Ledger(folder)
    ledger.made("table.csv", "source")
    return Ledger(folder)


def test_a_file_is_current_until_its_source_changes(tmp_path: Path) -> None:
    ledger = made(tmp_path)
    assert ledger.is_current("table.csv", "source")
    assert not ledger.is_current("table.csv", "another source")
    assert not ledger.is_current("other.csv", "source")


def test_a_file_that_was_changed_or_removed_is_not_current(tmp_path: Path) -> None:
    ledger = made(tmp_path)
    path = tmp_path / "table.csv"
    path.write_text("1,2,4")
    os.utime(path, ns=(1, 1))
    assert not ledger.is_current("table.csv", "source")
    path.unlink()
    assert not ledger.is_current("table.csv", "source")


def test_a_file_that_was_only_touched_is_current(tmp_path: Path) -> None:
    ledger = made(tmp_path)
    os.utime(tmp_path / "table.csv", ns=(1, 1))
    assert ledger.is_current("table.csv", "source")


def test_an_unreadable_ledger_counts_as_empty(tmp_path: Path) -> None:
    made(tmp_path)
    for contents in ("{half", "[]", '{"table.csv": 3}'):
        (tmp_path / NAME).write_text(contents)
        assert not Ledger(tmp_path).is_current("table.csv", "source")


def test_values_are_no_files(tmp_path: Path) -> None:
    ledger = Ledger(tmp_path)
    ledger.keep("quantities", "source", {"speed": 0.0175})
    assert not Ledger(tmp_path).holds_files()
    assert made(tmp_path).holds_files()


def test_a_value_is_kept_with_its_source(tmp_path: Path) -> None:
    Ledger(tmp_path).keep("quantities", "source", {"speed": 0.0175})
    assert Ledger(tmp_path).value("quantities", "source") == {"speed": 0.0175}
    assert Ledger(tmp_path).value("quantities", "another") is None


def test_a_source_covers_the_code_and_what_is_shown() -> None:
    one = source_id(["workflows.exports.probes"], {"postprocessing": "a"})
    assert one == source_id(["workflows.exports.probes"], {"postprocessing": "a"})
    assert one != source_id(["workflows.exports.probes"], {"postprocessing": "b"})
    assert one != source_id(["workflows.exports.paraview"], {"postprocessing": "a"})


def test_a_value_in_which_something_changed_is_not_used(tmp_path: Path) -> None:
    Ledger(tmp_path).keep("quantities", "source", {"speed": 0.0175})
    path = tmp_path / NAME
    path.write_text(path.read_text().replace("0.0175", "0.0975"))
    assert Ledger(tmp_path).value("quantities", "source") is None
