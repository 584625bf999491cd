"""Limits of an optimal law are lines in the diagrams of the motion editor, which the mouse drags."""

import math

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from window_user import Open, User, settle

from core.design import CurveLimits, OptimalCurve, require_motion
from kindyna_gui.motion.limit_plot import LimitLine, LimitPlot

PATH = "motion.segments[1]"
NAMES = ("velocity", "acceleration", "jerk")
LEFT = Qt.MouseButton.LeftButton
NONE = Qt.KeyboardModifier.NoModifier


@pytest.fixture
def user(same_window: Open) -> User:
    user = same_window(size=(1440, 900), whole=True)
    user.choose("View", "Make")
    user.motion().choose(1)
    user.session.edit(f"{PATH}.law", "optimal", "Choose the optimal law")
    user.motion().choose(1)
    user.wait_for_laws()
    return user


def curve(user: User) -> OptimalCurve:
    result = require_motion(user.session.typed).segments[1].curve
    assert isinstance(result, OptimalCurve)
    return result


def plot(user: User, name: str) -> LimitPlot:
    return user.motion().derivatives.plots[NAMES.index(name)]


def line(user: User, name: str) -> LimitLine:
    user.wait_for_laws()
    (only,) = plot(user, name).limit_lines
    return only


def peak(user: User, name: str) -> float:
    """Largest derivative of the segment, for span 1 and rise 1."""
    user.wait_for_laws()
    order, compiled, segment = (
        1 + NAMES.index(name),
        user.session.study.program,
        require_motion(user.design).segments[1],
    )
    theta = np.deg2rad(np.linspace(35.0, 35.0 + segment.span_deg - 1e-9, 5001))
    y = compiled.state(compiled.angles(theta)).y[order]
    return float(np.abs(y).max() * np.deg2rad(segment.span_deg) ** order / abs(segment.rise * 1e-3))


class Hand:
    """The mouse on the line of a limit."""

    def __init__(self, user: User, name: str) -> None:
        self.user, self.plot = user, plot(user, name)
        self.grabbed = line(user, name)
        self.at = self.plot.position_of_limit(self.grabbed).toPoint()
        QTest.mouseMove(self.plot.viewport(), self.at)
        QTest.mousePress(self.plot.viewport(), LEFT, NONE, self.at)

    def pull(self, limit: float) -> None:
        """Move to the height of a limit, normalised."""
        grabbed = self.grabbed
        target = LimitLine(
            grabbed.segment, grabbed.order, grabbed.begin, grabbed.end, limit, limit * grabbed.unit, grabbed.unit
        )
        self.at = QPoint(self.at.x(), self.plot.position_of_limit(target).toPoint().y())
        QTest.mouseMove(self.plot.viewport(), self.at)
        self.user.wait_for_laws()

    def release(self) -> None:
        QTest.mouseRelease(self.plot.viewport(), LEFT, NONE, self.at)
        self.user.wait_for_laws()


def test_a_limit_is_dragged_and_the_law_follows(user: User) -> None:
    user.enter(f"{PATH}.limits.jerk", "60")
    steps = len(user.steps)
    hand = Hand(user, "jerk")
    hand.pull(50.0)
    first = peak(user, "jerk")
    assert first == pytest.approx(50.0, rel=0.03), "before the button is released"
    hand.pull(40.0)
    hand.release()
    assert curve(user).limits.jerk == pytest.approx(40.0, rel=0.03)
    assert peak(user, "jerk") == pytest.approx(curve(user).limits.jerk, rel=1e-6)
    assert user.steps[steps:] == [f"Change jerk limit of segment 2 to {curve(user).limits.jerk:g}"]
    user.choose("Edit", f"Undo {user.steps[-1]}")
    assert curve(user).limits == CurveLimits(jerk=60.0)
    assert line(user, "jerk").limit == 60.0


def test_the_line_is_at_the_value_of_the_motion(user: User) -> None:
    user.enter(f"{PATH}.limits.jerk", "60")
    segment, study = require_motion(user.design).segments[1], user.session.study
    omega, beta = abs(study.omega), math.radians(segment.span_deg)
    shown = line(user, "jerk")
    values = np.abs(study.motion.y[3]) * omega**3
    in_segment = (study.theta > math.radians(35.0)) & (study.theta < math.radians(76.5))
    assert shown.value * 1e-3 == pytest.approx(60.0 * abs(segment.rise) * 1e-3 * (omega / beta) ** 3, rel=1e-9)
    assert shown.value * 1e-3 == pytest.approx(values[in_segment].max(), rel=1e-6)
    assert (shown.begin, shown.end) == (35.0, 76.5)


def test_a_limit_is_set_by_a_drag_of_the_offered_line(user: User) -> None:
    assert line(user, "velocity").limit is None
    assert plot(user, "acceleration").limit_lines == [], "its peak is minimised"
    hand = Hand(user, "velocity")
    hand.pull(1.6)
    hand.release()
    limit = curve(user).limits.velocity
    assert limit == pytest.approx(1.6, rel=0.03)
    assert peak(user, "velocity") == pytest.approx(limit, rel=1e-6)
    user.enter(f"{PATH}.limits.velocity", "")
    assert curve(user).limits.velocity is None
    assert line(user, "velocity").limit is None


def test_a_limit_that_no_law_keeps_is_refused_with_the_least_one(user: User) -> None:
    user.enter(f"{PATH}.limits.jerk", "60")
    hand = Hand(user, "jerk")
    hand.pull(40.0)
    kept = curve(user).limits.jerk
    hand.pull(20.0)
    assert curve(user).limits.jerk == kept, "the law stays"
    hand.release()
    refusal = hand.plot.refusal
    assert refusal.isVisible()
    assert "the least one is 32.048" in refusal.text()
    (button,) = refusal.buttons.values()
    assert button.text() == "Use 32.048"
    button.click()
    settle()
    assert curve(user).limits.jerk == 32.048
    assert not refusal.isVisible()
    assert user.session.incomplete is None


def test_a_typed_limit_that_no_law_keeps_has_the_same_button(user: User) -> None:
    user.enter(f"{PATH}.limits.jerk", "20")
    message = user.field(f"{PATH}.limits.jerk").message
    assert "the least one is 32.048" in message.text()
    message.buttons["Use 32.048"].click()
    settle()
    assert curve(user).limits.jerk == 32.048
    assert user.session.incomplete is None
    assert not message.isVisible()


def test_escape_restores_the_limit(user: User) -> None:
    user.enter(f"{PATH}.limits.jerk", "60")
    hand = Hand(user, "jerk")
    hand.pull(45.0)
    hand.plot.setFocus()
    QTest.keyClick(hand.plot, Qt.Key.Key_Escape)
    hand.release()
    assert curve(user).limits.jerk == 60.0


def test_other_segments_have_no_lines(user: User) -> None:
    user.motion().choose(3)
    settle()
    assert plot(user, "velocity").limit_lines == []
    user.motion().choose(1)
    user.enter(f"{PATH}.limits.velocity", "1.7")
    user.motion().choose(3)
    settle()
    assert [row.limit for row in plot(user, "velocity").limit_lines] == [1.7], "limits that are set stay in sight"


def test_the_tip_says_what_a_line_does(user: User) -> None:
    shown = plot(user, "velocity")
    at = shown.position_of_limit(line(user, "velocity")).toPoint()
    QTest.mouseMove(shown.viewport(), at)
    assert shown.toolTip().startswith("Drag to set a velocity limit of segment 2")
    QTest.mouseMove(shown.viewport(), QPoint(at.x(), at.y() + 25))
    assert "cam angle" in shown.toolTip()
