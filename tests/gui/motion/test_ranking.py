"""Make > Law table and Make > Blend: what each law and blend costs in this design, computed while it is seen, sorted by a click."""

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QWidget
from window_user import Open, User, settle, wait_for

from core.design import edited
from core.find import blend_candidates, law_candidates, moving_segments, ranking_columns, ranking_row
from core.laws import LAWS
from core.project import load
from core.study.stages import evaluations
from kindyna_gui.blend.wizard import REPLACEMENTS, BlendDialog
from kindyna_gui.labels import law_label
from kindyna_gui.look import linked
from kindyna_gui.motion.laws_plot import RankingPanel
from kindyna_gui.motion.laws_view import LawsView
from kindyna_gui.pictures.units import digits
from kindyna_gui.places import example
from kindyna_gui.requirements import NO_RANKING


@pytest.fixture
def open_user(same_window: Open) -> Open:
    return same_window


def names(panel: RankingPanel) -> list[str]:
    assert panel.table is not None
    return [row.cells[0] for row in panel.table.rows.rows]


def column(panel: RankingPanel, number: int) -> list[str]:
    assert panel.table is not None
    return [row.cells[number] for row in panel.table.rows.rows]


def numbers(panel: RankingPanel, number: int) -> list[float]:
    """A column's figures, without those who have none."""
    return [float(text) for text in column(panel, number) if text[:1].isdigit()]


def click(part: QWidget) -> None:
    QTest.mouseClick(part, Qt.MouseButton.LeftButton, pos=QPoint(10, part.height() // 2))
    settle()


def rested(panel: RankingPanel) -> None:
    wait_for(lambda: not panel.busy and bool(panel.rows))


def click_heading(panel: RankingPanel, number: int) -> None:
    assert panel.table is not None
    head = panel.table.horizontalHeader()
    middle = QPoint(head.sectionViewportPosition(number) + head.sectionSize(number) // 2, head.height() // 2)
    QTest.mouseClick(head.viewport(), Qt.MouseButton.LeftButton, pos=middle)
    settle()


def pick(panel: RankingPanel, name: str) -> None:
    """Click on a row."""
    assert panel.table is not None
    label = law_label(name) if name in LAWS else name
    row = next(i for i, text in enumerate(names(panel)) if text.partition("  ◂")[0] == label)
    panel.table.scrollTo(panel.table.rows.index(row, 0))
    at = panel.table.visualRect(panel.table.rows.index(row, 0)).center()
    QTest.mouseClick(panel.table.viewport(), Qt.MouseButton.LeftButton, pos=at)
    settle()


def see(user: User) -> LawsView:
    user.choose("Make", "Law table")
    view = user.window.view("laws")
    assert isinstance(view, LawsView)
    return view


@pytest.mark.stress
def test_laws_are_ranked_in_the_design_while_it_is_asked_for(open_user: Open) -> None:
    user = open_user(example("rocker_cam"))
    user.session.put(edited(user.design, "loads.follower_stiffness_n_per_mm", 60.0), "Stiffness")
    view = see(user)
    panel = view.ranking
    user.session.choose_segment(1)
    settle()
    before = evaluations["ranking"]
    assert not panel.busy, "nobody asked"
    click(view.rank_button)
    rested(panel)
    candidates = law_candidates(user.design, (1,))
    assert evaluations["ranking"] - before == len(candidates) == len(names(panel))
    figures = ranking_columns(user.design)
    assert [figure.key for figure in panel.figures] == ["peak_torque_nm", "residual_mm", "least_contact_force_n"]
    for slug, label in (("modified-sine", "Modified sine  ◂ now"), ("5-6-7-8-9", "Polynomial 5-6-7-8-9")):
        wanted = ranking_row(slug, candidates[slug], figures).figures
        at = names(panel).index(label)
        assert [column(panel, i)[at] for i in (1, 2, 3)] == [digits(value, 4) for value in wanted if value is not None]
    torques = numbers(panel, 1)
    assert len(torques) > 15
    assert torques == sorted(torques)
    assert column(panel, 1)[-1] == "Cv2 is a return", "why the design does not take it, in place of figures"
    click_heading(panel, 2)
    residuals = numbers(panel, 2)
    assert residuals == sorted(residuals)
    click_heading(panel, 2)
    assert numbers(panel, 2) == residuals[::-1]

    assert panel.table is not None
    first = names(panel)[0]
    QTest.mouseClick(
        panel.table.viewport(),
        Qt.MouseButton.LeftButton,
        pos=panel.table.visualRect(panel.table.rows.index(0, 0)).center(),
    )
    click(view.use_button)
    assert user.steps[-1] == f"Change law of segment 2 to {first}"
    rested(panel)
    assert f"{first}  ◂ now" in names(panel)

    click(view.all_button)
    rested(panel)
    candidates = law_candidates(user.design, moving_segments(user.design))
    wanted = ranking_row("cycloidal", candidates["cycloidal"], figures).figures
    assert column(panel, 2)[names(panel).index("Cycloidal")] == digits(wanted[1] or 0.0, 4)

    click(view.rank_button)
    made = evaluations["ranking"]
    user.session.put(edited(user.design, "shaft.speed_rpm", 350.0), "Speed")
    settle()
    assert (evaluations["ranking"], panel.busy) == (made, False), "not while the plots are shown"


def test_the_ranking_is_cancelled_and_goes_on(open_user: Open) -> None:
    user = open_user(example("kim_1990"))
    view = see(user)
    panel = view.ranking
    click(view.rank_button)
    wait_for(panel.cancel.isVisible)
    assert panel.bar.maximum() == len(law_candidates(user.design, moving_segments(user.design)))
    click(panel.cancel)
    wait_for(lambda: not panel.busy)
    assert len(panel.rows) < panel.bar.maximum()
    assert panel.resume.isVisible()
    missing = panel.bar.maximum() - len(panel.rows)
    before = evaluations["ranking"]
    click(panel.resume)
    wait_for(lambda: evaluations["ranking"] > before)
    click(panel.cancel)
    wait_for(lambda: not panel.busy)
    assert evaluations["ranking"] - before <= missing, "none twice"
    user.session.put(load(example("four_bar")), "Take the four-bar")
    settle()
    assert (panel.text.text(), panel.busy) == (linked(NO_RANKING), False)


def test_blends_are_ranked_in_the_wizard(open_user: Open) -> None:
    user = open_user(example("rocker_cam"))
    user.choose("Make", "Blend...")
    dialog = user.window.findChild(BlendDialog)
    assert isinstance(dialog, BlendDialog)
    wait_for(lambda: not dialog.is_solving)
    before = evaluations["ranking"]
    assert not dialog.ranking.rows
    dialog.pages.setCurrentWidget(dialog.ranking)
    rested(dialog.ranking)
    assert dialog.blended is not None
    own = "-".join(dialog.blended.curves)
    assert evaluations["ranking"] > before
    where = next(name for name, button in dialog.replaced.items() if button.isChecked())
    candidates = blend_candidates(dialog.blended, lambda other: REPLACEMENTS[where](user.design, other))
    figures = ranking_columns(user.design)
    wanted = ranking_row(own, candidates[own], figures).figures
    at = names(dialog.ranking).index(f"{own}  ◂ this blend")
    assert [column(dialog.ranking, i + 1)[at] for i in range(len(wanted))] == [
        digits(value or 0.0, 4) for value in wanted
    ]
    pick(dialog.ranking, "C1-C2")
    wait_for(lambda: not dialog.is_solving)
    assert dialog.questions.chosen_sequence[0] == "C1-C2"
    assert dialog.blended is None, "it takes a setting more, as the questions say"
    pick(dialog.ranking, own)
    wait_for(lambda: dialog.blended is not None and "-".join(dialog.blended.curves) == own)
    rested(dialog.ranking)
    pick(dialog.ranking, "cycloidal")
    assert "is a motion law" in dialog.message.text()
    assert dialog.questions.chosen_sequence[0] == own
    dialog.reject()
