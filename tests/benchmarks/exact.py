"""Fifty-digit values that the benchmark measures errors against, and how well conditioned they are.

    .venv/bin/python tests/benchmarks/exact.py

writes exact.json anew, which takes some minutes. Values stand there as sums of two floats, so that an error far below
one rounding can be told; ``condition`` is what one rounding of every number that goes in does to the values at worst, in
eps and relative to the scale of each channel.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

if __name__ == "__main__":
    sys.path[:0] = [str(Path(__file__).parents[1]), str(Path(__file__).parents[2])]

import itertools

from benchmarks.exact_dyads import dyad_values
from benchmarks.exact_shafts import OF_SHAFTS
from mechanisms import LIFT, with_shaft
from references import (
    LAW_TERMS,
    MP,
    Series,
    cam_shape,
    free_bodies,
    joins_of,
    law,
    law_joins,
    masses,
    motion_series,
    placed,
)

from core.design import Design, entries, get, put
from core.motion import Program

FILE = Path(__file__).with_name("exact.json")
LAW = "modified-sine"
FITTED = with_shaft(LIFT, flywheel_inertia_kg_m2=2000.0, motor_slope_nm_s_per_rad=3000.0)
"""The lift with a flywheel that levels some of its torque; its speed changes by half."""
SHARES = (0.11373, 0.52719, 0.93131)  # of each piece of the motion: on no table's knots
STEP = MP.mpf(10) ** -20

Figures = Callable[[Design, Any, int], Sequence[Any]]


@dataclass(frozen=True)
class Exact:
    """Values of one kernel: where (m,), what (c, m) as high + low, how large each channel gets (c,), how much of it one
    rounding of all that goes in can move."""

    at: np.ndarray
    high: np.ndarray
    low: np.ndarray
    scale: np.ndarray
    condition: float

    def error(self, told: Sequence[np.ndarray]) -> float:
        """The largest error of channels (c, m), relative to the channel's scale; inf where a value is none."""
        worst = 0.0
        for values, high, low, scale in zip(told, self.high, self.low, self.scale, strict=True):
            off = np.abs((np.asarray(values) - high) - low) / scale
            worst = max(worst, float(off.max()) if np.isfinite(off).all() else math.inf)
        return worst


@cache
def exact(kernel: str) -> Exact:
    rows = json.loads(FILE.read_text(encoding="utf-8"))[kernel]
    high, low = (np.array(rows[name]) for name in ("high", "low"))
    if high.ndim == 3:  # real and imaginary part
        high, low = high[..., 0] + 1j * high[..., 1], low[..., 0] + 1j * low[..., 1]
    return Exact(np.array(rows["at"]), high, low, np.array(rows["scale"]), rows["condition"])


# -- how the values are made ------------------------------------------------------------------------------


def angles() -> list[float]:
    """Cam angles [rad] inside every piece of the lift's motion."""
    compiled = Program(LIFT.drive.motion)
    return [float(a + s * (b - a)) for a, b in zip(compiled.starts, compiled.ends, strict=True) for s in SHARES]


def _segment(theta: Any) -> int:
    joins = joins_of(LIFT.drive.motion)
    return max(i for i, j in enumerate(joins[:-1]) if theta >= j)


def _way(segment: int) -> int:
    rise = LIFT.drive.motion.segments[segment].rise
    return (rise > 0) - (rise < 0)


def linkage(design: Design, there: Any, way: int) -> list[Any]:
    """Arm pin and roller centre with velocity and acceleration, and the rod's direction."""
    rod = there.points["slider_pin"].c[0] - there.points["arm_pin"].c[0]
    return [*(there.points[name].derivative(k) for name in ("arm_pin", "roller") for k in range(3)), rod / abs(rod)]


def profile(design: Design, there: Any, way: int) -> list[Any]:
    shape = cam_shape(design, there)
    return [shape.profile, shape.pressure_angle + 0j]


def curvature(design: Design, there: Any, way: int) -> list[Any]:
    return [cam_shape(design, there).curvature.c[0] + 0j]


def torque(design: Design, there: Any, way: int) -> list[Any]:
    told = free_bodies(design, there, way)
    return [told["contact"] + 0j, told["torque"] + 0j]


ALONG_THE_TURN: dict[str, tuple[Figures, tuple[str, ...]]] = {
    "linkage": (linkage, ("follower", "cam")),
    "profile": (profile, ("follower", "cam")),
    "curvature": (curvature, ("follower", "cam")),
    "torque": (torque, ("follower", "cam", "shaft", "loads")),
}


def _sizes(theta: float, segment: int) -> list[float]:
    """How large the terms are that y and its derivatives are made of [SI per radian]: what their roundings act on."""
    motion = LIFT.drive.motion
    part = motion.segments[segment]
    terms, span = LAW_TERMS[part.curve.law], math.radians(part.span_deg)
    rise = abs(part.rise) * motion.scale
    sizes = [rise / span**k * (terms[k] + theta / span * terms[k + 1]) for k in range(4)]
    sizes[0] += motion.scale * (abs(motion.start) + sum(abs(s.rise) for s in motion.segments[: segment + 1]))
    return sizes


def with_weights(figures: Figures, sections: Sequence[str], theta: float) -> tuple[list[Any], list[float]]:
    """Values at one angle, and for each the sum of |weight d/dp| over all numbers: design, cam angle, motion."""
    segment = _segment(theta)
    way, sizes = _way(segment), _sizes(theta, segment)
    y = motion_series(LIFT.drive.motion, theta, segment).derivatives
    paths = [e.path for section in sections for e in entries(LIFT, section) if not e.info.choices]

    def values(design: Design, at: Any, series: list[Any]) -> Sequence[Any]:
        made = Series([d / MP.factorial(k) for k, d in enumerate(series)])
        return figures(design, placed(design, at, made), way)

    exact_values = list(values(LIFT, MP.mpf(theta), y))
    moved = [values(LIFT, MP.mpf(theta) * (1 + STEP), y)]
    for k, size in enumerate(sizes):
        if size:
            moved.append(values(LIFT, MP.mpf(theta), [*y[:k], y[k] + size * STEP, *y[k + 1 :]]))
    for path in paths:
        number = MP.convert(get(LIFT, path))
        if number:
            moved.append(values(put(LIFT, path, number * (1 + STEP)), MP.mpf(theta), y))
    return exact_values, [float(MP.fsum(abs(m[i] - v) for m in moved) / STEP) for i, v in enumerate(exact_values)]


def _pair(value: Any) -> tuple[list[float], list[float]]:
    parts = [MP.re(value), MP.im(value)]
    high = [float(p) for p in parts]
    return high, [float(p - h) for p, h in zip(parts, high, strict=True)]


def _rows(at: Sequence[float], values: Sequence[Sequence[Any]], condition: float, scale: list[float]) -> dict[str, Any]:
    """values (m, c)."""
    pairs = [[_pair(v) for v in channel] for channel in zip(*values, strict=True)]
    return {
        "at": list(at),
        "high": [[p[0] for p in channel] for channel in pairs],
        "low": [[p[1] for p in channel] for channel in pairs],
        "scale": scale,
        "condition": condition,
    }


def _along_the_turn(name: str) -> dict[str, Any]:
    figures, sections = ALONG_THE_TURN[name]
    told = [with_weights(figures, sections, theta) for theta in angles()]
    values = [t[0] for t in told]
    scale = [float(max(abs(v) for v in channel)) for channel in zip(*values, strict=True)]
    condition = max(reach / s for t in told for reach, s in zip(t[1], scale, strict=True))
    return _rows(angles(), values, condition, scale)


def _law() -> dict[str, Any]:
    joins = [float(j) for j in law_joins(LAW)]
    at = [a + s * (b - a) for a, b in itertools.pairwise(joins) for s in (0.0213, *SHARES, 0.9917)]
    values = [[v + 0j for v in law(LAW, u)[:3]] for u in at]
    scale = [float(max(abs(v) for v in channel)) for channel in zip(*values, strict=True)]
    condition = max(terms / s for terms, s in zip(LAW_TERMS[LAW], scale, strict=False))
    return _rows(at, values, condition, scale)


def _blending() -> dict[str, Any]:
    """Yang's card picker: C1-CV1-H2-P2 over 300 deg, 20 mm up, h1 = h3 = 1. With V the slope of the constant velocity the
    spans are 2h1/V, h2/V, (π/2)h3/V; H2 ends and P2 begins with one acceleration, (π²/4)h3/β3² = (216/41)h/β4²."""
    h, h1, h3 = MP.mpf(20), MP.mpf(1), MP.mpf(1)
    widths = [2 * h1, h - h1 - h3, MP.pi / 2 * h3, MP.sqrt(MP.mpf(216) / 41 * h * h3)]
    speed = MP.fsum(widths) / 300
    values = [[w / speed + 0j for w in widths] + [speed + 0j]]
    # sums and quotients of positive numbers: each as good as its parts, of which there are five
    return _rows([0.0], values, 5.0, [float(abs(v)) for v in values[0]])


def _gauss(count: int) -> list[tuple[Any, Any]]:
    """Nodes and weights of Gauss and Legendre, refined by Newton's method."""
    found = []
    for near in np.polynomial.legendre.leggauss(count)[0]:
        x = MP.mpf(near)
        for _ in range(3):
            value, before = MP.legendre(count, x), MP.legendre(count - 1, x)
            slope = count * (before - x * value) / (1 - x * x)
            x -= value / slope
        found.append((x, 2 / ((1 - x * x) * slope**2)))
    return found


def _integrals(nodes: Sequence[tuple[Any, Any]]) -> Any:
    """Integrals from -1 to each of Gauss's nodes, of the polynomial through values at them: a matrix."""
    count, made = len(nodes), MP.zeros(len(nodes), len(nodes))
    values = [[MP.legendre(n, x) for x, _ in nodes] for n in range(count + 1)]
    for i, (x, _) in enumerate(nodes):
        for n in range(count):
            reach = x + 1 if n == 0 else (values[n + 1][i] - values[n - 1][i]) / (2 * n + 1)
            for j, (_, w) in enumerate(nodes):
                made[i, j] += MP.mpf(2 * n + 1) / 2 * w * values[n][j] * reach
    return made


def _flywheel() -> dict[str, Any]:
    """d/dθ ½(I + J)ω² = T̄ + k(ω̄ - ω) - T_s over the turn, T_s = T_c - ½ω̄²J', for e = ½(I + J)(ω² - ω̄²): collocation at
    Gauss's nodes, piece by piece, closed so that it comes back to where it began, by Newton's method."""
    compiled = Program(FITTED.drive.motion)
    shaft = FITTED.shaft
    omega = MP.convert(shaft.speed_rpm) * 2 * MP.pi / 60
    slope, flywheel = MP.convert(shaft.motor_slope_nm_s_per_rad), MP.convert(shaft.flywheel_inertia_kg_m2)
    spots = [
        float(s * (b - a) + a) for a, b in zip(compiled.starts, compiled.ends, strict=True) for s in (0.31373, 0.81931)
    ]
    joins = sorted({*map(float, compiled.starts), *spots, 2.0 * math.pi})
    nodes = _gauss(30)
    within = _integrals(nodes)

    @cache
    def load(theta: Any) -> tuple[Any, Any]:
        segment = _segment(theta)
        there = placed(FITTED, theta, motion_series(FITTED.drive.motion, theta, segment))
        worth = MP.fsum(
            m.mass * abs(m.centre.derivative(1)) ** 2 + m.inertia * m.angle.derivative(1) ** 2
            for m in masses(FITTED, there).values()
        )
        return free_bodies(FITTED, there, _way(segment))["torque"], flywheel + worth

    stretches = []
    for a, b in itertools.pairwise(joins):
        half, middle = (MP.mpf(b) - a) / 2, (MP.mpf(a) + b) / 2
        stretches.append((half, [load(middle + half * x) for x, _ in nodes]))
    mean = MP.fsum(h * w * t for h, row in stretches for (_, w), (t, _) in zip(nodes, row, strict=True)) / (2 * MP.pi)
    energies = [[MP.zero] * len(nodes) for _ in stretches]

    def above(e: Any, worth: Any) -> Any:
        """ω - ω̄."""
        return 2 * e / worth / (omega + MP.sqrt(omega**2 + 2 * e / worth))

    for _ in range(9):
        maps = []  # e at nodes and end as p·begin + q
        for (half, row), known in zip(stretches, energies, strict=True):
            rates = [slope / (worth * (omega + above(e, worth))) for e, (_, worth) in zip(known, row, strict=True)]
            free = [
                c * e - slope * above(e, worth) - (t - mean) for c, e, (t, worth) in zip(rates, known, row, strict=True)
            ]
            matrix = MP.eye(len(nodes)) + half * within * MP.diag(rates)
            p = MP.lu_solve(matrix, MP.ones(len(nodes), 1))
            q = MP.lu_solve(matrix, half * within * MP.matrix(free))
            ends = [
                MP.fsum(half * w * (f - c * v) for (_, w), f, c, v in zip(nodes, given, rates, values, strict=True))
                for given, values in (([0] * len(nodes), p), (free, q))
            ]
            maps.append((list(p), list(q), 1 + ends[0], ends[1]))
        whole, gained = MP.one, MP.zero
        for _, _, kept, more in maps:
            whole, gained = whole * kept, gained * kept + more
        begins = [gained / (1 - whole)]
        for _, _, kept, more in maps:
            begins.append(begins[-1] * kept + more)
        energies = [
            [b * x + y for x, y in zip(p, q, strict=True)] for b, (p, q, _, _) in zip(begins, maps, strict=False)
        ]
    at_joins = dict(zip(joins, begins, strict=True))
    values = [[mean - slope * above(at_joins[s], load(MP.mpf(s))[1]) + 0j] for s in spots]
    peak = max(abs(t) for _, row in stretches for t, _ in row)
    torque_condition = json.loads(FILE.read_text(encoding="utf-8"))["torque"]["condition"]
    return _rows(spots, values, torque_condition, [float(peak)])


MADE: dict[str, Callable[[], dict[str, Any]]] = {
    "law": _law,
    "blending": _blending,
    **{name: (lambda n=name: _along_the_turn(n)) for name in ALONG_THE_TURN},
    "flywheel": _flywheel,
    "dyads": lambda: _rows(*dyad_values(STEP)),
    **{name: (lambda made=made: _rows(*made())) for name, made in OF_SHAFTS.items()},
}


def main(words: list[str]) -> int:
    """Make the named kernels' values anew, or all."""
    rows = json.loads(FILE.read_text(encoding="utf-8")) if FILE.exists() else {}
    for name in words or MADE:
        rows[name] = MADE[name]()
        print(f"{name}: {len(rows[name]['at'])} places, condition {rows[name]['condition']:.3g}", flush=True)
        FILE.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
