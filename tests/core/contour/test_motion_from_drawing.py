"""Motions from drawings: against the textbook's formulas for circles, tangent cams and three-arc cams, and in and out again."""

import cmath
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from drawn_cams import NosedCam, drawn
from face_cases import FACES, random_design
from mechanisms import PUSHER, levels, with_cam, with_follower, with_shaft
from sampled import spread

from core.__main__ import main
from core.contour import DrawingError, TracedMotion, read_contour, trace
from core.design import Design, DiskCam, Knife, TiltedFlat, with_drive
from core.motion import program
from core.project import load, save
from core.study import Study, findings_of

UP = with_cam(with_follower(PUSHER, offset_mm=0.0, direction_deg=0.0), roller_radius_mm=12.0)
TANGENT, THREE_ARC = NosedCam(), NosedCam(flank=70.0)
ANGLES = np.linspace(0.0, 2.0 * math.pi, 721)[:-1] + 1e-4


def traced(design: Design, data: bytes, unit: str = "", centre: complex | None = None) -> TracedMotion:
    return trace(design, read_contour(data, "cam.dxf", unit, centre))


def lifts(result: TracedMotion, theta: np.ndarray = ANGLES) -> np.ndarray:
    """The motion (n,) in its unit."""
    motion = result.design.drive.motion
    assert motion is not None
    compiled = program(motion)
    return compiled.state(compiled.angles(theta)).y[0] / motion.scale


def flat(tilt: float = 0.0, offset: float = 0.0, direction: float = 0.0) -> Design:
    follower = with_follower(UP, face=TiltedFlat(face_tilt_deg=tilt), offset_mm=offset, direction_deg=direction)
    return with_drive(follower, cam=DiskCam(30.0))


# -- the eccentric circle ---------------------------------------------------------------------------------

RADIUS, CENTRE = 40.0, 9.0 * cmath.exp(0.4j)
ECCENTRIC = drawn(("circle", (CENTRE.real, CENTRE.imag), RADIUS))


@pytest.mark.parametrize("rotation", ["ccw", "cw"])
def test_an_eccentric_circle_under_a_roller_beside_the_centre(rotation: str) -> None:
    """S = Re C + √((ρ + r)² - (ε - Im C)²), C the centre seen along the guide."""
    sense, offset, guide = (1.0 if rotation == "ccw" else -1.0), 7.0, math.radians(70.0)
    design = with_shaft(with_cam(with_follower(PUSHER, offset_mm=offset), roller_radius_mm=12.0), rotation=rotation)
    result = traced(design, ECCENTRIC)
    c = CENTRE * np.exp(1j * (sense * ANGLES - guide))
    reach = RADIUS - abs(CENTRE) + 12.0
    wanted = c.real + np.sqrt(52.0**2 - (offset - c.imag) ** 2) - math.sqrt(reach**2 - offset**2)
    assert result.base_radius_mm == pytest.approx(RADIUS - abs(CENTRE), abs=1e-12)
    assert lifts(result) == pytest.approx(wanted, abs=1e-9)
    assert result.jumps == ()


@pytest.mark.parametrize("rotation", ["ccw", "cw"])
def test_an_eccentric_circle_under_a_tilted_face(rotation: str) -> None:
    """The face along m stands ρ + C·m from the cam centre, which the guide meets farther out by 1/cos of the tilt."""
    sense = 1.0 if rotation == "ccw" else -1.0
    result = traced(with_shaft(flat(15.0, 4.0, 30.0), rotation=rotation), ECCENTRIC)
    h = RADIUS + (CENTRE * np.exp(1j * (sense * ANGLES - math.radians(45.0)))).real
    wanted = (h - (RADIUS - abs(CENTRE))) / math.cos(math.radians(15.0))
    assert lifts(result) == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize(("side", "sign"), [("left", 1.0), ("right", -1.0)])
def test_an_eccentric_circle_under_an_arm(side: str, sign: float) -> None:
    """The triangle of arm, pivot and the circle's centre, which goes round the cam centre."""
    design = random_design(np.random.default_rng(4), "oscillating", "roller", "ccw")
    design = with_follower(
        with_cam(design, roller_radius_mm=10.0), side=side, arm_mm=95.0, pivot_x_mm=90.0, pivot_y_mm=-40.0
    )
    result = traced(design, ECCENTRIC)
    pivot, c = complex(90.0, -40.0), CENTRE * np.exp(1j * ANGLES)

    def angle(far: np.ndarray, side_opposite: float) -> np.ndarray:
        return np.arccos((95.0**2 + far**2 - side_opposite**2) / (2.0 * 95.0 * far))

    arm = np.angle((c - pivot) / -pivot) + sign * angle(np.abs(c - pivot), RADIUS + 10.0)
    base = sign * angle(np.array([abs(pivot)]), RADIUS - abs(CENTRE) + 10.0)
    assert lifts(result) == pytest.approx(np.rad2deg(sign * (arm - base)), abs=1e-9)


# -- cams with flanks and a nose --------------------------------------------------------------------------


def test_the_tangent_cam_of_the_textbook() -> None:
    """Roller on the flank: (r₁ + r₀)(1 - cos ψ)/cos ψ, ψ from where the flank begins; on the nose L cos β + √((r₂ + r₀)² -
    L² sin² β) - r₁ - r₀, β from the nose's middle; both meet where tan ψ = L sin φ/(r₁ + r₀)."""
    result = traced(UP, drawn(*TANGENT.shapes))
    half = math.acos((TANGENT.base - TANGENT.nose) / TANGENT.distance)
    on_base = TANGENT.base + 12.0
    met = math.atan(TANGENT.distance * math.sin(half) / on_base)
    # the nose stands before the follower at cam angle 0; the flank comes half an angle before that
    psi, beta = half - np.abs(np.angle(np.exp(1j * ANGLES))), np.angle(np.exp(1j * ANGLES))
    flank = on_base * (1.0 - np.cos(psi)) / np.cos(psi)
    nose = (
        TANGENT.distance * np.cos(beta) + np.sqrt(20.0**2 - (TANGENT.distance * np.sin(beta)) ** 2 + 0j).real - on_base
    )
    wanted = np.where(psi < 0.0, 0.0, np.where(psi < met, flank, nose))
    assert lifts(result) == pytest.approx(wanted, abs=1e-9)
    places = [math.degrees(a) % 360.0 for a in (half - met, half, -half, met - half)]
    assert [jump.angle for jump in result.jumps] == pytest.approx(places, abs=1e-10)
    leaves = [jump for jump in result.jumps if jump.after == 0.0]
    assert [jump.order for jump in result.jumps] == [2, 2, 2, 2]
    assert leaves[0].before == pytest.approx(on_base * math.radians(1.0) ** 2, rel=1e-12)


def test_a_three_arc_cam_under_a_flat_face() -> None:
    """On a flank of radius R: (R - r₁)(1 - cos ψ); on the nose L cos β + r₂ - r₁ (Roberts: the cam with convex flanks)."""
    result = traced(flat(), drawn(*THREE_ARC.shapes))
    first, last = (cmath.phase(n) for n in THREE_ARC.normals)
    beta = np.abs(np.angle(np.exp(1j * ANGLES)))
    flank = (THREE_ARC.flank - THREE_ARC.base) * (1.0 - np.cos(first - beta))
    nose = THREE_ARC.distance * np.cos(beta) + THREE_ARC.nose - THREE_ARC.base
    assert lifts(result) == pytest.approx(np.where(beta > first, 0.0, np.where(beta > last, flank, nose)), abs=1e-9)
    assert [jump.angle for jump in result.jumps] == pytest.approx(
        [math.degrees(a) % 360.0 for a in (last, first, -first, -last)], abs=1e-10
    )


def test_a_flat_face_turns_over_on_a_straight_flank() -> None:
    """There the velocity jumps by the flank's length, per radian."""
    result = traced(flat(), drawn(*TANGENT.shapes))
    p, q = TANGENT.joints
    assert [jump.order for jump in result.jumps] == [1, 1]
    assert result.jumps[0].after - result.jumps[0].before == pytest.approx(abs(q - p) * math.radians(1.0), rel=1e-12)
    assert [f.code for f in findings_of(Study(result.design), ("motion",))] == ["jump-velocity", "jump-velocity"]


@pytest.mark.parametrize(
    ("follower", "face"), spread([(a, b) for a, faces in FACES.items() if a != "linkage" for b in faces], 5)
)
def test_in_and_out_again(follower: str, face: str) -> None:
    """The envelope of the motion is the drawing again."""
    rng = np.random.default_rng(3)
    design = random_design(rng, follower, face, str(rng.choice(("ccw", "cw"))))
    size = design.drive.cam.base_radius_mm / 25.0
    cam = NosedCam(25.0 * size, 20.0 * size, 7.0 * size, 34.0 * size)
    result = traced(design, drawn(*cam.shapes))
    profile = 1e3 * Study(result.design, 36_000 if face in ("roller", "flat") else 3600).cam.flank.profile
    assert cam.distance_of(profile).max() < 1e-9
    assert [jump.order for jump in result.jumps] == [2, 2, 2, 2]
    codes = [f.code for f in findings_of(Study(result.design), ("motion",))]
    assert codes == ["jump-acceleration"] * 4


def test_base_circle_and_nose_seen_from_the_cam_centre_are_dwells() -> None:
    """Circles about the cam centre, joined by radial lines whose ends a knife edge climbs along arcs."""
    shapes = [("arc", (0, 0), 30.0, 90.0, 360.0), ("arc", (0, 0), 34.0, 20.0, 70.0)]
    a, b, c, d = (cmath.rect(r, math.radians(t)) for r, t in ((30.0, 0.0), (34.0, 20.0), (34.0, 70.0), (30.0, 90.0)))
    shapes += [("line", (p.real, p.imag), (q.real, q.imag)) for p, q in ((a, b), (c, d))]
    edge = with_drive(with_follower(UP, face=Knife()), cam=DiskCam(30.0))
    result = traced(edge, drawn(*shapes))
    motion = result.design.drive.motion
    assert motion is not None
    assert [s.curve.law for s in motion.segments] == ["dwell", "table", "dwell", "table"]
    assert [s.span_deg for s in motion.segments] == pytest.approx([270.0, 20.0, 50.0, 20.0], abs=1e-9)
    assert motion.start == 0.0
    assert [jump.order for jump in result.jumps] == [1, 1, 1, 1]


def test_a_roller_bridges_a_hollow_that_it_does_not_fill() -> None:
    """Beside a notch of two lines it turns from one flank's path to the other's: the velocity jumps where it lies on both."""
    notch = cmath.rect(44.0, 0.0)
    a, b = cmath.rect(50.0, math.radians(12.0)), cmath.rect(50.0, math.radians(-12.0))
    shapes = [
        ("arc", (0, 0), 50.0, 12.0, 348.0),
        ("line", (a.real, a.imag), (44.0, 0.0)),
        ("line", (44.0, 0.0), (b.real, b.imag)),
    ]
    result = traced(UP, drawn(*shapes))
    (jump,) = [jump for jump in result.jumps if jump.order == 1]
    assert jump.angle == pytest.approx(0.0, abs=1e-9)
    assert jump.after == pytest.approx(-jump.before, rel=1e-9)
    # it lies on both lines, or on both corners where the lines are too short for it
    flank = (a - notch) / abs(a - notch)
    on_lines = 44.0 + 12.0 / flank.imag
    centre = on_lines if (on_lines - 44.0) * flank.real <= abs(a - notch) else a.real + math.sqrt(12.0**2 - a.imag**2)
    assert result.base_radius_mm == pytest.approx(centre - 12.0, abs=1e-9)


# -- drawings ---------------------------------------------------------------------------------------------


def test_one_polyline_backwards_in_inches_elsewhere_is_the_same_cam() -> None:
    """As arcs and lines in any order, or as a polyline clockwise, scaled, and with the cam centre off the origin."""
    p, q = TANGENT.joints
    half, by = cmath.phase(p), 3.0 - 2.0j
    corners = [
        (p, 0.0),
        (q, -math.tan(half / 2.0)),
        (q.conjugate(), 0.0),
        (p.conjugate(), -math.tan((math.pi - half) / 2.0)),
    ]
    rows = [((z / 25.4 + by).real, (z / 25.4 + by).imag, b) for z, b in corners]
    polyline = drawn(("lwpolyline", rows, {"format": "xyb", "close": True}), unit=0)
    one, other = traced(UP, drawn(*TANGENT.shapes)), traced(UP, polyline, "in", by)
    assert other.base_radius_mm == pytest.approx(25.0, abs=1e-9)
    assert lifts(other) == pytest.approx(lifts(one), abs=1e-9)


def test_a_profile_written_as_arcs_comes_in_again(tmp_path: Path) -> None:
    save(PUSHER, tmp_path / "pusher.toml")
    command = [
        "profile",
        str(tmp_path / "pusher.toml"),
        "--out",
        str(tmp_path / "cam.dxf"),
        "--as",
        "arcs",
        "--tolerance",
        "1e-3",
    ]
    assert main(command) == 0
    result = traced(PUSHER, (tmp_path / "cam.dxf").read_bytes())
    assert result.fit is None
    assert result.contour.layer == "PROFILE"
    slope = math.cos(math.radians(40.0))  # of the pressure angle, which is less
    before = program(PUSHER.drive.motion).state(program(PUSHER.drive.motion).angles(ANGLES)).y[0] * 1e3
    assert np.abs(lifts(result) + result.base_radius_mm - before - 45.0).max() < 2.5e-3 / slope
    assert all(jump.order == 2 for jump in result.jumps)


def test_a_digitised_cam_is_fitted(tmp_path: Path) -> None:
    """720 points of a cam with a cycloidal motion, measured to 2 µm: the motion to about that."""
    rise = with_drive(
        UP, motion=levels(0.0, (60.0, 0.0, "dwell"), (120.0, 8.0, "cycloidal"), (180.0, 0.0, "cycloidal"))
    )
    profile = 1e3 * Study(rise, 720).cam.flank.profile + np.random.default_rng(1).normal(0.0, 2e-3, (2, 720)).T @ [
        1.0,
        1j,
    ]
    rows = [(z.real, z.imag) for z in profile]
    result = traced(rise, drawn(("lwpolyline", rows, {"close": True})))
    assert result.fit is not None
    assert 1e-3 < result.fit.error < 4e-3
    off = (
        lifts(result)
        + result.base_radius_mm
        - (1e3 * program(rise.drive.motion).state(program(rise.drive.motion).angles(ANGLES)).y[0])
    )
    assert np.abs(off - 45.0).max() < 6e-3


def three_decimals(*shapes: tuple[object, ...]) -> list[tuple[object, ...]]:
    """As CAD writes them: lengths to a micrometre, angles to a thousandth of a degree."""
    return [
        (kind, *(np.round(np.array(place, dtype=float), 3).tolist() for place in places)) for kind, *places in shapes
    ]


@pytest.mark.parametrize("cam", [TANGENT, THREE_ARC], ids=["tangent", "three arcs"])
@pytest.mark.parametrize("spread", [0.0, 0.4e-3, 0.9e-3])
def test_ends_that_cad_rounded_join(cam: NosedCam, spread: float) -> None:
    """Lifts to what was rounded; it jumps where the exact curve does, and nowhere else."""
    shapes = three_decimals(*cam.shapes)
    lines = [i for i, shape in enumerate(shapes) if shape[0] == "line"]
    for i in lines:  # drawn apart a little more
        shapes[i] = ("line", *((x + spread, y) for x, y in shapes[i][1:]))
    wanted, result = traced(UP, drawn(*cam.shapes)), traced(UP, drawn(*shapes))
    assert np.abs(lifts(result) + result.base_radius_mm - lifts(wanted) - wanted.base_radius_mm).max() < 1.5e-3 + spread
    assert [jump.order for jump in result.jumps] == [2, 2, 2, 2]
    assert [s.curve.law for s in result.design.drive.motion.segments] == [
        s.curve.law for s in wanted.design.drive.motion.segments
    ]
    assert [jump.angle for jump in result.jumps] == pytest.approx([jump.angle for jump in wanted.jumps], abs=0.05)
    for one, other in zip(result.jumps, wanted.jumps, strict=True):
        assert (one.before, one.after) == pytest.approx((other.before, other.after), rel=2e-3, abs=1e-6)


def test_short_pieces_between_gaps_keep_their_place() -> None:
    """A line of a micrometre, as roundings leave it, is neither lost nor takes the place of what it joins."""
    p, q = TANGENT.joints
    shapes = [shape for shape in TANGENT.shapes if shape[0] == "arc"]
    between = p + 1e-3 * (q - p) / abs(q - p)
    for a, b in ((p, between), (between, q), (p.conjugate(), q.conjugate())):
        shapes.append(("line", (a.real, a.imag), (b.real, b.imag)))
    assert lifts(traced(UP, drawn(*shapes))) == pytest.approx(lifts(traced(UP, drawn(*TANGENT.shapes))), abs=1e-8)


# -- what cannot be followed ------------------------------------------------------------------------------

ARM = with_follower(
    with_cam(random_design(np.random.default_rng(4), "oscillating", "roller", "ccw"), roller_radius_mm=10.0),
    arm_mm=95.0, pivot_x_mm=90.0, pivot_y_mm=-40.0,
)  # fmt: skip
SLOTTED = [(10, -30), (10, 30), (-50, 30), (-50, 15), (-15, 15), (-15, -15), (-50, -15), (-50, -30)]
HOLLOW = (
    "lwpolyline",
    [(40, -30, 0.2), (40, 30, 0.0), (-40, 30, 0.0), (-40, -30, -0.3)],
    {"format": "xyb", "close": True},
)


@pytest.mark.parametrize(
    ("design", "data", "phrase"),
    [
        (UP, b"hello", "not a DXF drawing"),
        (UP, drawn(*TANGENT.shapes)[:9000], "not a DXF drawing"),
        (UP, drawn(("point", (0, 0))), "no closed curve"),
        (
            UP,
            drawn(*TANGENT.shapes[:3]),
            "no closed curve: the ends (17.71, 17.65) mm and (17.71, \u221217.65) mm are 35.29 mm apart",
        ),
        (
            UP,
            drawn(("lwpolyline", [(0, 0), (30, 0), (0, 30)], {"close": True})),
            "the cam centre (0, 0) mm lies outside the curve",
        ),
        (UP, drawn(("circle", (0, 0), 0.0)), "no closed curve: its lines, arcs, circles and polylines have no length"),
        (UP, drawn(("lwpolyline", [(30, 0)], {"close": True})), "no closed curve: its lines"),
        (
            UP,
            drawn(("circle", (0, 0), math.nan)),
            "CIRCLE on layer '0': nan is no number of a drawing; allowed: -1e+09 ... 1e+09",
        ),
        (UP, drawn(("line", (0, 1e200), (1, 0))), "LINE on layer '0': 1e+200 is no number of a drawing"),
        (
            UP,
            drawn(("lwpolyline", [(1e200, 0, 0), (0, 1e200, math.inf)], {"format": "xyb", "close": True})),
            "1e+200 is no number",
        ),
        (
            UP,
            drawn(
                *TANGENT.shapes, ("line", (0, 0), (25.0, 0.0)), ("line", (25.0, 0.0), (9, 9)), ("line", (25, 0), (9, 8))
            ),
            "3 ends of",
        ),
        (UP, drawn(*TANGENT.shapes, ("circle", (0, 0), 5.0)), "2 closed curves on layer 0"),
        (
            UP,
            drawn(("lwpolyline", [(-40, -40), (40, 40), (40, -40), (-40, 40)], {"close": True})),
            "crosses itself at (0, 0) mm",
        ),
        (UP, drawn(*TANGENT.shapes, unit=0), "its header states no unit; state the unit: mm | cm | in"),
        (UP, drawn(*TANGENT.shapes, unit=13), "states the unit 13 in $INSUNITS"),
        (UP, drawn(("circle", (50, 0), 40.0)), "the cam centre (0, 0) mm lies outside the curve"),
        (
            UP,
            drawn(("ellipse", (0, 0), (30, 0), 0.5)),
            "ELLIPSE on layer '0': only lines, arcs, circles and polylines are read",
        ),
        (
            UP,
            drawn(("open_spline", [(40, 0), (0, 40), (-40, 0), (0, -40)])),
            "as a polyline (a profile from here: as tangent arcs)",
        ),
        (flat(), drawn(HOLLOW), "the curve is hollow at (0, \u221218) mm"),
        (ARM, drawn(("circle", (10, 0), 250.0)), "the roller cannot reach the curve"),
        (with_follower(UP, offset_mm=60.0), ECCENTRIC, "the roller cannot reach the curve"),
        (UP, drawn(("lwpolyline", SLOTTED, {"close": True})), "the roller cannot follow the curve about cam angle"),
    ],
    ids=lambda value: value[:24] if isinstance(value, str) else "",
)
def test_what_cannot_be_followed_is_named_in_one_line(design: Design, data: bytes, phrase: str, tmp_path: Path) -> None:
    save(design, tmp_path / "design.toml")
    with pytest.raises(DrawingError) as caught:
        traced(design, data)
    assert phrase in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


# -- the command ------------------------------------------------------------------------------------------


def test_the_command_writes_the_design(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    save(replace(UP, assumed=("cam.base_radius_mm", "motion.start_mm")), tmp_path / "design.toml")
    (tmp_path / "cam.dxf").write_bytes(drawn(*TANGENT.shapes))
    command = [
        "motion-from",
        str(tmp_path / "design.toml"),
        str(tmp_path / "cam.dxf"),
        "--out",
        str(tmp_path / "out.toml"),
    ]
    assert main(command) == 0
    text = capsys.readouterr().out
    assert "acceleration jumps at 315.1 deg, from 0 to 0.01127 mm/deg²" in text
    assert load(tmp_path / "out.toml") == traced(UP, drawn(*TANGENT.shapes)).design
    assert main([*command, "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["base_radius_mm"] == 25.0
    assert answer["exact"]
    assert len(answer["jumps"]) == 4


def test_the_command_joins_ends_over_the_gap_that_is_given(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    save(UP, tmp_path / "design.toml")
    line, *others = TANGENT.shapes
    (tmp_path / "cam.dxf").write_bytes(drawn(("line", *((x + 0.005, y) for x, y in line[1:])), *others))
    command = [
        "motion-from",
        str(tmp_path / "design.toml"),
        str(tmp_path / "cam.dxf"),
        "--out",
        str(tmp_path / "out.toml"),
    ]
    assert main(command) == 2
    assert "are 0.005 mm apart, more than 0.002 mm; close it, or join over a wider gap" in capsys.readouterr().err
    assert main([*command, "--gap", "2"]) == 2
    assert "--gap: '2': gap; allowed: 0 ... 1 mm" in capsys.readouterr().err
    assert not (tmp_path / "out.toml").exists()
    assert main([*command, "--gap", "0.01"]) == 0


@pytest.mark.stress
def test_a_groove_comes_in_again_by_the_wall_within(tmp_path: Path) -> None:
    groove = Path(__file__).parents[3] / "resources/examples/groove.toml"
    words = ["--as", "arcs", "--flank", "outer", "--tolerance", "1e-3"]
    assert main(["profile", str(groove), "--out", str(tmp_path / "cam.dxf"), *words]) == 0
    result = traced(load(groove), (tmp_path / "cam.dxf").read_bytes())
    assert result.contour.layer == "PROFILE_INNER"
    assert result.base_radius_mm == pytest.approx(load(groove).drive.cam.base_radius_mm, abs=2e-3)


def test_the_command_leaves_nothing_half_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    save(UP, tmp_path / "design.toml")
    (tmp_path / "cam.dxf").write_bytes(drawn(*TANGENT.shapes, unit=0))
    command = [
        "motion-from",
        str(tmp_path / "design.toml"),
        str(tmp_path / "cam.dxf"),
        "--out",
        str(tmp_path / "out.toml"),
    ]
    assert main(command) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert main([*command, "--centre", "100,0", "--units", "mm"]) == 2
    assert "the cam centre (100, 0) mm lies outside the curve" in capsys.readouterr().err
    assert not (tmp_path / "out.toml").exists()
    assert main([*command, "--units", "mm", "--centre", "1,2"]) == 0
    assert main([*command, "--centre", "1;2"]) == 2
