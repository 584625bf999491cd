"""Two cams on a free shaft with a flywheel, a slider-crank with spring, damper and friction, the lift's arm with rod and slider, and
a follower that leaves its cam and lands, against Exudyn, a program for bodies and joints that knows no cams. Skipped without it.

An eccentric disk under a roller keeps the roller's centre at one distance from its own: in Exudyn that is a rigid rod between a point
of the shaft and a mass on a guide; here it is a motion, as a table of rows of the same function.
"""

from math import cos, hypot, log, pi, radians, sin, sqrt
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from bodies import ACROSS, TURN, Body, World, direction
from mechanisms import with_loads

from core.design import (
    Design,
    Drive,
    Motion,
    RollerCam,
    Segment,
    Shaft,
    SplinePoint,
    TableCurve,
    Translating,
    TranslatingLoads,
    edited,
)
from core.project import load, loads
from core.study import Study

EXAMPLES = Path(__file__).parents[2] / "resources" / "examples"
MM = 1e3
WEIGHT = -9.80665j
RPM, FLYWHEEL = 120.0, 0.4
# eccentricity [m], mass [kg], spring rate [N/m], phase [deg]
DISKS = ((0.03, 6.0, 4000.0, 0.0), (0.02, 9.0, 9000.0, 70.0))
ROD, ROLLER, PRELOAD = 0.12, 0.02, 300.0


def lift(eccentric: float, degrees: float) -> tuple[float, float, float]:
    """Of the roller above its lowest place [mm], with two derivatives per degree."""
    c, s = cos(np.deg2rad(degrees)), sin(np.deg2rad(degrees))
    root = sqrt(ROD**2 - (eccentric * s) ** 2)
    first = -(eccentric**2) * s * c / root
    second = -(eccentric**2) * (c * c - s * s) / root - first**2 / root
    value = -eccentric * c + root - ROD + eccentric
    return MM * value, MM * (eccentric * s + first) * pi / 180.0, MM * (eccentric * c + second) * (pi / 180.0) ** 2


def drive(number: int, eccentric: float, mass: float, rate: float, phase: float) -> Drive:
    rows = tuple(SplinePoint(float(degrees), *lift(eccentric, degrees)) for degrees in range(361))
    return Drive(
        Motion(0.0, (Segment(360.0, 0.0, TableCurve(rows)),)),
        Translating(direction_deg=0.0),
        RollerCam(base_radius_mm=MM * (ROD - eccentric - ROLLER), roller_radius_mm=MM * ROLLER),
        TranslatingLoads(follower_mass_kg=mass, spring_rate_n_per_mm=rate / MM, preload_n=PRELOAD, gravity_m_s2=0.0),
        name=f"Disk {number}",
        phase_deg=phase,
        mirrored=number == 1,
    )


def turned(exudyn: Any, speed: float) -> tuple[np.ndarray, np.ndarray]:
    """Angle and speed of the shaft over one turn [rad, rad/s], from this speed at angle 0 on."""
    world = World(exudyn)
    shaft = world.body(1.0, FLYWHEEL, turning=speed)
    world.pin(world.frame, 0j, shaft, 0j)
    for eccentric, mass, rate, phase in DISKS:
        centre = -eccentric * direction(-phase)  # of the disk at 0
        place, lowest = centre.real + sqrt(ROD**2 - centre.imag**2), ROD - eccentric
        moves = -centre.imag * speed - centre.imag * centre.real * speed / sqrt(ROD**2 - centre.imag**2)
        follower = world.body(mass, 1.0, complex(place), velocity=complex(moves))
        world.hold(follower, ACROSS)
        world.hold(follower, TURN)
        assert abs(place - centre) == pytest.approx(ROD)
        world.rod(shaft, centre, follower, 0j, ROD)
        world.spring_on(follower, 0, rate, lowest - PRELOAD / rate - place)
    angle, rate_of = world.watch(shaft, "Coordinates", "Coordinates_t")
    world.run(1.1 * 60.0 / RPM, 4000)
    return world.read(angle)[:, TURN], world.read(rate_of)[:, TURN]


def test_two_cams_on_a_free_shaft_speed_up_and_slow_down_as_the_bodies_do() -> None:
    exudyn = pytest.importorskip("exudyn")
    shaft = Shaft(
        "ccw", RPM, flywheel_inertia_kg_m2=FLYWHEEL, motor_slope_nm_s_per_rad=1e-9
    )  # a motor that hardly helps
    design = Design("Two disks", shaft, tuple(drive(i, *disk) for i, disk in enumerate(DISKS)))
    study = Study(design, 720)
    assert np.abs(study.camshaft.load.mean) <= 1e-9 * study.camshaft.rms_torque
    angle, speed = turned(exudyn, float(study.camshaft.speed[0]))
    assert angle[-1] >= 2.0 * pi
    there = np.interp(study.camshaft.theta, angle, speed)
    swing = np.ptp(study.camshaft.speed)
    assert swing >= 0.5 * study.omega
    assert np.abs(there - study.camshaft.speed).max() <= 2e-6 * swing


# -- slider-crank ------------------------------------------------------------------------------------------

CRANK, LENGTH, CENTRE, INERTIA = 0.04, 0.14, 0.045, 0.05  # [m, kg m²] of the crank, which runs evenly
SPRING = (0.3 + 0.08j, 2000.0, 0.15, 50.0)  # its place on the frame [m], rate [N/m], free length [m], damping [N s/m]
SPRING_ROW = """
[[loads.springs]]
from = { link = 1, at = [300.0, 80.0] }
to = { link = 4, point = "B" }
rate_n_per_mm = 2.0
free_length_mm = 150.0
damping_n_s_per_mm = 0.05
"""
PINS = {"O2": (0.1, 12.0), "A": (0.12, 10.0), "B": (0.08, 8.0)}  # coefficient, radius [mm]
GUIDE = (0.15, 60.0)  # coefficient, length [mm]
FRICTION_ROW = """
[[loads.pair_friction]]
pair = "{}"
coefficient = {}
{}_mm = {}
"""
FADES = 0.002  # of the crank's speed: slower slip rubs less in Exudyn


class SliderCrank(NamedTuple):
    """Crank, rod and slider, and what joins them: pins by their names, what keeps the slider on its line and upright."""

    crank: Body
    rod: Body
    slider: Body
    pins: dict[str, int]
    across: int
    upright: int


def slider_crank(world: World, omega: float) -> SliderCrank:
    """With spring, damper and process force, from its outer dead centre on."""
    up = 1j * CRANK * omega  # velocity of A
    crank = world.body(0.0, INERTIA, turning=omega)
    rod = world.body(
        0.6, 0.0013, complex(CRANK + CENTRE), velocity=up * (LENGTH - CENTRE) / LENGTH, turning=-up.imag / LENGTH
    )
    slider = world.body(0.5, 0.001, complex(CRANK + LENGTH))
    pins = {
        "O2": world.pin(world.frame, 0j, crank, 0j),
        "A": world.pin(crank, complex(CRANK), rod, complex(-CENTRE)),
        "B": world.pin(rod, complex(LENGTH - CENTRE), slider, 0j),
    }
    place, rate, length, damping = SPRING
    world.spring(world.frame, place, slider, 0j, rate, length, damping)
    world.push(slider, -200.0 + 0j)
    return SliderCrank(crank, rod, slider, pins, world.hold(slider, ACROSS), world.hold(slider, TURN))


def test_the_torque_found_for_a_slider_crank_with_spring_and_damper_keeps_its_crank_at_speed() -> None:
    exudyn = pytest.importorskip("exudyn")
    design = loads((EXAMPLES / "slider_crank.toml").read_text("utf-8") + SPRING_ROW)
    study = Study(design, 3600)
    omega, theta, found = (
        study.omega,
        np.append(study.theta, 2.0 * pi),
        np.append(study.dynamics.driver, study.dynamics.driver[0]),
    )
    world = World(exudyn, WEIGHT)
    parts = slider_crank(world, omega)
    world.drive(parts.crank, TURN, lambda t: float(np.interp(omega * t, theta, found)))
    angle, speed = world.watch(parts.crank, "Coordinates", "Coordinates_t")
    world.run(2.0 * pi / omega, 4000)
    assert world.read(angle)[-1, TURN] == pytest.approx(2.0 * pi, rel=1e-5)
    swing = np.abs(np.cumsum(found)).max() * (theta[1] / (INERTIA * omega))  # of the speed without that torque
    assert swing > 0.01 * omega
    assert np.abs(world.read(speed)[:, TURN] - omega).max() <= 1e-3 * swing


def test_a_slider_crank_that_rubs_in_every_pin_and_on_both_edges_of_its_slider() -> None:
    """Torque and reactions but for 3 degrees about the angles at which a slip turns round, where Exudyn's friction fades."""
    exudyn = pytest.importorskip("exudyn")
    text = (EXAMPLES / "slider_crank.toml").read_text("utf-8") + SPRING_ROW
    rows = [FRICTION_ROW.format(pair, coefficient, "radius", radius) for pair, (coefficient, radius) in PINS.items()]
    design = loads("".join((text, *rows, FRICTION_ROW.format("4", GUIDE[0], "length", GUIDE[1]))))
    study, smooth = Study(design, 2000), Study(loads(text), 2000)
    omega, forces = study.omega, study.dynamics
    world = World(exudyn, WEIGHT)
    parts = slider_crank(world, omega)
    torque = world.watch_joint(world.hold(parts.crank, TURN, lambda t: omega * t))
    bodies = {"O2": (world.frame, parts.crank), "A": (parts.crank, parts.rod), "B": (parts.rod, parts.slider)}
    for name, (coefficient, radius) in PINS.items():
        world.rub_in_pin(parts.pins[name], *bodies[name], coefficient * radius / MM, FADES * omega)

    def edges() -> float:
        normal, couple = world.carried(parts.across)[0], world.carried(parts.upright)[0] / (GUIDE[1] / MM)
        return abs(0.5 * normal + couple) + abs(0.5 * normal - couple)

    world.rub_on_guide(parts.slider, edges, GUIDE[0], FADES * omega * CRANK)
    pins = {name: world.watch_joint(pin) for name, pin in parts.pins.items()}
    across, upright = world.watch_joint(parts.across), world.watch_joint(parts.upright)
    world.run(1.1 * 2.0 * pi / omega, 2200, spectral_radius=0.6)
    turn = np.arange(200, 2200)  # after what the start leaves in the reactions
    at = turn % 2000
    slips = np.minimum(np.abs(np.sin(study.theta)), np.abs(np.cos(study.theta)))[at] > sin(radians(3.0))

    def agrees(there: np.ndarray, here: np.ndarray, without: np.ndarray) -> None:
        size = np.abs(here).max()
        assert np.abs(here - without).max() > 0.01 * size
        assert np.abs(there[turn] - here[at])[slips].max() <= 5e-5 * size

    agrees(world.held(torque), forces.driver, smooth.dynamics.driver)
    for name, pin in pins.items():
        agrees(world.force(pin), forces.pairs[name], smooth.dynamics.pairs[name])
    agrees(world.held(across), forces.pairs["4"].imag, smooth.dynamics.pairs["4"].imag)
    agrees(world.held(upright), forces.couples["4"], np.zeros(1))


# -- cam, arm, rod and slider ------------------------------------------------------------------------------


class Lift(NamedTuple):
    """Arm, rod and slider, the pins, what keeps the slider on its line, and where the slider begins."""

    arm: Body
    rod: Body
    slider: Body
    pins: dict[str, int]
    guide: int
    end: complex


def lift_at(world: World, design: Design, turned: float, turning: float = 0.0) -> Lift:
    """The follower of the lift without its cam, with its cylinder, from an angle [rad] and a speed [rad/s] of its arm on."""
    lengths, masses, turn = design.drive.mechanism, design.drive.loads, direction(np.rad2deg(turned))
    pivot, arm = complex(lengths.pivot_x_mm, lengths.pivot_y_mm) / MM, lengths.slider_arm_mm / MM
    rod, roller_arm = lengths.rod_mm / MM, lengths.roller_arm_mm / MM * direction(lengths.fixed_angle_deg)
    joint, joint_moves = pivot + arm * turn, 1j * turning * arm * turn
    height = pivot.imag + lengths.guide_height_mm / MM
    along = complex(-sqrt(rod**2 - (height - joint.imag) ** 2), height - joint.imag)
    link_turns = -joint_moves.imag / along.real
    end_moves = joint_moves + 1j * link_turns * along
    middle, middle_moves = joint + along / 2.0, joint_moves + 1j * link_turns * along / 2.0
    lever = world.body(masses.arm_mass_kg, masses.arm_inertia_kg_m2, pivot, turned, turning=turning)
    place, moves = pivot + roller_arm * turn, 1j * turning * roller_arm * turn
    roller = world.body(masses.roller_mass_kg, masses.roller_inertia_kg_m2, place, turned, moves, turning)
    link = world.body(
        masses.rod_mass_kg, masses.rod_inertia_kg_m2, middle, float(np.angle(along)), middle_moves, link_turns
    )
    slider = world.body(masses.slider_mass_kg, 1.0, joint + along, velocity=end_moves)
    world.pin(lever, roller_arm, roller, 0j)
    world.hold(roller, TURN, by=lever)
    pins = {
        "pivot": world.pin(world.frame, pivot, lever, 0j),
        "arm_pin": world.pin(link, complex(-rod / 2.0), lever, complex(arm)),
        "slider_pin": world.pin(link, complex(rod / 2.0), slider, 0j),
    }
    world.hold(slider, TURN)
    world.push(slider, complex(masses.external_force_n))
    return Lift(lever, link, slider, pins, world.hold(slider, ACROSS), joint + along)


def test_the_arm_of_the_lift_with_rod_and_slider() -> None:
    """The arm is turned as by the cam: the moment that this takes is that of the contact force, and with the arm's own speed it gives
    the torque of the cam. But for 2 degrees about the ends of its rises, where Exudyn's friction fades."""
    exudyn = pytest.importorskip("exudyn")
    design, steps, fades = load(EXAMPLES / "transfer_lift.toml"), 3600, 0.001
    study = Study(design, steps)
    forces, arm_turns = study.dynamics, study.linkage.bodies["arm"].turn
    start = float(arm_turns[0][0])
    world = World(exudyn, WEIGHT)
    parts = lift_at(world, design, start)
    world.rub_on_guide(parts.slider, lambda: abs(world.carried(parts.guide)[0]), design.drive.loads.friction, fades)
    times, way = np.append(study.theta, 2.0 * pi) / study.omega, np.append(arm_turns[0], start) - start
    moment = world.watch_joint(world.hold(parts.arm, TURN, lambda t: float(np.interp(t, times, way))))
    carries, pins = world.watch_joint(parts.guide), {name: world.watch_joint(pin) for name, pin in parts.pins.items()}
    (moves,) = world.watch(parts.slider, "Coordinates")
    world.run(2.0 * pi / study.omega, steps, spectral_radius=0.6)
    here = study.linkage.bodies["slider"].origin
    assert world.read(moves)[:-1, 0] == pytest.approx(here[0].real - parts.end.real, abs=1e-12)
    slow = (study.motion.velocity_sign != 0.0) & (np.abs(here[1]) * study.omega < 5.0 * fades)
    clear = ~np.convolve(np.tile(slow, 3), np.ones(41), "same").astype(bool)[
        steps : 2 * steps
    ]  # 2 degrees about such angles
    assert clear.mean() > 0.9

    def agrees(there: np.ndarray, found: np.ndarray) -> None:
        assert np.abs(there[:-1] - found)[clear].max() <= 5e-5 * np.abs(found).max()

    agrees(world.held(moment), forces.follower_torque)
    agrees(world.held(moment) * np.append(arm_turns[1], arm_turns[1][0]), forces.torque)
    agrees(world.force(pins["pivot"]), forces.pairs["pivot"] + forces.pairs["bearing"])  # with what the cam carries
    agrees(world.force(pins["arm_pin"]), forces.pairs["arm_pin"])
    agrees(world.force(pins["slider_pin"]), forces.pairs["slider_pin"])
    assert forces.guide is not None
    agrees(world.held(carries), forces.guide.normal)


DAMPED = """
[[loads.springs]]
from = { link = 1, point = "pivot" }
to = { link = 4, point = "slider_pin" }
rate_n_per_mm = 20.0
free_length_mm = 1500.0
damping_n_s_per_mm = 3.0
"""


@pytest.mark.parametrize(("friction", "exact"), [(0.0, 1e-7), (0.3, 1e-4)])
def test_the_lift_flies_with_all_its_bodies_a_spring_and_a_damper(friction: float, exact: float) -> None:
    """From its place and speed at lift-off on; where and how fast it lands. Friction, of guide and pins, fades near standstill."""
    exudyn = pytest.importorskip("exudyn")
    text = (EXAMPLES / "transfer_lift.toml").read_text("utf-8") + DAMPED
    text += "".join(FRICTION_ROW.format(pin, friction, "radius", 100.0) for pin in ("pivot", "slider_pin") if friction)
    design = edited(with_loads(loads(text), friction=friction), "shaft.speed_rpm", 80.0)
    study = Study(design)
    flights = study.flights().flights
    assert len(flights) > 1
    for flight in flights[:2]:
        ends = study.at_theta(np.array([flight.lift, flight.land]) % (2.0 * pi))
        turn, way = ends.linkage.bodies["arm"].turn, ends.motion.displacement
        world = World(exudyn, WEIGHT)
        parts = lift_at(world, design, float(turn[0][0]), float(turn[1][0]) * study.omega)
        pivot = complex(design.drive.mechanism.pivot_x_mm, design.drive.mechanism.pivot_y_mm) / MM
        world.spring(world.frame, pivot, parts.slider, 0j, 20e3, 1.5, 3e3)
        if friction:
            world.rub_on_guide(
                parts.slider, lambda parts=parts, world=world: abs(world.carried(parts.guide)[0]), friction, 1e-3
            )
            world.rub_in_pin(parts.pins["pivot"], world.frame, parts.arm, friction * 0.1, 1e-3)
            world.rub_in_pin(parts.pins["slider_pin"], parts.rod, parts.slider, friction * 0.1, 1e-3)
        place, speed = world.watch(parts.slider, "Coordinates", "Coordinates_t")
        world.run((flight.land - flight.lift) / study.omega, 1000 if friction else 2000, relative=1e-8, absolute=1e-7)
        there = np.interp((flight.theta - flight.lift) / study.omega, world.times(place), world.read(place)[:, 0])
        assert np.abs(there - (flight.y - flight.y[0])).max() <= 5.0 * exact * np.ptp(flight.y)
        assert flight.y[-1] == pytest.approx(way[0][1], abs=1e-10)
        assert way[1][1] * study.omega - world.read(speed)[-1, 0] == pytest.approx(flight.speed, rel=exact)


# -- lift-off and landing ----------------------------------------------------------------------------------

SPEED, STROKE, MASS, RATE, CLOSING = 900.0, 0.009, 0.2, 1800.0, 0.7  # [rpm, m, kg, N/m, N]
STIFFNESS = 1e9  # of the contact [N/m]


def s_of(theta: float) -> float:
    """Up and down by harmonic rises over half a turn, then at rest."""
    return STROKE * sin(theta) ** 2 if theta % (2.0 * pi) < pi else 0.0


def landings(exudyn: Any, restitution: float, turns: float) -> tuple[float, list[tuple[float, float, float]]]:
    """Where it leaves its base first, and angle, speed and height before of every landing on it [deg, m/s, m].

    The contact is a spring of 1e9 N/m and a damper with the ratio -ln e/√(π² + ln² e), 1 for e = 0. It lasts π/ω_d."""
    ratio = -log(restitution) / hypot(pi, log(restitution)) if restitution else 1.0
    omega, closing = SPEED * pi / 30.0, CLOSING + MASS * 9.80665
    world = World(exudyn)
    base, follower = world.mass(1.0), world.mass(MASS, -closing / STIFFNESS)
    world.hold(base, 0, lambda t: s_of(omega * t))
    world.spring_on(follower, 0, RATE, -closing / RATE)
    world.contact(base, follower, STIFFNESS, 2.0 * ratio * sqrt(STIFFNESS * MASS), -closing / STIFFNESS)
    below = world.watch(base, "Coordinates", "Coordinates_t")
    above = world.watch(follower, "Coordinates", "Coordinates_t", "Coordinates_tt")
    world.run(turns * 2.0 * pi / omega, round(36000 * turns), relative=1e-7, absolute=1e-6)
    angle = np.rad2deg(world.times(above[0]) * omega)
    gap, speed = (world.read(one)[:, 0] - world.read(other)[:, 0] for one, other in zip(above, below, strict=False))
    force = MASS * world.read(above[2])[:, 0] + RATE * world.read(above[0])[:, 0] + closing
    off = int(np.flatnonzero((force < 0.0) & (angle > 30.0))[0])
    lift = float(np.interp(0.0, -force[off - 1 : off + 1], angle[off - 1 : off + 1]))
    lands = np.flatnonzero((gap[:-1] >= 0.0) & (gap[1:] < 0.0) & (angle[:-1] > lift))
    leaves = [off, *lands[:-1]]
    return lift, [
        (float(angle[i]), float(-speed[i]), float(gap[j : i + 1].max())) for i, j in zip(lands, leaves, strict=True)
    ]


@pytest.mark.parametrize("restitution", [0.0, 0.3])
def test_a_follower_that_leaves_its_cam_lands_and_rebounds(restitution: float) -> None:
    exudyn = pytest.importorskip("exudyn")
    given = {"spring_rate_n_per_mm": RATE / MM, "preload_n": CLOSING, "restitution": restitution}
    design = edited(with_loads(load(EXAMPLES / "kim_1990.toml"), **given), "shaft.speed_rpm", SPEED)
    flights = Study(design).flights().flights
    lift, lands = landings(exudyn, restitution, 1.1 if restitution else 0.6)
    assert lift == pytest.approx(np.rad2deg(flights[0].lift), abs=1e-3)
    assert lands[0] == pytest.approx((np.rad2deg(flights[0].land), flights[0].speed, flights[0].height), rel=3e-5)
    rebounds = 2 if restitution else 0  # later flights are as short as the contact
    assert min(len(lands), len(flights)) > rebounds
    assert len(lands) == len(flights) or rebounds
    for (angle, speed, height), flight in zip(lands[1 : rebounds + 1], flights[1 : rebounds + 1], strict=True):
        assert angle == pytest.approx(np.rad2deg(flight.land), abs=0.3)  # the contact alone lasts 0.26
        assert speed == pytest.approx(flight.speed, rel=0.01)
        assert height == pytest.approx(flight.height, rel=0.02)
