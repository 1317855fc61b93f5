"""Processes that run a workflow and may be killed: forked, so that each is there at once.

The parent compiles the kernels by running each workflow once; a child then needs milliseconds to begin.
What a child does to the store is what any process does.
"""

from __future__ import annotations

import json
import mmap
import os
import signal
import time
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

from pipeline.events import Event, StageFinished, StageHit, StageStarted, StageWarned
from pipeline.nodes import Node
from pipeline.runner import Outcome, run
from pipeline.store import LocalStore
from tests.faults.operations import Fault, Operation, Watch

Look: TypeAlias = Callable[["Outcome"], None]


@dataclass
class Ending:
    """How a child ended.

    Attributes
    ----------
    killed
        Whether it was; otherwise it finished, or failed with ``error``.
    place
        The last operation on the store that it began, in words, and how many there were.
    seconds
        From the beginning to the end.
    resumed
        Frames of the checkpoint that each stage went on from, by stage.
    computed, hits
        Stages that finished, or were there; ``keys`` are those of what it computed.
    warnings
        All that it warned of.
    """

    killed: bool
    place: str = ""
    operations: int = 0
    seconds: float = 0.0
    error: str = ""
    resumed: dict[str, int] = field(default_factory=dict)
    computed: list[str] = field(default_factory=list)
    keys: list[str] = field(default_factory=list)
    hits: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)


class Victim:
    """A child that runs nodes in a store.

    Parameters
    ----------
    nodes, store
        What it runs, and where.
    interval
        Seconds between two checkpoints.
    fault
        What happens at its operations on the store.
    trace
        File to which it writes every operation, if wanted.
    look
        What it does with each result afterwards, in the same process.
    """

    def __init__(
        self,
        nodes: Mapping[str, Node[Any]],
        store: Path,
        interval: float,
        fault: Fault | None = None,
        trace: Path | None = None,
        look: Look | None = None,
    ) -> None:
        self._shared = mmap.mmap(-1, 1 << 16)  # what the child tells, readable after its death
        self._began = time.perf_counter()
        self.pid = os.fork()
        if self.pid == 0:
            code = 1
            try:
                _Child(self._shared, fault, trace, look).run(nodes, store, interval)
                code = 0
            except BaseException:
                self._shared[32768:] = traceback.format_exc()[-30000:].encode().ljust(32768, b"\0")
            finally:
                os._exit(code)

    @property
    def told(self) -> dict[str, Any]:
        """What the child told last."""
        text = self._shared[:32768].rstrip(b"\0")
        try:
            return dict(json.loads(text)) if text else {}
        except ValueError:
            return {}  # it is being written

    @property
    def ended(self) -> bool:
        """Whether it ended, by itself or not."""
        return os.waitid(os.P_PID, self.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None

    def kill(self) -> None:
        """Kill it; one that ended before is not waited for yet, so that its number is not another's."""
        os.kill(self.pid, signal.SIGKILL)

    def kill_in(self, stage: str, after: float, patience: float = 60.0) -> None:
        """Kill it some seconds after a stage began, or let it end before."""
        deadline = time.perf_counter() + patience
        while stage not in self.told.get("begun", ()) and not self.ended:
            assert time.perf_counter() < deadline, f"stage {stage} never began"
            time.sleep(0.0005)
        time.sleep(after)
        self.kill()

    def wait(self) -> Ending:
        """How it ended."""
        _, status = os.waitpid(self.pid, 0)
        told, error = self.told, self._shared[32768:].rstrip(b"\0").decode()
        self._shared.close()
        return Ending(
            killed=os.WIFSIGNALED(status),
            place=told.get("place", ""),
            operations=told.get("operations", 0),
            seconds=time.perf_counter() - self._began,
            error=error,
            resumed=told.get("resumed", {}),
            computed=told.get("computed", []),
            keys=told.get("keys", []),
            hits=told.get("hits", []),
            warnings=told.get("warnings", []),
        )


class _Child:
    def __init__(
        self, shared: mmap.mmap, fault: Fault | None, trace: Path | None, look: Look | None
    ) -> None:
        self._shared, self._fault, self._look = shared, fault, look
        self._trace = None if trace is None else open(trace, "w")  # noqa: SIM115 - until the end
        self._told: dict[str, Any] = {
            "begun": [],
            "resumed": {},
            "computed": [],
            "keys": [],
            "hits": [],
            "warnings": [],
            "place": "",
            "operations": 0,
        }

    def run(self, nodes: Mapping[str, Node[Any]], store: Path, interval: float) -> None:
        self._watch = Watch(store, self._at)
        kept = LocalStore(store)
        outcomes = run(nodes, kept, listen=self._listen, checkpoint_interval=interval)
        for outcome in outcomes.values() if self._look is not None else ():
            self._look(outcome)
        if self._trace is not None:
            self._trace.close()

    def _at(self, watch: Watch, now: Operation) -> None:
        self._told["place"], self._told["operations"] = str(now), self._told["operations"] + 1
        if self._trace is not None:
            self._trace.write(f"{now.stage}\t{now.what}\t{now.verb}\t{now.count}\n")
        if self._fault is not None:
            self._tell()
            self._fault(watch, now)

    def _listen(self, event: Event) -> None:
        if isinstance(event, StageStarted):
            self._watch.stage = event.stage
            self._told["begun"].append(event.stage)
            if event.resumed_frames is not None:
                self._told["resumed"][event.stage] = event.resumed_frames
        elif isinstance(event, StageFinished):
            self._told["computed"].append(event.stage)
            self._told["keys"].append(event.key)
        elif isinstance(event, StageHit):
            self._told["hits"].append(event.stage)
        elif isinstance(event, StageWarned):
            self._told["warnings"].append(event.message)
        self._tell()

    def _tell(self) -> None:
        self._shared[:32768] = json.dumps(self._told).encode().ljust(32768, b"\0")
