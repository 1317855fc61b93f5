"""The three ways in which a run can fail, each with the exit code of the command line.

An error gives the fact with its numbers, the place, and the remedy.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any


class MyofilmError(Exception):
    """Anything the user should read as one message, without a traceback.

    Attributes
    ----------
    exit_code
        Exit code of the command that ends with this error.
    """

    exit_code = 1

    def __reduce__(self) -> tuple[Any, ...]:
        """All of it reaches another process: class, message, and what the subclass keeps."""
        return _rebuilt, (type(self), self.args), self.__dict__


def _rebuilt(cls: type[MyofilmError], args: tuple[Any, ...]) -> MyofilmError:
    error = cls.__new__(cls)
    error.args = args
    return error


class InputError(MyofilmError):
    """The request itself is wrong: a parameter, a file, a path. Nothing was computed."""

    exit_code = 2


class StageError(MyofilmError):
    """A stage could not finish.

    Parameters
    ----------
    stage
        Name of the stage.
    cause
        What went wrong, with its numbers.
    place
        Where in the computation, for instance ``"t = 12.5 ms"``; empty when unknown.
    after
        What was finished before, for instance ``"4 of 8 steps"``; told where no place is known.
    remedy
        What the user can try; empty when unknown.
    kept
        Folder in which the results up to the failure are kept.

    Examples
    --------
    >>> print(StageError("mechanics", "no convergence", place="t = 5 ms", remedy="halve the step"))
    stage mechanics failed at t = 5 ms: no convergence
    Remedy: halve the step
    """

    def __init__(
        self,
        stage: str,
        cause: str,
        *,
        place: str = "",
        after: str = "",
        remedy: str = "",
        kept: Path | None = None,
    ) -> None:
        self.stage = stage
        self.cause = cause
        self.place = place
        self.after = after
        self.remedy = remedy
        self.kept = kept
        where = f" at {place}" if place else f" after {after}" if after else ""
        lines = [f"stage {stage} failed{where}: {cause}"]
        if kept is not None:
            lines.append(f"What was computed until then is kept in {kept}")
        if remedy:
            lines.append(f"Remedy: {remedy}")
        super().__init__("\n".join(lines))


class StoreError(MyofilmError):
    """The store cannot be read or written.

    Parameters
    ----------
    cause
        What went wrong.
    path
        File or folder concerned, or the URL of an object.
    remedy
        What the user can do about it.
    """

    def __init__(self, cause: str, *, path: Path | str | None = None, remedy: str = "") -> None:
        self.cause = cause
        self.path = path
        self.remedy = remedy
        lines = [cause if path is None else f"{cause}: {path}"]
        if remedy:
            lines.append(f"Remedy: {remedy}")
        super().__init__("\n".join(lines))
