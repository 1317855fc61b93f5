"""Workers of other code or another store are refused, those with other libraries warned of."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from pipeline.errors import InputError
from pipeline.executors.agreement import Agreement
from pipeline.executors.opening import opened
from pipeline.store import LocalStore
from pipeline.store.labels import RunLabel, process_label
from tests.executors.clusters import ROOT, Cluster, cluster


@pytest.fixture
def store(tmp_path: Path) -> LocalStore:
    return LocalStore(tmp_path / "store")


@pytest.fixture
def agreement(store: LocalStore) -> Agreement:
    return Agreement.here(store, process_label())


def test_this_process_agrees_with_itself(agreement: Agreement) -> None:
    findings = agreement.findings(patience=0.0)
    assert (findings.refusals, findings.warnings) == ((), ())
    assert agreement.brief.findings(patience=0.0) == findings
    assert {"pipeline.sweep", "stages.mechanics.stage", "workflows.cli"} <= agreement.modules.keys()


def test_other_code_is_refused_and_named(agreement: Agreement) -> None:
    modules = {**agreement.modules, "pipeline.sweep": "0", "stages.new": "1"}
    other = replace(agreement, code="2", modules=modules)
    (told,) = other.findings(patience=0.0).refusals
    assert told.startswith("it has other code: pipeline.sweep, stages.new differ")
    (told,) = other.brief.findings(patience=0.0).refusals
    assert told.startswith("it has other code; install")


def test_another_store_is_refused(agreement: Agreement, tmp_path: Path) -> None:
    elsewhere = replace(agreement, store=LocalStore(tmp_path / "elsewhere"))
    (told,) = elsewhere.findings(patience=0.0).refusals
    assert str(tmp_path / "elsewhere") in told
    assert "--store" in told
    unknown = replace(agreement, label=RunLabel("never begun"))
    assert len(unknown.findings(patience=0.0).refusals) == 1


def test_other_libraries_are_told(agreement: Agreement) -> None:
    versions = {**agreement.versions, "numpy": "1.0"}
    findings = replace(agreement, versions=versions).findings(patience=0.0)
    assert findings.refusals == ()
    assert findings.warnings[0].startswith("it has numpy ")
    assert findings.warnings[0].endswith("(here: 1.0)")


def with_other_code(folder: Path, edit: Callable[[str], str]) -> str:
    """Folder with a copy of the program in which one module was edited."""
    for name in ("pipeline", "stages", "workflows"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    module = folder / "pipeline" / "threads.py"
    module.write_text(edit(module.read_text()))
    return str(folder)


@pytest.fixture
def lone(tmp_path: Path) -> Iterator[Cluster]:
    with cluster(tmp_path / "cluster", workers=0) as started:
        yield started


def test_a_worker_of_other_code_is_refused_unless_only_a_comment_differs(
    lone: Cluster, store: LocalStore, tmp_path: Path
) -> None:
    same = with_other_code(tmp_path / "same", lambda text: text + "# a comment\n")
    lone.start_worker(PYTHONPATH=same)
    lone.wait_for(1)
    with opened(None, lone.address, store, process_label()):
        pass
    other = with_other_code(tmp_path / "other", lambda text: text + "OTHER = 1\n")
    lone.start_worker(PYTHONPATH=other)
    lone.wait_for(2)
    with (
        pytest.raises(InputError, match=r"the worker tcp://.* other code: pipeline.threads differ"),
        opened(None, lone.address, store, process_label()),
    ):
        pass


def test_a_worker_without_the_program_is_refused(
    lone: Cluster, store: LocalStore, tmp_path: Path
) -> None:
    bare = tmp_path / "bare" / "pipeline"
    bare.mkdir(parents=True)
    (bare / "__init__.py").write_text("raise ImportError('not here')\n")
    lone.start_worker(PYTHONPATH=str(bare.parent))
    lone.wait_for(1)
    with (
        pytest.raises(InputError, match=r"cannot run this program \(.*not here.*install"),
        opened(None, lone.address, store, process_label()),
    ):
        pass
