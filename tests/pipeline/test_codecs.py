"""Records come back from their files as they were, and equal records make equal bytes."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from numpy.typing import NDArray

from pipeline.codecs import load, load_part, save
from pipeline.errors import StoreError
from pipeline.manifest import content_ids, hash_files


@dataclass(frozen=True)
class Space:
    degree: int
    knots: NDArray[np.float64]
    name: str | None = None


@dataclass(frozen=True)
class Circle:
    radius: float


@dataclass(frozen=True)
class Table:
    spaces: tuple[Space, Space]
    shape: Circle | Space
    points: NDArray[np.float64] = field(metadata={"unit": "mm", "axes": ("point", "xyz")})
    thin: NDArray[np.float64] = field(metadata={"unit": "mV", "stored": "float32"})
    kept: NDArray[np.int32] = field(metadata={"stored": None})
    flags: NDArray[np.bool_]
    empty: NDArray[np.float64]
    single: NDArray[np.float64]
    ragged: tuple[NDArray[np.float64], ...]
    speed: float = field(metadata={"unit": "mm/ms"})
    odd: tuple[float, ...] = (np.inf, -np.inf, 1e-300, 0.1, -0.0)
    nothing: None = None
    yes: bool = True
    count: int = 12345678901234567
    text: str = 'µm "quoted" \n'
    nested: tuple[tuple[int, str], ...] = ((1, "a"), (2, "b"))


@dataclass(frozen=True)
class LazyTable(Table):
    stored_as: ClassVar[str] = "zarr"


@dataclass(frozen=True)
class Both:
    table: Table
    lazy: LazyTable


def values() -> dict[str, Any]:
    return {
        "spaces": (Space(2, np.linspace(0, 1, 5), "u"), Space(3, np.zeros(0))),
        "shape": Circle(2.5),
        "points": np.asfortranarray(np.arange(12.0).reshape(4, 3) / 7),
        "thin": np.array([1 / 3, np.nan]),
        "kept": np.array([[1, 2], [3, 4]], np.int32),
        "flags": np.array([True, False]),
        "empty": np.zeros((0, 3)),
        "single": np.array(1.5),
        "ragged": (np.arange(2.0), np.arange(5.0)),
        "speed": np.float64(0.25),
    }


def assert_same(found: Any, expected: Any) -> None:
    if isinstance(expected, np.ndarray):
        array = np.asarray(found[...])
        assert array.dtype == expected.dtype
        np.testing.assert_array_equal(array, expected, strict=True)
    elif isinstance(expected, tuple):
        assert isinstance(found, tuple)
        for one, other in zip(found, expected, strict=True):
            assert_same(one, other)
    elif hasattr(expected, "__dataclass_fields__"):
        assert type(found) is type(expected)
        for name in expected.__dataclass_fields__:
            assert_same(getattr(found, name), getattr(expected, name))
    else:
        assert repr(found) == repr(expected)


@pytest.mark.parametrize("record", [Table, LazyTable])
def test_a_record_comes_back_as_it_was(record: type[Any], tmp_path: Path) -> None:
    save(tmp_path, record(**values()))
    found = load(tmp_path, record)
    stored = {**values(), "thin": values()["thin"].astype("float32"), "speed": 0.25}
    assert_same(found, record(**stored))


@pytest.mark.parametrize("record", [Table, LazyTable])
@pytest.mark.filterwarnings("error")
def test_what_is_too_large_for_the_stored_type_is_kept_as_infinite(
    record: type[Any], tmp_path: Path
) -> None:
    save(tmp_path, record(**{**values(), "thin": np.array([-1e300, 1.0])}))
    assert load(tmp_path, record).thin[...].tolist() == [-np.inf, 1.0]


def test_fields_kept_as_zarr_are_read_lazily(tmp_path: Path) -> None:
    save(tmp_path, LazyTable(**values()))
    points = load(tmp_path, LazyTable).points
    assert not isinstance(points, np.ndarray)
    assert points[1:3, 0].tolist() == [3 / 7, 6 / 7]


def test_units_and_axes_are_kept_for_other_programs(tmp_path: Path) -> None:
    import h5py
    import zarr

    save(tmp_path, Both(Table(**values()), LazyTable(**values())))
    with h5py.File(tmp_path / "table.h5") as file:
        assert file["points"].attrs["unit"] == "mm"
        assert [dim.label for dim in file["points"].dims] == ["point", "xyz"]
    points: Any = zarr.open_group(tmp_path / "lazy.zarr", mode="r")["points"]
    assert points.attrs["unit"] == "mm"
    assert points.metadata.dimension_names == ("point", "xyz")


def test_parts_are_kept_apart(tmp_path: Path) -> None:
    save(tmp_path, Both(Table(**values()), LazyTable(**values())))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["lazy.zarr", "table.h5"]
    assert_same(load_part(tmp_path, "table", Table).speed, 0.25)
    assert_same(load(tmp_path, Both).lazy.speed, 0.25)


def test_a_part_written_already_is_left_alone(tmp_path: Path) -> None:
    save(tmp_path, Both(Table(**values()), LazyTable(**values())), written={"lazy"})
    assert not (tmp_path / "lazy.zarr").exists()


def test_equal_records_make_equal_bytes_in_every_process(
    tmp_path: Path, output: Callable[..., str]
) -> None:
    save(tmp_path / "here", Both(Table(**values()), LazyTable(**values())))
    output(
        "from pathlib import Path\nfrom tests.pipeline.test_codecs import *\n"
        "save(Path('there'), Both(Table(**values()), LazyTable(**values())))"
    )
    assert hash_files(tmp_path / "here") == hash_files(tmp_path / "there")


def test_the_content_id_of_a_part_depends_on_that_part_alone(tmp_path: Path) -> None:
    table, lazy = Table(**values()), LazyTable(**values())
    save(tmp_path / "one", Both(table, lazy))
    save(tmp_path / "two", Both(Table(**{**values(), "speed": 0.5}), lazy))
    one, two = (content_ids(hash_files(tmp_path / name)) for name in ("one", "two"))
    assert one["lazy"] == two["lazy"]
    assert one["table"] != two["table"]


def test_the_content_id_of_a_part_does_not_depend_on_its_name(tmp_path: Path) -> None:
    @dataclass(frozen=True)
    class Pair:
        first: LazyTable
        second: LazyTable

    save(tmp_path, Pair(LazyTable(**values()), LazyTable(**values())))
    ids = content_ids(hash_files(tmp_path))
    assert ids["first"] == ids["second"]


@pytest.mark.parametrize("record", [Table, LazyTable])
@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("speed", object(), "speed holds a object"),
        ("speed", [1.0], "speed holds a list"),
        ("points", np.zeros(3), r"shape \(3,\), but its axes"),
        ("flags", np.array(["a"]), "flags holds <U1 values"),
        ("flags", np.array([None]), "flags holds object values"),
    ],
)
def test_what_no_record_may_hold_is_refused_by_name(
    record: type[Any], field: str, value: Any, message: str, tmp_path: Path
) -> None:
    with pytest.raises((TypeError, ValueError), match=message):
        save(tmp_path, record(**{**values(), field: value}))


def test_a_record_of_other_fields_is_not_read_wrongly(tmp_path: Path) -> None:
    @dataclass(frozen=True)
    class Grown:
        radius: float
        colour: str = "red"

    save(tmp_path, Circle(1.0))
    with pytest.raises(StoreError, match="has radius, colour"):
        load(tmp_path, Grown)


def test_a_chunk_of_fill_values_is_written_like_any_other(tmp_path: Path) -> None:
    # A chunk that is not there would read the same, so a lost one could not be told from it.
    save(tmp_path, LazyTable(**{**values(), "points": np.full((4, 3), np.nan)}))
    assert (tmp_path / "record.zarr" / "points" / "c.0.0").is_file()


def test_arrays_whose_chunks_lie_in_folders_as_earlier_versions_kept_them_can_be_read(
    tmp_path: Path,
) -> None:
    save(tmp_path, LazyTable(**values()))
    expected = load(tmp_path, LazyTable).points[...]
    group = tmp_path / "record.zarr"
    for metadata in (group / "points" / "zarr.json",):
        about = json.loads(metadata.read_bytes())
        assert about["chunk_key_encoding"]["configuration"] == {"separator": "."}
        about["chunk_key_encoding"]["configuration"] = {"separator": "/"}
        metadata.write_text(json.dumps(about))
        for chunk in list(metadata.parent.glob("c.*")):
            place = metadata.parent / chunk.name.replace(".", "/")
            place.parent.mkdir(parents=True)
            chunk.rename(place)
    assert list(group.glob("points/c/0/0"))
    np.testing.assert_array_equal(load(tmp_path, LazyTable).points[...], expected, strict=True)


@pytest.mark.parametrize(
    ("axes", "shape", "chunks"),
    [
        (("time",), (3000,), (3000,)),
        (("time", "point"), (100, 2000), (64, 2000)),
        (("point", "xyz"), (1_000_000, 3), (2**24 // 24, 3)),
    ],
)
def test_small_arrays_are_one_chunk_and_large_ones_chunks_of_rows(
    axes: tuple[str, ...], shape: tuple[int, ...], chunks: tuple[int, ...], tmp_path: Path
) -> None:
    @dataclass(frozen=True)
    class Large:
        stored_as: ClassVar[str] = "zarr"
        values: NDArray[np.float64] = field(metadata={"axes": axes})

    values = np.arange(float(np.prod(shape))).reshape(shape)
    save(tmp_path, Large(values))
    found: Any = load(tmp_path, Large).values
    assert found.chunks == chunks
    np.testing.assert_array_equal(found[...], values, strict=True)


def test_a_flipped_bit_in_a_chunk_does_not_pass(tmp_path: Path) -> None:
    save(tmp_path, LazyTable(**values()))
    chunk = tmp_path / "record.zarr" / "points" / "c.0.0"
    contents = bytearray(chunk.read_bytes())
    contents[len(contents) // 2] ^= 1
    chunk.write_bytes(contents)
    with pytest.raises(ValueError, match="checksum"):
        load(tmp_path, LazyTable).points[...]
