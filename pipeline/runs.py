"""What a running stage may ask of the engine; the store and the tests each implement it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

R = TypeVar("R")
R_co = TypeVar("R_co", covariant=True)

FRAMES_PER_CHUNK = 64
"""Frames of a field written together: measured as a good size for reading slices and series alike."""


class History(Protocol[R_co]):
    """A record written frame by frame, so that memory does not grow with its length."""

    @property
    def frames_done(self) -> int:
        """Number of frames appended so far, those of a resumed run included."""
        ...

    def append(self, **fields: ArrayLike) -> None:
        """Add one frame of every streamed field.

        Raises
        ------
        ValueError
            If the fields or their shapes are not those announced, or all frames are there already.
        """
        ...

    def finish(self, **fields: Any) -> R_co:
        """The record, from the streamed frames and the remaining fields.

        Raises
        ------
        ValueError
            If frames are missing.
        """
        ...


class StageRun(Protocol):
    """The engine's side of one running stage."""

    def stream(
        self,
        record: type[R],
        *,
        frames: int,
        shapes: Mapping[str, tuple[int, ...]],
        fewer: bool = False,
    ) -> History[R]:
        """Begin a history of a record, or continue the one of an interrupted run.

        Parameters
        ----------
        record
            Record class, kept as zarr.
        frames
            Number of frames of the whole history.
        shapes
            Shape of one frame of each streamed field; the field's first axis is ``"time"``.
        fewer
            Whether the history may end with fewer frames, since nobody knows before how many it takes.
        """
        ...

    def resume(self) -> dict[str, NDArray[Any]] | None:
        """State last saved by :meth:`checkpoint`, or ``None`` at a fresh start.

        Histories already hold the frames that belong to that state.
        """
        ...

    def checkpoint(self, state: Callable[[], Mapping[str, ArrayLike | np.generic]]) -> None:
        """Save the state belonging to the frames appended so far, if it is time to.

        Cheap enough to be called after every frame; ``state`` is evaluated only when it is saved.
        """
        ...

    def progress(self, done: int, total: int) -> None:
        """Report that ``done`` of ``total`` steps are finished."""
        ...

    def warn(self, message: str) -> None:
        """Tell the user something that does not stop the stage."""
        ...

    def tell(self, message: str) -> None:
        """Tell what goes on, a line at a time, to a user who wants to see it; nothing is kept."""
        ...

    def note(self, name: str, value: Any) -> None:
        """Keep a JSON value with the result, for instance an iteration count."""
        ...
