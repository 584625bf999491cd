"""Groove and conjugate pair: both flanks against the roller by brute force, closed forms, which flank carries and how hard the
contact strikes the other one, and what cannot be."""

import csv
import json
import math
import tomllib
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from face_cases import random_design
from mechanisms import levels
from references import MP
from sampled import spread

from core import project
from core.__main__ import main
from core.cam import CamShape, envelope
from core.design import (
    Conjugate,
    Design,
    Drive,
    Groove,
    LinkageConjugate,
    LinkPoint,
    Open,
    RollerCam,
    SecondLinkRoller,
    SecondPlace,
    SecondRoller,
    Shaft,
    Translating,
    TranslatingLoads,
    edited,
    faults,
    get,
    with_drive,
)
from core.dynamics import momentum_residual, power_residual
from core.errors import DesignError, NoCam, NoSolution
from core.followers import SECOND_ROLLER, built
from core.followers.dragging import joints_of, move_joint
from core.mechanism import solve_mechanism
from core.motion import Angles, MotionState
from core.output.channels import channels
from core.project import load
from core.stability.stage import Stability
from core.study import Study, certificate_of, extremes_of, findings_of
from core.study.cam_checks import limit_rows

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
GROOVE, PAIR = load(EXAMPLES / "groove.toml"), load(EXAMPLES / "conjugate.toml")
FOLLOWERS = ("translating", "oscillating", "cam-slider", "linkage")
CASES = [
    (follower, sense, form) for follower in FOLLOWERS for sense in ("ccw", "cw") for form in ("groove", "conjugate")
]
UNDERCUT = {"inner": "undercut", "outer": "outer-undercut", "second": "second-undercut"}


def pushed(stroke: float = 20.0, law: str = "cycloidal", **cam: object) -> Design:
    """A centric follower that nothing but its mass loads, up and down in 120 deg each."""
    motion = levels(0.0, (60.0, 0.0, "dwell"), (120.0, stroke, law), (60.0, stroke, "dwell"), (120.0, 0.0, law))
    follower = Translating(
        second=SecondPlace(distance_mm=130.0 + stroke) if isinstance(cam.get("form"), Conjugate) else None
    )
    loads = TranslatingLoads(follower_mass_kg=2.0, gravity_m_s2=0.0)
    return Design("pushed", Shaft("ccw", 600.0), (Drive(motion, follower, RollerCam(50.0, 15.0, **cam), loads),))  # type: ignore


def drawn(rng: np.random.Generator, follower: str, sense: str, form: str) -> Design:
    """A design of usual proportions with play; some so steep that they are undercut."""
    design = random_design(rng, follower, "roller", sense)
    if follower in ("translating", "oscillating") and rng.uniform() < 0.3:
        unit, motion = design.drive.motion_unit, design.drive.motion
        design = edited(
            design, f"motion.stroke_{unit}", max(s.rise for s in motion.segments) * float(rng.uniform(2.0, 8.0))
        )  # type: ignore
    if follower == "linkage" and form == "conjugate":
        design = behind_the_coupler(design, float(rng.uniform(-20.0, 20.0)))
    else:
        design = edited(design, "cam.form", form)
    if form == "conjugate":
        moved = {
            "follower.second.angle_deg": (-8.0, 8.0),
            "follower.second.distance_mm": (-2.0, 2.0),
            "cam.second.roller_radius_mm": (-1.0, 1.0),
        }
        for path, (low, high) in moved.items():
            try:
                design = edited(design, path, get(design, path) + rng.uniform(low, high))
            except KeyError:
                continue
    return edited(design, "cam.play_mm", float(rng.uniform(0.0, 0.3)))


def behind_the_coupler(design: Design, x: float) -> Design:
    """A pair whose second roller stands on the coupler too, on the other side of the cam centre."""
    linkage, cam = design.drive.linkage, design.drive.cam
    other = LinkPoint("C2", x, -200.0)
    links = tuple(
        replace(link, points=(*link.points, other)) if link.number == cam.link else link for link in linkage.links
    )
    second = SecondLinkRoller(link=cam.link, point="C2", roller_radius_mm=cam.face.radius_mm)
    return with_drive(
        design, mechanism=replace(linkage, links=links), cam=replace(cam, form=LinkageConjugate(second=second))
    )


# -- what touches the flanks, from the lengths of the design ------------------------------------------------


def rollers(study: Study) -> dict[str, tuple[np.ndarray, float]]:
    """Flank -> centre of what touches it in the cam's own frame (n,) [mm], and its radius."""
    drive = study.design.drive
    back, first = np.exp(-1j * study.sense * study.theta), study.linkage.follower.origin[0] * 1e3
    form, radius = drive.cam.form, drive.face.radius_mm
    found = {"inner": (first * back, radius)}
    if isinstance(form, Groove):
        return found | {"outer": (first * back, radius + form.play_mm)}
    place = getattr(drive.mechanism, "second", None)
    if place is None:
        pose = study.linkage.bodies[f"link{form.second.link}"]
        at = drive.linkage.by_number[form.second.link].places[form.second.point]
        second = pose.origin[0] * 1e3 + at * np.exp(1j * pose.turn[0])
    elif isinstance(place, SecondPlace):
        second = first - place.distance_mm * np.exp(1j * math.radians(drive.mechanism.direction_deg))  # type: ignore[union-attr]
    else:
        pivot = complex(drive.mechanism.pivot_x_mm, drive.mechanism.pivot_y_mm)  # type: ignore[union-attr]
        arm = (first - pivot) / np.abs(first - pivot)
        second = pivot + place.arm_mm * arm * np.exp(1j * math.radians(place.angle_deg))
    return found | {"second": (second * back, form.second.roller_radius_mm + form.play_mm)}


def check(design: Design, positions: int = 20, points: int = 720) -> str:
    """What came of a design: ``undercut``, ``sound`` or ``none``; asserts what must hold."""
    assert faults(design) == []
    study = Study(design, points)
    try:
        shape = study.cam
    except NoSolution:
        return "none"
    profiles = {flank.name: flank.profile * 1e3 for flank in shape.flanks}
    size = max(float(np.abs(profile).max()) for profile in profiles.values())
    result = "sound"
    for name, (centre, radius) in rollers(study).items():
        assert np.abs(np.abs(profiles[name] - centre) - radius).max() <= 1e-10 * size, (
            "its own point lies on the roller"
        )
        if name in ("inner", "second"):
            assert (np.abs(profiles[name]) < np.abs(centre)).mean() > 0.5, "on the side of the cam centre"
        else:
            assert (np.abs(profiles[name]) > np.abs(centre)).mean() > 0.5, "on the far side"
        gaps = np.abs(profiles[name][None, :] - centre[:: points // positions, None]).min(axis=1) - radius
        if np.abs(gaps).max() > 1e-10 * size:
            codes = {finding.code for finding in findings_of(study, ("cam",))}
            assert {UNDERCUT[name], "groove-flanks-meet"} & codes, (
                f"{name} is entered, or not touched, and no undercut named"
            )
            result = "undercut"
    return result


def run(seed: int, count: int) -> Counter[str]:
    rng = np.random.default_rng(seed)
    found = Counter(check(drawn(rng, *case)) for case in CASES for _ in range(count))
    assert found["sound"] > 0.6 * len(CASES) * count, found
    assert found["undercut"] > 0, found
    return found


def test_the_roller_touches_both_flanks_and_enters_neither() -> None:
    run(3, 8)


@pytest.mark.parametrize(("follower", "sense", "form"), CASES)
def test_the_certificate_proves_every_flank(follower: str, sense: str, form: str) -> None:
    kept = certificate_of(Study(drawn(np.random.default_rng(4), follower, sense, form), 360))
    assert {"outer_tangency"} if form == "groove" else {"second_tangency", "second_centre"} <= set(kept)
    assert all(residual.kept for residual in kept.values()), kept


@pytest.mark.stress
def test_the_roller_touches_both_flanks_of_thousands() -> None:
    run(2, 300)


# -- closed forms --------------------------------------------------------------------------------------------


def moved(design: Design, y: np.ndarray) -> CamShape:
    """The cam of a design whose motion is given with its derivatives (4, n) at equally spaced angles."""
    theta = np.arange(y.shape[1]) * 2.0 * math.pi / y.shape[1]
    state = MotionState(Angles(theta, np.zeros(theta.size, dtype=int)), y, np.sign(y[1]))
    drive = design.drive
    return envelope(solve_mechanism(built(drive.mechanism, drive.cam), state), drive.face, drive.cam, design.sense)


@pytest.mark.parametrize("sense", ["ccw", "cw"])
def test_the_groove_of_an_eccentric_circle_is_two_circles(sense: str) -> None:
    """s = √(ρ² - e² sin²θ) - e cos θ - (ρ - e): the roller's centre runs on a circle about a point e from the cam centre."""
    e, rho, rr, play, n = 0.008, 0.062, 0.012, 0.0004, 24
    design = pushed(form=Groove(play_mm=1e3 * play))
    cam = replace(design.drive.cam, base_radius_mm=1e3 * (rho - e - rr), roller_radius_mm=1e3 * rr)
    design = replace(with_drive(design, cam=cam), shaft=Shaft(sense, 60.0))

    def lift(at: object) -> object:
        return -e * MP.cos(at) + MP.sqrt(MP.mpf(rho) ** 2 - (e * MP.sin(at)) ** 2) - (rho - e)

    shape = moved(design, np.array([[float(MP.diff(lift, 2 * MP.pi * i / n, k)) for i in range(n)] for k in range(4)]))
    inner, outer = shape.flanks
    centre = inner.pitch[0] * (-e / (rho - e))
    assert np.abs(np.abs(inner.profile - centre) - (rho - rr)).max() <= 1e-15
    assert np.abs(np.abs(outer.profile - centre) - (rho + rr + play)).max() <= 1e-15
    assert np.abs(inner.profile_curvature * (rho - rr) - 1.0).max() <= 1e-11
    assert np.abs(outer.profile_curvature * (rho + rr + play) - 1.0).max() <= 1e-11


@pytest.mark.parametrize("sense", ["ccw", "cw"])
def test_a_pair_of_constant_breadth_is_one_cam(sense: str) -> None:
    """s(θ) + s(θ + 180°) = h, and rollers alike 2 (Br + Rr) + h apart: the second cam is the first."""
    h = 14.0
    motion = levels(0.0, (180.0, h, "simple-harmonic"), (180.0, 0.0, "simple-harmonic"))
    design = with_drive(
        pushed(),
        motion=motion,
        cam=RollerCam(50.0, 15.0, form=Conjugate(second=SecondRoller(roller_radius_mm=15.0))),
        mechanism=Translating(second=SecondPlace(distance_mm=2.0 * 65.0 + h), direction_deg=70.0),
    )
    first, second = Study(replace(design, shaft=Shaft(sense, 60.0)), 360).cam.flanks
    assert np.abs(second.profile - np.roll(first.profile, -180)).max() <= 1e-16 * 360
    assert second.profile_curvature == pytest.approx(np.roll(first.profile_curvature, -180), rel=1e-12)
    assert second.pressure_angle == pytest.approx(np.roll(first.pressure_angle, -180), abs=1e-13)


# -- which flank carries -------------------------------------------------------------------------------------


def fast(rng: np.random.Generator, follower: str, sense: str, form: str) -> Design:
    """So fast that inertia turns the contact round, with friction in the guide."""
    design = drawn(rng, follower, sense, form)
    if design.shaft is None:
        driver = design.drive.linkage.driver
        mechanism = replace(design.drive.linkage, driver=replace(driver, speed_rpm=driver.speed_rpm * 25.0))
        return with_drive(design, mechanism=mechanism)
    loads = design.drive.loads
    if hasattr(loads, "friction"):
        loads = replace(loads, friction=float(rng.uniform(0.0, 0.15)))
    return replace(with_drive(design, loads=loads), shaft=replace(design.shaft, speed_rpm=3000.0))


@pytest.mark.parametrize(("follower", "sense", "form"), CASES)
def test_power_and_momentum_balance_while_the_contact_changes_flanks(follower: str, sense: str, form: str) -> None:
    rng, changed = np.random.default_rng(3), 0
    for _ in range(3):
        study = Study(fast(rng, follower, sense, form), 360)
        try:
            shape, forces = study.cam, study.dynamics
        except NoSolution:
            continue
        first, other = (contact.force for contact in forces.contacts)
        assert first.min() >= 0.0
        assert other.min() >= 0.0
        assert np.minimum(first, other).max() == 0.0, "the idle one is not pressed"
        changed += bool(first.max() > 0.0 and other.max() > 0.0)
        parts = (study.linkage, shape, forces, study.loading)
        assert power_residual(*parts).max() <= 1e-12
        assert momentum_residual(*parts).max() <= 1e-12
    assert changed


def test_the_second_arm_carries_what_turns_the_rocker_back() -> None:
    """J φ'' = -F₂ (C₂ - P) × n₂ where the first roller would have to pull; of J the two masses at their places."""
    design = edited(PAIR, "loads.gravity_m_s2", 0.0)
    study = Study(design, 720)
    g, loads = design.drive.mechanism, design.drive.loads
    arm_centre = 1e-3 * loads.arm_centre_mm
    inertia = loads.arm_inertia_kg_m2 + loads.arm_mass_kg * arm_centre**2
    inertia += loads.roller_inertia_kg_m2 + loads.roller_mass_kg * (1e-3 * g.arm_mm) ** 2  # type: ignore[union-attr]
    pivot = 1e-3 * complex(g.pivot_x_mm, g.pivot_y_mm)  # type: ignore[union-attr]
    moment = inertia * study.motion.displacement[2] * study.omega**2
    pull = np.zeros(720)
    for flank, force in zip(
        study.cam.flanks, (study.dynamics.contacts[0].force, study.dynamics.contacts[1].force), strict=True
    ):
        arm = flank.reference - pivot
        pull = pull - force * (arm.real * flank.normal.imag - arm.imag * flank.normal.real)
    assert pull == pytest.approx(moment, abs=1e-12 * np.abs(moment).max())
    carried = study.dynamics.contacts[1].force > 0.0
    assert np.all(moment[carried] < 0.0)
    assert carried.sum() == pytest.approx(240, abs=2), "while the arm is slowed down outwards and set going inwards"


def test_torque_and_flywheel_do_not_see_which_flank_carries_without_friction() -> None:
    groove = edited(pushed(form=Groove()), "shaft.flywheel_inertia_kg_m2", 0.02)
    opened = edited(groove, "cam.form", "open")
    ours, theirs = Study(groove, 360), Study(opened, 360)
    assert ours.dynamics.torque == pytest.approx(
        theirs.dynamics.torque, abs=1e-13 * np.abs(theirs.dynamics.torque).max()
    )
    assert ours.dynamics.contact == pytest.approx(
        theirs.dynamics.contact, abs=1e-12 * np.abs(theirs.dynamics.contact).max()
    )
    assert ours.flywheel.needed_inertia == pytest.approx(theirs.flywheel.needed_inertia, rel=1e-12)


def test_a_flywheel_behind_a_rubbing_groove_takes_the_energy_of_a_dense_sum() -> None:
    study = Study(edited(GROOVE, "loads.friction", 0.3), 360)
    theta = (np.arange(400_000) + 0.5) * 2.0 * math.pi / 400_000
    torque = study.at_theta(theta).dynamics.torque
    energy = np.cumsum(torque - torque.mean()) * (theta[1] - theta[0])
    assert study.flywheel.mean_torque == pytest.approx(torque.mean(), rel=1e-7)
    assert study.flywheel.energy_swing == pytest.approx(np.ptp(energy), rel=1e-6)


# -- changes of flank ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "design", spread([GROOVE, PAIR, pushed(form=Groove())], 1), ids=["groove", "pair", "weightless"]
)
def test_changes_of_flank_stand_where_a_dense_scan_has_them(design: Design) -> None:
    study = Study(design, 72)
    theta = np.deg2rad(np.arange(0.005, 360.0, 0.01))
    signed = study.at_theta(theta).dynamics.signed_contact
    signed[np.abs(signed) < 1e-9 * np.abs(signed).max()] = 0.0
    loaded = np.flatnonzero(signed)
    wanted = [(i, j) for i, j in zip(np.roll(loaded, 1), loaded, strict=True) if signed[i] * signed[j] < 0.0]
    notes = [f for f in findings_of(study, ("dynamics",)) if f.code == "flank-change"]
    assert [f.severity for f in notes] == ["note"] * len(wanted)
    assert len(wanted) >= 2
    for note in notes:
        at = math.radians(note.cam_angle_deg) + 1e-9  # type: ignore[arg-type]
        near = min((abs((theta[j] - at + math.pi) % (2.0 * math.pi) - math.pi), j) for _, j in wanted)
        assert near[0] <= np.deg2rad(0.011)
        there = 0 if signed[near[1]] > 0.0 else 1
        names = {"groove": ("inner flank", "outer flank"), "conjugate": ("first roller", "second roller")}
        assert note.values["to"] == names[design.drive.cam.form.form][there]
    assert not [f for f in findings_of(study, ("dynamics",)) if f.code == "separation"]


def impacts(design: Design) -> dict[float, float]:
    found = findings_of(Study(design, 72), ("dynamics",))
    return {
        f.cam_angle_deg: f.values["impact_m_s"] for f in found if f.code == "flank-change" and "impact_m_s" in f.values
    }  # type: ignore


def test_the_speed_of_impact_over_a_small_play() -> None:
    """Half way up, a = (s''' ω³ cos ψ) t: v = (9/2 ȧ play²)^(1/3). Where the acceleration jumps: v = √(2 a play)."""
    play = 1e-6
    design = pushed(form=Groove(play_mm=1e3 * play))
    there = Study(design, 72).at_theta(np.array([math.radians(120.0)]))
    jerk = abs(there.motion.displacement[3][0]) * there.omega**3 * math.cos(there.cam.flank.pressure_angle[0])
    found = impacts(design)
    at = min(found, key=lambda angle: abs(angle - 120.0))
    assert at == pytest.approx(120.0, abs=1e-9)
    assert found[at] == pytest.approx((4.5 * jerk * play**2) ** (1.0 / 3.0), rel=2e-3)

    design = pushed(law="parabolic", form=Groove(play_mm=1e3 * play))
    there = Study(design, 72).at_theta(np.array([math.radians(120.0 + 1e-9)]))
    jump = abs(there.motion.displacement[2][0]) * there.omega**2 * math.cos(there.cam.flank.pressure_angle[0])
    found = impacts(design)
    at = min(found, key=lambda angle: abs(angle - 120.0))
    assert found[at] == pytest.approx(math.sqrt(2.0 * jump * play), rel=2e-3)


def test_without_play_there_is_no_impact_and_no_design_separates() -> None:
    study = Study(pushed(form=Groove()), 72)
    notes = [f for f in findings_of(study) if f.code == "flank-change"]
    assert notes
    assert all(set(f.values) == {"to"} for f in notes)
    assert "changes to the outer flank" in notes[0].message
    with_play = findings_of(Study(pushed(form=Groove(play_mm=0.05)), 72))
    assert "over a play of 0.05 mm it strikes with" in next(f for f in with_play if f.code == "flank-change").message


def test_a_groove_on_a_flexible_shaft_is_never_left() -> None:
    design = edited(load(EXAMPLES / "kim_1990.toml"), "shaft.spring", "fixed")
    opened, groove = Study(design, 72).stability, Study(edited(design, "cam.form", "groove"), 72).stability
    assert isinstance(opened, Stability)
    assert isinstance(groove, Stability)
    assert opened.contact is not None
    assert groove.contact is None


# -- limits --------------------------------------------------------------------------------------------------


def found(design: Design, code: str) -> list[object]:
    return [finding for finding in findings_of(Study(design, 720), ("cam",)) if finding.code == code]


@pytest.mark.parametrize("play", [0.0, 0.5])
def test_an_outer_flank_is_undercut_exactly_where_the_pitch_curve_is_as_hollow_as_the_roller(play: float) -> None:
    motion = levels(
        0.0, (120.0, 0.0, "dwell"), (60.0, 40.0, "cycloidal"), (120.0, 40.0, "dwell"), (60.0, 0.0, "cycloidal")
    )
    hollow = with_drive(pushed(form=Groove(play_mm=play)), motion=motion)
    study = Study(hollow, 720)
    low = extremes_of(study, "cam", ("pitch_curvature",))["pitch_curvature"].low
    radius = -1e3 / low.value
    assert 10.0 < radius < 60.0
    reach = hollow.drive.cam.base_radius_mm + hollow.drive.cam.roller_radius_mm
    for size, there in ((radius - play - 1e-6, False), (radius - play + 1e-6, True)):
        cam = replace(hollow.drive.cam, base_radius_mm=reach - size, roller_radius_mm=size)
        notes = found(with_drive(hollow, cam=cam), "outer-undercut")
        assert bool(notes) == there, size
    (note,) = notes
    dense = study.at_theta(np.linspace(low.theta - 0.01, low.theta + 0.01, 2001)).cam.flank.pitch_curvature
    assert note.cam_angle_deg == pytest.approx(math.degrees(low.theta))  # type: ignore[attr-defined]
    assert low.value <= dense.min()
    assert note.values["pitch_radius_mm"] == pytest.approx(radius, rel=1e-9)  # type: ignore[attr-defined]


def test_stretches_of_a_groove_that_run_into_each_other() -> None:
    """A lobe whose foot is thinner than two rollers: the wall against a search over both angles."""

    def lobe(top: float) -> Design:
        motion = levels(
            0.0,
            (20.0, 120.0, "cycloidal"),
            (top, 120.0, "dwell"),
            (20.0, 0.0, "cycloidal"),
            (320.0 - top, 0.0, "dwell"),
        )
        return with_drive(pushed(form=Groove()), motion=motion, cam=RollerCam(20.0, 20.0, form=Groove()))

    (note,) = found(lobe(20.0), "groove-flanks-meet")
    study = Study(lobe(20.0), 720)
    rise, back = (study.at_theta(np.deg2rad(np.linspace(a, a + 3.0, 1500))).cam.flank.pitch * 1e3 for a in (1.0, 56.0))
    near = np.abs(rise[:, None] - back[None, :])
    i, j = np.unravel_index(near.argmin(), near.shape)
    assert note.values["overlap_mm"] == pytest.approx(40.0 - near[i, j], abs=1e-4)  # type: ignore[attr-defined]
    assert note.cam_angle_deg == pytest.approx(1.0 + 3.0 * i / 1499, abs=0.005)  # type: ignore[attr-defined]
    assert note.values["other_deg"] == pytest.approx(56.0 + 3.0 * j / 1499, abs=0.005)  # type: ignore[attr-defined]
    assert not found(lobe(30.0), "groove-flanks-meet"), "a thicker foot stands"
    assert not found(GROOVE, "groove-flanks-meet")


def test_the_second_roller_keeps_off_the_hub() -> None:
    least = (np.abs(rollers(Study(PAIR, 36000))["second"][0])).min() - 20.0
    for field in ("hub_mm", "bore_mm"):
        bare = edited(edited(PAIR, "cam.hub_mm", None), "cam.bore_mm", None)
        assert not found(edited(bare, f"cam.{field}", 2.0 * least - 1e-3), "second-roller-meets-hub")
        (note,) = found(edited(bare, f"cam.{field}", 2.0 * least + 1e-3), "second-roller-meets-hub")
        assert note.field == f"cam.{field}"  # type: ignore[attr-defined]
        assert note.values["distance_mm"] == pytest.approx(least, rel=1e-6)  # type: ignore[attr-defined]


def test_limits_of_the_second_cam() -> None:
    (blunt,) = found(edited(PAIR, "cam.second.roller_radius_mm", 92.55), "second-undercut")
    assert blunt.values["roller_radius_mm"] == pytest.approx(92.6)  # type: ignore[attr-defined]
    (steep,) = found(edited(PAIR, "follower.second.angle_deg", -60.0), "second-pressure-angle")
    study = Study(edited(PAIR, "follower.second.angle_deg", -60.0), 36000)
    assert steep.values["value"] == pytest.approx(np.rad2deg(study.cam.flanks[1].pressure_angle.max()), rel=1e-6)  # type: ignore
    assert found(edited(PAIR, "follower.second.angle_deg", 20.0), "second-roller-pushes-along")
    assert not {"second-undercut", "second-roller-pushes-along"} & {
        finding.code for finding in findings_of(Study(PAIR, 72))
    }


def test_a_pressure_angle_beyond_the_own_limit_names_its_roller_and_what_mends_it() -> None:
    """The second roller's is the second's, in findings and beside the limits; turning its arm mends it, a larger base circle does not."""
    steep = edited(PAIR, "follower.second.angle_deg", -75.0)
    study = Study(steep, 36000)
    first, second = (np.rad2deg(flank.pressure_angle) for flank in study.cam.flanks)
    rises = study.drive.velocity_sign > 0.0
    limited = edited(steep, "limits.pressure_angle_rise_deg", 30.0)
    assert first[rises].max() < 30.0 < second[rises].max()
    (note,) = found(limited, "pressure-angle-rise")
    assert note.field == "follower.second.angle_deg"  # type: ignore[attr-defined]
    assert note.message == (  # type: ignore[attr-defined]
        f"pressure angle of the second roller {second[rises].max():.5g} deg on the rise at {note.cam_angle_deg:.4g} deg, your limit "  # type: ignore
        "30 deg: turn the second roller's arm, or change its length, or lengthen the rise"
    )
    rows = {row.name: row.value for row in limit_rows(Study(limited), ("cam",))}
    assert rows["pressure_angle_rise_deg"] == pytest.approx(first[rises].max(), rel=1e-6)
    assert rows["second_pressure_angle_rise_deg"] == pytest.approx(second[rises].max(), rel=1e-6)
    assert not found(edited(limited, note.field, -85.0), "pressure-angle-rise")  # type: ignore[attr-defined]
    assert found(edited(limited, "cam.base_radius_mm", 80.0), "pressure-angle-rise")
    both = found(edited(limited, "limits.pressure_angle_rise_deg", 5.0), "pressure-angle-rise")
    assert [each.field for each in both] == ["cam.base_radius_mm", "follower.second.angle_deg"]  # type: ignore[attr-defined]


def test_a_second_roller_farther_away_has_a_smaller_pressure_angle() -> None:
    """On a follower that slides, as its finding says."""
    pair = edited(load(EXAMPLES / "card_picker.toml"), "cam.form", "conjugate")
    near = edited(pair, "limits.pressure_angle_return_deg", 5.0)
    field = "follower.second.distance_mm"
    note = found(near, "pressure-angle-return")[-1]
    assert (note.field, "put the second roller farther away" in note.message) == (field, True)  # type: ignore[attr-defined]
    away = found(edited(near, field, 2.0 * get(near, field)), "pressure-angle-return")[-1]
    assert away.values["value"] < note.values["value"]  # type: ignore[attr-defined]


def test_a_second_roller_on_the_cam_centre_is_named() -> None:
    with pytest.raises(
        NoSolution, match=r"cam\.second\.roller_radius_mm: the second roller covers the cam centre.*farther out"
    ):
        _ = Study(edited(PAIR, "cam.second.roller_radius_mm", 95.0), 72).cam


def test_a_second_roller_on_a_fixed_pivot_is_named() -> None:
    """A point of a moving link that stands still: that cam would be a circle and could push nothing."""
    coupler = edited(load(EXAMPLES / "four_bar_coupler_cam.toml"), "cam.form", "conjugate")
    pivot = LinkageConjugate(second=SecondLinkRoller(link=4, point="O4", roller_radius_mm=12.0))
    with pytest.raises(NoCam, match="the second roller keeps its distance from the cam centre") as refused:
        findings_of(Study(edited(coupler, "cam", replace(coupler.drive.cam, form=pivot))))
    assert refused.value.field == "cam.second.point"


def test_the_second_roller_is_drawn_elsewhere_by_the_mouse() -> None:
    for name in ("rocker_cam", "card_picker", "transfer_lift"):
        opened = load(EXAMPLES / f"{name}.toml")
        assert SECOND_ROLLER not in joints_of(opened)
        design = edited(opened, "cam.form", "conjugate")
        there = Study(design, 72).at_theta(np.array([1.3]))
        place = there.cam.flanks[1].reference[0]
        along = 1j if name == "card_picker" else 1.0 + 0.5j  # what slides keeps to its guide
        to = complex(place + 1e-3 * along)
        after = Study(move_joint(design, there.linkage, SECOND_ROLLER, to, 12), 72).at_theta(np.array([1.3]))
        assert after.cam.flanks[1].reference[0] == pytest.approx(to, abs=1e-13)
        assert after.cam.flanks[0].reference[0] == there.cam.flanks[0].reference[0]


# -- files and tables ----------------------------------------------------------------------------------------


def told(design: Design, **tables: dict[str, object]) -> list[str]:
    """The faults of a file with some entries replaced, or taken away."""
    table = tomllib.loads(project.dumps(replace(design, assumed=())))
    for name, values in tables.items():
        table[name] = {key: value for key, value in (table[name] | values).items() if value is not None}
    try:
        project.loads(tomli_w.dumps(table))
    except DesignError as error:
        return [str(fault) for fault in error.faults]
    return []


def test_what_a_form_needs_and_what_belongs_to_another_is_named() -> None:
    assert told(GROOVE, cam={"form": "open"}) == [
        'cam.play_mm = 0.05: only with form = "groove" or "conjugate"; allowed: base_radius_mm | roller_radius_mm | form | '
        "thickness_mm | bore_mm | hub_mm | hub_length_mm | keyway_width_mm | keyway_depth_mm | keyway_angle_deg | cutter_radius_mm | "
        "material | roller_material | youngs_modulus_gpa | poisson_ratio | roller_youngs_modulus_gpa | roller_poisson_ratio | "
        "roller_load_rating_n"
    ]
    assert told(GROOVE, cam={"play_mm": -1.0}) == ["cam.play_mm = -1.0: outside its range; allowed: 0 ... 1e+09 mm"]
    assert told(PAIR, follower={"second": None}) == [
        "follower.second: missing; allowed: the position of the second roller of the conjugate pair: arm_mm, angle_deg"
    ]
    (second,) = told(PAIR, cam={"second": None})
    assert second.startswith("cam.second: missing")
    assert told(PAIR, follower={"second": {"arm_mm": 120.0}}) == [
        "follower.second.angle_deg: missing; allowed: -360 ... 360 °"
    ]
    (unpaired,) = told(PAIR, cam={"form": "groove", "second": None})
    assert unpaired.startswith("follower.second = '[follower.second]': a cam of the form groove has no second roller")
    assert told(GROOVE, cam={"hub_mm": 40.0}) == ["cam.hub_mm = 40.0: not larger than the bore; allowed: > 40 mm"]
    assert told(GROOVE, cam={"keyway_width_mm": 41.0}) == [
        "cam.keyway_width_mm = 41.0: not narrower than the bore; allowed: < 40 mm"
    ]
    assert told(load(EXAMPLES / "tappet_knife.toml"), cam={"form": "groove"}) == [
        "cam.form = 'groove': requires a roller; allowed: open, or face = \"roller\""
    ]
    coupler = edited(load(EXAMPLES / "four_bar_coupler_cam.toml"), "cam.face", "shoe")
    (shoe,) = told(coupler, cam={"form": "groove"})
    assert shoe.startswith("cam.form = 'groove': needs a roller, not a shoe")
    pair = edited(load(EXAMPLES / "four_bar_coupler_cam.toml"), "cam.form", "conjugate")
    assert told(pair, cam={"second": {"link": 3, "point": "X", "roller_radius_mm": 9.0}})[0].startswith(
        "cam.second.point = 'X': link 3 has no such point"
    )


@pytest.mark.parametrize("name", ["rocker_cam", "card_picker", "transfer_lift", "four_bar_coupler_cam"])
def test_another_form_keeps_the_rest_and_goes_back(name: str) -> None:
    design = load(EXAMPLES / f"{name}.toml")
    for form in ("groove", "conjugate"):
        other = edited(design, "cam.form", form)
        assert faults(other) == []
        assert project.loads(project.dumps(other)) == other
        assert len(Study(other, 72).cam.flanks) == 2
        assert edited(other, "cam.form", "open") == design
    assert isinstance(design.drive.cam.form, Open)
    assert edited(edited(design, "cam.form", "groove"), design.drive.face_path, "knife").drive.cam.form == Open()


def test_the_tables_have_the_columns_of_the_form(tmp_path: Path) -> None:
    profile = {
        "groove": ["outer_x_mm", "outer_y_mm", "outer_curvature_per_mm"],
        "conjugate": ["second_x_mm", "second_y_mm", "second_pitch_x_mm", "second_pitch_y_mm", "second_pressure_angle_deg",
                      "second_pitch_curvature_per_mm"],
    }  # fmt: skip
    for design, form in ((GROOVE, "groove"), (PAIR, "conjugate")):
        names = [row.slug for row in channels(design)]
        assert set(profile[form]) <= set(names)
        assert ("second_contact_force_n" in names) == (form == "conjugate")
        assert not any(slug in names for other in profile if other != form for slug in profile[other])
        path = tmp_path / form
        assert main(["export", str(EXAMPLES / f"{form}.toml"), "--out", str(path), "--samples", "72"]) == 0
        with (path / "dynamics.csv").open(encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        force = np.array([float(row["contact_force_n"]) for row in rows])
        assert (force.min() < 0.0) == (form == "groove")
        if form == "conjugate":
            second = np.array([float(row["second_contact_force_n"]) for row in rows])
            assert np.minimum(force, second).max() == 0.0
            assert second.max() > 0.0
        summary = json.loads((path / "summary.json").read_text(encoding="utf-8"))
        assert (
            {"outer_tangency"}
            if form == "groove"
            else {"second_tangency", "second_centre"} <= set(summary["certificate"])
        )
        assert "flank-change" in {finding["code"] for finding in summary["findings"]}


@pytest.mark.parametrize(("name", "flank"), [("groove", "inner"), ("groove", "outer"), ("conjugate", "second")])
def test_each_flank_is_written_as_a_profile(tmp_path: Path, name: str, flank: str) -> None:
    out = tmp_path / "profile.csv"
    assert (
        main(["profile", str(EXAMPLES / f"{name}.toml"), "--out", str(out), "--flank", flank, "--samples", "720"]) == 0
    )
    with out.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    exact = (
        next(each for each in Study(load(EXAMPLES / f"{name}.toml"), 720).cam.flanks if each.name == flank).profile
        * 1e3
    )
    assert np.array([complex(float(r["x_mm"]), float(r["y_mm"])) for r in rows]) == pytest.approx(exact, abs=1e-9)
    other = "second" if name == "groove" else "outer"
    assert main(["profile", str(EXAMPLES / f"{name}.toml"), "--out", str(out), "--flank", other]) == 2
