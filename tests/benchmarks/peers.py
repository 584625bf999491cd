"""Other packages that solve planar linkages, set to the lift and to a four-bar. Nothing else of KINDYNA uses them."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from benchmarks.exact_dyads import LENGTHS
from benchmarks.plain import BETA0, L0, PHI0, PIVOT, G
from benchmarks.table import Channels

from core.motion import TURN


def _solvers(compiled: bool) -> list[Any]:
    """pylinkage's own of a pin between two pins and of a point fixed to a link: positions, velocities, accelerations."""
    from pylinkage.solver import acceleration, joints, velocity

    names = (
        (joints, ("solve_revolute", "solve_fixed")),
        (velocity, ("solve_revolute_velocity", "solve_fixed_velocity")),
        (acceleration, ("solve_revolute_acceleration", "solve_fixed_acceleration")),
    )
    found = [getattr(module, name) for module, group in names for name in group]
    return found if compiled else [getattr(f, "py_func", f) for f in found]


def _jitted(walk: Callable[..., None], compiled: bool) -> Callable[..., None]:
    if not compiled:
        return walk
    from numba import njit

    return njit(walk)


Rows = tuple[Any, ...]


def _rows(count: int, n: int, compiled: bool) -> Rows:
    """What a loop writes into: Python is quickest with lists, compiled code with arrays."""
    return tuple(np.empty((count, n), dtype=complex)) if compiled else tuple([0j] * n for _ in range(count))


def _read(array: np.ndarray, compiled: bool) -> Any:
    """What a loop reads."""
    return array if compiled else array.tolist()


@cache
def _walk(compiled: bool) -> Callable[..., None]:
    """A loop over the cam angles: arm pin between pivot and slider pin, roller fixed to the arm."""
    pin, fixed, pin_speed, fixed_speed, pin_gain, fixed_gain = _solvers(compiled)

    def walk(px, py, l1, l2, arm, ahead, a, v, c, bx, by, out):  # type: ignore[no-untyped-def]
        o0, o1, o2, o3, o4, o5 = out
        for i in range(len(a)):
            ax, ay, vx, vy, cx, cy = a[i].real, a[i].imag, v[i].real, v[i].imag, c[i].real, c[i].imag
            bx, by = pin(bx, by, px, py, l1, ax, ay, l2)
            ux, uy = pin_speed(bx, by, px, py, 0.0, 0.0, ax, ay, vx, vy)
            wx, wy = pin_gain(bx, by, ux, uy, px, py, 0.0, 0.0, 0.0, 0.0, ax, ay, vx, vy, cx, cy)
            rx, ry = fixed(px, py, bx, by, arm, ahead)
            sx, sy = fixed_speed(rx, ry, px, py, 0.0, 0.0, bx, by, ux, uy, arm, ahead)
            tx, ty = fixed_gain(rx, ry, sx, sy, px, py, 0.0, 0.0, 0.0, 0.0, bx, by, ux, uy, wx, wy, arm, ahead)
            o0[i], o1[i], o2[i] = complex(bx, by), complex(ux, uy), complex(wx, wy)
            o3[i], o4[i], o5[i] = complex(rx, ry), complex(sx, sy), complex(tx, ty)

    return _jitted(walk, compiled)


def _solve(there: Any, compiled: bool) -> Channels:
    slider = L0 + there.motion.y[0]
    pin_a = PIVOT + slider + 1j * G.guide_height
    start = PIVOT + G.slider_arm * complex(math.cos(PHI0), math.sin(PHI0))
    out = _rows(6, slider.size, compiled)
    read = [
        _read(row, compiled) for row in (pin_a, there.motion.y[1].astype(complex), there.motion.y[2].astype(complex))
    ]
    _walk(compiled)(
        PIVOT.real,
        PIVOT.imag,
        G.slider_arm,
        G.rod,
        G.roller_arm,
        G.fixed_angle,
        *read,
        start.real,
        start.imag,
        out,
    )
    told = [np.asarray(row) for row in out]
    return [*told, (pin_a - told[0]) / G.rod]


def pylinkage(there: Any, setting: None) -> Channels:
    return _solve(there, True)


def pylinkage_plain(there: Any, setting: None) -> Channels:
    """Without the compiler, which is what its plain installation brings."""
    return _solve(there, False)


def _mechanism() -> tuple[Any, Any, Any]:
    import os

    os.environ.setdefault("MPLBACKEND", "Agg")
    from mechanism import Joint, Mechanism, Vector

    return Joint, Mechanism, Vector


def mechanism(there: Any, setting: None) -> Channels:
    """Vectors around the loop, solved angle by angle with fsolve by the package."""
    Joint, Mechanism, Vector = _mechanism()
    p, s, a, b = (Joint(name) for name in "PSAB")
    along = Vector((p, s), theta=0.0)  # from the pivot along the guide, as long as the slider is away
    up = Vector((s, a), r=G.guide_height, theta=math.pi / 2)
    arm, rod = Vector((p, b), r=G.slider_arm), Vector((b, a), r=G.rod)

    def loops(x: np.ndarray, slider: float) -> np.ndarray:
        return np.asarray(arm(x[0]) + rod(x[1]) - up() - along(slider)).flatten()

    y = there.motion.y
    solved = Mechanism(
        vectors=(along, up, arm, rod),
        origin=p,
        loops=loops,
        pos=L0 + y[0],
        vel=y[1].copy(),
        acc=y[2].copy(),
        guess=(np.array([PHI0, BETA0]), np.zeros(2), np.zeros(2)),
    )
    solved.iterate()
    pin = b.x_positions + 1j * b.y_positions
    speed, gain = b.x_velocities + 1j * b.y_velocities, b.x_accelerations + 1j * b.y_accelerations
    ahead = (G.roller_arm / G.slider_arm) * np.exp(1j * G.fixed_angle)
    direction = (a.x_positions + 1j * a.y_positions - pin) / G.rod
    return [PIVOT + pin, speed, gain, PIVOT + pin * ahead, speed * ahead, gain * ahead, direction]


# -- a four-bar -------------------------------------------------------------------------------------------

GROUND, CRANK, COUPLER, ROCKER = LENGTHS


@cache
def _dyad_walk(compiled: bool) -> Callable[..., None]:
    """A loop over the crank angles: B between A and O4."""
    pin, _, pin_speed, _, pin_gain, _ = _solvers(compiled)

    def walk(a, v, c, ground, coupler, rocker, bx, by, out):  # type: ignore[no-untyped-def]
        o0, o1, o2 = out
        for i in range(len(a)):
            ax, ay, vx, vy, cx, cy = a[i].real, a[i].imag, v[i].real, v[i].imag, c[i].real, c[i].imag
            bx, by = pin(bx, by, ax, ay, coupler, ground, 0.0, rocker)
            ux, uy = pin_speed(bx, by, ax, ay, vx, vy, ground, 0.0, 0.0, 0.0)
            wx, wy = pin_gain(bx, by, ux, uy, ax, ay, vx, vy, cx, cy, ground, 0.0, 0.0, 0.0, 0.0, 0.0)
            o0[i], o1[i], o2[i] = complex(bx, by), complex(ux, uy), complex(wx, wy)

    return _jitted(walk, compiled)


def _dyad(there: Any, compiled: bool) -> Channels:
    out = _rows(3, there.theta.size, compiled)
    a = CRANK * np.exp(1j * there.theta)
    read = [_read(row, compiled) for row in (a, 1j * a, -a)]
    _dyad_walk(compiled)(*read, GROUND, COUPLER, ROCKER, 40.0, 60.0, out)
    return [np.asarray(row) for row in out]


@cache
def _four_bar_of_pylinkage(first: float, step: float) -> Any:
    """Its own model of the four-bar, compiled, whose crank comes to ``first`` with the first step."""
    from pylinkage import Crank, Ground, Linkage, RRRDyad

    o2, o4 = Ground(0.0, 0.0, name="O2"), Ground(GROUND, 0.0, name="O4")
    crank = Crank(anchor=o2, radius=CRANK, angular_velocity=step, initial_angle=first - step, name="A")
    pin = RRRDyad(anchor1=crank.output, anchor2=o4, distance1=COUPLER, distance2=ROCKER, name="B")
    made = Linkage(components=(o2, o4, crank, pin), name="four-bar")
    made.compile()
    made.set_input_velocity(crank, omega=1.0, alpha=0.0)
    return made, [tuple(component.position) for component in made.components]


def pylinkage_four_bar(there: Any, setting: None) -> Channels:
    """As the package is used: its model, stepped once round. It knows even steps only: at any other angles one by one."""
    theta, steps = there.theta, np.diff(there.theta)
    if not steps.size:
        steps = np.array([TURN / 360.0])
    made, start = _four_bar_of_pylinkage(float(theta[0]), float(steps[0]))
    if float(np.ptp(steps)) < 1e-9:
        made.set_coords(start)
        return [rows[:, -1, 0] + 1j * rows[:, -1, 1] for rows in made.step_fast_with_kinematics(theta.size)]
    found = []
    for before in (CRANK * np.exp(1j * (theta - steps[0]))).tolist():
        made.set_coords([*start[:2], (before.real, before.imag), start[3]])
        found.append([complex(*rows[0, -1]) for rows in made.step_fast_with_kinematics(1)])
        start = [*start[:3], (found[-1][0].real, found[-1][0].imag)]
    return list(np.array(found).T)


def dyad(there: Any, setting: None) -> Channels:
    return _dyad(there, True)


def dyad_plain(there: Any, setting: None) -> Channels:
    """Without the compiler."""
    return _dyad(there, False)


def four_bar(there: Any, setting: None) -> Channels:
    """The loop of its vectors, solved angle by angle by mechanism."""
    Joint, Mechanism, Vector = _mechanism()
    o2, a, b, o4 = (Joint(name) for name in ("O2", "A", "B", "O4"))
    crank, coupler, rocker = Vector((o2, a), r=CRANK), Vector((a, b), r=COUPLER), Vector((o4, b), r=ROCKER)
    ground = Vector((o2, o4), r=GROUND, theta=0.0, style="ground")
    n = there.theta.size

    def loops(x: Any, i: Any) -> Any:
        return crank(i) + coupler(x[0]) - rocker(x[1]) - ground()

    made = Mechanism(
        vectors=(crank, coupler, rocker, ground),
        origin=o2,
        loops=loops,
        pos=there.theta,
        vel=np.ones(n),
        acc=np.zeros(n),
        guess=(np.array([0.8, 1.4]), np.full(2, 0.1), np.full(2, 0.1)),
    )
    made.iterate()
    return [getattr(b, f"x_{k}") + 1j * getattr(b, f"y_{k}") for k in ("positions", "velocities", "accelerations")]
