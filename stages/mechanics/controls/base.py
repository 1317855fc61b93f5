"""What a control is: how a quasi-static run gets from one stored shape to the next."""

from __future__ import annotations

from stages.configuration import Section


class Control(Section):
    """Parameters of a control; a file of this folder holds one kind and names it in ``MODEL``."""

    kind: str
