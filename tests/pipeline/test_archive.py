"""Results passed on as one file: what arrives is what was sent, or nothing is taken in."""

from __future__ import annotations

import dataclasses
import io
import json
import shutil
import tarfile
from collections.abc import Callable
from pathlib import Path

import pytest

from pipeline.archive.export import WritingError, export
from pipeline.archive.form import HEADER, ArchiveError, Header, folder_of
from pipeline.archive.reading import check
from pipeline.archive.taking_in import Taken, take_in
from pipeline.errors import InputError, StoreError
from pipeline.keys import Ref
from pipeline.lineage import lineage
from pipeline.manifest import Manifest
from pipeline.runner import run
from pipeline.store import LocalStore
from pipeline.store.labels import RunLabel
from tests.pipeline.toy import MeshConfig, WaveConfig, mesh, peak, wave

Members = list[tuple[tarfile.TarInfo, bytes]]


def nodes() -> dict[str, object]:
    film = mesh(MeshConfig())
    history = wave(WaveConfig(), film.part("surface"))
    return {"mesh": film, "wave": history, "peak": peak(MeshConfig(), history)}


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the store of a small run, and the run's archive."""
    folder = tmp_path_factory.mktemp("exported")
    kept = LocalStore(folder / "store")
    outcomes = run(nodes(), kept)  # type: ignore[arg-type]
    lines = lineage(kept, [outcome.manifest.ref for outcome in outcomes.values()])
    export(kept, Header(tuple(lines.manifests), "mine", "toy"), folder / "run.tar")
    return folder


@pytest.fixture
def sent(exported: Path, tmp_path: Path) -> Path:
    """Archive of a small run."""
    return shutil.copy(exported / "run.tar", tmp_path / "run.tar")


@pytest.fixture
def store(exported: Path, tmp_path: Path) -> LocalStore:
    """The store that it is of."""
    return LocalStore(shutil.copytree(exported / "store", tmp_path / "store"))


@pytest.fixture
def other(tmp_path: Path) -> LocalStore:
    """The store of a colleague, empty."""
    return LocalStore(tmp_path / "other")


def taken(path: Path, store: LocalStore) -> Taken:
    return take_in(store, path, check(path), RunLabel("theirs", named=True))


def members(path: Path) -> Members:
    with tarfile.open(path) as tar:
        files = [(member, tar.extractfile(member)) for member in tar]
        return [(member, file.read() if file else b"") for member, file in files]


def rewrite(path: Path, change: Callable[[Members], Members | None]) -> None:
    """Archive with other members."""
    found = members(path)
    changed = change(found) or found
    with tarfile.open(path, "w") as tar:
        for member, contents in changed:
            member.size = len(contents)
            tar.addfile(member, io.BytesIO(contents))


def place(found: Members, end: str) -> int:
    return next(i for i, (member, _) in enumerate(found) if member.name.endswith(end))


def edit_manifest(found: Members, **changes: object) -> None:
    """Change the first manifest, sealed anew, as one who means harm would."""
    i = place(found, "manifest.json")
    manifest = Manifest.from_json(found[i][1])
    found[i] = (found[i][0], dataclasses.replace(manifest, **changes).to_json())  # type: ignore[arg-type]


def edit_header(found: Members, **changes: object) -> None:
    data = json.loads(found[0][1])
    found[0] = (found[0][0], json.dumps({**data, **changes}).encode())


def test_a_colleague_finds_every_result_and_computes_nothing(
    sent: Path, store: LocalStore, other: LocalStore
) -> None:
    assert len(taken(sent, other).new) == 3
    outcomes = run(nodes(), other)  # type: ignore[arg-type]
    assert all(outcome.hit for outcome in outcomes.values())
    for ref in store.refs():
        assert other.manifest(ref) == store.manifest(ref)
        assert other.verify(ref, full=True) == ()


def test_what_was_taken_in_is_kept_under_its_name(sent: Path, other: LocalStore) -> None:
    taken(sent, other)
    (known,) = other.upkeep.runs()
    assert (known.label.name, known.label.named) == ("theirs", True)
    assert set(other.upkeep.used_by(known.label)) == set(other.refs())


def test_the_same_results_give_the_same_bytes(sent: Path, store: LocalStore) -> None:
    again = sent.with_name("again.tar")
    export(store, check(sent).header, again)
    assert again.read_bytes() == sent.read_bytes()


def test_taking_in_twice_changes_nothing(sent: Path, other: LocalStore) -> None:
    taken(sent, other)
    assert taken(sent, other) == Taken((), check(sent).header.refs, ())


def test_what_a_killed_import_had_published_is_not_read_again(
    sent: Path, other: LocalStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    from pipeline.store.workspace import LocalWorkspace

    publish = LocalWorkspace.publish
    done: list[Ref] = []

    def publish_one(work: LocalWorkspace, manifest: Manifest) -> Manifest:
        if done:
            raise KeyboardInterrupt
        done.append(manifest.ref)
        return publish(work, manifest)

    monkeypatch.setattr(LocalWorkspace, "publish", publish_one)
    with pytest.raises(KeyboardInterrupt):
        taken(sent, other)
    monkeypatch.undo()
    assert list(other.refs()) == done
    assert all(other.verify(ref, full=True) == () for ref in other.refs())
    second = taken(sent, other)
    assert list(second.present) == done
    assert len(second.new) == 2


def test_an_import_killed_outright_is_completed_by_the_next(
    sent: Path, other: LocalStore, start: Callable[..., object]
) -> None:
    killed = f"""
import os, signal
from pathlib import Path
from pipeline.archive.reading import check
from pipeline.archive.taking_in import take_in
from pipeline.store import LocalStore
from pipeline.store.labels import RunLabel
from pipeline.store.workspace import LocalWorkspace
publish, count = LocalWorkspace.publish, []
def dying(work, manifest):
    count.append(1)
    if len(count) == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    return publish(work, manifest)
LocalWorkspace.publish = dying
path = Path({str(sent)!r})
take_in(LocalStore({str(other.path)!r}), path, check(path), RunLabel("theirs", named=True))
"""
    process = start(killed)
    assert process.wait(timeout=60) == -9  # type: ignore[attr-defined]
    assert len(list(other.refs())) == 1
    assert len(taken(sent, other).new) == 2
    assert all(other.verify(ref, full=True) == () for ref in other.refs())


def test_results_with_other_bits_stay_as_they_are_and_are_told(
    sent: Path, store: LocalStore, other: LocalStore
) -> None:
    ref = check(sent).header.refs[0]
    with other.writing(ref, lambda holder: None) as work:
        work.begin(resume=False)
        for name in ("label.h5", "surface.h5"):
            (work.data / name).write_bytes(b"other bits")
        from pipeline.manifest import content_ids, hash_files, whole_content

        files = hash_files(work.data)
        parts = content_ids(files)
        changed = {"files": files, "parts": parts, "content": whole_content(parts)}
        mine = dataclasses.replace(store.manifest(ref), **changed)
        work.publish(mine)
    assert taken(sent, other).other == (ref,)
    assert other.manifest(ref) == mine


def test_a_compressed_archive_is_read_as_well(sent: Path, other: LocalStore) -> None:
    import gzip

    packed = sent.with_suffix(".tar.gz")
    packed.write_bytes(gzip.compress(sent.read_bytes()))
    assert len(taken(packed, other).new) == 3


def cut(share: float) -> Callable[[Path], None]:
    def change(path: Path) -> None:
        contents = path.read_bytes()
        path.write_bytes(contents[: int(share * len(contents))])

    return change


def members_changed(change: Callable[[Members], Members | None]) -> Callable[[Path], None]:
    return lambda path: rewrite(path, change)


def flipped(found: Members) -> None:
    i = place(found, ".h5")
    member, contents = found[i]
    found[i] = (member, bytes([contents[0] ^ 1]) + contents[1:])


def renamed(name: str) -> Callable[[Members], None]:
    def change(found: Members) -> None:
        found[place(found, ".h5")][0].name = name

    return change


def linked(found: Members) -> None:
    i = place(found, ".h5")
    link = tarfile.TarInfo(found[i][0].name)
    link.type, link.linkname = tarfile.SYMTYPE, "/etc/passwd"
    found[i] = (link, b"")


def outside(found: Members) -> None:
    """A manifest that asks for a file above, and an archive that has it."""
    i = place(found, "manifest.json")
    manifest = Manifest.from_json(found[i][1])
    files = (dataclasses.replace(manifest.files[0], path="../../../up.h5"), *manifest.files[1:])
    edit_manifest(found, files=files)
    j = place(found, ".h5")
    found[j][0].name = f"{folder_of(manifest.ref)}/data/../../../up.h5"


def forged(found: Members) -> None:
    edit_manifest(found, config={"height": 2.0, "label": "flat"})


def relabelled(found: Members) -> None:
    edit_manifest(found, content="0" * 40)


def foreign(found: Members) -> Members:
    return [*found, (tarfile.TarInfo("foreign"), b"")]


def edited(found: Members) -> None:
    i = place(found, "manifest.json")
    found[i] = (found[i][0], found[i][1].replace(b'"seconds": ', b'"seconds": 1'))


def without(end: str) -> Callable[[Members], None]:
    def change(found: Members) -> None:
        del found[place(found, end)]

    return change


def text(path: Path) -> None:
    path.write_text("no archive at all")


DAMAGES: dict[str, tuple[Callable[[Path], None], str]] = {
    "no tar": (text, "no tar file"),
    "empty": (cut(0.0), "no tar file"),
    "half of it": (cut(0.5), "cut short"),
    "its beginning": (cut(0.02), "cut short"),
    "a flipped bit": (members_changed(flipped), "checksum of .* is wrong"),
    "a lost file": (members_changed(without(".h5")), "stands in place of"),
    "no header": (members_changed(without(HEADER)), "stands in place of archive.json"),
    "a path upwards": (members_changed(renamed("../../up.h5")), "stands in place of"),
    "an absolute path": (members_changed(renamed("/up.h5")), "stands in place of"),
    "a path upwards that is announced": (members_changed(outside), "outside of its folder"),
    "a link": (members_changed(linked), "not a plain file"),
    "another key": (members_changed(forged), "key of .* is not that of its statement"),
    "another content": (members_changed(relabelled), "content ids of"),
    "an edited manifest": (members_changed(edited), "edited after it had been written"),
    "a foreign file": (members_changed(foreign), "'foreign' does not belong to it"),
    "a stage upwards": (
        members_changed(lambda found: edit_header(found, refs=[["../up", "0" * 40]])),
        "is not the name of a result",
    ),
    "a newer form": (
        members_changed(lambda found: edit_header(found, version=2)),
        "its version is 2, and this program knows those up to 1",
    ),
    "a newer store": (
        members_changed(lambda found: edit_header(found, schema=7)),
        "its schema is 7, and this program knows those up to 1",
    ),
    "an unreadable header": (
        members_changed(lambda found: edit_header(found, refs=3)),
        "header cannot be read",
    ),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_of_an_unsound_archive_nothing_is_taken(
    damage: str, sent: Path, other: LocalStore, tmp_path: Path
) -> None:
    change, told = DAMAGES[damage]
    change(sent)
    with pytest.raises(ArchiveError, match=told) as error:
        taken(sent, other)
    assert str(sent) in str(error.value)
    assert "Remedy: " in str(error.value)
    assert not other.path.exists()
    assert not list(tmp_path.rglob("up.h5"))


def test_an_archive_that_is_not_there_is_told_as_such(tmp_path: Path) -> None:
    with pytest.raises(ArchiveError, match="no such file"):
        check(tmp_path / "absent.tar")


def test_a_damaged_result_is_not_exported(store: LocalStore, sent: Path, tmp_path: Path) -> None:
    header = check(sent).header
    file = next(path for path in store.data(header.refs[0]).iterdir())
    contents = file.read_bytes()
    file.write_bytes(contents[:-1] + bytes([contents[-1] ^ 1]))
    with pytest.raises(StoreError, match="checksum"):
        export(store, header, tmp_path / "second.tar")
    assert not list(tmp_path.glob("*second.tar*"))


def test_no_file_is_overwritten(store: LocalStore, sent: Path) -> None:
    before = sent.read_bytes()
    with pytest.raises(InputError, match="is there already"):
        export(store, check(sent).header, sent)
    assert sent.read_bytes() == before


def test_a_full_disk_leaves_no_archive(
    store: LocalStore, sent: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    header = check(sent).header
    monkeypatch.setattr("pipeline.archive.export.os.fsync", full)
    with pytest.raises(WritingError, match="no space left"):
        export(store, header, tmp_path / "second.tar")
    assert not list(tmp_path.glob("*second.tar*"))
