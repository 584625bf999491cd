"""Other packages that solve planar linkages, set to the lift. Nothing else of KINDYNA uses them."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from benchmarks.plain import BETA0, L0, PHI0, PIVOT, G
from benchmarks.table import Channels


@cache
def _walk(compiled: bool) -> Callable[..., None]:
    """A loop over the cam angles that calls pylinkage's own solvers: arm pin between pivot and slider pin, roller
    fixed to the arm, positions, velocities, accelerations."""
    from pylinkage.solver import acceleration, joints, velocity

    names = (
        (joints, ("solve_revolute", "solve_fixed")),
        (velocity, ("solve_revolute_velocity", "solve_fixed_velocity")),
        (acceleration, ("solve_revolute_acceleration", "solve_fixed_acceleration")),
    )
    found = [getattr(module, name) for module, group in names for name in group]
    if not compiled:
        found = [getattr(f, "py_func", f) for f in found]
    pin, fixed, pin_speed, fixed_speed, pin_gain, fixed_gain = found

    def walk(px, py, l1, l2, arm, ahead, a, v, c, bx, by, out):  # type: ignore[no-untyped-def]
        for i in range(a.shape[0]):
            ax, ay, vx, vy, cx, cy = a[i].real, a[i].imag, v[i].real, v[i].imag, c[i].real, c[i].imag
            bx, by = pin(bx, by, px, py, l1, ax, ay, l2)
            ux, uy = pin_speed(bx, by, px, py, 0.0, 0.0, ax, ay, vx, vy)
            wx, wy = pin_gain(bx, by, ux, uy, px, py, 0.0, 0.0, 0.0, 0.0, ax, ay, vx, vy, cx, cy)
            rx, ry = fixed(px, py, bx, by, arm, ahead)
            sx, sy = fixed_speed(rx, ry, px, py, 0.0, 0.0, bx, by, ux, uy, arm, ahead)
            tx, ty = fixed_gain(rx, ry, sx, sy, px, py, 0.0, 0.0, 0.0, 0.0, bx, by, ux, uy, wx, wy, arm, ahead)
            out[0, i], out[1, i], out[2, i] = complex(bx, by), complex(ux, uy), complex(wx, wy)
            out[3, i], out[4, i], out[5, i] = complex(rx, ry), complex(sx, sy), complex(tx, ty)

    if not compiled:
        return walk
    from numba import njit

    return njit(walk)


def _solve(there: Any, compiled: bool) -> Channels:
    slider = L0 + there.motion.y[0]
    pin_a = PIVOT + slider + 1j * G.guide_height
    start = PIVOT + G.slider_arm * complex(math.cos(PHI0), math.sin(PHI0))
    out = np.empty((6, slider.size), dtype=complex)
    speed, gain = there.motion.y[1].astype(complex), there.motion.y[2].astype(complex)
    _walk(compiled)(
        PIVOT.real, PIVOT.imag, G.slider_arm, G.rod, G.roller_arm, G.fixed_angle, pin_a, speed, gain, start.real,
        start.imag, out,
    )  # fmt: skip
    return [*out, (pin_a - out[0]) / G.rod]


def pylinkage(there: Any, setting: None) -> Channels:
    return _solve(there, True)


def pylinkage_plain(there: Any, setting: None) -> Channels:
    """Without the compiler, which is what its plain installation brings."""
    return _solve(there, False)


def mechanism(there: Any, setting: None) -> Channels:
    """Vectors around the loop, solved angle by angle with fsolve by the package."""
    import os

    os.environ.setdefault("MPLBACKEND", "Agg")
    from mechanism import Joint, Mechanism, Vector

    p, s, a, b = (Joint(name) for name in "PSAB")
    along = Vector((p, s), theta=0.0)  # from the pivot along the guide, as long as the slider is away
    up = Vector((s, a), r=G.guide_height, theta=math.pi / 2)
    arm, rod = Vector((p, b), r=G.slider_arm), Vector((b, a), r=G.rod)

    def loops(x: np.ndarray, slider: float) -> np.ndarray:
        return np.asarray(arm(x[0]) + rod(x[1]) - up() - along(slider)).flatten()

    y = there.motion.y
    solved = Mechanism(
        vectors=(along, up, arm, rod), origin=p, loops=loops,
        pos=L0 + y[0], vel=y[1].copy(), acc=y[2].copy(),
        guess=(np.array([PHI0, BETA0]), np.zeros(2), np.zeros(2)),
    )  # fmt: skip
    solved.iterate()
    pin = b.x_positions + 1j * b.y_positions
    speed, gain = b.x_velocities + 1j * b.y_velocities, b.x_accelerations + 1j * b.y_accelerations
    ahead = (G.roller_arm / G.slider_arm) * np.exp(1j * G.fixed_angle)
    direction = (a.x_positions + 1j * a.y_positions - pin) / G.rod
    return [PIVOT + pin, speed, gain, PIVOT + pin * ahead, speed * ahead, gain * ahead, direction]
