"""kindyna_gui.motion.laws_view, laws_model, laws_plot: every law with what it costs, drawn over each other, and used."""

from io import BytesIO
from itertools import pairwise

import numpy as np
import pytest
from mechanisms import LIFT
from PIL import Image
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QColor
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu, QStyle, QStyleOptionViewItem
from window_user import Alone, Open, User, settle

from core.laws import LAWS, peaks
from kindyna_gui.documents.session import Session
from kindyna_gui.motion.laws_plot import QUANTITIES, line_style
from kindyna_gui.motion.laws_view import (
    ACCELERATION,
    COLUMNS,
    EMPTY,
    ENDS,
    JERK,
    NAME,
    TORQUE,
    VELOCITY,
    LawsView,
    law_rows,
    segment_texts,
)
from kindyna_gui.player import Player
from kindyna_gui.window.docks import VIEWS

FIRST = ["cycloidal", "modified-sine", "modified-trapezoid", "3-4-5"]
"""The laws that are compared at first."""


@pytest.fixture
def laws(alone: Alone) -> LawsView:
    return alone(LawsView(Session(LIFT), Player()), 1000, 640)


def text(view: LawsView, slug: str, column: int) -> str:
    return str(view.model.data(view.model.index(view.model.row_of(slug), column)))


def order(view: LawsView) -> list[str]:
    return [row.slug for row in view.model.rows]


def place(view: LawsView, slug: str, column: int = NAME) -> QPoint:
    index = view.model.index(view.model.row_of(slug), column)
    view.table.scrollTo(index)
    return view.table.visualRect(index).center()


def box_of(view: LawsView, slug: str) -> QPoint:
    """Where the box to tick stands."""
    index = view.model.index(view.model.row_of(slug), NAME)
    view.table.scrollTo(index)
    option = QStyleOptionViewItem()
    option.initFrom(view.table)
    option.rect = view.table.visualRect(index)
    option.features = QStyleOptionViewItem.ViewItemFeature.HasCheckIndicator
    box = view.table.style().subElementRect(QStyle.SubElement.SE_ItemViewItemCheckIndicator, option, view.table)
    return box.center()


def click(view: LawsView, where: QPoint) -> None:
    QTest.mouseClick(view.table.viewport(), Qt.MouseButton.LeftButton, pos=where)
    settle()


def drawn(view: LawsView) -> list[str]:
    return [law.slug for law, _ in view.model.drawn]


# -- the table --------------------------------------------------------------------------------------------


def test_every_law_stands_there_with_its_peaks(laws: LawsView) -> None:
    assert order(laws) == list(LAWS)
    assert text(laws, "modified-sine", VELOCITY) == "1.760"
    assert text(laws, "modified-sine", ACCELERATION) == "5.528"
    assert text(laws, "modified-sine", JERK) == "69.47"
    assert text(laws, "modified-sine", TORQUE) == "5.458"
    assert text(laws, "parabolic", JERK) == "∞"
    for row in law_rows():
        found = peaks(row.law)
        assert row.numbers == (found.cv, found.ca, found.cj, found.cm)
    tip = laws.model.data(laws.model.index(laws.model.row_of("modified-sine"), JERK), Qt.ItemDataRole.ToolTipRole)
    assert float(tip.splitlines()[0]) == pytest.approx(16.0 * np.pi**3 / (4.0 + np.pi), rel=1e-9)


def test_what_jumps_at_the_ends_is_marked(laws: LawsView) -> None:
    ends = {slug: text(laws, slug, ENDS) for slug in LAWS}
    assert ends["cycloidal"] == ends["dwell"] == ends["3-4-5"] == ""
    assert ends["simple-harmonic"] == ends["parabolic"] == ends["2-3"] == "a | a"
    assert ends["p1"] == ends["double-harmonic"] == "– | a"
    assert ends["constant-velocity"] == "v | v"
    assert ends["c1"] == "– | v"
    assert ends["h2"] == "v | a"
    for slug, told in ends.items():
        assert ("a" in told) == peaks(LAWS[slug]).jumps_at_an_end
    index = laws.model.index(laws.model.row_of("h1"), ENDS)
    tip = laws.model.data(index, Qt.ItemDataRole.ToolTipRole)
    assert tip == "Acceleration does not start at 0; velocity does not end at 0"


def test_a_click_on_a_heading_sorts(laws: LawsView) -> None:
    head = laws.table.horizontalHeader()
    laws.table.choose("gutman-1-3")
    middle = QPoint(head.sectionViewportPosition(JERK) + head.sectionSize(JERK) // 2, head.height() // 2)
    QTest.mouseClick(head.viewport(), Qt.MouseButton.LeftButton, pos=middle)
    sizes = [peaks(LAWS[slug]).cj for slug in order(laws)]
    assert sizes == sorted(sizes)
    assert order(laws)[-1] == "parabolic", "what is infinite comes last"
    assert laws.table.slug == "gutman-1-3", "the chosen law stays chosen"
    assert order(laws)[:2] == ["dwell", "constant-velocity"], "laws alike in it stay in their order"
    QTest.mouseClick(head.viewport(), Qt.MouseButton.LeftButton, pos=middle)
    assert order(laws)[0] == "parabolic"
    QTest.mouseClick(head.viewport(), Qt.MouseButton.LeftButton, pos=middle)
    assert order(laws) == list(LAWS)
    laws.model.sort(NAME, Qt.SortOrder.AscendingOrder)
    labels = [row.law.label.casefold() for row in laws.model.rows]
    assert labels == sorted(labels)


def test_the_law_of_the_chosen_segment_is_marked(laws: LawsView) -> None:
    assert text(laws, "dwell", NAME) == "Dwell  ◂ segment 1"
    laws.session.choose_segment(3)
    settle()
    assert text(laws, "dwell", NAME) == "Dwell"
    assert text(laws, "modified-sine", NAME) == "Modified sine  ◂ segment 4"
    assert laws.table.slug == "modified-sine"
    laws.session.edit("motion.segments[3].law", "cycloidal", "a")
    settle()
    assert text(laws, "cycloidal", NAME) == "Cycloidal  ◂ segment 4"
    laws.session.edit("motion.segments[3].law", "polynomial", "a")
    settle()
    assert not any("◂" in text(laws, slug, NAME) for slug in LAWS), "which is no law of the table"


def test_the_table_can_be_copied(laws: LawsView) -> None:
    laws.table.setFocus()
    QTest.keyClick(laws.table, Qt.Key.Key_C, Qt.KeyboardModifier.ControlModifier)
    lines = QApplication.clipboard().text().splitlines()
    assert lines[0].split("\t") == [column.title for column in COLUMNS]
    assert len(lines) == len(LAWS) + 1
    assert lines[1 + list(LAWS).index("cycloidal")].split("\t")[:3] == ["Cycloidal", "2", "6.28318531"]


# -- ticking and drawing ----------------------------------------------------------------------------------


def test_laws_are_ticked_with_the_mouse(laws: LawsView) -> None:
    assert drawn(laws) == FIRST
    click(laws, box_of(laws, "simple-harmonic"))
    assert drawn(laws) == [*FIRST, "simple-harmonic"]
    click(laws, box_of(laws, "modified-sine"))
    assert drawn(laws) == ["cycloidal", "modified-trapezoid", "3-4-5", "simple-harmonic"]
    assert all(len(plot.lines) == len(drawn(laws)) for plot in laws.plots)
    assert [law.slug for law, _ in laws.legend.laws] == drawn(laws)


def test_laws_are_ticked_with_the_keys(laws: LawsView) -> None:
    laws.table.choose("gutman-1-3")
    laws.table.setFocus()
    QTest.keyClick(laws.table, Qt.Key.Key_Space)
    assert drawn(laws)[-1] == "gutman-1-3"
    QTest.keyClick(laws.table, Qt.Key.Key_Space)
    assert "gutman-1-3" not in drawn(laws)


def test_a_curve_is_the_law(laws: LawsView) -> None:
    for k, plot in enumerate(laws.plots):
        u, values = plot.lines[FIRST.index("3-4-5")]
        assert (u[0], u[-1]) == (0.0, plot.frame().last)
        assert values == pytest.approx(LAWS["3-4-5"](u / u[-1])[k], abs=1e-12)
        low, high = plot.frame().low, plot.frame().high
        assert low <= values.min()
        assert values.max() <= high


def test_a_jump_inside_a_law_is_upright(laws: LawsView) -> None:
    laws.model.tick("parabolic", True)
    u, values = laws.plots[2].lines[drawn(laws).index("parabolic")]
    middle = np.flatnonzero(np.abs(u - u[-1] / 2.0) < 1e-9)
    assert values[middle].tolist() == [4.0, -4.0]


def test_strokes_can_be_told_apart_without_colour() -> None:
    strokes = [line_style(i) for i in range(3 * len(LAWS))]
    assert len(set(strokes)) == len(strokes)
    for one, other in pairwise(strokes):
        assert one.colour != other.colour
        assert one.dash != other.dash
    assert len({stroke.dash for stroke in strokes[:5]}) == 5
    # of Okabe and Ito, which colour-blind readers keep apart, without the yellow that paper swallows
    assert {QColor(stroke.colour).name().upper() for stroke in strokes} == {
        "#0072B2",
        "#D55E00",
        "#009E73",
        "#000000",
        "#CC79A7",
        "#E69F00",
        "#56B4E9",
    }


def test_a_stroke_stays_with_its_law_and_is_free_after_it(laws: LawsView) -> None:
    before = dict(laws.model.drawn)
    laws.model.tick("cycloidal", False)
    laws.model.tick("gutman-1-3", True)
    after = {law.slug: stroke for law, stroke in laws.model.drawn}
    assert after["gutman-1-3"] == before[LAWS["cycloidal"]]
    assert all(after[slug] == before[LAWS[slug]] for slug in FIRST[1:])


@pytest.mark.stress
def test_all_laws_can_be_drawn_at_once_and_none(laws: LawsView) -> None:
    for slug in LAWS:
        laws.model.tick(slug, True)
    assert len({stroke for _, stroke in laws.model.drawn}) == len(LAWS)
    settle()
    assert laws.legend.height() > 3 * laws.legend.LINE, "in as many lines as it takes"
    QTest.mouseClick(laws.clear_button, Qt.MouseButton.LeftButton)
    assert drawn(laws) == []
    assert laws.empty.isVisible()
    assert laws.empty.text() == EMPTY


def left_above(laws: LawsView) -> tuple[int, int]:
    """What is left of, and above, the plots within the page."""
    corner = laws.plots[0].mapTo(laws, QPoint(0, 0)) - laws.table.mapTo(laws, QPoint(0, 0))
    return corner.x(), corner.y()


def test_table_and_plots_share_the_page(laws: LawsView) -> None:
    assert left_above(laws)[0] >= laws.table.width(), "beside the table"
    laws.resize(600, 640)
    settle()
    assert left_above(laws)[1] >= laws.table.height(), "below the table"
    places = [(plot.x() > 100, plot.y() > laws.plots[0].y() + 20) for plot in laws.plots]
    assert places == [(False, False), (True, False), (False, True), (True, True)], "two by two"
    assert all(plot.height() > 60 for plot in laws.plots)
    assert laws.table.columnWidth(NAME) > 150


def test_curves_and_three_laws_can_be_read_at_the_least_size(laws: LawsView) -> None:
    least = VIEWS["laws"].least
    laws.resize(*least)
    settle()
    assert laws.minimumSizeHint().height() <= least[1]
    boxes = [plot.getViewBox() for plot in laws.plots]
    assert all(box.width() >= 160 and box.height() >= 80 for box in boxes)
    assert 3 * laws.table.rowHeight(0) <= laws.table.viewport().height()


@pytest.mark.stress
def test_the_picture_shows_the_curves_and_their_names(laws: LawsView) -> None:
    picture = np.asarray(Image.open(BytesIO(laws.picture(".png"))).convert("RGB")).reshape(-1, 3).astype(int)
    for _, stroke in laws.model.drawn:
        colour = QColor(stroke.colour)
        near = np.abs(picture - (colour.red(), colour.green(), colour.blue())).max(axis=1) < 40
        assert near.sum() > 100
    svg = laws.picture(".svg").decode()
    for name in (*(quantity[0] for quantity in QUANTITIES), "Modified trapezoid"):
        assert name in svg
    assert "<image" not in svg


# -- using ------------------------------------------------------------------------------------------------


def test_a_law_goes_into_the_chosen_segment_in_one_step(laws: LawsView) -> None:
    laws.session.choose_segment(1)
    settle()
    click(laws, place(laws, "cycloidal"))
    assert laws.use_button.text() == "Use in segment 2"
    QTest.mouseClick(laws.use_button, Qt.MouseButton.LeftButton, pos=QPoint(10, 10))
    stack = laws.session.stack
    assert [stack.text(i) for i in range(stack.count())] == ["Change law of segment 2 to Cycloidal"]
    assert laws.session.design.drive.motion.segments[1].curve.law == "cycloidal"
    stack.undo()
    assert laws.session.design == LIFT


def test_enter_uses_the_law(laws: LawsView) -> None:
    laws.session.choose_segment(1)
    laws.table.choose("3-4-5")
    laws.table.setFocus()
    QTest.keyClick(laws.table, Qt.Key.Key_Return)
    assert laws.session.design.drive.motion.segments[1].curve.law == "3-4-5"


def test_the_arrow_offers_every_segment(laws: LawsView) -> None:
    laws.table.choose("mcv33")
    menu = laws.use_button.menu()
    assert isinstance(menu, QMenu)
    menu.aboutToShow.emit()
    texts = [action.text() for action in menu.actions()]
    assert texts == segment_texts(LIFT.drive.motion)
    assert texts[1] == "2  Modified sine, 35° … 76.5°, \u2212150 mm"
    assert [action.isChecked() for action in menu.actions()] == [True, False, False, False, False]
    menu.actions()[3].trigger()
    assert laws.session.design.drive.motion.segments[3].curve.law == "mcv33"


def test_a_law_that_does_not_fit_is_refused_with_the_reason(laws: LawsView) -> None:
    laws.session.choose_segment(3)
    laws.table.choose("c3")
    laws.use()
    assert laws.session.design == LIFT
    assert laws.note.text().startswith("Not in segment 4: ")
    assert "c3 is a return" in laws.note.text()
    laws.table.choose("c1")
    laws.use()
    assert laws.note.text() == ""
    assert laws.session.design.drive.motion.segments[3].curve.law == "c1"


# -- in the window ----------------------------------------------------------------------------------------


def test_the_law_table_is_a_page_and_follows_the_motion_table(open_user: Open) -> None:
    user: User = open_user()
    user.choose("Make", "Law table")
    view = user.window.view("laws")
    assert isinstance(view, LawsView)
    assert view.on_screen()
    user.motion().choose(3, 0)
    settle()
    assert text(view, "modified-sine", NAME) == "Modified sine  ◂ segment 4"
    view.table.choose("cycloidal")
    QTest.mouseClick(view.use_button, Qt.MouseButton.LeftButton, pos=QPoint(10, 10))
    settle()
    assert user.cell(3, 0) == "Cycloidal"
    assert user.steps == ["Change law of segment 4 to Cycloidal"]
    view.table.choose("c3")
    view.use()
    settle()
    assert user.cell(3, 0) == "Cycloidal", "no cell holds what was refused elsewhere"
