"""No support: switches off one that a parameter file sets."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Literal

from pydantic import ConfigDict

from stages.configuration import Edge, setting
from stages.mechanics.supports.base import Support

if TYPE_CHECKING:
    from stages.numerics.patches import Patch
    from stages.numerics.ties import Relation


class Free(Support):
    """Holds nothing: ``--set mechanics.supports.clamp.kind=free`` lets a clamped film go.

    Whatever else the support that it takes the place of was given says nothing any more.
    """

    model_config = ConfigDict(extra="ignore")

    kind: Literal["free"] = "free"
    edge: Edge | None = setting("edge that is let go; says nothing more", "sec. 4.1", default=None)

    def relations(self, patch: Patch) -> Iterable[Relation]:
        """None."""
        return ()


MODEL = Free
