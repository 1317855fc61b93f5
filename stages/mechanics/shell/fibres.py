"""What the fibres feel: stretch and active stress at the mid-depth of the topmost active layer."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stages.mechanics.shell.kinematics import Frames
from stages.mechanics.shell.laminate import LayerPoints, fibre_direction, reference_at_depth
from stages.mechanics.tension_laws.base import TensionLaw, functions_of
from stages.numerics.bsplines import Array
from stages.numerics.compiled import inlined, kernel


@dataclass(frozen=True)
class FibreGauge:
    """One point through the thickness, at every in-plane quadrature point (eq. 39).

    Attributes
    ----------
    depth
        theta3 of the gauge, mm.
    structure
        f0^a f0^b (11, 22, 12) there, shape ``(point, 3)``.
    activity
        Factor of the layer on the activation; 0 for a passive one, which has no active stress.
    """

    depth: float
    structure: Array
    activity: float
    _pull: Callable[[Array, Array], Array]

    @classmethod
    def build(
        cls, layers: Sequence[LayerPoints], reference: Frames, tension: TensionLaw
    ) -> FibreGauge:
        """Gauge in the topmost active layer, or in the topmost one of a passive laminate."""
        chosen = max(range(len(layers)), key=lambda i: (layers[i].layer.active, i))
        layer, depth = layers[chosen].layer, float(layers[chosen].depth.mean())
        table = reference_at_depth(reference, fibre_direction(layer, reference), depth)
        return cls(depth, table[:, 4:7].copy(), layer.activity, _compiled(tension))

    def stretch(self, reference: Frames, current: Frames) -> Array:
        """lambda_f = sqrt(1 + 2 f0^a f0^b E_ab), shape ``(point,)``."""
        strain = 0.5 * (current.metric - reference.metric)
        strain += self.depth * (reference.curvature - current.curvature)
        strain[:, 2] *= 2.0  # 12 and 21
        squared = 1.0 + 2.0 * np.einsum("ps,ps->p", self.structure, strain)
        return np.asarray(np.sqrt(squared))

    def stress(self, activation: Array, stretch: Array) -> Array:
        """sigma_a that the tension law makes of the activation, kPa, shape ``(point,)``."""
        if self.activity == 0.0:
            return np.zeros_like(stretch)
        return self._pull(self.activity * np.asarray(activation, dtype=float), stretch)


def _compiled(tension: TensionLaw) -> Callable[[Array, Array], Array]:
    pull, constants = _kernel(type(tension)), tension.constants()
    return lambda activation, stretch: pull(activation, stretch, constants)


@functools.cache
def _kernel(tension: type[TensionLaw]) -> Callable[..., Array]:
    law = inlined(functions_of(tension).tension)

    @kernel
    def pull(activation: Any, stretch: Any, constants: Any) -> Any:
        stress = np.empty_like(stretch)
        for p in range(stretch.size):
            stress[p] = law(activation[p], stretch[p], constants)[0]
        return stress

    return pull
