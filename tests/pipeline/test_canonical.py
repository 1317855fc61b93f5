"""The canonical form is typed, unambiguous, and the same in every process."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, Field

from pipeline.canonical import canonical, digest

scalars = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(st.characters(exclude_categories=["Cs"]))
)
trees = st.recursive(
    scalars,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text("abc"), inner, max_size=4),
    max_leaves=12,
)


class Law(BaseModel):
    name: Literal["neo-hookean"] = "neo-hookean"
    modulus: float = 1.0


class Config(BaseModel):
    law: Law = Law()
    ratio: float = 0.5
    maybe: float | None = None
    either: int | float = 1
    pair: tuple[float, int] = (1.0, 1)
    many: tuple[float, ...] = ()
    table: dict[str, float] = Field(default_factory=dict)
    threads: int = Field(default=1, json_schema_extra={"keyed": False})


@dataclass(frozen=True)
class Plain:
    ratio: float
    threads: int = field(default=1, metadata={"keyed": False})
    twice: float = field(init=False, default=0.0)


def test_the_digests_of_known_values_never_change() -> None:
    # Literal digests: a change here means that every stored result is lost.
    assert digest(None) == "ef10aa9c5f2ffc6991a62db3447235eb8fa219eb"
    assert (
        digest({"b": [1, 1.0, True, "1"], "a": {"x": -0.5}})
        == "a761496a212f97b3ca2267ce83dc044afc78b609"
    )
    assert digest(Config()) == "d4551a3579931ecd1ebc57509d50104afbdae83e"


@pytest.mark.parametrize("seed", ["0", "1", "4294967295"])
def test_digests_do_not_depend_on_the_hash_seed(seed: str, output: Callable[..., str]) -> None:
    code = "from tests.pipeline.test_canonical import *; print(digest(Config()))"
    assert output(code, PYTHONHASHSEED=seed).strip() == digest(Config())


def test_values_of_different_types_have_different_digests() -> None:
    values = [None, False, 0, 0.0, "", "0", [], {}, [0], [[]], "None", [None], {"": None}]
    assert len({digest(value) for value in values}) == len(values)


def test_nesting_is_unambiguous() -> None:
    values = [["ab"], ["a", "b"], [["a"], "b"], ["a", ["b"]], {"a": "b"}, [["a", "b"]], "ab"]
    assert len({digest(value) for value in values}) == len(values)


def test_minus_zero_is_zero() -> None:
    assert digest(-0.0) == digest(0.0)


def test_tuples_are_lists() -> None:
    assert digest((1, (2,))) == digest([1, [2]])


def test_numpy_scalars_are_the_numbers_they_hold() -> None:
    assert digest(np.float64(1.5)) == digest(1.5)
    assert digest([np.int32(3), np.bool_(True)]) == digest([3, True])


@given(st.dictionaries(st.text("abcdef"), trees, min_size=2))
def test_the_order_of_a_dict_does_not_matter(value: dict[str, Any]) -> None:
    assert digest(dict(reversed(value.items()))) == digest(value)


@given(trees, st.data())
def test_any_changed_leaf_changes_the_digest(value: Any, data: st.DataObject) -> None:
    changed = [copy.deepcopy(value)]
    place, key = data.draw(st.sampled_from(list(leaves(changed))))
    old = place[key]
    place[key] = data.draw(scalars.filter(lambda new: not same(new, old)))
    assert digest(changed) != digest([value])


def leaves(container: Any) -> Any:
    """Container and key of every scalar or empty container."""
    items = container.items() if isinstance(container, dict) else enumerate(container)
    for key, item in list(items):
        if isinstance(item, dict | list) and item:
            yield from leaves(item)
        else:
            yield container, key


def same(a: Any, b: Any) -> bool:
    return type(a) is type(b) and a == b


def test_an_integer_in_a_float_field_is_a_float() -> None:
    loose = Config.model_construct(
        law=Law.model_construct(name="neo-hookean", modulus=1),
        ratio=1,
        maybe=2,
        either=1,
        pair=(1, 1),
        many=[1, 2],
        table={"x": 1},
        threads=1,
    )
    strict = Config(ratio=1.0, maybe=2.0, pair=(1.0, 1), many=(1.0, 2.0), table={"x": 1.0})
    assert digest(loose) == digest(strict)
    assert digest(Plain(1)) == digest(Plain(1.0))


def test_an_integer_stays_one_where_integers_are_declared() -> None:
    kept = canonical(Config())
    assert isinstance(kept, dict)
    assert repr(kept["either"]) == "1"
    assert repr(kept["pair"]) == "[1.0, 1]"


def test_unkeyed_and_derived_fields_do_not_count() -> None:
    assert digest(Config(threads=8)) == digest(Config())
    assert digest(Plain(0.5, threads=8)) == digest(Plain(0.5))
    assert canonical(Plain(0.5)) == {"ratio": 0.5}


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, np.float64("nan")])
def test_numbers_that_are_not_finite_are_refused_with_their_place(bad: float) -> None:
    config = Config.model_construct(**{**dict(Config()), "many": (1.0, bad)})
    with pytest.raises(ValueError, match=r"many\.1 is"):
        digest(config)


@pytest.mark.parametrize("bad", [object(), {1, 2}, b"bytes", 1j, np.zeros(2), digest, Config])
def test_values_without_a_canonical_form_are_refused_with_their_place(bad: Any) -> None:
    with pytest.raises(TypeError, match=r"law\.1"):
        digest({"law": [0, bad]})


def test_keys_that_are_no_strings_are_refused() -> None:
    with pytest.raises(TypeError, match="only strings"):
        digest({1: 2})


def test_text_that_is_not_unicode_is_refused() -> None:
    with pytest.raises(ValueError, match="Unicode"):
        digest("\ud800")
