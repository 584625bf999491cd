"""Coulomb friction: of one guide in closed form, of any number of pairs together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

JAMMED = 1e150  # [N] stands for a force without limit: infinity would leave nan behind, not a sign
_BEYOND = 1e100
_ROUNDS = 60  # of Newton on the directions of the reactions; three to five do
_DONE = 1e-15  # of the largest magnitude
_BELOW = 1.0 - 1e-9  # of a jam factor: the force beyond a jam is taken in the direction that it has just below


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


def jammed(force: np.ndarray) -> bool:
    """Whether the force is without limit anywhere."""
    return bool((np.abs(force) > _BEYOND).any())


def guide_reaction(frictionless: np.ndarray, sign: np.ndarray, slope: np.ndarray, coefficient: float) -> GuideReaction:
    """Solves N + μ sgn(L̇) slope |N| = N0.

    frictionless  (n,) N0, the normal force without friction [N]
    sign          (n,) sgn L̇ of the motion: -1, 0, 1
    slope         (n,) what one newton of friction takes from the normal force: tan β of the rod

    With τ = sgn(N0) μ sgn(L̇) slope: N = N0/(1+τ). |τ| < 1 has exactly this sign; τ > 1 has two, of which this is
    one; τ <= -1 has none: the guide jams and the force grows without limit. It is ``JAMMED`` then, so that what
    follows from it keeps its sign; ``limitless`` makes it infinite in the end.
    """
    tau = coefficient * sign * slope * np.sign(frictionless)
    with np.errstate(divide="ignore", invalid="ignore"):
        normal = np.where(tau > -1.0, frictionless / (1.0 + tau), np.copysign(JAMMED, frictionless))
        friction = -coefficient * np.abs(normal) * sign
    return GuideReaction(normal, np.where(sign == 0.0, 0.0, friction), np.abs(coefficient * slope))


Gains = Mapping[tuple[str, str], np.ndarray]
"""(pair, rubbing pair) -> G (n,): what one newton of friction in the second adds to the reaction of the first."""


def _matrix(names: tuple[str, ...], gains: Gains, n: int) -> np.ndarray:
    rows = [[np.broadcast_to(gains[(one, other)], n) for other in names] for one in names]
    return np.moveaxis(np.array(rows), 2, 0)


def jam_factor(names: tuple[str, ...], gains: Gains, coefficients: np.ndarray, n: int) -> np.ndarray:
    """The spectral radius of |G| c (n,): where it is 1 or more, friction feeds on itself and the mechanism jams."""
    if not names:
        return np.zeros(n)
    matrix = np.abs(_matrix(names, gains, n)) * coefficients
    matrix = np.where(np.isfinite(matrix), matrix, JAMMED)
    return np.asarray(np.abs(np.linalg.eigvals(matrix)).max(axis=1))


def magnitudes(
    names: tuple[str, ...], normals: Mapping[str, np.ndarray], gains: Gains, coefficients: np.ndarray, jam: np.ndarray, n: int
) -> np.ndarray:
    """|N| of every pair that rubs (k, n) [N], from m = |N0 + G c m|, c the coefficients.

    Newton on the directions of the reactions, all angles at once, from m = 0; unique where the jam factor is below 1. At
    1 and above there is no limit: ``JAMMED``, in the proportions just below.
    """
    if not names:
        return np.zeros((0, n))
    free = np.array([np.broadcast_to(normals[name], n) for name in names]).T.astype(complex)
    over = np.where(jam < 1.0, 1.0, _BELOW / np.maximum(jam, 1.0))
    gain = _matrix(names, gains, n) * coefficients * over[:, None, None]
    m, one = np.zeros(free.shape), np.eye(len(names))
    for _ in range(_ROUNDS):
        reaction = free + (gain @ m[..., None])[..., 0]
        size = np.abs(reaction)
        heading = np.where(size > 0.0, reaction / np.where(size > 0.0, size, 1.0), 0.0)
        slope = (heading.conj()[..., None] * gain).real
        change = np.linalg.solve(one - slope, (size - m)[..., None])[..., 0]
        m = m + change
        if not (np.abs(change) > _DONE * np.abs(m).max(axis=1, keepdims=True)).any():
            break
    m = np.abs(m)
    largest = m.max(axis=1, keepdims=True)
    beyond = JAMMED * m / np.where(largest > 0.0, largest, 1.0)
    return np.where((jam < 1.0)[:, None], m, beyond).T
