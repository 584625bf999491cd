"""Curves of least ∫ jerk² as a least-squares problem around a ring of knots, reduced by halves with Householder's QR.

Between two knots a distance h apart the curve of least jerk through the states x = (s, s', s'') at both ends is a
quintic, and its ∫ s'''² is |R d|²/h⁵ with the defects
    d = (s₁ - s₀ - h s₀' - h² s₀''/2,  h (s₁' - s₀' - h s₀''),  h² (s₁'' - s₀'')),
where the rows of R give mean, slope and bend of the jerk, its Legendre coefficients. So s, s', s'' join by themselves,
and what is left is to minimise a sum of squares over the states. Squares are never summed up before they are solved,
which keeps twice the digits of the normal equations and bears knots of very uneven distances.

All work is on whole levels of the ring at once: n knots cost 2n small factorisations in log2(n) calls of numpy.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

ROUNDING = 1e3 * float(np.finfo(float).eps)
STATES = 3  # s, s', s''
# columns of a level's rows: the knot taken out, its neighbours, what the rows add up to
_OWN, _LEFT, _RIGHT, _TOLD = (
    slice(0, STATES),
    slice(STATES, 2 * STATES),
    slice(2 * STATES, 3 * STATES),
    slice(3 * STATES, None),
)
_R = np.array([[0.0, 0.0, 1.0], [0.0, -2.0 * 3.0**0.5, 3.0**0.5], [12.0 * 5.0**0.5, -6.0 * 5.0**0.5, 5.0**0.5]])


def defects(h: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """d of each interval (k, 3, r) from its distance h (k,) and the states at its ends (k, 3, r)."""
    wide = h[:, None]
    return np.stack(
        (
            end[:, 0] - start[:, 0] - wide * start[:, 1] - 0.5 * wide**2 * start[:, 2],
            wide * (end[:, 1] - start[:, 1] - wide * start[:, 2]),
            wide**2 * (end[:, 2] - start[:, 2]),
        ),
        axis=1,
    )


def jerk_rows(h: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Rows (k, 3, r) whose sum of squares is ∫ s'''² over each interval, one column for each curve."""
    return (_R @ defects(h, start, end)) / (h**2.5)[:, None, None]


def quintics(h: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Coefficients (k, 6, r) of the quintics w⁰...w⁵ with these states (k, 3, r) at both ends of intervals h (k,).

    The jerk c₀ + c₁ P₁ + c₂ P₂ (Legendre) follows from the defects, and its integrals are the last three.
    """
    d0, d1, d2 = np.moveaxis(defects(h, start, end), 1, 0)
    c1, c2 = 3.0 * d2 - 6.0 * d1, 60.0 * d0 - 30.0 * d1 + 5.0 * d2
    jerk = (d2 - c1 + c2, 2.0 * c1 - 6.0 * c2, 6.0 * c2)  # by powers of w/h, times h³
    wide = h[:, None]
    made = [start[:, 0], start[:, 1], 0.5 * start[:, 2]]
    made += [c / f / wide**k for c, f, k in zip(jerk, (6.0, 24.0, 60.0), (3, 4, 5), strict=True)]
    return np.stack(made, axis=1)


@dataclass(frozen=True, eq=False)
class _Half:
    """What one level leaves behind: own x_j = told - left x_{j-1} - right x_{j+1} for the knots taken out of it."""

    own: np.ndarray
    left: np.ndarray
    right: np.ndarray
    told: np.ndarray


def states(h: np.ndarray, known: np.ndarray, fixed: np.ndarray, weight: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """The states (n, 3, r) at the knots of least ∫ s'''² + Σ weight² (x - wanted)².

    h       (n,) distance from each knot to the next, the last to the first; 0: the two have nothing to do with each other
    known   (n, 3, r) the states that are fixed; 0 elsewhere
    fixed   (n, 3) which are
    weight  (n, 3) of those that are wanted; 0 elsewhere
    wanted  (n, 3, r)

    Raises numpy.linalg.LinAlgError where what is fixed and wanted leaves the curve free.
    """
    n, _, r = known.shape
    linked = h > 0.0
    size = np.where(linked, h, 1.0)
    one = np.broadcast_to(np.eye(STATES), (n, STATES, STATES))
    none = np.zeros_like(one)
    gain = (linked / size**2.5)[:, None, None]
    start = gain * (_R @ defects(size, one, none)) * ~fixed[:, None, :]
    end = gain * (_R @ defects(size, none, one)) * ~np.roll(fixed, -1, axis=0)[:, None, :]
    told = -gain * (_R @ defects(size, known, np.roll(known, -1, axis=0)))
    held = np.where(fixed, 1.0, weight)
    node = held[:, :, None] * np.eye(STATES)
    aims = np.where(fixed[:, :, None], 0.0, held[:, :, None] * wanted)
    usual = np.abs(np.concatenate((start[0], end[-1], node[0]))).max(axis=0)
    halves = []
    while node.shape[0] > 1:
        half, (start, end, told), node, aims = _halved(start, end, told, node, aims)
        halves.append(half)
    rows = np.concatenate((start[0] + end[0], node[0]))
    sides = np.concatenate((told[0], aims[0]))
    x = _determined(rows, sides, usual)[None]
    for half in reversed(halves):
        k = half.own.shape[0]
        kept = x
        after = np.roll(kept, -1, axis=0)[:k]
        found = np.linalg.solve(half.own, half.told - half.left @ kept[:k] - half.right @ after)
        x = np.empty((kept.shape[0] + k, STATES, r))
        x[0::2], x[1::2] = kept, found
    return np.where(fixed[:, :, None], known, x)


def _halved(
    start: np.ndarray, end: np.ndarray, told: np.ndarray, node: np.ndarray, aims: np.ndarray
) -> tuple[_Half, tuple[np.ndarray, np.ndarray, np.ndarray], np.ndarray, np.ndarray]:
    """Every second knot taken out: the two intervals beside it become one."""
    k = node.shape[0] // 2
    rows, r = start.shape[1], told.shape[2]
    stack = np.zeros((k, 2 * rows + STATES, 3 * STATES + r))
    before, behind, own = stack[:, :rows], stack[:, rows : 2 * rows], stack[:, 2 * rows :]
    before[:, :, _OWN], before[:, :, _LEFT], before[:, :, _TOLD] = (part[0 : 2 * k : 2] for part in (end, start, told))
    behind[:, :, _OWN], behind[:, :, _RIGHT], behind[:, :, _TOLD] = (part[1 : 2 * k : 2] for part in (start, end, told))
    own[:, :, _OWN], own[:, :, _TOLD] = node[1::2], aims[1::2]
    # heavy rows first: then each row keeps its own digits, however uneven the knots are (Powell, Reid 1969)
    order = np.argsort(-np.abs(stack[:, :, : 3 * STATES]).max(axis=2), axis=1, kind="stable")
    stack = np.take_along_axis(stack, order[:, :, None], axis=1)
    made = np.asarray(np.linalg.qr(stack, mode="r"))
    top, rest = made[:, :STATES], made[:, STATES : 3 * STATES]
    half = _Half(top[:, :, _OWN], top[:, :, _LEFT], top[:, :, _RIGHT], top[:, :, _TOLD])
    new = [rest[:, :, _LEFT], rest[:, :, _RIGHT], rest[:, :, _TOLD]]
    if node.shape[0] > 2 * k:  # an odd ring: its last interval stays
        for i, part in enumerate((start, end, told)):
            last = np.zeros((1, 2 * STATES, part.shape[2]))
            last[0, :rows] = part[-1]
            new[i] = np.concatenate((new[i], last))
    return half, (new[0], new[1], new[2]), node[0::2], aims[0::2]


def _determined(rows: np.ndarray, sides: np.ndarray, usual: np.ndarray) -> np.ndarray:
    """Least squares for the last knot's state; its columns (3,) differ in size by powers of the distances, and what has
    become of one of ``usual`` size when all other knots are gone may be rounding alone."""
    size = np.abs(rows).max(axis=0)
    if np.any(size <= ROUNDING * usual):
        raise np.linalg.LinAlgError("a state is left free")
    found, _, rank, _ = np.linalg.lstsq(rows / size, sides, rcond=ROUNDING)
    if rank < STATES:
        raise np.linalg.LinAlgError("the curve is left free")
    return found / size[:, None]
