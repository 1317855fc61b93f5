"""Tensor fields of diffusivity over a surface: isotropic, or stronger along fibres than across.

Tensors are relative to a scalar conductivity D that multiplies them elsewhere: the isotropic one is
the metric, and along the fibres every tensor is one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.fibres import FibreField, fibre_field
from stages.numerics.surface_geometry import SurfaceFrame


@dataclass(frozen=True)
class TensorField:
    """A symmetric tangential tensor at points, and its surface divergence.

    Attributes
    ----------
    components
        D^ab, contravariant, shape ``(point, 2, 2)``.
    divergence
        D^ab_|a with the covariant derivative of the surface, shape ``(point, 2)``.
    """

    components: Array
    divergence: Array


Diffusivity: TypeAlias = Callable[[SurfaceFrame], TensorField]
"""Tensor field of a frame: what collocation needs to know about a tissue."""


def isotropic(frame: SurfaceFrame) -> TensorField:
    """D^ab = a^ab, whose covariant derivatives vanish: div(D grad v) is the Laplace-Beltrami operator."""
    return TensorField(frame.metric_con, np.zeros((len(frame.position), 2)))


def along_fibres(ratio: float, angle: float) -> Diffusivity:
    """Fibres at a constant angle from theta^1, in degrees (see :func:`fibre_tensor`)."""
    return lambda frame: fibre_tensor(frame, fibre_field(frame, angle), ratio)


def fibre_tensor(frame: SurfaceFrame, fibres: FibreField, ratio: float) -> TensorField:
    """D^ab = k a^ab + (1 - k) f^a f^b: one along the fibres f and k = ``ratio`` across.

    With it div(D grad v) = k Lap v + (1 - k) (f . grad(f . grad v) + (div f) (f . grad v)). Any field of
    unit tangents will do:

        collocate(patch, lambda frame: fibre_tensor(frame, my_fibres(frame), 0.25))
    """
    up = np.einsum("px,pax->pa", fibres.direction, frame.dual)
    slopes = np.einsum("pax,pbx->pab", fibres.derivatives, frame.dual)  # f^b_|a
    spread = np.einsum("paa->p", slopes)
    carried = np.einsum("pa,pab->pb", up, slopes)
    return TensorField(
        ratio * frame.metric_con + (1.0 - ratio) * up[:, :, None] * up[:, None, :],
        (1.0 - ratio) * (spread[:, None] * up + carried),
    )
