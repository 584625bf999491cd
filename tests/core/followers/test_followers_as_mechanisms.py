"""Followers solved as mechanisms, against circles that intersect, at fifty digits; against mirrors; at the edge of reach."""

import math
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
    cam_sliders,
    levels,
    mirrored,
    posed,
    pushers,
    with_cam,
    with_drive,
    with_follower,
)
from references import (
    EPS,
    MM,
    MP,
    Series,
    Solved,
    apart,
    circle_and_line,
    conditioned,
    direction,
    off,
    placed,
    reach_of,
    sensitivity,
    solved,
    two_circles,
)
from rods import arm_and_rod, metres
from sampled import spread

from core.design import Design, si
from core.errors import NoAssembly, NoCam
from core.findings import ERROR, WARNING
from core.followers import LAYOUT_TABLE
from core.mechanism import solve_mechanism
from core.mechanism.dyads import area4_of, brackets, opposite_angle
from core.numerics.derivatives import Derivatives
from core.study import Study, findings_of

DESIGNS = {**LAYOUT_DESIGNS, "lift": LIFT, "pusher": PUSHER}

# Of a length or an angle: twice on conversion to SI. Then, each acting like a rounding of the inputs: in the base
# position 6 (reach, triangle, angle, rise, root, slider), in the triangle 6 (square, root, area, two arguments, angle),
# and at most 4 in each of the four orders of derivatives, which are built on one another.
ROUNDINGS = 2 + 6 + 6 + 4 * 4


def everything(design: Design, there: Solved) -> list[object]:
    """All points and all angles with three derivatives."""
    points = [d for p in there.points.values() for d in p.derivatives]
    return points + [d for a in there.angles.values() for d in a.derivatives]


def computed(study: Study, there: Solved) -> list[complex]:
    kinematics = study.linkage
    pins = {"arm_pin": "arm", "slider_pin": "slider", "pivot": "arm"}
    points = [
        complex(v)
        for name in there.points
        for v in (kinematics.bodies[pins[name]].point(name) if name in pins else kinematics.follower.z)[:, 0]
    ]
    return points + [complex(v) for name in there.angles for v in kinematics.coordinates[name].all[:, 0]]


def check_everything(design: Design, theta: float) -> None:
    study = Study(design).at_theta(np.array([theta]))
    y = study.motion.y[:, 0]
    there = placed(design, theta, Series([v / math.factorial(k) for k, v in enumerate(map(float, y))]))
    exact, size = sensitivity(everything, design, theta, y)
    got = computed(study, there)
    names = [f"{n}{chr(39) * k}" for n in (*there.points, *there.angles) for k in range(4)]
    for name, value, reference, reach in zip(names, got, exact, size, strict=True):
        error = apart(value.real, reference) if name in ("phi", "beta") else off(value, reference)
        assert error <= EPS * (ROUNDINGS * reach + 2.0 * float(abs(reference)) + (name in ("phi", "beta"))), name


PLACES = [(name, theta) for name in DESIGNS for theta in (0.3, 1.1, 2.5, 3.4, 5.6)]


@pytest.mark.parametrize(("name", "theta"), spread(PLACES, 4))
def test_points_angles_and_three_derivatives_follow_from_the_circles(name: str, theta: float) -> None:
    check_everything(DESIGNS[name], theta)


@settings(max_examples=13)
@given(buildable(), ANGLES)
def test_any_mechanism_follows_from_the_circles(design: Design, theta: float) -> None:
    check_everything(design, theta)


@pytest.mark.parametrize("letter", ["b", "d", "f"])
def test_a_slider_high_above_the_pivot_keeps_the_arms_pin_on_its_side(letter: str) -> None:
    """Height and cosine outweigh slider and sine: which side the pin is on is told by both."""
    follower, cam = posed(
        letter,
        slider_arm=300.0,
        rod=280.0,
        arm_angle=0.35,
        rod_angle=1.1,
        guide=0.2,
        pivot=complex(230.0, -30.0),
        roller_arm=200.0,
        spread=0.7,
        roller_share=0.2,
    )
    design = with_drive(LAYOUT_DESIGNS[letter], mechanism=follower, cam=cam)
    base = Study(design, 8).linkage.base
    slider, phi = base["slider"][0], base["phi"][0]
    assert abs(follower.guide_height_mm * 1e-3 * math.cos(phi)) > 2.0 * abs(slider * math.sin(phi))
    for theta in (0.3, 2.5):
        check_everything(design, theta)


# -- layouts ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("letter", "abcdefgh")
def test_roller_and_slider_stand_on_the_side_the_letter_says(letter: str) -> None:
    """Pivot level with the cam centre, guide level: above is up, right is right."""
    cam, roller, slider = {
        "a": ("left", "above", "right"),
        "b": ("left", "above", "left"),
        "c": ("right", "above", "right"),
        "d": ("right", "above", "left"),
        "e": ("left", "below", "right"),
        "f": ("left", "below", "left"),
        "g": ("right", "below", "right"),
        "h": ("right", "below", "left"),
    }[letter]
    pivot_x = 200.0 if cam == "left" else -200.0
    design = with_follower(
        LAYOUT_DESIGNS["a"],
        layout=letter,
        pivot_x_mm=pivot_x,
        pivot_y_mm=0.0,
        guide_angle_deg=0.0,
        guide_height_mm=330.0,
        fixed_angle_deg=float(np.rad2deg(_alpha(pivot_x, cam, roller)) - 75.0),
    )
    design = with_drive(design, motion=levels(0.0, (180.0, 10.0, "cycloidal"), (180.0, 0.0, "cycloidal")))
    kinematics = Study(design, 8).linkage
    roller_at = kinematics.follower.z[0, 0]
    assert (roller_at.imag > 0.0) == (roller == "above")
    assert (kinematics.bodies["slider"].z[0, 0].real > kinematics.bodies["rod"].z[0, 0].real) == (slider == "right")
    assert (kinematics.bodies["arm"].z[0, 0].real > 0.0) == (cam == "left")
    assert abs(roller_at) == pytest.approx(float(reach_of(design)), rel=8 * EPS)
    # slider at y = 10 mm to the right of where it stood: + is to the right whichever side of the arm it is on
    assert kinematics.bodies["slider"].z[0, 4].real - kinematics.bodies["slider"].z[0, 0].real == pytest.approx(
        0.010, rel=1e-13
    )
    row = LAYOUT_TABLE[letter]
    assert (row.cam_left, row.roller_above, row.slider_right) == (cam == "left", roller == "above", slider == "right")


def _alpha(pivot_x: float, cam: str, roller: str) -> float:
    """Direction of the roller from the pivot, so that the slider arm can be put at 75 degrees."""
    base = LAYOUT_DESIGNS["a"].drive
    arm, reach = base.follower.roller_arm_mm, base.cam.base_radius_mm + base.cam.roller_radius_mm
    height = 2.0 * _heron(200.0, arm, reach) / 200.0
    x = math.sqrt(reach**2 - height**2) * math.copysign(1.0, pivot_x * (reach**2 + 200.0**2 - arm**2))
    return math.atan2(height if roller == "above" else -height, x - pivot_x)


def _heron(a: float, b: float, c: float) -> float:
    s = (a + b + c) / 2.0
    return math.sqrt(s * (s - a) * (s - b) * (s - c))


def _mirror(z: np.ndarray) -> np.ndarray:
    return -z.conjugate()


def check_mirror(design: Design) -> None:
    here, there = Study(design, 24), Study(mirrored(design), 24)
    a, b = here.linkage, there.linkage
    # either side keeps to the circles within the bound of the kinematics; a derivative loses no more than (S/K)² of it
    for name, body in a.bodies.items():
        scale = np.abs(body.z).max(axis=1, keepdims=True) + float(reach_of(design)) * np.array(
            [[1.0], [1.0], [1.0], [1.0]]
        )
        grow = EPS * ROUNDINGS * a.condition.max() ** np.array([[1.0], [2.0], [3.0], [4.0]])
        assert (np.abs(_mirror(body.z) - b.bodies[name].z) <= grow * scale).all(), name
    for name, rotation in (("phi", -1.0), ("beta", -1.0)):
        if name in a.coordinates:
            for k in range(4):
                one, other = a.coordinates[name][k], b.coordinates[name][k]
                error = (
                    np.abs(one - rotation * other) if k else np.abs(np.exp(1j * (math.pi - one)) - np.exp(1j * other))
                )
                assert error.max() <= EPS * ROUNDINGS * a.condition.max() ** (k + 1) * max(1.0, np.abs(one).max())


@pytest.mark.parametrize("name", DESIGNS)
def test_a_mirrored_design_moves_like_its_mirror_image(name: str) -> None:
    check_mirror(DESIGNS[name])


@settings(max_examples=13)
@given(buildable())
def test_any_mirrored_design_moves_like_its_mirror_image(design: Design) -> None:
    check_mirror(design)


@pytest.mark.parametrize("angle", [10.0, -75.0, 90.0, 180.0])
@pytest.mark.parametrize("letter", "adfg")
def test_a_design_turned_as_a_whole_moves_as_before(letter: str, angle: float) -> None:
    """Pivot, guide and layout's letter turned about the cam centre turn the whole mechanism, and φ and β stay."""
    design = LAYOUT_DESIGNS[letter]
    g, by = design.drive.mechanism, np.exp(1j * math.radians(angle))
    pivot = complex(g.pivot_x_mm, g.pivot_y_mm) * by
    row = LAYOUT_TABLE[letter]
    left = pivot.real > 0.0
    above = (row.cam_left == row.roller_above) == left  # the roller stays on its side of the line to the pivot
    new = next(
        k
        for k, v in LAYOUT_TABLE.items()
        if (v.cam_left, v.roller_above, v.slider_right) == (left, above, row.slider_right)
    )
    turned = with_follower(
        design, layout=new, pivot_x_mm=pivot.real, pivot_y_mm=pivot.imag, guide_angle_deg=g.guide_angle_deg + angle
    )
    a, b = Study(design, 24).linkage, Study(turned, 24).linkage
    bound = EPS * 2 * ROUNDINGS * a.condition.max() * np.abs(a.follower.z).max()
    for name in a.bodies:
        assert np.abs(a.bodies[name].z[0] * by - b.bodies[name].z[0]).max() <= bound
    for name in ("phi", "beta"):
        assert np.abs(np.exp(1j * a.coordinates[name][0]) - np.exp(1j * b.coordinates[name][0])).max() <= bound * 4.0


# -- closure ----------------------------------------------------------------------------------------------


@settings(max_examples=25)
@given(cam_sliders())
@example(LIFT)
def test_the_loop_is_closed_and_stays_on_one_branch(design: Design) -> None:
    kinematics = Study(design, 360).linkage
    g = design.drive.mechanism
    arm, rod, slider = (kinematics.bodies[name] for name in ("arm", "rod", "slider"))
    size = (g.slider_arm_mm + g.rod_mm + abs(g.guide_height_mm)) * 1e-3
    closure = np.abs(rod.point("slider_pin") - slider.z)
    assert closure[0].max() <= 1e-13 * size
    # and the angles say the same as the poses
    by_angles = (
        arm.z[0] + g.slider_arm_mm * 1e-3 * np.exp(1j * arm.angle[0]) + g.rod_mm * 1e-3 * np.exp(1j * rod.angle[0])
    )
    missed = np.abs(by_angles - slider.z[0])
    assert missed.max() <= 1e-13 * size
    assert kinematics.residual.max() <= EPS * kinematics.condition.max()
    # velocities and accelerations close too: each order divides by the sine once more than its velocities
    grow = EPS * ROUNDINGS * kinematics.condition.max() ** np.array([2.0, 3.0, 4.0])
    parts = [np.abs(p[1:]).max(axis=1) for p in (rod.z, slider.z, rod.point("slider_pin"))]
    assert (closure[1:].max(axis=1) <= grow * np.maximum.reduce(parts)).all()
    # the arm's pin keeps to its side of the line from pivot to slider pin
    side = np.sign(((slider.z[0] - arm.z[0]).conj() * (rod.z[0] - arm.z[0])).imag)
    assert np.unique(side).size == 1
    assert side[0] == (1.0 if np.angle((rod.z[0, 0] - arm.z[0, 0]) / (slider.z[0, 0] - arm.z[0, 0])) > 0 else -1.0)
    # and both ends of the arm, roller and pin, are on one body, whose drawing has them there
    for name, place in (("roller", kinematics.follower.z), ("arm_pin", rod.z)):
        assert np.abs(arm.point(name)[0] - place[0]).max() <= 16 * EPS * (np.abs(place[0]) + np.abs(arm.z[0])).max()
    span = (kinematics.follower.z[0] - arm.z[0]) / (rod.z[0] - arm.z[0])
    turn = np.exp(1j * math.radians(g.fixed_angle_deg)) * g.roller_arm_mm / g.slider_arm_mm
    assert np.abs(span - turn).max() <= 16 * EPS * abs(turn) * (
        1.0 + abs(math.radians(g.fixed_angle_deg)) + 4 * math.pi
    )


def test_angles_do_not_wrap_within_the_cycle() -> None:
    """The lift's rod angle passes -180 degrees by 4e-5; whole turns are those of the base position."""
    for design in (LIFT, *LAYOUT_DESIGNS.values()):
        kinematics = Study(design, 720).linkage
        for name in ("phi", "beta"):
            angle = kinematics.coordinates[name]
            step = 1.5 * (2 * math.pi / 720) * np.abs(angle[1]).max() + 1e-12
            assert np.abs(np.diff(angle[0])).max() <= step
            assert abs(angle[0][0] - kinematics.base[name][0]) < 1.0


@pytest.mark.parametrize("name", DESIGNS)
def test_every_body_points_where_its_angle_says(name: str) -> None:
    """The vectors of the triangle and the angles in tables are one and the same direction, seen from its own point."""
    kinematics = Study(DESIGNS[name], 24).linkage
    for body, ends in {
        "arm": ("pivot", "arm_pin"),
        "rod": ("arm_pin", "slider_pin"),
        "roller": (),
        "slider": (),
    }.items():
        if body not in kinematics.bodies:
            continue
        pose = kinematics.bodies[body]
        assert pose.unit == pytest.approx(np.exp(1j * pose.angle[0]), abs=EPS * ROUNDINGS * kinematics.condition.max())
        if ends:
            here, there = (pose.point(end)[0] for end in ends)
            assert (there - here) / abs(there - here) == pytest.approx(pose.unit, abs=8 * EPS)
        for point, local in pose.points.items():
            for k in range(4):
                assert pose.fixed_point(local)[k] == pytest.approx(pose.point(point)[k], rel=4 * EPS, abs=1e-300)
            assert pose.position(point).tolist() == pose.fixed_point(local)[0].tolist()
    if "roller" in kinematics.bodies:
        assert (kinematics.bodies["roller"].angle == kinematics.bodies["arm"].angle).all()  # fixed to the arm


# -- the triangle -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("a", "b", "c"),
    [(3.0, 4.0, 5.0), (5.0, 3.0, 4.0), (1.0, 1.0, 1e-9), (1.0, 1.0, 2.0 - 2**-40), (1.0, 2.0, 1.0 + 2**-30),
     (0.1, 0.2, 0.3), (1e-9, 1e-9, 1e-9), (1e6, 1e-3, 1e6)],
)  # fmt: skip
def test_area_and_angle_keep_their_digits_in_a_needle(a: float, b: float, c: float) -> None:
    """Kahan: the area is good to a few roundings, whatever the shape, for sides taken as exact."""
    x, y, z = map(MP.mpf, (a, b, c))
    area = MP.sqrt((x + y + z) * (-x + y + z) * (x - y + z) * (x + y - z))
    assert off(area4_of(a, b, c), area) <= 8 * EPS * float(area)
    cosine = (x * x + y * y - z * z) / (2 * x * y)
    angle = MP.acos(cosine)
    # atan2 of the area and 2ab cos, the latter of three products: its error counts as far as it turns the angle
    turning = (a * a + abs(b - c) * (b + c)) * float(area) / float((2 * x * y) ** 2)
    assert off(opposite_angle(a, b, c), angle) <= 8 * EPS * (float(angle) + turning)


def test_no_triangle_gives_no_area() -> None:
    assert math.isnan(area4_of(1.0, 2.0, 3.1))
    assert math.isnan(area4_of(3.1, 2.0, 1.0))
    assert math.isnan(opposite_angle(5.0, 1.0, 2.0))
    assert area4_of(1.0, 2.0, 3.0) == 0.0
    sides = brackets(np.array([3.1, 3.0, 0.9, 2.5]), np.zeros(4), 1.0, 2.0)
    assert (np.sign(sides.stretched) + np.sign(sides.folded)).tolist() == [0.0, 1.0, 0.0, 2.0]
    assert sides.gap(1.0, 2.0) == pytest.approx([-0.1, 0.0, -0.1, 0.5], abs=2 * EPS)


@pytest.mark.parametrize(("l1", "l2"), [(1.3, 0.8), (0.31, 0.94), (0.7, 0.7), (1.302162, 0.845), (1e-4, 1.0)])
@pytest.mark.parametrize("height", [0.0, 0.3, -0.2, 1.3])
def test_the_area_keeps_all_its_digits_down_to_dead_centres(l1: float, l2: float, height: float) -> None:
    """Squares that are kept with their rounding near the straight line, a sum, a product and a root: 16 eps of it, at any distance
    from there."""
    a, b, h = map(MP.mpf, (l1, l2, height))
    places = []
    for square in ((a + b) ** 2 - h**2, (a - b) ** 2 - h**2):
        if square > 0:
            edge = float(MP.sqrt(square))
            steps = [edge * (1.0 + sign * 10.0**-k) for k in (1, 3, 6, 9, 12, 15) for sign in (1, -1)]
            places += [edge, math.nextafter(edge, 0.0), math.nextafter(edge, 9.0), *steps]
    for slider in (p * sign for p in places for sign in (1.0, -1.0)):
        r2 = MP.mpf(slider) ** 2 + h**2
        exact = ((a + b) ** 2 - r2) * (r2 - (a - b) ** 2)
        _, stretched, folded = brackets(np.array([slider]), np.array([height]), l1, l2)
        product = float((stretched * folded)[0])
        if exact < 0:
            assert product < 0.0
        else:
            assert off(math.sqrt(product), MP.sqrt(exact)) <= 16 * EPS * float(MP.sqrt(exact))
    if not places:
        assert brackets(np.array([0.5]), np.array([height]), l1, l2).gap(l1, l2)[0] < 0.0, "the guide is out of reach"


# -- towards dead centres ---------------------------------------------------------------------------------


def _near(l1: float, l2: float, height: float, distance: float, sign: float, stretched: bool) -> float:
    """The slider where the triangle misses a straight line by a fraction ``distance``."""
    far = (l1 + l2) * (1.0 - distance) if stretched else abs(l1 - l2) * (1.0 + distance)
    return sign * math.sqrt((far - height) * (far + height))


def _by_circles(numbers: list[object], side: int) -> list[object]:
    l1, l2, height, slider, *rates = numbers
    pin_a = Series([slider + 1j * height, *(r / MP.factorial(k + 1) for k, r in enumerate(rates))])
    pin_b = two_circles(Series([0, 0, 0, 0]), l1, pin_a, l2, side)
    return [*direction(pin_b).derivatives, *direction(pin_a - pin_b).derivatives]


@pytest.mark.parametrize("sigma", [1.0, -1.0])
@pytest.mark.parametrize("stretched", [True, False])
@pytest.mark.parametrize("distance", spread([1e-1, 1e-3, 1e-6, 1e-8, 1e-10, 1e-12], 12))
@pytest.mark.parametrize(
    ("l1", "l2", "height", "sign"), [(1.3, 0.8, 0.3, 1.0), (0.31, 0.94, -0.2, -1.0), (0.7, 0.4, 0.0, 1.0)]
)
def test_angles_hold_down_to_dead_centres(
    l1: float, l2: float, height: float, sign: float, stretched: bool, distance: float, sigma: float
) -> None:
    l1, l2, height = map(metres, (l1, l2, height))
    slider = _near(l1, l2, height, distance, sign, stretched)
    rates = np.array([0.37, -0.61, 1.9])
    exact, size = conditioned(lambda x: _by_circles(x, int(sigma)), [l1, l2, height, slider, *rates])
    # the base position only tells the branch and the whole turns
    got = arm_and_rod(l1, l2, height, slider, sigma, float(exact[0]), float(exact[4]), tuple(rates))
    k = 2.0 * l1 * l2 * float(got.singular["pin"][0])
    s = slider**2 + height**2 + l1**2 + l2**2
    half_an_ulp = EPS * 0.5 * math.pi  # of an angle that a whole turn was added to
    for row, at in ((got.coordinates["phi"].all, 0), (got.coordinates["beta"].all, 4)):
        error = apart(row[0, 0], exact[at])
        assert error <= 3.0 * EPS * (1.0 + s / k) + half_an_ulp
        # sin(φ-β) = K/2 L1 L2 is as good as r, whose rounding it feels by (S/K)²; each further order divides by it
        # twice more: the first-order size of the inputs' roundings, of which there are four a step
        for order in range(1, 4):
            bound = EPS * (4 + 4 * order) * size[at + order]
            assert off(row[order, 0], exact[at + order]) <= bound + ROUNDINGS * EPS * abs(float(exact[at + order])), (
                order
            )


# Arm 300, rod 200, the guide through the pivot: stretched at 500, folded at 100, the rod across the guide at 223.6 mm.
LEVEL_FOLLOWER, LEVEL_CAM = posed(
    "a", slider_arm=300.0, rod=200.0, arm_angle=0.6, rod_angle=-math.asin(1.5 * math.sin(0.6)), guide=0.0,
    pivot=complex(210.0, -40.0), roller_arm=180.0, spread=0.6, roller_share=0.2,
)  # fmt: skip
LEVEL = with_drive(LAYOUT_DESIGNS["a"], mechanism=replace(LEVEL_FOLLOWER, guide_height_mm=0.0), cam=LEVEL_CAM)
LEVEL_START = float(solved(LEVEL, 0.0).base["slider"]) * 1e3


def driven_to(design: Design, y: float, law: str = "cycloidal") -> Design:
    """Dwell to 90 degrees, to y at 180, dwell to 240, and back."""
    steps = ((90.0, 0.0, "dwell"), (90.0, y, law), (60.0, y, "dwell"), (120.0, 0.0, law))
    return with_drive(design, motion=levels(0.0, *steps))


@pytest.mark.parametrize(
    ("design", "edge"),
    spread(
        [
            (LEVEL, 500.0),
            (LEVEL, 100.0),
            (LAYOUT_DESIGNS["b"], -1.0),
            (LAYOUT_DESIGNS["e"], 1.0),
            (LAYOUT_DESIGNS["h"], -1.0),
        ],
        1,
    ),
    ids=["stretched", "folded", "b", "e", "h"],
)
def test_a_slider_out_of_reach_names_the_cam_angles(design: Design, edge: float) -> None:
    """The motion is carried beyond the dead centre: the angles are those where the distance passes it."""
    g = design.drive.mechanism
    if abs(edge) == 1.0:
        edge = math.copysign(math.sqrt((g.slider_arm_mm + g.rod_mm) ** 2 - g.guide_height_mm**2), edge)
    way = edge - float(solved(design, 0.0).base["slider"]) * 1e3
    with pytest.raises(NoAssembly) as caught:
        _ = Study(driven_to(design, 1.2345 * way, "constant-velocity")).linkage
    ((first, last),) = caught.value.cam_angles
    out, back = 90.0 + 90.0 / 1.2345, 360.0 - 120.0 / 1.2345
    assert first == pytest.approx(out, abs=1e-9)  # found by bisection, whatever the sampling
    assert last == pytest.approx(back, abs=1e-9)
    assert caught.value.field == "follower.rod_mm"
    text = str(caught.value)
    assert f"{first:.4g}...{last:.4g} deg" in text
    assert f"{abs(g.slider_arm_mm - g.rod_mm):.6g} ... {g.slider_arm_mm + g.rod_mm:.6g} mm" in text
    assert len(text.splitlines()) == 1


def test_arm_and_rod_exactly_in_line_are_told_with_the_cam_angle() -> None:
    """A sum of floats that hits the sum of arm and rod to the last bit."""
    study = Study(LEVEL, 8)
    g, base = si(LEVEL.drive.mechanism), study.linkage.base["slider"][0]
    y = study.motion.y.copy()
    y[0, 3] = g.slider_arm + g.rod - base
    assert base + y[0, 3] == g.slider_arm + g.rod
    still = replace(study.motion, displacement=Derivatives.of(y))
    with pytest.raises(NoAssembly, match="dead centre") as caught:
        solve_mechanism(study.mechanism, still)
    assert caught.value.cam_angles == ((pytest.approx(135.0), pytest.approx(135.0)),)


@pytest.mark.parametrize(
    ("sine", "severity"), [(0.0502, None), (0.0498, WARNING), (1.01e-3, WARNING), (0.99e-3, ERROR)]
)
def test_near_a_dead_centre_a_finding_names_the_angle_and_the_sine(sine: float, severity: str | None) -> None:
    far = math.sqrt(300.0**2 + 200.0**2 + 2 * 300.0 * 200.0 * math.sqrt(1 - sine**2))
    study = Study(driven_to(LEVEL, far - LEVEL_START))
    found = [f for f in findings_of(study, ("linkage",)) if f.code == "dead-centre"]
    assert [f.severity for f in found] == ([severity] if severity else [])
    for f in found:
        assert 180.0 - 1e-6 <= f.cam_angle_deg <= 240.0
        # sin² = 2 (1 - r/500)... : the rounding of r, 1e-16 of it, over 1e-6 of its room to the dead centre
        assert f.values["value"] == pytest.approx(sine, rel=1e-9)


def test_a_rod_across_the_guide_is_told_with_angle_and_cosine() -> None:
    """Slider straight below the arm's pin on the way out and back: there the arm cannot drive it."""
    way = math.sqrt(300.0**2 - 200.0**2) - LEVEL_START
    (found,) = [
        f
        for f in findings_of(Study(driven_to(LEVEL, 1.5 * way, "constant-velocity")), ("linkage",))
        if f.code == "rod-across-guide"
    ]
    assert found.severity == ERROR
    assert found.cam_angle_deg in (
        pytest.approx(90.0 + 90.0 / 1.5, abs=1e-9),
        pytest.approx(360.0 - 120.0 / 1.5, abs=1e-9),
    )
    assert found.values["value"] < 1e-9
    (near,) = [
        f for f in findings_of(Study(driven_to(LEVEL, 0.99 * way)), ("linkage",)) if f.code == "rod-across-guide"
    ]
    there = solved(driven_to(LEVEL, 0.99 * way), MP.pi)
    assert near.values["value"] == pytest.approx(float(abs(MP.cos(there.angles["beta"].c[0]))), rel=1e-9)
    assert (near.severity, 180.0 <= near.cam_angle_deg <= 240.0) == (WARNING, True)


# -- base positions that do not exist ---------------------------------------------------------------------


def test_a_roller_that_does_not_reach_the_base_circle_is_named_with_the_range_that_would() -> None:
    design = with_follower(LIFT, roller_arm_mm=100.0)
    with pytest.raises(NoAssembly) as caught:
        _ = Study(design).linkage
    distance = math.hypot(873.746, -65.0)
    assert caught.value.field == "follower.roller_arm_mm"
    assert caught.value.cam_angles == ()
    assert f"{distance - 550.0:.6g}" in str(caught.value)
    for arm, fits in (
        (distance - 550.0 + 0.01, True),
        (distance - 550.0 - 0.01, False),
        (distance + 550.0 - 0.01, True),
        (distance + 550.0 + 0.01, False),
    ):
        edge = with_follower(LIFT, roller_arm_mm=arm)
        try:
            _ = Study(edge, 8).linkage
            reaches = True
        except NoAssembly as refusal:
            reaches = refusal.field != "follower.roller_arm_mm"
        assert reaches == fits, arm


def test_a_rod_too_short_for_the_guide_is_named_with_its_least_length() -> None:
    """The arm's pin of the lift is level with its guide; a guide 900 mm higher is out of the rod's reach."""
    there = solved(LIFT, 3.0)
    pin = there.points["arm_pin"].c[0] - there.points["pivot"].c[0]
    with pytest.raises(NoAssembly) as caught:
        _ = Study(with_follower(LIFT, guide_height_mm=2200.0), 8).linkage
    assert caught.value.field == "follower.rod_mm"
    least = 2200.0 - float(MP.im(pin) / MM)
    assert f"{least:.6g} mm from the guide" in str(caught.value)
    assert f"make it longer than {math.ceil(least * 1e3) / 1e3:.6g} mm" in str(caught.value), (
        "rounded up, else too short"
    )


# -- the translating follower -----------------------------------------------------------------------------


@settings(max_examples=20)
@given(pushers(), ANGLES)
def test_a_translating_follower_stands_on_its_guide_at_its_distance(design: Design, theta: float) -> None:
    """The reference point is offset from the cam centre across the guide, and reach away from it where y = 0."""
    study = Study(design).at_theta(np.array([theta]))
    g, y, z = design.drive.mechanism, study.motion.y[:, 0], study.linkage.follower.z[:, 0]
    guide = MP.expj(MP.mpf(g.direction_deg) * MP.pi / 180)
    offset = MP.mpf(g.offset_mm) * MM
    start = circle_and_line(MP.mpc(0), reach_of(design), 1j * offset * guide, guide, 1)
    size = float(abs(start)) * (1.0 + float(offset) ** 2 / float(abs(start) ** 2 - offset**2)) + abs(y[0])
    # two conversions each of three lengths and an angle of up to pi, the root, the sum, the product
    bound = EPS * 12 * (size + float(abs(start)) * math.pi)
    assert off(complex(z[0]), start + float(y[0]) * guide) <= bound
    for k in range(1, 4):
        assert off(complex(z[k]), float(y[k]) * guide) <= EPS * (4 + math.pi) * abs(y[k])
    kinematics = study.linkage
    assert kinematics.base["follower"][0] == pytest.approx(float((start * MP.conj(guide)).real), abs=bound)
    assert complex(kinematics.travel[0]) == pytest.approx(complex(guide), abs=4 * EPS)


@pytest.mark.parametrize(("offset", "fits"), [(49.999, True), (50.0, False), (-49.999, True), (-50.1, False)])
def test_an_offset_beyond_the_base_circle_is_named(offset: float, fits: bool) -> None:
    """A reach of 40 + 10 mm, of which no bit is lost."""
    design = with_cam(with_follower(PUSHER, offset_mm=offset), base_radius_mm=40.0, roller_radius_mm=10.0)
    design = with_drive(design, motion=levels(0.0, (360.0, 0.0, "dwell")))
    if fits:
        assert Study(design, 8).linkage.base["follower"][0] == pytest.approx(
            math.sqrt(50.0e-3**2 - 49.999e-3**2), rel=1e-9
        )
    else:
        with pytest.raises(NoAssembly, match=r"follower\.offset_mm"):
            _ = Study(design, 8).linkage


def test_a_follower_that_passes_the_cam_centre_is_told_with_the_cam_angles() -> None:
    design = with_follower(PUSHER, offset_mm=0.0)
    motion = levels(
        0.0,
        (90.0, 0.0, "dwell"),
        (90.0, -76.0, "constant-velocity"),
        (60.0, -76.0, "dwell"),
        (120.0, 0.0, "constant-velocity"),
    )
    with pytest.raises(NoCam) as caught:
        _ = Study(with_drive(design, motion=motion), 3600).linkage
    ((first, last),) = caught.value.cam_angles
    assert first == pytest.approx(90.0 + 90.0 * 57.0 / 76.0, abs=0.1 + 1e-9)  # the cam angles are 0.1 apart
    assert last == pytest.approx(360.0 - 120.0 * 57.0 / 76.0, abs=0.1 + 1e-9)
    assert "19 mm" in str(caught.value), "by how much the radius is missed"


def test_the_base_circle_is_where_the_motion_is_zero() -> None:
    """Not where the motion starts: the lift stands 150 mm up at cam angle 0."""
    for name, design in DESIGNS.items():
        study = Study(with_drive(design, motion=levels(0.0, (360.0, 0.0, "dwell"))), 8)
        reach = float(reach_of(design))
        assert np.abs(study.linkage.follower.z[0]) == pytest.approx(reach, rel=64 * EPS), name
        if "phi" in study.linkage.base:
            for key in ("phi", "alpha", "beta"):
                assert apart(study.linkage.base[key][0], solved(design, 0.0).base[key]) <= EPS * ROUNDINGS * 32
