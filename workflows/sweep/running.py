"""A sweep under way: which cases still have to run, what became of each, and what is left at the end."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from types import TracebackType
from typing import Any

from pipeline.computing.obtaining import Policy
from pipeline.errors import InputError, MyofilmError, StoreError
from pipeline.executors import Executor
from pipeline.fingerprint import fingerprint
from pipeline.nodes import Node, in_order
from pipeline.store import Store
from pipeline.store.labels import RunLabel
from pipeline.sweep import Case, CaseDone, CaseFailed, CaseResult, sweep
from pipeline.task import Codes
from workflows.sweep.design import CaseSettings
from workflows.sweep.forecast import Forecast
from workflows.sweep.journal import Failure, Journal
from workflows.sweep.measuring import Measure
from workflows.sweep.outputs import write_case, write_results
from workflows.sweep.pace import Pace
from workflows.sweep.progress import Display, summary, watching_cases
from workflows.sweep.results import Results, Stage
from workflows.sweep.study import Study
from workflows.ways import USUAL, Way

LISTED = 20
"""Failed cases that the message at the end names."""


class FailedCasesError(MyofilmError):
    """Cases of a sweep failed; the others are done."""

    def __init__(self, results: Results, earlier: int, folder: Path) -> None:
        design = results.study.design
        failed = sorted(results.errors)
        before = f", {earlier} of them before and not tried again" if earlier else ""
        lines = [f"{len(failed)} of {len(design)} cases failed{before}:"]
        for number in failed[:LISTED]:
            error = results.errors[number].replace("\n", "\n  ")
            lines.append(f"{design[number]}:\n  {error}")
        if len(failed) > LISTED:
            lines.append(f"and {len(failed) - LISTED} more, all listed in {folder / 'cases.csv'}")
        lines.append("Remedy: the same command with --retry-failed tries them again")
        super().__init__("\n".join(lines))


class Sweep:
    """The cases of a study, run once.

    Parameters
    ----------
    study
        What is to be run.
    store
        Where results are kept.
    folder
        Output folder, with the journal of earlier calls.
    label
        Under which the sweep registers what it uses.
    way
        How the command goes about its work.
    retry_failed
        Whether cases are tried again that failed before.
    each
        Whether every case gets its own report, pictures and data.

    Attributes
    ----------
    earlier
        Cases that failed in an earlier call and are not tried again.
    """

    def __init__(
        self,
        study: Study,
        store: Store,
        folder: Path,
        label: RunLabel,
        way: Way = USUAL,
        *,
        retry_failed: bool = False,
        each: bool = False,
    ) -> None:
        self._study, self._store, self._folder, self._label = study, store, folder, label
        self._way, self._retry, self._each = way, retry_failed, each
        self._journal = Journal(folder)
        self._codes = Codes()
        self._results = Results(study)
        self.earlier = 0

    def __enter__(self) -> Sweep:
        self._journal.began(" ".join(sys.argv), len(self._study.design))
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._journal.close()

    def run(self, forecast: Forecast, executor: Executor | None = None) -> Results:
        """Run what is left to run, and write tables, figure, report and summary.

        When it is stopped, these show the cases that were done by then.

        Raises
        ------
        InputError
            If the store may not be written to.
        Stopped
            If a signal asked to stop.
        """
        pace = Pace(self._study.design.numbers, forecast)
        try:
            with watching_cases(pace, quiet=self._way.quiet, verbose=self._way.verbose) as display:
                for result in sweep(
                    self._cases(display),
                    self._store,
                    executor,
                    finish=Measure(self._study.workflow.name, self._study.common),
                    listen=display,
                    policy=Policy(
                        label=self._label,
                        recompute_damaged=self._way.recompute_damaged,
                        accept_code=self._way.accept_code,
                    ),
                ):
                    self._note(result, display)
        except KeyboardInterrupt:
            self._write("stopped", pace)
            if not self._way.quiet:
                print(f"\n{summary(pace)} are done; tables, figure and report show these")
            raise
        self._write("ended", pace)
        return self._results

    def _write(self, how: str, pace: Pace) -> None:
        self._results.stages = {
            name: Stage(len(stage.computed), len(stage.there) - len(stage.computed), stage.seconds)
            for name, stage in pace.stages.items()
            if stage.there
        }
        write_results(self._results, self._folder)
        counts = {"done": len(self._results.quantities), "failed": len(self._results.errors)}
        self._journal.ended(how, counts)

    def _cases(self, display: Display) -> Iterator[Case]:
        """Cases to run; those that failed before, and would again, are noted instead."""
        for number, case in enumerate(self._study.design):
            nodes = self._study.nodes(case)
            failure = self._journal.failures.get(self._study.id_of(case))
            known = failure is not None and failure.code == self._code(failure.stage, nodes)
            if failure is not None and known and not self._retry:
                self._results.errors[number] = failure.error
                display.case_done(case.name, failure.error, earlier=True)
                self.earlier += 1
                continue
            yield Case(case.name, nodes, case)

    def _note(self, result: CaseResult, display: Display) -> None:
        number = self._study.design.numbers[result.name]
        case = self._study.design[number]
        if isinstance(result, CaseDone):
            error = None
            self._results.quantities[number] = result.value.quantities()
            if result.value.warnings:
                self._results.warnings[number] = result.value.warnings
            self._journal.done(case.name, self._study.id_of(case))
            if self._each:
                error = self._write_case(case, result)
        else:
            error = self._failed(case, result)
        if error is not None:
            self._results.errors[number] = error
        display.case_done(case.name, error)

    def _failed(self, case: CaseSettings, result: CaseFailed) -> str:
        if isinstance(result.error, InputError):
            raise result.error  # of the store, not of this case
        error = _message(result.error)
        if isinstance(result.error, StoreError):
            return (
                error  # nor is this one: the next call, on a disk with room, tries the case again
            )
        code = self._code(result.stage, self._study.nodes(case))
        failure = Failure(case.name, self._study.id_of(case), result.stage, error, code)
        self._journal.failed(failure)
        return error

    def _write_case(self, case: CaseSettings, result: CaseDone) -> str | None:
        """Files of a case; an error of theirs is one of this case only."""
        try:
            write_case(self._study.request(case), result.outcomes, self._folder, case.name)
        except MyofilmError as error:
            return _message(error)
        return None

    def _code(self, stage: str, nodes: Mapping[str, Node[Any]]) -> str:
        """Digest of the code that computes a stage, or without one of that which reads the numbers."""
        for _, node in in_order(nodes):
            if node.stage.name == stage:
                return self._codes.of(node).digest
        return self._reading

    @cached_property
    def _reading(self) -> str:
        """Digest of the code that reads the numbers: thousands of cases may have failed in it."""
        return fingerprint(self._study.workflow.modules, ("workflows", "stages")).digest


def _message(error: Exception) -> str:
    return str(error) if isinstance(error, MyofilmError) else f"{type(error).__name__}: {error}"
