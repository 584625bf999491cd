"""The drawing of a cam as a file: PDF and SVG read again and measured against the cam; by command and by mouse."""

import re
import subprocess
import sys
import zlib
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from mechanisms import PUSHER, levels, with_drive
from PySide6.QtCore import QByteArray, Qt, QTimer
from PySide6.QtSvg import QSvgRenderer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from sampled import spread
from scipy.spatial import cKDTree
from window_user import Open, User, wait_for

from core.project import load, save
from core.study import Study
from kindyna_gui.__main__ import main
from kindyna_gui.cam_dialogs.profile_dialogs import DrawingDialog
from kindyna_gui.places import example

SVG = "{http://www.w3.org/2000/svg}"
WAY = ("File", "Export", "Drawing...")
INCH, POINTS = 25.4, 72.0
WIDE = 0.5  # mm: of visible edges
Path_ = np.ndarray  # (n,) places [mm] of a path, y upwards


@pytest.fixture
def open_user(same_window: Open) -> Open:
    """One window for all tests of this file."""
    return same_window


@pytest.fixture(autouse=True)
def platform(app: QApplication, monkeypatch: pytest.MonkeyPatch) -> None:
    """What the command does to the environment ends with the test."""
    monkeypatch.setenv("QT_QPA_PLATFORM", "offscreen")


def run(*words: object) -> int:
    return main(["--headless", "drawing", *map(str, words)])


def along(cubics: list[list[complex]]) -> Path_:
    """Points of cubics, twenty of each."""
    t = np.arange(20) / 20.0
    weights = np.stack(((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3))
    return np.asarray((np.array(cubics) @ weights).ravel())


def svg_paths(data: bytes) -> tuple[tuple[float, float], list[tuple[float, bool, Path_]]]:
    """Size [mm] of the page and its paths: width of the line [mm], whether it is dashed, where it runs."""
    root = ElementTree.fromstring(data)
    width, height = (float(root.get(name, "").removesuffix("mm")) for name in ("width", "height"))
    box = [float(v) for v in root.get("viewBox", "").split()]
    unit = width / box[2]
    assert unit == pytest.approx(height / box[3], rel=1e-9)
    found = []
    for group in root.iter(f"{SVG}g"):
        assert group.get("transform", "matrix(1,").startswith("matrix("), "no other transform is read here"
        pen, dashed = float(group.get("stroke-width", "0")) * unit, group.get("stroke-dasharray") is not None
        for drawn in (*group.findall(f"{SVG}path"), *group.findall(f"{SVG}polyline")):
            numbers = [
                float(v) for v in re.findall(r"-?[\d.]+(?:e[-+]?\d+)?", drawn.get("d") or drawn.get("points") or "")
            ]
            z = np.array(numbers[::2]) * unit + 1j * (height - np.array(numbers[1::2]) * unit)
            if "C" in (drawn.get("d") or ""):
                z = along([[z[i], *z[i + 1 : i + 4]] for i in range(0, 3 * ((z.size - 1) // 3), 3)])
            found.append((pen, dashed, z))
    return (width, height), found


def pdf_paths(data: bytes) -> tuple[tuple[float, float], list[tuple[float, bool, Path_]]]:
    """The same of a PDF's one page: its media box, and the operators of its content."""
    box = re.search(rb"/MediaBox \[([^\]]*)\]", data)
    assert box is not None
    size = [float(v) / POINTS * INCH for v in box[1].split()]
    streams = [
        zlib.decompress(part)
        for part in re.findall(rb"/FlateDecode\s*>>\s*stream\r?\n(.*?)\r?\nendstream", data, re.DOTALL)
    ]
    content = max((part for part in streams if b" cm" in part), key=len).decode("latin-1")
    matrix, kept, stack, pen, dashed = np.eye(3), [], [], 0.0, False
    here, start, path, found = 0j, 0j, [], []
    for word in re.findall(r"\[[^\]]*\]|\([^)]*\)|<[^>]*>|[^\s\[\]<>()]+", content):
        if re.fullmatch(r"[-+]?[\d.]+", word):
            stack.append(float(word))
            continue
        place = [complex(x, y) for x, y in zip(stack[::2], stack[1::2], strict=False)]
        if word == "q":
            kept.append((matrix, pen, dashed))
        elif word == "Q":
            matrix, pen, dashed = kept.pop()
        elif word == "cm":
            a, b, c, d, e, f = stack[-6:]
            matrix = matrix @ np.array([[a, c, e], [b, d, f], [0.0, 0.0, 1.0]])
        elif word == "w":
            pen = stack[-1]
        elif word.startswith("["):
            dashed = bool(word.strip("[] "))
            continue
        elif word == "m":
            here = start = place[-1]
        elif word == "l":
            path.append(here + (place[-1] - here) * np.arange(2))
            here = place[-1]
        elif word == "c":
            path.append(along([[here, *place[-3:]]]))
            here = place[-1]
        elif word == "h":
            here = start
        elif word in ("S", "f", "f*", "B", "B*", "n"):
            if word == "S" and path:
                z = np.concatenate(path)
                x, y, _ = matrix @ np.stack((z.real, z.imag, np.ones(z.size)))
                scale = np.sqrt(abs(np.linalg.det(matrix)))
                found.append((pen * scale / POINTS * INCH, dashed, (x + 1j * y) / POINTS * INCH))
            path = []
        stack = []
    return (size[2], size[3]), found


READERS = {".svg": svg_paths, ".pdf": pdf_paths}


def check_profile(file: Path, design: Path, scale: float, size: tuple[float, float], flank: str = "inner") -> None:
    """Page and profile have their sizes on paper: to 0.2 mm, for Qt's pages are whole points, and to 0.05 mm."""
    page, paths = READERS[file.suffix](file.read_bytes())
    assert page == pytest.approx(size, abs=0.2)
    axes = [z for pen, dashed, z in paths if dashed and z.size == 2]
    assert len(axes) == 2, "two centre lines"
    level, upright = sorted(axes, key=lambda z: abs(z[1].imag - z[0].imag))
    centre = complex(upright.real.mean(), level.imag.mean())
    drawn = max((z for pen, _, z in paths if abs(pen - WIDE) < 0.01), key=lambda z: z.size)
    exact = 1e3 * scale * Study(load(design), 36_000).cam.only(flank).flank.profile + centre
    far = cKDTree(np.column_stack((exact.real, exact.imag))).query(np.column_stack((drawn.real, drawn.imag)))[0]
    back = cKDTree(np.column_stack((drawn.real, drawn.imag))).query(np.column_stack((exact.real, exact.imag)))[0]
    assert far.max() < 0.05
    assert back.max() < 0.05 + 0.5 * np.abs(np.diff(drawn)).max()


@pytest.mark.parametrize("ending", spread(READERS, 1))
def test_a_drawing_is_true_to_scale(ending: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / f"cam{ending}"
    assert run(example("tappet_flat"), "--out", file) == 0
    assert capsys.readouterr() == (f"{file}\n", "")
    check_profile(file, example("tappet_flat"), 2.0, (297.0, 210.0))
    assert run(example("transfer_lift"), "--out", file, "--paper", "A3") == 0
    check_profile(file, example("transfer_lift"), 0.2, (420.0, 297.0))


def test_qt_reads_the_svg_at_its_size(tmp_path: Path) -> None:
    assert run(example("tappet_flat"), "--out", tmp_path / "cam.svg") == 0
    renderer = QSvgRenderer(QByteArray((tmp_path / "cam.svg").read_bytes()))
    assert renderer.isValid()
    assert (renderer.viewBox().width(), renderer.viewBox().height()) == (29700, 21000)
    text = "".join(ElementTree.parse(tmp_path / "cam.svg").getroot().itertext())
    assert all(word in text for word in ("Flat tappet", "2:1", "R 30", "counter-clockwise", "clockwise"))


@pytest.mark.stress
@pytest.mark.parametrize("ending", spread(list(READERS), 1))
def test_the_same_design_gives_the_same_bytes_and_no_time(ending: str, tmp_path: Path) -> None:
    """In another process too."""
    one, two = tmp_path / f"one{ending}", tmp_path / f"two{ending}"
    assert run(example("tappet_flat"), "--out", one) == 0
    words = ["--headless", "drawing", str(example("tappet_flat")), "--out", str(two)]
    subprocess.run([sys.executable, "-m", "kindyna_gui", *words], check=True, capture_output=True)
    assert one.read_bytes() == two.read_bytes()
    assert b"CreationDate" not in one.read_bytes()


def test_what_cannot_be_drawn_is_refused_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "cam.pdf"
    for words, reason in (
        ((example("four_bar"), "--out", out), "stage 'cam': this kind of design has none of that name"),
        ((example("tappet_flat"), "--out", out, "--flank", "second"), "flank 'second': this cam has none of that name"),
        ((example("tappet_flat"), "--out", tmp_path / "cam.dxf"), "allowed endings: .pdf, .svg"),
    ):
        code = run(*words)
        said = capsys.readouterr()
        assert (code, said.out, len(said.err.splitlines())) == (2, "", 1)
        assert reason in said.err
    assert list(tmp_path.iterdir()) == []


def test_names_of_any_script_and_length_are_written_as_they_are(tmp_path: Path) -> None:
    for name in ('A & <B> -- "q"', "캠 설계", "x" * 300, "a\tb\x01"):
        shown = "".join(c if c.isprintable() else "\ufffd" for c in name)
        save(replace(load(example("tappet_flat")), name=name), tmp_path / "design.toml")
        assert run(tmp_path / "design.toml", "--out", tmp_path / "cam.svg", "--date", "1 March") == 0
        root = ElementTree.parse(tmp_path / "cam.svg").getroot()
        assert {shown, "1 March"} <= {text.strip() for text in root.itertext()}


# -- the window -------------------------------------------------------------------------------------------


def test_a_drawing_goes_from_the_dialog_into_a_file(user: User, tmp_path: Path) -> None:
    seen: list[str] = []

    def act() -> None:
        dialog = QApplication.activeModalWidget()
        if not isinstance(dialog, DrawingDialog):
            QTimer.singleShot(5, act)
            return
        wait_for(lambda: dialog.computed is not None)
        QTest.keyClick(dialog.form.boxes["paper"], Qt.Key.Key_Down)
        assert dialog.computed is None, "nothing can be written before it is computed"
        assert not dialog.export.isEnabled()
        wait_for(lambda: dialog.computed is not None)
        dialog.grab()
        seen.append(dialog.result.text())
        QTest.mouseClick(dialog.export, Qt.MouseButton.LeftButton)

    user.session.start(load(example("tappet_flat")))
    suggested = user.picks("drawing_to_save", tmp_path / "cam.svg")
    QTimer.singleShot(0, act)
    user.choose(*WAY)
    assert len(seen) == 1
    assert "Flat tappet" in seen[0]
    assert suggested[0].suffix == ".pdf"
    assert user.window.status.currentMessage() == f"Wrote {tmp_path / 'cam.svg'}"
    save(user.design, tmp_path / "design.toml")
    assert run(tmp_path / "design.toml", "--out", tmp_path / "again.svg", "--paper", "A3") == 0
    assert (tmp_path / "cam.svg").read_bytes() == (tmp_path / "again.svg").read_bytes()


def test_an_undercut_cam_is_refused_in_the_dialog(user: User) -> None:
    seen: list[str] = []

    def act() -> None:
        dialog = QApplication.activeModalWidget()
        if not isinstance(dialog, DrawingDialog):
            QTimer.singleShot(5, act)
            return
        wait_for(lambda: not dialog.result.text().startswith("Calculating"))
        seen.append(dialog.result.text())
        assert not dialog.export.isEnabled()
        QTest.keyClick(dialog, Qt.Key.Key_Escape)

    motion = levels(0.0, (25.0, 20.0, "cycloidal"), (25.0, 0.0, "cycloidal"), (310.0, 0.0, "dwell"))
    user.session.start(with_drive(PUSHER, motion=motion))
    QTimer.singleShot(0, act)
    user.choose(*WAY)
    assert len(seen) == 1
    assert "the profile is undercut" in seen[0]


def test_a_design_without_a_cam_has_no_drawing(user: User) -> None:
    user.session.start(load(example("four_bar")))
    action = user.action(*WAY)
    assert not action.isEnabled()
    assert action.statusTip() == "This design has no cam"
