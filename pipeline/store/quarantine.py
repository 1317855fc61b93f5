"""Damaged artefacts, set aside with a report: evidence for their owner, out of the way of the next run."""

from __future__ import annotations

import datetime
import json
import os
import platform
import sys
from collections.abc import Iterable
from pathlib import Path

from pipeline.durable import sync, write_atomically
from pipeline.keys import Ref


def move_aside(folder: Path, quarantine: Path, ref: Ref, problems: Iterable[str]) -> Path:
    """Move what is kept under a key to ``quarantine/<stage>/<key>.<time>``; the report lies beside it.

    The caller holds the lock of the key. The report is written first: after a crash there may be a
    report of an artefact that is still in place, never an artefact set aside without its reason.

    Raises
    ------
    OSError
        If the disk does not let it be moved.
    """
    now = datetime.datetime.now(datetime.UTC)
    place = quarantine / ref.stage / f"{ref.key}.{now:%Y%m%dT%H%M%S.%fZ}"
    report = {
        "artefact": str(ref),
        "found": now.isoformat(timespec="milliseconds"),
        "problems": list(problems),
        "host": platform.node(),
        "command": sys.argv,
    }
    text = json.dumps(report, indent=1, ensure_ascii=False)
    write_atomically(place.with_name(f"{place.name}.json"), text.encode())
    os.rename(folder, place)
    sync(place.parent)
    sync(folder.parent)
    return place
