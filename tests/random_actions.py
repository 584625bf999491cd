"""What a random user can do to the window, by mouse and keys: each action draws what it does from a generator of its own."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from pathlib import Path
from random import Random
from typing import Any

from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDropEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QDockWidget,
    QLineEdit,
    QMenu,
    QToolBar,
    QWidget,
)
from random_choices import AREAS, CTRL, DRAWING, KEYS, NO, NUMBERS, QUESTIONS, SHIFT, SIZES, K
from random_files import table

from core.design import motion_of
from kindyna_gui.linkage.canvas import Canvas, draggable_joints
from kindyna_gui.motion.diagram import MotionDiagram
from kindyna_gui.window.docks import VIEWS
from kindyna_gui.window.main_window import MainWindow
from kindyna_gui.window.tasks import TASKS


class Actions:
    """The hands of a random user at a window, or at a dialog in front of it."""

    def __init__(self, window: MainWindow, files: Sequence[Path]) -> None:
        self.window, self.files, self.rng = window, files, Random(0)
        self.on_the_way = False  # through menus, to an entry that is known

    def note(self, text: str) -> None:
        """Write an action down before it is done."""
        raise NotImplementedError

    # -- who is there -------------------------------------------------------------------------------------

    def _in_front(self) -> QWidget:
        """The window, or now and then another that is open."""
        others = [
            w
            for w in QApplication.topLevelWidgets()
            if w.isVisible() and w is not self.window and not isinstance(w, QMenu)
        ]
        return self.rng.choice(others) if others and self.rng.random() < 0.15 else self.window

    def _some(self, kind: type | tuple[type, ...], within: QWidget | None = None) -> Any:
        """A widget of a kind that can be seen; None where there is none."""
        top = within or self._in_front()
        kinds = kind if isinstance(kind, tuple) else (kind,)
        found = [
            w for each in kinds for w in top.findChildren(each) if w.isEnabled() and not w.visibleRegion().isEmpty()
        ]
        return self.rng.choice(found) if found else None

    def _place(self, widget: QWidget) -> QPoint:
        box = widget.visibleRegion().boundingRect()
        return box.topLeft() + QPoint(self.rng.randrange(max(1, box.width())), self.rng.randrange(max(1, box.height())))

    def _modifier(self) -> Qt.KeyboardModifier:
        return self.rng.choice((NO, NO, NO, SHIFT, CTRL))

    # -- actions ------------------------------------------------------------------------------------------

    def menu(self) -> None:
        """An entry of the menu bar, by mouse, through all menus on the way; ``Answers`` goes on from there."""
        bar = self.window.menuBar()
        title = self.rng.choice([a for a in bar.actions() if a.isVisible()])
        self.note(f"  menu bar: {title.text()!r}")
        QTest.mouseClick(bar, Qt.MouseButton.LeftButton, pos=bar.actionGeometry(title).center())

    def open_example(self) -> None:
        """A design of another kind, as the menu File has it."""
        self._choose(("File", "Examples"))

    def new_design(self) -> None:
        self._choose(("File", "New by type"))

    def question(self) -> None:
        """What opens a dialog, or changes the mechanism."""
        self._choose(self.rng.choice(QUESTIONS))

    def _choose(self, way: tuple[str, ...]) -> None:
        """An entry of the menu bar; one of those in a menu where the way ends at that. What is greyed stays unchosen."""
        place: Any = self.window.menuBar()
        self.on_the_way = True
        for text in (*way, None):
            entries = [a for a in place.actions() if a.isVisible() and a.isEnabled() and not a.isSeparator()]
            named = [a for a in entries if text is None or a.text().replace("&", "") == text]
            if not named:
                break
            entry = self.rng.choice(named)
            self.note(f"  menu: {entry.text()!r}")
            if entry.menu() is None:
                self.on_the_way = False
                QTest.mouseClick(place, Qt.MouseButton.LeftButton, pos=place.actionGeometry(entry).center())
                break
            QTest.mouseClick(place, Qt.MouseButton.LeftButton, pos=place.actionGeometry(entry).center())
            place = entry.menu()
            for _ in range(20):
                if not place.isVisible():
                    QTest.qWait(5)
        self.on_the_way = False

    def open_file(self) -> None:
        self.note("  Ctrl+O")
        QTest.keyClick(self.window, K.Key_O, CTRL)

    def keys(self) -> None:
        """Some keys on what has the focus."""
        for _ in range(self.rng.randrange(1, 5)):
            key, modifier = self.rng.choice(KEYS)
            self.note(f"  key: {modifier.name} {key.name}")
            QTest.keyClick(QApplication.focusWidget() or self.window, key, modifier)
            QTest.qWait(1)
            if QApplication.activeModalWidget() is not None:  # it has the keys from now on
                return

    def field(self) -> None:
        self._fill(self._some((QLineEdit, QComboBox)))

    def _fill(self, editor: QWidget | None) -> None:
        """Type a value into an editor, good or bad, and leave it in one of several ways."""
        if editor is None:
            return
        name = editor.accessibleName() or editor.objectName() or type(editor.parent()).__name__
        if isinstance(editor, QComboBox) and editor.count() and self.rng.random() < 0.7:
            self.note(f"  choice {name}")
            editor.setFocus()
            QTest.keyClick(editor, self.rng.choice((K.Key_Down, K.Key_Up, K.Key_End, K.Key_Home)))
            QTest.keyClick(editor, K.Key_Return)
            return
        text = self.rng.choice(NUMBERS)
        box = editor.parent()
        value = getattr(box, "value", None) if isinstance(box, QAbstractSpinBox) else None
        if isinstance(value, float) and isfinite(value) and self.rng.random() < 0.5:
            text = f"{value * self.rng.choice((0.5, 0.9, 1.01, 1.1, 2.0)):.4g}"
        end = self.rng.choice((K.Key_Return, K.Key_Return, K.Key_Tab, K.Key_Escape, None))
        self.note(f"  field {name}: {text!r} {end.name if end else ''}")
        editor.setFocus()
        if isinstance(editor, QLineEdit):
            editor.selectAll()
        QTest.keyClicks(editor, text)
        if end is not None:
            QTest.keyClick(QApplication.focusWidget() or editor, end)

    def button(self) -> None:
        """Click a button."""
        self._press(self._some(QAbstractButton))

    def _press(self, button: QAbstractButton | None) -> None:
        if button is not None:
            self.note(f"  button {button.text() or button.toolTip()[:40]!r}")
            QTest.mouseClick(button, Qt.MouseButton.LeftButton, pos=QPoint(button.width() // 2, button.height() // 2))

    def table(self) -> None:
        """A cell of a table: choose, edit, insert, delete."""
        self._in_table(self._some(QAbstractItemView))

    def _in_table(self, table: QAbstractItemView | None) -> None:
        if table is None or table.model() is None:
            return
        place = self._place(table.viewport())
        kind = self.rng.choice(("click", "edit", "edit", "double", "insert", "delete"))
        self.note(f"  {type(table).__name__} {kind} at {place.x()}, {place.y()}")
        QTest.mouseClick(table.viewport(), Qt.MouseButton.LeftButton, self._modifier(), place)
        if kind == "double":
            QTest.mouseDClick(table.viewport(), Qt.MouseButton.LeftButton, NO, place)
        elif kind in ("insert", "delete"):
            QTest.keyClick(table, K.Key_Insert if kind == "insert" else K.Key_Delete)
        elif kind == "edit":
            QTest.keyClick(table, self.rng.choice((K.Key_Return, K.Key_F2)))
            QTest.qWait(5)
            editor = QApplication.focusWidget()
            if editor is not None and table.isAncestorOf(editor):
                text = self.rng.choice(NUMBERS)
                self.note(f"    cell: {text!r}")
                QTest.keyClicks(editor, text)
                QTest.keyClick(
                    QApplication.focusWidget() or editor, self.rng.choice((K.Key_Return, K.Key_Tab, K.Key_Escape))
                )

    def mouse(self) -> None:
        """A click of any kind anywhere."""
        self._click(self._some(QWidget))

    def _click(self, widget: QWidget | None) -> None:
        if widget is None:
            return
        at, modifier = self._place(widget), self._modifier()
        kind = self.rng.choice(("click", "click", "double", "right", "middle"))
        self.note(f"  {kind} on {type(widget).__name__} {widget.objectName()} at {at.x()}, {at.y()} {modifier.name}")
        if kind == "double":
            QTest.mouseDClick(widget, Qt.MouseButton.LeftButton, modifier, at)
        else:
            buttons = {
                "click": Qt.MouseButton.LeftButton,
                "right": Qt.MouseButton.RightButton,
                "middle": Qt.MouseButton.MiddleButton,
            }
            QTest.mouseClick(widget, buttons[kind], modifier, at)

    def drag(self) -> None:
        """From anywhere to anywhere in a widget."""
        widget = self._some(QWidget)
        if widget is not None:
            self._drag(widget, self._place(widget), self._place(widget))

    def drag_join(self) -> None:
        """A join or a segment of the motion diagram."""
        diagram = self._some(MotionDiagram, self.window)
        if diagram is not None:
            box = diagram.viewport().rect()
            start = self._place(diagram.viewport())
            motion = motion_of(self.window.session.design)
            joins = range(len(motion.segments)) if motion is not None and diagram.motion is not None else ()
            is_inside = [p for p in (diagram.position_of_join(j).toPoint() for j in joins) if box.contains(p)]
            self._drag(
                diagram.viewport(), self.rng.choice(is_inside) if is_inside else start, self._place(diagram.viewport())
            )

    def drag_joint(self) -> None:
        """A joint of the mechanism."""
        canvas = self._some(Canvas, self.window)
        if canvas is not None:
            places = [
                canvas.viewportTransform().map(QPointF(z.real, z.imag)).toPoint()
                for z in draggable_joints(canvas.scene()).values()
            ]
            is_inside = [p for p in places if canvas.viewport().rect().contains(p)]
            start = self.rng.choice(is_inside) if is_inside else self._place(canvas.viewport())
            self._drag(
                canvas.viewport(), start, start + QPoint(self.rng.randrange(-80, 81), self.rng.randrange(-80, 81))
            )

    def _drag(self, widget: QWidget, start: QPoint, end: QPoint) -> None:
        button = self.rng.choice((Qt.MouseButton.LeftButton, Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton))
        modifier = self._modifier()
        self.note(
            f"  drag in {type(widget).__name__} {widget.objectName()}, {type(widget.parent()).__name__}: "
            f"{start.x()}, {start.y()} to {end.x()}, {end.y()} {button.name} {modifier.name}"
        )
        QTest.mousePress(widget, button, modifier, start)
        for part in (0.1, 0.4, 0.7, 1.0):
            QTest.mouseMove(widget, start + (end - start) * part)
            QTest.qWait(1)
        if self.rng.random() < 0.1:
            QTest.keyClick(QApplication.focusWidget() or self.window, self.rng.choice((K.Key_Escape, K.Key_Z)), CTRL)
        QTest.mouseRelease(widget, button, modifier, end)

    def wheel(self) -> None:
        self._wheel(self._some((Canvas, QAbstractItemView, QAbstractSpinBox, QComboBox, QWidget)))

    def _wheel(self, widget: QWidget | None) -> None:
        if widget is None:
            return
        at, turned = QPointF(self._place(widget)), self.rng.choice((-1200, -120, 120, 120, 1200))
        self.note(f"  wheel {turned} on {type(widget).__name__} {widget.objectName()}")
        event = QWheelEvent(
            at,
            QPointF(widget.mapToGlobal(at)),
            QPoint(),
            QPoint(0, turned),
            Qt.MouseButton.NoButton,
            self._modifier(),
            Qt.ScrollPhase.NoScrollPhase,
            False,
        )
        QApplication.sendEvent(widget, event)

    def undo_redo(self) -> None:
        """There and back on the undo stack."""
        steps = "".join(self.rng.choice("ZZY") for _ in range(self.rng.randrange(1, 9)))
        self.note(f"  Ctrl+ {steps}")
        for step in steps:
            QTest.keyClick(QApplication.focusWidget() or self.window, K.Key_Z if step == "Z" else K.Key_Y, CTRL)
            QTest.qWait(1)

    def resize(self) -> None:
        size = self.rng.choice(SIZES)
        self.note(f"  size {size}")
        self.window.resize(*size)

    def dock(self) -> None:
        """Show, hide, float, tab or move a dock."""
        docks = self.window.findChildren(QDockWidget)
        dock, other = self.rng.sample(docks, 2)
        kind = self.rng.choice(("toggle", "toggle", "raise", "float", "tab", "move"))
        self.note(f"  {kind} {dock.windowTitle()!r} {other.windowTitle()!r}")
        if kind == "toggle":
            dock.toggleViewAction().trigger()
        elif kind == "float":
            dock.setFloating(not dock.isFloating())
        elif kind == "tab":
            self.window.tabifyDockWidget(dock, other)
        elif kind == "move":
            self.window.addDockWidget(self.rng.choice(AREAS), dock)
        else:
            dock.show()
            dock.raise_()

    def play(self) -> None:
        self.window.player.play(not self.window.player.playing)
        QTest.qWait(self.rng.randrange(20, 150))

    def view(self) -> None:
        """Bring one of the views to the front."""
        name = self.rng.choice(list(VIEWS))
        self.note(f"  {name}")
        self.window.show_view(name)

    def curves(self) -> None:
        """The page of curves: files of any kind dropped there, which change and vanish, rows, forms, and a hand at the graph."""
        page = self.window.show_view("curves")
        for _ in range(self.rng.randrange(1, 9)):
            kind = self.rng.choice(
                ("drop", "change", "form", "form", "button", "rows", "drag", "drag", "click", "wheel", "keys", "tab")
            )
            self.note(f"  curves: {kind}")
            graph = page.plot.viewport()
            if not graph.isVisible() or QApplication.activeModalWidget() or QApplication.activePopupWidget():
                return  # what has opened is answered first
            if kind == "drop":
                self._drop(page, self.rng.sample(list(self.files), self.rng.randrange(1, 3)))
            elif kind == "change":
                self._change(self.rng.choice([path for path in self.files if path.suffix == ".csv"]))
            elif kind == "form":
                self._fill(self._some((QLineEdit, QComboBox), page))
            elif kind == "button":
                self._press(self._some(QAbstractButton, page))
            elif kind == "rows":
                self._in_table(page.rows.list)
            elif kind == "drag":
                self._drag(graph, self._place(graph), self._place(graph))
            elif kind == "click":
                self._click(graph)
            elif kind == "wheel":
                self._wheel(graph)
            elif kind == "keys":
                QTest.keyClick(page.plot, self.rng.choice((K.Key_Left, K.Key_Right, K.Key_Backspace, K.Key_Escape)), NO)
            else:
                page.tabs.setCurrentIndex(self.rng.randrange(2))
            QTest.qWait(self.rng.choice((1, 1, 120)))

    def draw(self) -> None:
        """Draw a linkage, the one at hand or on an empty sheet: tools, pulls between pins, numbers, deeds, menus, undo."""
        view: Any = self.window.show_view("mechanism")
        if not view.draws:
            self._choose(
                ("File", "New by type", "Linkage by drawing") if self.rng.random() < 0.5 else ("Compo", "Draw")
            )
        for _ in range(self.rng.randrange(4, 16)):
            QTest.qWait(1)
            if not view.draws or QApplication.activeModalWidget() or QApplication.activePopupWidget():
                return  # of another kind, or what has opened is answered first
            paper, picture = view.canvas.viewport(), view.drawing.sketch
            pins = [
                p for p in (picture.to(at).toPoint() for at in picture.positions.values()) if paper.rect().contains(p)
            ]
            one, other = (
                self.rng.choice(pins) if pins and self.rng.random() < 0.6 else self._place(paper) for _ in range(2)
            )
            kind = self.rng.choice(("key", "key", "drag", "drag", "click", "menu", "type"))
            self.note(f"  draw: {kind} at {one.x()}, {one.y()}")
            if kind == "key":
                key, modifier = self.rng.choice(DRAWING)
                self.note(f"    {modifier.name} {key.name}")
                QTest.keyClick(QApplication.focusWidget() or view.canvas, key, modifier)
            elif kind == "drag":
                self._drag(paper, one, other)
            elif kind == "menu":
                entries = [a for a in view.drawing.menu_at(QPointF(one)).actions() if a.isEnabled() and a.text()]
                entry = self.rng.choice(entries)
                self.note(f"    {entry.text()!r}")
                entry.trigger()
            else:
                QTest.mouseClick(paper, Qt.MouseButton.LeftButton, self._modifier(), one)
                if kind == "type":
                    for text, end in ((self.rng.choice(NUMBERS), K.Key_Tab), (self.rng.choice(NUMBERS), K.Key_Return)):
                        QTest.keyClicks(QApplication.focusWidget() or view.canvas, text)
                        QTest.keyClick(QApplication.focusWidget() or view.canvas, end)

    def _drop(self, widget: QWidget, paths: Sequence[Path]) -> None:
        self.note(f"    {', '.join(path.name for path in paths)}")
        data = QMimeData()
        data.setUrls([QUrl.fromLocalFile(str(path)) for path in paths])
        buttons = Qt.MouseButton.LeftButton
        QApplication.sendEvent(widget, QDropEvent(QPointF(5.0, 5.0), Qt.DropAction.CopyAction, data, buttons, NO))

    def _change(self, path: Path) -> None:
        """Another table in its place, or none."""
        if path.exists() and self.rng.random() < 0.3:
            path.unlink()
        else:
            path.write_bytes(table(self.rng))

    def task(self) -> None:
        """Another task, by its button or its keys, there and back again; now and then in its first layout."""
        for _ in range(self.rng.randrange(1, 4)):
            number, name = self.rng.choice(list(enumerate(TASKS)))
            kind = self.rng.choice(("button", "keys", "keys"))
            self.note(f"  {name} by {kind}")
            if kind == "button":
                bar = self.window.findChild(QToolBar, "tasks")
                button = bar.widgetForAction(bar.actions()[number])
                QTest.mouseClick(button, Qt.MouseButton.LeftButton)
            else:
                QTest.keyClick(QApplication.focusWidget() or self.window, K(K.Key_1 + number), CTRL)
            QTest.qWait(self.rng.choice((0, 1, 20)))
        if self.rng.random() < 0.1:
            self.note("  Reset layout")
            self.window.reset_layout()

    def in_dialog(self, dialog: QWidget, rng: Random) -> None:
        """One action on the widgets of a dialog."""
        self.rng = rng
        editor, table, button = (
            self._some(kind, dialog) for kind in ((QLineEdit, QComboBox), QAbstractItemView, QAbstractButton)
        )
        kind = self.rng.randrange(6)
        if kind <= 2 and editor is not None:
            self._fill(editor)
        elif kind == 3 and table is not None:
            self._in_table(table)
        elif kind == 4:
            self._click(self._some(QWidget, dialog))
        elif button is not None:
            self.note(f"  button {button.text()!r}")
            QTest.mouseClick(button, Qt.MouseButton.LeftButton, pos=QPoint(button.width() // 2, button.height() // 2))


__all__ = ["Actions"]
