"""kindyna_gui.headless, screenshots, selftest: what the window is good for where nobody sees it."""

import os
import subprocess
import sys
from io import BytesIO
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from mechanisms import LIFT, with_follower
from PIL import Image
from PySide6.QtCore import QPointF
from PySide6.QtGui import QColor, QImage, QLinearGradient, QPainter
from PySide6.QtWidgets import QApplication, QWidget
from sampled import stressed

from core.__main__ import main as core_main
from core.design import Design
from core.errors import KindynaError
from core.project import load, save
from core.stability import Stability
from kindyna_gui import screenshots, selftest
from kindyna_gui.__main__ import main
from kindyna_gui.headless import COMMANDS
from kindyna_gui.places import example, examples
from kindyna_gui.settings import Settings, settings_file
from kindyna_gui.stability_view import StabilityView
from kindyna_gui.window.docks import VIEWS
from kindyna_gui.window.tasks import TASKS

PICKER = example("card_picker")


@pytest.fixture(autouse=True)
def platform(app: QApplication, monkeypatch: pytest.MonkeyPatch) -> None:
    """What the commands do to the environment ends with the test."""
    monkeypatch.setenv("QT_QPA_PLATFORM", os.environ["QT_QPA_PLATFORM"])


def run(*words: object) -> int:
    return main(["--headless", *map(str, words)])


# -- screenshots ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("views", "tasks"), [([*VIEWS][::12], [*TASKS][::5]), stressed([*VIEWS], [*TASKS])], ids=["some", "all"]
)
def test_every_view_is_painted(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    views: list[str],
    tasks: list[str],
) -> None:
    monkeypatch.setattr(screenshots, "VIEWS", {name: VIEWS[name] for name in views})
    monkeypatch.setattr(screenshots, "TASKS", {name: TASKS[name] for name in tasks})
    assert run("screenshots", PICKER, "--out", tmp_path / "shots", "--size", "1024x700") == 0
    told = capsys.readouterr()
    made = {path.name: path for path in (tmp_path / "shots").iterdir()}
    assert told.out.splitlines() == [
        str(tmp_path / "shots" / name) for name in map(os.path.basename, told.out.split("\n")) if name
    ]
    assert told.err == ""
    wanted = {"window", *(f"window_{task}" for task in tasks), *views}
    pages = {
        "mechanism": ("vectors",),
        "graph": ("polar",),
        "parameters": ("follower", "cam", "shaft", "loads", "limits"),
        "centres": ("links", "points", "differences"),
    }
    wanted |= {f"{view}_{name}" for view, names in pages.items() if view in views for name in names}
    assert set(made) == {f"{name}.png" for name in wanted}
    for name, path in made.items():
        with Image.open(path) as opened:
            picture = np.asarray(opened.convert("L"))
        if name == "window.png":
            assert picture.shape == (700, 1024)
        assert picture.min() < 120, f"{name} is empty"
        assert picture.std() > 2.0, f"{name} is empty"


@pytest.mark.parametrize("kind", ["PNG", "WEBP"])
def test_an_image_in_few_colours_keeps_those_of_areas_and_lines(kind: Literal["PNG", "WEBP"]) -> None:
    """Curves in the colours of a plot on areas that differ little, with smoothed edges, over a gradient."""
    image = QImage(640, 400, QImage.Format.Format_RGB32)
    painter = QPainter(image)
    painter.fillRect(0, 0, 640, 400, QColor("#ffffff"))
    painter.fillRect(200, 0, 200, 300, QColor("#f3f4f6"))
    shade = QLinearGradient(0, 300, 640, 400)
    shade.setColorAt(0.0, QColor("#ffffff"))
    shade.setColorAt(1.0, QColor("#003050"))
    painter.fillRect(0, 300, 640, 100, shade)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    curves = ("#0072b2", "#009e73", "#d55e00", "#cc79a7")
    for row, colour in enumerate(curves, 1):
        painter.setPen(QColor(colour))
        painter.drawPolyline(
            [QPointF(0.5, 40 * row + 0.5), QPointF(120.5, 40 * row + 0.5), QPointF(600.3, 40 * row + 91.2)]
        )
    painter.end()
    data = screenshots.small_file(image, kind)
    read = QImage.fromData(data, kind)
    shown = [picture.convertToFormat(QImage.Format.Format_RGB32) for picture in (image, read)]
    exact, few = (np.array(np.frombuffer(picture.constBits(), np.uint8), dtype=int) for picture in shown)
    assert np.abs(exact - few).max() <= 24
    assert 8 < len({tuple(pixel) for pixel in few.reshape(-1, 4).tolist()}) <= 256
    assert [read.pixelColor(60, 40 * row).name() for row in range(1, 5)] == list(curves)
    assert [read.pixelColor(x, 10).name() for x in (10, 300)] == ["#ffffff", "#f3f4f6"]
    assert len(data) < 0.5 * len(screenshots.png_bytes(image))


@pytest.mark.stress
def test_the_page_of_stability_is_finished_before_its_picture_is_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[tuple[bool, bool, int, str]] = []
    paint = screenshots.png

    def look(widget: QWidget, small: bool = False) -> bytes:
        if isinstance(widget, StabilityView):
            seen.append((widget.busy, widget.progress.isVisible(), widget.drawn.q.size, widget.pages.speeds.text()))
        return paint(widget, small)

    monkeypatch.setattr(Stability, "turns", 2.0)
    monkeypatch.setattr(screenshots, "VIEWS", ["stability"])
    monkeypatch.setattr(screenshots, "png", look)
    assert run("screenshots", example("kim_1990"), "--out", tmp_path) == 0
    [(busy, waiting, rows, text)] = seen
    assert not busy
    assert not waiting
    assert rows > 30, "the coarse chart has few"
    assert "margin" in text
    assert "Calculating" not in text


@pytest.mark.stress
def test_a_picture_waits_no_longer_than_its_patience(monkeypatch: pytest.MonkeyPatch) -> None:
    window = screenshots.hidden_window(load(example("kim_1990")), (800, 600))
    view = window.show_view("stability")
    monkeypatch.setattr(type(view), "busy", property(lambda self: True))
    try:
        screenshots.rest(window, patience=0.0)
        assert view.busy
    finally:
        screenshots.dismiss(window)


def test_the_users_own_settings_are_neither_read_nor_written(tmp_path: Path, own_settings: Path) -> None:
    kept = Settings()
    kept.add_recent(PICKER)
    settings_file().sync()
    before = {path: path.read_bytes() for path in own_settings.rglob("*") if path.is_file()}
    window = screenshots.hidden_window(LIFT, (800, 600))
    assert window.settings.recent == []
    screenshots.dismiss(window)
    assert {path: path.read_bytes() for path in own_settings.rglob("*") if path.is_file()} == before


@pytest.mark.parametrize("size", ["900", "10x10", "900x", "99999x900", "-900x700"])
def test_a_wrong_size_is_told_in_one_line(size: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("screenshots", PICKER, "--out", tmp_path / "out", f"--size={size}") == 2
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 1
    assert "allowed" in told[0]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", ["screenshots", "animation"])
def test_a_design_without_an_answer_leaves_nothing(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "bad.toml"
    save(with_follower(LIFT, rod_mm=400.0, guide_height_mm=600.0), path)
    out = tmp_path / ("out.gif" if command == "animation" else "out")
    assert run(command, path, "--out", out) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert [p.name for p in tmp_path.iterdir()] == ["bad.toml"]


def test_a_design_with_an_error_is_painted_and_answers_1(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = PICKER.read_text("utf-8").replace("base_radius_mm = 50.0", "base_radius_mm = 1.0")
    path = tmp_path / "steep.toml"
    path.write_text(text, "utf-8")
    code = run("animation", path, "--out", tmp_path / "a.gif", "--frames", 4, "--size", "320x320")
    assert code == (1 if "error" in _check(path, capsys) else 0)
    assert (tmp_path / "a.gif").is_file()


def _check(path: Path, capsys: pytest.CaptureFixture[str]) -> str:
    capsys.readouterr()
    run("check", path)
    return capsys.readouterr().out


# -- animation --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("ending", ["gif", "webp"])
def test_an_animation_from_the_command_line(ending: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / f"turn.{ending}"
    assert run("animation", PICKER, "--out", path, "--frames", 8, "--size", "400x320") == 0
    assert capsys.readouterr().out == f"{path}\n"
    film = Image.open(BytesIO(path.read_bytes()))
    assert (film.n_frames, film.size) == (8, (400, 320))


@pytest.mark.parametrize("words", [("--out", "a.mp4"), ("--frames", "1"), ("--frames", "many")])
def test_wrong_words_are_told(words: tuple[str, str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run("animation", PICKER, *words) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


# -- selftest ---------------------------------------------------------------------------------------------


KINDS = ("transfer_lift", "kim_1990", "four_bar_coupler_cam")


@pytest.mark.stress
@pytest.mark.parametrize("name", KINDS)
def test_an_example_of_each_kind_passes(
    name: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """One by one, so that they share the processors."""
    monkeypatch.setattr(selftest, "FRAMES", 4)
    monkeypatch.setattr(selftest, "examples", lambda: [row for row in examples() if row[1] == example(name)])
    assert run("selftest") == 0
    told = capsys.readouterr()
    assert told.err == ""
    assert [line.split(":")[0] for line in told.out.splitlines()] == [f"ok {name}"]


def test_the_selftest_walks_all_examples(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """And goes on after one that fails."""

    def refuse(path: Path) -> Design:
        raise KindynaError(f"{path.stem} cannot be read")

    monkeypatch.setattr(selftest, "load", refuse)
    assert run("selftest") == 1
    wanted = [f"FAILED {path.stem}: {path.stem} cannot be read" for _, path in examples()]
    assert capsys.readouterr().out.splitlines() == wanted


def test_what_differs_from_the_core_is_told(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def other(design: object, folder: Path) -> list[str]:
        names = selftest_write(design, folder)
        table = folder / "profile.csv"
        table.write_text(table.read_text("utf-8").replace("0.1,", "0.2,", 1), "utf-8")
        return names

    selftest_write = selftest.write_tables
    monkeypatch.setattr(selftest, "FRAMES", 4)
    monkeypatch.setattr(selftest, "write_tables", other)
    monkeypatch.setattr(selftest, "examples", lambda: examples()[:1])
    assert run("selftest") == 1
    assert capsys.readouterr().out == f"FAILED {examples()[0][1].stem}: profile.csv differs from the core's\n"


# -- how they are hooked in -------------------------------------------------------------------------------


def test_the_commands_are_offered_beside_the_cores(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("--help") == 0
    told = capsys.readouterr().out
    for name in ("check", "report", "export", *COMMANDS):
        assert name in told


def test_the_core_knows_nothing_of_them(capsys: pytest.CaptureFixture[str]) -> None:
    assert core_main(["--help"]) == 0
    told = capsys.readouterr().out
    for name in COMMANDS:
        assert name not in told


def test_no_window_is_shown_whatever_the_desktop_says(tmp_path: Path) -> None:
    """And nothing is said on stderr."""
    path = tmp_path / "lift.toml"
    save(LIFT, path)
    words = ["animation", str(path), "--frames", "2", "--size", "320x320", "--out", "a.gif"]
    environment = {**os.environ, "QT_QPA_PLATFORM": "xcb", "DISPLAY": ":987"}
    program = [sys.executable, "-m", "kindyna_gui", "--headless", *words]
    done = subprocess.run(
        program, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=60, encoding="utf-8"
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "a.gif").is_file()
