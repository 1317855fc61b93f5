"""Version of the installed program."""

from __future__ import annotations

from importlib import metadata


def version() -> str:
    """Version of the distribution, ``"not installed"`` when run from a bare source tree."""
    try:
        return metadata.version("myofilm")
    except metadata.PackageNotFoundError:
        return "not installed"
