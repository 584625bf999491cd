"""What a newcomer does first, as events of mouse and keyboard on the real window: see the lift turn, change its
stroke, go from task to task to see cam, pressure angle and torque follow, export the profile, undo everything."""

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pytest
from plot_reading import curves
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLineEdit, QMenu, QWidget
from window_user import Open, User, plain, settle, wait_for

from core.design import edited
from core.output.export import files
from core.project import dumps, load
from core.study import Study
from kindyna_gui import dialogs, export_dialogs
from kindyna_gui.export_dialogs import TablesRequest
from kindyna_gui.graph.plots_view import PlotView
from kindyna_gui.places import example

Event = tuple[str, Any]
LEFT = Qt.MouseButton.LeftButton
CONTROL = Qt.KeyboardModifier.ControlModifier

LOAD: tuple[Event, ...] = (("menu", ("File", "Examples", "Transfer lift")),)
TURN: tuple[Event, ...] = (
    ("click", "play"),
    ("until", 20.0),
    ("click", "play"),
    ("key", (Qt.Key.Key_PageDown, Qt.KeyboardModifier.NoModifier)),
)
STROKE: tuple[Event, ...] = (
    ("click", "stroke"),
    ("key", (Qt.Key.Key_A, CONTROL)),
    ("type", "160"),
    ("key", (Qt.Key.Key_Return, Qt.KeyboardModifier.NoModifier)),
)
EXPORT: tuple[Event, ...] = (("menu", ("File", "Export", "Tables...")),)
SAVE: tuple[Event, ...] = (("key", (Qt.Key.Key_S, CONTROL)),)
UNDO: tuple[Event, ...] = (("key", (Qt.Key.Key_Z, CONTROL)),)


@pytest.fixture
def whole(open_user: Open) -> User:
    """Nothing has been done in it before."""
    return open_user(whole=True)


@pytest.fixture
def user(whole: User) -> User:
    return whole


class Replay:
    """Plays events on a window, as Qt would get them from mouse and keyboard."""

    def __init__(self, user: User) -> None:
        self.user = user
        self._play: Mapping[str, Callable[[Any], None]] = MappingProxyType(
            {"menu": self._menu, "click": self._click, "key": self._key, "type": self._type, "until": self._until}
        )

    def __call__(self, events: tuple[Event, ...]) -> None:
        for kind, what in events:
            self._play[kind](what)
            settle()

    def _menu(self, way: tuple[str, ...]) -> None:
        """Click from menu to menu."""
        bar = self.user.window.menuBar()
        place: Any = bar
        for text in way:
            action = next(a for a in place.actions() if plain(a.text()) == text)
            QTest.mouseClick(place, LEFT, pos=place.actionGeometry(action).center())
            settle()
            if isinstance(action.menu(), QMenu):
                place = action.menu()
                wait_for(place.isVisible)

    def _click(self, what: str) -> None:
        places: Mapping[str, Callable[[], QWidget]] = {
            "play": lambda: self.user.window.bar.play,  # type: ignore[attr-defined]
            "stroke": lambda: self.user.number("motion.stroke_mm").lineEdit(),
        }
        widget = places[what]()
        wait_for(lambda: not widget.visibleRegion().isEmpty())
        QTest.mouseClick(widget, LEFT, pos=QPoint(widget.width() // 2, widget.height() // 2))
        if isinstance(widget, QLineEdit):
            wait_for(lambda: QApplication.focusWidget() in (widget, widget.parentWidget()))

    def _key(self, key: tuple[Qt.Key, Qt.KeyboardModifier]) -> None:
        window = self.user.window
        window.activateWindow()  # which a dialog that has gone leaves to the desktop, and here there is none
        wait_for(window.isActiveWindow)
        holder = QApplication.focusWidget()
        QTest.keyClick(holder if holder is not None and holder.window() is window else window, *key)

    def _type(self, text: str) -> None:
        QTest.keyClicks(QApplication.focusWidget(), text)

    def _until(self, angle: float) -> None:
        """Time passes until the cam has turned so far [deg]."""
        wait_for(lambda: self.user.window.player.theta * 57.29578 > angle)


def seen(user: User) -> dict[str, Any]:
    """What the newcomer looks at: the outline of the cam, the values at the cursors, the picture itself."""
    window = user.window
    told: dict[str, Any] = {}
    for key, names in ((Qt.Key.Key_3, ("displacement", "pressure_angle")), (Qt.Key.Key_4, ("torque",))):
        user.press(key, modifier=CONTROL)
        for name in names:
            wait_for(lambda name=name: window.view(name) is not None and window.view(name).up_to_date)
            view = window.view(name)
            assert isinstance(view, PlotView)
            told[name] = (view.plot.readings(), [curve.y.tobytes() for curve in curves(view.plot)])
    user.press(Qt.Key.Key_1, modifier=CONTROL)
    mechanism = window.view("mechanism")
    path = mechanism.scene.item("cam").path()  # type: ignore[union-attr]
    told["cam"] = [(path.elementAt(i).x, path.elementAt(i).y) for i in range(0, path.elementCount(), 50)]
    return told


@pytest.mark.stress
def test_the_first_five_minutes(user: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    play, lift = Replay(user), load(example("transfer_lift"))
    longer = edited(lift, "motion.stroke", 160.0)
    monkeypatch.setattr(export_dialogs, "ask_tables", lambda *_: TablesRequest(tmp_path / "out", 3600))
    monkeypatch.setattr(dialogs, "design_to_save", lambda *_: tmp_path / "mine.toml")

    play(LOAD)
    assert user.design == lift
    play(TURN)
    stands = user.window.player.theta * 57.29578
    assert any(stands == pytest.approx(join, abs=1e-3) for join in (35.0, 76.5, 283.5, 325.0)), (
        "the join after where it stopped"
    )
    QTest.keyClick(user.window, Qt.Key.Key_Right, CONTROL)
    before = seen(user)

    play(STROKE)
    assert user.design == longer
    assert user.steps == ["Change stroke to 160 mm"]
    after = seen(user)
    for name in ("displacement", "pressure_angle", "torque", "cam"):
        assert after[name] != before[name], f"{name} does not follow the stroke"

    play(EXPORT)
    wanted = files(Study(longer))
    assert (tmp_path / "out" / "profile.csv").read_text("utf-8") == wanted["profile.csv"]
    assert {path.name: path.read_text("utf-8") for path in (tmp_path / "out").iterdir()} == wanted

    play(SAVE)
    assert (tmp_path / "mine.toml").read_text("utf-8") == dumps(longer)
    play(UNDO)
    assert user.design == lift
    assert seen(user) == before
    assert user.window.isWindowModified(), "what was saved had the longer stroke"
    play(SAVE)
    assert (tmp_path / "mine.toml").read_text("utf-8") == dumps(lift)
    assert not user.window.isWindowModified()
