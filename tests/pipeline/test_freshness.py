"""A result is never kept under the key of code that did not compute it."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

Output = Callable[..., str]

FACTOR = "FACTOR = {}\n"

STAGES = """
from dataclasses import dataclass
from pathlib import Path
from pipeline.nodes import stage
{top}

@dataclass(frozen=True)
class Config:
    start: float
    touch: str = ""

@dataclass(frozen=True)
class Number:
    value: float

def save(text):
    if text:
        Path(__file__).with_name("factor.py").write_text(text)

@stage
def first(config: Config) -> Number:
    save(config.touch)
    return Number(config.start)

@stage
def second(config: Config, number: Number) -> Number:
    from scaling import factor
    save(config.touch)
    return Number(number.value * factor.FACTOR)
"""

# Runs in another process: a plan of two stages, and what comes of it.
RUN = """
import sys
from scaling import stages
from pipeline.errors import MyofilmError
from pipeline.plan import explain
from pipeline.runner import run
from pipeline.store import LocalStore

def attempt(start, first="", second=""):
    config = stages.Config(start, first)
    number = stages.first(config)
    nodes = {"second": stages.second(stages.Config(start, second), number)}
    try:
        outcome = run(nodes, LocalStore("store"))["second"]
        print(outcome.load().value, outcome.hit)
    except MyofilmError as error:
        print(error)
    explain(nodes, LocalStore("store"))

def save(text):
    stages.save(text)
"""


@pytest.fixture(params=["", "from scaling import factor"], ids=["lazy", "eager"])
def scaling(tmp_path: Path, request: pytest.FixtureRequest) -> Path:
    """A package whose second stage imports a factor when it runs, or at the top of its module."""
    folder = tmp_path / "scaling"
    folder.mkdir()
    (folder / "__init__.py").write_text("")
    (folder / "factor.py").write_text(FACTOR.format(1.0))
    (folder / "stages.py").write_text(STAGES.format(top=request.param))
    return folder


REFUSED = "the source of scaling.factor was edited after this process had loaded"


def test_code_edited_between_two_runs_of_a_process_is_refused(
    scaling: Path, output: Output
) -> None:
    old, new = FACTOR.format(1.0), FACTOR.format(1000.0)
    told = output(
        f"{RUN}\nattempt(3.0)\nsave({new!r})\nattempt(3.0)\nattempt(4.0)\nsave({old!r})\nattempt(3.0)"
    )
    assert told.startswith("3.0 False\n")
    assert told.count(REFUSED) == 2
    assert told.count("Remedy: start again in a new process") == 2
    assert told.endswith("3.0 True\n")  # what is on the disk is what was loaded
    (scaling / "factor.py").write_text(new)
    assert output(f"{RUN}\nattempt(3.0)\nattempt(4.0)") == "3000.0 False\n4000.0 False\n"


def test_code_saved_while_an_earlier_stage_computes_does_not_enter_a_later_key(
    scaling: Path, output: Output
) -> None:
    new = FACTOR.format(1000.0)
    told = output(f"{RUN}\nattempt(3.0, first={new!r})")
    if "import factor\n\n" in (scaling / "stages.py").read_text():
        # The old code was loaded: its result is kept under the old key.
        assert told == "3.0 False\n"
    else:
        assert REFUSED in told
        assert len(list((scaling.parent / "store" / "objects").glob("second/*"))) == 0
    assert output(f"{RUN}\nattempt(3.0)") == "3000.0 False\n"
    (scaling / "factor.py").write_text(FACTOR.format(1.0))
    expected = "3.0 True\n" if told == "3.0 False\n" else "3.0 False\n"
    assert output(f"{RUN}\nattempt(3.0)") == expected


def test_code_saved_after_it_was_loaded_does_not_spoil_the_result_of_the_loaded_code(
    scaling: Path, output: Output
) -> None:
    new = FACTOR.format(1000.0)
    assert output(f"{RUN}\nattempt(3.0, second={new!r})") == "3.0 False\n"
    (scaling / "factor.py").write_text(FACTOR.format(1.0))
    assert output(f"{RUN}\nattempt(3.0, second={new!r})") == "3.0 True\n"


def test_a_comment_saved_during_a_run_is_no_edit(scaling: Path, output: Output) -> None:
    old = FACTOR.format(1.0)
    commented = f"# a comment\n{old}"
    told = output(
        f"{RUN}\nattempt(3.0, first={commented!r})\nattempt(4.0)\nsave({old!r})\nattempt(5.0)"
    )
    assert told == "3.0 False\n4.0 False\n5.0 False\n"


def test_an_edit_after_loading_but_before_the_first_run_is_refused(
    scaling: Path, output: Output
) -> None:
    told = output(f"{RUN}\nfrom scaling import factor\nsave({FACTOR.format(7.0)!r})\nattempt(3.0)")
    assert REFUSED in told


def test_code_that_is_gone_since_it_was_loaded_is_noticed(scaling: Path, output: Output) -> None:
    told = output(f"{RUN}\nattempt(3.0)\nsave('# no code\\n')\nattempt(4.0)")
    assert told.startswith("3.0 False\n")
    assert REFUSED in told


def test_a_module_loaded_anew_is_the_edited_one(scaling: Path, output: Output) -> None:
    told = output(
        f"{RUN}\nimport importlib\nfrom scaling import factor\nattempt(3.0)\n"
        f"save({FACTOR.format(1000.0)!r})\nimportlib.reload(factor)\nattempt(3.0)"
    )
    assert told == "3.0 False\n3000.0 False\n"


def test_a_checkpoint_is_never_saved_under_the_key_of_other_code(
    scaling: Path, output: Output
) -> None:
    (scaling / "stages.py").write_text(
        STAGES.format(top="from pipeline.nodes import StageRun\nimport numpy as np\n")
        + """
@stage
def long(config: Config, *, run: StageRun) -> Number:
    save(config.touch)
    from scaling import factor
    run.checkpoint(lambda: {"x": np.array(factor.FACTOR)})
    raise AssertionError
"""
    )
    told = output(
        f"{RUN}\ntry:\n"
        f"    run({{'x': stages.long(stages.Config(1.0, {FACTOR.format(2.0)!r}))}},"
        " LocalStore('store'), checkpoint_interval=0.0)\n"
        "except MyofilmError as error:\n    print(error)"
    )
    assert REFUSED in told
    assert not list((scaling.parent / "store" / "checkpoints").iterdir())


@pytest.mark.parametrize("how", ["written", "copied"])
def test_compiled_code_of_another_state_of_a_file_is_not_run(
    how: str, scaling: Path, output: Output
) -> None:
    # Python looks at size and time of the source, in seconds: here both are those of the edited file.
    file, compiling = scaling / "factor.py", {"PYTHONDONTWRITEBYTECODE": ""}
    then = file.stat()
    assert output(f"{RUN}\nattempt(3.0)", **compiling) == "3.0 False\n"
    assert list((scaling / "__pycache__").glob("factor.*.pyc"))
    target = file if how == "written" else file.with_name("other.py")
    target.write_text(FACTOR.format(7.0))
    os.utime(target, ns=(then.st_atime_ns, then.st_mtime_ns))
    target.replace(file)
    assert output(f"{RUN}\nattempt(3.0)", **compiling) == "21.0 False\n"


def test_compiled_code_that_is_clearly_younger_than_its_source_is_kept(
    scaling: Path, output: Output
) -> None:
    code = "from scaling import factor"
    compiling = {"PYTHONDONTWRITEBYTECODE": ""}
    output(f"import pipeline\n{code}", **compiling)
    (compiled,) = (scaling / "__pycache__").glob("factor.*.pyc")
    first = compiled.stat()
    output(
        f"import pipeline, pipeline.fingerprint.loaded as loaded\nloaded.DOUBTFUL_NS = 0\n{code}",
        **compiling,
    )
    assert compiled.stat().st_mtime_ns == first.st_mtime_ns
    output(f"import pipeline\n{code}", **compiling)  # it was compiled within two seconds
    assert compiled.stat().st_mtime_ns > first.st_mtime_ns
