"""Least clearances over a turn: proven bounds, meetings to 1e-6 degrees, slides by hand, a coupler by its own loop."""

import cmath
import math

import numpy as np
import pytest
from outlined import clearance, example, four_bar_points, outline, rise, slides, studied

from core.study import Study

BLOCK = [[0.0, 60.0], [30.0, 60.0], [30.0, 100.0]]
CASES = {
    "bars of a four-bar": (
        example("four_bar")
        + outline("link 3", round_mm=3.0)
        + outline("link 4", points=[[-8.0, -30.0], [20.0, -25.0], [8.0, 5.0]])
        + outline("frame", points=[[-40.0, 60.0], [-10.0, 60.0], [-10.0, 100.0]], round_mm=1.0)
        + outline("link 2", points=[[-25.0, -6.0], [40.0, -6.0], [40.0, 6.0], [-25.0, 6.0]])
    ),
    "a cam and its arm": (
        example("transfer_lift") + outline("arm", round_mm=40.0) + outline("cam") + outline("follower", points=BLOCK)
    ),
    "drives, one of them mirrored": (
        example("transfer_unit")
        + outline("arm", drive="Feed", round_mm=30.0)
        + outline("follower", drive="Clamp", points=[[0.0, -40.0], [300.0, -40.0], [300.0, 40.0], [0.0, 40.0]])
        + outline("cam", drive="Clamp")
        + outline("roller", drive="Lift")
    ),
    "a transferred part": (
        example("transfer_unit")
        + outline("carried", plane="xz", points=[[0.0, 0.0], [40.0, 0.0], [40.0, 30.0], [0.0, 30.0]])
        + outline("frame", plane="xz", points=[[60.0, -50.0], [120.0, -50.0], [120.0, -10.0], [60.0, -10.0]])
        + outline("frame", points=[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    ),
}


def check_against_angles(study: Study, count: int) -> None:
    clearances = study.clearances
    assert clearances.require_pairs()
    theta = np.linspace(0.0, 2.0 * np.pi, count)[:-1]
    pose = clearances.at(clearances.angles(theta))
    for pair in clearances.pairs:
        values, result = clearances.distance(pair, pose), clearances.least(pair)
        assert result.at_least <= values.min() + 1e-15
        assert result.value <= values.min() + 1e-6  # within 1 µm
        if not result.meets:
            assert result.value - result.at_least <= 1.5e-6
            assert abs(result.points[0] - result.points[1]) == pytest.approx(result.value, abs=1e-9)
            assert values.min() > 0.0
            continue
        inside = np.zeros(theta.size, dtype=bool)
        for begin, end in result.meets:
            after, before = theta >= begin, theta <= end
            inside |= after & before if begin <= end else after | before
        assert (inside == (values == 0.0)).all()


@pytest.mark.parametrize("name", CASES)
def test_the_bound_is_never_above_the_exact_distances(name: str) -> None:
    check_against_angles(studied(CASES[name]), 1441)


@pytest.mark.stress
@pytest.mark.parametrize("name", CASES)
def test_the_bound_is_never_above_20001_exact_distances(name: str) -> None:
    check_against_angles(studied(CASES[name]), 20_002)


def test_two_slides_with_phases_by_hand() -> None:
    """Right less left is least where the left one is up and the right one down: gap + y(θ - φ₂) - y(θ - φ₁)."""
    study = studied(slides(0.0, 100.0, 40.0))
    theta = np.linspace(0.0, 360.0, 2_000_001)
    exact = 40.0 + rise(theta - 100.0) - rise(theta)
    (pair,) = study.clearances.pairs
    result = study.clearances.least(pair)
    assert study.clearances.column(pair) == "left_follower__right_follower_mm"
    assert result.value * 1e3 == pytest.approx(exact.min(), abs=1e-3)
    assert result.at_least * 1e3 <= exact.min()
    assert result.at_least * 1e3 >= exact.min() - 1.01e-3


def test_the_ends_of_a_meeting_of_two_slides_are_exact() -> None:
    """They meet while the left one is more than 10 mm above the right one: both edges solved on the law itself."""
    from scipy.optimize import brentq

    study = studied(slides(0.0, 100.0, 10.0))

    def gap(theta: float) -> float:
        return 10.0 + float(rise(np.array([theta - 100.0]))[0]) - float(rise(np.array([theta]))[0])

    begin, end = brentq(gap, 20.0, 100.0, xtol=1e-12), brentq(gap, 110.0, 220.0, xtol=1e-12)
    result = study.clearances.least(study.clearances.pairs[0])
    (meeting,) = result.meets
    assert (result.value, result.at_least) == (0.0, 0.0)
    assert np.rad2deg(meeting) == pytest.approx((begin, end), abs=1e-6)


def test_a_point_of_a_coupler_and_a_post_of_the_frame() -> None:
    """A pin of 2 mm at C of the coupler, a post of 4 mm in the frame, by the loop of the four-bar itself."""
    post = complex(20.0, 110.0)
    text = example("four_bar") + outline("link 3", points=[[45.0, 40.0]], round_mm=2.0)
    study = studied(text + outline("frame", points=[[post.real, post.imag]], round_mm=4.0))
    (pair,) = study.clearances.pairs

    def exact(theta: float) -> float:
        a, _, unit = four_bar_points(theta)
        return abs(a + unit * complex(45.0, 40.0) - post) - 6.0

    low = min((2.0 * math.pi * k / 20_000 for k in range(20_000)), key=exact)
    steps = np.linspace(low - 4e-4, low + 4e-4, 2001)
    least = min(map(exact, steps.tolist()))
    result = study.clearances.least(pair)
    assert result.value * 1e3 == pytest.approx(least, abs=1e-3)
    assert result.at_least * 1e3 <= least
    at = study.clearances.distance(pair, study.clearances.at(study.clearances.angles(np.array([1.0, 3.0]))))
    assert at * 1e3 == pytest.approx([exact(1.0), exact(3.0)], abs=1e-9)


def test_bodies_that_touch_by_design_are_no_pairs_unless_they_are_stated() -> None:
    bars = "".join(outline(f"link {n}", round_mm=3.0) for n in (2, 3, 4))
    study = studied(example("four_bar") + bars)
    assert list(study.clearances.by_column) == ["link_2__link_4_mm"]
    study = studied(example("four_bar") + bars + clearance("link 2", "link 3", 0.0))
    assert list(study.clearances.by_column) == ["link_2__link_3_mm", "link_2__link_4_mm"]
    lift = example("transfer_lift") + outline("roller") + outline("cam") + outline("arm", round_mm=20.0)
    assert list(studied(lift).clearances.by_column) == ["cam__arm_mm"]  # the arm carries the roller


def test_a_mirrored_drive_is_seen_from_the_first_end() -> None:
    """Of two equal drives the mirrored one is the reflection of the other at the other sense of rotation."""
    arm = example("transfer_unit").replace("mirrored = true", "mirrored = {}")
    box = [[0.0, -10.0], [100.0, -10.0], [100.0, 60.0], [0.0, 60.0]]
    post = cmath.rect(200.0, 1.0)

    def least(mirrored: bool) -> float:
        text = arm.format("true" if mirrored else "false") + outline("follower", drive="Clamp", points=box)
        x = -post.real if mirrored else post.real
        study = studied(text + outline("frame", points=[[x, post.imag]], round_mm=5.0))
        return study.clearances.least(study.clearances.pairs[0]).value

    assert least(True) == pytest.approx(least(False), abs=1e-9)


def test_the_circle_of_a_roller_stays_on_the_profile_of_its_cam() -> None:
    """The pair is no default one; stated, its distance is 0 to the deviation of the arcs."""
    text = example("transfer_lift") + outline("roller") + outline("cam") + clearance("roller", "cam", 0.0)
    study = studied(text)
    (pair,) = study.clearances.pairs
    pose = study.clearances.at(study.clearances.angles(np.linspace(0.0, 6.28, 200)))
    assert study.clearances.distance(pair, pose).max() < 2e-7


def test_the_spans_in_which_slides_are_nearer_than_they_must_be() -> None:
    from scipy.optimize import brentq

    study = studied(slides(0.0, 100.0, 40.0) + clearance("left.follower", "right.follower", 15.0))

    def spare(theta: float) -> float:
        return 25.0 + float(rise(np.array([theta - 100.0]))[0]) - float(rise(np.array([theta]))[0])

    begin, end = brentq(spare, 20.0, 100.0, xtol=1e-12), brentq(spare, 110.0, 220.0, xtol=1e-12)
    (span,) = study.clearances.too_near(study.clearances.pairs[0])
    assert np.rad2deg(span) == pytest.approx((begin, end), abs=1e-6)
    assert study.clearances.least(study.clearances.pairs[0]).meets == ()
    assert studied(slides(0.0, 100.0, 40.0)).clearances.too_near(study.clearances.pairs[0]) == ()


@pytest.mark.parametrize("angle", [33.25, 77.13, 201.4])
def test_a_passage_between_two_samples_is_not_missed(angle: float) -> None:
    """A pin of 1 mm on a crank of 2 m passes a post of 1 mm at 0.5 mm within a tenth of a degree; another post is 4 mm away."""
    near, far = cmath.rect(2002.5, math.radians(angle)), cmath.rect(2006.0, math.radians(90.0))
    text = example("four_bar") + outline("link 2", points=[[2000.0, 0.0]], round_mm=1.0)
    for post in (near, far):
        text += outline("frame", points=[[post.real, post.imag]], round_mm=1.0)
    study = studied(text)
    result = study.clearances.least(study.clearances.pairs[0])
    assert result.value * 1e3 == pytest.approx(0.5, abs=1e-3)
    assert math.degrees(result.theta) == pytest.approx(angle, abs=0.01)
