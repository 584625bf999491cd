"""kindyna_gui.export, export_dialogs, pictures.film: what leaves the program, whole or not at all."""

import json
import sys
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mechanisms import LIFT
from PIL import Image
from PySide6.QtCore import Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QDialogButtonBox, QProgressDialog, QPushButton, QWidget
from sampled import spread
from window_user import Open, User, settle

from core.__main__ import main as command
from core.errors import KindynaError
from core.output.export import Film, files
from core.output.handover import HandoverRequest, web_page
from core.output.report import report
from core.project import load, loads
from core.study import Study
from kindyna_gui import background, dialogs, export_dialogs, inspection
from kindyna_gui import export_dialogs as export_tables
from kindyna_gui.background import progress
from kindyna_gui.cam_dialogs import profile_dialogs, surface_dialog
from kindyna_gui.export_dialogs import FilmDialog, TablesDialog, TablesRequest, ask_animation, ask_tables
from kindyna_gui.pictures.film import Camera, pictures, shoot
from kindyna_gui.places import example

SMALL = Film(".gif", 12, 320, 240, 1.0)
EXPORT = ("File", "Export")
TICK = 10  # milliseconds: what a GIF counts in
LEAST_DELAY = 20  # browsers slow down what is shorter


# -- the menu ---------------------------------------------------------------------------------------------


def test_file_export_offers_everything(user: User) -> None:
    assert user.entries(*EXPORT) == [
        "Tables...",
        "Profile...",
        "Solid and surfaces...",
        "Drawing...",
        "Controller...",
        "Inspection table...",
        "Lift table...",
        "Timing chart...",
        "Report as text...",
        "Hand-over...",
        "Web page...",
        "Picture of the mechanism...",
        "Animation...",
        "Pose of the links...",
    ]
    for name in user.entries(*EXPORT):
        assert user.action(*EXPORT, name).statusTip()


# -- tables and report ------------------------------------------------------------------------------------


@pytest.mark.parametrize("samples", spread([72, 3600], 1))
def test_the_tables_are_the_cores(samples: int, user: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "new" / "tables"
    monkeypatch.setattr(export_tables, "ask_tables", lambda *_: TablesRequest(folder, samples))
    user.session.edit("motion.stroke", 160.0, "a")
    user.choose(*EXPORT, "Tables...")
    wanted = files(Study(user.design, samples))
    assert {path.name: path.read_text("utf-8") for path in folder.iterdir()} == wanted
    assert user.window.status.currentMessage() == f"Wrote {', '.join(wanted)} into {folder}"


def test_tables_that_cannot_be_written_are_told(user: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("", "utf-8")
    monkeypatch.setattr(export_tables, "ask_tables", lambda *_: TablesRequest(tmp_path / "file", 72))
    user.choose(*EXPORT, "Tables...")
    assert [what for what, _ in user.faults] == ["The tables cannot be exported."]


def test_the_report_is_the_cores(user: User, tmp_path: Path) -> None:
    suggested = user.picks("report_to_save", tmp_path / "r.txt")
    user.choose(*EXPORT, "Report as text...")
    assert (tmp_path / "r.txt").read_text("utf-8") == report(Study(user.design))
    assert suggested[0].name == "Transfer_unit__lift_drive.txt"


def test_a_cancelled_dialog_writes_nothing(user: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    user.picks("report_to_save", None)
    user.picks("page_to_save", None)
    user.picks("picture_to_save", None)
    user.picks("links_to_save", None)
    user.picks("timing_to_save", None)
    monkeypatch.setattr(export_tables, "ask_tables", lambda *_: None)
    monkeypatch.setattr(export_tables, "ask_animation", lambda *_: None)
    monkeypatch.setattr(profile_dialogs, "ask_profile", lambda *_: None)
    monkeypatch.setattr(surface_dialog, "ask_surface", lambda *_: None)
    monkeypatch.setattr(profile_dialogs, "ask_drawing", lambda *_: None)
    monkeypatch.setattr(inspection, "ask_inspection", lambda *_: None)
    monkeypatch.setattr(export_dialogs, "ask_handover", lambda *_: None)
    monkeypatch.setattr(export_dialogs, "ask_lift_table", lambda *_: None)
    monkeypatch.setattr(profile_dialogs, "ask_controller_table", lambda *_: None)
    for name in user.entries(*EXPORT):
        user.choose(*EXPORT, name)
    assert list(tmp_path.iterdir()) == []
    assert user.faults == []


@pytest.mark.stress
def test_the_web_page_is_the_cores(user: User, tmp_path: Path) -> None:
    suggested = user.picks("page_to_save", tmp_path / "lift.html")
    user.choose(*EXPORT, "Web page...")
    assert (tmp_path / "lift.html").read_text("utf-8") == web_page(Study(user.design))
    assert suggested[0].name == "Transfer_unit__lift_drive.html"


@pytest.mark.posix("a script in the place of ffmpeg")
def test_frames_go_into_a_folder_and_a_film_by_ffmpeg(
    app: QApplication, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = pictures(LIFT, replace(SMALL, ending=".png"))
    assert made is not None
    assert list(made) == [f"frame_{number:03d}.png" for number in range(SMALL.frames)]
    assert Image.open(BytesIO(made["frame_000.png"])).size == (SMALL.width, SMALL.height)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(KindynaError, match="ffmpeg is not on the PATH"):
        shoot(LIFT, replace(SMALL, ending=".mp4"))
    stand_in = tmp_path / "ffmpeg"  # writes down how many bytes come, into the file that the real one would write
    stand_in.write_text(
        f"#!{sys.executable}\nimport sys\nopen(sys.argv[-1], 'w').write(str(len(sys.stdin.buffer.read())))\n",
        "utf-8",
    )
    stand_in.chmod(0o755)
    assert shoot(LIFT, replace(SMALL, ending=".mp4")) == str(SMALL.frames * SMALL.width * SMALL.height * 3).encode()
    stand_in.write_text(f"#!{sys.executable}\nimport sys\nsys.exit('unknown encoder')\n", "utf-8")
    with pytest.raises(KindynaError, match="unknown encoder"):
        shoot(LIFT, replace(SMALL, ending=".mp4"))


def test_the_hand_over_is_one_archive_of_all_files(
    same_window: Open, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    user = same_window(example("card_picker"))
    monkeypatch.setattr(export_dialogs, "ask_handover", lambda *_: HandoverRequest(controller="codesys-xyva"))
    user.picks("handover_to_save", tmp_path / "lift.zip")
    user.choose(*EXPORT, "Hand-over...")
    with zipfile.ZipFile(tmp_path / "lift.zip") as archive:
        names = set(archive.namelist())
        listed = json.loads(archive.read("contents.json"))
        assert {each["name"] for each in listed["files"]} == names - {"contents.json"}
        assert loads(archive.read("design.toml").decode()) == user.session.full_design
    assert {"report.pdf", "drawing.pdf", "profile.dxf", "inspection.csv", "machine.html", "controller.json"} <= names
    assert user.window.status.currentMessage().startswith(f"Wrote {len(names) - 1} files into")


def test_the_picture_of_the_mechanism(user: User, tmp_path: Path) -> None:
    user.picks("picture_to_save", tmp_path / "m.svg")
    user.choose(*EXPORT, "Picture of the mechanism...")
    assert b"Transfer unit, lift drive" in (tmp_path / "m.svg").read_bytes()


# -- the dialogs ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("way", "button"),
    spread([
        ((*EXPORT, "Profile..."), "Save profile..."), ((*EXPORT, "Drawing..."), "Save drawing..."),
        ((*EXPORT, "Solid and surfaces..."), "Save surfaces..."),
        ((*EXPORT, "Inspection table..."), "Save inspection table..."), ((*EXPORT, "Animation..."), "Save animation..."),
        (("File", "Report..."), "Save report..."),
    ], 2),
)  # fmt: skip
def test_a_button_that_leads_to_a_file_says_that_it_saves(way: tuple[str, ...], button: str, user: User) -> None:
    asked = user.clicks(
        "Cancel", before=lambda dialog: seen.extend(each.text() for each in dialog.findChildren(QPushButton))
    )
    seen: list[str] = []
    user.choose(*way)
    assert len(asked) == 1
    assert button in seen


@contextmanager
def answering(act: Callable[[QWidget], None]) -> Iterator[None]:
    """Act on the dialog that is about to open."""
    seen: list[QWidget] = []

    def look() -> None:
        dialog = QApplication.activeModalWidget()
        if dialog is None:
            QTimer.singleShot(10, look)
        else:
            seen.append(dialog)
            act(dialog)

    QTimer.singleShot(0, look)
    yield
    assert seen, "no dialog opened"


def press(dialog: QWidget, which: QDialogButtonBox.StandardButton) -> None:
    box = dialog.findChild(QDialogButtonBox)
    assert box is not None
    QTest.mouseClick(box.button(which), Qt.MouseButton.LeftButton)


OK, CANCEL = QDialogButtonBox.StandardButton.Ok, QDialogButtonBox.StandardButton.Cancel


def test_folder_and_samples_are_asked(user: User, tmp_path: Path) -> None:
    def act(dialog: QWidget) -> None:
        assert isinstance(dialog, TablesDialog)
        assert dialog.summary.text().startswith("One row every 0.1°.")
        dialog.folder.setText(str(tmp_path))
        dialog.form.show_value("samples", 720)
        assert dialog.summary.text().startswith("One row every 0.5°.")
        press(dialog, OK)

    with answering(act):
        assert ask_tables(user.window, tmp_path / "elsewhere", user.session.study) == TablesRequest(tmp_path, 720)
    with answering(lambda dialog: press(dialog, CANCEL)):
        assert ask_tables(user.window, tmp_path, user.session.study) is None


def test_the_tables_of_a_shaft_are_those_of_all_drives(same_window: Open, tmp_path: Path) -> None:
    user = same_window(example("transfer_unit"))

    def act(dialog: QWidget) -> None:
        assert isinstance(dialog, TablesDialog)
        assert "shaft.csv" in dialog.summary.text()
        press(dialog, OK)

    with answering(act):
        assert ask_tables(user.window, tmp_path, user.session.full_study) == TablesRequest(tmp_path, 3600)


def test_without_a_folder_there_is_no_export(user: User, tmp_path: Path) -> None:
    """Else the tables would go to wherever the program was started."""

    def act(dialog: QWidget) -> None:
        assert isinstance(dialog, TablesDialog)
        export = dialog.findChild(QDialogButtonBox).button(OK)
        assert export.isEnabled()
        dialog.folder.selectAll()
        QTest.keyClick(dialog.folder, Qt.Key.Key_Delete)
        assert not export.isEnabled()
        press(dialog, CANCEL)

    with answering(act):
        assert ask_tables(user.window, tmp_path, user.session.study) is None


def test_frames_size_format_and_time_are_asked(user: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    suggested: list[str] = []

    def pick(parent: QWidget, title: str, suggestion: str, filters: str) -> tuple[str, str]:
        suggested.append(suggestion)
        return str(tmp_path / "film"), filters

    monkeypatch.setattr(export_tables.QFileDialog, "getSaveFileName", pick)

    def act(dialog: QWidget) -> None:
        assert isinstance(dialog, FilmDialog)
        assert dialog.form.boxes["seconds"].number == 3.0
        dialog.form.show_value("ending", ".webp")
        dialog.pixels.setCurrentIndex(0)
        dialog.form.show_value("frames", 36)
        assert dialog.summary.text() == "a frame every 10°, 12 frames per second"
        press(dialog, OK)

    with answering(act):
        wanted = ask_animation(user.window, tmp_path, "lift", 3.0)
    assert suggested == [str(tmp_path / "lift.webp")]
    assert wanted == (tmp_path / "film.webp", Film(".webp", 36, 480, 360, 3.0))
    with answering(lambda dialog: press(dialog, CANCEL)):
        assert ask_animation(user.window, tmp_path, "lift", 3.0) is None


def test_names_get_their_ending(monkeypatch: pytest.MonkeyPatch) -> None:
    for dialog, name, ending in ((dialogs.table_to_save, "a", "a.csv"), (dialogs.report_to_save, "a.b", "a.b.txt")):
        monkeypatch.setattr(dialogs.QFileDialog, "getSaveFileName", lambda *_, name=name: (name, ""))
        assert dialog(None, Path("x")) == Path(ending)  # type: ignore[arg-type]
        monkeypatch.setattr(dialogs.QFileDialog, "getSaveFileName", lambda *_: ("", ""))
        assert dialog(None, Path("x")) is None  # type: ignore[arg-type]


# -- animation --------------------------------------------------------------------------------------------


def test_an_animation_of_one_turn(user: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[float] = []

    def wanted(parent: QWidget, folder: Path, name: str, seconds: float) -> tuple[Path, Film]:
        asked.append(seconds)
        return tmp_path / "film.gif", SMALL

    monkeypatch.setattr(export_tables, "ask_animation", wanted)
    user.choose(*EXPORT, "Animation...")
    assert asked == pytest.approx([3.0]), "20 rpm in true time"
    film = Image.open(BytesIO((tmp_path / "film.gif").read_bytes()))
    assert (film.n_frames, film.size, film.info["loop"]) == (12, (320, 240), 0)
    assert user.window.status.currentMessage() == f"Wrote {tmp_path / 'film.gif'}"


@pytest.mark.stress
def test_the_layers_on_the_screen_are_those_of_the_animation(
    user: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(export_tables, "ask_animation", lambda *_: (tmp_path / "a.gif", SMALL))
    user.choose(*EXPORT, "Animation...")
    view = user.window.view("mechanism")
    assert view is not None
    next(a for a in view.layer_actions() if a.text() == "Labels").trigger()
    monkeypatch.setattr(export_tables, "ask_animation", lambda *_: (tmp_path / "b.gif", SMALL))
    user.choose(*EXPORT, "Animation...")
    assert (tmp_path / "a.gif").read_bytes() == shoot(user.design, SMALL)
    assert (tmp_path / "b.gif").read_bytes() == shoot(user.design, SMALL, {"labels": False})


def test_a_cancelled_animation_writes_nothing(user: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[int] = []

    @contextmanager
    def impatient(parent: QWidget, text: str, steps: int) -> Iterator[Callable[[int], bool]]:
        yield lambda done: (drawn.append(done), done < 3)[1]

    monkeypatch.setattr(background, "progress", impatient)
    monkeypatch.setattr(export_tables, "ask_animation", lambda *_: (tmp_path / "film.gif", SMALL))
    user.choose(*EXPORT, "Animation...")
    assert drawn == [0, 1, 2, 3]
    assert list(tmp_path.iterdir()) == []
    assert "cancelled" in user.window.status.currentMessage()


@pytest.mark.parametrize("ending", spread([".gif", ".webp"], 1))
def test_an_animation_is_given_up_while_it_is_encoded_too(ending: str) -> None:
    """Each frame is encoded before the next is drawn, or the writing asks between its parts."""
    film, looks = Film(ending, 12, 320, 240, 1.0), []

    def go_on(done: int) -> bool:
        looks.append((done, len(drawn)))
        return done < 12 and len(looks) < 30

    drawn: list[int] = []
    taken = Camera.take

    def take(self: Camera, frame: int) -> Image.Image:
        drawn.append(frame)
        return taken(self, frame)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Camera, "take", take)
        made = shoot(LIFT, film, {}, go_on)
    if ending == ".gif":
        assert made is None
        assert looks[-1][0] == 12, "all are drawn, and the writing is given up"
    else:
        assert made is not None
        assert looks == [(n, n) for n in range(12)], "the frame before is encoded when the next is asked about"


def test_tables_are_written_beside_the_window_which_stays_alive_and_can_be_cancelled(
    user: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(export_tables, "ask_tables", lambda *_: TablesRequest(tmp_path / "tables", 200_000))
    ticks: list[bool] = []

    def tick() -> None:
        dialog = user.window.findChild(QProgressDialog)
        if dialog is not None and dialog.isVisible():
            ticks.append(True)
            if len(ticks) == 5:
                QTest.mouseClick(dialog.findChild(QPushButton), Qt.MouseButton.LeftButton)

    timer = QTimer(user.window, interval=10)
    timer.timeout.connect(tick)
    timer.start()
    user.choose(*EXPORT, "Tables...")
    timer.stop()
    assert len(ticks) >= 5, "events run while it computes"
    assert user.window.status.currentMessage() == "The export of the tables was cancelled; nothing is written"
    assert list(tmp_path.iterdir()) == []
    assert user.window.findChild(QProgressDialog) is None or not user.window.findChild(QProgressDialog).isVisible()


def test_the_progress_can_be_cancelled(open_user: Open) -> None:
    user = open_user()
    with progress(user.window, "Drawing", 10) as go_on:
        assert go_on(1)
        dialog = user.window.findChild(QProgressDialog)
        assert dialog is not None
        dialog.cancel()
        assert not go_on(2)
    settle()


def test_an_animation_that_cannot_be_written_is_told(
    user: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(export_tables, "ask_animation", lambda *_: (tmp_path / "nowhere" / "film.gif", SMALL))
    user.choose(*EXPORT, "Animation...")
    assert [what for what, _ in user.faults] == ["film.gif cannot be written."]


@pytest.mark.stress
@pytest.mark.parametrize("ending", [".gif", ".webp"])
def test_the_same_design_gives_the_same_bytes(ending: str) -> None:
    film = Film(ending, 6, 320, 240, 1.0)
    assert shoot(LIFT, film) == shoot(LIFT, film)


def frames(data: bytes) -> list[np.ndarray]:
    film = Image.open(BytesIO(data))
    pictures = []
    for number in range(film.n_frames):
        film.seek(number)
        pictures.append(np.asarray(film.convert("RGB"), dtype=int))
    return pictures


def test_webp_loses_nothing_and_gif_only_shades() -> None:
    design = load(example("card_picker"))
    films = {ending: Film(ending, 6, 400, 300, 1.0) for ending in (".gif", ".webp")}
    camera = Camera(design, films[".gif"], {})
    drawn = [np.asarray(camera.take(i), dtype=int) for i in range(6)]
    for ending, film in films.items():
        data = shoot(design, film)
        assert data is not None
        for seen, wanted in zip(frames(data), drawn, strict=True):
            apart = np.abs(seen - wanted).max(axis=2)
            assert (apart.max() == 0) if ending == ".webp" else (apart.max() < 64 and np.mean(apart > 10) < 2e-3)
            assert seen[150, 3].tolist() == [255, 255, 255], "paper is white"


@pytest.mark.parametrize(("frames", "seconds"), [(12, 1.0), (72, 3.0), (7, 0.5), (360, 0.2), (100, 3.33)])
def test_the_delays_add_up_to_the_turn(frames: int, seconds: float) -> None:
    delays = Film(".gif", frames, 320, 240, seconds).delays
    assert len(delays) == frames
    assert all(delay % TICK == 0 and delay >= LEAST_DELAY for delay in delays)
    assert sum(delays) == pytest.approx(max(1000.0 * seconds, frames * LEAST_DELAY), abs=TICK)
    assert max(delays) - min(delays) <= TICK


# -- lift table of a lobe -----------------------------------------------------------------------------------


def test_the_lift_table_is_that_of_the_command(same_window: Open, tmp_path: Path) -> None:
    user = same_window(example("valve_train"))

    def act(dialog: Any) -> None:
        assert isinstance(dialog, export_dialogs.LiftTableDialog)
        assert dialog.summary.text().startswith(
            "361 rows from −180° to 180° of the cam from the nose, lift_mm up to 9 mm"
        )
        box = dialog.form.boxes["step"]
        box.setFocus()
        box.selectAll()
        QTest.keyClicks(box, "0.7")
        assert "does not divide the turn" in dialog.summary.text()
        assert not dialog.accept_button.isEnabled()
        box.selectAll()
        QTest.keyClicks(box, "0.5")
        unit = dialog.form.boxes["unit"]
        unit.setFocus()
        QTest.keyClick(unit, Qt.Key.Key_End)
        QTest.mouseClick(dialog.copy, Qt.MouseButton.LeftButton)
        QTest.mouseClick(dialog.accept_button, Qt.MouseButton.LeftButton)

    suggested = user.picks("lift_table_to_save", tmp_path / "lobe.csv")
    with answering(act):
        user.choose(*EXPORT, "Lift table...")
    assert suggested[0].name.endswith("_inlet_lobe.csv")
    line = QApplication.clipboard().text().split()
    assert line[:4] == ["kindyna", "--headless", "valve", str(example("valve_train"))]
    assert line[4:-1] == ["--step", "0.5", "--unit", "in", "--drive", "Inlet", "--table"]
    words = [*line[2:-1], str(tmp_path / "command.csv")]
    assert command(words) == 0
    assert (tmp_path / "lobe.csv").read_bytes() == (tmp_path / "command.csv").read_bytes()
