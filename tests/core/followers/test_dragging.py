"""core.followers.dragging with core.mechanism.checks: a joint is put where it is wanted, and the
typed lengths follow."""

import cmath
import math
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from linkages import assemblies
from mechanisms import LIFT

from core.design import LAYOUTS, CamSlider, Design, faults, get, put, with_drive
from core.errors import NoAssembly
from core.followers import base_position
from core.followers.dragging import joints_of, move_joint
from core.mechanism.kinematics import Kinematics
from core.project import load
from core.study import Study

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
LINKAGES = sorted(p.stem for p in EXAMPLES.glob("*.toml") if "\n[linkage]\n" in p.read_text("utf-8"))
HEIGHTS = {
    "a": (1300.0, 43.637), "b": (1300.0, 43.637), "c": (-1300.0, 130.0), "d": (-1300.0, 130.0),
    "e": (1300.0, 110.0), "f": (1300.0, 130.0), "g": (-1300.0, 60.0), "h": (-1300.0, 60.0),
}  # fmt: skip
ANGLES = (0.0, 0.9, 2.0, 5.0)  # one in each segment of the lift's motion


def layout(letter: str) -> Design:
    """The lift's lengths in another layout."""
    height, angle = HEIGHTS[letter]
    side = 1.0 if letter in "abef" else -1.0
    follower = replace(LIFT.drive.mechanism, layout=letter, guide_height_mm=height, fixed_angle_deg=angle)
    follower = replace(follower, pivot_x_mm=side * abs(follower.pivot_x_mm))
    return with_drive(LIFT, mechanism=follower)


def example(name: str) -> Any:
    return load(EXAMPLES / f"{name}.toml")


def kinematics_at(design: Design, theta: float) -> Kinematics:
    return Study(design).at_theta(np.array([theta])).linkage


def place(kinematics: Kinematics, point: str) -> complex:
    body = next(body for body in kinematics.bodies.values() if point in body.points)
    return complex(body.point(point)[0, 0])


def numbers(design: Design) -> dict[str, float]:
    """Every number of follower and cam, or of the links."""
    found: dict[str, float] = {}

    def walk(part: Any, at: str) -> None:
        if isinstance(part, dict):
            for key, value in part.items():
                walk(value, f"{at}.{key}")
        elif isinstance(part, list | tuple):
            for i, value in enumerate(part):
                walk(value, f"{at}[{i}]")
        elif isinstance(part, float):
            found[at] = part

    walk(asdict(design), "")
    return found


# -- cams -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "design",
    [*map(layout, LAYOUTS), *map(example, ("kim_1990", "finger_follower", "pushrod_train"))],
    ids=[*LAYOUTS, "translating", "rocker", "pushrod"],
)
def test_a_joint_at_its_own_place_changes_nothing(design: Design) -> None:
    for theta in ANGLES:
        kinematics = kinematics_at(design, theta)
        for name in joints_of(design):
            same = move_joint(design, kinematics, name, place(kinematics, name), 12)
            assert numbers(same) == pytest.approx(numbers(design), rel=1e-14, abs=1e-12)
            assert move_joint(design, kinematics, name, place(kinematics, name), 6) == design


@pytest.mark.parametrize("letter", LAYOUTS)
def test_a_joint_of_the_cam_slider_lands_where_it_is_put_and_the_others_stay(letter: str) -> None:
    """At any cam angle, by lengths and angles that the core solves forwards again; pivot, arm and slider stay in place but
    for the joint itself, and the roller on its base circle in the base position."""
    design, rng = layout(letter), np.random.default_rng(ord(letter))
    stay = {
        "pivot": (),
        "arm_pin": ("pivot", "slider_pin"),
        "slider_pin": ("pivot", "arm_pin"),
        "roller": ("pivot", "arm_pin", "slider_pin"),
    }
    for theta in ANGLES:
        kinematics = kinematics_at(design, theta)
        for name in joints_of(design):
            to = place(kinematics, name) + 0.05 * complex(*rng.normal(size=2))
            moved = move_joint(design, kinematics, name, to, 12)
            assert not moved.drive.is_linkage
            after = kinematics_at(moved, theta)
            assert place(after, name) == pytest.approx(to, abs=1e-12)
            for other in stay[name]:
                assert place(after, other) == pytest.approx(place(kinematics, other), abs=1e-12)
            reach = 1e-3 * (moved.drive.cam.base_radius_mm + moved.drive.cam.roller_radius_mm)
            base = base_position(moved.drive.mechanism, reach)  # type: ignore[arg-type]
            follower = moved.drive.mechanism
            assert isinstance(follower, CamSlider)
            roller = complex(follower.pivot_x_mm, follower.pivot_y_mm) + cmath.rect(follower.roller_arm_mm, base.alpha)
            assert abs(roller) * 1e-3 == pytest.approx(reach, rel=1e-12)


@pytest.mark.parametrize("name", ["finger_follower", "pushrod_train"])
def test_a_joint_of_a_valve_train_lands_where_it_is_put(name: str) -> None:
    """The pivot of the rocker and the joints that its lengths do not contain stay, and the face stays on the base circle."""
    design, rng = example(name), np.random.default_rng(5)
    stay = {
        "finger_follower": {"pivot": (), "roller": ("pivot", "pad_centre"), "pad_centre": ("pivot", "roller")},
        "pushrod_train": {
            "pivot": ("lower_ball",),
            "roller": (),
            "lower_ball": ("pivot", "upper_ball", "pad_centre", "roller"),
            "upper_ball": ("pivot", "lower_ball", "pad_centre", "roller"),
            "pad_centre": ("pivot", "lower_ball", "upper_ball", "roller"),
        },
    }[name]
    for theta in (0.3, 2.4, 3.1, 4.0):
        kinematics = kinematics_at(design, theta)
        assert set(joints_of(design)) == set(stay)
        for joint, others in stay.items():
            to = place(kinematics, joint) + 5e-4 * complex(*rng.normal(size=2))
            moved = move_joint(design, kinematics, joint, to, 12)
            after = kinematics_at(moved, theta)
            if joint != "roller" or name == "finger_follower":
                assert place(after, joint) == pytest.approx(to, abs=1e-11)
            for other in others:
                assert place(after, other) == pytest.approx(place(kinematics, other), abs=1e-11)


@pytest.mark.parametrize(
    ("joint", "changed"),
    [
        ("pivot", {"pivot_x_mm", "pivot_y_mm"}),
        ("arm_pin", {"slider_arm_mm", "rod_mm", "fixed_angle_deg"}),
        ("slider_pin", {"rod_mm", "guide_height_mm", "fixed_angle_deg"}),
        ("roller", {"roller_arm_mm", "fixed_angle_deg", "base_radius_mm"}),
    ],
)
def test_each_joint_changes_its_own_lengths(joint: str, changed: set[str]) -> None:
    kinematics = kinematics_at(LIFT, 0.9)
    moved = move_joint(LIFT, kinematics, joint, place(kinematics, joint) + 0.03 - 0.02j, 6)
    before, after = numbers(LIFT), numbers(moved)
    assert {path.rpartition(".")[2] for path in before if before[path] != after[path]} == changed
    assert faults(moved) == []
    assert joints_of(LIFT)[joint].field.rpartition(".")[2] in changed


def test_a_turned_guide_is_followed() -> None:
    """Fixed angle and heights are told in the frame of the guide."""
    turned = put(put(LIFT, "follower.guide_angle_deg", 20.0), "follower.fixed_angle_deg", 23.637)
    for joint in ("arm_pin", "slider_pin", "roller"):
        kinematics = kinematics_at(turned, 2.0)
        to = place(kinematics, joint) * 1.01
        assert place(kinematics_at(move_joint(turned, kinematics, joint, to, 12), 2.0), joint) == pytest.approx(
            to, abs=1e-12
        )


def test_an_arm_drawn_to_the_other_side_changes_the_letter() -> None:
    """The arm's pin drawn across the line from pivot to slider, far beyond it: the slider comes to stand on its other side."""
    kinematics = kinematics_at(LIFT, 0.0)
    pin, slider = place(kinematics, "arm_pin"), place(kinematics, "slider_pin")
    to = complex(2.0 * slider.real - pin.real, pin.imag)
    moved = move_joint(LIFT, kinematics, "arm_pin", to, 12)
    assert not moved.drive.is_linkage
    follower = moved.drive.mechanism
    assert isinstance(follower, CamSlider)
    assert (LIFT.drive.mechanism.layout, follower.layout) == ("b", "a")  # type: ignore[union-attr]
    assert place(kinematics_at(moved, 0.0), "arm_pin") == pytest.approx(to, abs=1e-12)


def test_where_nothing_meets_it_is_told_with_lengths() -> None:
    """So near to the slider's lowest place that arm and rod cannot come together when the slider is back at 0."""
    kinematics = kinematics_at(LIFT, 0.0)
    assert kinematics.motion.y[0, 0] == pytest.approx(0.15)
    pivot, slider = place(kinematics, "pivot"), place(kinematics, "slider_pin")
    with pytest.raises(NoAssembly, match=r"follower\.rod_mm: slider arm \S+ mm and rod \S+ mm do not meet in the base"):
        move_joint(LIFT, kinematics, "arm_pin", pivot + (slider - pivot) * (0.5 + 1e-6j), 12)
    tappet = example("kim_1990")
    there = kinematics_at(tappet, math.pi)
    with pytest.raises(NoAssembly, match=r"cam\.base_radius_mm: .* behind the cam centre"):
        move_joint(tappet, there, "roller", -place(there, "roller"), 6)


@given(st.floats(-0.02, 0.02), st.floats(-0.02, 0.02), st.floats(0.0, 6.28))
def test_the_roller_of_a_translating_follower_lands_where_it_is_put(x: float, y: float, theta: float) -> None:
    design = example("kim_1990")
    kinematics = kinematics_at(design, theta)
    to = place(kinematics, "roller") * (1.0 + complex(x, y) / abs(place(kinematics, "roller")) * 0.2)
    moved = move_joint(design, kinematics, "roller", to, 12)
    assert place(kinematics_at(moved, theta), "roller") == pytest.approx(to, rel=1e-11)


# -- linkages ---------------------------------------------------------------------------------------------


def centre(design: Design, kinematics: Kinematics, path: str) -> complex:
    """Where the centre of mass of a row of the loads stands [m]."""
    row = get(design, path)
    pose = kinematics.bodies[f"link{row.link}"]
    return complex(pose.origin[0][0] + 1e-3 * complex(row.centre_x_mm, row.centre_y_mm) * np.exp(1j * pose.turn[0][0]))


@pytest.mark.parametrize("name", LINKAGES)
def test_a_joint_of_a_linkage_at_its_own_place_changes_nothing(name: str) -> None:
    design = example(name)
    for theta in (0.4, 2.0):
        kinematics = kinematics_at(design, theta)
        for point in joints_of(design):
            at = centre(design, kinematics, point) if point.startswith("loads.") else place(kinematics, point)
            same = move_joint(design, kinematics, point, at, 12)
            assert numbers(same) == pytest.approx(numbers(design), rel=1e-13, abs=1e-9)


@given(assemblies(), st.floats(-2.0, 2.0), st.floats(-2.0, 2.0))
def test_a_joint_of_any_linkage_lands_where_it_is_put(drawn: tuple[Design, float], x: float, y: float) -> None:
    """Of the driver along its line, of a link that slides along its guide, else right there; nothing else moves but what
    hangs on the frame's points."""
    design, q = drawn
    kinematics = kinematics_at(design, q)
    sliding = {str(s.link) for s in design.drive.mechanism.sliders}
    for point in joints_of(design):
        having = {link.number for link in design.drive.mechanism.links if point in link.places}
        if having & {1, design.drive.mechanism.driver.link} or having & {int(n) for n in sliding}:
            continue
        to = place(kinematics, point) + 1e-3 * complex(x, y)
        moved = move_joint(design, kinematics, point, to, 12)
        after = kinematics_at(moved, q)
        size = Study(design).driver_ranges.plan.size
        assert place(after, point) == pytest.approx(to, abs=1e-12 * size * max(1.0, float(kinematics.condition.max())))
        for body in kinematics.bodies:
            for other in kinematics.bodies[body].points:
                if other != point and not other.isdecimal():
                    there = complex(kinematics.bodies[body].point(other)[0, 0])
                    assert complex(after.bodies[body].point(other)[0, 0]) == pytest.approx(there, abs=1e-9 * size)


def test_a_point_of_the_frame_moves_alone() -> None:
    design = example("four_bar")
    kinematics = kinematics_at(design, 1.0)
    moved = move_joint(design, kinematics, "O4", 0.11 + 0.004j, 12)
    changed = [
        a.number for a, b in zip(design.drive.mechanism.links, moved.drive.mechanism.links, strict=True) if a != b
    ]
    assert changed == [1]
    assert moved.drive.mechanism.by_number[1].places["O4"] == pytest.approx(110.0 + 4.0j)


def test_a_point_of_the_crank_keeps_to_its_line() -> None:
    design = example("four_bar")
    kinematics = kinematics_at(design, math.pi / 2.0)
    moved = move_joint(design, kinematics, "A", 0.01 + 0.04j, 12)
    assert moved.drive.mechanism.by_number[2].places["A"] == pytest.approx(40.0, abs=1e-9)
    assert place(kinematics_at(moved, math.pi / 2.0), "A") == pytest.approx(0.04j, abs=1e-12)


def test_a_point_that_slides_keeps_to_its_guide() -> None:
    design = example("slider_crank")
    kinematics = kinematics_at(design, 1.0)
    moved = move_joint(design, kinematics, "B", place(kinematics, "B") + 0.01 + 0.02j, 12)
    assert place(kinematics_at(moved, 1.0), "B") == pytest.approx(place(kinematics, "B") + 0.01, abs=1e-12)
    assert moved.drive.mechanism.sliders == design.drive.mechanism.sliders


def test_what_is_no_joint_is_a_key_error() -> None:
    design = example("four_bar")
    with pytest.raises(KeyError):
        move_joint(design, kinematics_at(design, 0.0), "Z", 0j)
    with pytest.raises(KeyError):
        move_joint(LIFT, kinematics_at(LIFT, 0.0), "guide", 0j)


def test_a_driver_that_slides_stays_where_the_motion_puts_it() -> None:
    design = example("cam_slider_linkage")
    assert "S" not in joints_of(design)
