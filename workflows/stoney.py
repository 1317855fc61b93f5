"""From the curvature of a film back to the stress of its muscle, as laboratories do it, and how far that is off.

The Stoney formula and its relatives know a narrow strip, which is free to curl across its width. A wide
film is not, and bends less under the same stress. Read as a strip, it seems to pull less than it does.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from stages.mechanics.materials.neo_hookean import NeoHookean
from stages.mechanics.materials.neo_hookean_fibre import NeoHookeanFibre
from stages.mechanics.supports.clamped import Clamped
from stages.mechanics.supports.clamped_normal import ClampedNormal
from stages.mechanics.tension_laws.length_dependent import LengthDependent
from workflows.workflow import Quantity

if TYPE_CHECKING:
    from workflows.experiment import Experiment
    from workflows.imposed_film import ImposedFilmConfig
    from workflows.theory.bilayer import Ply

LEAST = 0.7
"""Share below cylindrical bending (3/4 for a thin muscle) and what the clamp takes from it."""


def modified_stoney(config: ImposedFilmConfig) -> float | None:
    """1/R = 6 (3 mu_a + E_p) ln(lambda_0)/(3 mu_s d_s) (d_a/d_s) (1 + d_a/d_s), 1/mm (eq. 102).

    ``None`` for materials or tension laws that have no such parameters. It holds no peak stress: the
    muscle is taken to shorten by its optimal stretch lambda_0, whatever it pulls with.
    """
    film, shell = config.geometry, config.mechanics
    substrate, muscle, law = shell.substrate, shell.active, shell.tension_law
    if not (
        isinstance(substrate, NeoHookean)
        and isinstance(muscle, NeoHookeanFibre)
        and isinstance(law, LengthDependent)
        and is_bilayer(config)
    ):
        return None
    ratio = film.active_thickness / film.substrate_thickness
    pull = (3.0 * muscle.shear_modulus + muscle.fibre_stiffness) * math.log(law.optimal_stretch)
    stiffness = 3.0 * substrate.shear_modulus * film.substrate_thickness
    return 6.0 * pull / stiffness * ratio * (1.0 + ratio)


def is_bilayer(config: ImposedFilmConfig) -> bool:
    """Whether a flat film of muscle on substrate is clamped at X = 0 alone, and only the muscle bends it."""
    held = [one for one in config.mechanics.supports.values() if one.kind != "free"]
    clamps = [one for one in held if isinstance(one, Clamped | ClampedNormal) and one.edge == "X=0"]
    return (
        config.geometry.shape.is_flat
        and not config.geometry.layers
        and not config.mechanics.loads
        and len(held) == len(clamps) == 1
    )


def plies(config: ImposedFilmConfig, stress: float) -> list[Ply] | None:
    """The film for the closed forms, under an active stress in kPa; ``None`` where they do not fit.

    They know two layers of the paper's materials, with fibres along X.
    """
    from workflows.theory.bilayer import Ply, prescribed

    film, shell = config.geometry, config.mechanics
    substrate, muscle = shell.substrate, shell.active
    if not (
        isinstance(substrate, NeoHookean)
        and isinstance(muscle, NeoHookeanFibre)
        and film.fibre_angle % 180.0 == 0.0
        and is_bilayer(config)
    ):
        return None
    return [
        Ply(film.substrate_thickness, substrate.shear_modulus),
        Ply(
            film.active_thickness,
            muscle.shear_modulus,
            muscle.fibre_stiffness,
            muscle.fibre_exponent,
            prescribed(stress),
        ),
    ]


def strip_stress(config: ImposedFilmConfig, curvature: float) -> float | None:
    """Active stress (kPa) with which a narrow strip of this film would have that curvature (1/mm).

    ``None`` where the closed form of the strip does not fit the film, or no stress does that.
    """
    from scipy.optimize import brentq

    from workflows.theory.bilayer import free_strip

    if curvature <= 0.0 or plies(config, 0.0) is None:
        return None

    def excess(stress: float) -> float:
        strip = plies(config, stress)
        assert strip is not None
        return free_strip(strip).curvature_x - curvature

    small = 1e-3
    guess = curvature * small / (excess(small) + curvature)
    try:
        return float(brentq(excess, 0.5 * guess, 2.0 * guess, xtol=1e-9 * guess))
    except ValueError:
        return None


def bias_quantities(experiment: Experiment) -> dict[str, Quantity]:
    """The active stress, what a narrow-strip formula makes of the curvature, and the ratio."""
    shape = experiment.shape
    true = float(shape.mean_active_stress[-1])
    read = strip_stress(experiment.config, float(shape.curvature[-1]))
    return {
        "active_stress": Quantity(
            true, "kPa", "active stress at the end of the loading, mean over the film"
        ),
        "strip_stress": Quantity(
            read,
            "kPa",
            "active stress that a narrow-strip (Stoney) formula reads off the curvature",
        ),
        "strip_share": Quantity(
            read / true if read is not None and true > 0.0 else None,
            "",
            "share of the true active stress that the strip formula returns",
        ),
    }


def bias_remarks(quantities: Mapping[str, Quantity]) -> Sequence[str]:
    """What that means, for someone who measures films."""
    share, read = quantities["strip_share"].value, quantities["strip_stress"].value
    true, curvature = quantities["active_stress"].value, quantities["curvature"].value
    if not (isinstance(share, float) and isinstance(read, float) and isinstance(true, float)):
        return ()
    if share < LEAST:
        return (
            f"A narrow-strip (Stoney) formula returns {share:.0%} of this film's stress, less than any width "
            "explains: look at the warnings of the run, and at its mesh.",
        )
    return (
        f"From a curvature of {curvature:.3g} per mm, a narrow-strip (Stoney) formula reads an active "
        f"stress of {read:.3g} kPa. The muscle of this film pulls with {true:.3g} kPa: the formula "
        f"returns {share:.0%} of the truth.",
        "Why: a narrow strip is free to curl across its width while it bends along its length. A wide "
        "film is not; it bends like a sheet of paper held at one edge, which takes up to a third more "
        "pull for the same curvature. Whoever reads a wide film as a strip underestimates the muscle, "
        "by about a quarter at most. The error cancels between films of equal shape; it does not between "
        "narrow and wide ones.",
    )
