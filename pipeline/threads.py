"""One BLAS thread inside a stage, so that a result does not depend on the number of cores."""

from __future__ import annotations

import contextlib
import importlib
import sys
from collections.abc import Iterator
from functools import lru_cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

BLAS_USERS = ("numpy", "scipy.linalg")
"""Modules that bring a BLAS of their own; only libraries that are loaded can be limited."""


@contextlib.contextmanager
def one_blas_thread() -> Iterator[None]:
    """Linear algebra on one thread while inside.

    A BLAS with several threads splits its sums otherwise and gives other last bits. Cases of a sweep
    run side by side instead.
    """
    for module in BLAS_USERS:
        importlib.import_module(module)
    with _controller(len(sys.modules)).limit(limits=1, user_api="blas"):
        yield


@lru_cache(maxsize=1)
def _controller(modules: int) -> ThreadpoolController:
    """The loaded libraries; looking for them takes milliseconds, and only a new module brings more."""
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
