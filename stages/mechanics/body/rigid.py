"""Motions that nothing resists: found before a quasi-static solve, and told with their remedy."""

from __future__ import annotations

import numpy as np

from stages.mechanics.body.body import Body
from stages.numerics.bsplines import Array
from stages.numerics.sparse import SingularMatrixError

FREE = 1e-9
"""Resistance of the supports to a rigid motion of unit size below which it counts as free."""

ZERO_ENERGY = 1e-14
"""Stiffness of a motion, relative to the stiffest entry, that is round-off (a bending film has 1e-9)."""


class FreeMotionError(ValueError):
    """The film may move without resistance; ``remedy`` says what to hold."""

    def __init__(self, fact: str, remedy: str) -> None:
        self.remedy = remedy
        super().__init__(fact)


def check_is_held(body: Body) -> None:
    """Raise an error if a rigid motion is free, or another one costs no energy at rest.

    The supports' relations are tried on the six rigid motions of the undeformed film. What they leave
    free would make the tangent singular.

    Raises
    ------
    FreeMotionError
        Naming the motion.
    """
    motions, centre, size = rigid_motions(body)
    _, strengths, directions = np.linalg.svd(
        np.vstack((body.constraints.resistance(motions), np.zeros((6, 6))))
    )
    free = directions[strengths < FREE]
    if free.size:
        raise FreeMotionError(
            f"the supports leave the film free to move: it can {_all(free, centre, size)}",
            "hold it by a clamp, or by hinges, symmetry or points that resist this motion "
            "(mechanics.supports)",
        )
    _check_has_stiffness(body)


def rigid_motions(body: Body) -> tuple[Array, Array, float]:
    """Translations along and rotations about X, Y, Z, shape ``(dof, 6)``; their centre and scale.

    Rotations are divided by the size of the film, so that all six move it by about one.
    """
    net = body.shell.patch.control_points.reshape(-1, 3)
    centre, size = net.mean(axis=0), body.shell.extent
    motions = np.empty((*net.shape, 6))
    for i, axis in enumerate(np.eye(3)):
        motions[..., i] = axis
        motions[..., 3 + i] = np.cross(axis, net - centre) / size
    return motions.reshape(-1, 6), centre, size


def _all(free: Array, centre: Array, size: float) -> str:
    """What a space of rigid motions can do; translations are named first, then pure rotations."""
    rotations = free[:, 3:]
    u, strengths, _ = np.linalg.svd(rotations)
    turning = strengths > 1e-6
    still = np.ones(len(free), dtype=bool)
    still[: turning.size] = ~turning
    words = [f"shift along {_axis(t)}" for t in _plain((u.T @ free)[still][:, :3])]
    turns = _plain((u.T @ free)[~still])
    return ", ".join([*words, *(_turn(turn, centre, size) for turn in turns)])


def _plain(rows: Array) -> Array:
    """The same space by reduced rows, so that coordinate axes show up as such."""
    rows = rows.copy()
    rank = 0
    for column in range(rows.shape[1] - 3 if rows.shape[1] == 6 else 0, rows.shape[1]):
        if rank == len(rows):
            break
        best = rank + int(np.argmax(np.abs(rows[rank:, column])))
        if abs(rows[best, column]) < 1e-6:
            continue
        rows[[rank, best]] = rows[[best, rank]]
        rows[rank] /= rows[rank, column]
        for other in range(len(rows)):
            if other != rank:
                rows[other] -= rows[other, column] * rows[rank]
        rank += 1
    return rows


def _turn(motion: Array, centre: Array, size: float) -> str:
    """v = t + w x (r - c) turns about the line through c + w x t / |w|^2 along w."""
    shift, spin = motion[:3], motion[3:] / size
    point = centre + np.cross(spin, shift) / (spin @ spin)
    place = ", ".join(f"{0.0 if abs(x) < 1e-9 * size else x:g}" for x in point)
    return f"turn about the line through ({place}) mm along {_axis(spin)}"


def _axis(vector: Array) -> str:
    unit = vector / np.linalg.norm(vector)
    unit *= np.sign(unit[np.argmax(np.abs(unit))])
    for name, axis in zip("XYZ", np.eye(3), strict=True):
        if np.abs(unit - axis).max() < 1e-6:
            return name
    return f"({', '.join(f'{0.0 if abs(x) < 1e-6 else x:.3g}' for x in unit)})"


def _check_has_stiffness(body: Body) -> None:
    """Inverse iteration on the tangent at rest finds the softest motion."""
    balance = body.balance(np.zeros(body.shell.size), body.nothing())
    scale = float(np.abs(balance.tangent.diagonal).max())
    motion = body.ties.collect(np.random.default_rng(0).normal(size=body.shell.size))
    try:
        for _ in range(3):
            motion = balance.factor.solve(motion / np.linalg.norm(motion))
    except SingularMatrixError:
        softest = 0.0
    else:
        softest = 1.0 / float(np.linalg.norm(motion))
    if not softest > ZERO_ENERGY * scale:
        raise FreeMotionError(
            "the film at rest can deform without resistance (its tangent is singular)",
            "use more in-plane quadrature points (mechanics.plane_points), or hold the film at "
            "more places",
        )
