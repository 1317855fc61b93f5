"""Linear algebra runs on one thread inside a stage, and on as many as before after it."""

from __future__ import annotations

from pathlib import Path

import threadpoolctl

from pipeline.nodes import stage
from pipeline.runner import run
from pipeline.store import LocalStore
from pipeline.threads import one_blas_thread
from tests.pipeline.toy import Label, MeshConfig

SEEN: list[int] = []


def blas_threads() -> list[int]:
    return [
        lib["num_threads"] for lib in threadpoolctl.threadpool_info() if lib["user_api"] == "blas"
    ]


@stage
def counting(config: MeshConfig) -> Label:
    SEEN.extend(blas_threads())
    return Label("counted")


def test_a_stage_sees_one_thread(tmp_path: Path) -> None:
    before = blas_threads()
    run({"counting": counting(MeshConfig())}, LocalStore(tmp_path))
    assert SEEN
    assert set(SEEN) == {1}
    assert blas_threads()[: len(before)] == before


def test_the_limit_ends_with_the_block() -> None:
    with one_blas_thread():
        assert set(blas_threads()) == {1}
