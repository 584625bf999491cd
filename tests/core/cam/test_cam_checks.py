"""Checks of a cam: the user's own limits, radii of curvature, hub, bore, keyway and cutter, and the profile against itself; each
against a dense scan, and with a design that just meets it and one that just misses."""

import contextlib
import io
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from mechanisms import PUSHER, levels
from sampled import spread, stressed

from core.__main__ import main
from core.design import (
    NO_LIMITS,
    Design,
    DiskCam,
    Drive,
    Knife,
    Motion,
    NamedCurve,
    Oscillating,
    OscillatingLoads,
    RollerCam,
    Segment,
    Shaft,
    Translating,
    TranslatingLoads,
    edited,
    get,
    with_drive,
)
from core.errors import DesignError, NoSolution
from core.findings import WARNING, Finding
from core.output.export import files
from core.output.report import report
from core.project import dumps, load, loads, to_table
from core.study import Study, extremes_of, findings_of
from core.study.stages import evaluations

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
ROCKER = load(EXAMPLES / "rocker_cam.toml")
LIFT = load(EXAMPLES / "transfer_lift.toml")
COUPLER = load(EXAMPLES / "four_bar_coupler_cam.toml")
TAPPET = load(EXAMPLES / "tappet_flat.toml")
FAMILIES = {"lift": LIFT, "pusher": PUSHER, "rocker": ROCKER, "coupler": COUPLER, "tappet": TAPPET}
POINTS = 40000


def found(design: Design, code: str, stage: str = "cam") -> list[Finding]:
    return [finding for finding in findings_of(Study(design), (stage,)) if finding.code == code]


def with_values(design: Design, **values: float) -> Design:
    """Paths with two underscores for the dot."""
    for path, value in values.items():
        design = edited(design, path.replace("__", "."), value)
    return design


def dense(design: Design) -> Study:
    """At the middles of many equal steps."""
    return Study(design).at_theta((np.arange(POINTS) + 0.5) * 2.0 * np.pi / POINTS)


def bends(curve: np.ndarray, sense: float) -> np.ndarray:
    """1/radius [1/mm] of the circle through each point of a closed curve [m] and its neighbours, convex positive for a cam that
    turns in this sense."""
    before, after = np.roll(curve, 1), np.roll(curve, -1)
    area = ((curve - before).conj() * (after - curve)).imag
    sides = np.abs(curve - before) * np.abs(after - curve) * np.abs(after - before)
    with np.errstate(divide="ignore"):
        return -sense * 2.0 * area / sides * 1e-3


def limit_rows(design: Design) -> dict[str, dict[str, float]]:
    rows = json.loads(files(Study(design, 36))["summary.json"])["limits"]
    return {row["name"]: row for row in rows}


# -- figures against a dense scan --------------------------------------------------------------------------


@pytest.mark.parametrize("name", spread(FAMILIES, 2))
def test_pressure_angles_of_rise_and_return_are_those_of_a_dense_scan(name: str) -> None:
    design = FAMILIES[name]
    study, rows = dense(design), limit_rows(design)
    y = study.motion.y[0]
    moving = np.roll(y, -1) - np.roll(y, 1)
    for stretch, sign in (("rise", 1.0), ("return", -1.0)):
        here = sign * moving > 1e-12 * np.abs(y).max()
        angle = np.rad2deg(study.cam.flank.pressure_angle)
        row = rows[f"pressure_angle_{stretch}_deg"]
        assert row["value"] == pytest.approx(angle[here].max(), abs=1e-3)
        assert row["value"] >= angle[here].max() - 1e-9
        there = Study(design).at_theta(np.deg2rad(row["cam_angle_deg"]) + np.array([-1e-9, 0.0, 1e-9]))
        assert np.rad2deg(there.cam.flank.pressure_angle).max() == pytest.approx(row["value"], abs=1e-6)
        assert (row["limit"], row["source"]) == (
            30.0 if name in ("pusher", "tappet") else 45.0,
            "VDI 2142; Norton ch. 7",
        )


@pytest.mark.parametrize("name", spread(FAMILIES, 2))
def test_the_smallest_radii_are_those_of_a_dense_scan(name: str) -> None:
    design = FAMILIES[name]
    study, rows = dense(design), limit_rows(design)
    curves = {"": study.cam.flank.profile}
    if name != "tappet":
        curves["pitch_"] = study.cam.flank.pitch
    theta = np.rad2deg(study.theta)
    for prefix, curve in curves.items():
        bend = bends(curve, study.sense)
        for sort, sign in (("convex", 1.0), ("concave", -1.0)):
            row = rows.get(f"{prefix}{sort}_radius_mm")
            assert (row is not None) == bool((sign * bend).max() > 1e-9)
            if row is not None:
                sharpest = float((sign * bend).max())
                assert row["value"] * sharpest == pytest.approx(1.0, rel=2e-3)
                near = np.abs((theta - row["cam_angle_deg"] + 180.0) % 360.0 - 180.0) < 0.05
                assert (sign * bend)[near].max() == pytest.approx(sharpest, rel=2e-3), "and stands where it is said"


def test_the_report_shows_figures_and_limits_side_by_side() -> None:
    text = report(Study(edited(LIFT, "limits.pressure_angle_rise_deg", 12.5), 36))
    rows = {line.split("  ")[0]: line for line in text.split("Limits of the cam")[1].splitlines()}
    assert rows["Pressure angle, rise"].split()[-2:] == ["12.500", "own"]
    assert rows["Pressure angle, return"].endswith("VDI 2142; Norton ch. 7")
    assert "1420.2" in rows["Smallest concave radius of the profile"]


# -- the user's own limits ---------------------------------------------------------------------------------

OWN = [
    ("pressure_angle_rise_deg", "pressure-angle-rise", "cam", 1.0),
    ("pressure_angle_return_deg", "pressure-angle-return", "cam", 1.0),
    ("convex_radius_mm", "convex-radius", "cam", -1.0),
    ("concave_radius_mm", "concave-radius", "cam", -1.0),
    ("contact_force_n", "contact-force", "dynamics", 1.0),
]


@pytest.mark.parametrize(("key", "code", "stage", "side"), spread(OWN, 2))
def test_an_own_limit_is_exceeded_just_beyond_it_and_not_before(key: str, code: str, stage: str, side: float) -> None:
    wide = edited(LIFT, f"limits.{key}", 80.0 if side > 0.0 else 1e9)
    reached = limit_rows(wide)[key]
    for by, beyond in ((1e-9, False), (-1e-9, True)):
        limited = edited(LIFT, f"limits.{key}", reached["value"] * (1.0 + side * by))
        findings = found(limited, code, stage)
        assert [f.severity for f in findings] == [WARNING] * beyond
        for finding in findings:
            assert finding.cam_angle_deg == reached["cam_angle_deg"]
            assert finding.values["value"] == reached["value"]
            assert "your limit" in finding.message
            assert finding in findings_of(Study(limited))
    assert limit_rows(limited)[key]["source"] == "own"


def test_the_usual_limit_stands_beside_the_users_own() -> None:
    """Each says what was exceeded; a lax one of the user does not silence the usual one."""
    steep = with_values(ROCKER, cam__base_radius_mm=38.0, limits__pressure_angle_rise_deg=80.0)
    codes = {finding.code for finding in findings_of(Study(steep), ("cam",))}
    strict = edited(steep, "limits.pressure_angle_rise_deg", 20.0)
    (own,) = found(strict, "pressure-angle-rise")
    assert own.message.endswith("your limit 20 deg: enlarge the base radius, or lengthen the rise")
    assert {f.code for f in findings_of(Study(strict), ("cam",))} == codes | {"pressure-angle-rise"}
    tilted = with_values(TAPPET, follower__face_tilt_deg=-20.0, limits__pressure_angle_return_deg=15.0)
    (own,) = found(tilted, "pressure-angle-return")
    assert (own.field, own.values["remedy"]) == ("follower.face_tilt_deg", "reduce the tilt of the face")


def test_a_limit_of_the_user_computes_nothing_anew() -> None:
    findings_of(Study(LIFT))
    before = dict(evaluations)
    findings_of(Study(edited(LIFT, "limits.contact_pressure_mpa", 900.0)))
    assert dict(evaluations) == before


def test_limits_stand_in_the_file_where_there_are_any() -> None:
    assert "limits" not in dumps(LIFT)
    assert get(LIFT, "limits.convex_radius_mm") is None
    limited = with_values(LIFT, limits__pressure_angle_rise_deg=28.0, limits__contact_pressure_mpa=850.0)
    assert dumps(limited).endswith("\n[limits]\npressure_angle_rise_deg = 28.0\ncontact_pressure_mpa = 850.0\n")
    assert loads(dumps(limited)) == limited
    assert loads(dumps(limited)).drive.limits != NO_LIMITS
    assert edited(limited, "limits.pressure_angle_rise_deg", None).drive.limits.pressure_angle_rise_deg is None


@pytest.mark.parametrize(
    ("limits", "path", "says"),
    [
        ({"pressure_angle_rise_deg": 91.0}, "limits.pressure_angle_rise_deg", "above 0 ... 90 °"),
        ({"pressure_angle_return_deg": 0.0}, "limits.pressure_angle_return_deg", "above 0 ... 90 °"),
        ({"convex_radius_mm": -3.0}, "limits.convex_radius_mm", "above 0"),
        ({"contact_force_n": "much"}, "limits.contact_force_n", "must be a number"),
        ({"contact_pressure_mpa": 0}, "limits.contact_pressure_mpa", "> 0 MPa"),
        ({"pressure_angel_rise_deg": 30.0}, "limits.pressure_angel_rise_deg", "pressure_angle_rise_deg"),
        (7, "limits", "must be a table"),
    ],
)
def test_wrong_limits_are_named(limits: object, path: str, says: str) -> None:
    with pytest.raises(DesignError) as refused:
        loads(tomli_w.dumps(to_table(PUSHER) | {"limits": limits}))
    (fault,) = refused.value.faults
    assert fault.path == path
    assert says in str(refused.value)


def test_limits_of_a_linkage_without_a_cam_are_refused() -> None:
    bar = to_table(load(EXAMPLES / "four_bar.toml"))
    with pytest.raises(DesignError, match=r"limits = .*these are limits of a cam, but the design has no cam"):
        loads(tomli_w.dumps(bar | {"limits": {"convex_radius_mm": 3.0}}))


# -- hub, bore, keyway, cutter -----------------------------------------------------------------------------


def test_hub_and_bore_must_lie_within_the_profile() -> None:
    nearest = 1e3 * np.abs(dense(LIFT).cam.flank.profile).min()
    for what in ("hub", "bore"):
        for diameter, meets in ((2.0 * nearest * 0.999999, False), (2.0 * nearest * 1.000001, True)):
            findings = found(edited(LIFT, f"cam.{what}_mm", diameter), "profile-meets-hub")
            assert [(f.field, f.values["what"]) for f in findings] == [(f"cam.{what}_mm", what)] * meets
            for finding in findings:
                assert finding.values["radius_mm"] == pytest.approx(nearest, rel=1e-9)


def test_the_keyway_must_lie_within_the_profile_where_it_is() -> None:
    """A keyway 14 mm wide in a bore of 70 mm; where its angle is not known it may lie anywhere."""
    keyed = with_values(PUSHER, cam__bore_mm=70.0, cam__keyway_width_mm=14.0)
    local = 1e3 * dense(PUSHER).cam.flank.profile
    assert found(edited(keyed, "cam.keyway_depth_mm", 9.99), "profile-meets-keyway") == []
    (anywhere,) = found(edited(keyed, "cam.keyway_depth_mm", 10.01), "profile-meets-keyway")
    assert anywhere.values["overlap_mm"] == pytest.approx(0.01, rel=1e-6)
    for angle in (0.0, 95.0, 200.0, 310.0):
        turned = local * np.exp(-1j * math.radians(angle))
        over = (np.abs(turned.imag) <= 7.0) & (turned.real > 0.0)
        floor = float(turned.real[over].min()) - 35.0
        placed = edited(keyed, "cam.keyway_angle_deg", angle)
        for depth, meets in ((floor - 1e-2, False), (floor + 1e-2, True)):
            findings = found(edited(placed, "cam.keyway_depth_mm", depth), "profile-meets-keyway")
            assert len(findings) == meets, angle
            for finding in findings:
                there = (
                    Study(PUSHER).at_theta(np.array([math.radians(finding.cam_angle_deg)])).cam.flank.profile[0] * 1e3
                )
                own = there * np.exp(-1j * math.radians(angle))
                assert own.real < 35.0 + depth
                assert abs(own.imag) < 7.0


def test_the_cutter_must_go_into_the_hollow() -> None:
    hollow = limit_rows(LIFT)["concave_radius_mm"]
    for radius, large in ((hollow["value"] * (1.0 - 1e-9), False), (hollow["value"] * (1.0 + 1e-9), True)):
        findings = found(edited(LIFT, "cam.cutter_radius_mm", radius), "cutter-too-large")
        assert [f.cam_angle_deg for f in findings] == [hollow["cam_angle_deg"]] * large
    assert found(edited(ROCKER, "cam.cutter_radius_mm", 1e4), "cutter-too-large") == [], "none is hollow"


def test_of_a_groove_the_outer_flank_is_hollow_where_the_pitch_curve_bulges() -> None:
    """And its cutter must go between the flanks; the force limit counts on either flank."""
    groove = load(EXAMPLES / "groove.toml")
    roller, play = groove.drive.cam.roller_radius_mm, groove.drive.cam.form.play_mm
    rows = limit_rows(groove)
    outer = bends(dense(groove).cam.flanks[1].profile, Study(groove).sense)
    assert rows["outer_concave_radius_mm"]["value"] * outer.max() == pytest.approx(1.0, rel=2e-3)
    assert rows["outer_concave_radius_mm"]["value"] == pytest.approx(
        rows["pitch_convex_radius_mm"]["value"] + roller + play, rel=1e-12
    )
    for cutter, wide in ((roller + 0.5 * play - 1e-6, False), (roller + 0.5 * play + 1e-6, True)):
        assert len(found(edited(groove, "cam.cutter_radius_mm", cutter), "cutter-wider-than-groove")) == wide
    force = extremes_of(Study(groove), "dynamics")["contact_force"]
    most = max(abs(force.low.value), abs(force.high.value))
    for limit, beyond in ((most * (1.0 + 1e-9), False), (most * (1.0 - 1e-9), True)):
        assert len(found(edited(groove, "limits.contact_force_n", limit), "contact-force", "dynamics")) == beyond


# -- the profile against itself ----------------------------------------------------------------------------


def arm(side: str, swing: float) -> Design:
    """A knife edge on an arm that passes the line from its pivot to the cam centre and goes on."""
    motion = Motion(
        0.0,
        (
            Segment(60.0, 0.0, NamedCurve("dwell")),
            Segment(60.0, -swing, NamedCurve("cycloidal")),
            Segment(100.0, 0.0, NamedCurve("dwell")),
            Segment(140.0, swing, NamedCurve("cycloidal")),
        ),
        "deg",
    )
    follower = Oscillating(face=Knife(), arm_mm=60.0, pivot_x_mm=100.0, pivot_y_mm=0.0, side=side)
    return Design("through", Shaft("ccw", 60.0), (Drive(motion, follower, DiskCam(55.0), OscillatingLoads()),))


def lobe(rng: np.random.Generator) -> Design:
    """A roller with an offset and a stroke many times the base radius: a lobe, some with a neck that is too thin."""
    roller, base, stroke, offset = (
        rng.uniform(12, 20),
        rng.uniform(2, 12),
        rng.uniform(180, 400),
        rng.uniform(-0.9, 0.9),
    )
    up, top, down = rng.uniform(25, 60), rng.uniform(0.5, 40), rng.uniform(25, 60)
    motion = levels(
        0.0,
        (100.0, 0.0, "dwell"),
        (float(up), float(stroke), "3-4-5"),
        (float(top), float(stroke), "dwell"),
        (float(down), 0.0, "3-4-5"),
        (float(260.0 - up - top - down), 0.0, "dwell"),
    )
    follower = Translating(offset_mm=float(offset * (base + roller)))
    return Design(
        "lobe", Shaft("cw", 60.0), (Drive(motion, follower, RollerCam(float(base), float(roller)), TranslatingLoads()),)
    )


def crossing_steps(curve: np.ndarray) -> list[tuple[int, int]]:
    """Which steps of a closed polyline cross which, two by two."""
    to = np.roll(curve, -1) - curve
    pairs = []
    for i in range(curve.size - 1):
        gap, own, others = curve[i + 2 :] - curve[i], to[i], to[i + 2 :]
        area = (own.conjugate() * others).imag
        with np.errstate(divide="ignore", invalid="ignore"):
            along = (gap.conj() * others).imag / area
            across = (gap.conj() * own).imag / area
        hits = np.flatnonzero((along >= 0.0) & (along < 1.0) & (across >= 0.0) & (across < 1.0))
        pairs += [(i, i + 2 + int(j)) for j in hits if (i, i + 2 + j) != (0, curve.size - 1)]
    return pairs


def check_crossing(design: Design, points: int = 1200) -> str:
    """``undercut``, ``none``, ``crosses`` or ``plain``; asserts that the finding says what a dense polyline does."""
    study = Study(design, points)
    try:
        profile = study.cam.flank.profile
    except NoSolution:
        return "none"
    findings = findings_of(study, ("cam",))
    if any(finding.code == "undercut" for finding in findings):
        return "undercut"
    told = [finding for finding in findings if finding.code == "self-intersection"]
    seen = crossing_steps(profile)
    if bool(told) != bool(seen) and points < 10000:  # it all but touches itself
        return check_crossing(design, 8 * points)
    assert bool(told) == bool(seen)
    for finding in told:
        assert finding.values["crossings"] >= 1.0
        angles = np.deg2rad([finding.values["first_deg"], finding.values["other_deg"]])
        there = study.at_theta(angles).cam.flank.profile
        assert abs(there[1] - there[0]) <= 1e-10 * np.abs(profile).max(), "both pass the same place"
        assert finding.cam_angle_deg == finding.values["first_deg"]
        steps = (angles / (2.0 * np.pi) * points).tolist()
        near = any(max(abs(i + 0.5 - steps[0]), abs(j + 0.5 - steps[1])) < 5.0 for i, j in seen)
        if not near and points < 10000:  # it crosses at so small an angle that a coarse polyline does so elsewhere
            return check_crossing(design, 8 * points)
        assert near
    return "crosses" if told else "plain"


@pytest.mark.stress
def test_crossings_of_many_lobes() -> None:
    rng = np.random.default_rng(1995)
    outcome = [check_crossing(lobe(rng)) for _ in range(3000)]
    assert outcome.count("crosses") >= 50


@pytest.mark.parametrize("side", spread(["left", "right"], 1))
def test_a_profile_that_crosses_itself_far_apart_is_found(side: str) -> None:
    design = arm(side, 60.0)
    assert check_crossing(design, 3600) == "crosses"
    (finding,) = found(design, "self-intersection")
    assert finding.values["other_deg"] - finding.values["first_deg"] > 45.0, "far apart, and every curvature is right"
    assert not {"undercut"} & {f.code for f in findings_of(Study(design), ("cam",))}


@pytest.mark.parametrize("count", [12, stressed(32)])
def test_crossings_are_those_of_a_dense_polyline_and_no_others(count: int) -> None:
    rng = np.random.default_rng(15)
    outcome = [check_crossing(lobe(rng)) for _ in range(count)]
    assert outcome.count("crosses") >= 3 * count / 32
    assert outcome.count("plain") >= 5 * count / 32


@pytest.mark.stress
def test_a_neck_that_just_holds_does_not_cross() -> None:
    """Between the largest roller that leaves a neck and the smallest that does not."""

    def design(roller: float) -> Design:
        motion = levels(
            0.0,
            (100.0, 0.0, "dwell"),
            (42.0, 270.0, "3-4-5"),
            (13.0, 270.0, "dwell"),
            (28.0, 0.0, "3-4-5"),
            (177.0, 0.0, "dwell"),
        )
        # the pitch curve stays
        return Design(
            "lobe",
            Shaft("ccw", 60.0),
            (Drive(motion, Translating(), RollerCam(24.0 - roller, roller), TranslatingLoads()),),
        )

    low, high = 1.0, 17.0
    assert not found(design(low), "self-intersection")
    assert found(design(high), "self-intersection")
    while high - low > 1e-3:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if found(design(middle), "self-intersection") else (middle, high)
    gone, left = (Study(design(radius), 14400).cam.flank.profile for radius in (high + 0.01, low - 0.01))
    assert crossing_steps(gone[3600:9600])
    assert not crossing_steps(left[3600:9600])


# -- bad designs, the user's way ---------------------------------------------------------------------------

BAD = [
    (
        "tappet_flat",
        {"cam.base_radius_mm": 5.0},
        1,
        r"undercut: under the flat face .* at [0-9.]+ deg.* base radius of .* is sufficient",
    ),
    (
        "tappet_flat",
        {"follower.face_half_width_mm": 3.0},
        1,
        r"leaves the flat face at [0-9.]+ deg.* half the face's width is 3 mm",
    ),
    ("rocker_cam", {"follower.pivot_x_mm": 300.0}, 2, r"cannot reach the base circle"),
    ("rocker_flat", {"follower.pivot_x_mm": 10.0, "follower.pivot_y_mm": 5.0}, 2, r"cannot lie on the base circle"),
    (
        "groove",
        {"cam.roller_radius_mm": 20.0, "cam.base_radius_mm": 20.0, "cam.hub_mm": None, "cam.bore_mm": None},
        1,
        r"two sections of the groove overlap at [0-9.]+ deg and at [0-9.]+ deg",
    ),
    ("tappet_knife", {"follower.offset_mm": 90.0}, 2, r"cannot reach the base circle: offset 90 mm"),
]


@pytest.mark.parametrize(("name", "values", "code", "says"), BAD, ids=[f"{row[0]} {next(iter(row[1]))}" for row in BAD])
def test_a_bad_design_is_named(
    name: str, values: dict[str, float | None], code: int, says: str, tmp_path: Path
) -> None:
    design = load(EXAMPLES / f"{name}.toml")
    for path, value in values.items():
        design = edited(design, path, value)
    if name == "groove":  # a lobe with a foot that is thinner than two rollers
        motion = levels(
            0.0, (20.0, 120.0, "cycloidal"), (20.0, 120.0, "dwell"), (20.0, 0.0, "cycloidal"), (300.0, 0.0, "dwell")
        )
        design = with_drive(design, motion=motion)
    (tmp_path / "bad.toml").write_text(dumps(design), "utf-8")
    printed, faults = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(faults):
        assert main(["check", str(tmp_path / "bad.toml")]) == code
    lines = (printed.getvalue() if code == 1 else faults.getvalue()).splitlines()
    assert [line for line in lines if re.search(says, line)], lines
