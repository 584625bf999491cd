"""Coulomb friction: of one guide in closed form, of any number of pairs together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np

from core.frozen import frozen
from core.numerics.lazy import Lazy

JAMS = 1.0  # jam factor from which friction may jam
JAMMED = 1e150  # [N] replaces an infinite force during the solution, as infinities would cancel to NaN
_INFINITE = 1e100  # [N] a larger force counts as infinite
_NEWTON_STEPS = 60  # on the directions of the reactions; three to five are usual
_CONVERGED = 1e-15  # of the largest magnitude
_BELOW_JAM = 1.0 - 1e-9  # jam factor at which the proportions of the forces of a jam are computed


def with_infinities(value: Any) -> Any:
    """Replace the large finite forces and torques of a jammed guide by infinities of the same sign.

    Complex arrays are replaced component by component; mappings, tuples and dataclasses entry by entry.
    """
    if isinstance(value, Mapping):
        return {name: with_infinities(part) for name, part in value.items()}
    if is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{field.name: with_infinities(getattr(value, field.name)) for field in fields(value)})
    if isinstance(value, tuple):
        parts = [with_infinities(part) for part in value]
        return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)
    if not isinstance(value, np.ndarray):
        return value
    if np.iscomplexobj(value):  # i times infinity would be NaN
        result = np.empty(value.shape, dtype=complex)
        result.real, result.imag = with_infinities(value.real), with_infinities(value.imag)
        return result
    return np.where(np.abs(value) > _INFINITE, np.copysign(np.inf, value), value)


@frozen(eq=False)
class GuideReaction:
    """Reaction of a guide.

    Attributes
    ----------
    normal : ndarray (n,) [N]
        Normal force by the guide on the body, along the guide's direction + 90°.
    friction : ndarray (n,) [N]
        Along the guide.
    jam : ndarray (n,), dimensionless
        Jam factor, below 1 unless the guide jams.
    """

    normal: np.ndarray
    friction: np.ndarray
    jam: Lazy[np.ndarray] = Lazy()


def is_jammed(force: np.ndarray) -> bool:
    """Whether the force is infinite anywhere, i.e. larger than 1e100.

    Parameters
    ----------
    force : ndarray (n,) [N]

    Returns
    -------
    bool
    """
    return bool(np.abs(force).max() > _INFINITE)


def guide_reaction(frictionless: np.ndarray, sign: np.ndarray, slope: np.ndarray, coefficient: float) -> GuideReaction:
    """Reaction of one guide with Coulomb friction: the solution of N + μ sgn(L̇) slope |N| = N0.

    With τ = sgn(N0) μ sgn(L̇) slope: N = N0/(1+τ). |τ| < 1 has exactly this solution; τ > 1 has two, of which this is
    one; τ <= -1 has none: the guide jams and the force grows without limit. It is ``JAMMED`` then, so that the forces
    that follow from it keep their signs; `with_infinities` makes it infinite.

    Parameters
    ----------
    frictionless : ndarray (n,) [N]
        Normal force N0 without friction.
    sign : ndarray (n,), dimensionless
        sgn L̇ of the motion: -1, 0, 1.
    slope : ndarray (n,), dimensionless
        Decrease of the normal force per newton of friction: tan β of the rod.
    coefficient : float
        Coefficient of friction μ.

    Returns
    -------
    GuideReaction
    """
    tau = coefficient * sign * slope * np.sign(frictionless)
    solvable = tau > -1.0
    with np.errstate(divide="ignore", invalid="ignore"):
        normal = frictionless / (1.0 + tau)
    if not solvable.all():
        normal = np.where(solvable, normal, np.copysign(JAMMED, frictionless))
    return GuideReaction(normal, np.abs(normal) * (-coefficient * sign), lambda: np.abs(coefficient * slope))


def jam_factor(gains: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """Spectral radius of |G| c: from 1 on friction increases without limit and the mechanism jams.

    Parameters
    ----------
    gains : ndarray (k, k, n), dimensionless
        G: change of the reaction of the first pair per newton of friction in the second pair.
    coefficients : ndarray (k,) or (k, n), dimensionless
        Coefficients of friction c.

    Returns
    -------
    ndarray (n,), dimensionless
    """
    return np.asarray(np.abs(np.linalg.eigvals(_gain_matrices(gains, coefficients))).max(axis=1))


def _rows(coefficients: np.ndarray) -> np.ndarray:
    """Coefficients (k,) or (k, n) as (k, 1) or (k, n)."""
    return coefficients.reshape(coefficients.shape[0], -1)


def _gain_matrices(gains: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """|G| c (n, k, k)."""
    matrix = np.moveaxis(np.abs(gains) * _rows(coefficients), 2, 0)
    return np.where(np.isfinite(matrix), matrix, JAMMED)


def jam_factor_bound(gains: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """The jam factor, or an upper bound of it where that is below 1: the largest row or column sum of |G| c.

    Parameters
    ----------
    gains : ndarray (k, k, n), dimensionless
    coefficients : ndarray (k,) or (k, n), dimensionless

    Returns
    -------
    ndarray (n,), dimensionless
    """
    c = _rows(coefficients)
    matrix = np.abs(gains) * c
    bound = np.fmin(matrix.sum(axis=0).max(axis=0), matrix.sum(axis=1).max(axis=0))
    undecided = np.flatnonzero(~(bound < 1.0))
    if undecided.size:
        bound[undecided] = jam_factor(gains[:, :, undecided], c if c.shape[1] == 1 else c[:, undecided])
    return np.asarray(bound)


def critical_friction(gains: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """Index of the friction with the largest component in the eigenvector of the jam factor.

    Parameters
    ----------
    gains : ndarray (k, k, n), dimensionless
    coefficients : ndarray (k,) or (k, n), dimensionless

    Returns
    -------
    ndarray (n,) int, dimensionless
    """
    values, vectors = np.linalg.eig(_gain_matrices(gains, coefficients))
    first = np.abs(values).argmax(axis=1)
    parts = np.abs(np.take_along_axis(vectors, first[:, None, None], axis=2)[..., 0]) * _rows(coefficients).T
    return np.asarray(parts.argmax(axis=1))


def magnitudes(normals: np.ndarray, gains: np.ndarray, coefficients: np.ndarray, jam: np.ndarray) -> np.ndarray:
    """Magnitudes |N| of the reactions of k pairs with friction: the solution of m = |N0 + G c m|.

    Newton's method on the directions of the reactions, all angles at once, from m = 0; the solution is unique where the
    jam factor is below 1. From 1 on there is no limit: the result is ``JAMMED``, in the proportions just below.

    Parameters
    ----------
    normals : ndarray (k, n) complex [N]
        Reactions N0 without friction.
    gains : ndarray (k, k, n) complex, dimensionless
        G.
    coefficients : ndarray (k,) or (k, n), dimensionless
        c.
    jam : ndarray (n,), dimensionless
        Jam factor.

    Returns
    -------
    ndarray (k, n) [N]
    """
    reduction = np.where(jam < 1.0, 1.0, _BELOW_JAM / np.maximum(jam, 1.0))
    x, y = (part * (_rows(coefficients) * reduction) for part in (gains.real, gains.imag))
    is_real = not y.any()  # sliding pairs alone
    m, converged = np.zeros(normals.shape), np.zeros(normals.shape[1], dtype=bool)
    for _ in range(_NEWTON_STEPS):
        along = normals.real + (x * m).sum(axis=1)
        across = normals.imag if is_real else normals.imag + (y * m).sum(axis=1)
        size = np.hypot(along, across)
        inverse = 1.0 / np.where(size > 0.0, size, np.inf)
        slope = (along * inverse)[:, None] * x
        if not is_real:
            slope += (across * inverse)[:, None] * y
        change = np.where(converged, 0.0, _solve(slope, size - m))  # so that angles stay independent
        m = m + change
        converged |= ~(np.abs(change) > _CONVERGED * np.abs(m).max(axis=0)).any(axis=0)
        if converged.all():
            break
    m = np.abs(m)
    largest = m.max(axis=0)
    is_jammed = JAMMED * m / np.where(largest > 0.0, largest, 1.0)
    return np.where(jam < 1.0, m, is_jammed)


def _solve(slope: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solution x of (1 - A) x = b, A (k, k, n), b (k, n).

    Elimination without pivoting: where the spectral radius of |A| is below 1 every pivot is positive.
    """
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
