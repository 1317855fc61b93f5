"""Hypothesis strategies for spline spaces and patches."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from stages.numerics.bsplines import SplineSpace
from stages.numerics.patches import Patch


@st.composite
def spline_spaces(draw: st.DrawFn, max_degree: int = 4, smooth: bool = False) -> SplineSpace:
    """Spaces of degree 1 to 4 on uneven knot spans, some knots repeated (unless ``smooth``)."""
    degree = draw(st.integers(2 if smooth else 1, max_degree))
    widths = draw(st.lists(st.floats(0.2, 2.0), min_size=1, max_size=6))
    breaks = np.concatenate(([0.0], np.cumsum(widths)))
    most = 1 if smooth else degree
    counts = [draw(st.integers(1, most)) for _ in breaks[1:-1]]
    knots = np.repeat(breaks, [degree + 1, *counts, degree + 1])
    return SplineSpace(degree, knots)


@st.composite
def bumpy_patches(draw: st.DrawFn, max_degree: int = 3) -> Patch:
    """Curved patches: a flat net over the Greville points, moved by up to a tenth of a span."""
    first = draw(spline_spaces(max_degree, smooth=True))
    second = draw(spline_spaces(max_degree, smooth=True))
    x, y = np.meshgrid(first.greville(), second.greville(), indexing="ij")
    net = np.stack((x, y, np.zeros_like(x)), axis=-1)
    spans = min(np.diff(first.breaks).min(), np.diff(second.breaks).min())
    seed = draw(st.integers(0, 2**32 - 1))
    noise = np.random.default_rng(seed).uniform(-1, 1, net.shape)
    smallest = spans / max(first.degree, second.degree)
    return Patch(first, second, net + 0.1 * smallest * noise)


@st.composite
def rational_patches(draw: st.DrawFn, max_degree: int = 3) -> Patch:
    """Bumpy patches with random weights between a half and two."""
    patch = draw(bumpy_patches(max_degree))
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    weights = 2.0 ** random.uniform(-1, 1, patch.control_points.shape[:2])
    return Patch(patch.first, patch.second, patch.control_points, weights)
