"""Why something cannot be is read whole, however long it is and however little room there is: in the status line, in a view, in a
table."""

import pytest
from PySide6.QtCore import QRect, Qt
from PySide6.QtWidgets import QLabel, QScrollArea, QTableView, QWidget
from sampled import spread
from window_user import Open, User, settle, wait_for

from core.design import edited
from core.project import load
from kindyna_gui.places import example


def room_for(label: QLabel) -> bool:
    """Whether all its lines can be seen."""
    return label.visibleRegion().boundingRect().height() >= label.heightForWidth(label.width())


def seen(place: QWidget, text: str) -> QLabel:
    """The label that shows a text."""
    found = [each for each in place.findChildren(QLabel) if each.text() == text and each.isVisible()]
    assert found, f"{text}: is not shown"
    return found[0]


def test_a_refusal_longer_than_the_status_line_grows_over_what_stands_there(open_user: Open) -> None:
    user: User = open_user(size=(800, 720), whole=True)
    before = user.window.status.height()
    user.enter("cam.roller_radius_mm", "1e12")
    refusal = user.window.status.currentMessage()
    assert refusal.startswith("Refused: Roller radius Rr")
    assert user.window.status.fontMetrics().horizontalAdvance(refusal) > user.window.status.findings.x(), (
        "it needs more than a line"
    )
    label = seen(user.window, refusal)
    assert room_for(label)
    assert user.window.status.height() == before, "nothing is moved by it"
    assert label.geometry().bottom() == user.window.status.geometry().bottom()
    assert label.geometry().right() < user.window.status.findings.x()
    user.enter("cam.roller_radius_mm", "75")
    assert not label.isVisible()


@pytest.mark.stress
@pytest.mark.parametrize("name", spread(["mechanism", "displacement", "findings"], 1))
def test_a_reason_is_rolled_where_a_view_has_no_room(name: str, open_user: Open) -> None:
    user: User = open_user(example("lecture_six_bar"), size=(800, 560), whole=True)
    user.session.start(edited(load(example("lecture_six_bar")), "linkage.links[1].points.A.x_mm", 200.0))
    view = user.window.show_view(name)
    view.setFixedSize(120, 60)
    settle()
    wait_for(lambda: view.in_trouble)
    text = (
        "Links: its links cannot be assembled at any position of the driver, or at single ones only; change their lengths, "
        "or assembly mode"
    )
    label = seen(view, text)
    assert label.height() >= label.heightForWidth(label.width())
    area = label.parentWidget()
    while not isinstance(area, QScrollArea):
        area = area.parentWidget()
    assert area.verticalScrollBar().maximum() >= label.height() - view.height()
    bar = seen(user.window.bar, "Cannot play: the drawing shows why.")
    assert room_for(bar), "of one line"


def test_a_linkage_that_is_not_complete_says_so_where_it_would_play(open_user: Open) -> None:
    user: User = open_user(size=(1280, 720))
    user.choose("File", "New by type", "Linkage by drawing")
    text = "Cannot play: the linkage is not complete; the drawing shows what is missing."
    assert room_for(seen(user.window.bar, text)), "of one line"


@pytest.mark.stress
def test_a_law_that_a_design_does_not_take_says_why_in_as_many_lines_as_it_needs(open_user: Open) -> None:
    user: User = open_user(example("card_picker"), size=(1280, 720), whole=True)
    user.choose("Make", "Law table")
    view = user.window.view("laws")
    view.rank_button.click()  # type: ignore[union-attr]
    panel = view.ranking  # type: ignore[union-attr]
    wait_for(lambda: not panel.busy and bool(panel.rows))
    panel.window().resize(700, 560)
    settle()
    table: QTableView = panel.table
    reasons = [(number, row.cells[1]) for number, row in enumerate(table.rows.rows) if row.across == 1]  # type: ignore[attr-defined]
    assert any("infinite acceleration" in text for _, text in reasons)
    for number, text in reasons:
        cell = table.visualRect(table.model().index(number, 1))
        assert cell.width() == sum(table.columnWidth(column) for column in range(1, table.model().columnCount()))
        needed = table.fontMetrics().boundingRect(QRect(0, 0, cell.width() - 8, 0), Qt.TextFlag.TextWordWrap, text)
        assert table.rowHeight(number) >= needed.height()
        assert cell.width() >= needed.width()
