"""Computing one artefact, under the lock of its key."""

from __future__ import annotations

import contextlib
import datetime
import resource
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pipeline.codecs import save
from pipeline.computing.loading import load_result
from pipeline.durable import remove_tree, storing
from pipeline.errors import MyofilmError, StageError, StoreError
from pipeline.events import Listener, StageFailed, StageFinished, StageStarted, StageStopping
from pipeline.fingerprint.freshness import check_loaded
from pipeline.fingerprint.sources import locate
from pipeline.keys import Ref, Statement
from pipeline.manifest import Manifest, content_ids, hash_files, whole_content
from pipeline.provenance import environment
from pipeline.records import WHOLE
from pipeline.running.interrupts import deferred_interrupts
from pipeline.running.storerun import StoreRun
from pipeline.store import Store, Workspace
from pipeline.task import Task
from pipeline.threads import one_blas_thread
from pipeline.verification import telling_damage


def execute(
    task: Task,
    store: Store,
    work: Workspace,
    listen: Listener,
    checkpoint_interval: float,
    waited_seconds: float = 0.0,
) -> Manifest:
    """Compute, write and publish an artefact, under a lock that was waited for.

    Raises
    ------
    StageError
        If the stage raises, or its code in memory is not the code that its key states.
    StoreError
        If an input cannot be read or the result cannot be written.
    Stopped
        After publishing, if a signal to stop came after the last checkpoint.
    """
    stage, key, stated = task.stage, task.key, task.statement()
    code = stated.code
    check_loaded(stage.name, code)
    started = _now()
    try:
        run = StoreRun(
            task.name,
            stage.name,
            key,
            code,
            stage.signature.record,
            work,
            listen,
            checkpoint_interval,
        )
        resumed = run.resumed_frames
        listen(StageStarted(task.name, stage.name, key, resumed, task.expected_seconds))
        inputs = {role: _load(task, role, store) for role in task.inputs}
        _compute(task, inputs, run, store)
        check_loaded(stage.name, code)  # again: modules may have been loaded on the way
        manifest = work.publish(_manifest(task, stated, run, started, waited_seconds))
    except BaseException as error:
        if not work.checkpoint.exists() and getattr(error, "kept", None) is None:
            with contextlib.suppress(OSError):  # the first error is the one to tell
                remove_tree(work.folder)
        raise
    run.emit(StageFinished(task.name, stage.name, key, manifest.seconds, manifest.size))
    run.interrupts.check()
    return manifest


def _manifest(
    task: Task, stated: Statement, run: StoreRun, started: str, waited_seconds: float
) -> Manifest:
    with storing(run.work.data):
        files = hash_files(run.work.data)
    parts = content_ids(files)
    circumstances = {"argv": list(task.argv), "lock_wait_seconds": waited_seconds}
    return Manifest(
        stage=stated.stage,
        key=task.key,
        config=stated.config,
        code=stated.code.digest,
        modules=stated.code.modules,
        inputs=task.inputs,
        files=files,
        parts=parts,
        content=whole_content(parts),
        seconds=run.seconds,
        cpu_seconds=run.cpu_seconds,
        peak_memory=_peak_memory(),
        started=started,
        finished=_now(),
        environment=environment(locate(task.stage.module)) | circumstances,
        warnings=tuple(run.warnings),
        notes=run.notes,
    )


def _load(task: Task, role: str, store: Store) -> Any:
    entry = task.inputs[role]
    return load_result(store, Ref(entry.stage, entry.key), task.records[role], entry.part)


def _compute(task: Task, inputs: Mapping[str, Any], run: StoreRun, store: Store) -> None:
    """Run the stage and write what it returns."""
    stage, declared = task.stage, task.stage.signature.record
    stopping = StageStopping(task.name, stage.name)
    try:
        with (
            deferred_interrupts(lambda: run.emit(stopping)) as run.interrupts,
            one_blas_thread(),
            telling_damage(store, (Ref(e.stage, e.key) for e in task.inputs.values())),
        ):
            record = stage.compute(task.config, run=run, **inputs)
        if type(record) is not declared:
            raise TypeError(f"it returned a {type(record).__name__}, not a {declared.__name__}")
        with storing(run.work.data):
            save(run.work.data, record, written=_streamed(record, run))
    except MyofilmError:
        raise
    except Exception as error:
        failure = _failure(stage.name, error, run)
        run.emit(StageFailed(task.name, stage.name, failure.cause))
        raise failure from error


def _failure(stage: str, error: Exception, run: StoreRun) -> StageError:
    cause = str(error).strip() or type(error).__name__
    if isinstance(error, TypeError | AttributeError | LookupError | AssertionError | NameError):
        cause = f"{type(error).__name__}: {cause}"  # not written for users: the type helps
    return StageError(
        stage,
        cause,
        place=getattr(error, "place", "") or "",
        after="" if run.step is None else f"{run.step[0]} of {run.step[1]} steps",
        remedy=getattr(error, "remedy", "") or "",
        kept=_kept(run),
    )


def _kept(run: StoreRun) -> Path | None:
    """Folder of the work, if histories were streamed into it."""
    frames = [history for history in run.histories.values() if history.frames_done]
    for history in frames:
        with contextlib.suppress(StoreError):  # the stage's own failure is the one to tell
            history.flush()
    return run.work.folder if frames else None


def _streamed(record: Any, run: StoreRun) -> set[str]:
    """Parts that were streamed; the record must hold the finished histories themselves."""
    for part, history in run.histories.items():
        value = record if part == WHOLE else getattr(record, part)
        if history.record is None or value is not history.record:
            raise TypeError(f"its {type(value).__name__} is not what history.finish(...) gave")
    return set(run.histories)


def _now() -> str:
    return datetime.datetime.now(datetime.UTC).isoformat(timespec="milliseconds")


def _peak_memory() -> int:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else peak * 1024
