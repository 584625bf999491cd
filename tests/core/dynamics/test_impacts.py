"""core.dynamics.flight: the speed with which a follower strikes across the play, against an integration and a geometry of its own."""

from __future__ import annotations

import cmath
import math
from pathlib import Path

import numpy as np
import pytest
from sampled import spread
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from core.design import Design, edited
from core.project import load
from core.study import Study, findings_of

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
MM = 1e-3
H = 2e-3  # [rad] of differences of fourth order


class Crossing:
    """A roller between two flanks, by the lengths of the design and Newton's law: groove on a vertical guide with a spring, or rollers on
    the two arms of a conjugate pair. Motion y of the follower; its distance from a flank is that of the roller's centre from the
    pitch curve, which is looked for point by point."""

    def __init__(self, design: Design) -> None:
        self.study = Study(design, 72)
        follower, cam, loads = design.drive.mechanism, design.drive.cam, design.drive.loads
        self.omega, self.play = self.study.omega, cam.form.play_mm * MM
        self.paired = cam.form.form == "conjugate"
        far = (cam.base_radius_mm + cam.roller_radius_mm) * MM
        if self.paired:
            self.pivot, arm = complex(follower.pivot_x_mm, follower.pivot_y_mm) * MM, follower.arm_mm * MM
            ray = -self.pivot
            between = math.acos((arm**2 + abs(ray) ** 2 - far**2) / (2.0 * arm * abs(ray)))
            second = cmath.rect(follower.second.arm_mm * MM, math.radians(follower.second.angle_deg))
            start = cmath.exp(1j * (cmath.phase(ray) + between))  # on the left of the ray
            self.arms = (arm * start, second * start)
            self.centre_of_mass = cmath.rect(loads.arm_centre_mm * MM, math.radians(loads.arm_centre_angle_deg)) * start
            self.masses = (loads.arm_mass_kg, loads.roller_mass_kg)
            self.inertia = (
                loads.arm_inertia_kg_m2
                + loads.roller_inertia_kg_m2
                + loads.arm_mass_kg * abs(self.centre_of_mass) ** 2
                + loads.roller_mass_kg * arm**2
            )
        else:
            self.far, self.mass = far, loads.follower_mass_kg
            self.rate, self.preload = loads.spring_rate_n_per_mm / MM, loads.preload_n

    def acceleration(self, y: float) -> float:
        """Of the follower that nothing touches."""
        if not self.paired:
            return -9.80665 - (self.preload + self.rate * y) / self.mass
        weights = zip(self.masses, (self.centre_of_mass, self.arms[0]), strict=True)
        return -9.80665 * sum(mass * (at * cmath.exp(1j * y)).real for mass, at in weights) / self.inertia

    def centre(self, y: float, roller: int) -> tuple[complex, complex, complex]:
        """Of a roller, with two derivatives by y."""
        if not self.paired:
            return 1j * (self.far + y), 1j, 0j
        arm = self.arms[roller] * cmath.exp(1j * y)
        return self.pivot + arm, 1j * arm, -arm

    def motion(self, theta: float) -> np.ndarray:
        program = self.study.program
        state = program.state(program.angles(np.array([theta % (2.0 * math.pi)]))).displacement
        return np.array([state[k][0] for k in range(3)])

    def pitch(self, theta: float, roller: int) -> tuple[complex, complex, complex]:
        """A point of the pitch curve, with two derivatives by the angle."""
        s, first, second = self.motion(theta)
        at, by, bend = self.centre(s, roller)
        turn = cmath.exp(-1j * theta)
        moved, curved = by * first, by * second + bend * first * first
        return at * turn, (moved - 1j * at) * turn, (curved - 2j * moved - at) * turn

    def off(self, theta: float, y: float, roller: int) -> float:
        """How far a roller's centre stands off its pitch curve, away from the cam."""
        place, near = self.centre(y, roller)[0] * cmath.exp(-1j * theta), theta
        for _ in range(20):
            at, along, bend = self.pitch(near, roller)
            slope = ((at - place) * along.conjugate()).real
            near -= slope / (abs(along) ** 2 + ((at - place) * bend.conjugate()).real)
        at, along, _ = self.pitch(near, roller)
        outwards = 1j * along / abs(along)
        return ((place - at) * outwards.conjugate()).real * math.copysign(1.0, (at * outwards.conjugate()).real)

    def gap(self, theta: float, y: float, flank: int) -> float:
        if flank == 0:
            return self.off(theta, y, 0)
        return self.play + (self.off(theta, y, 1) if self.paired else -self.off(theta, y, 0))

    def kept(self, theta: float) -> np.ndarray:
        """y of the follower that keeps to the second flank, with two derivatives."""

        def at(angle: float) -> float:
            s = self.motion(angle)[0]
            return s + brentq(lambda off: self.gap(angle, s + off, 1), -40.0 * self.play, 40.0 * self.play, xtol=1e-16)

        y = np.array([at(theta + k * H) for k in range(-2, 3)])
        return np.array(
            [
                y[2],
                (y[0] - 8.0 * y[1] + 8.0 * y[3] - y[4]) / (12.0 * H),
                (-y[0] + 16.0 * y[1] - 30.0 * y[2] + 16.0 * y[3] - y[4]) / (12.0 * H * H),
            ]
        )

    def impact(self, theta: float, to: int) -> float:
        """The speed along the normal at the flank ``to``."""
        if to == 0:

            def pulled(at: float) -> float:
                y, _, bend = self.kept(at)
                return bend * self.omega**2 - self.acceleration(y)

            theta = brentq(pulled, theta - 0.03, theta + 0.03, xtol=1e-10)
        y, slope, _ = self.kept(theta) if to == 0 else self.motion(theta + 1e-12)

        def rate(_: float, state: np.ndarray) -> list[float]:
            return [state[1], self.acceleration(state[0])]

        def struck(t: float, state: np.ndarray) -> float:
            return self.gap(theta + self.omega * t, float(state[0]), to)

        struck.terminal = True  # type: ignore[attr-defined]
        flown = solve_ivp(
            rate,
            (0.0, 1.0 / self.omega),
            [y, slope * self.omega],
            "DOP853",
            events=struck,
            dense_output=True,
            rtol=1e-11,
            atol=1e-15,
            max_step=0.02 / self.omega,
        )
        assert flown.status == 1
        end, step = float(flown.t[-1]), 1e-5 / self.omega
        before, after = (struck(end + k * step, flown.sol(end + k * step)) for k in (-1.0, 1.0))
        return (before - after) / (2.0 * step)


GROOVE = edited(edited(load(EXAMPLES / "groove.toml"), "loads.friction", 0.0), "follower.direction_deg", 90.0)
SPRUNG = edited(edited(GROOVE, "loads.spring_rate_n_per_mm", 5.0), "loads.preload_n", -150.0)
PAIR = load(EXAMPLES / "conjugate.toml")


@pytest.mark.parametrize(
    ("design", "play", "rel"),
    spread([(GROOVE, 0.05, 1e-4), (GROOVE, 0.5, 1e-3), (SPRUNG, 0.5, 1e-3), (PAIR, 0.05, 1e-4)], 1),
    ids=["groove", "much play", "sprung groove", "conjugate pair"],
)
@pytest.mark.stress
def test_the_impact_is_that_of_the_integrated_flight(design: Design, play: float, rel: float) -> None:
    """Both ways, of a pair whose arms and levers differ too; three digits are printed."""
    made = edited(design, "cam.play_mm", play)
    own, changes = Crossing(made), Study(made).flank_impacts
    assert {change.to for change in changes} == {0, 1}
    for change in changes:
        assert change.impact == pytest.approx(own.impact(change.theta, change.to), rel=rel)


def test_friction_slows_the_flight_and_a_follower_that_it_stops_strikes_nothing() -> None:
    """On a level guide nothing else moves the free follower. At the end of the rise it stops within a thousandth of the play."""
    level = load(EXAMPLES / "groove.toml")
    rubbing, free = (Study(edited(level, "loads.friction", each)).flank_impacts for each in (0.1, 0.0))
    assert [change.impact is None for change in rubbing] == [False, False, True] * 2
    for change in rubbing:
        if change.impact is not None:
            assert change.impact != pytest.approx(
                min(free, key=lambda other: abs(other.theta - change.theta)).impact, rel=1e-3
            )
    texts = [f.message for f in findings_of(Study(level)) if f.code == "flank-change"]
    assert (
        texts[0]
        == "the contact changes to the inner flank at 60 deg: over a play of 0.05 mm it strikes with 0.02784 m/s"
    )
    assert texts[2].endswith("inner flank at 179.5 deg")
