"""File > Export > Inspection table and Kine > Inspect a measured cam: what the dialogs show is what the core computes."""

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from window_user import Open, User, answering, wait_for

from core.__main__ import main
from core.project import load, save
from kindyna_gui import dialogs
from kindyna_gui.inspection import InspectionDialog, MeasuredCamDialog, magnified
from kindyna_gui.pictures.style import LIGHT
from kindyna_gui.places import example

WAY = ("File", "Export", "Inspection table...")
KNIFE = load(example("tappet_knife"))
BUMP = 0.05


def type_number(box: object, text: str) -> None:
    box.setFocus()
    box.selectAll()
    QTest.keyClicks(box, text)


def test_a_table_goes_from_the_dialog_into_a_file(user: User, tmp_path: Path) -> None:
    def act(dialog: InspectionDialog) -> None:
        assert not dialog.export.isEnabled(), "nothing can be written before it is computed"
        dialog.form.boxes["probe"].setCurrentIndex(dialog.form.boxes["probe"].findData("flat"))
        assert not dialog.form.boxes["radius_mm"].isEnabled()
        wait_for(lambda: dialog.export.isEnabled())
        assert "does not reach into a hollow" in dialog.result.text()
        dialog.form.boxes["probe"].setCurrentIndex(dialog.form.boxes["probe"].findData("roller"))
        type_number(dialog.form.boxes["radius_mm"], "60")
        type_number(dialog.form.boxes["tolerance_mm"], "0.1")
        type_number(dialog.form.boxes["samples"], "72")
        wait_for(lambda: dialog.export.isEnabled())
        assert dialog.result.text().startswith("72 rows; largest lift ")
        (x, lift), (_, upper) = dialog.lift.lines[0], dialog.band.lines[0]
        assert (x.size, x[-1], lift[0]) == (73, 360.0, lift[-1])
        assert lift[:-1].tolist() == dialog.computed.table.lift.tolist()
        assert upper.min() > 99.999, "the band is wider in lift than normal to the profile"
        QTest.mouseClick(dialog.export, Qt.MouseButton.LeftButton)

    suggested = user.picks("inspection_to_save", tmp_path / "cam.csv")
    with answering(InspectionDialog, act):
        user.choose(*WAY)
    assert suggested[0].name.endswith("_lift.csv")
    save(user.design, tmp_path / "design.toml")
    (tmp_path / "again").mkdir()
    words = [
        "inspection",
        tmp_path / "design.toml",
        "--out",
        tmp_path / "again" / "cam.csv",
        "--radius",
        60,
        "--tolerance",
        0.1,
        "--samples",
        72,
    ]
    assert main([str(word) for word in words]) == 0
    for name in ("cam.csv", "summary.json"):
        assert (tmp_path / name).read_bytes() == (tmp_path / "again" / name).read_bytes()


# -- a measured cam -----------------------------------------------------------------------------------------------


def table(path: Path, degrees: np.ndarray, values: np.ndarray, head: str = "cam_angle_deg,lift_mm") -> Path:
    path.write_text(
        "\n".join([head, *(f"{a!r},{y!r}" for a, y in zip(degrees.tolist(), values.tolist(), strict=True))]), "utf-8"
    )
    return path


@pytest.fixture(scope="module")
def exact(tmp_path_factory: pytest.TempPathFactory) -> np.ndarray:
    """The table of the knife's cam."""
    path = tmp_path_factory.mktemp("exact") / "exact.csv"
    main(["inspection", str(example("tappet_knife")), "--out", str(path), "--samples", "180"])
    return np.genfromtxt(path, delimiter=",", names=True)


@pytest.fixture
def user(open_user: Open) -> User:
    """The dialogs go with the window."""
    return open_user()


@pytest.fixture
def opened(user: User, exact: np.ndarray, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> MeasuredCamDialog:
    """The dialog with a cam that has a bump at 120 deg."""
    degrees = exact["cam_angle_deg"]
    bump = BUMP * np.exp(-(((degrees - 120.0) / 5.0) ** 2))
    path = table(tmp_path / "cut.csv", degrees, exact["lift_mm"] + bump)
    user.session.start(KNIFE)
    monkeypatch.setattr(dialogs, "file_to_open", lambda *_: path)
    user.choose("Kine", "Inspect a measured cam...")
    dialog = next(each for each in QApplication.topLevelWidgets() if isinstance(each, MeasuredCamDialog))
    computed(dialog)
    return dialog


def computed(dialog: MeasuredCamDialog) -> str:
    wait_for(lambda: not dialog.verdict.text().startswith("Calculating"))
    return dialog.verdict.text()


def count(image: QImage, colour: str) -> int:
    wanted = QColor(colour).rgb()
    return sum(image.pixel(x, y) == wanted for x in range(image.width()) for y in range(0, image.height(), 2))


def test_a_bump_is_shown_with_its_place_and_verdict(
    opened: MeasuredCamDialog, exact: np.ndarray, tmp_path: Path
) -> None:
    """Then in tolerance, magnified otherwise, its zero marks fitted; what cannot be read is one line, and mended goes on."""
    text = opened.verdict.text()
    assert text.startswith("Out of tolerance, ± 20 µm, in ")
    worst = opened.comparison.worst_row
    assert f"{1e3 * opened.comparison.normal_deviation[worst]:+.4g} µm normal to the profile at 120°, line 62" in text
    assert opened.verdict.palette().windowText().color().name() == LIGHT.limit.lower()
    first = opened.rows.rows.rows[0].cells
    assert (first[0], first[1], first[3]) == ("62", "120", "+50")
    drawn, place = (magnified(opened.comparison, by)[worst] for by in (100.0, 0.0))
    assert abs(drawn) > abs(place) + 3.0, "metal too much stands outside"
    assert abs(drawn - place) == pytest.approx(100.0 * opened.comparison.normal_deviation[worst])
    out = opened.picture.grab().toImage()
    assert count(out, LIGHT.limit) > 20
    QTest.mouseClick(
        opened.rows.viewport(),
        Qt.MouseButton.LeftButton,
        pos=opened.rows.visualRect(opened.rows.rows.index(3, 1)).center(),
    )
    assert opened.picture.grab().toImage() != out, "the row that was clicked is ringed"
    type_number(opened.factor, "400")
    assert opened.picture.factor == 400.0
    type_number(opened.form.boxes["tolerance_mm"], "0.06")
    opened.form.boxes["tolerance_mm"].clearFocus()
    wait_for(lambda: opened.verdict.text().startswith("In tolerance, ± 60 µm"))
    assert opened.verdict.palette().windowText().color().name() == LIGHT.good.lower()
    # shifted by 10 deg and 1 mm, in inches: fitted, all is as before
    degrees = exact["cam_angle_deg"]
    table(
        tmp_path / "cut.csv",
        np.mod(degrees - 10.0, 360.0)[5:],
        (exact["lift_mm"][5:] + 1.0) / 25.4,
        "Angle [deg],Lift [in]",
    )
    QTest.mouseClick(opened.again, Qt.MouseButton.LeftButton)
    assert computed(opened).startswith("Out of tolerance")
    opened.fit.setChecked(True)
    assert computed(opened).startswith("In tolerance")
    assert "Fitted: cam angle = angle +10°, lift = measured \u22121 mm." in opened.notes.text()


@pytest.mark.stress
def test_what_cannot_be_read_is_one_line_and_nothing_is_lost(opened: MeasuredCamDialog, tmp_path: Path) -> None:
    path, shown = tmp_path / "cut.csv", opened.picture.shown
    whole = path.read_bytes()
    path.unlink()
    QTest.mouseClick(opened.again, Qt.MouseButton.LeftButton)
    assert "cut.csv" in opened.verdict.text()
    assert opened.picture.shown is shown, "a file that has gone leaves what is shown"
    for data, message in (
        (b"", "cut.csv: no row contains two numbers"),
        (whole.replace(b"40.0,", b"forty,"), "cut.csv, line 22: 'forty' in column 1"),
        (whole.replace(b"lift_mm", b"lift [furlong]"), "unknown unit 'furlong'"),
    ):
        path.write_bytes(data)
        QTest.mouseClick(opened.again, Qt.MouseButton.LeftButton)
        assert message in computed(opened)
        assert opened.picture.shown is None
    path.write_bytes(b"\n".join(whole.split(b"\n")[:100]))
    QTest.mouseClick(opened.again, Qt.MouseButton.LeftButton)
    assert computed(opened).startswith("Out of tolerance")
    assert opened.notes.text() == "No measured rows from 196 to 360°: the cam is not assessed there."


def test_a_file_that_is_not_there_and_a_design_without_a_cam(
    user: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(dialogs, "file_to_open", lambda *_: tmp_path / "gone.csv")
    user.choose("Kine", "Inspect a measured cam...")
    assert [what for what, _ in user.faults] == ["gone.csv cannot be read."]
    user.session.start(load(example("four_bar")))
    assert not user.action(*WAY).isEnabled()
    user.choose("Kine", "Inspect a measured cam...")
    assert "no cam" in user.window.status.currentMessage()
