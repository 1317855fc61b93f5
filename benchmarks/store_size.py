"""How large the results of a paper-scale run are, and what other stored forms would cost and lose.

    python benchmarks/store_size.py [WORKFLOW]... [--store DIR] [--out DIR] [--set SECTION.KEY=VALUE]...
                                    [--results DIR]

Computes each workflow with all fields in float64, into a store of its own, and writes its arrays again in other
forms: precision, compression, chunks. Prints tables and writes them as JSON to the folder DIR. With --results it also
compares the quantities with those of ordinary runs, in DIR/WORKFLOW/summary.json. Times are those of one process one after another: compare their ratios.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import shutil
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import zarr
from zarr.codecs import BloscCodec, Crc32cCodec

from pipeline.runner import run
from pipeline.store import LocalStore
from stages import artefacts
from workflows.exports.outputs import experiment_of
from workflows.request import Request

LARGE = 1 << 20
"""Bytes from which on an array is looked at; all others together are less than one per cent."""

ZSTD = {"cname": "zstd", "clevel": 3, "shuffle": "shuffle"}
FORMS: dict[str, dict[str, Any]] = {
    "as stored": {},
    "all float64": {"dtype": "float64"},
    "all float32": {"dtype": "float32"},
    "not compressed": {"blosc": None},
    "no checksum": {"checksum": False},
    "zstd 1": {"blosc": ZSTD | {"clevel": 1}},
    "zstd 9": {"blosc": ZSTD | {"clevel": 9}},
    "zstd 3, bits shuffled": {"blosc": ZSTD | {"shuffle": "bitshuffle"}},
    "lz4": {"blosc": {"cname": "lz4", "clevel": 5, "shuffle": "shuffle"}},
    "16 frames a chunk": {"rows": 16},
    "256 frames a chunk": {"rows": 256},
    "tiles in one file": {"tiles": True},
}


def in_float64() -> dict[tuple[str, str], str]:
    """Let all records keep float64 in this process; what they keep otherwise."""
    narrowed = {}
    for record in vars(artefacts).values():
        if isinstance(record, type) and dataclasses.is_dataclass(record):
            for one in dataclasses.fields(record):
                if stored := one.metadata.get("stored"):
                    narrowed[record.__name__, one.name] = stored
                    one.metadata = {**one.metadata, "stored": None}
    return narrowed


def arrays(store: LocalStore, refs: list[Any]) -> Iterator[tuple[str, str, zarr.Array[Any]]]:
    """Stage, name and values of each large array of a run."""
    for ref in refs:
        for path in sorted(store.data(ref).glob("*.zarr")):
            for name, array in sorted(zarr.open_group(path, mode="r").arrays()):
                if array.nbytes >= LARGE:
                    yield ref.stage, name, array


def written(values: np.ndarray, folder: Path, form: dict[str, Any]) -> zarr.Array[Any]:
    """The values in another form."""
    rows = min(form.get("rows", 64), len(values))
    chunks, shards = (rows, *values.shape[1:]), None
    if form.get("tiles"):
        across = -(-values.shape[1] // 8)
        chunks = (min(256, len(values)), across, *values.shape[2:])
        shards = (-(-len(values) // chunks[0]) * chunks[0], across * 8, *values.shape[2:])
    codecs: list[Any] = (
        [] if form.get("blosc", ZSTD) is None else [BloscCodec(**form.get("blosc", ZSTD))]
    )
    codecs += [Crc32cCodec()] if form.get("checksum", True) else []
    array = zarr.create_array(
        folder, shape=values.shape, dtype=values.dtype, chunks=chunks, shards=shards,
        compressors=codecs or None, fill_value=np.nan,
    )  # fmt: skip
    step = shards[0] if shards else rows
    for start in range(0, len(values), step):
        array[start : start + step] = values[start : start + step]
    return array


def measured(values: np.ndarray, form: dict[str, Any]) -> dict[str, float]:
    """Bytes, files, and seconds for writing all, reading a frame, and reading a point's course."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "array"
        began = time.perf_counter()
        written(values, folder, form)
        result = {"write": time.perf_counter() - began}
        array = zarr.open_array(folder, mode="r")
        for kind, index in (("frame", len(values) // 2), ("course", (slice(None), 7))):
            began = time.perf_counter()
            array[index]
            result[kind] = time.perf_counter() - began
        files = [path for path in folder.rglob("*") if path.is_file()]
        return result | {"bytes": sum(p.stat().st_size for p in files), "files": len(files)}


def study(name: str, store: LocalStore, settings: list[str]) -> dict[str, Any]:
    """All forms of one run, summed over its large arrays, and what rounding takes from each field."""
    outcomes = run(Request.read(name, None, settings).nodes(), store)
    refs = [outcome.manifest.ref for outcome in outcomes.values()]
    small = sum(outcome.manifest.size for outcome in outcomes.values())
    nothing = dict.fromkeys(("bytes", "files", "write", "frame", "course"), 0.0)
    total = {form: dict(nothing) for form in FORMS}
    fields = []
    for stage, field, array in arrays(store, refs):
        exact = np.asarray(array[...])
        small -= sum(p.stat().st_size for p in Path(str(array.store_path)[7:]).glob("c.*"))
        record = Path(str(array.store_path)[7:]).parent
        kept = NARROWED.get((zarr.open_group(record, mode="r").attrs["record"], field), "float64")
        rounded = exact.astype("float32")
        fields.append(
            {
                "stage": stage, "field": field, "stored": kept, "shape": list(exact.shape),
                "MB": exact.astype(kept).nbytes / 1e6,
                "largest": float(np.nanmax(np.abs(exact))),
                "float32 loses": float(np.nanmax(np.abs(exact - rounded))),
                "float64 MB": measured(exact, {})["bytes"] / 1e6,
                "float32 MB": measured(rounded, {})["bytes"] / 1e6,
            }
        )  # fmt: skip
        for form, options in FORMS.items():
            found = measured(exact.astype(options.get("dtype", kept)), options)
            for what, value in found.items():
                total[form][what] += value
    return {"small": small, "forms": total, "fields": fields}


def compared(name: str, store: LocalStore, settings: list[str], summary: Path) -> dict[str, float]:
    """Relative differences of a run's quantities from those of an ordinary run; equal ones left out."""
    request = Request.read(name, None, settings)
    found = request.workflow.quantities(experiment_of(request, run(request.nodes(), store)))
    kept = json.loads(summary.read_text())["quantities"]
    changes = {}
    for quantity, entry in found.items():
        one, other = (
            np.ravel(v).astype(float) for v in (entry.value or 0, kept[quantity]["value"] or 0)
        )
        change = float(np.max(np.abs(one - other) / np.maximum(np.abs(one), 1e-300), initial=0.0))
        changes |= {quantity: change} if change else {}
    return changes


def told(name: str, result: dict[str, Any]) -> None:
    """Tables for people."""
    print(
        f"\n{name}: all small arrays, tables and metadata together {result['small'] / 1e6:.2f} MB"
    )
    print(
        "| form | size [MB] | files | write [s] | frame [ms] | course [ms] |\n|---|---|---|---|---|---|"
    )
    for form, found in result["forms"].items():
        size = (found["bytes"] + result["small"]) / 1e6
        reading = f"{1e3 * found['frame']:.0f} | {1e3 * found['course']:.0f}"
        print(f"| {form} | {size:.1f} | {found['files']:.0f} | {found['write']:.2f} | {reading} |")
    print(
        "| stage | field | stored as | largest | float32 loses | float64 [MB] | float32 [MB] |\n|---|---|---|---|---|---|---|"
    )
    for one in result["fields"]:
        sizes = f"{one['float64 MB']:.1f} | {one['float32 MB']:.1f}"
        loss = f"{one['largest']:.3g} | {one['float32 loses']:.1g}"
        print(f"| {one['stage']} | {one['field']} | {one['stored']} | {loss} | {sizes} |")


def main() -> None:
    """Study all workflows."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("workflows", nargs="*", metavar="WORKFLOW")
    parser.add_argument("--set", action="append", default=[], metavar="SECTION.KEY=VALUE")
    parser.add_argument(
        "--store", type=Path, help="never one of real results: keys would be the same"
    )
    parser.add_argument("--out", type=Path, default=Path("results/benchmark"))
    parser.add_argument("--results", type=Path, help="folder of ordinary runs' output folders")
    options = parser.parse_args()
    own = Path(tempfile.mkdtemp()) if options.store is None else None
    results = {}
    for name in options.workflows or ["planar-waves", "spiral-wave"]:
        results[name] = study(name, LocalStore(own or options.store), options.set)
        told(name, results[name])
        if options.results is not None:
            kept = LocalStore(own or options.store)
            summary = options.results / name / "summary.json"
            changes = results[name]["quantities"] = compared(name, kept, options.set, summary)
            worst = max(changes, key=changes.__getitem__, default="-")
            print(f"{len(changes)} quantities differ, most {worst}: {changes.get(worst, 0.0):.1e}")
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "store_size.json").write_text(json.dumps(results, indent=2) + "\n")
    if own is not None:
        shutil.rmtree(own)


NARROWED = in_float64()

if __name__ == "__main__":
    main()
