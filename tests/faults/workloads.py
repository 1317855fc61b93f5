"""Real workflows, small enough to be run hundreds of times."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pipeline.nodes import Node
from workflows.request import Request

WORKLOADS: Mapping[str, tuple[str, ...]] = {
    # All five stages: wave, resampling, motion, measures. 41 and 9 frames.
    "planar-waves": (
        "electrophysiology.elements=[14, 4]",
        "electrophysiology.n_steps=400",
        "electrophysiology.duration=40.0",
        'electrophysiology.stimuli=["S1"]',
        "electrophysiology.conductivity=0.05",
        "electrophysiology.stimulus_library.S1.flux=10.0",
        "mechanics.elements=[4, 2]",
        "mechanics.n_steps=8",
        "mechanics.duration=40.0",
    ),
    # A path of equilibria, and a motion of more frames than a chunk holds.
    "curling": ("mechanics.elements=[4, 2]", "mechanics.n_steps=8"),
    "twitch": ("mechanics.elements=[4, 2]", "mechanics.n_steps=70"),
}


def nodes_of(workload: str) -> Mapping[str, Node[Any]]:
    """Planned nodes of a small workflow."""
    return Request.read(workload, None, WORKLOADS[workload]).nodes()
