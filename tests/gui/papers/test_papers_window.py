"""Help > Figures of the papers: nothing is computed before it is chosen; picture, statement, number and verdict; opening and saving."""

from collections import Counter
from pathlib import Path
from xml.etree import ElementTree

import pytest
from paper_claims import EXAMPLES, at, every_claim
from PySide6.QtCore import Qt
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QTreeWidgetItem
from sampled import spread
from window_user import Open, User, wait_for

from core.output.stability_files import table_text
from core.papers import PAPERS, VERDICTS
from kindyna_gui.papers import CHOOSE, FiguresWindow
from kindyna_gui.pictures.film import paint


@pytest.fixture
def user(same_window: Open) -> User:
    return same_window()


@pytest.fixture
def figures(user: User) -> FiguresWindow:
    return opened(user)


def opened(user: User) -> FiguresWindow:
    user.choose("Help", "Figures of the papers...")
    found = user.window.findChild(FiguresWindow)
    assert isinstance(found, FiguresWindow)
    return found


def items(figures: FiguresWindow) -> dict[str, QTreeWidgetItem]:
    """The rows by paper and place."""
    found = {}
    for i in range(figures.list.topLevelItemCount()):
        top = figures.list.topLevelItem(i)
        assert top is not None
        for j in range(top.childCount()):
            found[f"{top.text(0).splitlines()[0]}: {top.child(j).text(0)}"] = top.child(j)
    return found


def choose(figures: FiguresWindow, start: str) -> None:
    """Click the first row that begins so, and wait for it."""
    item = next(item for name, item in items(figures).items() if name.startswith(start))
    figures.list.scrollToItem(item)
    place = figures.list.visualItemRect(item).center()
    QTest.mouseClick(figures.list.viewport(), Qt.MouseButton.LeftButton, pos=place)
    wait_for(lambda: not figures.busy)


@pytest.mark.stress
def test_the_list_has_every_verdict_and_their_count_before_a_row_is_opened(
    user: User, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kindyna_gui.papers.Examples", lambda: EXAMPLES)  # computed once for these tests
    figures = opened(user)
    assert figures.says.text() == CHOOSE
    assert not figures.open_button.isEnabled()
    found = items(figures)
    assert len(found) == sum(len(paper.rows) for paper in PAPERS.values())
    wait_for(lambda: figures.judged == len(found))
    assert figures.computed == 0
    shown = {name: (item.text(1), item.toolTip(1)) for name, item in found.items()}
    assert shown == {
        f"{PAPERS[claim.paper].label}: {claim.where}   {claim.says}": (claim.verdict, VERDICTS[claim.verdict])
        for claim in every_claim()
    }
    for i, (slug, paper) in enumerate(PAPERS.items()):
        label, counts = figures.list.topLevelItem(i).text(0).splitlines()  # type: ignore[union-attr]
        assert label == paper.label
        verdicts = Counter(claim.verdict for claim in every_claim() if claim.paper == slug)
        assert counts == ", ".join(f"{verdict} {verdicts[verdict]}" for verdict in VERDICTS if verdicts[verdict])


def test_a_row_that_is_chosen_shows_its_picture_its_words_and_its_verdict(figures: FiguresWindow) -> None:
    choose(figures, "Shin, Kim and Ha 1995: (18)")
    assert figures.computed == 1
    claim = at("shin1995", "(18)")
    assert (figures.verdict.text(), figures.says.text(), figures.result.text()) == (
        f"Convention: {VERDICTS['convention']}",
        f"The paper: {claim.says}",
        f"Here: {claim.here}",
    )
    assert not figures.picture.empty
    choose(figures, "Yang and Shon: Table 2")
    assert figures.computed == 2
    assert figures.verdict.text() == f"Agrees: {VERDICTS['agrees']}"
    assert not figures.picture.empty


@pytest.mark.stress
def test_the_design_behind_a_figure_is_opened(user: User, figures: FiguresWindow) -> None:
    choose(figures, "Yang and Shon: Fig. 4")
    QTest.mouseClick(figures.open_button, Qt.MouseButton.LeftButton)
    assert user.design.name == "Card picker"


@pytest.mark.stress
def test_the_star_of_an_assumed_value_says_why(user: User) -> None:
    user.choose("View", "Docks", "Parameters")
    field = user.field("loads.arm_inertia_kg_m2")
    assert field.mark is not None
    assert "prints 1691.509 kg·mm²" in field.mark.toolTip()
    user.session.edit("loads.arm_inertia_kg_m2", 17.0, "a")
    wait_for(lambda: "1691.509" not in user.field("loads.arm_inertia_kg_m2").mark.toolTip())  # type: ignore[union-attr]


def test_a_figure_is_saved_as_picture_or_as_numbers(user: User, figures: FiguresWindow, tmp_path: Path) -> None:
    choose(figures, "Shin, Kim and Ha 1995: Table 3")
    for name, begins in (("a.png", b"\x89PNG"), ("b.svg", b"<?xml"), ("c.csv", b"quantity,printed,here,unit")):
        suggested = user.picks("figure_to_save", tmp_path / name)
        QTest.mouseClick(figures.save_button, Qt.MouseButton.LeftButton)
        assert suggested[-1].name == "shin1995_table_3.png"
        assert (tmp_path / name).read_bytes().startswith(begins)
    assert (tmp_path / "c.csv").read_text("utf-8") == table_text(at("shin1995", "Table 3").table)
    user.picks("figure_to_save", tmp_path / "none" / "d.png")
    QTest.mouseClick(figures.save_button, Qt.MouseButton.LeftButton)
    assert [what for what, _ in user.faults] == ["d.png cannot be written."]


DRAWN = {
    ("shin1995", "Fig. 1"): "(h) right, below, left", ("shin1995", "Fig. 2, §6.4"): "L2 845", ("shin1995", "Fig. 14, §6.1"): "Clamp",
    ("shin1995", "Fig. 18"): "roller centre", ("shin1995", "Table 3"): "651.081", ("velocity", "p. 3"): "V",
    ("velocity", "p. 8, step 3"): "24 is the intersection of the lines 12–14", ("kim1990", "Fig. 8"): "Kim1990 Fig. 8",
}  # fmt: skip
"""A row of each kind of drawing: what its picture says somewhere."""


@pytest.mark.parametrize(("place", "words"), spread(list(DRAWN.items()), 1))
def test_every_kind_of_figure_is_painted_as_png_and_as_svg(place: tuple[str, str], words: str) -> None:
    pictures = {name.rpartition(".")[2]: data for name, data in paint(at(*place).drawing).items()}
    assert set(pictures) == {"png", "svg"}
    image = QImage.fromData(pictures["png"])
    assert (image.width() >= 600, image.height() >= 300) == (True, True)
    text = "".join(ElementTree.fromstring(pictures["svg"]).itertext())
    assert words.replace(" ", "") in "".join(text.split())
