"""What every executor must do, as tests: one of its own inherits :class:`ExecutorConformance`."""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable, Iterator
from typing import Any

import pytest

from pipeline.errors import StageError
from pipeline.executors import Completion, Executor
from pipeline.running.interrupts import Stopped


def doubled(number: int, *, tell: Callable[[str], None]) -> int:
    """A job with a value, and something to tell."""
    tell(f"doubling {number}")
    return 2 * number


def failing(cause: str, *, tell: Callable[[str], None]) -> None:
    """A job that ends with an error."""
    raise StageError("toy", cause, remedy="take another one")


def slow(seconds: float, *, tell: Callable[[str], None]) -> None:
    """A job that takes a while."""
    time.sleep(seconds)


class ExecutorConformance:
    """Inherit, give a fixture ``executor``, and every behaviour that the engine needs is tested."""

    @pytest.fixture
    def executor(self) -> Iterator[Executor]:
        """An executor without jobs."""
        raise TypeError("a test class for an executor defines the fixture 'executor'")

    def ended(self, executor: Executor, count: int, heard: list[Any]) -> list[Completion]:
        """The next jobs that end; what they tell is noted with their tag."""
        found: list[Completion] = []
        while len(found) < count:
            completion = executor.next(lambda tag, told: heard.append((tag, told)), 60.0)
            assert completion is not None, "a job neither ended nor was given up"
            found.append(completion)
        return found

    def test_there_is_always_a_job_worth_submitting(self, executor: Executor) -> None:
        assert executor.slots >= 1

    def test_every_job_is_handed_out_once_with_its_tag_and_value(self, executor: Executor) -> None:
        for number in range(5):
            executor.submit(("job", number), doubled, number)
        values: dict[Hashable, Any] = {each.tag: each.value for each in self.ended(executor, 5, [])}
        assert values == {("job", number): 2 * number for number in range(5)}

    def test_without_jobs_nobody_waits(self, executor: Executor) -> None:
        executor.submit(1, doubled, 1)
        self.ended(executor, 1, [])
        assert executor.next(lambda tag, told: None) is None

    def test_what_a_job_tells_is_heard_before_it_is_handed_out(self, executor: Executor) -> None:
        heard: list[Any] = []
        executor.submit("a", doubled, 4)
        self.ended(executor, 1, heard)
        assert heard == [("a", "doubling 4")]

    def test_an_error_is_handed_out_and_harms_no_other_job(self, executor: Executor) -> None:
        executor.submit("bad", failing, "it does not converge")
        executor.submit("good", doubled, 1)
        found = {each.tag: each for each in self.ended(executor, 2, [])}
        error = found["bad"].error
        assert isinstance(error, StageError)
        assert str(error) == str(
            StageError("toy", "it does not converge", remedy="take another one")
        )
        assert (found["good"].value, found["good"].error) == (2, None)

    def test_after_a_stop_all_jobs_end_and_those_that_waited_do_not_begin(
        self, executor: Executor
    ) -> None:
        for number in range(20):
            executor.submit(number, slow, 0.2)
        executor.stop()
        found = self.ended(executor, 20, [])
        assert {each.tag for each in found} == set(range(20))
        stopped = [isinstance(each.error, Stopped) for each in found]
        assert any(stopped)
        assert all(was or each.error is None for was, each in zip(stopped, found, strict=True))
