"""The report to hand on with its pictures: HTML and PDF by the command, its pages, its text, the same bytes again."""

import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from pdf_reader import page_texts
from PySide6.QtCore import QPoint, QRectF, Qt, QTimer
from PySide6.QtGui import QImage, QPainter
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QPushButton
from window_user import User

from core.output.report.document import PAPERS, PARTS, document
from core.output.summary import summary
from core.project import load
from core.study import Study
from kindyna_gui import export_dialogs
from kindyna_gui.__main__ import main
from kindyna_gui.export_dialogs import ReportDialog
from kindyna_gui.pictures.paper.pictures import vector
from kindyna_gui.pictures.paper.report import BODY, SCALE, Pen, pages, report_file, strips_of, typeset, width
from kindyna_gui.pictures.paper.sheets import UNITS_PER_MM
from kindyna_gui.places import example

LIFT = example("transfer_lift")
LESS = ("--without", "papers", "extremes")


@pytest.fixture(autouse=True)
def platform(app: QApplication, monkeypatch: pytest.MonkeyPatch) -> None:
    """What the command does to the environment ends with the test."""
    monkeypatch.setenv("QT_QPA_PLATFORM", "offscreen")


def report(*words: object) -> int:
    return main(["--headless", "report", *map(str, words)])


@pytest.fixture(scope="module")
def lift() -> Study:
    return Study(load(LIFT))


@pytest.fixture(scope="module")
def written(app: QApplication, tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("report") / "lift.pdf"
    assert report(LIFT, "--out", path, *LESS) == 0
    return path.read_bytes()


@pytest.mark.parametrize("letter", "φθβαLlz")
def test_the_dots_of_a_derivative_stand_clear_above_the_middle_of_their_letter(letter: str, app: QApplication) -> None:
    """Whatever the font makes of a letter with dots."""
    plain, dotted, twice = (_ink(letter + dots) for dots in ("", "\N{COMBINING DOT ABOVE}", "\N{COMBINING DIAERESIS}"))
    top = np.flatnonzero(plain.any(axis=1))[0]
    for each, count in ((dotted, 1), (twice, 2)):
        above = each[:top]
        assert (each[top:] == plain[top:]).all(), "the letter is the same"
        assert not above[-3:].any(), "clear of it"
        across = np.flatnonzero(np.diff(above.any(axis=0).astype(int)))
        assert across.size == 2 * count
        assert across.mean() == pytest.approx(np.flatnonzero(plain.any(axis=0))[[0, -1]].mean(), abs=0.2 * UNITS_PER_MM)


def _ink(text: str) -> np.ndarray:
    """Dark pixels (rows, columns) of a paper 5 mm across and 8 mm high."""
    image = QImage(round(5 * UNITS_PER_MM), round(8 * UNITS_PER_MM), QImage.Format.Format_Grayscale8)
    image.fill(255)
    painter = QPainter(image)
    Pen(painter).text(2.0, 6.0, text, BODY)
    painter.end()
    return (
        np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())[:, : image.width()]
        < 128
    )


@pytest.mark.stress
def test_the_text_of_the_pdf_can_be_searched(lift: Study, written: bytes) -> None:
    texts = page_texts(written)
    whole, figures = "\n".join(texts), summary(lift, ("cam", "dynamics"))
    assert texts[0].startswith("REPORT\nTransfer unit, lift drive\n")
    letters = "".join(whole.split())
    for text in (
        "Cam-driven slider, roller, open cam",
        "Findings",
        "Slider arm L1",
        "1302.162",
        "Shin1995 (11), (12)",
    ):
        assert "".join(text.split()) in letters
    words = " ".join(whole.split())
    assert "corrected: the printed equation is wrong, and the equation given here is computed" in words
    for name in ("pressure_angle_deg", "contact_force_n", "drive_torque_nm"):
        rounded = float(f"{figures['extremes'][name]['max']['value']:.4g}")
        assert f"{rounded:,.10g}".replace(",", " " if rounded >= 1e4 else "") in words
    assert [text.rpartition("\n")[2] for text in texts] == [f"{n} / {len(texts)}" for n in range(1, len(texts) + 1)]


def test_the_first_page_says_for_whom_and_what_matters_on_either_paper(tmp_path: Path) -> None:
    words = (
        "--customer",
        "Press works",
        "--author",
        "J. Kim",
        "--revision",
        "B",
        "--date",
        "2 March",
        "--paper",
        "Letter",
    )
    assert report(LIFT, "--out", tmp_path / "a.pdf", *LESS, *words) == 0
    data = (tmp_path / "a.pdf").read_bytes()
    first = page_texts(data)[0]
    for text in (
        "Customer\nPress works",
        "Author\nJ. Kim",
        "Revision\nB",
        "Date\n2 March",
        "Pressure angle",
        "Flywheel needed",
        "Findings",
    ):
        assert text in first
    assert re.findall(rb"/MediaBox \[0 0 ([\d.]+) ([\d.]+)\]", data)[0] == (b"612.000000", b"792.000000")


SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="40" height="20"><circle cx="10" cy="10" r="9" fill="#123456"/></svg>'


@pytest.mark.stress
def test_company_and_logo_stand_on_the_first_page_and_a_broken_logo_stops_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    least = ("--without", *PARTS, "--company", "Cams & Sons")
    (tmp_path / "logo.svg").write_text(SVG, "utf-8")
    picture = QImage(60, 20, QImage.Format.Format_RGB32)
    picture.fill(0xFF123456)
    assert picture.save(str(tmp_path / "logo.png"))
    (tmp_path / "logo.jpg").write_bytes(b"no picture")
    made = {}
    for name in ("logo.svg", "logo.png", "logo.jpg"):
        for ending in (".pdf", ".html"):
            out = tmp_path / f"{name}{ending}"
            assert report(LIFT, "--out", out, *least, "--logo", tmp_path / name) == 0
            made[name, ending] = out.read_bytes()
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 2
    assert all("logo.jpg: cannot be read as an image" in line for line in said)
    assert b"/Subtype /Image" in made["logo.png", ".pdf"]
    assert made["logo.svg", ".pdf"] != made["logo.jpg", ".pdf"]
    for name, kind in (("logo.svg", b"image/svg+xml"), ("logo.png", b"image/png")):
        assert b'<img src="data:' + kind in made[name, ".html"]
    assert b"<img" not in made["logo.jpg", ".html"]
    assert all("Company\nCams & Sons" in page_texts(made[name, ".pdf"])[0] for name in ("logo.svg", "logo.jpg"))
    assert report(LIFT, "--out", tmp_path / "again.pdf", *least, "--logo", tmp_path / "logo.png") == 0
    assert (tmp_path / "again.pdf").read_bytes() == made["logo.png", ".pdf"]


@pytest.fixture
def elsewhere(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The clock of another place on earth."""
    with monkeypatch.context() as patch:
        patch.setenv("TZ", "Asia/Kolkata")
        time.tzset()
        yield
    time.tzset()


@pytest.mark.stress
@pytest.mark.posix("time.tzset")
def test_the_same_design_gives_the_same_bytes_at_any_time_and_place(
    written: bytes, tmp_path: Path, elsewhere: None
) -> None:
    """And the table at the file's end says where its objects stand."""
    assert report(LIFT, "--out", tmp_path / "again.pdf", *LESS) == 0
    assert (tmp_path / "again.pdf").read_bytes() == written
    assert b"CreationDate" not in written
    begin = int(written.rpartition(b"startxref\n")[2].split()[0])
    table = written[begin:].partition(b"trailer")[0].splitlines()
    assert table[0] == b"xref"
    for number, line in enumerate(table[2:]):
        assert number == 0 or written[int(line.split()[0]) :].startswith(b"%d 0 obj" % number)
    assert re.findall(rb"/MediaBox \[0 0 ([\d.]+) ([\d.]+)\]", written)[0] == (b"595.000000", b"842.000000")


def test_a_page_does_not_end_with_a_heading(lift: Study, app: QApplication) -> None:
    """What belongs to what follows it stands on the same page; nothing stands below the foot, and every strip once."""
    strips = list(strips_of(document(lift, [part for part in PARTS if part not in ("pictures", "papers")]), {}))
    room = PAPERS["A4"][1] - 40.0
    laid = pages(strips, room)
    for page in laid:
        assert not page[-1][0].joined
        assert page[-1][1] + page[-1][0].height <= room
        assert all(a[1] + a[0].height <= b[1] + 1e-9 for a, b in pairwise(page))
    heads = {id(strip.header) for strip in strips if strip.header is not None}
    assert [id(strip) for page in laid for strip, _ in page if id(strip) not in heads] == [
        id(strip) for strip in strips
    ]


@pytest.mark.stress
def test_a_picture_is_drawn_lower_rather_than_leaving_half_a_page_empty(app: QApplication) -> None:
    """No page but the last ends in its upper half, and a picture keeps its letters and most of its height."""
    made = document(Study(load(example("groove"))), ["inputs", "pictures"])
    drawn = {picture: vector(picture, SCALE) for picture in made.pictures}
    strips = list(strips_of(made, drawn))
    laid = pages(strips, PAPERS["A4"][1] - 40.0)
    filled = [page[-1][1] + page[-1][0].height for page in laid]
    assert min(filled[:-1]) > 0.6 * 257.0
    whole = [strip.height for strip in strips if strip.shrunk is not None]
    shown = [strip.height for page in laid for strip, _ in page if strip.shrunk is not None]
    assert len(whole) == len(shown)
    assert all(0.55 * a < b <= a for a, b in zip(whole, shown, strict=True))
    assert shown != whole, "the curves of the motion stand on the page at hand"


@pytest.mark.skipif(shutil.which("qpdf") is None, reason="no qpdf on the PATH")
def test_qpdf_finds_nothing_wrong_with_the_pdf(written: bytes, tmp_path: Path) -> None:
    (tmp_path / "r.pdf").write_bytes(written)
    checked = subprocess.run(["qpdf", "--check", tmp_path / "r.pdf"], capture_output=True, text=True, encoding="utf-8")
    assert checked.returncode == 0, checked.stdout + checked.stderr
    assert "No syntax or stream encoding errors found" in checked.stdout


def test_an_index_stands_below_its_letter_and_paths_of_fields_stay(app: QApplication) -> None:
    plain, low = _ink("CC"), _ink("C_f")
    bottom = np.flatnonzero(plain.any(axis=1))[-1]
    assert not plain[bottom + 1 :].any()
    assert low[bottom + 1 :].any()
    assert width("a_b_mm", BODY) > width("abmm", BODY) + 2.0 * width("_", BODY) - 0.1


def fill_in(act: Callable[[ReportDialog], None]) -> None:
    """What the user does in the dialog once it is there."""

    def try_it() -> None:
        dialog = QApplication.activeModalWidget()
        if isinstance(dialog, ReportDialog):
            act(dialog)
        else:
            QTimer.singleShot(5, try_it)

    QTimer.singleShot(0, try_it)


def press(dialog: ReportDialog, text: str) -> None:
    button = next(each for each in dialog.findChildren(QPushButton) if each.text() == text)
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)


def check_pictures(page: str) -> None:
    """Five pictures stand in the page as vectors, and no name stands in two of them."""
    drawn = re.findall(r"<svg\b.*?</svg>", page, re.DOTALL)
    assert len(drawn) == page.count("<figure>") == 5
    for picture in drawn:
        root = ElementTree.fromstring(picture)
        assert root.get("width") is None
        assert len(list(root.iter("{http://www.w3.org/2000/svg}path"))) > 5
        assert "base64" not in picture
    assert "without its pictures" not in page
    assert "Displacement, mm" in page
    names = re.findall(r'\bid="([^"]+)"', page)
    assert len(names) == len(set(names))


def test_the_window_writes_the_report_and_opens_it_when_asked(
    user: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[Path] = []
    monkeypatch.setattr(export_dialogs, "open_outside", opened.append)
    suggested = user.picks("report_to_save", tmp_path / "r.html")

    def act(dialog: ReportDialog) -> None:
        QTest.keyClick(dialog.kind, Qt.Key.Key_Down)
        for box in (dialog.parts["equations"], dialog.parts["papers"], dialog.opened):
            QTest.mouseClick(box, Qt.MouseButton.LeftButton, pos=QPoint(8, box.height() // 2))
        press(dialog, "Save report...")

    fill_in(act)
    user.choose("File", "Report...")
    page = (tmp_path / "r.html").read_text("utf-8")
    assert suggested[0].suffix == ".html"
    assert opened == [tmp_path / "r.html"]
    assert user.window.status.currentMessage() == f"Wrote {tmp_path / 'r.html'}"
    check_pictures(page)
    assert "Extremes over one turn" in page
    assert "Equations used" not in page
    user.picks("report_to_save", tmp_path / "missing" / "r.pdf")

    def least(dialog: ReportDialog) -> None:
        for box in dialog.parts.values():
            box.setChecked(False)
        press(dialog, "Save report...")

    fill_in(least)
    user.choose("File", "Report...")
    assert [what for what, _ in user.faults] == ["r.pdf cannot be written."]
    assert opened == [tmp_path / "r.html"]


def test_a_report_that_is_cancelled_is_not_written(lift: Study, app: QApplication) -> None:
    made = document(lift, ["pictures"])
    asked: list[int] = []
    assert report_file(made, ".pdf", lambda done: asked.append(done) or done < 1) is None  # type: ignore[func-returns-value]
    assert asked == [0, 1]


def test_a_report_can_be_cancelled_between_two_equations(lift: Study, app: QApplication) -> None:
    made = document(lift, ["equations"])
    asked: list[int] = []
    assert report_file(made, ".pdf", lambda done: asked.append(done) or len(asked) < 4) is None  # type: ignore[func-returns-value]
    assert len(asked) == 4
    assert len(made.equations) > 40


def drawn_equation(mathml: str) -> tuple[float, float, bytes]:
    """Width, height and pixels of an equation, as a new process would draw it."""
    typeset.cache_clear()
    equation = typeset(mathml)
    image = QImage(200, 100, QImage.Format.Format_Grayscale8)
    image.fill(255)
    painter = QPainter(image)
    equation.paint(painter, QRectF(0.0, 0.0, 200.0, 100.0))
    painter.end()
    return equation.width, equation.height, bytes(image.constBits())


def test_an_equation_is_typeset_once_and_then_read_from_the_cache(
    app: QApplication, monkeypatch: pytest.MonkeyPatch
) -> None:
    mathml = "<math><mi>p</mi><mo>=</mo><msqrt><mfrac><mi>F</mi><mi>b</mi></mfrac></msqrt></math>"
    first = drawn_equation(mathml)
    assert 0 < first[2].count(0) < 200 * 100, "something is drawn"
    (saved,) = (Path(os.environ["XDG_CACHE_HOME"]) / "KINDYNA").rglob("*.svg")
    content = saved.read_bytes()
    with monkeypatch.context() as without_typesetter:
        without_typesetter.setitem(sys.modules, "ziamath", None)
        assert drawn_equation(mathml) == first
    for damaged in (content[: len(content) // 2], content.replace(b" L ", b" M ", 1), b"", b"\xff\n1 1\n<svg/>"):
        saved.write_bytes(damaged)
        assert drawn_equation(mathml) == first
        assert saved.read_bytes() == content, "it is saved again"
    folder = saved.parent
    saved.unlink()
    folder.rmdir()
    folder.write_text("a file of the user where the folder would be", "utf-8")
    assert drawn_equation(mathml) == first
    assert folder.read_text("utf-8").startswith("a file of the user")
