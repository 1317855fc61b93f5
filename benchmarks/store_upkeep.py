"""Time that the commands about the store take on a large one, whole processes.

Ten thousand artefacts with manifests as real ones have, and a run that registered half a million. Print a
table: seconds, best of three.

    python benchmarks/store_upkeep.py [--artefacts 10000] [--registered 500000]
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from pipeline.canonical import Canonical
from pipeline.fingerprint import Fingerprint
from pipeline.keys import Ref, Statement
from pipeline.manifest import FileEntry, Manifest, content_ids, whole_content
from pipeline.store import LocalStore, RunLabel
from pipeline.store.local_upkeep import INDEX

MODULES = {f"stages.mechanics.module_{number}": f"{number:040x}" for number in range(60)}
"""As many as the mechanics has, whose manifests are the longest."""

FILES = tuple(FileEntry(f"record.zarr/{n}/c.0.0", 1_000_000, f"{n:064x}") for n in range(12))


def manifest(number: int) -> Manifest:
    """Manifest of a made-up artefact."""
    config: Canonical = {
        "gain": float(number),
        "material": {"name": "neo-hooke", "shear_modulus": 1.5},
    }
    statement = Statement("mechanics", config, Fingerprint(f"{0:040x}", MODULES), {})
    parts = content_ids(FILES)
    return Manifest(
        stage="mechanics",
        key=statement.key,
        config=statement.config,
        code=statement.code.digest,
        modules=MODULES,
        inputs={},
        files=FILES,
        parts=parts,
        content=whole_content(parts),
        seconds=1.5 + number,
        cpu_seconds=1.0,
        peak_memory=10**8,
        started="2024-01-01T00:00:00+00:00",
        finished="2024-01-01T00:00:01+00:00",
        environment={"versions": {"numpy": "2.4.6"}, "threads": dict.fromkeys("abcdef", "1")},
    )


def fill(store: LocalStore, artefacts: int, registered: int) -> None:
    """Make a store of artefacts without data, and a run that keeps some of them."""
    label = RunLabel("a large sweep", named=True)
    store.begin(label)
    for number in range(artefacts):
        made = manifest(number)
        folder = store.path / "objects" / made.stage / made.key
        folder.mkdir(parents=True)
        (folder / "manifest.json").write_bytes(made.to_json())
    (lines,) = (path.with_suffix(".host.1.refs") for path in store.path.rglob("runs/*/*.json"))
    lines.write_text("".join(f"{Ref('mechanics', f'{n:040x}')}\n" for n in range(registered)))
    store.finish(label)


def seconds(*command: str, store: LocalStore, times: int = 3) -> float:
    """Best time of some processes."""
    best = float("inf")
    for _ in range(times):
        began = time.perf_counter()
        subprocess.run(
            [sys.executable, "-m", "workflows.cli", *command],
            env=os.environ | {"MYOFILM_STORE": str(store.path)},
            stdout=subprocess.DEVNULL,
            check=True,
        )
        best = min(best, time.perf_counter() - began)
    return best


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--artefacts", type=int, default=10_000)
    parser.add_argument("--registered", type=int, default=500_000)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        store = LocalStore(Path(folder) / "store")
        fill(store, asked.artefacts, asked.registered)
        first = seconds("store", "ls", store=store, times=1)
        print(f"{'store ls, the first':32}{first:6.2f} s")
        print(f"{'--help':32}{seconds('store', '--help', store=store):6.2f} s")
        for command in (["ls"], ["ls", "--sort", "worth"], ["runs"], ["gc", "--unreachable"]):
            print(
                f"{'store ' + ' '.join(command):32}{seconds('store', *command, store=store):6.2f} s"
            )
        size = os.path.getsize(store.path / INDEX)
        print(f"{INDEX}: {size / asked.artefacts:.0f} bytes an artefact")


if __name__ == "__main__":
    main()
