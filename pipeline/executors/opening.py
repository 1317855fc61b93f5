"""The executor that a user asks for."""

from __future__ import annotations

import contextlib
import json
import logging
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pipeline.errors import InputError, MyofilmError
from pipeline.executors.protocol import Executor
from pipeline.executors.serial import SerialExecutor
from pipeline.store import Store
from pipeline.store.labels import RunLabel

if TYPE_CHECKING:
    from distributed import Client

CONNECT = 5.0
"""Seconds in which a scheduler must answer."""

THREADS = dict.fromkeys(
    (
        "OMP_NUM_THREADS",
        "OPENBLAS_NUM_THREADS",
        "MKL_NUM_THREADS",
        "NUMBA_NUM_THREADS",
        "VECLIB_MAXIMUM_THREADS",
    ),
    "1",
)
"""Environment of local workers: each has one core."""

LOCAL = {
    "distributed.scheduler.allowed-failures": 2,
    "distributed.scheduler.worker-ttl": None,  # the kernel tells of the death of a local process
    "distributed.worker.profile.enabled": False,
    "distributed.admin.system-monitor.gil.enabled": False,
}


@contextlib.contextmanager
def opened(
    workers: int | None,
    cluster: str | None,
    store: Store,
    label: RunLabel,
    warn: Callable[[str], None] = lambda line: None,
) -> Iterator[Executor]:
    """Executor in this process, on local worker processes, or on those of a running scheduler.

    Parameters
    ----------
    workers
        Local processes; ``None`` or 1 for this process alone.
    cluster
        Address of a dask.distributed scheduler, for instance ``tcp://10.0.0.1:8786``, or the file in
        which it tells its address.
    store, label
        What the workers of a scheduler must see: the store, and in it the run.
    warn
        Receives lines about what a user should know.

    Raises
    ------
    InputError
        If both are asked for, the scheduler does not answer, or one of its workers cannot be used.
    """
    if cluster is not None and workers is not None:
        raise InputError(
            "--workers and --cluster contradict each other; the workers of a cluster are those that it has"
        )
    if workers is not None and workers < 1:
        raise InputError(f"--workers must be at least 1, got {workers}")
    executor: Executor
    if cluster is not None:
        executor = _on_cluster(cluster, store, label, warn)
    elif workers is not None and workers > 1:
        if workers > (cores := _cores()):
            warn(f"{workers} of them share {cores} cores, and are no faster than {cores}")
        executor = _on_local_workers(workers, warn)
    else:
        executor = SerialExecutor()
    with contextlib.closing(executor):
        yield executor


def _on_cluster(
    address: str, store: Store, label: RunLabel, warn: Callable[[str], None]
) -> Executor:
    from pipeline.executors.agreement import Agreement
    from pipeline.executors.connection import connected
    from pipeline.executors.dask import DaskExecutor

    _silence()
    where = _address(address)  # before anything is written
    agreement = Agreement.here(store, label)

    def connect() -> Client:
        try:
            return connected(_address(address), CONNECT)
        except InputError as error:  # a scheduler that starts again has not written its file yet
            raise OSError(str(error)) from error

    try:
        return DaskExecutor(connect, agreement, warn=warn)
    except MyofilmError:
        raise
    except Exception as error:  # whatever listens there may answer anything
        raise InputError(
            f"no dask scheduler answers at {where!r} ({_cause(error)}); give the address that "
            "`dask scheduler` tells, such as tcp://10.0.0.1:8786, or its --scheduler-file"
        ) from error


def _address(cluster: str) -> str:
    """The address, read from a scheduler file if that is given.

    Raises
    ------
    InputError
        If it is neither, or a TLS address without certificates.
    """
    if "://" in cluster or not (cluster.endswith(".json") or os.path.sep in cluster):
        address = cluster
    else:
        try:
            address = str(json.loads(Path(cluster).read_bytes())["address"])
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise InputError(
                f"--cluster {cluster} is no scheduler file ({_cause(error)}); give the file that `dask "
                "scheduler --scheduler-file` writes, or an address such as tcp://10.0.0.1:8786"
            ) from error
    import dask.config

    if address.startswith("tls://") and not dask.config.get("distributed.comm.tls.ca-file", None):
        raise InputError(
            f"the scheduler at {address} wants TLS, and no certificates are configured; set "
            "DASK_DISTRIBUTED__COMM__TLS__CA_FILE, ..__CLIENT__CERT and ..__CLIENT__KEY "
            "(docs/cluster.md)"
        )
    return address


def _on_local_workers(workers: int, warn: Callable[[str], None]) -> Executor:
    import dask.config
    from distributed import Client, LocalCluster

    from pipeline.executors.dask import DaskExecutor

    _silence()
    with dask.config.set(LOCAL):
        cluster: Any = LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
            memory_limit=0,  # they hold no results; what a stage needs it needs
            silence_logs=logging.CRITICAL,
            env=THREADS,
            preload="pipeline.executors.preload",
        )
    return DaskExecutor(
        lambda: Client(cluster, set_as_default=False),
        warn=warn,
        on_close=lambda: cluster.close(timeout=5),
    )


def _cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _silence() -> None:
    """What matters of what distributed logs, such as lost connections, is told in our own words."""
    import distributed  # noqa: F401 - it sets the levels of its loggers

    for name in ("distributed", *logging.root.manager.loggerDict):
        if name.partition(".")[0] == "distributed":
            logging.getLogger(name).setLevel(logging.CRITICAL)


def _cause(error: Exception) -> str:
    told = str(error).partition("\n")[0]
    return told or (
        f"nothing comes in {CONNECT:g} s" if isinstance(error, TimeoutError) else repr(error)
    )
