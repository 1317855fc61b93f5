"""A manifest says from which state of the source tree a result came."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from pipeline.provenance import environment, git_state, versions


def git(folder: Path, *arguments: str) -> None:
    identity = ["-c", "user.name=a", "-c", "user.email=a@b.example"]
    subprocess.run(["git", "-C", folder, *identity, *arguments], check=True, capture_output=True)


def test_outside_a_repository_there_is_no_git_state(tmp_path: Path) -> None:
    assert git_state(tmp_path) is None


def test_the_git_state_tells_revision_and_changes(tmp_path: Path) -> None:
    git(tmp_path, "init")
    (tmp_path / "file").write_text("one\n")
    git(tmp_path, "add", "file")
    git(tmp_path, "commit", "-m", "one")
    clean = git_state(tmp_path)
    assert clean is not None
    assert len(clean["revision"]) == 40
    assert (clean["dirty"], clean["diff"]) == (False, None)
    (tmp_path / "file").write_text("two\n")
    dirty = git_state(tmp_path)
    assert dirty is not None
    assert dirty["revision"] == clean["revision"]
    assert dirty["dirty"]
    assert len(dirty["diff"]) == 64


def test_git_is_asked_once_for_all_results_of_a_process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    git(tmp_path, "init")
    (tmp_path / "package").mkdir()
    (tmp_path / "package" / "file.py").write_text("one\n")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "-m", "one")
    first = environment(tmp_path / "package" / "file.py")["git"]
    assert first == git_state(tmp_path)
    monkeypatch.setattr(subprocess, "run", None)
    assert environment(tmp_path / "other.py")["git"] == first


def test_versions_are_known_without_importing_the_libraries() -> None:
    assert versions().keys() == {"python", "numpy", "scipy", "numba", "h5py", "zarr"}
    assert all(environment(None)["versions"].values())
