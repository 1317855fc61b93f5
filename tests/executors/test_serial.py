"""Jobs in this process."""

from __future__ import annotations

import pytest

from pipeline.executors import Executor, SerialExecutor
from pipeline.testing.executors import ExecutorConformance


class TestSerialExecutor(ExecutorConformance):
    @pytest.fixture
    def executor(self) -> Executor:
        return SerialExecutor()
