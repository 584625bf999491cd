"""The chart of stability as plain data: whoever draws it needs nothing else."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.stability.coefficients import LOAD_SLOPE, Coefficients
from core.stability.critical_speeds import Machine
from core.stability.equations import APPROXIMATE, EXACT
from core.stability.floquet_edges import tongues
from core.stability.tongues import ERROR, Tongues

ROWS = 64
ETA_MAX = 5.6
MOST_Q = 0.12  # of the chart of a machine of small Q (Kim1990 Fig. 8 goes to 0.1)
ROOM = 1.6  # above the machine's own Q


@dataclass(frozen=True, eq=False)
class Chart:
    """Tongues over a range of Q, as edges.

    name         of the design
    q            (rows,) rising
    tongues      equation -> its tongues in all rows; edges (rows, n, 2), nan where damping has closed them
    eta_max      the η axis goes from 0 to here
    machine      None where the chart belongs to no machine; else its operating point is (``machine.eta``, ``machine.q``)
                 and it runs up along Q = ``machine.q`` from η = ∞
    marked       rows of Q that were asked for by name
    """

    name: str
    q: np.ndarray
    tongues: dict[str, Tongues]
    eta_max: float
    machine: Machine | None
    marked: tuple[float, ...] = ()

    def outline(self, n: int, equation: str = EXACT) -> list[np.ndarray]:
        """Tongue n as closed polygons (k, 2) of (η, Q), one for each stretch of Q in which it is open; without damping the
        first starts at its tip, η = n/2 at Q = 0."""
        edges = self.tongues[equation].edges[:, n - 1]
        open_rows = np.isfinite(edges).all(axis=1)
        runs = np.split(np.arange(self.q.size), np.flatnonzero(np.diff(open_rows.astype(int))) + 1)
        drawn = []
        for run in runs:
            if not open_rows[run[0]]:
                continue
            left = np.column_stack((edges[run, 0], self.q[run]))
            right = np.column_stack((edges[run, 1], self.q[run]))[::-1]
            parts = [left, right]
            if run[0] == 0 and self.tongues[equation].damping == 0.0:
                parts.insert(0, np.array([[0.5 * n, 0.0]]))
            drawn.append(np.concatenate(parts))
        return drawn


def count_up_to(eta_max: float) -> int:
    """How many tongues may reach below an η: one at each half, and one more whose lower edge may."""
    return max(1, int(np.floor(2.0 * eta_max + 1e-9)))


def _top(coefficients: Coefficients, machine: Machine | None, marked: Sequence[float]) -> float:
    """How far the chart goes in Q: above the machine and the marked rows, but no farther than these where a fixed load
    would be stiffer than the shaft, 1 + Qψ1 < 0."""
    asked = (machine.q,) if machine is not None else ()
    top = max((MOST_Q, *(ROOM * q for q in asked), *(1.1 * q for q in marked)))
    softest = -float(coefficients.panels.values[LOAD_SLOPE].min()) if coefficients.fixed else 0.0
    return min(top, max((1.0 / softest, *asked, *marked))) if softest > 0.0 else top


def chart(
    coefficients: Coefficients,
    machine: Machine | None,
    name: str = "",
    q: Sequence[float] | np.ndarray | None = None,
    eta_max: float = ETA_MAX,
    rows: int = ROWS,
    damping: float = 0.0,
    equations: Sequence[str] = (EXACT, APPROXIMATE),
    marked: Sequence[float] = (),
    error: float = ERROR,
) -> Chart:
    """The chart of a machine; by default ``rows`` of Q from 0 to well above the machine's own.

    A coarse one (few rows, a large ``error`` of the edges η) comes at once.
    """
    if q is None:
        q = _top(coefficients, machine, marked) * np.arange(1, rows + 1) / rows
    rising = np.sort(np.asarray(q, dtype=float))
    count = count_up_to(eta_max)
    found = {equation: tongues(coefficients, rising, count, equation, damping, error) for equation in equations}
    return Chart(name, rising, found, eta_max, machine, tuple(marked))
