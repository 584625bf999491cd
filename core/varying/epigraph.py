"""The least of the largest of several functions, below bounds of others: the solver's wrapper."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

MOST_STEPS = 30  # of SLSQP in a round


def epigraph(
    rows: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]], bound: np.ndarray, scale: np.ndarray, start: np.ndarray,
    low: np.ndarray, high: np.ndarray, inset: float = 0.0,
) -> np.ndarray:  # fmt: skip
    """The place (k,) between low and high where the largest of the functions without a bound is least, while the others are below theirs:
    minimise t subject to t - f_j(x) >= 0 and b_j - f_j(x) >= 0, by SLSQP.

    rows: place -> values (c,) and slopes (c, k); bound (c,): NaN of those that are minimised; scale (c,): of each bound; inset: of its
    scale, how far below its bound each is to be. The start where nothing can be computed there, or at the end.
    """
    from scipy.optimize import minimize

    k, of_goal = start.size, np.isnan(bound)
    memory: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}

    def known(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        key = z[:k].tobytes()
        if key not in memory:
            memory[key] = rows(z[:k])
        return memory[key]

    value, slope = known(start)
    if not np.isfinite(value).all():
        return start
    size = max(float(np.abs(value[of_goal]).max()), float(np.abs(slope[of_goal] * (high - low)).max())) or 1.0
    scale = np.where(of_goal, size, scale)

    def constraints(z: np.ndarray) -> np.ndarray:
        value, _ = known(z)
        room = np.where(of_goal, z[k] - value / scale, (bound - value) / scale - inset)
        return np.where(np.isfinite(room), room, -1e2)

    def jacobian(z: np.ndarray) -> np.ndarray:
        made = np.hstack([-known(z)[1] / scale[:, None], of_goal[:, None].astype(float)])
        return np.where(np.isfinite(made), made, 0.0)

    t, gradient = float((value / scale)[of_goal].max()), np.append(np.zeros(k), 1.0)
    found = minimize(
        lambda z: float(z[k]), np.append(start, t), jac=lambda z: gradient, method="SLSQP",
        bounds=[*zip(low, high, strict=True), (None, None)],
        constraints=[{"type": "ineq", "fun": constraints, "jac": jacobian}], options={"maxiter": MOST_STEPS, "ftol": 1e-13},
    )  # fmt: skip
    new = np.clip(found.x[:k], low, high)
    return new if np.isfinite(new).all() and np.isfinite(known(new)[0]).all() else start
