"""Welcome and the table of examples: what it offers, when it is shown, and what a click opens."""

import shutil
from pathlib import Path

import pytest
from PySide6.QtCore import QSize, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QPushButton
from window_user import Open, User, settle, wait_for

from core.design import get
from core.papers import PAPERS
from core.process import resources
from core.project import load, recovery
from core.project.reading_faults import subjects
from kindyna_gui.files.recovery import recovery_folder
from kindyna_gui.places import example, lessons
from kindyna_gui.window.tutorial import TutorialStrip
from kindyna_gui.window.welcome import Card, Welcome

ROWS = [row for _, rows in subjects() for row in rows]


def card(page: Welcome, file: str) -> Card:
    found = page.findChild(Card, f"example:{file}")
    assert isinstance(found, Card)
    return found


def click(button: QPushButton) -> None:
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    settle()


@pytest.fixture
def page(same_window: Open) -> Welcome:
    user = same_window()
    user.choose("Help", "Welcome")
    made = user.window.welcome
    assert made is not None
    return made


def test_every_example_is_in_the_table_once_with_a_paper_that_there_is() -> None:
    files = [row.file for row in ROWS]
    assert sorted(files) == sorted(path.stem for path in (resources() / "examples").glob("*.toml"))
    assert len({row.name for row in ROWS}) == len(files)
    assert {row.paper for row in ROWS} == {*PAPERS, ""}
    of_papers = {row.file: row.paper for row in ROWS if row.paper}
    for paper in PAPERS.values():
        assert {of_papers[row.example] for row in paper.rows} == {paper.slug}


def test_the_sentences_of_the_lecture_say_why_its_coupler_is_what_it_is_and_how_the_axle_steers() -> None:
    told = {row.file: row.text for row in ROWS}
    mm = float(get(load(example("lecture_six_bar")), "linkage.links[2].points.B")[0])
    assert f"{mm / 10.0:.6f} cm" in told["lecture_six_bar"]
    assert "steers" in told["rear_suspension"]


def test_the_menu_offers_the_examples_by_subject_with_their_papers(same_window: Open) -> None:
    user = same_window()
    assert user.entries("File", "Examples") == [row.name for row in ROWS]
    actions = user.action("File", "Examples").menu().actions()  # type: ignore[union-attr]
    assert [each.text() for each in actions if each.isSeparator()] == [title for title, _ in subjects()]
    assert user.action("File", "Examples", "Lecture six bar").text().endswith(f"\t{PAPERS['velocity'].label}")


def test_every_example_has_a_picture_of_its_own(page: Welcome) -> None:
    wait_for(lambda: all(not each.picture.pixmap().isNull() for each in page.cards))
    images = {each.example.file: bytes(each.picture.pixmap().toImage().constBits()) for each in page.cards}
    assert len(set(images.values())) == len(images)
    assert [file for file, pixels in images.items() if len(set(pixels)) < 3] == [], "pictures with nothing in them"


def test_a_click_opens_an_example_and_the_page_is_out_of_the_way(same_window: Open) -> None:
    user = same_window()
    user.choose("Help", "Welcome")
    page = user.window.welcome
    assert page is not None
    click(card(page, "rear_suspension"))
    assert user.design == load(example("rear_suspension"))
    assert not page.isVisible()


def test_files_opened_lately_are_a_click_away(same_window: Open, tmp_path: Path) -> None:
    mine = tmp_path / "a & b.toml"
    shutil.copy(example("card_picker"), mine)
    user = same_window(mine)
    user.window.documents.open_path(mine)
    user.window.documents.open_example(example("card_picker"))
    user.choose("Help", "Welcome")
    page = user.window.welcome
    assert page is not None
    click(next(each for each in page.recent.findChildren(QPushButton) if each.toolTip() == str(mine)))
    assert user.session.path == mine
    assert not page.isVisible()


@pytest.mark.parametrize(("room", "columns"), [((1280, 720), 2), ((1920, 1080), 3)])
def test_cards_fill_the_page_and_none_is_cut(same_window: Open, room: tuple[int, int], columns: int) -> None:
    user = same_window()
    page = Welcome(user.window, QSize(*room))
    page.show()
    settle()
    shown = page.cards[:columns]
    assert len({each.y() for each in shown}) == 1
    assert page.cards[columns].y() > shown[0].y()
    right = shown[-1].mapTo(page, shown[-1].rect().bottomRight()).x()
    assert right < page.width() <= room[0]
    assert page.height() <= room[1]
    page.close()
    page.deleteLater()


# -- at the start -----------------------------------------------------------------------------------------


def greeted(user: User) -> bool:
    """Whether the page is shown by a start."""
    user.window.greet()
    settle()
    return user.window.welcome is not None and user.window.welcome.isVisible()


def test_a_start_without_a_file_shows_it_until_the_box_says_no(open_user: Open) -> None:
    first = open_user()
    assert greeted(first)
    assert first.window.welcome is not None
    first.window.welcome.at_start.click()
    assert not greeted(open_user())


def test_it_is_not_in_the_way_of_a_file_that_was_named(open_user: Open, tmp_path: Path) -> None:
    mine = tmp_path / "mine.toml"
    shutil.copy(example("card_picker"), mine)
    assert not greeted(open_user(mine))


def test_it_is_not_in_the_way_of_unsaved_work(open_user: Open, monkeypatch: pytest.MonkeyPatch) -> None:
    user = open_user()
    monkeypatch.setattr(user.window.recovery, "offer", lambda: True)
    assert not greeted(user)
    assert recovery.find(recovery_folder()) == []


def test_after_it_is_closed_the_drawing_has_the_keys(open_user: Open) -> None:
    user = open_user()
    assert greeted(user)
    page = user.window.welcome
    assert page is not None
    QTest.keyClick(page, Qt.Key.Key_Escape)
    assert QTest.qWaitForWindowActive(user.window)
    assert not page.isVisible()
    user.press(Qt.Key.Key_Space)
    assert user.window.player.playing


def test_it_offers_every_tutorial(open_user: Open) -> None:
    user = open_user()
    assert greeted(user)
    page = user.window.welcome
    assert page is not None
    buttons = [each for each in page.findChildren(QPushButton) if each.text().startswith("Tutorial")]
    assert [each.toolTip() for each in buttons] == [title for _, title in lessons()]
    assert all(each.sizeHint().width() <= each.width() for each in buttons)
    click(buttons[0])
    assert user.window.findChild(TutorialStrip) is not None
    assert not page.isVisible()


@pytest.mark.parametrize("entry", ["Tour", "Figures of the papers..."])
def test_escape_closes_windows_that_ask_nothing(open_user: Open, entry: str) -> None:
    user = open_user()
    before = set(QApplication.topLevelWidgets())
    user.choose("Help", entry)
    (shown,) = (each for each in QApplication.topLevelWidgets() if each not in before and each.isVisible())
    QTest.keyClick(QApplication.focusWidget() or shown, Qt.Key.Key_Escape)
    settle()
    assert not shown.isVisible()
