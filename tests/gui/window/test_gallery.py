"""Mechanisms chosen by their pictures, and the way from such a picture to a cam."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import QSize, Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel, QWidget
from sampled import spread
from window_user import Open, User, settle

from core.design import LAYOUTS, faults
from core.output.export import files
from core.project import load
from core.study import Study, findings_of
from kindyna_gui.export_dialogs import TablesDialog
from kindyna_gui.motion.segments_table import RISE
from kindyna_gui.places import example
from kindyna_gui.window import gallery

FACES = ["Roller", "Flat face", "Knife edge", "Curved shoe"]
FORMS = ["Groove", "Conjugate pair"]

# -- chosen by picture ------------------------------------------------------------------------------------


@pytest.fixture
def open_user(same_window: Open) -> Open:
    return same_window


@pytest.mark.parametrize(
    "title",
    spread(
        [
            "Translating follower",
            "Oscillating follower",
            "Cam-driven slider",
            "Valve rocker",
            "Pushrod train",
            "Barrel cam",
            "Globoidal cam",
            "Linkages",
        ],
        1,
    ),
)
def test_the_gallery_has_every_follower_with_every_face_and_form_and_the_linkages_as_pictures(
    user: User, title: str
) -> None:
    dialog = gallery.Gallery(user.window)
    dialog.show()
    assert {group: [choice.name for choice in pictures.choices] for group, pictures in dialog.groups.items()} == {
        "Cam-driven slider": [*(f"Layout {letter}" for letter in LAYOUTS), "Knife edge", "Curved shoe", *FORMS],
        "Translating follower": [*FACES, *FORMS],
        "Oscillating follower": [*FACES, *FORMS],
        "Valve rocker": ["Roller", "Curved shoe", *FORMS],
        "Pushrod train": [*FACES, *FORMS],
        "Barrel cam": ["Slide in a groove", "Slide on a rib", "Arm in a groove", "Indexing turret"],
        "Globoidal cam": ["Indexing turret", "Arm in a groove"],
        "Linkages": [choice.name for choice in gallery.presets()],
    }
    dialog.show_group(title)
    pictures = dialog.groups[title]
    while pictures.paint_next():
        pass
    seen = set()
    for row in range(pictures.count()):
        image = pictures.item(row).icon().pixmap(pictures.iconSize()).toImage()
        colours = {image.pixel(x, y) for x in range(0, image.width(), 3) for y in range(0, image.height(), 3)}
        assert len(colours) > 5, pictures.item(row).text()
        seen.add(bytes(image.constBits()))
    assert len(seen) == pictures.count()
    dialog.close()
    dialog.deleteLater()


@pytest.mark.parametrize(
    "choice", spread([each for _, choices in gallery.kinds() for each in choices], 2), ids=lambda each: each.step_name
)
def test_each_picture_of_a_follower_begins_a_design_without_faults_or_findings(choice: gallery.GalleryChoice) -> None:
    design = choice.design()
    assert faults(design) == []
    assert [f for f in findings_of(Study(design, 180)) if f.severity != "note"] == []
    if not choice.name.startswith("Layout"):
        assert [segment.span_deg for segment in design.drive.motion.segments] == [120.0, 60.0, 120.0, 60.0]


@pytest.mark.parametrize(
    "choice",
    spread([each for _, choices in gallery.in_space() for each in choices], 3),
    ids=lambda each: each.step_name,
)
def test_each_picture_of_a_cam_in_space_begins_a_design_without_faults_or_findings(
    choice: gallery.GalleryChoice,
) -> None:
    design = choice.design()
    assert faults(design) == []
    assert findings_of(Study(design, 720)) == ()
    assert design.drive.label == choice.title.partition(",")[0]
    own = load(example("tappet_flat")).drive.motion
    kept = choice.with_motion(own).drive.motion
    assert (len(kept.segments) == len(own.segments)) == choice.keeps_motion


def test_a_rib_of_a_slide_begins_with_a_distance_of_its_rollers_that_is_assumed() -> None:
    rib = next(c for _, choices in gallery.in_space() for c in choices if c.name == "Slide on a rib").design()
    assert rib.drive.cam.form.roller_distance_mm == 3.0 * rib.drive.cam.roller_radius_mm
    assert "cam.roller_distance_mm" in rib.assumed


def test_the_motion_that_is_there_goes_on_under_another_follower_as_far_as_it_suits() -> None:
    own = load(example("tappet_flat")).drive.motion
    by_name = {choice.step_name: choice for _, choices in gallery.kinds() for choice in choices}
    assert by_name["Translating follower, knife edge"].with_motion(own).drive.motion == own
    swung = by_name["Oscillating follower, curved shoe"].with_motion(own).drive.motion
    assert [(s.span_deg, s.curve) for s in swung.segments] == [(s.span_deg, s.curve) for s in own.segments]
    assert (swung.unit, [s.rise for s in swung.segments]) == ("deg", [0.0, 18.0, -18.0])


@pytest.mark.parametrize("letter", LAYOUTS)
def test_the_roller_of_each_layout_stays_on_the_cam(letter: str) -> None:
    assert Study(gallery.layout_design(letter), 720).dynamics.contact.min() > 0.0


@pytest.mark.stress
def test_whatever_is_chosen_begins_and_undo_brings_the_design_before_back(
    open_user: Open, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Followers and linkages, from the lift; nothing is to be saved on either side."""
    user = open_user()
    before, window = user.design, user.window
    for choice in [each for _, choices in gallery.groups() for each in choices][::3]:
        monkeypatch.setattr(gallery, "ask_mechanism", lambda parent, choice=choice: choice)
        user.choose("Compo", "Choose a mechanism...")
        assert user.design == choice.with_motion(before.drive.motion), choice.name
        assert user.session.path is None
        assert not user.session.modified
        view = window.view("mechanism")
        assert view is not None
        assert not view.in_trouble
        assert view.canvas.visible.contains(view.scene.least_rect()), "the whole of it is in sight"  # type: ignore[attr-defined]
        name = f"Undo Begin with {choice.step_name}" if user.design != before else ""
        if name:
            user.choose("Edit", name)
        assert user.design == before
        assert not user.session.modified
    assert user.faults == []


def test_a_file_comes_back_with_its_name(open_user: Open, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "own.toml"
    path.write_bytes(example("four_bar").read_bytes())
    user = open_user(path)
    choice = next(c for c in gallery.presets() if c.name == "Watt six bar")
    monkeypatch.setattr(gallery, "ask_mechanism", lambda parent: choice)
    user.choose("Compo", "Choose a mechanism...")
    assert "own.toml" not in user.window.windowTitle()
    user.choose("Edit", "Undo Begin with Watt six bar")
    assert user.session.path == path
    assert "own.toml" in user.window.windowTitle()
    assert not user.window.isWindowModified()
    user.choose("Edit", "Redo Begin with Watt six bar")
    assert user.session.path is None


@pytest.mark.stress
@pytest.mark.parametrize("room", [QSize(1420, 860), QSize(1260, 680)])
def test_all_pictures_of_a_group_are_seen_at_once(room: QSize, user: User) -> None:
    dialog = gallery.Gallery(user.window, room)
    dialog.show()
    settle()
    assert dialog.width() <= room.width()
    assert dialog.height() <= room.height()
    for title, pictures in dialog.groups.items():
        dialog.show_group(title)
        settle()
        for row in range(pictures.count()):
            seen = pictures.visualItemRect(pictures.item(row))
            assert pictures.viewport().rect().contains(seen), pictures.item(row).text()
    dialog.close()
    dialog.deleteLater()


def test_a_new_motion_begins_with_its_rise_or_with_its_dwell_where_it_is_not_that_of_the_picture(user: User) -> None:
    dialog = gallery.Gallery(user.window, asks_order=True)
    dialog.show()
    dialog.orders[gallery.DWELL].click()
    for title, caption, spans in (
        ("Oscillating follower", "Roller", [60.0, 120.0, 60.0, 120.0]),
        ("Cam-driven slider", "Layout b", [35.0, 41.5, 207.0, 41.5, 35.0]),
    ):
        dialog.show_group(title)
        pictures = dialog.groups[title]
        pictures.setCurrentRow(next(i for i in range(pictures.count()) if pictures.item(i).text() == caption))
        assert dialog.choice is not None
        design = dialog.choice.with_motion(None)
        assert [segment.span_deg for segment in design.drive.motion.segments] == spans
        assert dialog.orders[gallery.DWELL].isEnabled() == (caption == "Roller")
        assert faults(design) == []
    dialog.close()
    dialog.deleteLater()


# -- from a picture to a cam that can be cut --------------------------------------------------------------


@contextmanager
def answering(kind: type, act: Callable[[Any], None]) -> Iterator[None]:
    """Do something to the next dialog of a kind that opens."""
    seen: list[QWidget] = []
    parents: list[QWidget] = []

    def look() -> None:
        dialog = QApplication.activeModalWidget()
        if not isinstance(dialog, kind):
            QTimer.singleShot(5, look)
            return
        seen.append(dialog)
        parents.append(dialog.parentWidget().window())
        act(dialog)

    QTimer.singleShot(0, look)
    yield
    assert seen, "no dialog opened"
    window = parents[0]
    window.activateWindow()  # which a desktop does by itself
    assert QTest.qWaitForWindowActive(window)


@pytest.mark.stress
def test_from_the_picture_of_a_four_bar_to_the_cam_under_its_coupler(open_user: Open, tmp_path: Path) -> None:
    """Choose, edit a length, let a link follow a motion, put the roller on the coupler, edit the motion, turn, export: the
    profile in the file is the core's to the byte. All by mouse, menus and keys."""
    user = open_user()

    def choose(dialog: gallery.Gallery) -> None:
        names, pictures = dialog.names, dialog.groups["Linkages"]
        at = names.visualItemRect(names.item(names.count() - 1)).center()
        QTest.mouseClick(names.viewport(), Qt.MouseButton.LeftButton, pos=at)
        row = next(i for i in range(pictures.count()) if pictures.item(i).text() == "Four bar")
        at = pictures.visualItemRect(pictures.item(row)).center()
        QTest.mouseClick(pictures.viewport(), Qt.MouseButton.LeftButton, pos=at)
        QTest.keyClick(pictures, Qt.Key.Key_Return)

    with answering(gallery.Gallery, choose):
        user.press(Qt.Key.Key_N, modifier=Qt.KeyboardModifier.ControlModifier)
    assert user.design == load(example("four_bar"))

    def leave(dialog: gallery.Gallery) -> None:
        assert dialog.shown is dialog.groups["Linkages"], "where the design at hand belongs"
        dialog.reject()

    with answering(gallery.Gallery, leave):
        user.choose("Compo", "Choose a mechanism...")
    user.enter("linkage.links[2].points.C.y_mm", "60")
    user.choose("Compo", "Driver", "Link 2 follows a motion")
    user.choose("Compo", "Cam roller", "C on link 3")
    user.enter_cell(1, RISE, "20")
    user.enter("cam.roller_radius_mm", "9")
    assert user.steps == [
        "Begin with Four bar",
        "Change C y to 60 mm",
        "Drive link 2 by a motion",
        "Put the cam roller on C of link 3",
        "Change rise of segment 2 to 20°",
        "Change roller radius Rr to 9 mm",
    ]
    view = user.window.view("mechanism")
    assert view is not None
    view.pull()
    scene = view.scene  # type: ignore[attr-defined]
    turns = []
    user.choose("Kine", "Play")
    for _ in range(3):
        user.window.player.advance(0.1)
        settle()
        turns.append(scene.item("cam").rotation())
        touch = user.session.at(user.window.player.theta).linkage
        roller = scene.item("roller").pos()
        assert complex(roller.x(), roller.y()) == pytest.approx(touch.follower.z[0, 0] * 1e3, abs=0.5)
    user.choose("Kine", "Play")
    assert len(set(turns)) == 3, "the cam turns"

    def export(dialog: TablesDialog) -> None:
        told = " ".join(label.text() for label in dialog.findChildren(QLabel))
        for name in ("profile.csv", "kinematics.csv", "linkage.csv", "dynamics.csv", "summary.json"):
            assert name in told
        assert "Driver angles per turn" in told
        dialog.folder.setText(str(tmp_path))
        dialog.form.show_value("samples", 180)
        QTest.keyClick(dialog.folder, Qt.Key.Key_Return)

    with answering(TablesDialog, export):
        user.choose("File", "Export", "Tables...")
    wanted = files(Study(user.design, 180))
    assert {path.name for path in tmp_path.iterdir()} == set(wanted) >= {"profile.csv", "linkage.csv"}
    for name, text in wanted.items():
        assert (tmp_path / name).read_bytes() == text.encode(), name
    assert user.faults == []
