"""One BLAS thread inside a stage, so that a result does not depend on the number of cores."""

from __future__ import annotations

import contextlib
import importlib
from collections.abc import Iterator

BLAS_USERS = ("numpy", "scipy.linalg")
"""Modules that bring a BLAS of their own; only libraries that are loaded can be limited."""


@contextlib.contextmanager
def one_blas_thread() -> Iterator[None]:
    """Linear algebra on one thread while inside.

    A BLAS with several threads splits its sums otherwise and gives other last bits. Cases of a sweep
    run side by side instead.
    """
    from threadpoolctl import threadpool_limits

    for module in BLAS_USERS:
        importlib.import_module(module)
    with threadpool_limits(limits=1, user_api="blas"):
        yield
