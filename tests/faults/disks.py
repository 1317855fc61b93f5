"""Study: let the disk fail at every single operation of a run, and look at what is left.

    python -m tests.faults.disks FOLDER [EVERY]

Each child runs the toy stages and meets the error at another operation on the files of its store; from
then on nothing new can be made there. It prints one JSON object a trial: the operation, the error's
text, and what is left behind. ``EVERY`` leaves out all operations but every n-th one.
"""

from __future__ import annotations

import errno
import json
import sys
from pathlib import Path
from typing import Any

from pipeline.manifest import hash_files
from pipeline.nodes import Node
from pipeline.runner import run
from pipeline.store import LocalStore
from tests.faults.operations import Operation, fail_from
from tests.faults.victims import Victim
from tests.pipeline import toy

CODES = (errno.ENOSPC, errno.EDQUOT, errno.EACCES, errno.EROFS, errno.EIO)


def plan() -> dict[str, Node[Any]]:
    """Tables and a history of 70 frames: a whole chunk and some."""
    film = toy.mesh(toy.MeshConfig())
    history = toy.wave(toy.WaveConfig(frames=70), surface=film.part("surface"))
    return {"wave": history, "peak": toy.peak(toy.MeshConfig(), history=history)}


def contents(store: Path) -> dict[str, Any]:
    """Files of all artefacts, with their checksums; all of them are whole."""
    kept = LocalStore(store)
    refs = list(kept.refs())
    for ref in refs:
        assert kept.verify(ref, full=True) == (), ref
    return {str(ref): hash_files(kept.data(ref)) for ref in refs}


def operations(folder: Path) -> list[Operation]:
    """What an undisturbed run does, checkpoints at every 35th frame or so left to chance."""
    trace = folder / "trace"
    ending = Victim(plan(), folder / "unbroken", NEVER_SAVED, trace=trace).wait()
    assert not ending.error, ending.error
    rows = [line.split("\t") for line in trace.read_text().splitlines()]
    return [Operation(stage, what, verb, int(count)) for stage, what, verb, count in rows]


NEVER_SAVED = 1e9
"""Seconds between checkpoints: without one, all that is temporary must be gone after a failure."""


def main() -> None:
    """One trial for each operation, with one error number after the other."""
    folder = Path(sys.argv[1])
    every = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    run(plan(), LocalStore(folder / "first"))  # so that the children find all modules loaded
    found = operations(folder)[::every]
    unbroken = contents(folder / "unbroken")
    for number, operation in enumerate(found):
        store = folder / str(number)
        code = CODES[number % len(CODES)]
        failed = Victim(plan(), store, NEVER_SAVED, fail_from(operation, code)).wait()
        kept = contents(store) if store.exists() else {}
        left = [str(path) for path in (store / "tmp").glob("*")]
        again = Victim(plan(), store, NEVER_SAVED).wait()
        report = {
            "operation": str(operation),
            "code": errno.errorcode[code],
            "error": failed.error,
            "killed": failed.killed,
            "kept_are_whole": all(unbroken.get(ref) == files for ref, files in kept.items()),
            "left": left,
            "completed": not again.error and contents(store) == unbroken,
            "again": again.error,
        }
        print(json.dumps(report))


if __name__ == "__main__":
    main()
