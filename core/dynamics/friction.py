"""Coulomb friction on a guide in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

JAMMED = 1e150  # [N] stands for a force without limit: infinity would leave nan behind, not a sign
_BEYOND = 1e100


def limitless(force: np.ndarray) -> np.ndarray:
    """Forces and torques with infinity, of the right sign, for what a jammed guide makes of them; complex ones part by
    part."""
    if np.iscomplexobj(force):
        return _complex(limitless(force.real), limitless(force.imag))
    return np.where(np.abs(force) > _BEYOND, np.copysign(np.inf, force), force)


def _complex(real: np.ndarray, imag: np.ndarray) -> np.ndarray:
    """real + i imag without multiplying: i times infinity would be nan."""
    made = np.empty(real.shape, dtype=complex)
    made.real, made.imag = real, imag
    return made


@dataclass(frozen=True, eq=False)
class GuideReaction:
    """normal (n,) [N] by the guide on the body, along guide + 90 deg; friction (n,) [N] along the guide;
    jam (n,) the factor that must stay below 1."""

    normal: np.ndarray
    friction: np.ndarray
    jam: np.ndarray


def jammed(guide: GuideReaction) -> bool:
    """Whether the force is without limit anywhere."""
    return bool((np.abs(guide.normal) > _BEYOND).any())


def guide_reaction(frictionless: np.ndarray, way: np.ndarray, slope: np.ndarray, coefficient: float) -> GuideReaction:
    """Solves N + μ sgn(L̇) slope |N| = N0.

    frictionless  (n,) N0, the normal force without friction [N]
    way           (n,) sgn L̇ of the motion: -1, 0, 1
    slope         (n,) what one newton of friction adds to the normal force: tan β of the rod

    With τ = sgn(N0) μ sgn(L̇) slope: N = N0/(1+τ). |τ| < 1 has exactly this sign; τ > 1 has two, of which this is
    one; τ <= -1 has none: the guide jams and the force grows without limit. It is ``JAMMED`` then, so that what
    follows from it keeps its sign; ``limitless`` makes it infinite in the end.
    """
    if coefficient == 0.0:
        return GuideReaction(frictionless, np.zeros_like(frictionless), np.zeros_like(frictionless))
    tau = coefficient * way * slope * np.sign(frictionless)
    with np.errstate(divide="ignore", invalid="ignore"):
        normal = np.where(tau > -1.0, frictionless / (1.0 + tau), np.copysign(JAMMED, frictionless))
        friction = -coefficient * np.abs(normal) * way if coefficient else np.zeros_like(normal)
    return GuideReaction(normal, np.where(way == 0.0, 0.0, friction), np.abs(coefficient * slope))
