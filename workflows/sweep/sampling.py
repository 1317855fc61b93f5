"""Samples that fill a space of parameters evenly: Latin hypercubes and Sobol sequences."""

from __future__ import annotations

import warnings
from collections.abc import Mapping

from pipeline.errors import InputError
from workflows.sweep.design import Block
from workflows.sweep.fields import Field
from workflows.sweep.grammar import Interval

METHODS = ("lhs", "sobol")
MOST_FIELDS = 21_201
"""Dimensions for which scipy has Sobol direction numbers."""


def parse_sample(text: str) -> tuple[str, int]:
    """Method and number of samples of ``lhs:200`` or ``sobol:256``.

    Raises
    ------
    InputError
        If it is not of that form.
    """
    method, _, count = (part.strip() for part in text.partition(":"))
    if method not in METHODS:
        raise InputError(f"--sample {text}: choose lhs:N or sobol:N, with N samples")
    if not count.isdigit() or not 1 <= int(count) <= 1_000_000:
        raise InputError(f"--sample {text}: the number of samples must be 1 to 1000000")
    return method, int(count)


def sampled(method: str, count: int, intervals: Mapping[Field, Interval], seed: int) -> Block:
    """Samples of some fields, a row each; the same seed gives the same samples.

    References
    ----------
    McKay, Beckman and Conover (1979), *Technometrics* 21; Owen (1998), *J. Complexity* 14 (scrambled
    Sobol sequences); both as in ``scipy.stats.qmc``.
    """
    from scipy.stats import qmc

    dimensions = len(intervals)
    if method == "lhs":
        points = qmc.LatinHypercube(dimensions, seed=seed).random(count)
    else:
        with warnings.catch_warnings():  # the caller tells when a count is no power of two
            warnings.simplefilter("ignore", UserWarning)
            points = qmc.Sobol(dimensions, seed=seed).random(count)
    rows = [
        tuple(
            one.at(float(share), whole=field.is_whole)
            for (field, one), share in zip(intervals.items(), point, strict=True)
        )
        for point in points
    ]
    return Block(tuple(intervals), rows)


def is_balanced(method: str, count: int) -> bool:
    """Whether a Sobol sequence of that length has its balance: it takes a power of two."""
    return method != "sobol" or count & (count - 1) == 0
