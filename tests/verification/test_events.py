"""Events read off samples are those of every time step."""

from __future__ import annotations

import pytest

from tests.verification.studies import broken_limits, table_of
from workflows.verification.studies.events import TIMES

SHORT = (
    "samples=[5, 10, 20]",
    "electrophysiology.elements=[102, 1]",
    "electrophysiology.duration=800",
    "electrophysiology.n_steps=16000",
)


def test_samples_of_one_millisecond_place_events_to_a_hundredth() -> None:
    table = table_of("events", *SHORT)
    assert broken_limits("events", table) == []
    # third-order: the error of a parabola falls by 8 with each halving, that of a straight line by 4
    quarter, _, one = table.column("activation_times")
    assert one / quarter > 4**2
    assert (table.values > 0.0).all()  # nothing was compared with itself


@pytest.mark.slow
def test_they_do_for_both_waves_and_every_interval() -> None:
    table = table_of("events")
    assert broken_limits("events", table) == []
    for name in TIMES:
        assert table.column(name)[0] < 1e-4
