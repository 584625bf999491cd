"""Roller, flat face, knife edge and shoe on every follower: the profile against the face by brute force, curves at fifty digits,
circles, constant breadth, the forces of a face that slides, and what cannot be."""

import math
import tomllib
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from face_cases import CASES, placed, random_design
from mechanisms import levels
from references import MP, Series, motion_series, segment_at, turn
from sampled import spread

from core import project
from core.cam import envelope
from core.design import (
    ContactFriction,
    Design,
    DiskCam,
    Drive,
    Flat,
    Knife,
    RollerCam,
    Rolling,
    Shaft,
    Shoe,
    TiltedFlat,
    Translating,
    TranslatingLoads,
    edited,
    faults,
    get,
    with_drive,
)
from core.errors import DesignError, NoAssembly, NoCam, NoSolution
from core.followers import built
from core.followers.dragging import joints_of, move_joint
from core.mechanism import solve_mechanism
from core.motion import Angles, MotionState
from core.project import dumps, load, loads
from core.study import Study, certificate_of, clear_caches, extremes_of, findings_of

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
TAPPET = Design("tappet", Shaft("ccw", 600.0), (Drive(
    levels(0.0, (120.0, 12.0, "cycloidal"), (60.0, 12.0, "dwell"), (120.0, 0.0, "cycloidal"), (60.0, 0.0, "dwell")),
    Translating(face=TiltedFlat(), offset_mm=0.0),
    DiskCam(40.0),
    TranslatingLoads(follower_mass_kg=0.6, spring_rate_n_per_mm=8.0, preload_n=120.0, contact=ContactFriction(0.1)),
),))  # fmt: skip
ROCKER = edited(load(EXAMPLES / "rocker_cam.toml"), "follower.face", "flat")


# -- the face touches the profile, and enters it nowhere ----------------------------------------------------


def check(design: Design, positions: int = 24, points: int = 1080) -> str:
    """What came of a design: ``undercut``, ``sound`` or ``none``; asserts what must hold."""
    study = Study(design, points)
    try:
        profile = study.cam.flank.profile * 1e3
    except NoSolution:
        return "none"
    step = points // positions
    where = placed(study.at_theta(study.theta[::step]))
    gaps, own, size = where.gaps(profile), where.gaps_at(profile[::step]), float(np.abs(profile).max())
    assert np.abs(own).max() <= 1e-10 * size, "each point of the profile lies on its face"
    bend = study.cam.flank.profile_curvature * 1e-3
    # the profile's own curvature changes its sign through infinity where the face needs more than there is
    reversed_ = (
        (bend < -1.0 / where.radius if where.radius else bend < 0.0) if where.can_undercut else np.zeros(1, dtype=bool)
    )
    near = where.can_undercut and bool((bend > 100.0 / size).any())
    told = False
    if near or reversed_.any() or gaps.min() < -1e-10 * size:
        found = [finding for finding in findings_of(study, ("cam",)) if finding.code == "undercut"]
        told = bool(found)
        assert told or not reversed_.any()
        for finding in found:
            sides = math.radians(finding.cam_angle_deg) + np.array([-1e-7, 0.0, 1e-7])  # of a join, too
            there = study.at_theta(sides).cam.flank.profile_curvature * 1e-3
            assert ((there <= 0.0) | (there > 10.0 / size)).any(), "and at an angle where it is so"
    if told:
        return "undercut"
    assert np.abs(gaps).max() <= 1e-10 * size, "entered, or not touched, and no undercut named"
    return "sound"


def run(seed: int, count: int) -> dict[tuple[str, str, str], list[str]]:
    rng = np.random.default_rng(seed)
    return {case: [check(random_design(rng, *case)) for _ in range(count)] for case in CASES}


def test_every_face_touches_its_profile_and_enters_it_nowhere() -> None:
    outcome = run(15, 10)
    assert min(found.count("sound") for found in outcome.values()) >= 3
    assert sum(found.count("none") for found in outcome.values()) <= 30
    assert sum(found.count("undercut") for found in outcome.values()) >= 10


@pytest.mark.stress
def test_hundreds_of_each() -> None:
    outcome = run(1995, 300)
    assert min(found.count("sound") for found in outcome.values()) >= 100


# -- at fifty digits ----------------------------------------------------------------------------------------


def exact(design: Design, theta: float) -> dict[str, object]:
    """Contact [m], curvature [1/m], place on the face [m] and pressure angle of a flat face: the line n·x = h of the face in the
    cam's frame and its derivative by the cam angle meet in the contact; its path is differentiated as a series."""
    drive, d = design.drive, 1 if design.camshaft.rotation == "ccw" else -1
    at, mm = MP.mpf(theta), MP.mpf(1) / 1000
    y = motion_series(drive.motion, at, segment_at(drive.motion, at))
    f, base = drive.mechanism, MP.mpf(drive.cam.base_radius_mm) * mm
    if isinstance(f, Translating):
        tilt, along = MP.radians(MP.mpf(f.face.face_tilt_deg)), MP.expj(MP.radians(MP.mpf(f.direction_deg)))
        start = (base - f.offset_mm * mm * MP.sin(tilt)) / MP.cos(tilt)
        reference = along * (y + (start + 1j * f.offset_mm * mm))
        normal = turn(y * 0) * (along * MP.expj(tilt))
    else:
        pivot, offset = MP.mpc(f.pivot_x_mm, f.pivot_y_mm) * mm, MP.mpf(f.face.face_offset_mm) * mm
        side = 1 if f.side == "left" else -1
        normal = turn(side * y + (MP.arg(pivot) - side * MP.acos((base - offset) / abs(pivot))))
        reference = pivot + normal * offset
    back = turn(-d * Series.variable(at))
    n, r = normal * back, reference * back
    h = (n.conjugate() * r).real
    n1, h1 = n.slope(), h.slope()
    # x = a n + b i n with n·x = h, n'·x = h'
    along_n = (n1.conjugate() * n).real
    across = (n1.conjugate() * (n * 1j)).real
    path = n * h + n * 1j * ((h1 - along_n * h) / across)
    v, a = path.derivative(1), path.derivative(2)
    contact = path.c[0] / back.c[0]
    travel = MP.expj(MP.radians(f.direction_deg)) if isinstance(f, Translating) else 1j * (contact - pivot)
    cosine = abs(MP.re(MP.conj(travel) * normal.c[0])) / abs(travel)
    # the cam turns against the world: convex where its outline bends towards its inside
    bend = MP.im(MP.conj(v) * a) / abs(v) ** 3 * (MP.im(MP.conj(n.c[0]) * v) / abs(v))
    place = MP.im(MP.conj(normal.c[0]) * (contact - reference.c[0]))
    return {
        "profile": path.c[0],
        "profile_curvature": bend,
        "on_face": place,
        "pressure_angle": MP.acos(min(cosine, MP.one)),
    }


FLATS = {
    "tappet": TAPPET,
    "tilted, offset, clockwise": replace(
        with_drive(
            TAPPET, mechanism=Translating(face=TiltedFlat(face_tilt_deg=-14.0), offset_mm=9.0, direction_deg=35.0)
        ),
        shaft=Shaft("cw", 600.0),
    ),
    "rocker": ROCKER,
    "rocker, left, offset, clockwise": replace(
        edited(edited(ROCKER, "follower.side", "left"), "follower.face_offset_mm", 11.0), shaft=Shaft("cw", 300.0)
    ),
    "rocker, offset inwards": edited(ROCKER, "follower.face_offset_mm", -14.0),
}


@pytest.mark.parametrize("name", FLATS)
def test_a_flat_faces_profile_is_that_of_fifty_digits(name: str) -> None:
    design = FLATS[name]
    theta = np.array([0.4, 1.3, 1.9, 3.3, 4.1, 5.0])
    study = Study(design).at_theta(theta)
    flank = study.cam.flank
    for i, at in enumerate(theta):
        for what, reference in exact(design, float(at)).items():
            value = complex(getattr(flank, what)[i])
            floor = 1e-9 if what == "pressure_angle" else 0.0  # arccos of nearly one
            assert abs(value - complex(reference)) <= 1e-12 * max(abs(value), abs(flank.profile[i])) + floor, (what, at)  # type: ignore


def test_the_contact_on_the_face_is_what_the_tables_call_it(tmp_path: Path) -> None:
    """Translating: x = (Br sin η - ε)/cos η + s sin η - d s' cos η; oscillating: d g/(φ' - d) from the pivot's foot."""
    design = FLATS["tilted, offset, clockwise"]
    study = Study(design, 360)
    s, v = study.motion.y[:2]
    tilt, offset, base, d = math.radians(-14.0), 9e-3, 40e-3, -1.0
    expected = (base * math.sin(tilt) - offset) / math.cos(tilt) + s * math.sin(tilt) - d * v * math.cos(tilt)
    assert np.abs(study.cam.flank.on_face - expected).max() <= 1e-15
    study = Study(ROCKER, 360)
    f = ROCKER.drive.mechanism
    pivot, y, v = complex(f.pivot_x_mm, f.pivot_y_mm) * 1e-3, *study.motion.y[:2]
    mu = np.angle(pivot) + math.acos(45e-3 / abs(pivot)) - y
    g = (np.exp(-1j * mu) * pivot).imag
    assert np.abs(study.cam.flank.on_face - g / (-v - 1.0)).max() <= 1e-15
    assert "pitch_x_mm" not in header(design, tmp_path)
    assert {"contact_on_face_mm", "profile_curvature_per_mm", "pressure_angle_deg", "x_mm"} <= set(
        header(design, tmp_path)
    )


def header(design: Design, folder: Path) -> list[str]:
    from core.__main__ import main

    project.save(design, folder / "d.toml")
    main(["export", str(folder / "d.toml"), "--out", str(folder / "out"), "--samples", "12", "--only", "cam"])
    return (folder / "out" / "profile.csv").read_text("utf-8").splitlines()[0].split(",")


# -- circles, and a cam of constant breadth -----------------------------------------------------------------


def moved(design: Design, y: np.ndarray) -> object:
    """The cam of a design whose motion is given with its derivatives (4, n) at equally spaced angles."""
    theta = np.arange(y.shape[1]) * 2.0 * math.pi / y.shape[1]
    state = MotionState(Angles(theta, np.zeros(theta.size, dtype=int)), y, np.sign(y[1]))
    drive = design.drive
    return envelope(
        solve_mechanism(built(drive.mechanism, drive.cam), state), drive.face, drive.cam, design.sense
    ).flank


@pytest.mark.parametrize("sense", ["ccw", "cw"])
@pytest.mark.parametrize("face", ["roller", "knife", "shoe"])
def test_an_eccentric_circle_under_a_round(face: str, sense: str) -> None:
    """s = e cos θ + √((r + Rr)² - e² sin²θ) - (r + Rr - e), its derivatives by fifty-digit differences."""
    e, r, n = 0.008, 0.05, 24
    size = 0.0 if face == "knife" else 0.012
    part = {"roller": Rolling(), "knife": Knife(), "shoe": Shoe(12.0)}[face]
    cam = RollerCam(1e3 * (r - e), 12.0) if face == "roller" else DiskCam(1e3 * (r - e))
    design = with_drive(TAPPET, mechanism=Translating(face=part), cam=cam)
    design = replace(design, shaft=Shaft(sense, 60.0))

    def lift(at: object) -> object:
        return -e * MP.cos(at) + MP.sqrt((MP.mpf(r) + size) ** 2 - (e * MP.sin(at)) ** 2) - (r + size - e)

    y = np.array([[float(MP.diff(lift, 2 * MP.pi * i / n, k)) for i in range(n)] for k in range(4)])
    flank = moved(design, y)
    centre = flank.profile[0] * (-e / (r - e))  # opposite of where it begins, at the least radius
    assert np.abs(np.abs(flank.profile - centre) - r).max() <= 1e-15
    assert np.abs(flank.profile_curvature * r - 1.0).max() <= 1e-11
    assert face == "knife" or np.abs(flank.pitch_curvature * (r + size) - 1.0).max() <= 1e-11


def test_an_eccentric_circle_under_a_flat_face() -> None:
    """Simple harmonic motion up and down in half a turn each: s = e(1 - cos θ) over a circle of radius Br + e."""
    motion = levels(0.0, (180.0, 24.0, "simple-harmonic"), (180.0, 0.0, "simple-harmonic"))
    for sense, tilt in (("ccw", 0.0), ("cw", 0.0), ("ccw", 20.0)):
        stroke = 24.0 / math.cos(math.radians(tilt))
        design = with_drive(
            TAPPET,
            motion=replace(
                motion, segments=tuple(replace(s, rise=math.copysign(stroke, s.rise)) for s in motion.segments)
            ),
            mechanism=Translating(face=TiltedFlat(face_tilt_deg=tilt), offset_mm=5.0),
        )
        flank = Study(replace(design, shaft=Shaft(sense, 60.0)), 360).cam.flank
        assert np.abs(flank.profile_curvature * 52e-3 - 1.0).max() <= 1e-12
        centre = (
            flank.profile.real.max()
            + flank.profile.real.min()
            + 1j * (flank.profile.imag.max() + flank.profile.imag.min())
        ) / 2
        assert np.abs(np.abs(flank.profile - centre) - 52e-3).max() <= 2e-9, "the box of 360 points is that good"
        assert np.abs(np.abs(flank.profile - 12e-3 * flank.normal[0] * (1.0)) - 52e-3).max() <= 1e-15


def test_a_cam_of_constant_breadth_between_two_flat_faces() -> None:
    """h(ν) + h(ν + 180°) = 2 Br + stroke for rise and return alike in half a turn each."""
    motion = levels(0.0, (180.0, 16.0, "cycloidal"), (180.0, 0.0, "cycloidal"))
    study = Study(with_drive(TAPPET, motion=motion), 720)
    profile = study.cam.flank.profile
    direction = study.cam.flank.support_angle[::24]
    reach = (direction.conj()[:, None] * profile[None, :]).real
    assert np.abs(reach.max(axis=1) - reach.min(axis=1) - 96e-3).max() <= 1e-15


# -- forces of a face that slides ---------------------------------------------------------------------------


def test_the_torque_of_a_flat_tappet_by_hand() -> None:
    """F_c = m a + spring + weight; the face rubs at the distance h from the cam centre: T_c = F_c (s' + μ h)."""
    study = Study(TAPPET, 360)
    s, v, a = study.motion.y[:3]
    force = 0.6 * (study.omega**2 * a + 9.80665) + 120.0 + 8e3 * s
    assert np.abs(study.dynamics.contact - force).max() <= 1e-12 * np.abs(force).max()
    torque = force * (v + 0.1 * (40e-3 + s))
    assert np.abs(study.dynamics.torque - torque).max() <= 1e-12 * np.abs(torque).max()


@pytest.mark.parametrize("side", ["left", "right"])
def test_the_torque_of_a_flat_rocker_by_hand(side: str) -> None:
    """T_c = d/dθ(½ J ω² + V); its mass centre lies on the side of the contact, along the face and 12 degrees from it."""
    design = edited(
        edited(edited(ROCKER, "follower.side", side), "loads.arm_centre_angle_deg", 12.0),
        "follower.face_offset_mm",
        7.0,
    )
    study = Study(design, 180)
    f, load = design.drive.mechanism, design.drive.loads
    y, v, a = study.motion.y[:3]
    sign, pivot = (1.0 if side == "left" else -1.0), complex(f.pivot_x_mm, f.pivot_y_mm) * 1e-3
    contact = study.cam.flank.contact
    foot = pivot + 7e-3 * -study.cam.flank.normal
    towards = (contact - foot) / np.abs(contact - foot)
    centre = towards * load.arm_centre_mm * 1e-3 * np.exp(1j * math.radians(12.0))
    lift = (1j * centre).imag * sign
    inertia = load.arm_inertia_kg_m2 + load.arm_mass_kg * (load.arm_centre_mm * 1e-3) ** 2
    spring = load.preload_nm + load.spring_rate_nm_per_rad * y
    torque = v * (inertia * study.omega**2 * a + load.arm_mass_kg * 9.80665 * lift + spring)
    assert np.abs(study.dynamics.torque - torque).max() <= 1e-11 * np.abs(torque).max()


@pytest.mark.parametrize(("follower", "face", "sense"), spread([case for case in CASES if case[1] != "roller"], 5))
def test_power_and_momentum_balance_with_sliding_friction(follower: str, face: str, sense: str) -> None:
    """The friction's power from the velocities of the two bodies where they touch."""
    rng, held = np.random.default_rng(7), 0
    for _ in range(4):
        design = random_design(rng, follower, face, sense)
        study = Study(design, 120)
        try:
            forces = study.dynamics
        except NoSolution:
            continue
        if study.jam is not None:
            continue
        held += 1
        proof = certificate_of(study, ("dynamics",))
        assert proof["power_balance"].value <= 1e-12
        assert proof["momentum_balance"].kept
        body, at = study.linkage.follower, study.cam.flank.contact
        slip = body.z[1] + 1j * body.angle[1] * (at - body.z[0]) - 1j * design.sense * at
        lost = design.drive.loads.contact.contact_friction * forces.contact * np.abs(slip) * study.omega
        if not study.loading.frictions:
            assert np.abs(forces.friction_power - lost).max() <= 1e-12 * np.abs(lost).max()
        assert np.abs((slip.conj() * study.cam.flank.normal).real).max() <= 1e-12 * np.abs(slip).max()
    assert held


def test_a_steep_shoe_jams_on_its_friction() -> None:
    """On the rise of a translating round the friction takes μ tan ψ of the lever: it jams from μ = 1/tan ψ on."""
    design = edited(edited(TAPPET, "follower.face", "knife"), "loads.friction", 0.0)
    steepest = math.tan(extremes_of(Study(design), "cam")["pressure_angle"].high.value)
    for factor, jams in ((0.999, False), (1.001, True)):
        study = Study(edited(design, "loads.contact_friction", factor / steepest), 720)
        found = [finding for finding in findings_of(study, ("dynamics",)) if finding.code == "contact-jamming"]
        assert bool(found) == jams
        for finding in found:
            assert finding.field == "loads.contact_friction"
            assert finding.values["factor"] == pytest.approx(factor, rel=1e-9)
            endless = replace(finding, values={"factor": math.inf}).message
            assert "the cam's force has no lever arm at" in endless
            assert "inf" not in endless


# -- what cannot be -----------------------------------------------------------------------------------------


def test_a_concave_stretch_under_a_flat_face_names_the_base_radius_that_would_do() -> None:
    for design, small in ((TAPPET, 6.0), (ROCKER, 10.0)):
        (finding,) = [
            f for f in findings_of(Study(edited(design, "cam.base_radius_mm", small))) if f.code == "undercut"
        ]
        wanted = finding.values["base_radius_mm"]
        assert f"a base radius of {wanted:.5g} mm is sufficient" in finding.message
        for radius, undercut in ((wanted, False), (wanted * 0.9995, True)):
            codes = [f.code for f in findings_of(Study(edited(design, "cam.base_radius_mm", radius)), ("cam",))]
            assert ("undercut" in codes) == undercut


def test_the_base_radius_under_a_rocker_is_found_close_to_its_pivot_too() -> None:
    """The first guess lies beyond the largest base circle that the face can lie on."""
    steep = replace(
        levels(0.0, (60, 0.0, "dwell"), (120, 26.0, "cycloidal"), (60, 26.0, "dwell"), (120, 0.0, "cycloidal")),
        unit="deg",
    )
    far = with_drive(ROCKER, motion=steep)
    (finding,) = [f for f in findings_of(Study(far), ("cam",)) if f.code == "undercut"]
    assert f"a base radius of {finding.values['base_radius_mm']:.5g} mm is sufficient" in finding.message
    for part, undercut in ((1.0, False), (0.999, True)):
        other = edited(far, "cam.base_radius_mm", float(finding.values["base_radius_mm"]) * part)
        assert ("undercut" in {f.code for f in findings_of(Study(other), ("cam",))}) == undercut


def test_the_curvature_at_a_cusp_is_infinite_and_no_figure_stands_for_it() -> None:
    for design, small in ((TAPPET, 6.0), (ROCKER, 10.0)):
        study = Study(edited(design, "cam.base_radius_mm", small))
        found, radius = (
            extremes_of(study, "cam")["profile_curvature"],
            lambda theta, study=study: study.at_theta(theta).cam.flank,
        )
        assert (found.low.value, found.high.value) == (-math.inf, math.inf)
        for end in (found.low, found.high):
            assert abs(radius(np.array([end.theta])).profile_radius[0]) < 1e-5  # a hundredth of a millimetre
        assert math.isfinite(extremes_of(Study(design), "cam")["profile_curvature"].high.value)


def test_the_radius_of_curvature_of_a_flat_faced_cam_is_exact_to_the_limit() -> None:
    """Translating: ρ = Br + s + s'', so the base radius at which it vanishes is that of s + s'' least."""
    least = min((Study(TAPPET).at_theta(np.linspace(0.0, 6.28, 4001)).motion.y[[0, 2]]).sum(axis=0))
    base = -1e3 * least
    assert "undercut" not in {
        f.code for f in findings_of(Study(edited(TAPPET, "cam.base_radius_mm", base * 1.0001)), ("cam",))
    }
    assert "undercut" in {
        f.code for f in findings_of(Study(edited(TAPPET, "cam.base_radius_mm", base * 0.9999)), ("cam",))
    }


def test_the_pressure_angle_of_a_flat_face_is_its_own_doing() -> None:
    tilted = edited(TAPPET, "follower.face_tilt_deg", -32.0)
    (finding,) = [f for f in findings_of(Study(tilted), ("cam",)) if f.code == "pressure-angle"]
    assert (finding.field, finding.values["value"]) == ("follower.face_tilt_deg", pytest.approx(32.0, rel=1e-12))
    assert finding.message.endswith("limit 30 deg: reduce the tilt of the face")
    offset = edited(edited(ROCKER, "follower.face_offset_mm", -110.0), "follower.pivot_x_mm", 190.0)
    (finding,) = [f for f in findings_of(Study(offset), ("cam",)) if f.code == "pressure-angle"]
    assert finding.field == "follower.face_offset_mm"


def test_a_face_too_narrow_names_the_width_that_it_needs() -> None:
    study = Study(TAPPET)
    reach = 1e3 * max(abs(end.value) for end in vars(extremes_of(study, "cam")["contact_on_face"]).values())
    for half, narrow in ((reach * 1.000001, False), (reach * 0.99, True)):
        found = list(findings_of(Study(edited(TAPPET, "follower.face_half_width_mm", half)), ("cam",)))
        assert [f.code for f in found] == ["face-too-narrow"] * narrow
        for finding in found:
            assert finding.values["needed_mm"] == pytest.approx(reach, rel=1e-9)
            assert finding.field == "follower.face_half_width_mm"
            assert finding.message.endswith("widen the face, or move its centre")
    moved = edited(edited(TAPPET, "follower.face_half_width_mm", reach), "follower.face_centre_mm", 3.0)
    (finding,) = findings_of(Study(moved), ("cam",))
    assert finding.values["needed_mm"] == pytest.approx(reach + 3.0, rel=1e-9)


def test_a_pivot_within_the_base_circle_and_an_offset_beyond_it_are_named() -> None:
    near = edited(edited(ROCKER, "follower.pivot_x_mm", 20.0), "follower.pivot_y_mm", 10.0)
    with pytest.raises(
        NoAssembly, match=r"follower\.pivot_x_mm: the flat face cannot lie on the base circle: .* farther than 45 mm"
    ):
        _ = Study(near).linkage
    arm = edited(edited(load(EXAMPLES / "rocker_cam.toml"), "follower.face", "shoe"), "follower.pivot_x_mm", 300.0)
    with pytest.raises(NoAssembly, match=r"the shoe cannot reach the base circle: .*base radius \+ shoe radius"):
        _ = Study(arm).linkage
    knife = edited(edited(TAPPET, "follower.face", "knife"), "follower.offset_mm", 41.0)
    with pytest.raises(
        NoAssembly, match=r"the knife edge cannot reach the base circle: offset 41 mm; must stay within \+-40 mm"
    ):
        _ = Study(knife).linkage


def test_a_face_that_turns_as_fast_as_the_cam_and_one_that_passes_its_centre_are_named() -> None:
    motion = ROCKER.drive.motion
    assert motion is not None
    spans = (60.0, 12.0, 60.0, 228.0)
    segments = tuple(replace(segment, span_deg=span) for segment, span in zip(motion.segments, spans, strict=True))
    fast = with_drive(ROCKER, motion=replace(motion, segments=segments))
    turned = replace(fast, shaft=replace(fast.camshaft, rotation="cw"))
    with pytest.raises(
        NoCam, match=r"motion\.segments: the flat face turns as fast as the cam.* at cam angle 6[0-9.]+\.\.\."
    ):
        _ = Study(turned).cam
    low = with_drive(TAPPET, motion=levels(-45.0, (90.0, -30.0, "cycloidal"), (270.0, -45.0, "cycloidal")))
    with pytest.raises(NoCam, match=r"cam\.base_radius_mm: the flat face passes the cam centre by 5 mm"):
        _ = Study(low).cam


# -- files and edits ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["card_picker", "rocker_cam", "transfer_lift", "four_bar_coupler_cam"])
def test_a_face_is_changed_to_any_other_and_back(name: str) -> None:
    """What the new face needs comes with it, what the old one had goes, and the file reads as it was written."""
    first = load(EXAMPLES / f"{name}.toml")
    path = first.drive.face_path
    for one, other in pairwise(("roller", "shoe", "knife", "roller", "shoe", "roller")):
        changed = edited(edited(first, path, one), path, other)
        assert faults(changed) == []
        assert get(changed, path) == other == changed.drive.face.face
        assert loads(dumps(changed)) == changed
        assert (changed.drive.loads.contact is None) == (other == "roller")
        _ = Study(changed, 36).cam
    there_and_back = edited(edited(first, path, "shoe"), path, "roller")
    assert there_and_back.drive == first.drive


@pytest.mark.parametrize("name", ["card_picker", "rocker_cam"])
def test_a_flat_face_comes_and_goes(name: str) -> None:
    first = load(EXAMPLES / f"{name}.toml")
    flat = edited(first, "follower.face", "flat")
    assert isinstance(flat.drive.face, Flat)
    assert loads(dumps(flat)) == flat
    text = dumps(flat)
    assert "roller_radius_mm" not in text
    assert "arm_mm =" not in text
    assert "contact_friction = 0.0" in text
    again = edited(flat, "follower.face", "roller")
    assert faults(again) == []
    assert "cam.roller_radius_mm" in again.assumed
    _ = Study(again, 36).cam


def told(name: str, **changes: dict[str, object]) -> list[str]:
    """The faults of an example's file with these entries, None for none, in its tables."""
    table = tomllib.loads((EXAMPLES / f"{name}.toml").read_text("utf-8"))
    for section, entries in changes.items():
        table[section] = {key: value for key, value in {**table[section], **entries}.items() if value is not None}
    with pytest.raises(DesignError) as caught:
        loads(tomli_w.dumps({**table, "assumed": []}))
    return [str(fault) for fault in caught.value.faults]


def test_a_flat_face_where_there_is_none_is_refused_in_one_line() -> None:
    flat = {"face": "flat", "face_half_width_mm": 20.0, "face_tilt_deg": 3.0}
    assert told("transfer_lift", follower=flat, cam={"roller_radius_mm": None}, loads={"contact_friction": 0.1}) == [
        "follower.face = 'flat': unknown word; allowed: roller | knife | shoe"
    ]
    assert told("four_bar_coupler_cam", cam={**flat, "roller_radius_mm": None}) == [
        "cam.face = 'flat': unknown word; allowed: roller | knife | shoe"
    ]


def test_what_belongs_to_another_face_is_a_fault() -> None:
    assert told("card_picker", follower={"face": "knife"}) == [
        'cam.roller_radius_mm = 10.0: only with face = "roller"; allowed: base_radius_mm | form | thickness_mm | bore_mm | '
        "hub_mm | hub_length_mm | "
        "keyway_width_mm | keyway_depth_mm | keyway_angle_deg | cutter_radius_mm | material | roller_material | youngs_modulus_gpa | "
        "poisson_ratio | roller_youngs_modulus_gpa | roller_poisson_ratio | roller_load_rating_n"
    ]
    assert told("card_picker", follower={"face": "shoe"}, cam={"roller_radius_mm": None}) == [
        "follower.shoe_radius_mm: missing; allowed: above 0 ... 1e+09 mm"
    ]
    assert told("card_picker", loads={"contact_friction": 0.1}) == [
        "loads.contact_friction = 0.1: a roller rolls on the cam; allowed: for a flat face, a knife edge or a shoe"
    ]
    table = tomllib.loads((EXAMPLES / "card_picker.toml").read_text("utf-8"))
    assert faults(loads(tomli_w.dumps(table | {"loads": table["loads"] | {"contact_friction": 0.0}}))) == [], (
        "none is none"
    )
    unrolled = {"roller_mass_kg": None, "roller_inertia_kg_m2": None}
    (arm,) = told("rocker_cam", follower={"face": "flat"}, cam={"roller_radius_mm": None}, loads=unrolled)
    assert arm.startswith(
        'follower.arm_mm = 90.0: only with face = "roller" or "knife" or "shoe"; allowed: face | face_offset_mm'
    )
    rolled = told(
        "rocker_cam",
        follower={"face": "flat", "arm_mm": None},
        cam={"roller_radius_mm": None},
        loads={"roller_mass_kg": 0.2},
    )
    assert any(fault.startswith('loads.roller_mass_kg = 0.2: only with face = "roller" or') for fault in rolled)


def test_a_face_nobody_asks_for_curvature_computes_none() -> None:
    clear_caches()
    study = Study(ROCKER, 36)
    flank = study.cam.flank
    _ = flank.profile, flank.pressure_angle
    assert 2 not in study.linkage.follower.origin.computed_orders
    assert callable(vars(flank)["profile_radius"])
    assert callable(vars(flank)["profile_curvature"])
    _ = flank.profile_curvature
    assert 2 in study.linkage.follower.origin.computed_orders


@pytest.mark.parametrize("name", ["tappet", "tilted, offset, clockwise"])
def test_a_flat_tappet_is_drawn_elsewhere(name: str) -> None:
    """Offset and base radius follow from where the reference point is put; the motion stays what it is."""
    design = FLATS[name]
    here = Study(design).at_theta(np.array([1.2]))
    at = complex(here.linkage.follower.origin[0][0])
    along = np.exp(1j * math.radians(design.drive.mechanism.direction_deg))
    to = at + along * (0.004 + 0.003j)
    moved = move_joint(design, here.linkage, "roller", to)
    assert faults(moved) == []
    assert abs(complex(Study(moved).at_theta(np.array([1.2])).linkage.follower.origin[0][0]) - to) <= 2e-9
    assert joints_of(design)["roller"].label == "flat face"


def test_a_face_that_a_follower_cannot_have_is_named() -> None:
    with pytest.raises(DesignError, match=r"follower\.face = 'flat': unknown word; allowed: roller \| knife \| shoe"):
        edited(load(EXAMPLES / "transfer_lift.toml"), "follower.face", "flat")
