"""Which events at two places belong to the same wave."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stages.numerics.bsplines import Array


def matching(events: Array, others: Array) -> NDArray[np.int64]:
    """Column of the one of ``others`` that is nearest in time to each event, and it to that.

    Beats are numbered place by place, so column k of two neighbours may belong to different waves:
    where a wave was blocked, and along a line through every spiral.

    Parameters
    ----------
    events, others
        Times at places and at their neighbours, shapes ``(..., n)`` and ``(..., m)``, ms; NaN where
        there is none.

    Returns
    -------
    Array
        Shape ``(..., n)``; -1 where there is none.

    Examples
    --------
    >>> matching(np.array([10.0, 440.0, 900.0]), np.array([12.0, 905.0]))
    array([ 0, -1,  1])
    """
    if not events.size or not others.size:
        places = np.broadcast_shapes(events.shape[:-1], others.shape[:-1])
        return np.full((*places, events.shape[-1]), -1)
    apart = np.abs(events[..., :, None] - others[..., None, :])
    apart = np.where(np.isnan(apart), np.inf, apart)
    nearest, back = np.argmin(apart, axis=-1), np.argmin(apart, axis=-2)
    there_and_back = np.take_along_axis(back, nearest, axis=-1)
    distance = np.take_along_axis(apart, nearest[..., None], axis=-1)[..., 0]
    mutual = (there_and_back == np.arange(events.shape[-1])) & np.isfinite(distance)
    return np.where(mutual, nearest, -1)


def taken(values: Array, columns: NDArray[np.int64]) -> Array:
    """Values of the matched events: ``values[..., columns]``, NaN where there is none.

    ``values`` has shape ``(..., m)``, ``columns`` ``(..., n)`` from :func:`matching`.
    """
    if not values.shape[-1]:
        return np.full(columns.shape, np.nan)
    found = np.take_along_axis(values, np.maximum(columns, 0), axis=-1)
    return np.where(columns >= 0, found, np.nan)
