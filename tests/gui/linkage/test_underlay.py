"""A picture under the drawing: scaled and turned by the mouse, kept beside the design, and drawn upon."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import ezdxf
import pytest
from folders import content
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QColor, QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QCheckBox, QToolButton
from window_user import Open, User, pixel, settle

from core.__main__ import main
from core.contour.underlay import Underlay, read_underlay, save_underlay, snap_points
from core.errors import FileError, KindynaError
from core.project import load, save
from kindyna_gui import dialogs
from kindyna_gui.places import example


def bracket(path: Path) -> Path:
    """In inches: a line and a polyline with a bow, and, in a block that is turned, a hole; one layer is off."""
    drawing = ezdxf.new("R2010")
    drawing.header["$INSUNITS"] = 1
    hole = drawing.blocks.new("HOLE")
    hole.add_circle((1.0, 2.0), 0.25)
    space = drawing.modelspace()
    space.add_blockref("HOLE", (10.0, 0.0), dxfattribs={"rotation": 90.0})
    space.add_lwpolyline(
        [(0.0, 0.0, 0.0, 0.0, 0.0), (4.0, 0.0, 0.0, 0.0, 1.0), (4.0, 2.0, 0.0, 0.0, 0.0)], format="xyseb"
    )
    drawing.layers.add("AUX").off()
    space.add_line((50.0, 50.0), (60.0, 60.0), dxfattribs={"layer": "AUX"})
    drawing.saveas(path)
    return path


def near(points: Sequence[complex], wanted: Sequence[complex]) -> bool:
    """The same places, in any order, each once."""
    return len(points) == len(wanted) and all(min(abs(z - other) for z in points) < 1e-9 for other in wanted)


def test_corners_and_centres_of_a_dxf_in_the_plane_of_the_linkage(tmp_path: Path) -> None:
    """Corner (4, 2) in inch, the bow's centre (4, 1), the hole's at 10 + i(1 + 2i); under a place, a scale and an angle typed."""
    underlay = Underlay(bracket(tmp_path / "b.dxf"), 7.0, -3.0, 25.4, 30.0)
    put = lambda z: 7.0 - 3.0j + 25.4 * cmath.exp(1j * math.pi / 6.0) * z  # noqa: E731
    corners, centres = snap_points(underlay)
    assert near(corners, [put(0.0), put(4.0), put(4.0 + 2.0j)])
    assert near(centres, [put(4.0 + 1.0j), put(8.0 + 1.0j)])
    longer = underlay.scaled(put(0.0), put(4.0), 200.0)
    assert longer.scale_mm_per_unit == pytest.approx(50.0)
    assert longer.to_plane(0.0) == pytest.approx(put(0.0))
    level = longer.rotated(put(0.0), longer.to_plane(4.0), 0.0)
    assert level.to_plane(4.0) == pytest.approx(put(0.0) + 200.0)
    with pytest.raises(KindynaError, match="above 0"):
        underlay.scaled(put(0.0), put(0.0), 10.0)


def test_a_placement_is_kept_beside_the_design_and_a_wrong_one_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    design = tmp_path / "four.toml"
    design.write_bytes(example("four_bar").read_bytes())
    placed = Underlay(bracket(tmp_path / "b.dxf"), 1.5, 2.0, 25.4, -12.5, 0.3, True)
    save_underlay(design, placed)
    assert read_underlay(design) == placed
    assert 'file = "b.dxf"' in (tmp_path / "four.underlay.toml").read_text("utf-8")
    out = tmp_path / "pose.dxf"
    assert main(["pose", str(design), "--angle", "30", "--underlay", "--out", str(out)]) == 0
    lines = ezdxf.readfile(out).modelspace().query('LWPOLYLINE[layer=="UNDERLAY"]')
    ends = [complex(*line.get_points("xy")[0]) for line in lines]
    assert any(abs(end - placed.to_plane(4.0)) < 1e-9 for end in ends)
    (tmp_path / "b.dxf").unlink()
    assert main(["pose", str(design), "--angle", "30", "--underlay", "--out", str(out)]) == 0
    assert "underlay: left out" in capsys.readouterr().err
    for text, why in (("opacity = 2.0", "opacity: 2.0"), ("colour = 1", "colour: unknown")):
        (tmp_path / "four.underlay.toml").write_text(f'file = "b.dxf"\n{text}\n', "utf-8")
        with pytest.raises(FileError, match=why):
            read_underlay(design)


@pytest.mark.posix("links")
@pytest.mark.parametrize("what", ["of the user", "a link", "a link to nothing", "a folder", "written by hand"])
def test_a_file_in_the_place_of_a_placement_that_the_window_has_not_written_stays(tmp_path: Path, what: str) -> None:
    design, path = tmp_path / "four.toml", tmp_path / "four.underlay.toml"
    placed = Underlay(bracket(tmp_path / "b.dxf"), 1.5, 2.0)
    if what == "a folder":
        path.mkdir()
    elif what.startswith("a link"):
        (tmp_path / "notes.toml").write_text('file = "b.dxf"\n' if what == "a link" else "mine", "utf-8")
        path.symlink_to("notes.toml" if what == "a link" else "nowhere")
    else:
        path.write_text('# mine\nfile = "b.dxf"\n' if what == "written by hand" else "mine", "utf-8")
    before = content(tmp_path)
    for underlay in (None, *([] if what == "written by hand" else [placed])):
        with suppress(FileError):
            save_underlay(design, underlay)
        assert content(tmp_path) == before
    if what == "written by hand":  # it was read as a placement, and is placed otherwise
        save_underlay(design, placed)
        assert read_underlay(design) == placed
        save_underlay(design, None)
        assert not path.exists()


class Tracer:
    """Who lays a picture under a drawing."""

    def __init__(self, user: User, picture: Path, patch: pytest.MonkeyPatch) -> None:
        self.user = user
        patch.setattr(dialogs, "file_to_open", lambda *_: picture)
        user.choose("Compo", "Underlay...")

    @property
    def view(self):  # type: ignore[no-untyped-def]
        return self.user.drawing()

    @property
    def underlay(self) -> Underlay:
        return self.view.underlay.underlay

    @property
    def panel(self):  # type: ignore[no-untyped-def]
        return next(w for w in QApplication.topLevelWidgets() if w.windowTitle() == "Underlay" and w.isVisible())

    def press(self, text: str) -> None:
        button = next(b for b in self.panel.findChildren(QToolButton) if b.text().replace("&", "") == text)
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)
        settle()

    def click(self, at: complex, off: QPoint | None = None) -> None:
        canvas = self.view.canvas
        QTest.mouseClick(
            canvas.viewport(), Qt.MouseButton.LeftButton, pos=pixel(canvas, at) + (QPoint() if off is None else off)
        )
        settle()

    def type(self, text: str) -> None:
        QTest.keyClicks(QApplication.focusWidget(), text)
        QTest.keyClick(QApplication.focusWidget(), Qt.Key.Key_Return)
        settle()


def test_a_dxf_is_scaled_by_two_clicks_moved_locked_and_drawn_upon(
    open_user: Open, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    user = open_user(whole=False, size=(1280, 1000))
    user.choose("File", "New by type", "Linkage by drawing")
    tracer = Tracer(user, bracket(tmp_path / "b.dxf"), monkeypatch)
    steps = user.steps
    assert tracer.underlay.scale_mm_per_unit == 25.4
    tracer.press("Scale")
    tracer.click(tracer.underlay.to_plane(0.0), QPoint(5, -4))  # beside the corner: it snaps
    tracer.click(tracer.underlay.to_plane(4.0), QPoint(-3, 6))
    tracer.type("80")
    assert tracer.underlay.scale_mm_per_unit == pytest.approx(20.0, abs=1e-12)
    tracer.press("Move")
    canvas = tracer.view.canvas
    one, other = pixel(canvas, 10.0 + 5.0j), pixel(canvas, -15.0 + 5.0j)
    QTest.mousePress(canvas.viewport(), Qt.MouseButton.LeftButton, pos=one)
    QTest.mouseMove(canvas.viewport(), other)
    QTest.mouseRelease(canvas.viewport(), Qt.MouseButton.LeftButton, pos=other)
    settle()
    assert tracer.underlay.x_mm == pytest.approx(-25.0, abs=1.0 / canvas.scale_now)
    box = tracer.panel.findChild(QCheckBox)
    box.click()
    assert tracer.underlay.locked
    assert not any(b.isEnabled() for b in tracer.panel.findChildren(QToolButton))
    tracer.panel.close()
    user.drawing().draw(True, "ground")  # a fixed pivot set beside the bow's centre stands on it
    tracer.click(tracer.underlay.to_plane(4.0 + 1.0j), QPoint(6, 5))
    assert user.drawing().drawing.layout[1]["O1"] == pytest.approx(tracer.underlay.to_plane(4.0 + 1.0j), abs=1e-9)
    assert len(user.steps) == len(steps) + 1  # the pivot alone is a step of the design
    kept = tmp_path / "mine.toml"
    user.session.save(kept)
    again = read_underlay(kept)
    assert again == tracer.underlay
    user.session.save(tmp_path / "other.toml")
    assert read_underlay(tmp_path / "other.toml") == again


def test_a_design_brings_its_picture_and_a_missing_one_is_a_note(open_user: Open, tmp_path: Path) -> None:
    picture = QImage(100, 50, QImage.Format.Format_RGB32)
    picture.fill(QColor("#C00000"))
    for i in range(100 * 25):
        picture.setPixelColor(i % 100, 25 + i // 100, QColor("#0000C0"))
    assert picture.save(str(tmp_path / "red.png"))
    design = tmp_path / "four.toml"
    save(load(example("four_bar")), design)
    save_underlay(design, Underlay(tmp_path / "red.png", -1000.0, -1000.0, 40.0, 0.0, 1.0))
    user = open_user(whole=False, path=design)
    view = user.drawing()
    view.pull()
    canvas = view.canvas
    image = canvas.grab().toImage()
    for y in (5.0, -5.0):  # the upper half is red
        at = canvas.viewportTransform().map(QPointF(canvas.visible.left() + 5.0, y)).toPoint()
        colour = image.pixelColor(at * image.devicePixelRatio())
        assert (colour.red() > 100, colour.blue() > 100) == (y > 0.0, y < 0.0)
    (tmp_path / "red.png").unlink()
    view.underlay.put(view.underlay.underlay.shifted(1.0), save=False)
    user.session.save(tmp_path / "next.toml")
    user = open_user(whole=False, path=tmp_path / "next.toml")
    user.drawing().pull()
    settle()
    assert "red.png" in user.drawing().note.text()
