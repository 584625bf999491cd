"""kindyna_gui.motion.diagram: what can be taken hold of in a displacement diagram, and what a pull makes of it."""

import pytest

from core.design import Motion, NamedCurve, Segment, join_range
from kindyna_gui.motion.diagram import (
    LEVEL,
    LINE,
    POINT,
    DiagramScale,
    Grip,
    GripDrag,
    grip_at,
    segment_at,
    snap,
    snap_angle,
    step_join,
)

DWELL, SINE = NamedCurve("dwell"), NamedCurve("modified-sine")
LIFT = Motion(
    150.0,
    (
        Segment(35.0, 0.0, DWELL),
        Segment(41.5, -150.0, SINE),
        Segment(207.0, 0.0, DWELL),
        Segment(41.5, 150.0, SINE),
        Segment(35.0, 0.0, DWELL),
    ),
)
SCALE = DiagramScale(
    left=100.0, right=460.0, top=20.0, bottom=220.0, low=-25.0, high=175.0
)  # 1 pixel = 1 degree = 1 mm


def at(angle: float, level: float) -> tuple[float, float]:
    return SCALE.x(angle), SCALE.y(level)


# -- places -----------------------------------------------------------------------------------------------


def test_levels_go_up_and_angles_to_the_right() -> None:
    assert at(0.0, -25.0) == (100.0, 220.0)
    assert at(360.0, 175.0) == (460.0, 20.0)
    assert (SCALE.angle(280.0), SCALE.angle(0.0), SCALE.angle(900.0)) == (180.0, 0.0, 360.0)
    assert (SCALE.degree, SCALE.unit) == (1.0, 1.0)


@pytest.mark.parametrize(
    ("angle", "level", "grip"),
    [
        (76.5, 0.0, Grip(POINT, 2, 1)),
        (80.0, 4.0, Grip(POINT, 2, 1)),
        (0.0, 150.0, Grip(POINT, 0, 4)),
        (360.0, 150.0, Grip(POINT, 0, 4)),
        (76.5, 90.0, Grip(LINE, 2, 1)),
        (79.0, -15.0, Grip(LINE, 2, 1)),
        (180.0, 2.0, Grip(LEVEL, 2, 2)),
        (20.0, 150.0, Grip(LEVEL, 0, 0)),
        (340.0, 152.0, Grip(LEVEL, 4, 4)),
        (180.0, 10.0, None),
        (55.0, 75.0, None),  # on a curve that moves
        (0.0, 60.0, None),  # the axis: cam angle 0 stays
        (76.5, 190.0, None),  # above the diagram
    ],
)
def test_points_lines_and_levels_can_be_taken(angle: float, level: float, grip: Grip | None) -> None:
    assert grip_at(LIFT, SCALE, *at(angle, level)) == grip


def test_the_nearest_of_two_points_is_taken() -> None:
    near = Motion(0.0, (Segment(100.0, 4.0, SINE), Segment(4.0, 2.0, SINE), Segment(256.0, -6.0, SINE)))
    grips = [grip_at(near, SCALE, SCALE.x(x), SCALE.y(5.0)) for x in (99.0, 105.0)]
    assert [grip.join for grip in grips if grip is not None] == [1, 2]


def test_a_segment_is_found_by_its_angle() -> None:
    assert [segment_at(LIFT, angle) for angle in (0.0, 34.9, 35.0, 200.0, 359.0, 360.0)] == [0, 0, 1, 2, 4, 4]


def test_an_angle_that_was_pointed_at_is_rounded() -> None:
    assert [snap_angle(a) for a in (50.0, 50.12, 34.615384, 34.8, 49.99999999999)] == [50.0, 50.12, 34.5, 34.8, 50.0]


# -- pulls ------------------------------------------------------------------------------------------------


def pull(kind: str, join: int) -> GripDrag:
    return GripDrag(LIFT, Grip(kind, join, max(join - 1, 0)), SCALE)


def test_a_point_moves_in_both_directions() -> None:
    assert pull(POINT, 2).move(10.2, -20.4) == (86.5, 20.0)


def test_a_trembling_hand_means_nothing() -> None:
    hand = pull(POINT, 2)
    assert hand.move(2.0, -3.0) == (None, None)
    assert hand.move(8.0, 1.0) == (86.5, None)
    assert hand.move(0.0, 8.0) == (86.5, -6.0)


def test_a_line_keeps_its_level_and_a_level_its_angle() -> None:
    assert pull(LINE, 2).move(10.0, 40.0) == (86.5, None)
    assert pull(LEVEL, 2).move(10.0, 40.0) == (None, -40.0)


def test_cam_angle_0_stays() -> None:
    assert pull(POINT, 0).move(30.0, 10.0) == (None, 140.0)


def test_shift_keeps_to_the_direction_that_is_meant_more() -> None:
    hand = pull(POINT, 2)
    assert hand.move(10.0, 6.0, one_direction=True) == (86.5, None)
    assert hand.move(0.0, 20.0, one_direction=True) == (None, -26.0)
    assert hand.move(0.0, 0.0) == (86.5, -26.0)
    assert pull(POINT, 0).move(40.0, 10.0, one_direction=True) == (None, 140.0)


def test_ctrl_is_ten_times_finer() -> None:
    hand = pull(POINT, 2)
    assert hand.move(10.0, -20.0, fine=True) == (77.5, 2.0)
    assert hand.move(0.4, -0.6, fine=True) == (77.55, 2.0)
    assert hand.move(10.0, 0.0) == (87.5, 2.0)  # from where it is: letting Ctrl go does not make it jump


def test_an_angle_stays_between_its_neighbours() -> None:
    hand = pull(LINE, 2)
    low, high = join_range(LIFT, 2)
    assert 35.0 < low < high < 283.5
    assert hand.move(500.0, 0.0) == (high, None)
    assert hand.move(-900.0, 0.0) == (low, None)
    assert hand.move(400.0, 0.0) == (76.5, None)


@pytest.mark.parametrize(("value", "way", "wanted"), [(76.3, 0, 76.5), (76.5, 1, 77.0), (76.5, -1, 76.0),
                                                      (76.3, 1, 76.5), (76.3, -1, 76.0), (0.1, -1, 0.0)])  # fmt: skip
def test_steps_lead_to_round_values(value: float, way: int, wanted: float) -> None:
    assert snap(value, 0.5, way) == wanted


def test_levels_step_by_what_a_hand_can_aim_at() -> None:
    assert SCALE.level_step == 2.0
    assert DiagramScale(0.0, 360.0, 0.0, 100.0, 0.0, 1.0).level_step == 0.02


# -- keys -------------------------------------------------------------------------------------------------


def test_keys_move_by_one_step() -> None:
    assert step_join(LIFT, 2, SCALE, (1, 0)) == (77.0, None)
    assert step_join(LIFT, 2, SCALE, (0, -1)) == (None, -2.0)
    assert step_join(LIFT, 2, SCALE, (-1, 0), fine=True) == (76.45, None)
    assert step_join(LIFT, 0, SCALE, (1, 0)) == (None, None)
    assert step_join(LIFT, 0, SCALE, (0, 1), fine=True) == (None, 150.2)
