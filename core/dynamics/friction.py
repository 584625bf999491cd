"""Coulomb friction: of one guide in closed form, of any number of pairs together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np

from core.frozen import frozen
from core.numerics.lazy import Lazy

JAMMED = 1e150  # [N] stands for a force without limit: infinity would leave nan behind, not a sign
_BEYOND = 1e100
_ROUNDS = 60  # of Newton on the directions of the reactions; three to five do
_DONE = 1e-15  # of the largest magnitude
_BELOW = 1.0 - 1e-9  # of a jam factor: the force beyond a jam is taken in the direction that it has just below


def limitless(value: Any) -> Any:
    """Forces and torques with infinity, of the right sign, for what a jammed guide makes of them; complex ones part by part,
    and all arrays of a mapping, a tuple or a dataclass."""
    if isinstance(value, Mapping):
        return {name: limitless(part) for name, part in value.items()}
    if is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{field.name: limitless(getattr(value, field.name)) for field in fields(value)})
    if isinstance(value, tuple):
        parts = [limitless(part) for part in value]
        return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)
    if not isinstance(value, np.ndarray):
        return value
    if np.iscomplexobj(value):  # i times infinity would be nan
        made = np.empty(value.shape, dtype=complex)
        made.real, made.imag = limitless(value.real), limitless(value.imag)
        return made
    return np.where(np.abs(value) > _BEYOND, np.copysign(np.inf, value), value)


@frozen(eq=False)
class GuideReaction:
    """normal (n,) [N] by the guide on the body, along guide + 90 deg; friction (n,) [N] along the guide;
    jam (n,) the factor that must stay below 1."""

    normal: np.ndarray
    friction: np.ndarray
    jam: Lazy[np.ndarray] = Lazy()


def jammed(force: np.ndarray) -> bool:
    """Whether the force is without limit anywhere."""
    return bool(force.max() > _BEYOND or force.min() < -_BEYOND)


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
    holds = tau > -1.0
    with np.errstate(divide="ignore", invalid="ignore"):
        normal = frictionless / (1.0 + tau)
    if not holds.all():
        normal = np.where(holds, normal, np.copysign(JAMMED, frictionless))
    return GuideReaction(normal, np.abs(normal) * (-coefficient * sign), lambda: np.abs(coefficient * slope))


def jam_factor(gains: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """The spectral radius of |G| c (n,): where it is 1 or more, friction feeds on itself and the mechanism jams.

    gains  (k, k, n) G: what one newton of friction in the second pair adds to the reaction of the first; coefficients c (k,), or (k, n)
    of many designs
    """
    return np.asarray(np.abs(np.linalg.eigvals(_sizes_of(gains, coefficients))).max(axis=1))


def _rows(coefficients: np.ndarray) -> np.ndarray:
    """(k, 1), or (k, n)."""
    return coefficients.reshape(coefficients.shape[0], -1)


def _sizes_of(gains: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """|G| c (n, k, k)."""
    matrix = np.moveaxis(np.abs(gains) * _rows(coefficients), 2, 0)
    return np.where(np.isfinite(matrix), matrix, JAMMED)


def below_jamming(gains: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """The jam factor (n,), or a bound of it where that is below 1: the largest sum of a row or of a column of |G| c."""
    c = _rows(coefficients)
    matrix = np.abs(gains) * c
    bound = np.fmin(matrix.sum(axis=0).max(axis=0), matrix.sum(axis=1).max(axis=0))
    near = np.flatnonzero(~(bound < 1.0))
    if near.size:
        bound[near] = jam_factor(gains[:, :, near], c if c.shape[1] == 1 else c[:, near])
    return np.asarray(bound)


def jams_most(gains: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """The row (n,) that has the largest part in what feeds on itself."""
    values, vectors = np.linalg.eig(_sizes_of(gains, coefficients))
    first = np.abs(values).argmax(axis=1)
    parts = np.abs(np.take_along_axis(vectors, first[:, None, None], axis=2)[..., 0]) * _rows(coefficients).T
    return np.asarray(parts.argmax(axis=1))


def magnitudes(normals: np.ndarray, gains: np.ndarray, coefficients: np.ndarray, jam: np.ndarray) -> np.ndarray:
    """|N| (k, n) [N] of the k pairs that rub, from m = |N0 + G c m|, N0 the reactions without friction (k, n), complex.

    Newton on the directions of the reactions, all angles at once, from m = 0; unique where the jam factor is below 1. At
    1 and above there is no limit: ``JAMMED``, in the proportions just below.
    """
    over = np.where(jam < 1.0, 1.0, _BELOW / np.maximum(jam, 1.0))
    x, y = (part * (_rows(coefficients) * over) for part in (gains.real, gains.imag))
    flat = not y.any()  # of slides alone
    m, done = np.zeros(normals.shape), np.zeros(normals.shape[1], dtype=bool)
    for _ in range(_ROUNDS):
        along = normals.real + (x * m).sum(axis=1)
        across = normals.imag if flat else normals.imag + (y * m).sum(axis=1)
        size = np.hypot(along, across)
        per = 1.0 / np.where(size > 0.0, size, np.inf)
        slope = (along * per)[:, None] * x
        if not flat:
            slope += (across * per)[:, None] * y
        change = np.where(done, 0.0, _solved(slope, size - m))  # an angle's answer depends on no other's
        m = m + change
        done |= ~(np.abs(change) > _DONE * np.abs(m).max(axis=0)).any(axis=0)
        if done.all():
            break
    m = np.abs(m)
    largest = m.max(axis=0)
    beyond = JAMMED * m / np.where(largest > 0.0, largest, 1.0)
    return np.where(jam < 1.0, m, beyond)


def _solved(slope: np.ndarray, right: np.ndarray) -> np.ndarray:
    """x of (1 - A) x = b, A (k, k, n), b (k, n). Elimination in order: where the spectral radius of |A| is below 1 every pivot
    is positive, and no other order is better."""
    count, a, x = right.shape[0], -slope, right.copy()
    for i in range(count):
        a[i, i] += 1.0
    for i in range(count - 1):
        factor = a[i + 1 :, i] / a[i, i]
        a[i + 1 :, i + 1 :] -= factor[:, None] * a[i, i + 1 :]
        x[i + 1 :] -= factor * x[i]
    for i in reversed(range(count)):
        x[i] = (x[i] - (a[i, i + 1 :] * x[i + 1 :]).sum(axis=0)) / a[i, i]
    return x
