"""The flight of a follower that has left its cam: against a closed form, an integration of its own, and a parabola."""

import math
from pathlib import Path

import numpy as np
import pytest
from mechanisms import with_loads
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from core.__main__ import main
from core.design import Design, Motion, Process, Segment, edited, with_drive
from core.dynamics import flights
from core.errors import NoSolution
from core.motion import Angles
from core.project import load, save
from core.study import Study, extremes_of

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
SPEED = "shaft.speed_rpm"


def valve(rpm: float, **loads: float) -> Design:
    """Kim1990's cam at a speed; s = (h/2)(1 - cos 2θ) on its first half turn, then a dwell."""
    return edited(with_loads(load(EXAMPLES / "kim_1990.toml"), **loads), SPEED, rpm)


def lift_of(design: Design) -> float:
    return extremes_of(Study(design), "motion", ("displacement",))["displacement"].high.value


def s_of(h: float, theta: float) -> tuple[float, float]:
    """s and s' of Kim1990's cam."""
    theta %= 2.0 * math.pi
    return (0.5 * h * (1.0 - math.cos(2.0 * theta)), h * math.sin(2.0 * theta)) if theta < math.pi else (0.0, 0.0)


def test_on_its_spring_it_swings_in_closed_form() -> None:
    """m z'' = -(F + k z) - m g: a cosine about its rest, from where F + k s + m g + m s'' ω² = 0."""
    design = valve(2600.0)
    h, m, k, force, omega = lift_of(design), 0.2, 15e3, 20.0 + 0.2 * 9.80665, 2600.0 * math.pi / 30.0
    found = Study(design).flights()
    one = found.flights[0]
    lift = 0.5 * math.acos((force + 0.5 * k * h) / (0.5 * k * h - 2.0 * h * m * omega**2))
    assert one.lift == pytest.approx(lift, abs=1e-12)
    p, (s, slope) = math.sqrt(k / m) / omega, s_of(h, lift)

    def way(theta: float) -> float:
        t = p * (theta - lift)
        return (s + force / k) * math.cos(t) + slope / p * math.sin(t) - force / k

    assert one.y == pytest.approx([way(theta) for theta in one.theta.tolist()], abs=1e-11)
    land = brentq(
        lambda theta: way(theta) - s_of(h, theta)[0], 0.5 * (one.lift + one.land), one.land + 0.02, xtol=1e-14
    )
    assert one.land == pytest.approx(land, abs=1e-10)
    t = p * (land - lift)
    falls = -(s + force / k) * p * math.sin(t) + slope * math.cos(t)
    assert one.speed == pytest.approx((s_of(h, land)[1] - falls) * omega, rel=1e-8)
    high = max(
        way(theta) - s_of(h, theta)[0] for theta in np.linspace(one.highest - 1e-4, one.highest + 1e-4, 201).tolist()
    )
    assert one.height == pytest.approx(high, rel=1e-9)
    assert found.steady
    assert found.turns == 1


def test_without_a_spring_it_is_a_parabola_and_a_rebound_is_the_part_that_is_given() -> None:
    design = valve(300.0, spring_rate_n_per_mm=0.0, preload_n=0.0, restitution=0.5)
    h, omega, g = lift_of(design), 300.0 * math.pi / 30.0, 9.80665
    found = Study(design).flights()
    first, second = found.flights[:2]
    s, slope = s_of(h, first.lift)
    t = (first.theta - first.lift) / omega
    assert first.y == pytest.approx(s + slope * omega * t - 0.5 * g * t * t, abs=1e-12)
    assert second.lift == first.land
    down = (second.y[1] - second.y[0]) / (second.theta[1] - second.theta[0]) * omega
    tau = (second.theta[1] - second.theta[0]) / omega
    leaves = down + 0.5 * g * tau
    assert leaves - s_of(h, first.land)[1] * omega == pytest.approx(0.5 * first.speed, rel=1e-6)
    speeds = [flight.speed for flight in found.flights]
    assert min(speeds) < 1e-3 * max(speeds), "it bounces until it rests"
    still = Study(edited(design, "loads.restitution", 0.0)).flights()
    assert len(still.flights) < len(found.flights)
    assert still.steady


def test_a_swinging_follower_against_an_integration_of_its_own() -> None:
    design = edited(load(EXAMPLES / "rocker_cam.toml"), SPEED, 1500.0)
    study, omega = Study(design), 1500.0 * math.pi / 30.0
    one = study.flights().flights[0]
    loads, follower = design.drive.loads, design.drive.mechanism
    mass, centre = loads.arm_mass_kg, 1e-3 * loads.arm_centre_mm
    arm, angle = 1e-3 * follower.arm_mm, math.radians(loads.arm_centre_angle_deg)
    inertia = loads.arm_inertia_kg_m2 + mass * centre**2 + loads.roller_inertia_kg_m2 + loads.roller_mass_kg * arm**2
    side = 1.0 if follower.side == "left" else -1.0
    alpha = float(study.at_theta(np.zeros(1)).linkage.bodies["arm"].turn[0][0])

    def moment(z: float) -> float:
        """Of the spring, and of the weight, along the motion."""
        turned = alpha + side * z
        down = math.radians(loads.gravity_angle_deg)
        weight = loads.gravity_m_s2 * (
            mass * centre * math.sin(down - turned - angle) + loads.roller_mass_kg * arm * math.sin(down - turned)
        )
        return -loads.preload_nm - loads.spring_rate_nm_per_rad * z + side * weight

    start = study.at_theta(np.array([one.lift])).motion.displacement
    run = solve_ivp(
        lambda t, x: (x[1], moment(x[0]) / inertia),
        (0.0, (one.land - one.lift) / omega),
        (float(start[0][0]), float(start[1][0]) * omega),
        rtol=1e-11,
        atol=1e-13,
        method="Radau",
        dense_output=True,
    )
    assert one.y == pytest.approx(run.sol((one.theta - one.lift) / omega)[0], abs=1e-8)
    end = study.at_theta(np.array([one.land % (2.0 * math.pi)])).motion.displacement
    assert one.y[-1] == pytest.approx(float(end[0][0]), abs=1e-10)
    assert one.speed == pytest.approx(float(end[1][0]) * omega - float(run.y[1][-1]), rel=1e-6)


def test_with_friction_of_its_guide_it_swings_about_two_places() -> None:
    """Gravity across the guide: N = m g. F + k z + m z'' ± μ m g = 0, a cosine up, another one down."""
    design = valve(2600.0, gravity_angle_deg=0.0, friction=2.0)
    h, m, k, omega, rubs = lift_of(design), 0.2, 15e3, 2600.0 * math.pi / 30.0, 2.0 * 0.2 * 9.80665
    one = Study(design).flights().flights[0]
    up, down, p = (20.0 + rubs) / k, (20.0 - rubs) / k, math.sqrt(k / m) / omega
    lift = 0.5 * math.acos((k * up + 0.5 * k * h) / (0.5 * k * h - 2.0 * h * m * omega**2))
    assert one.lift == pytest.approx(lift, abs=1e-9)
    s, slope = s_of(h, lift)
    rise = math.atan2(slope / p, s + up)  # angle of the oscillation until it turns round
    high = math.hypot(s + up, slope / p) - up

    def way(theta: float) -> float:
        t = p * (theta - lift)
        return (high + up) * math.cos(t - rise) - up if t < rise else (high + down) * math.cos(t - rise) - down

    assert one.y == pytest.approx([way(theta) for theta in one.theta.tolist()], abs=1e-5 * h)
    land = brentq(lambda theta: way(theta) - s_of(h, theta)[0], one.land - 0.02, one.land + 0.02, xtol=1e-14)
    assert one.land == pytest.approx(land, abs=1e-5)
    assert one.speed == pytest.approx(
        (s_of(h, land)[1] + (high + down) * p * math.sin(p * (land - lift) - rise)) * omega, rel=1e-5
    )


def test_friction_that_holds_the_follower_back_makes_it_leave_and_strike_harder() -> None:
    rubs, smooth = (
        edited(with_loads(load(EXAMPLES / "transfer_lift.toml"), friction=mu), SPEED, 58.0) for mu in (0.1, 0.0)
    )
    held, free = (Study(design).flights().flights[0] for design in (rubs, smooth))
    there = Study(rubs).at_theta(np.array([held.lift])).dynamics.contact
    assert float(there[0]) == pytest.approx(0.0, abs=1e-3)
    assert held.lift < free.lift
    assert held.speed > 2.0 * free.speed


@pytest.mark.stress
def test_a_force_lifts_a_follower_that_stands_still() -> None:
    """m z'' + k z = P - F - μ m g: from rest, against gravity across the guide."""
    still = with_drive(load(EXAMPLES / "kim_1990.toml"), motion=Motion(0.0, (Segment(360.0, 0.0),)))
    push = Process(cam_from_deg=35.0, cam_to_deg=200.0, force_n=40.0)
    design = with_loads(still, gravity_angle_deg=0.0, friction=0.2, process=(push,))
    one = Study(design).flights().flights[0]
    m, k, omega = 0.2, 15e3, 1500.0 * math.pi / 30.0
    far = (40.0 - 20.0 - 0.2 * m * 9.80665) / k
    assert one.lift == pytest.approx(math.radians(35.0), abs=1e-9)
    assert one.height == pytest.approx(2.0 * far, rel=1e-3)
    assert one.highest == pytest.approx(one.lift + math.pi * omega / math.sqrt(k / m), abs=1e-3)


def test_where_the_contact_is_lost_but_the_follower_does_not_get_off_there_is_no_flight() -> None:
    study = Study(valve(1500.0))
    least = float(study.dynamics.contact.min())
    assert least > 0.0

    def pressed(angles: Angles) -> np.ndarray:
        return study.contact_force.at_speed(angles, study.omega) - 1.5 * least

    found = flights(pressed, study.mechanism, study.loading, study.program, study.omega, 1.0)
    assert found.flights == ()
    assert found.steady


def test_what_never_flies_and_what_never_rests() -> None:
    still = Study(valve(1500.0)).flights()
    assert still.flights == ()
    assert still.steady
    with pytest.raises(NoSolution, match="nowhere"):
        Study(valve(1500.0, preload_n=-500.0)).flights()
    with pytest.raises(NoSolution, match="beyond the range of its mechanism at cam angle"):
        Study(valve(6000.0, spring_rate_n_per_mm=0.0, preload_n=0.1, gravity_m_s2=0.0)).flights()


def test_the_command_names_the_speed_the_flights_and_writes_the_map(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "fast.toml"
    save(valve(2600.0), file)
    sizes = ("--samples", "36", "--speeds", "4", "--rpm", "2600")
    assert main(["contact", str(file), "--flights", "--out", str(tmp_path / "map.csv"), *sizes]) == 0
    text = capsys.readouterr().out
    found = Study(load(file)).lift_off
    assert found is not None
    assert f"at {found.omega * 30.0 / math.pi:.4g} rpm" in text
    assert "58.33" in text
    assert "repeat every turn" in text
    rows = np.loadtxt(tmp_path / "map.csv", delimiter=",", skiprows=1)
    assert rows.shape == (4 * 36, 3)
    forces = Study(load(file)).at_theta(np.deg2rad(rows[-36:, 0])).dynamics.contact
    assert rows[-36:, 1] == pytest.approx(2600.0)
    assert rows[-36:, 2] == pytest.approx(forces, rel=1e-9, abs=1e-9)
    assert main(["contact", str(EXAMPLES / "groove.toml")]) == 2
    assert "holds the follower from both sides" in capsys.readouterr().err
    assert main(["report", str(file)]) == 1
    assert "the follower leaves the cam: it does at" in capsys.readouterr().out
