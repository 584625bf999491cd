"""Positions, velocities and accelerations of one four-bar at 3600 crank angles: time and error, beside pylinkage and
mechanism where they are installed.

    .venv/bin/python tests/benchmarks/four_bar.py

Error: of joint B, the largest over 72 angles, relative to the largest value, against the intersection of two circles at
fifty digits.
"""

from __future__ import annotations

import importlib.util
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[1]))
    sys.path.insert(0, str(Path(__file__).parents[2]))

from references import MP, Series, sqrt

SAMPLES, CHECKED = 3600, 72
GROUND, CRANK, COUPLER, ROCKER = 100.0, 30.0, 90.0, 70.0
Motion = tuple[np.ndarray, np.ndarray, np.ndarray]
"""B (n,) complex [mm], its velocity and acceleration for a crank of 1 rad/s."""


def exact(theta: float) -> tuple[complex, complex, complex]:
    """By circles around A and O4, left of the line from A to O4, as power series of the crank angle."""
    angle = Series.variable(MP.mpf(theta))
    turned = _unit(angle)
    a = CRANK * turned
    d = GROUND - a
    square = (d * d.conjugate()).real
    along = (square + (COUPLER**2 - ROCKER**2)) / (2 * square)
    across = sqrt(COUPLER**2 / square - along * along)
    b = a + d * (along + across * Series([MP.mpc(0, 1), 0, 0, 0]))
    return tuple(complex(b.derivative(k)) for k in range(3))  # type: ignore[return-value]


def _unit(angle: Series) -> Series:
    from references import exp

    turned: Series = exp(angle * Series([MP.mpc(0, 1), 0, 0, 0]))
    return turned


def kindyna() -> Callable[[], Motion]:
    from linkages import four_bar

    from core.mechanism import at_driver, course_of

    course = course_of(four_bar(GROUND, CRANK, COUPLER, ROCKER).linkage)
    q = at_driver(np.linspace(0.0, 2.0 * np.pi, SAMPLES, endpoint=False))
    rocker = ROCKER * 1e-3

    def run() -> Motion:
        pose = course.solve(q).poses[4]
        u = pose.unit * (rocker * 1e3)
        w, a = pose.angle[1], pose.angle[2]
        return GROUND + u, 1j * w * u, (1j * a - w * w) * u

    return run


def pylinkage() -> Callable[[], Motion]:
    from pylinkage import Crank, Ground, RRRDyad
    from pylinkage.simulation import Linkage

    o2, o4 = Ground(0.0, 0.0), Ground(GROUND, 0.0)
    crank = Crank(anchor=o2, radius=CRANK, angular_velocity=2.0 * np.pi / SAMPLES)
    dyad = RRRDyad(anchor1=crank.output, anchor2=o4, distance1=COUPLER, distance2=ROCKER)
    made = Linkage([o2, o4, crank, dyad])
    made.set_input_velocity(crank, 1.0)

    def run() -> Motion:
        found = made.step_fast_with_kinematics(SAMPLES)
        b = [
            np.roll(part[:, -1, 0] + 1j * part[:, -1, 1], 1) for part in found
        ]  # its first row is after the first step
        return b[0], b[1], b[2]

    return run


def mechanism() -> Callable[[], Motion]:
    from mechanism import Mechanism, Vector, get_joints

    o2, a, b, o4 = get_joints("O2 A B O4")
    crank, coupler = Vector((o2, a), r=CRANK), Vector((a, b), r=COUPLER)
    rocker, ground = Vector((o4, b), r=ROCKER), Vector((o2, o4), r=GROUND, theta=0.0, style="ground")
    theta = np.linspace(0.0, 2.0 * np.pi, SAMPLES, endpoint=False)

    def loops(x: Any, i: Any) -> Any:
        return crank(i) + coupler(x[0]) - rocker(x[1]) - ground()

    guess = (np.array([0.8, 1.4]), np.array([0.1, 0.1]), np.array([0.1, 0.1]))

    def run() -> Motion:
        made = Mechanism(
            vectors=(crank, coupler, rocker, ground), origin=o2, loops=loops, pos=theta, vel=np.ones(SAMPLES),
            acc=np.zeros(SAMPLES), guess=guess,
        )  # fmt: skip
        made.iterate()
        return tuple(
            getattr(b, f"x_{k}") + 1j * getattr(b, f"y_{k}") for k in ("positions", "velocities", "accelerations")
        )  # type: ignore[return-value]

    return run


PEERS: dict[str, tuple[Callable[[], Callable[[], Motion]], int]] = {
    "kindyna": (kindyna, 200), "pylinkage": (pylinkage, 50), "mechanism": (mechanism, 1)
}  # fmt: skip
"""Name -> how it is set up, and how often it is timed."""


def measured(setup: Callable[[], Callable[[], Motion]], times: int) -> tuple[float, tuple[float, float, float]]:
    """Shortest time [ms] and errors of position, velocity and acceleration."""
    run = setup()
    found = run()
    best = float("inf")
    for _ in range(times):
        start = time.perf_counter()
        run()
        best = min(best, time.perf_counter() - start)
    theta = np.linspace(0.0, 2.0 * np.pi, SAMPLES, endpoint=False)
    step = SAMPLES // CHECKED
    truth = np.array([exact(float(t)) for t in theta[::step]]).T
    errors = [float(np.abs(found[k][::step] - truth[k]).max() / np.abs(truth[k]).max()) for k in range(3)]
    return 1e3 * best, (errors[0], errors[1], errors[2])


def main() -> None:
    print(f"four-bar, {SAMPLES} crank angles          ms    position    velocity  acceleration")
    for name, (setup, times) in PEERS.items():
        if name != "kindyna" and importlib.util.find_spec(name) is None:
            print(f"{name:28s}  not installed")
            continue
        took, errors = measured(setup, times)
        print(f"{name:28s}  {took:8.3f}  " + "  ".join(f"{e:10.1e}" for e in errors))


if __name__ == "__main__":
    main()
