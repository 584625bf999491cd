"""kindyna_gui.motion.law_picker, motion_curve, motion_points: a law is picked from pictures, and its curve is shaped."""

import math

import numpy as np
import pytest
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QImage, QPainter
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractItemView, QApplication
from window_user import Open, User, settle, wait_for

from core.design import CURVES, NamedCurve, PolynomialCurve, PolynomialEnd, SccaCurve, SplineCurve, SplinePoint, edited
from core.laws import EVERY_LAW, LAWS, law_groups, peaks
from core.project import load
from kindyna_gui.labels import law_label, name_of
from kindyna_gui.motion.curve_fields import EndField
from kindyna_gui.motion.curve_lists import ListsTable, OptionalBox
from kindyna_gui.motion.law_picker import LawBox, LawPicker, law_tip, matching_laws, peaks_text
from kindyna_gui.motion.segments_table import LAW
from kindyna_gui.pictures.plots.quantities import curves_of, paint_law, prescribed
from kindyna_gui.pictures.style import LIGHT
from kindyna_gui.pictures.units import short
from kindyna_gui.places import example

LIFT = load(example("transfer_lift"))
EDITING = QAbstractItemView.State.EditingState


@pytest.fixture
def user(same_window: Open) -> User:
    """Without plots, for which no test here has eyes, and without its mechanism's limits of reach."""
    made = same_window()
    made.session.stages_on_screen = tuple
    return made


def curve(user: User, segment: int = 1) -> NamedCurve | SccaCurve | PolynomialCurve | SplineCurve:
    return user.design.drive.motion.segments[segment].curve


def picker(user: User, row: int = 1, key: Qt.Key = Qt.Key.Key_Return) -> LawPicker:
    """Open the picker of a cell by a key."""
    view = user.motion()
    view.choose(row, LAW)
    view.table.setFocus()
    user.press(key)
    wait_for(lambda: isinstance(QApplication.activePopupWidget(), LawPicker))
    made = QApplication.activePopupWidget()
    assert isinstance(made, LawPicker)
    return made


def closed(user: User) -> bool:
    return user.motion().table.state() != EDITING


# -- the laws in their groups -----------------------------------------------------------------------------


def test_every_law_stands_in_one_group() -> None:
    told = [slug for slugs in law_groups().values() for slug in slugs]
    assert sorted(told) == sorted(EVERY_LAW)


@pytest.mark.parametrize("slug", EVERY_LAW)
def test_peaks_are_those_of_the_core(slug: str) -> None:
    text = peaks_text(slug)
    if slug not in LAWS or slug == "dwell":
        assert text == EVERY_LAW[slug].own
    else:
        told = peaks(LAWS[slug])
        assert text.split() == ["Cv", short(told.cv, 3), "Ca", short(told.ca, 3), "Cj", short(told.cj, 3)]


def test_peaks_read_as_in_the_books() -> None:
    assert peaks_text("modified-sine") == "Cv 1.76  Ca 5.53  Cj 69.5"
    assert peaks_text("parabolic") == "Cv 2  Ca 4  Cj ∞"


def test_laws_are_found_by_words_of_name_and_group() -> None:
    assert [s for slugs in matching_laws("3-4-5").values() for s in slugs] == ["3-4-5"]
    assert set(matching_laws("blending return")) == {"Elementary curves for blending: return"}
    assert [s for slugs in matching_laws("CYCL return").values() for s in slugs] == ["c3", "c4", "c6"]
    assert matching_laws("wobble") == {}
    assert matching_laws("  ") == law_groups()


def test_a_tip_says_where_a_law_would_jump() -> None:
    assert "acceleration jumps at a dwell" in law_tip("simple-harmonic")
    assert "velocity, which jumps at a dwell" in law_tip("c1")
    assert "jumps" not in law_tip("cycloidal")
    assert law_tip("dwell") == "S = 0"
    assert all(law_tip(slug) for slug in EVERY_LAW)


def test_short_names_are_shorter() -> None:
    assert all(len(law.short_label) <= 11 for law in EVERY_LAW.values())
    assert len({law.short_label for law in EVERY_LAW.values()}) == len(EVERY_LAW)


# -- pictures ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("slug", EVERY_LAW)
def test_a_picture_shows_the_law(slug: str) -> None:
    (u, s), (_, a) = curves_of(slug)
    assert (u[0], u[-1]) == (0.0, pytest.approx(1.0))
    law = LAWS.get(slug)
    if slug == "dwell":
        assert not s.any()
        return
    returns = law is not None and law.rises < 0
    assert (s[0], s[-1]) == pytest.approx((1.0, 0.0) if returns else (0.0, 1.0), abs=1e-9)
    assert np.abs(a).max() == pytest.approx(0.0 if law is not None and peaks(law).ca == 0.0 else 1.0)
    if law is not None:
        inside = slice(1, -1)  # at joins inside the law the table gives the right-hand limit
        wanted = 1.0 - law(u)[0] if returns else law(u)[0]
        assert s[inside] == pytest.approx(wanted[inside], abs=1e-9)


def test_the_picture_of_a_spline_passes_its_points() -> None:
    (u, s), _ = curves_of("spline")
    points = prescribed("spline")
    assert len(points) == 3
    for place, value in points:
        assert float(np.interp(place, u, s)) == pytest.approx(value, abs=0.01)


@pytest.mark.parametrize("slug", EVERY_LAW)
def test_a_picture_stays_in_its_box(slug: str) -> None:
    image = QImage(140, 70, QImage.Format.Format_RGB32)
    image.fill(Qt.GlobalColor.white)
    painter = QPainter(image)
    paint_law(painter, QRectF(20.0, 14.0, 100.0, 42.0), slug, LIGHT)
    painter.end()
    white = image.pixel(0, 0)
    inked = [(x, y) for x in range(140) for y in range(70) if image.pixel(x, y) != white]
    assert inked
    assert min(x for x, _ in inked) >= 17
    assert max(x for x, _ in inked) <= 123
    assert min(y for _, y in inked) >= 11
    assert max(y for _, y in inked) <= 59


# -- picking ----------------------------------------------------------------------------------------------


def test_a_law_is_picked_by_mouse(user: User) -> None:
    view = user.motion()
    view.choose(1, LAW)
    box = view.table.visualRect(view.model.index(1, LAW))
    QTest.mouseClick(view.table.viewport(), Qt.MouseButton.LeftButton, pos=box.center())
    QTest.mouseDClick(view.table.viewport(), Qt.MouseButton.LeftButton, pos=box.center())
    wait_for(lambda: isinstance(QApplication.activePopupWidget(), LawPicker))
    shown = QApplication.activePopupWidget()
    assert isinstance(shown, LawPicker)
    assert shown.grid.current == "modified-sine"
    place = shown.grid.box("cycloidal").center()
    QTest.mouseMove(shown.grid, place)
    wait_for(lambda: shown.grid.current == "cycloidal")
    QTest.mouseClick(shown.grid, Qt.MouseButton.LeftButton, pos=place)
    wait_for(lambda: closed(user))
    assert curve(user) == NamedCurve("cycloidal")
    assert user.steps == ["Change law of segment 2 to Cycloidal"]


def test_a_law_is_picked_by_arrows(user: User) -> None:
    shown = picker(user)
    user.press(Qt.Key.Key_Right)
    assert shown.grid.current == "modified-trapezoid"
    user.press(Qt.Key.Key_Left, Qt.Key.Key_Left, Qt.Key.Key_Up)
    assert shown.grid.current == "dwell"
    user.press(Qt.Key.Key_Up)
    assert shown.grid.current == "dwell"
    user.press(Qt.Key.Key_Down, Qt.Key.Key_Down, Qt.Key.Key_Right)
    assert shown.grid.current == "parabolic"
    user.press(Qt.Key.Key_Return)
    wait_for(lambda: closed(user))
    assert curve(user) == NamedCurve("parabolic")


def test_a_law_is_found_by_typing(user: User) -> None:
    """The first letter opens the picker, the next ones narrow it down."""
    shown = picker(user, key=Qt.Key.Key_F)
    assert shown.filter.text() == "f"
    user.type("reud")
    assert [cell.slug for cell in shown.grid.cells] == ["freudenstein-1-3", "freudenstein-1-3-5"]
    user.press(Qt.Key.Key_Right, Qt.Key.Key_Return)
    wait_for(lambda: closed(user))
    assert curve(user) == NamedCurve("freudenstein-1-3-5")


def test_what_is_not_found_is_told(user: User) -> None:
    shown = picker(user)
    user.type("wobble")
    assert shown.no_match.isVisible()
    user.press(Qt.Key.Key_Return)
    assert shown.isVisible()
    user.press(Qt.Key.Key_Escape)
    wait_for(lambda: closed(user))
    assert user.design == LIFT


def test_the_list_shows_the_law_that_is_chosen(user: User) -> None:
    shown = picker(user)
    for _ in range(11):
        user.press(Qt.Key.Key_Down)
    assert shown.grid.current == "spline"
    assert (
        shown.area.viewport()
        .rect()
        .contains(shown.grid.mapTo(shown.area.viewport(), shown.grid.box("spline").center()))
    )
    user.press(Qt.Key.Key_Escape)


def test_picking_the_same_law_keeps_its_parameters(user: User) -> None:
    user.session.edit("motion.segments[1].crossover", 0.4, "x")
    picker(user)
    user.press(Qt.Key.Key_Return)
    wait_for(lambda: closed(user))
    assert curve(user) == NamedCurve("modified-sine", 0.4)
    assert user.steps == ["x"]


def test_the_cell_of_a_law_forgets_its_picker(user: User) -> None:
    picker(user)
    box = user.motion().table.findChild(LawBox)
    assert box is not None
    user.press(Qt.Key.Key_Escape)
    wait_for(lambda: closed(user))
    settle()
    assert QApplication.activePopupWidget() is None
    assert user.motion().table.hasFocus()


# -- curves with parameters -------------------------------------------------------------------------------


def test_a_crossover_is_typed(user: User) -> None:
    user.enter("motion.segments[1].crossover", "0.4")
    assert curve(user) == NamedCurve("modified-sine", 0.4)
    assert user.steps == ["Change segment 2, crossover to 0.4"]
    user.enter("motion.segments[1].crossover", "1.2")
    field = user.motion().curve.fields["motion.segments[1].crossover"]
    assert field.trouble.startswith("Outside its range")
    assert curve(user) == NamedCurve("modified-sine", 0.4)


def test_only_what_can_be_shaped_has_a_form(user: User) -> None:
    view = user.motion()
    for slug, keys in (
        ("modified-sine", ["crossover"]),
        ("constant-velocity", []),
        ("c1", ["flat_fraction"]),
        ("double-harmonic", []),
        ("scca", ["cv_fraction", "ramp_fraction", "flat_fraction"]),
    ):
        user.session.edit("motion.segments[1].law", slug, "x")
        view.choose(1)
        assert [path.rpartition(".")[2] for path in view.curve.fields] == keys, slug
    view.choose(0)
    assert view.curve.fields == {}


def test_widths_are_typed_and_refused_where_they_are_too_much(user: User) -> None:
    user.session.edit("motion.segments[1].law", "scca", "x")
    user.enter("motion.segments[1].flat_fraction", "0.5")
    assert curve(user) == SccaCurve(0.0, 0.25, 0.5)
    user.enter("motion.segments[1].ramp_fraction", "0.6")
    assert "more than the full span" in user.motion().curve.fields["motion.segments[1].ramp_fraction"].trouble
    assert curve(user) == SccaCurve(0.0, 0.25, 0.5)


def test_the_ends_of_a_polynomial_are_typed(user: User) -> None:
    user.session.edit("motion.segments[1].law", "polynomial", "x")
    user.enter("motion.segments[1].start.velocity", "-2.5")
    assert curve(user) == PolynomialCurve(PolynomialEnd(-2.5))
    assert user.steps[-1] == "Change segment 2, start velocity to \u22122.5 mm/°"
    user.enter("motion.segments[1].end.jerk", "0.01")
    assert curve(user) == PolynomialCurve(PolynomialEnd(-2.5), PolynomialEnd(jerk=0.01))
    user.enter("motion.segments[1].end.jerk", "0")
    assert curve(user) == PolynomialCurve(PolynomialEnd(-2.5), PolynomialEnd(jerk=0.0))


def test_a_jerk_is_left_free(user: User) -> None:
    user.session.edit("motion.segments[1].law", "polynomial", "x")
    field = user.field("motion.segments[1].start.jerk")
    assert isinstance(field, EndField)
    box = field.editor
    assert isinstance(box, OptionalBox)
    assert (box.text(), box.lineEdit().placeholderText()) == ("", "free")
    user.press(Qt.Key.Key_Return)  # nothing was typed
    assert curve(user) == PolynomialCurve()
    user.type("0.02")
    user.press(Qt.Key.Key_Return)
    assert curve(user) == PolynomialCurve(PolynomialEnd(jerk=0.02))
    box.selectAll()
    user.press(Qt.Key.Key_Delete, Qt.Key.Key_Return)
    assert curve(user) == PolynomialCurve()
    assert box.text() == ""
    assert user.steps[-1] == "Leave segment 2, start jerk open"
    user.type("much")
    user.press(Qt.Key.Key_Return)
    assert field.trouble == "Not a number; enter a number, or nothing to leave it open"
    user.press(Qt.Key.Key_Escape)
    assert (box.text(), field.trouble) == ("", "")
    user.choose("Edit", "Undo Leave segment 2, start jerk open")
    assert box.text() == "0.02"


def points(user: User) -> ListsTable:
    user.motion().choose(1)
    made = user.motion().curve.points
    assert made is not None
    return made


def enter_point(user: User, row: int, column: int, text: str) -> None:
    """Type over a cell of the points, and Enter; an empty text clears it."""
    table = points(user).table
    table.setCurrentIndex(points(user).model.index(row, column))
    table.setFocus()
    user.press(Qt.Key.Key_Return)
    wait_for(lambda: table.state() == EDITING)
    if text:
        user.type(text)
    else:
        user.press(Qt.Key.Key_Delete)
    user.press(Qt.Key.Key_Return)
    wait_for(lambda: table.state() != EDITING)


def test_the_points_of_a_spline_come_and_go(user: User) -> None:
    user.session.edit("motion.segments[1].law", "spline", "x")
    user.window.player.step(55.75)
    before = user.session.study.motion.y[0].copy()
    QTest.mouseClick(points(user).add_button, Qt.MouseButton.LeftButton)
    assert curve(user) == SplineCurve((SplinePoint(20.75, -75.0),))
    assert user.session.study.motion.y[0] == pytest.approx(before, abs=1e-12)  # it lies on the curve
    points(user).table.setFocus()
    user.press(Qt.Key.Key_Insert)  # the cam stands on the point: the longest stretch is halved
    added = curve(user)
    assert isinstance(added, SplineCurve)
    assert [p.at_deg for p in added.points] == [10.375, 20.75]
    assert user.steps[1:] == ["Add point to segment 2"] * 2
    points(user).table.setCurrentIndex(points(user).model.index(0, 1))
    user.press(Qt.Key.Key_Delete)
    assert curve(user) == SplineCurve((SplinePoint(20.75, -75.0),))
    QTest.mouseClick(points(user).remove_button, Qt.MouseButton.LeftButton)
    assert curve(user) == SplineCurve()
    assert not points(user).remove_button.isEnabled()


def test_points_are_typed(user: User) -> None:
    user.session.edit("motion.segments[1].law", "spline", "x")
    points(user).add()
    enter_point(user, 0, 0, "15")
    enter_point(user, 0, 1, "-40")
    enter_point(user, 0, 2, "-5")
    assert curve(user) == SplineCurve((SplinePoint(15.0, -40.0, -5.0),))
    assert user.steps[-3:] == [
        "Change segment 2, point 1 angle to 15°",
        "Change segment 2, point 1 value to \u221240 mm",
        "Change segment 2, point 1 velocity to \u22125 mm/°",
    ]
    study = user.session.study
    there = study.program.state(study.program.angles(np.deg2rad(np.array([50.0])))).y[:, 0]
    assert there[0] == pytest.approx(0.110, abs=1e-9)
    assert there[1] == pytest.approx(-0.005 * 180.0 / math.pi, abs=1e-9)
    enter_point(user, 0, 1, "")
    assert curve(user) == SplineCurve((SplinePoint(15.0, None, -5.0),))
    assert user.steps[-1] == "Leave segment 2, point 1 value open"


@pytest.mark.stress
def test_a_point_that_cannot_be_is_told(user: User) -> None:
    user.session.edit("motion.segments[1].law", "spline", "x")
    points(user).add()
    good = curve(user)
    enter_point(user, 0, 0, "50")
    assert curve(user) == good
    assert "point 1 angle: beyond its segment; allowed: 0 ... 41.5°" in user.motion().incomplete_bar.trouble.text()
    assert points(user).model.is_faulty(0, 0)
    enter_point(user, 0, 1, "")  # a point that says nothing
    assert (
        user.motion().incomplete_bar.trouble.text().endswith("has no value; allowed: value, velocity or acceleration")
    )
    enter_point(user, 0, 1, "-60")
    assert curve(user) == good
    enter_point(user, 0, 0, "30")
    assert curve(user) == SplineCurve((SplinePoint(30.0, -60.0),))
    assert not user.motion().incomplete_bar.isVisible()


def test_points_on_top_of_one_another_wait(same_window: Open) -> None:
    """There is no curve through them; with the motion in sight that is told, and the last curve stays."""
    user = same_window()
    user.session.edit("motion.segments[1].law", "spline", "x")
    user.window.player.step(55.0)
    points(user).add()
    points(user).add()
    good = curve(user)
    enter_point(user, 0, 0, "30.75000000001")
    assert curve(user) == good
    assert "Motion: two points of the spline are less than" in user.motion().incomplete_bar.trouble.text()


def test_every_parameter_has_a_name(user: User) -> None:
    """Names for sentences: what is refused, and what was done."""
    for slug, path, name in (
        ("polynomial", "motion.segments[1].start.velocity", "Segment 2, start velocity"),
        ("polynomial", "motion.segments[1].end.jerk", "Segment 2, end jerk"),
        ("scca", "motion.segments[1].cv_fraction", "Segment 2, constant velocity"),
        ("spline", "motion.segments[1].points[2].at_deg", "Segment 2, point 3 angle"),
        ("spline", "motion.segments[1].points[0]", "Segment 2, point 1"),
    ):
        assert name_of(edited(LIFT, "motion.segments[1].law", slug), path) == name
    assert [law_label(slug) for slug in CURVES] == ["SCCA", "Polynomial", "Spline", "Table", "Optimal"]
