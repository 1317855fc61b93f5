"""How a command goes about its work. Nothing here changes a result."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Way:
    """What a user may choose of any command that computes.

    Attributes
    ----------
    name
        Name of the run in the store; without one it goes by its output folder.
    recompute_damaged
        Whether damaged results are set aside and computed again, instead of ending the run.
    accept_code
        Whether results whose code alone is another are accepted instead of computing.
    quiet, verbose
        Whether to tell warnings and errors only, or every step of the solvers, too.
    """

    name: str | None = None
    recompute_damaged: bool = False
    accept_code: bool = False
    quiet: bool = False
    verbose: bool = False


USUAL = Way()
"""What happens if nothing else is chosen."""
