"""The load of a camshaft over one turn, as polynomials on short panels that end where the load is not smooth.

Its integral, the flywheel's answer and their extremes are then exact to rounding for every flywheel, jumps of the torque
included; no harmonics are cut off.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from math import pi

import numpy as np

from core.errors import NoAnswer, angle_ranges
from core.motion import TURN, Angles, Program
from core.motion.roots import crossings

NODES = 10  # per panel; the polynomial has this many coefficients
PANEL = np.deg2rad(2.0)  # longest panel
LEAST_PANELS = 16  # of a piece, however short: it may hold a whole sine wave

Load = Callable[[Angles], np.ndarray]
"""Torque at constant speed [N m] and inertia J_e [kg m²] of a load, (2, n) at any cam angles."""


@dataclass(frozen=True, eq=False)
class LoadCurve:
    """What the camshaft has to drive, over one turn.

    start, width  (m,) of the panels [rad]
    torque        (NODES, m) coefficients of r**k, r = (θ - start)/width in 0...1, of the torque T_c that holds the
                  speed constant [N m]
    inertia       (NODES, m) the same of J_e(θ) = 2 KE/ω², what the moved bodies are worth at the camshaft [kg m²]
    mean          T̄, the mean of T_c [N m]
    """

    start: np.ndarray
    width: np.ndarray
    torque: np.ndarray
    inertia: np.ndarray
    mean: float


@lru_cache(maxsize=1)
def _nodes() -> tuple[np.ndarray, np.ndarray]:
    """Chebyshev nodes of 0...1 and the matrix from values there to Chebyshev coefficients."""
    k = np.arange(NODES)
    angle = pi * (1.0 - (k + 0.5) / NODES)
    to_chebyshev = np.cos(np.outer(k, angle)) * (2.0 / NODES)
    to_chebyshev[0] /= 2.0
    return 0.5 + 0.5 * np.cos(angle), to_chebyshev


@lru_cache(maxsize=4)
def to_powers(count: int) -> np.ndarray:
    """The matrix from so many Chebyshev coefficients on 0...1 to power coefficients.

    Values become powers in two steps, for the inverse of a Vandermonde matrix costs six digits: the first step has no
    large entry, the large ones of this second (whole numbers) meet coefficients that have died away.
    """
    out = np.zeros((count, count))
    out[0, 0], out[:2, 1] = 1.0, (-1.0, 2.0)
    for n in range(2, count):  # T_n(x) = 2x T_{n-1} - T_{n-2}, x = 2r - 1
        out[1:, n] = 4.0 * out[:-1, n - 1]
        out[:, n] -= 2.0 * out[:, n - 1] + out[:, n - 2]
    return out


def panel_angles(program: Program) -> tuple[np.ndarray, np.ndarray, Angles]:
    """Panels (start, width) that never cross a join of pieces, and the nodes of all of them."""
    start, width, piece = [], [], []
    for i, (a, b) in enumerate(zip(program.starts, program.ends, strict=True)):
        count = max(LEAST_PANELS, int(np.ceil((b - a) / PANEL)))
        cuts = np.linspace(a, b, count + 1)
        start.append(cuts[:-1])
        width.append(np.diff(cuts))
        piece.append(np.full(count, i))
    starts, widths, pieces = np.concatenate(start), np.concatenate(width), np.concatenate(piece)
    x, _ = _nodes()
    theta = starts[:, None] + widths[:, None] * x
    return starts, widths, Angles(theta.ravel(), np.repeat(pieces, NODES))


def load_curve(load: Load, program: Program, switch: Callable[[Angles], np.ndarray] | None = None) -> LoadCurve:
    """The load fitted on panels. Raises NoAnswer where its torque is infinite.

    switch  (n,) at any cam angles: where its sign changes, as that of the guide's force does, friction breaks the
            torque, and so panels end there
    """
    start, width, angles = panel_angles(program)
    values = _finite(load, angles)
    if switch is not None:
        start, width, values = _cut(load, (start, width, angles, values), crossings(switch, angles, switch(angles)))
    _, to_chebyshev = _nodes()
    torque, inertia = (to_powers(NODES) @ (to_chebyshev @ row.reshape(-1, NODES).T) for row in values)
    mean = float((width * (torque / np.arange(1, NODES + 1)[:, None]).sum(axis=0)).sum() / TURN)
    return LoadCurve(start, width, torque, inertia, mean)


def _finite(load: Load, angles: Angles) -> np.ndarray:
    values = load(angles)
    lost = np.any(~np.isfinite(values), axis=0)
    if lost.any():
        raise NoAnswer("the torque is infinite", "loads", "change them", angle_ranges(angles.theta, lost))
    return values


def _cut(
    load: Load,
    panels: tuple[np.ndarray, np.ndarray, Angles, np.ndarray],
    at: Angles,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Start, width and values (2, n) at the nodes of panels that are cut at these angles."""
    start, width, angles, values = panels
    if not at.theta.size:
        return start, width, values
    pieces = angles.piece[::NODES]
    whole = np.ones(start.size, dtype=bool)
    starts, widths, of = [], [], []
    inside = np.searchsorted(start, at.theta, side="right") - 1
    for panel in np.unique(inside):
        cuts = at.theta[inside == panel]
        edges = np.unique(np.concatenate(([start[panel]], cuts, [start[panel] + width[panel]])))
        whole[panel] = False
        starts.append(edges[:-1])
        widths.append(np.diff(edges))
        of.append(np.full(edges.size - 1, pieces[panel]))
    new_start, new_width = np.concatenate(starts), np.concatenate(widths)
    x, _ = _nodes()
    nodes = (new_start[:, None] + new_width[:, None] * x).ravel()
    new = _finite(load, Angles(nodes, np.repeat(np.concatenate(of), NODES)))
    all_starts = np.concatenate((start[whole], new_start))
    order = np.argsort(all_starts, kind="stable")
    all_values = np.concatenate((values.reshape(2, -1, NODES)[:, whole], new.reshape(2, -1, NODES)), axis=1)
    return all_starts[order], np.concatenate((width[whole], new_width))[order], all_values[:, order].reshape(2, -1)


def powers(r: np.ndarray, count: int = NODES) -> np.ndarray:
    """1, r, r², ... (count, n)."""
    out = np.empty((count, r.size))
    out[0] = 1.0
    for k in range(1, count):
        np.multiply(out[k - 1], r, out=out[k])
    return out


BLOCK = 4096  # angles at a time: ten numbers an angle


def by_blocks(value: Callable[[np.ndarray], np.ndarray], theta: np.ndarray) -> np.ndarray:
    """A function of cam angles (n,) taken a block at a time, so that few numbers are held at once."""
    out = np.empty(theta.size)
    for part in range(0, theta.size, BLOCK):
        out[part : part + BLOCK] = value(theta[part : part + BLOCK])
    return out


def placed(start: np.ndarray, width: np.ndarray, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The panel of each angle (n,) and where in it the angle lies, r (n,)."""
    at = np.clip(np.searchsorted(start, theta, side="right") - 1, 0, None)
    return at, (theta - start[at]) / width[at]
