"""core.cam and core.instant_centres: against the pitch curve differentiated at fifty digits, brute force, relative
velocity and mirrors."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from mechanisms import (
    ANGLES,
    LAYOUT_DESIGNS,
    LIFT,
    PUSHER,
    buildable,
    levels,
    mirrored,
    with_cam,
    with_drive,
    with_follower,
    with_shaft,
)
from references import EPS, MP, Series, Shape, Solved, cam_shape, off, placed, reach_of, sense_of, sensitivity, solved
from sampled import spread
from scipy.optimize import brentq, minimize_scalar

from core.cam import CamShape, centre_residual, envelope, relative_motion, tangency_residual
from core.design import Design
from core.errors import NoCam
from core.findings import ERROR, WARNING
from core.instant_centres import cam_follower_centre
from core.mechanism.kinematics import Kinematics, Pose
from core.motion import TURN
from core.numerics.derivatives import Derivatives
from core.study import Study, certificate_of, extremes_of, findings_of

DESIGNS = {**LAYOUT_DESIGNS, "lift": LIFT, "pusher": PUSHER}
TURNED = {f"{name} turned round": with_shaft(d, rotation="cw" if d.shaft.rotation == "ccw" else "ccw")
          for name, d in DESIGNS.items() if name in ("c", "lift", "pusher")}  # fmt: skip

# A rise to a peak and straight back.
PEAKED = with_drive(PUSHER, motion=levels(0.0, (60.0, 0.0, "dwell"), (60.0, 20.0, "cycloidal"), (60.0, 0.0, "cycloidal"),
                                          (180.0, 0.0, "dwell")))  # fmt: skip

# 34 of the follower's position and derivatives (test_linkage), 10 more for t, w, x, 12 for the two curvatures.
ROUNDINGS = 34 + 10 + 12


def figures(design: Design, there: Solved) -> list[object]:
    s: Shape = cam_shape(design, there)
    return [
        s.pitch.c[0],
        s.profile,
        s.normal,
        s.pressure_angle,
        s.curvature.derivative(0),
        s.curvature.derivative(1),
        s.profile_curvature,
    ]


NAMES = (
    "pitch",
    "profile",
    "normal",
    "pressure_angle",
    "pitch_curvature",
    "pitch_curvature_slope",
    "profile_curvature",
)


def check_shape(design: Design, theta: float) -> None:
    study = Study(design).at_theta(np.array([theta]))
    exact, size = sensitivity(figures, design, theta, study.motion.y[:, 0])
    t, w, x = (float(abs(c[0])) for c in relative_motion(study.linkage, study.design.shaft.sense).all[1:])
    # a pressure angle near 0 is as good as the normal; curvatures are sums of products of t, w, x
    floors = {"pressure_angle": 1.0, "pitch_curvature": w / t**2, "pitch_curvature_slope": x / t**2 + 3.0 * w**2 / t**3}
    for name, reference, reach in zip(NAMES, exact, size, strict=True):
        value = complex(getattr(study.cam.flank, name)[0])
        floor = floors.get(name, float(abs(reference)))
        assert off(value, reference) <= ROUNDINGS * EPS * (reach + floor), name


PLACES = [(name, theta) for name in (*DESIGNS, *TURNED) for theta in (0.3, 1.1, 2.5, 3.4, 5.6)]


@pytest.mark.parametrize(("name", "theta"), spread(PLACES, 4))
def test_profile_pressure_angle_and_curvatures_follow_from_the_pitch_curve(name: str, theta: float) -> None:
    check_shape({**DESIGNS, **TURNED}[name], theta)


@settings(max_examples=13)
@given(buildable(), ANGLES)
def test_any_cam_follows_from_its_pitch_curve(design: Design, theta: float) -> None:
    check_shape(design, theta)


@pytest.mark.parametrize("name", DESIGNS)
def test_the_relative_motion_is_the_pitch_curves_own_derivatives(name: str) -> None:
    """c' e^{idθ}, c'' e^{idθ}, c''' e^{idθ} of the pitch curve c = R e^{-idθ}."""
    design = DESIGNS[name]
    theta = 2.5
    study = Study(design).at_theta(np.array([theta]))

    def cam_frame_rotation(design: Design, there: Solved) -> list[object]:
        pitch = cam_shape(design, there).pitch
        return [pitch.derivative(k) * MP.expj(sense_of(design) * there.theta) for k in (1, 2, 3)]

    exact, size = sensitivity(cam_frame_rotation, design, theta, study.motion.y[:, 0])
    for got, reference, reach in zip(
        relative_motion(study.linkage, study.design.shaft.sense).all[1:], exact, size, strict=True
    ):
        assert off(complex(got[0]), reference) <= ROUNDINGS * EPS * (reach + float(abs(reference)))


# -- the roller touches, and enters nowhere ---------------------------------------------------------------


@pytest.mark.parametrize("name", spread([*DESIGNS, *TURNED], 3))
def test_the_least_distance_from_roller_centre_to_profile_is_the_roller_radius(name: str) -> None:
    """By search: the profile's nearest point, wherever it is, from 12 positions of the roller."""
    design = {**DESIGNS, **TURNED}[name]
    study, dense = Study(design, 12), Study(design, 3600)
    radius, reach = design.drive.cam.roller_radius_mm * 1e-3, float(reach_of(design))
    points, theta = dense.cam.flank.profile, dense.theta
    for centre, own in zip(study.cam.flank.pitch, study.theta, strict=True):

        def distance(at: float, centre: complex = centre) -> float:
            return float(np.abs(study.at_theta(np.array([at])).cam.flank.profile - centre)[0])

        sampled = np.abs(points - centre)
        nearest = int(np.argmin(sampled))
        step = TURN / 3600
        found = minimize_scalar(
            distance,
            bounds=(theta[nearest] - 1.5 * step, theta[nearest] + 1.5 * step),
            method="bounded",
            options={"xatol": 1e-9},
        )
        # near its least the distance is flat: the angle's 1e-9 costs its square, and rounding what positions cost
        least = min(float(found.fun), float(sampled[nearest]), distance(own))
        assert abs(least - radius) <= 64 * EPS * reach + 1e-18 / radius
        assert distance(own) == pytest.approx(radius, abs=64 * EPS * reach), "and it touches where it should"


def test_the_certificates_tangency_sees_a_dent_a_wrong_radius_and_an_undercut() -> None:
    study = Study(PUSHER, 360)
    flank, radius, reach = study.cam.flank, 0.012, study.reach
    assert tangency_residual(study.cam, study.design.drive.face, reach) <= 64 * EPS
    dented = flank.profile.copy()
    dented[100] += 1e-6 * (flank.pitch[100] - flank.profile[100]) / radius
    for profile, positions in (
        (dented, 360),
        (flank.profile + 1e-6 * (flank.pitch - flank.profile) / radius, 120),
        (flank.profile - 1e-6 * (flank.pitch - flank.profile) / radius, 120),
    ):
        wrong = replace(study.cam, flanks=(replace(flank, profile=profile),))
        assert tangency_residual(wrong, study.design.drive.face, reach, positions) == pytest.approx(
            1e-6 / reach, rel=1e-3
        )
    undercut = Study(with_cam(PEAKED, base_radius_mm=7.0, roller_radius_mm=50.0), 3600)
    assert tangency_residual(undercut.cam, undercut.design.drive.face, undercut.reach) > 1e-2


# -- instant centre ---------------------------------------------------------------------------------------


def check_centre(design: Design, theta: float) -> None:
    """At Q the point of the cam and the point of the follower have one velocity: i d Q = R' + iφ'(Q - R)."""
    study = Study(design).at_theta(np.array([theta]))
    kinematics, d = study.linkage, design.shaft.sense
    centre = cam_follower_centre(kinematics, d)
    body = kinematics.follower
    if abs(centre.weight[0]) < 1e-3:
        return
    q = centre.finite[0]
    of_cam = 1j * d * q
    of_follower = body.z[1, 0] + 1j * body.angle[1, 0] * (q - body.z[0, 0])
    size = abs(q) * (1.0 + abs(body.angle[1, 0])) + np.abs(body.z[:2, 0]).sum() * (1.0 + abs(body.angle[1, 0]))
    assert abs(of_cam - of_follower) <= 16 * EPS * size / abs(centre.weight[0]) * float(kinematics.condition.max())
    # the common normal passes through it
    normal = study.cam.flank.normal[0]
    lever = abs((normal.conjugate() * (q - body.z[0, 0])).imag)
    assert lever <= 16 * EPS * float(kinematics.condition.max()) * (abs(q) + abs(body.z[0, 0])) / abs(centre.weight[0])


@pytest.mark.parametrize("name", spread([*DESIGNS, *TURNED], 3))
def test_cam_and_follower_move_alike_at_their_instant_centre(name: str) -> None:
    for theta in np.linspace(0.05, 6.2, 29):
        check_centre({**DESIGNS, **TURNED}[name], float(theta))


@settings(max_examples=30)
@given(buildable(), ANGLES)
def test_any_instant_centre_has_one_velocity(design: Design, theta: float) -> None:
    check_centre(design, theta)


@pytest.mark.parametrize("rotation", ["ccw", "cw"])
def test_a_follower_that_turns_as_fast_as_the_cam_has_its_centre_at_infinity(rotation: str) -> None:
    """φ' = d: relative to the cam the follower moves without turning, along the circles about the pivot's distance."""
    design = with_shaft(LIFT, rotation=rotation)
    study = Study(design, 72)
    d, kinematics = design.shaft.sense, study.linkage
    angle = np.array(kinematics.follower.angle)
    angle[1] = d
    pivot, arm = kinematics.bodies["arm"].z, kinematics.follower.z - kinematics.bodies["arm"].z
    z = np.array(kinematics.follower.z)
    z[1] = 1j * d * arm[0]
    bodies = {
        **kinematics.bodies,
        "roller": Pose.of(z, angle, kinematics.follower.points),
        "arm": Pose.of(pivot, angle, kinematics.bodies["arm"].points),
    }
    fast = replace(kinematics, bodies=bodies)
    centre = cam_follower_centre(fast, d)
    assert (centre.weight == 0.0).all()
    assert np.isinf(centre.finite.real).all()
    # in the direction from cam centre to pivot
    assert np.abs((centre.point.conj() * pivot[0]).imag).max() <= EPS * np.abs(pivot[0]).max() ** 2
    shape = envelope(fast, design.drive.face, design.drive.cam, d)
    assert np.abs(centre_residual(shape)).max() <= 16 * EPS
    # the relative velocity is that of the pivot about the cam: across the line to the pivot
    assert np.abs(shape.relative_velocity - -1j * d * pivot[0]).max() <= 8 * EPS * np.abs(arm[0]).max()


def test_the_proof_holds_where_the_follower_overtakes_the_cam() -> None:
    """A return so short that the arm turns faster than the cam passes φ' = d twice."""
    steep = levels(
        150.0, (170.0, 150.0, "dwell"), (10.0, 0.0, "cycloidal"), (10.0, 150.0, "cycloidal"), (170.0, 150.0, "dwell")
    )
    for rotation in ("ccw", "cw"):
        design = with_shaft(with_drive(LIFT, motion=steep), rotation=rotation)
        study = Study(design, 36_000)
        turn = study.linkage.follower.angle[1] - design.shaft.sense
        assert turn.min() < 0.0 < turn.max(), "it does overtake"
        residual = centre_residual(study.cam)
        assert residual.max() <= 16 * EPS
        finite = cam_follower_centre(study.linkage, design.shaft.sense).finite
        far = np.abs(finite).max()
        assert far > 100.0 * abs(complex(0.873746, -0.065))
        # it leaves on one side of the line and comes back on the other
        along = (finite / complex(0.873746, -0.065)).real
        assert along.min() < -100.0
        assert along.max() > 100.0


def test_the_certificates_centre_sees_a_wrong_centre() -> None:
    study = Study(PUSHER, 360)
    flank, centre = study.cam.flank, study.cam.centre

    def with_centre(point: np.ndarray) -> CamShape:
        return CamShape((replace(flank, centre=replace(centre, point=point)),), study.sense)

    assert centre_residual(with_centre(-centre.point)).max() > 1e-2
    assert centre_residual(with_centre(centre.point + 1e-9)).max() > 1e-9


# -- mirrors ----------------------------------------------------------------------------------------------


def check_mirror(design: Design) -> None:
    one, other = (Study(d, 24).cam.flank for d in (design, mirrored(design)))
    condition = Study(design, 24).linkage.condition.max()
    bound = 2 * ROUNDINGS * EPS * condition * float(reach_of(design)) * 8.0
    speed = np.abs(Study(design, 24).cam.relative_velocity).min() / float(reach_of(design))
    assert np.abs(-one.profile.conjugate() - other.profile).max() <= bound * condition / speed
    assert np.abs(-one.normal.conjugate() - other.normal).max() <= bound * condition / speed / float(reach_of(design))
    for name in ("pressure_angle", "pitch_curvature"):
        a, b = getattr(one, name), getattr(other, name)
        assert np.abs(a - b).max() <= 2 * ROUNDINGS * EPS * (condition / speed) ** 3 * max(1.0, np.abs(a).max())


@pytest.mark.parametrize("name", [*DESIGNS, *TURNED])
def test_the_cam_of_a_mirrored_design_is_the_mirror_image(name: str) -> None:
    check_mirror({**DESIGNS, **TURNED}[name])


@settings(max_examples=13)
@given(buildable())
def test_any_mirrored_cam_is_the_mirror_image(design: Design) -> None:
    check_mirror(design)


def test_a_symmetric_motion_gives_cams_for_both_senses_that_are_mirror_images() -> None:
    """An in-line follower cannot tell the senses apart but by which flank comes first."""
    design = with_drive(
        with_follower(PUSHER, offset_mm=0.0, direction_deg=90.0),
        motion=levels(0.0, (120.0, 20.0, "3-4-5"), (120.0, 20.0, "dwell"), (120.0, 0.0, "3-4-5")),
    )
    ccw, cw = (Study(with_shaft(design, rotation=r), 360).cam.flank for r in ("ccw", "cw"))
    assert np.abs(-ccw.profile.conjugate() - cw.profile).max() <= 64 * EPS * 0.077
    assert ccw.pitch_curvature == pytest.approx(cw.pitch_curvature, rel=256 * EPS)
    # and being symmetric about 180 degrees, the one read backwards is the other
    assert np.abs(ccw.profile - np.roll(cw.profile[::-1], 1)).max() <= 64 * EPS * 0.077


# -- closed forms of the translating roller ---------------------------------------------------------------


@pytest.mark.parametrize("rotation", ["ccw", "cw"])
@pytest.mark.parametrize("offset", [0.0, 7.0, -11.0])
def test_a_translating_cam_keeps_to_the_textbooks_formulas(rotation: str, offset: float) -> None:
    """tan ψ = (s' + dε)/S, κ_p = [(s'+dε)(2s'+dε) + S(S-s'')]/[(s'+dε)² + S²]^{3/2}, Q = -i d s' e."""
    design = with_shaft(with_follower(PUSHER, offset_mm=offset), rotation=rotation)
    study = Study(design, 360)
    d, eps = design.shaft.sense, offset * 1e-3
    _, v, a, _ = study.motion.y
    s = math.sqrt(0.057**2 - eps**2) + study.motion.y[0]
    flank = study.cam.flank
    assert np.tan(flank.pressure_angle) == pytest.approx(np.abs(v + d * eps) / s, rel=64 * EPS, abs=64 * EPS)
    curvature = ((v + d * eps) * (2 * v + d * eps) + s * (s - a)) / ((v + d * eps) ** 2 + s**2) ** 1.5
    assert flank.pitch_curvature == pytest.approx(curvature, abs=256 * EPS * np.abs(curvature).max())
    axis = np.exp(1j * math.radians(70.0))
    assert np.abs(study.cam.centre.finite - -1j * d * v * axis).max() <= 8 * EPS * np.abs(v).max()


def test_an_offset_to_the_side_that_the_rise_leans_to_lowers_the_pressure_angle() -> None:
    """A cam turning counter-clockwise pushes an upward follower best from its right: an offset to the left is worse."""

    def worst(offset: float) -> float:
        design = with_follower(PUSHER, offset_mm=offset)
        rise = Study(design, 3600)
        return float(rise.cam.flank.pressure_angle[rise.motion.velocity_sign > 0].max())

    assert worst(-7.0) < worst(0.0) < worst(7.0)


def test_a_dwell_gives_a_circle_about_the_cam_centre() -> None:
    study = Study(with_drive(PUSHER, motion=levels(10.0, (360.0, 10.0, "dwell"))), 100)
    radius = abs(complex(math.sqrt(0.057**2 - 0.007**2) + 0.010, 0.007))
    assert study.cam.flank.pitch_curvature == pytest.approx(1.0 / radius, rel=16 * EPS)
    assert np.abs(study.cam.flank.profile) == pytest.approx(radius - 0.012, rel=16 * EPS)
    assert study.cam.flank.profile_curvature == pytest.approx(1.0 / (radius - 0.012), rel=32 * EPS)
    assert np.abs(study.cam.flank.pitch_curvature_slope).max() <= 64 * EPS / radius


# -- limits -----------------------------------------------------------------------------------------------


def sharpest(design: Design, low: float, high: float) -> tuple[float, float]:
    """The largest pitch curvature within a segment and its cam angle, by the root of its slope at fifty digits."""
    grid = np.linspace(low, high, 200)
    best = max(grid, key=lambda t: float(cam_shape(design, solved(design, t)).curvature.c[0]))
    at = MP.findroot(
        lambda t: cam_shape(design, solved(design, t)).curvature.c[1], (best - 1e-3, best + 1e-3), tol=1e-30
    )
    return float(cam_shape(design, solved(design, at)).curvature.c[0]), float(at)


def test_undercut_is_told_from_the_sharpest_place_on_and_not_before() -> None:
    """The roller grows while the pitch curve stays: its smallest radius, of the top of the rise, is the limit."""
    curvature, at = sharpest(PEAKED, math.radians(90.0), math.radians(120.0))
    other, there = sharpest(PEAKED, math.radians(120.0), math.radians(150.0))
    if other > curvature:
        curvature, at = other, there
    limit = 1e3 / curvature
    for factor, told in ((1 - 1e-9, False), (1 + 1e-9, True), (1.2, True), (0.5, False)):
        radius = limit * factor
        tried = with_cam(PEAKED, base_radius_mm=57.0 - radius, roller_radius_mm=radius)
        found = [f for f in findings_of(Study(tried), ("cam",)) if f.code == "undercut"]
        assert bool(found) == told, factor
        for f in found:
            assert f.severity == ERROR
            assert f.field == "cam.roller_radius_mm"
            assert f.cam_angle_deg == pytest.approx(math.degrees(at), abs=1e-4)  # flat there: 1e-16 is 1e-8 away
            assert f.values["pitch_radius_mm"] == pytest.approx(limit, rel=1e-11)
            shown = [float(text) for text in re.findall(r"([\d.]+) mm", f.message)]
            assert shown == pytest.approx([limit, radius], rel=1e-4)
            assert shown[0] < shown[1] or "just below" in f.message, "six digits do not show the excess"


def test_a_pressure_angle_just_above_its_limit_is_shown_with_the_digits_of_its_excess() -> None:
    """The base radius for 30 degrees, by bisection: no finding there, and a little below it one that shows its excess."""

    def worst(base: float) -> float:
        return math.degrees(
            extremes_of(Study(with_cam(PUSHER, base_radius_mm=base)), "cam")["pressure_angle"].high.value
        )

    radius = brentq(lambda base: worst(base) - 30.0, 10.0, 80.0, xtol=1e-13)
    for excess in (1e-5, 1e-8):
        study = Study(with_cam(PUSHER, base_radius_mm=radius * (1.0 - excess)))
        (found,) = (f for f in findings_of(study, ("cam",)) if f.code == "pressure-angle")
        words, shown = re.findall(r"pressure angle (just above )?([\d.]+) deg", found.message)[0]
        assert 0.0 <= float(shown) - 30.0 < 1e2 * excess
        assert bool(words) == (float(shown) == 30.0), "six digits at most"
        assert "limit 30 deg" in found.message
    exact = [radius + k * math.ulp(radius) for k in range(-3, 4)]
    assert not any(
        f.code == "pressure-angle"
        for r in exact
        for f in findings_of(Study(with_cam(PUSHER, base_radius_mm=r)), ("cam",))
    )


@pytest.mark.parametrize(
    ("design", "bases", "limit"), [(PUSHER, (45.0, 35.0, 25.0, 18.0), 30.0), (LIFT, (400.0, 300.0, 150.0, 100.0), 45.0)]
)
def test_the_pressure_angle_is_measured_against_the_limit_of_its_follower(
    design: Design, bases: tuple[float, ...], limit: float
) -> None:
    """30 degrees for a guide, 45 for an arm: the same motion on smaller and smaller base circles."""
    told = []
    for base in bases:
        study = Study(with_cam(design, base_radius_mm=base))
        found = [f for f in findings_of(study, ("cam",)) if f.code == "pressure-angle"]
        worst = extremes_of(study, "cam")["pressure_angle"].high
        assert bool(found) == (math.degrees(worst.value) > limit)
        for f in found:
            assert (f.severity, f.field, f.values["limit"]) == (WARNING, "cam.base_radius_mm", limit)
            assert f.values["value"] == pytest.approx(math.degrees(worst.value), rel=4 * EPS)
            assert f.message == (
                f"pressure angle {f.values['value']:.5g} deg at {f.cam_angle_deg:.4g} deg, limit {limit:g} deg: "
                "enlarge the base radius, or lengthen the rise"
            )
            assert f.cam_angle_deg == pytest.approx(math.degrees(worst.theta), rel=4 * EPS)
            assert f"{math.degrees(worst.value):.5g} deg" in f.message
        told.append(bool(found))
    assert told == sorted(told)
    assert (told[0], told[-1]) == (False, True)


def test_a_roller_that_covers_the_cam_centre_is_told_with_the_cam_angles() -> None:
    """The centre comes within the roller's radius between the angles where the lift's own radius is used up."""
    design = with_drive(
        with_follower(PUSHER, offset_mm=0.0),
        motion=levels(
            0.0,
            (90.0, 0.0, "dwell"),
            (90.0, -50.0, "constant-velocity"),
            (60.0, -50.0, "dwell"),
            (120.0, 0.0, "constant-velocity"),
        ),
    )
    with pytest.raises(NoCam) as caught:
        _ = Study(design, 3600).cam
    ((first, last),) = caught.value.cam_angles
    assert first == pytest.approx(90.0 + 90.0 * 45.0 / 50.0, abs=0.1 + 1e-9)
    assert last == pytest.approx(360.0 - 120.0 * 45.0 / 50.0, abs=0.1 + 1e-9)
    assert "7 mm" in str(caught.value)
    assert "negative" in str(caught.value)
    fits = with_drive(design, motion=levels(0.0, (180.0, -44.999, "cycloidal"), (180.0, 0.0, "cycloidal")))
    assert np.abs(Study(fits, 360).cam.flank.profile).min() == pytest.approx(1e-6, rel=1e-6)


def test_a_roller_that_stands_still_on_the_cam_is_a_cusp_and_told() -> None:
    study = Study(LIFT, 8)
    kinematics: Kinematics = study.linkage
    z = np.array(kinematics.follower.z)
    z[1, 5] = 1j * z[0, 5]
    cusp = replace(
        kinematics, bodies={**kinematics.bodies, "roller": replace(kinematics.follower, origin=Derivatives.of(z))}
    )
    with pytest.raises(NoCam, match="cusp") as caught:
        envelope(cusp, LIFT.drive.face, LIFT.drive.cam, 1.0)
    assert caught.value.cam_angles == ((pytest.approx(225.0), pytest.approx(225.0)),)


@settings(max_examples=20)
@given(buildable())
@example(LIFT)
@example(PUSHER)
def test_every_cam_carries_its_own_proof(design: Design) -> None:
    study = Study(design, 180)
    proof = certificate_of(study, ("linkage", "cam"))
    assert set(proof) == {"loop_closure", "instant_centre", "roller_tangency"}
    assert proof["loop_closure"].kept
    assert proof["instant_centre"].kept
    undercut = any(f.code == "undercut" for f in findings_of(study, ("cam",)))
    assert proof["roller_tangency"].kept or undercut
    y = study.motion.y[:, 7]
    here = placed(design, study.theta[7], Series([v / math.factorial(k) for k, v in enumerate(map(float, y))]))
    assert abs(complex(here.roller.c[0])) == pytest.approx(abs(study.cam.reference[7]), rel=1e-11)


@pytest.mark.parametrize("name", [*DESIGNS, *TURNED])
def test_the_profile_velocity_adds_up_to_the_profile(name: str) -> None:
    """By Gauss quadrature over a stretch of every piece of the motion."""
    study = Study({**DESIGNS, **TURNED}[name])
    place, weight = np.polynomial.legendre.leggauss(16)
    for start, end in zip(study.program.starts, study.program.ends, strict=True):
        first, half = start + 0.3 * (end - start), min(0.1 * (end - start), 0.02)
        there = study.at_theta(np.concatenate(([first, first + 2.0 * half], first + half * (place + 1.0)))).cam.flank
        gained = there.profile[1] - there.profile[0]
        assert abs(half * (there.profile_velocity[2:] @ weight) - gained) < 1e-13 * abs(there.profile[0])
