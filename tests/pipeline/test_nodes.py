"""Stages are declared by their signature; planning checks everything and computes nothing."""

from __future__ import annotations

import pickle
from dataclasses import dataclass
from typing import Any

import pytest

from pipeline.nodes import Node, in_order, stage
from pipeline.testing import MemoryRun
from tests.pipeline import toy


@dataclass(frozen=True)
class Config:
    n: int = 1


@dataclass(frozen=True)
class Number:
    value: int


@stage
def number(config: Config) -> Number:
    return Number(config.n)


@stage
def total(config: Config, first: Number, second: Number | None = None) -> Number:
    return Number(first.value + (second.value if second else 0))


def test_calling_a_stage_plans_a_node_and_computes_nothing() -> None:
    node = toy.wave(toy.WaveConfig(fail_at=0), surface=toy.mesh(toy.MeshConfig()).part("surface"))
    assert isinstance(node, Node)
    assert node.record is toy.Wave


def test_the_plain_function_stays_callable() -> None:
    film = toy.mesh.compute(toy.MeshConfig())
    run = MemoryRun()
    wave = toy.wave.compute(toy.WaveConfig(frames=3), film.surface, run=run)
    assert wave.potential.shape == (3, toy.POINTS)
    assert run.steps == [(1, 3), (2, 3), (3, 3)]
    assert toy.wave.function(toy.WaveConfig(frames=0), film.surface, run=run).time.size == 0


def test_a_history_in_memory_has_the_types_that_are_stored() -> None:
    wave = toy.wave.compute(toy.WaveConfig(frames=2), toy.mesh.compute(toy.MeshConfig()).surface)
    assert wave.potential.dtype == "float32"
    assert wave.energy.dtype == "float64"


def test_a_history_of_unknown_length_ends_with_the_frames_that_came() -> None:
    film = toy.mesh.compute(toy.MeshConfig())
    wave = toy.wave.compute(toy.WaveConfig(frames=9, ends_at=3), film.surface)
    assert wave.potential.shape == (3, toy.POINTS)
    assert wave.time.shape == wave.energy.shape == (3,)
    with pytest.raises(ValueError, match="ends after 0 of the 9 frames announced"):
        toy.wave.compute(toy.WaveConfig(frames=9, ends_at=0), film.surface)


def test_inputs_may_be_given_by_place_or_by_role() -> None:
    a, b = number(Config(1)), number(Config(2))
    assert total(Config(), a, b).inputs == total(Config(), second=b, first=a).inputs


def test_an_optional_input_may_be_left_out() -> None:
    a = number(Config())
    assert total(Config(), a).inputs == total(Config(), a, second=None).inputs == {"first": a}


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: total(Config()), "needs the input 'first'"),
        (lambda: total(Config(), third=number(Config())), "has no input 'third'; it takes: first"),
        (lambda: total(Config(), *[number(Config())] * 3), "takes 2 inputs, got 3"),
        (lambda: total(Config(), number(Config()), first=number(Config())), "'?first'? twice"),
        (lambda: total(Config(), Number(1)), "must be a planned node or a part of one"),
        (lambda: total(Config(), toy.mesh(toy.MeshConfig())), "must be Number, but .* is Film"),
        (
            lambda: total(Config(), toy.mesh(toy.MeshConfig()).part("label")),
            r"must be Number, but Part\(mesh.label\) is Label",
        ),
        (lambda: number({"n": 1}), "needs a configuration first"),
        (lambda: number(toy.MeshConfig()), "is configured by Config, got MeshConfig"),
        (lambda: toy.mesh(toy.MeshConfig()).part("surfaces"), "no part .*; it has: surface, label"),
        (lambda: number(Config()).part("value"), "it is one whole"),
    ],
)
def test_wrong_plans_are_refused_at_once(call: Any, message: str) -> None:
    with pytest.raises(TypeError, match=message):
        call()


def test_badly_declared_stages_are_refused_with_the_reason() -> None:
    def no_config() -> Number: ...  # type: ignore[empty-body]  # never called
    def no_record(config: Config) -> int: ...  # type: ignore[empty-body]  # never called
    def no_annotation(config: Config, first) -> Number: ...  # type: ignore  # the point of it
    def odd_keyword(config: Config, *, speed: float) -> Number: ...  # type: ignore[empty-body]

    for function, message in [
        (no_config, "must take its configuration"),
        (no_record, "must be annotated to return a record class"),
        (no_annotation, "'first' has no annotation"),
        (odd_keyword, "only 'run' may be keyword-only"),
    ]:
        with pytest.raises(TypeError, match=message):
            stage(function)(Config())


def test_nodes_come_after_all_they_need_and_once() -> None:
    a = number(Config(1))
    b = total(Config(), a, a)
    c = total(Config(), b, a)
    assert [name for name, _ in in_order({"c": c, "b": b})] == ["number", "b", "c"]


def test_stages_and_nodes_can_be_sent_to_another_process() -> None:
    node = toy.wave(toy.WaveConfig(), surface=toy.mesh(toy.MeshConfig()).part("surface"))
    copied = pickle.loads(pickle.dumps(node))
    assert copied.stage is toy.wave
    assert copied.config == node.config
