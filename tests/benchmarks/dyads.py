"""General linkages dyad by dyad: joint B of a crank-rocker, with velocity and acceleration, at any crank angles."""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
from benchmarks.exact import LENGTHS
from benchmarks.plain import (
    FEW,
    by_table,
    hermite,
    knots,
    turn,
)
from benchmarks.table import Channels, Kernel, Method
from linkages import four_bar

from core.mechanism import at_driver, driver_ranges_of
from core.motion import TURN

GROUND, CRANK, COUPLER, ROCKER = LENGTHS


def given(theta: np.ndarray) -> SimpleNamespace:
    return SimpleNamespace(theta=theta, mechanism=four_bar(*LENGTHS).drive.mechanism)


def _on_rocker(turned: np.ndarray, speed: Any, gain: Any) -> Channels:
    """B from the rocker's unit vector (n,), angular velocity and acceleration."""
    u = ROCKER * turned
    return [GROUND + u, 1j * speed * u, (1j * gain - speed * speed) * u]


def ours(there: Any, setting: None) -> Channels:
    """Joint B of the rocker, as any view asks for it."""
    pose = driver_ranges_of(there.mechanism).solve(at_driver(there.theta)).poses[4]
    return _on_rocker(pose.unit, pose.turn[1], pose.turn[2])


@np.errstate(invalid="ignore", divide="ignore")
def by_hand(there: Any, setting: None) -> Channels:
    """Two circles that meet; the loop equation's two derivatives by unit vectors of coupler and rocker."""
    a = np.empty(there.theta.shape, dtype=complex)
    a.real, a.imag = CRANK * np.cos(there.theta), CRANK * np.sin(there.theta)
    d = GROUND - a
    square = d.real * d.real + d.imag * d.imag
    along = (0.5 * (COUPLER**2 - ROCKER**2)) / square + 0.5
    arm = np.empty_like(a)  # the coupler
    arm.real, arm.imag = along, np.sqrt(COUPLER**2 / square - along * along)
    arm *= d
    rocker = arm - d
    across = arm.real * rocker.imag - arm.imag * rocker.real
    coupler_speed = (rocker.real * a.imag - rocker.imag * a.real) / across
    speed = (arm.real * a.imag - arm.imag * a.real) / across
    # what the acceleration is along the coupler
    gain = (a.real * arm.real + a.imag * arm.imag) + coupler_speed * coupler_speed * COUPLER**2
    gain -= speed * speed * (rocker.real * arm.real + rocker.imag * arm.imag)
    turning = np.empty_like(a)
    turning.real, turning.imag = -speed * speed, gain / across
    return [GROUND + rocker, 1j * speed * rocker, turning * rocker]


def joint(theta: np.ndarray) -> np.ndarray:
    """Where the circles about A and O4 meet, left of the line between them [mm]."""
    a = CRANK * np.exp(1j * theta)
    d = GROUND - a
    square = np.abs(d) ** 2
    along = (square + COUPLER**2 - ROCKER**2) / (2.0 * square)
    return np.asarray(a + d * (along + 1j * np.sqrt(COUPLER**2 / square - along**2)))


def quintic(there: Any, points: int) -> Any:
    at = knots(points)
    return hermite(at, *by_hand(SimpleNamespace(theta=at), None))


def fourier(there: Any, points: int) -> Any:
    """Harmonics of the joint, which a crank that turns round has."""
    numbers = np.fft.fftfreq(points, 1.0 / points)
    c = np.fft.fft(joint(turn(points))) / points
    return numbers, c


def by_transform(there: Any, kept: Any) -> Channels:
    """The same on an even grid over the turn, by inverse transforms of as many places."""
    numbers, c = kept
    theta, n = there.theta, there.theta.size
    first = c * np.exp(1j * numbers * theta[0])
    wide = np.zeros((3, n), dtype=complex)
    where = numbers.astype(int)
    wide[:, where] = n * np.stack((first, 1j * numbers * first, -numbers * numbers * first))
    return list(np.fft.ifft(wide))


# -- other packages that solve planar linkages ------------------------------------------------------------


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


def _mechanism() -> tuple[Any, Any, Any]:
    import os

    os.environ.setdefault("MPLBACKEND", "Agg")
    from mechanism import Joint, Mechanism, Vector

    return Joint, Mechanism, Vector


def by_mechanism(there: Any, setting: None) -> Channels:
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


KERNEL = Kernel(
    "dyads",
    "General linkage by dyads: a four-bar",
    given=given,
    grid=turn,
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("numpy by hand", by_hand, special=True),
        *by_table(lambda at: by_hand(SimpleNamespace(theta=at), None)),
        Method("quintic table", lambda there, table: table.at(there.theta, 0, 1, 2), FEW, "points", keeps=quintic),
        Method("harmonics (FFT)", by_transform, (64, 32, 40, 48, 56), "points", keeps=fourier, on_grid=True),
        Method("pylinkage, numba", pylinkage_four_bar, needs=("pylinkage", "numba")),
        Method("mechanism", by_mechanism, needs=("mechanism", "matplotlib"), one_by_one=True),
    ),
    handed="crank angles, lengths, and on which side the joint lies",
    warm="tables and harmonics; what KINDYNA knows of the linkage and its order of solution",
)
