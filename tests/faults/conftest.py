"""Fixtures of the engine's tests serve here, too."""

from __future__ import annotations

from tests.pipeline.conftest import output, start, store

__all__ = ["output", "start", "store"]
