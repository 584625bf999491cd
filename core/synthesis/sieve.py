"""Choice of the pairs of dyads that are worth judging: sampled transmission angles of all pairs at once.

With the driver's pin at A and ψ the angle of the body, the second dyad closes Re(U e^{iψ}) = V: of a pin U = (Ā - ḡ)ℓ,
of a guide U = n̄ℓ, of a turning guide U = m(ḡ - Ā). The answers themselves are judged by their solved kinematics (``judge``).
"""

from __future__ import annotations

import cmath
from collections import Counter
from collections.abc import Sequence
from math import pi

import numpy as np

from core.frozen import frozen
from core.synthesis.candidates import is_in_order, shortest_arc
from core.synthesis.dyads import GUIDE, PIN, Dyad

SAMPLES = 48  # driver angles in a turn
MOST_DYADS = 160
LEAST_SINE = 1e-3
MOST_USES = 4
"""Pairs of a dyad that are proposed: more would be neighbours of one linkage."""


@frozen(eq=False)
class Second:
    """Second dyads as arrays (n,), [mm]; ``normal`` are the normals of lines, and ``offset`` what their equations equal."""

    is_pin: np.ndarray
    is_guide: np.ndarray
    fixed: np.ndarray
    moving: np.ndarray
    normal: np.ndarray
    radius: np.ndarray

    @classmethod
    def of(cls, dyads: Sequence[Dyad], z: complex, turn: complex) -> Second:
        """Dyads with the length of their links by one position of the body, its origin z [mm] and unit vector."""
        kinds = np.array([dyad.kind for dyad in dyads])
        fixed, moving = (np.array([getattr(dyad, name) for dyad in dyads]) for name in ("fixed", "moving"))
        normal = np.array([1j * cmath.rect(1.0, dyad.line) for dyad in dyads])
        radius = np.abs(z + moving * turn - fixed)
        return cls(kinds == PIN, kinds == GUIDE, fixed, moving, normal, radius)

    def closure(self, pin: np.ndarray, local: complex) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """U, V of the closure and the factor that makes Im(U e^{iψ}) the sine of the transmission angle.

        Parameters
        ----------
        pin : ndarray (k,) complex [mm]
            Positions of the driver's pin.
        local : complex
            The same pin in the body's frame [mm].

        Returns
        -------
        tuple of ndarray (n, k), [mm²] of pins, else [mm]
        """
        rod = (self.moving - local)[:, None]
        to_pivot = self.fixed[:, None] - pin
        normal, radius = self.normal[:, None], self.radius[:, None]
        of_pin = -np.conj(to_pivot) * rod, 0.5 * (radius**2 - np.abs(to_pivot) ** 2 - np.abs(rod) ** 2)
        of_guide = np.conj(normal) * rod, (np.conj(normal) * to_pivot).real
        of_turning = normal * np.conj(to_pivot), (np.conj(normal) * rod).real
        cases = [np.broadcast_to(mask[:, None], to_pivot.shape) for mask in (self.is_pin, self.is_guide)]
        u = np.select(cases, np.broadcast_arrays(of_pin[0], of_guide[0]), of_turning[0])
        v = np.select(cases, np.broadcast_arrays(of_pin[1], of_guide[1]), of_turning[1])
        factor = np.select(cases, np.broadcast_arrays(radius * np.abs(rod), np.abs(rod)), np.abs(to_pivot))
        with np.errstate(divide="ignore", invalid="ignore"):
            return u, v, 1.0 / factor


def best_pairs(
    dyads: tuple[Sequence[Dyad], Sequence[Dyad]],
    z: np.ndarray,
    turn: np.ndarray,
    count: int,
    *,
    order: bool = False,
    with_defects: bool = False,
) -> list[tuple[Dyad, Dyad]]:
    """Pairs of dyads with the largest least transmission angle, among those without sampled defects.

    Parameters
    ----------
    dyads : (sequence of Dyad, sequence of Dyad)
        Those of the first and of the second side, of which a pair has one each; at most ``MOST_DYADS`` of a side are used, evenly chosen.
    z : ndarray (n,) complex [mm]
        Origins of the body at its poses.
    turn : ndarray (n,) complex, dimensionless
        Unit vectors of its x axis.
    count : int
        Number of pairs.
    order : bool
        The driver passes the poses in their order.
    with_defects : bool
        Pairs with sampled defects too; the transmission angle is then that at the poses.

    Returns
    -------
    list of (Dyad, Dyad)
        The driver's dyad, which has two pins, and the other one; each pair once, the best first.
    """
    first, second = (_evenly_chosen(side) for side in dyads)
    least: dict[frozenset[Dyad], tuple[float, tuple[Dyad, Dyad]]] = {}
    for drivers, others in ((first, second), (second, first)) if dyads[0] != dyads[1] else ((first, first),):
        arrays = Second.of(others, complex(z[0]), complex(turn[0]))
        for driver in drivers:
            if driver.kind != PIN:
                continue
            sines = _least_sines(driver, arrays, z, turn, order, with_defects)
            for k in np.flatnonzero(sines > LEAST_SINE):
                pair = driver, others[k]
                key = frozenset(pair)
                if len(key) == 2 and (key not in least or sines[k] > least[key][0]):
                    least[key] = float(sines[k]), pair
    most_uses = max(MOST_USES, -(-count // min(len(first), len(second))))
    uses: Counter[Dyad] = Counter()
    pairs: list[tuple[Dyad, Dyad]] = []
    for _, pair in sorted(least.values(), key=lambda row: -row[0]):
        if len(pairs) < count and max(uses[dyad] for dyad in pair) < most_uses:
            uses.update(pair)
            pairs.append(pair)
    return pairs


def _evenly_chosen(dyads: Sequence[Dyad]) -> list[Dyad]:
    chosen = np.unique(np.linspace(0, len(dyads) - 1, min(len(dyads), MOST_DYADS)).astype(int))
    return [dyads[i] for i in chosen]


def _least_sines(
    first: Dyad, second: Second, z: np.ndarray, turn: np.ndarray, order: bool, with_defects: bool
) -> np.ndarray:
    """Least sine of the transmission angle (n,) for a driver with each second dyad; 0 where a sampled defect counts and is found."""
    at_poses = z + first.moving * turn
    angles = np.angle(at_poses - first.fixed)
    crank = abs(at_poses[0] - first.fixed)
    if crank == 0.0:
        return np.zeros(second.fixed.size)
    u, _, factor = second.closure(at_poses, first.moving)
    with np.errstate(invalid="ignore"):
        signed = (u * turn).imag * factor
    if with_defects:
        return np.nan_to_num(np.abs(signed).min(axis=1))
    one_assembly = (np.sign(signed) == np.sign(signed[:, :1])).all(axis=1)
    if order and not is_in_order(angles):
        one_assembly[:] = False
    grid = 2.0 * pi / SAMPLES * np.arange(SAMPLES)
    u, v, factor = second.closure(first.fixed + crank * np.exp(1j * grid), first.moving)
    with np.errstate(invalid="ignore"):
        sines = np.sqrt(np.clip(np.abs(u) ** 2 - v**2, 0.0, None)) * factor
        assembled = np.abs(v) <= np.abs(u)
    turns_fully = assembled.all(axis=1)
    low, high = shortest_arc(angles)
    inside = np.mod(grid - low, 2.0 * pi) <= high - low
    between = assembled[:, inside].all(axis=1) if inside.any() else np.ones(turns_fully.size, dtype=bool)
    part = sines[:, inside].min(axis=1, initial=np.inf)
    full = sines.min(axis=1)
    result = np.where(turns_fully & (full > LEAST_SINE), full, np.where(between, part, 0.0))
    result = np.minimum(result, np.abs(signed).min(axis=1))
    return np.where(one_assembly & np.isfinite(result), result, 0.0)
