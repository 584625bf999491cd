"""Under ``strangers``: what is one row in one table is found wherever its kind is read, written, drawn and chosen."""

import csv
import json
import re
from pathlib import Path

import pytest
from plot_reading import limits
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from window_user import Open, User, settle, wait_for

from core import project
from core.__main__ import main
from core.design import Design, edited, si
from core.laws import LAWS
from core.output.drawing.turn import spans
from kindyna_gui.find import FindView
from kindyna_gui.graph.curves_view import CurvesView
from kindyna_gui.graph.graph_view import GraphView
from kindyna_gui.help import PAGES
from kindyna_gui.motion.law_picker import LawPicker
from kindyna_gui.motion.laws_view import LawsView
from kindyna_gui.motion.segments_table import LAW
from kindyna_gui.places import example, help_text

LIFT = edited(project.load(example("transfer_lift")), "motion.segments[1].law", "trefoil")


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "lift.toml"
    project.save(LIFT, path)
    return path


def say(capsys: pytest.CaptureFixture[str], *words: object) -> str:
    assert main([str(word) for word in words]) == 0
    return capsys.readouterr().out


def law_of(design: Design, number: int) -> str:
    return design.drive.motion.segments[number].curve.law


# -- a law ------------------------------------------------------------------------------------------------


def test_a_law_is_written_and_read(file: Path) -> None:
    assert 'law = "trefoil"' in file.read_text("utf-8")
    assert project.load(file) == LIFT


def test_a_report_prints_the_formula_of_the_law(file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "Trefoil" in say(capsys, "report", file, "--samples", "36")
    say(capsys, "report", file, "--samples", "36", "--out", tmp_path / "lift.html")
    _, _, law = (tmp_path / "lift.html").read_text("utf-8").partition("Motion law: Trefoil")
    own, _, others = law.partition("Motion law: ")
    assert others.startswith("Modified sine")
    told = re.sub(r"<[^>]*>|\s", "", own)
    assert "s=4u3−3u4" in told
    assert "Stranger2000" in told


def test_commands_know_the_law(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows = json.loads(say(capsys, "laws", "--json"))
    assert next(row for row in rows if row["law"] == "trefoil")["ca"] == 12.0
    ranked = json.loads(say(capsys, "laws", file, "--segment", "2", "--json"))
    assert "trefoil" in json.dumps(ranked)


def test_a_law_is_picked_by_its_picture(same_window: Open) -> None:
    user = same_window()
    view = user.motion()
    view.choose(3, LAW)
    view.table.setFocus()
    user.press(Qt.Key.Key_Return)
    wait_for(lambda: isinstance(QApplication.activePopupWidget(), LawPicker))
    picker = QApplication.activePopupWidget()
    assert isinstance(picker, LawPicker)
    QTest.keyClicks(picker.filter, "harmonic series")
    assert [cell.slug for cell in picker.grid.cells][-1] == "trefoil"
    QTest.mouseClick(picker.grid, Qt.MouseButton.LeftButton, pos=picker.grid.box("trefoil").center())
    wait_for(lambda: law_of(user.design, 3) == "trefoil")
    assert user.cell(3, LAW).strip() == "Trefoil"
    assert spans(user.design.drive.motion)[3].short == "TRE"


@pytest.mark.stress
def test_all_laws_are_drawn_over_each_other(same_window: Open, file: Path) -> None:
    user: User = same_window(file)
    page = user.see("laws")
    assert isinstance(page, LawsView)
    for slug in LAWS:
        page.model.tick(slug, True)
    assert {law.slug for law, _ in page.legend.laws} == {*LAWS}
    assert len(page.plots[2].lines) == len(LAWS)
    assert len({stroke for _, stroke in page.model.drawn}) == len(LAWS)
    assert page.model.data(page.model.index(page.model.row_of("trefoil"), 0)).startswith("Trefoil")


def test_help_lists_the_law() -> None:
    _, complete = PAGES["laws"]
    assert "| Trefoil | TRE | `trefoil` | Stranger 2000: s = 4u³ \u2212 3u⁴ |" in complete(help_text("laws"), None)


# -- a kind of unit ---------------------------------------------------------------------------------------


def test_a_field_in_the_unit_is_typed_shown_written_and_read(same_window: Open, tmp_path: Path) -> None:
    user = same_window()
    unit = user.field("loads.oil_l_per_min").unit
    assert unit is not None
    assert unit.text() == "l/min"
    user.enter("loads.oil_l_per_min", "0.12 m3/h")
    assert user.design.drive.loads.oil_l_per_min == 2.0
    assert user.steps == ["Change oil to 2 l/min"]
    project.save(user.design, tmp_path / "oil.toml")
    assert "oil_l_per_min = 2.0" in (tmp_path / "oil.toml").read_text("utf-8")
    assert project.load(tmp_path / "oil.toml") == user.design
    assert si(user.design.drive.loads).oil == pytest.approx(2e-3 / 60.0)


def test_a_column_in_the_unit_is_read_converted_and_written(tmp_path: Path) -> None:
    table = tmp_path / "pump.csv"
    table.write_text("angle_deg,oil_l_per_min\n0,0.03\n180,0.06\n360,0.03\n", "utf-8")
    assert main(["graph", str(table), "--curve", "y=oil_l_per_min", "--out", str(tmp_path / "own.csv")]) == 0
    assert (tmp_path / "own.csv").read_text("utf-8").splitlines()[:2] == ["angle_deg,oil_pump_l_per_min", "0.0,0.03"]
    words = ["--curve", "y=oil_l_per_min,y-unit=m3/h", "--out", str(tmp_path / "hours.csv")]
    assert main(["graph", str(table), *words]) == 0
    hours = [float(line.split(",")[1]) for line in (tmp_path / "hours.csv").read_text("utf-8").splitlines()[1:]]
    assert hours == pytest.approx([0.0018, 0.0036, 0.0018])


@pytest.mark.stress
def test_an_axis_in_the_unit_is_read_without_exponent(same_window: Open, tmp_path: Path) -> None:
    table = tmp_path / "pump.csv"
    table.write_text("angle_deg,oil_l_per_min\n0,0.03\n180,0.06\n360,0.03\n", "utf-8")
    view = same_window().see("curves")
    assert isinstance(view, CurvesView)
    view.add_files([table])
    wait_for(lambda: not view.busy)
    assert "Oil, ml/min" in view.plot.titles.values()


# -- a quantity, and a limit of it ------------------------------------------------------------------------

PRESSED = edited(project.load(example("transfer_lift")), "limits.squeeze_n", 80000.0)


@pytest.fixture
def pressed(tmp_path: Path) -> Path:
    path = tmp_path / "pressed.toml"
    project.save(PRESSED, path)
    return path


def test_the_limit_is_written_read_and_judged(pressed: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "squeeze_n = 80000.0" in pressed.read_text("utf-8")
    assert project.load(pressed) == PRESSED
    assert main(["check", str(pressed)]) == 0
    said = capsys.readouterr().out
    assert re.search(r"squeeze [\d.\u202f]+ N at [\d.]+ deg, your limit [\d.\u202f]+ N: press less", said), said


@pytest.mark.parametrize(("name", "counts"), [("card_picker", True), ("rocker_cam", False)])
def test_a_limit_bounds_what_measures_the_same(
    name: str, counts: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The jerk of a follower that slides; that of one that swings is an angle's."""
    path = tmp_path / "jerk.toml"
    project.save(edited(project.load(example(name)), "limits.jerk_mm_s3", 0.001), path)
    main(["check", str(path)])
    assert ("jerk " in capsys.readouterr().out) == counts


def test_the_quantity_stands_in_tables_and_report_beside_its_limit(
    pressed: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["export", str(pressed), "--out", str(tmp_path / "out"), "--samples", "36"])
    with (tmp_path / "out" / "dynamics.csv").open(encoding="utf-8") as table:
        rows = list(csv.DictReader(table))
    assert [float(row["squeeze_n"]) for row in rows] == [2.0 * float(row["contact_force_n"]) for row in rows]
    summary = json.loads((tmp_path / "out" / "summary.json").read_text("utf-8"))
    most = summary["extremes"]["squeeze_n"]["max"]["value"]
    assert most == pytest.approx(2.0 * summary["extremes"]["contact_force_n"]["max"]["value"], rel=1e-12)
    (told,) = (row for row in summary["limits"] if row["name"] == "squeeze_n")
    assert (told["limit"], told["source"]) == (80000.0, "own")
    capsys.readouterr()
    main(["report", str(pressed), "--samples", "36"])
    lines = [
        re.split(" +", line) for line in capsys.readouterr().out.splitlines() if line.strip().startswith("Squeeze")
    ]
    assert [len(line) for line in lines] == [3, 6, 6], "among inputs, extremes and limits"
    assert lines[2][4:] == ["80\u202f000", "own"]


def test_the_quantity_is_picked_and_drawn_with_the_line_of_its_limit(same_window: Open, pressed: Path) -> None:
    user = same_window(pressed)
    assert user.field("limits.squeeze_n").label.text() == "Squeeze"
    graph = user.see("graph")
    assert isinstance(graph, GraphView)
    item = graph.tree.item_of("squeeze")
    graph.tree.scrollToItem(item)
    box = graph.tree.visualItemRect(item)
    QTest.mouseClick(graph.tree.viewport(), Qt.MouseButton.LeftButton, pos=QPoint(box.left() + 9, box.center().y()))
    settle()
    assert "squeeze" in [row.name for row in graph.drawn]
    assert "limit 80 kN" in [limit.text for panel in graph.panels for limit in limits(panel.plot)]


@pytest.mark.stress
def test_find_keeps_the_limit(same_window: Open, pressed: Path, capsys: pytest.CaptureFixture[str]) -> None:
    view = same_window(pressed).see("find")
    assert isinstance(view, FindView)
    wait_for(lambda: view.up_to_date and not view.busy)
    assert view.limits.boxes["squeeze_n"].text() == "80000"
    words = (
        "find",
        pressed,
        "base-radius",
        "--limit",
        "squeeze_n=94000",
        "--into",
        pressed.parent / "found.toml",
        "--json",
    )
    reached = json.loads(say(capsys, *words))["reached"]
    assert reached["squeeze_n"] == pytest.approx(94000.0, rel=1e-8), "the smallest that just keeps it"
    assert reached["squeeze_n"] <= 94000.0
