"""How a command starts and gets under way. Only the standard library is imported here."""

from __future__ import annotations

import gc
import os
import sys

_put_off = False
"""Whether this process is a command that has not looked for garbage yet."""


def start() -> None:
    """Begin a process that is a command.

    What is loaded stays until the end: looking for garbage among it would take a tenth of the time of a
    short command. :func:`under_way` ends that.
    """
    global _put_off
    gc.disable()
    _put_off = True
    _open_closed_streams()


def under_way() -> None:
    """Collect garbage from now on, without what has been loaded so far."""
    global _put_off
    if _put_off:
        gc.freeze()
        gc.enable()
    _put_off = False


def _open_closed_streams() -> None:
    """Open what the caller closed (``>&-``) on nothing, before another file takes its number."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_RDWR), mode))
