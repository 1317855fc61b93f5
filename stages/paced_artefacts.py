"""Records of paced tissue: what was measured in each of many cases; see :mod:`stages.artefacts`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from stages.artefacts import array

if TYPE_CHECKING:  # records are described, not made, when a run is only planned
    from stages.numerics.bsplines import Array


@dataclass(frozen=True)
class PacedBeats:
    """One beat of paced tissue in each of several cases, measured at one point.

    ``interval`` is that from the stimulus before to the one that makes the beat, and tells the cases
    apart. ``activation_time`` counts from that stimulus; ``diastolic_interval`` is the time from 90 %
    repolarisation of the beat before, had nothing followed it, to this activation. Samples are
    ``Restitution.sample_times`` after the stimulus. NaN where the stimulus made no beat, or came before the
    beat before was over.
    """

    interval: Array = array("ms", "case")
    activation_time: Array = array("ms", "case")
    diastolic_interval: Array = array("ms", "case")
    apd50: Array = array("ms", "case")
    apd90: Array = array("ms", "case")
    peak_active_stress: Array = array("kPa", "case")
    conduction_velocity: Array = array("mm/ms", "case")
    potential: Array = array("mV", "case", "sample")
    active_stress: Array = array("kPa", "case", "sample")


@dataclass(frozen=True)
class Restitution:
    """Beats after one stimulus S2 that follows a train S1, and the last beats of steady trains.

    ``s1_apd90`` is that of each beat of the train; the samples of ``s1`` are those of its last one.
    """

    s2: PacedBeats
    steady: PacedBeats
    sample_times: Array = array("ms", "sample")
    s1_apd90: Array = array("ms", "beat")
    s1_potential: Array = array("mV", "sample")
    s1_active_stress: Array = array("kPa", "sample")


NO_WAVE, PASSES, REENTRY = 0.0, 1.0, 2.0
"""Outcomes: the last stimulus adds no wave; one that passes; one that comes round again."""


@dataclass(frozen=True)
class VulnerableWindow:
    """What becomes of the last stimulus, by the time at which it is given: ``outcome``, and more.

    The
    shares are those of the film that it activates, and activates again; activations are those that it adds,
    and ``life_time`` is the time from it to the last of these anywhere.
    """

    probe_names: tuple[str, ...]
    time: Array = array("ms", "case")
    outcome: Array = array("1", "case")
    activated_share: Array = array("1", "case")
    reactivated_share: Array = array("1", "case")
    life_time: Array = array("ms", "case")
    activations: Array = array("1", "case", "probe")
