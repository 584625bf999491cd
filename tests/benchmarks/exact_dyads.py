"""Fifty-digit values of a four-bar: two circles that meet, as power series of the crank angle."""

from __future__ import annotations

from typing import Any

from references import MP, Series, exp, sqrt

LENGTHS = (100.0, 30.0, 90.0, 70.0)  # ground, crank, coupler, rocker [mm]
ANGLES = tuple(0.0173 + 0.2617 * k for k in range(24))


def joint(lengths: tuple[Any, ...], theta: Any) -> list[Any]:
    """B with velocity and acceleration, left of the line from A to O4, for a crank that turns by 1 rad/s."""
    ground, crank, coupler, rocker = (MP.convert(v) for v in lengths)
    i = MP.mpc(0, 1)
    turned: Series = exp(Series.variable(MP.convert(theta)) * Series([i, 0, 0, 0]))
    a = crank * turned
    d = ground - a
    square = (d * d.conjugate()).real
    along = (square + (coupler**2 - rocker**2)) / (2 * square)
    across = sqrt(coupler**2 / square - along * along)
    b = a + d * (along + across * Series([i, 0, 0, 0]))
    return [b.derivative(k) for k in range(3)]


def dyad_values(step: Any) -> tuple[list[float], list[list[Any]], float, list[float]]:
    """Where; values by place and channel; what a relative change of every length and of the angle does at worst; scales."""
    values = [joint(LENGTHS, t) for t in ANGLES]
    scale = [float(max(abs(v) for v in channel)) for channel in zip(*values, strict=True)]
    worst = 0.0
    for theta, exact in zip(ANGLES, values, strict=True):
        moved = [joint(LENGTHS, MP.mpf(theta) * (1 + step))]
        for k, length in enumerate(LENGTHS):
            longer = MP.mpf(length) * (1 + step)
            moved.append(joint((*LENGTHS[:k], longer, *LENGTHS[k + 1 :]), theta))
        for i, size in enumerate(scale):
            worst = max(worst, float(MP.fsum(abs(m[i] - exact[i]) for m in moved) / step) / size)
    return list(ANGLES), values, worst, scale
