"""Keys and stored bytes of a release are those of the next one, unless that is wanted and told."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from numpy.typing import NDArray

from pipeline.canonical import digest
from pipeline.codecs import save
from pipeline.fingerprint import Fingerprint, fingerprint
from pipeline.keys import SCHEMA, Statement
from pipeline.manifest import content_ids, hash_files

SILENT = (
    "a changed key or stored form silently invalidates users' stores: "
    "bump pipeline.keys.SCHEMA, or explain in the commit why the change is wanted"
)

SOURCE = '''"""Docstrings do not count."""
from dataclasses import dataclass

import numpy as np

GAIN = 2.5e-1


@dataclass(frozen=True)
class Config:
    gain: float = GAIN


def amplified(config: Config, *values: float, **named: int | None) -> list[float]:
    """Nor does this."""
    with np.errstate(all="raise"):
        return [config.gain * v if v > 0 else -v**2 for v in (*values, b"x"[0], -1j.imag)]
'''

MODULES = {
    "toys.laws.soft": "d1a3c5e7f9b0d2c4a6e8f0b1d3c5a7e9f1b2d4c6",
    "toys.stage": "0123456789abcdef0123456789abcdef01234567",
}

STATEMENT = Statement(
    stage="toy",
    config={
        "law": {"name": "soft", "modulus": 1.5, "exponents": [1, 2.0, -0.25]},
        "label": "Müller 18 µm",
        "frames": 150,
        "closed": True,
        "limit": None,
        "probes": {"B": [3.5, 1.0], "A": [1.75, 1.0]},
        "empty": [{}, []],
    },
    code=Fingerprint("e4b0e1f0a53c7c1fbb1c9b8d3a9d5b7c2f6e8d01", MODULES),
    inputs={
        "surface": "5f0c2b7d9e1a3c4f6b8d0e2f4a6c8e0b2d4f6a81",
        "history": "a9b8c7d6e5f4039281706f5e4d3c2b1a09f8e7d6",
    },
)


@dataclass(frozen=True)
class Layer:
    thickness: float = field(metadata={"unit": "mm"})
    fibres: tuple[float, ...] = ()


@dataclass(frozen=True)
class Table:
    points: NDArray[np.float64] = field(metadata={"unit": "mm", "axes": ("point", "xyz")})
    counts: NDArray[np.int64] = field(metadata={"axes": ("point",)})
    layers: tuple[Layer, ...] = ()
    label: str | None = None


@dataclass(frozen=True)
class LazyTable:
    stored_as: ClassVar[str] = "zarr"

    potential: NDArray[np.float64] = field(
        metadata={"unit": "mV", "axes": ("time", "point"), "stored": "float32"}
    )
    layers: tuple[Layer, ...] = ()
    label: str | None = None


LAYERS = (Layer(0.018, (0.0, 90.0)), Layer(0.004))

RECORDS: dict[str, Any] = {
    "hdf5": Table(np.arange(6.0).reshape(2, 3) / 8, np.array([1, 2]), LAYERS, "film"),
    "zarr": LazyTable(np.arange(6.0).reshape(3, 2) / 8, LAYERS, None),
}


def test_the_key_of_a_statement_stays() -> None:
    assert SCHEMA == 1, SILENT
    assert STATEMENT.key == "d48eaf5fab6fd6823a183bdaca2ed35329ee96d8", SILENT


def test_the_digest_of_a_module_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "pinned_source.py").write_text(SOURCE, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    found = fingerprint(["pinned_source"], ["pinned_source"])
    assert found.modules == {"pinned_source": "9df8008d121f127be5ae22d468fc2fec163e3ee1"}, SILENT
    assert found.digest == digest(found.modules), SILENT


@pytest.mark.parametrize(
    ("kind", "content"),
    [
        ("hdf5", "84cd051f1de4eaa796493e244496c12b1fe22f99"),
        ("zarr", "b1c4bd05e6325cd5fe9640f43419c56dc237a3f1"),
    ],
)
def test_the_content_id_of_a_record_stays(kind: str, content: str, tmp_path: Path) -> None:
    # Another version of h5py or zarr may write other bytes: then say so in the commit.
    save(tmp_path, RECORDS[kind])
    assert content_ids(hash_files(tmp_path)) == {"record": content}, SILENT
