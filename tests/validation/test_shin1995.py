"""Shin, Kim and Ha 1995: the lift drive of a transfer unit, Tables 2 and 3, against the print and fifty digits.

``shin1995_lift.json`` holds the mechanism at six cam angles, computed from the geometry with fifty digits.
"""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mechanisms import LIFT, with_drive
from references import EPS, MP, apart, cam_shape, off, solved, two_circles
from rods import arm_and_rod

from core.design import Design, entries, put
from core.project import load
from core.study import Study, extremes_of, findings_of

ROWS = json.loads((Path(__file__).parent / "shin1995_lift.json").read_text(encoding="utf-8"))["rows"]
EXAMPLE = Path(__file__).parents[2] / "resources" / "examples" / "transfer_lift.toml"


def whole() -> Study:
    return Study(LIFT, 3600)


def at(degrees: float) -> Study:
    return whole().at_theta(np.array([math.radians(degrees)]))


# -- base position, Table 3 -------------------------------------------------------------------------------

BASE = {"slider": MP.mpf("-919.9947316092067"), "phi": MP.mpf("93.30163262503667"), "alpha": MP.mpf("136.93863262503667"),
        "beta": MP.mpf("-179.99995659200765")}  # fmt: skip
"""Sixteen digits; the paper prints them to two to four decimals."""


@pytest.mark.parametrize("name", BASE)
def test_the_base_position_is_the_papers_to_sixteen_digits(name: str) -> None:
    value = whole().linkage.base[name][0]
    if name == "slider":
        # sixteen digits end at 1e-13 mm; a length of 920 mm is rounded to 1e-13 mm
        assert abs(value * 1e3 + 919.9947316092067) <= 4 * EPS * 920.0
    else:
        degree = MP.pi / 180
        # 93 ... 180 degrees come of a dozen roundings of angles of that size and of lengths, well away from any needle
        assert apart(value, BASE[name] * degree) <= 12 * EPS * math.pi


@pytest.mark.parametrize(
    ("name", "printed", "decimals"),
    [("slider", -919.99, 2), ("phi", 93.30, 2), ("alpha", 136.94, 2), ("beta", 180.00, 2)],
)
def test_the_base_position_rounds_to_the_print(name: str, printed: float, decimals: int) -> None:
    """Angles modulo 360 degrees: the rod's -179.99996 is the print's 180."""
    value, unit = whole().linkage.base[name]
    told = value * 1e3 if unit == "mm" else math.degrees(value)
    difference = told - printed if unit == "mm" else (told - printed + 180.0) % 360.0 - 180.0
    assert abs(difference) <= 0.5 * 10.0**-decimals + 1e-9


# -- the table --------------------------------------------------------------------------------------------


def columns(study: Study) -> dict[str, np.ndarray]:
    """As they stand in the JSON, per radian of cam angle."""
    flank = study.cam.flank
    phi = study.linkage.coordinates["phi"]
    return {
        "y_mm": study.motion.y[0] * 1e3,
        "phi_deg": np.rad2deg(phi[0]),
        "dphi": phi[1],
        "ddphi": phi[2],
        "profile_x_mm": flank.profile.real * 1e3,
        "profile_y_mm": flank.profile.imag * 1e3,
        "pitch_x_mm": flank.pitch.real * 1e3,
        "pitch_y_mm": flank.pitch.imag * 1e3,
        "pressure_angle_deg": np.rad2deg(flank.pressure_angle),
        "pitch_curvature_per_mm": flank.pitch_curvature * 1e-3,
    }


@pytest.mark.parametrize("row", ROWS, ids=[row["cam_angle_deg"] for row in ROWS])
@pytest.mark.parametrize("name", [key for key in ROWS[0] if key != "cam_angle_deg"])
def test_every_column_at_six_cam_angles_to_twelve_digits_of_the_channels_largest(
    name: str, row: dict[str, str]
) -> None:
    largest = np.abs(columns(whole())[name]).max()
    value = float(columns(at(float(row["cam_angle_deg"])))[name][0])
    error = off(value, MP.mpf(row[name]))
    if name == "phi_deg":
        error = abs((error + 180.0) % 360.0 - 180.0)
    assert error <= 1e-12 * largest


def in_decimals(design: Design) -> Design:
    """Every number as it was typed, 1302.162 and not the float next to it: the table was computed so."""
    for section in ("motion", "follower", "cam"):
        for entry in entries(design, section):
            if not (entry.info.choices or entry.info.flag) and entry.value is not None:
                design = put(design, entry.path, MP.mpf(repr(entry.value)))
    return design


@pytest.mark.parametrize("row", ROWS, ids=[row["cam_angle_deg"] for row in ROWS])
def test_the_table_itself_follows_from_the_circles(row: dict[str, str]) -> None:
    """The reference in the file and the reference in the tests are one: the file's eighteen digits all agree."""
    design = in_decimals(LIFT)
    here = solved(design, MP.mpf(row["cam_angle_deg"]) * MP.pi / 180)
    shape = cam_shape(design, here)
    phi, profile, pitch = here.angles["phi"], shape.profile * 1000, shape.pitch.c[0] * 1000
    told = {"y_mm": here.y.c[0] * 1000, "phi_deg": phi.c[0] * 180 / MP.pi, "dphi": phi.derivative(1), "ddphi": phi.derivative(2),
            "profile_x_mm": profile.real, "profile_y_mm": profile.imag, "pitch_x_mm": pitch.real, "pitch_y_mm": pitch.imag,
            "pressure_angle_deg": shape.pressure_angle * 180 / MP.pi,
            "pitch_curvature_per_mm": shape.curvature.c[0] / 1000}  # fmt: skip
    for name, value in told.items():
        # of zero as many decimals
        assert abs(value - MP.mpf(row[name])) <= MP.mpf(10) ** -17 * (abs(value) or 1), name


# -- figures of the cam -----------------------------------------------------------------------------------


def test_the_roller_centre_runs_between_550_and_625_mm() -> None:
    """Base radius and roller radius; and the circle of the high dwell, whose radius the stroke of 150 mm gives."""
    low, high = _distance()
    assert low == pytest.approx(550.0, rel=64 * EPS)
    here = solved(LIFT, 0.1)
    top = float(abs(here.roller.c[0])) * 1e3
    assert high == pytest.approx(top, rel=64 * EPS)
    assert high == pytest.approx(625.0, abs=0.5), "the print rounds to whole millimetres"


def _distance() -> tuple[float, float]:
    """The refined extremes of the roller's distance from the cam centre [mm]: of the profile's, in dwells where the
    normal points to the centre."""
    ranges = extremes_of(whole(), "cam")["radius"]
    return (ranges.low.value + 0.150) * 1e3, (ranges.high.value + 0.150) * 1e3


def test_the_largest_pressure_angle_stands_at_58_degrees() -> None:
    worst = extremes_of(whole(), "cam")["pressure_angle"].high
    assert math.degrees(worst.value) == pytest.approx(17.6047866, abs=0.5e-7)
    assert math.degrees(worst.theta) == pytest.approx(58.476022, abs=0.5e-6)

    def pressure(theta: object) -> object:
        return cam_shape(LIFT, solved(LIFT, theta, 1)).pressure_angle

    root = MP.findroot(lambda t: MP.diff(pressure, t), (1.02, 1.021), tol=1e-20)
    # 13 digits of an angle of conditions like 10
    assert worst.value == pytest.approx(float(pressure(root)), rel=64 * EPS)
    assert worst.theta == pytest.approx(float(root), abs=1e-9)
    finding = [f for f in findings_of(whole()) if f.code == "pressure-angle"]
    assert finding == [], "well below 45 degrees"


def test_the_sharpest_place_of_the_pitch_curve_is_the_root_of_its_curvatures_slope() -> None:
    ranges = extremes_of(whole(), "cam")["pitch_curvature"]
    for side, sign in ((ranges.high, 1), (ranges.low, -1)):
        segment = 1 if side.theta < math.pi else 3

        def curvature(theta: object, segment: int = segment) -> object:
            here = cam_shape(LIFT, solved(LIFT, theta, segment))
            return here.curvature

        root = MP.findroot(lambda t, of=curvature: of(t).c[1], (side.theta - 1e-4, side.theta + 1e-4), tol=1e-25)
        assert side.theta == pytest.approx(float(root), abs=1e-8)
        assert side.value == pytest.approx(float(curvature(root).c[0]), rel=256 * EPS)
        grid = np.linspace(math.radians(36.0), math.radians(324.0), 97)
        there = [float(cam_shape(LIFT, solved(LIFT, t)).curvature.c[0]) for t in grid]
        assert sign * side.value >= max(sign * k for k in there)
    assert 150e-3 * ranges.high.value < 1.0, "no undercut under a roller of 150 mm"


def test_the_dwells_are_circles_about_the_cam_centre() -> None:
    for degrees, radius in ((150.0, 0.550), (10.0, float(abs(solved(LIFT, 0.1).roller.c[0])))):
        study = at(degrees)
        assert study.cam.flank.pitch_curvature[0] == pytest.approx(1.0 / radius, rel=64 * EPS)
        assert abs(study.cam.flank.profile[0]) == pytest.approx(radius - 0.150, rel=64 * EPS)


def test_the_joins_of_the_modified_sine_jump_in_nothing_but_jerk() -> None:
    for join in whole().program.joins[:-1]:
        assert join.jumps.tolist() == [False, False, False, True]
    assert not whole().program.joins[-1].jumps.any(), "a dwell goes on across 360 degrees"
    assert findings_of(whole(), ("motion",)) == ()


# -- the paper's equations --------------------------------------------------------------------------------


def _tangent_substitution(p: float, q: float, r: float, sign: float) -> tuple[float, float]:
    """Numerator and denominator of tan of the half angle in eqs. (7), (9), (10), as printed."""
    return -q + sign * math.sqrt(p * p + q * q - r * r), r - p


def _rod(slider: float, l1: float, l2: float, height: float, sign: float) -> tuple[float, float]:
    """Eq. (10), the rod."""
    d, e, f = 2 * slider * l2, 2 * height * l2, l1**2 - slider**2 - l2**2 - height**2
    return _tangent_substitution(d, e, f, sign)


def test_at_the_base_of_the_lift_the_printed_denominator_has_lost_six_digits() -> None:
    """β0 is 4e-5 degrees off 180: F - D is 1.7 where F and D are 1.6 million."""
    _, denominator = _rod(-919.9947316092067, 1302.162, 845.0, 1300.0, -1.0)
    assert abs(denominator) < 1e-5 * 2 * 919.99 * 845.0


def test_the_tangent_substitution_divides_by_zero_where_the_rod_lies_level() -> None:
    """Arm 1300, guide at 1200, so the arm's pin stands at -500 and 1200; the rod of the lift, 845, lies level at 180
    degrees. In whole numbers nothing is rounded: the printed denominator is zero. Ours has both branches."""
    numerator, denominator = _rod(-1345.0, 1300.0, 845.0, 1200.0, -1.0)
    assert denominator == 0.0
    with pytest.raises(ZeroDivisionError):
        _ = numerator / denominator
    # atan2 saves this root and loses the other one: 0/0
    assert _rod(-1345.0, 1300.0, 845.0, 1200.0, 1.0) == (0.0, 0.0)
    s = 1.345**2 + 1.2**2 + 1.3**2 + 0.845**2
    for side in (1, -1):
        pin_b = two_circles(MP.mpc(0), MP.mpf(1.3), MP.mpc(-1.345, 1.2), MP.mpf(0.845), -side)
        phi, beta = MP.arg(pin_b), MP.arg(MP.mpc(-1.345, 1.2) - pin_b)
        ours = arm_and_rod(1.3, 0.845, 1.2, -1.345, -float(side), float(phi), float(beta))
        area = 2.0 * 1.3 * 0.845 * float(ours.singular["pin"][0])
        bound = 3.0 * EPS * (1.0 + s / area) + EPS * math.pi
        assert apart(ours.coordinates["phi"][0][0], phi) <= bound
        assert apart(ours.coordinates["beta"][0][0], beta) <= bound
    level = math.degrees(arm_and_rod(1.3, 0.845, 1.2, -1.345, 1.0, 1.9656, math.pi).coordinates["beta"][0][0])
    other = math.degrees(arm_and_rod(1.3, 0.845, 1.2, -1.345, -1.0, 2.8, 1.2).coordinates["beta"][0][0])
    told = sorted(abs(x) for x in (level, other))
    assert told[1] == pytest.approx(180.0, abs=1e-12)
    assert told[0] < 170.0


def test_the_example_file_is_this_lift() -> None:
    example = load(EXAMPLE)
    drive = example.drive
    assert drive.motion == LIFT.drive.motion
    assert drive.mechanism == LIFT.drive.mechanism
    assert drive.cam == LIFT.drive.cam
    assert drive.loads == LIFT.drive.loads
    assert replace(example.shaft, flywheel_inertia_kg_m2=0.0) == LIFT.shaft, "the flywheel is of its own sizing"
    found = findings_of(Study(with_drive(example, loads=LIFT.drive.loads)))
    assert [f for f in found if f.severity == "error"] == []
