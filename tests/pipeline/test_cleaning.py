"""What may be removed and in which order, decided from lists alone."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from pipeline.keys import Ref
from pipeline.store.catalogue import Row
from pipeline.store.cleaning import (
    DAY,
    FAILED_DAYS,
    UNFINISHED_DAYS,
    Limits,
    reachable,
    removals,
    stale,
)
from pipeline.store.upkeep import Leftover

NOW = 1e9


def ref(number: int) -> Ref:
    return Ref("stage", str(number))


def row(number: int, size: int = 10, seconds: float = 1.0, age: float = 0.0, *inputs: int) -> Row:
    return Row(ref(number), size, seconds, NOW - age * DAY, tuple(map(ref, inputs)))


def gone(
    rows: list[Row], limits: Limits, reached: tuple[int, ...] = (), **uses: float
) -> list[str]:
    """Keys of what would go, in order."""
    used = {Ref("stage", key[1:]): NOW - days * DAY for key, days in uses.items()}
    return [r.row.ref.key for r in removals(rows, used, set(map(ref, reached)), limits, NOW)]


def test_without_limits_nothing_goes() -> None:
    assert gone([row(1, age=1000.0)], Limits()) == []


def test_what_is_unreachable_goes_and_what_is_reached_stays() -> None:
    assert gone([row(1), row(2), row(3)], Limits(unreachable=True), (2,)) == ["1", "3"]


def test_what_was_used_lately_is_not_old() -> None:
    rows = [row(1, age=50.0), row(2, age=50.0), row(3, age=10.0)]
    assert gone(rows, Limits(unused_for=30 * DAY), _2=29.0) == ["1"]


def test_what_saves_the_fewest_seconds_per_byte_goes_first_until_the_store_is_small() -> None:
    rows = [row(1, 10, 5.0), row(2, 10, 1.0), row(3, 40, 8.0), row(4, 1, 0.01)]
    assert gone(rows, Limits(size=61)) == []
    assert gone(rows, Limits(size=60)) == ["4"]
    assert gone(rows, Limits(size=59)) == ["4", "2"]
    assert gone(rows, Limits(size=50)) == ["4", "2"]
    assert gone(rows, Limits(size=49)) == ["4", "2", "3"]


def test_of_equal_worth_what_was_used_longest_ago_goes_first() -> None:
    rows = [row(1, age=9.0), row(2, age=9.0), row(3, age=5.0)]
    assert gone(rows, Limits(size=10), _1=1.0) == ["2", "3"]


def test_each_limit_is_a_reason_to_go() -> None:
    rows = [row(1, 10, 9.0, age=50.0), row(2, 10, 1.0), row(3, 10, 2.0)]
    assert gone(rows, Limits(unused_for=30 * DAY, size=20)) == ["1"]  # that is small enough
    assert gone(rows, Limits(unused_for=30 * DAY, size=10)) == ["2", "1"]


def test_what_nobody_can_read_stays() -> None:
    damaged = Row(ref(1), 0, 0.0, 0.0, problem="unreadable")
    assert gone([damaged], Limits(unused_for=0.0, size=0, unreachable=True)) == []


def test_what_something_kept_was_computed_from_is_reached() -> None:
    rows = {r.ref: r for r in (row(1), row(2, 10, 1.0, 0.0, 1), row(3, 10, 1.0, 0.0, 2, 9))}
    assert reachable([ref(3), ref(7)], rows) == {ref(n) for n in (1, 2, 3, 7, 9)}
    assert reachable([ref(3)], rows, {ref(2)}) == {ref(3), ref(2), ref(9)}


@given(
    sizes=st.lists(st.integers(0, 9), min_size=1, max_size=12),
    roots=st.sets(st.integers(0, 11)),
    limit=st.integers(0, 60),
    data=st.data(),
)
def test_whatever_is_asked_nothing_reached_goes_and_no_more_than_it_takes(
    sizes: list[int], roots: set[int], limit: int, data: st.DataObject
) -> None:
    rows = [
        row(n, size, data.draw(st.floats(0, 9)), data.draw(st.floats(0, 99)), *range(n - 2, n))
        for n, size in enumerate(sizes)
    ]
    reached = reachable(map(ref, roots), {r.ref: r for r in rows})
    chosen = [r.row for r in removals(rows, {}, reached, Limits(size=limit), NOW)]
    assert not {r.ref for r in chosen} & reached
    left = sum(sizes) - sum(r.size for r in chosen)
    free = [r for r in rows if r.ref not in reached]
    assert left <= limit or {r.ref for r in chosen} == {r.ref for r in free if r.size}
    if chosen:  # the last one was needed
        assert left + chosen[-1].size > limit


def leftover(days: float, **about: bool) -> Leftover:
    usual = {"resumable": False, "busy": False, "published": False}
    return Leftover("k", "k", 1, NOW - days * DAY, **(usual | about))


def test_unfinished_work_goes_when_nobody_can_or_will_go_on_from_it() -> None:
    young, old = FAILED_DAYS / 2, 2 * FAILED_DAYS
    stay = [
        leftover(young),
        leftover(old, resumable=True),
        leftover(UNFINISHED_DAYS / 2, damaged=True),
        leftover(999.0, busy=True, published=True),
    ]
    go = [
        leftover(old),
        leftover(young, resumable=True, published=True),
        leftover(2 * UNFINISHED_DAYS, resumable=True),
        leftover(2 * UNFINISHED_DAYS, damaged=True),
    ]
    assert [each for each, _ in stale(stay + go, Limits(), NOW)] == go


def test_a_checkpoint_is_kept_as_long_as_results_are() -> None:
    checkpoint = leftover(5.0, resumable=True)
    assert stale([checkpoint], Limits(unused_for=6 * DAY), NOW) == []
    assert len(stale([checkpoint], Limits(unused_for=4 * DAY), NOW)) == 1
