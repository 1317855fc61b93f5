"""Small films for the tests: flat, curved, and with the paper's materials (Table 1)."""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from stages.artefacts import Laminate, Layer
from stages.mechanics.body.body import Body
from stages.mechanics.config import MechanicsConfig
from stages.mechanics.materials.base import Material
from stages.mechanics.shell.shell import Shell, build_shell
from stages.mechanics.supports.clamped import Clamped
from stages.numerics.bsplines import Array, SplineSpace
from stages.numerics.newton import NewtonControls
from stages.numerics.patches import Patch
from stages.numerics.shapes import cylindrical_panel
from tests.mechanics.materials import EXAMPLES

PDMS = EXAMPLES["neo-hookean"]
MUSCLE = EXAMPLES["neo-hookean-fibre"]
MATERIALS: dict[str, Material] = {"substrate": PDMS, "active": MUSCLE}


def two_layers(angle: float = 45.0, substrate: float = 0.018, active: float = 0.004) -> Laminate:
    """The film of the paper."""
    return Laminate(
        (
            Layer("substrate", "substrate", substrate, angle, 0.0),
            Layer("active", "active", active, angle, 1.0),
        )
    )


def flat(
    elements: tuple[int, int] = (8, 3), degree: int = 2, length: float = 3.5, width: float = 2.0
) -> Patch:
    """Rectangle with equal spans."""
    return Patch.rectangle(length, width).refine(degree, elements)


def uneven(degree: int = 2) -> Patch:
    """Rectangle 3.5 x 2 whose knot spans have different lengths in both directions."""
    line = Patch.rectangle(3.5, 2.0)
    first = line.first.elevate(degree - 1).insert(np.array([0.13, 0.31, 0.72]))
    second = line.second.elevate(degree - 1).insert(np.array([0.4]))
    embed = line.first.embed(first), line.second.embed(second)
    net = np.einsum("ai,bj,ijx->abx", *embed, line.control_points)
    return Patch(first, second, net)


def arched(elements: tuple[int, int] = (4, 3), degree: int = 2, height: float = 0.6) -> Patch:
    """Doubly curved film: the rectangle lifted to a bulge, with a twist."""
    first, second = (SplineSpace.uniform(degree, n) for n in elements)
    x, y = np.meshgrid(first.greville(), second.greville(), indexing="ij")
    z = height * x * (1.0 - x) + 0.3 * height * (y - 0.5) ** 2 + 0.2 * height * x * y
    return Patch(first, second, np.stack((3.5 * x, 2.0 * y, z), axis=-1))


def mixed() -> Patch:
    """Curved film of degree 2 along X and 4 along Y."""
    flat_one = Patch.rectangle(3.5, 2.0)
    spaces = SplineSpace.uniform(2, 4), SplineSpace.uniform(4, 2)
    points = flat_one.evaluate(spaces[0].greville(), spaces[1].greville())
    points[:, 2] = 0.1 * np.sin(points[:, 0]) * (1.0 + points[:, 1])
    start = np.zeros((spaces[0].size, spaces[1].size, 3))
    return Patch(spaces[0], spaces[1], start).interpolate(points)


def rational() -> Patch:
    """Cylindrical panel whose inner weights are changed, so that no symmetry hides a term."""
    panel = cylindrical_panel(1.5, 3.5, (-50.0, 60.0)).refine(2, (3, 2))
    random = np.random.default_rng(9)
    factors = random.uniform(0.7, 1.4, panel.control_points.shape[:2])
    return Patch(panel.first, panel.second, panel.control_points, panel.weights * factors)


def shell(patch: Patch, laminate: Laminate | None = None) -> Shell:
    """Shell of the paper's materials."""
    return build_shell(patch, laminate or two_layers(), MATERIALS)


CLAMP = {"clamp": Clamped(edge="X=0")}
"""The paper's support."""


def clamped(body: Shell) -> Body:
    """A shell on the paper's clamp, without loads."""
    return Body.held(body, CLAMP)


def controls(body: Shell, **changes: int) -> NewtonControls:
    """Newton's tolerances as the configuration has them by default."""
    names = [
        field.name for field in fields(NewtonControls) if field.name in MechanicsConfig.model_fields
    ]
    defaults = {name: MechanicsConfig.model_fields[name].default for name in names}
    return NewtonControls(length=body.extent, **defaults | changes)


def random_state(body: Shell, seed: int, size: float = 0.05) -> tuple[Array, Array]:
    """A strongly deformed state and a rough activation between 0 and 15 kPa."""
    random = np.random.default_rng(seed)
    return size * random.normal(size=body.size), random.uniform(0.0, 15.0, size=body.points)


def rotation(seed: int = 0) -> Array:
    """A large random rotation."""
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q = q * np.sign(np.diagonal(r))
    return q if np.linalg.det(q) > 0 else -q
