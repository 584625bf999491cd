"""Palette, style sheets."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QBuffer, QByteArray, QEvent, QObject, QPoint, QPointF, QRect, QRectF, QSize, Qt
from PySide6.QtGui import (
    QColor,
    QFont,
    QIcon,
    QImageReader,
    QPainter,
    QPainterPath,
    QPaintEvent,
    QPalette,
    QPen,
    QPixmap,
    QResizeEvent,
)
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractSlider,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QMenu,
    QMenuBar,
    QPushButton,
    QTabBar,
    QToolBar,
    QToolButton,
    QWidget,
)
from shiboken6 import isValid

from core.findings import ERROR, NOTE, WARNING
from kindyna_gui import settings
from kindyna_gui.pictures.style import DARK, LIGHT, SCREEN, Theme, cached_by_theme, draw_in
from kindyna_gui.places import icon_file
from kindyna_gui.requirements import suggestions_for
from kindyna_gui.settings import DISPLAY, choose_font_scale, in_file_units

# -- look ------------------------------------------------------------------------------------------------

ICON_SCALES = (1, 2, 3)  # dots per pixel that icons are made for

_ROLES = {
    QPalette.ColorRole.Window: "desk",
    QPalette.ColorRole.WindowText: "ink",
    QPalette.ColorRole.Base: "paper",
    QPalette.ColorRole.AlternateBase: "row",
    QPalette.ColorRole.Text: "ink",
    QPalette.ColorRole.PlaceholderText: "quiet",
    QPalette.ColorRole.Button: "button",
    QPalette.ColorRole.ButtonText: "ink",
    QPalette.ColorRole.BrightText: "paper",
    QPalette.ColorRole.ToolTipBase: "tip",
    QPalette.ColorRole.ToolTipText: "ink",
    QPalette.ColorRole.Highlight: "chosen",
    QPalette.ColorRole.HighlightedText: "paper",
    QPalette.ColorRole.Link: "chosen",
    QPalette.ColorRole.LinkVisited: "chosen",
    QPalette.ColorRole.Light: "light",
    QPalette.ColorRole.Midlight: "midlight",
    QPalette.ColorRole.Mid: "mid",
    QPalette.ColorRole.Dark: "dark",
    QPalette.ColorRole.Shadow: "shadow",
    QPalette.ColorRole.Accent: "chosen",
}
"""Role of Qt -> tone of the theme."""
_FADED = (
    QPalette.ColorRole.WindowText,
    QPalette.ColorRole.Text,
    QPalette.ColorRole.ButtonText,
)


def _sheet() -> str:
    """Docks and bars are where they belong at once: one that still moves when it is deleted is laid out once more, and Qt dies."""
    seen = SCREEN
    return f"""
QToolTip {{ color: {seen.ink}; background: {seen.tip}; border: 1px solid {seen.line}; padding: 3px; }}
QMainWindow::separator {{ background: {seen.desk}; width: 5px; height: 5px; }}
QMainWindow::separator:hover {{ background: {seen.line}; }}
QDockWidget, QToolBar, QTabBar, QDockWidgetGroupWindow, CentralPages {{ widget-animation-duration: 0; }}
QDockWidget {{ titlebar-close-icon: url({icon_file("close")}); titlebar-normal-icon: url({icon_file("float")}); }}
QDockWidget::title {{ background: {seen.title}; padding: 4px 6px; text-align: left; }}
QTabBar::close-button {{ image: url({icon_file("close")}); }}
QTabBar::close-button:hover {{ background: {seen.line}; border-radius: 2px; }}
QStatusBar::item {{ border: none; }}
QHeaderView::section {{ background: {seen.desk}; color: {seen.quiet}; border: none; border-bottom: 1px solid {seen.line};
                        padding: 3px 4px; }}
"""


def palette() -> QPalette:
    """Colours for every role, so that none is left to the desktop."""
    made = QPalette()
    for role, tone in _ROLES.items():
        made.setColor(role, QColor(getattr(SCREEN, tone)))
    for role in _FADED:
        made.setColor(QPalette.ColorGroup.Disabled, role, QColor(SCREEN.greyed))
    made.setColor(QPalette.ColorGroup.Disabled, QPalette.ColorRole.Highlight, QColor(SCREEN.line))
    made.setColor(QPalette.ColorGroup.Inactive, QPalette.ColorRole.Highlight, QColor(SCREEN.idle))
    made.setColor(QPalette.ColorGroup.Inactive, QPalette.ColorRole.HighlightedText, QColor(SCREEN.ink))
    return made


def dress(app: QApplication) -> None:
    """Give the application its look. What it has already stays, for every window there is would be laid out anew."""
    wanted, sheet, ground = palette(), _sheet(), QPalette.ColorRole.Window
    if app.styleSheet() == sheet and app.palette().color(ground) == wanted.color(ground):
        return
    app.setStyle("Fusion")
    if app.property(RINGS) is None:
        app.setProperty(RINGS, True)
        app.focusChanged.connect(FocusRing.move_on)
    app.setPalette(wanted)
    app.setStyleSheet(sheet)
    app.setWindowIcon(icon("kindyna"))


USUAL = "usual font"  # property of the application: that before any preference
RINGS = "focus rings"  # likewise: whether they are shown
_SCHEMES = {"light": Qt.ColorScheme.Light, "dark": Qt.ColorScheme.Dark, "system": Qt.ColorScheme.Unknown}


def wear(wanted: settings.Preferences, app: QApplication, desktop: Qt.ColorScheme | None = None) -> None:
    """Show everything as it is preferred; desktop: its theme, where another is known than that which Qt tells."""
    hints = app.styleHints()
    settings.apply(wanted, app)
    hints.setColorScheme(_SCHEMES[wanted.theme])
    scheme = hints.colorScheme() if desktop is None or wanted.theme != "system" else desktop
    dark = wanted.theme == "dark" or (wanted.theme == "system" and scheme == Qt.ColorScheme.Dark)
    before, theme = replace(SCREEN), DARK if dark else LIGHT
    larger, recoloured = _letter(app, wanted.font), theme != before
    if recoloured:
        draw_in(theme)
    dress(app)
    if not (recoloured or larger) or not app.topLevelWidgets():
        return
    _change(app.allWidgets(), before, theme)
    DISPLAY.changed.emit()


def _change(widgets: Iterable[QWidget], before: Theme, theme: Theme) -> None:
    """Let these change from one theme into another, and be written in the letters of now."""
    from shiboken6 import isValid

    from kindyna_gui.pictures.recolour import Swap  # only now: a window that opens is made in its theme

    swap = Swap(before, theme) if theme != before else None
    for widget in widgets:
        if not isValid(widget):  # it went with what another one has made anew
            continue
        if swap is not None:
            swap.widget(widget)
        if callable(again := getattr(widget, "update_style", None)):
            again()


@contextmanager
def on_paper(widget: QWidget) -> Iterator[None]:
    """Inside, a widget and all in it is as a file has it: light, in letters and units of files."""
    screen, sheet = replace(SCREEN), widget.styleSheet()
    parts = [widget, *widget.findChildren(QWidget)]
    plain = [part for part in parts if not part.testAttribute(Qt.WidgetAttribute.WA_SetPalette)]
    with in_file_units():
        draw_in(LIGHT)
        _change(parts, screen, LIGHT)
        widget.setStyleSheet(_sheet())
        for part in plain:  # a style sheet keeps it from coming to them from what is around
            part.setPalette(palette())
        try:
            yield
        finally:
            draw_in(screen)
            widget.setStyleSheet(sheet)
            for part in plain:
                part.setPalette(QPalette())
    _change(parts, LIGHT, screen)


def _letter(app: QApplication, percent: int) -> bool:
    """Give all letters their size; whether that is another than before."""
    if app.property(USUAL) is None:
        app.setProperty(USUAL, app.font())
    usual = app.property(USUAL)
    wanted = QFont(usual)
    if usual.pointSizeF() > 0.0:
        wanted.setPointSizeF(usual.pointSizeF() * percent / 100.0)
    else:
        wanted.setPixelSize(round(usual.pixelSize() * percent / 100.0))
    if not choose_font_scale(percent / 100.0):
        return False
    app.setStyleSheet("")  # under one, widgets would keep the font they had
    app.setFont(wanted)
    return True


class FocusRing(QWidget):
    """A frame around what has the keys, where Qt shows none: drawings, plots, charts, pages that are rolled. One in each window; it is
    seen once the keys have been used to go from one to the other."""

    WIDTH = 2
    _around: QWidget | None = None  # of the class, too: events come until the very end of a window
    _watched: Sequence[QWidget] = ()

    @classmethod
    def move_on(cls, _: QWidget | None, now: QWidget | None) -> None:
        """The keys have gone somewhere else."""
        if now is None:
            return
        window = now.window()
        ring = window.findChild(FocusRing, options=Qt.FindChildOption.FindDirectChildrenOnly)
        shown = isinstance(now, _SHOWN_BY_QT) and not (isinstance(now, QPushButton) and now.isFlat())
        if not shown:
            (ring or cls(window)).follow(now)
        elif ring is not None:
            ring.follow(None)

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)

    def follow(self, widget: QWidget | None) -> None:
        """Stand around this, wherever what it lies in moves it; None: around nothing."""
        for each in self._watched:
            if isValid(each):
                each.removeEventFilter(self)
        self._around, watched = widget, []
        while widget is not None:
            widget.installEventFilter(self)
            watched.append(widget)
            widget = None if widget.isWindow() else widget.parentWidget()
        self._watched = watched
        self._place()

    def _place(self) -> None:
        window, at = self.window(), self._around
        seen = QRect()
        if at is not None and isValid(at) and at.hasFocus() and at.isVisible() and window.testAttribute(_BY_KEYS):
            seen = window.rect()
            for each in self._watched:
                seen &= QRect(each.mapTo(window, QPoint()), each.size())
        self.setGeometry(seen)
        self.setVisible(not seen.isEmpty())
        self.raise_()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() in _MOVES:
            self._place()
        return False

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setPen(QPen(QColor(SCREEN.chosen), self.WIDTH))
        painter.drawRect(self.rect().adjusted(1, 1, -1, -1))
        painter.end()


_SHOWN_BY_QT = (QAbstractButton, QAbstractSlider, QAbstractSpinBox, QComboBox, QLineEdit, QMenu, QMenuBar, QTabBar)
_BY_KEYS = Qt.WidgetAttribute.WA_KeyboardFocusChange
_MOVES = (QEvent.Type.Resize, QEvent.Type.Move, QEvent.Type.Hide, QEvent.Type.Show, QEvent.Type.LayoutRequest)


_ICON_COLOURS = (
    ("#3b4249", "ink"),
    ("#1c2126", "ink"),
    ("#ffffff", "roller"),
    ("#fff", "roller"),
    ("#2f6690", "chosen"),
)
"""Of icons -> the tone of a dark theme that stands for it."""


@cached_by_theme
def icon(name: str) -> QIcon:
    """An icon of ``resources/icons``, its ink that of the theme; empty where there is none."""
    file = icon_file(name)
    if not SCREEN.is_dark or not file:
        return QIcon(file)
    drawn = Path(file).read_text("utf-8")
    for light, tone in _ICON_COLOURS:
        drawn = drawn.replace(light, getattr(SCREEN, tone))
    made = QIcon()
    for scale in ICON_SCALES:
        buffer = QBuffer()
        buffer.setData(QByteArray(drawn.encode()))
        reader = QImageReader(buffer, QByteArray(b"svg"))
        reader.setScaledSize(reader.size() * scale)
        made.addPixmap(QPixmap.fromImage(reader.read()))
    return made


def text_button(text: str, *, checks: bool = False, flat: bool = False) -> QToolButton:
    """A button with a text; checks: it stays down; flat: its frame is seen under the mouse only."""
    button = QToolButton(autoRaise=flat)
    button.setText(text)
    button.setCheckable(checks)
    return button


def tool_bar(title: str, parent: QWidget | None = None) -> QToolBar:
    """A row of buttons that stays where it is; the one that holds what finds no room has a name, too."""
    bar = QToolBar(title, parent, movable=False)
    bar.setAccessibleName(title)
    more = bar.findChild(QToolButton, "qt_toolbar_ext_button")
    if isinstance(more, QToolButton):
        more.setAccessibleName(f"{title}: more")
    return bar


def coloured(widget: QWidget, colour: str) -> None:
    """Give a widget's text a colour, without a style sheet."""
    changed = widget.palette()
    changed.setColor(QPalette.ColorRole.WindowText, QColor(colour))
    widget.setPalette(changed)


# -- signs of severity ------------------------------------------------------------------------------------


def _disc(painter: QPainter, colour: str) -> None:
    painter.setBrush(QColor(colour))
    painter.drawEllipse(QRectF(1.5, 1.5, 13.0, 13.0))


def _triangle(painter: QPainter, colour: str) -> None:
    path = QPainterPath(QPointF(8.0, 1.6))
    path.lineTo(15.0, 14.4)
    path.lineTo(1.0, 14.4)
    path.closeSubpath()
    painter.setBrush(QColor(colour))
    painter.drawPath(path)


def _bars(painter: QPainter, rows: tuple[tuple[float, float, float, float], ...]) -> None:
    painter.setPen(QPen(QColor(SCREEN.paper), 1.8, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
    for x1, y1, x2, y2 in rows:
        painter.drawLine(QPointF(x1, y1), QPointF(x2, y2))


_SIGNS = {
    ERROR: (_disc, "limit", ((5.6, 5.6, 10.4, 10.4), (10.4, 5.6, 5.6, 10.4))),
    WARNING: (_triangle, "#D98200", ((8.0, 6.2, 8.0, 9.8), (8.0, 12.3, 8.0, 12.4))),
    NOTE: (_disc, "#5A7A94", ((8.0, 7.6, 8.0, 11.2), (8.0, 4.9, 8.0, 5.0))),
    "none": (_disc, "good", ((5.0, 8.3, 7.2, 10.5), (7.2, 10.5, 11.2, 5.8))),
}
"""Severity (or none) -> shape, tone of the theme or colour, strokes in that of paper; shape and strokes tell them apart without colour."""


@cached_by_theme
def sign(severity: str) -> QIcon:
    """The icon of a severity, or of ``none``."""
    shape, colour, strokes = _SIGNS[severity]
    made = QIcon()
    for scale in ICON_SCALES:
        picture = QPixmap(QSize(16, 16) * scale)
        picture.setDevicePixelRatio(scale)
        picture.fill(Qt.GlobalColor.transparent)
        painter = QPainter(picture)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        shape(painter, getattr(SCREEN, colour, colour))
        _bars(painter, strokes)
        painter.end()
        made.addPixmap(picture)
    return made


# -- note ------------------------------------------------------------------------------------------------


def linked(sentence: str) -> str:
    """A sentence, with what can be done about it as links to entries of the menus."""
    ways = suggestions_for(sentence)
    if not ways:
        return sentence
    from html import escape

    return " ".join((escape(sentence), *(f'<a href="{way.entry}">{escape(way.text)}</a>' for way in ways)))


class MessageLabel(QLabel):
    """A text that wraps; an empty one hides the label."""

    def __init__(self, colour: str) -> None:
        super().__init__(wordWrap=True)
        coloured(self, colour)
        self.setForegroundRole(QPalette.ColorRole.WindowText)  # on paper it would be that of texts
        self.setTextInteractionFlags(
            Qt.TextInteractionFlag.TextSelectableByMouse | Qt.TextInteractionFlag.LinksAccessibleByMouse
        )
        self.hide()

    def show_message(self, text: str) -> None:
        """Show this text; the label takes no room where it is empty."""
        if text != self.text() or self.isHidden() == bool(text):
            self.setText(text)
            self.setVisible(bool(text))


def bold_label(text: str) -> QLabel:
    """A heading inside a dialog."""
    label = QLabel(text)
    font = label.font()
    font.setBold(True)
    label.setFont(font)
    return label


class Note(MessageLabel):
    """The line below a picture that names what it does not show, and why; it never widens its parent."""

    def __init__(self, colour: str = "", margin: int = 6) -> None:
        super().__init__(colour or SCREEN.limit)
        self.setMargin(margin)
        self.setMinimumSize(1, 1)


class SteadyText(QWidget):
    """A text that may change in every frame: what is around it is laid out anew only where it needs more lines than ever."""

    def __init__(self, colour: str = "") -> None:
        super().__init__()
        self._label = QLabel(self, wordWrap=True)
        self._label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        if colour:
            coloured(self._label, colour)
        self.setMinimumHeight(self._label.fontMetrics().height())

    def text(self) -> str:
        return self._label.text()

    def show_text(self, text: str) -> None:
        """Show this text; the height grows with it and does not shrink, so that nothing below jumps."""
        if text != self.text():
            self._label.setText(text)
            self._grow()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._label.setGeometry(self.rect())
        if event.size().width() != event.oldSize().width():  # what it needed when it was narrow says nothing now
            self.setMinimumHeight(max(self._label.heightForWidth(self.width()), self._label.fontMetrics().height()))

    def _grow(self) -> None:
        needed = self._label.heightForWidth(self.width())
        if needed > self.minimumHeight():
            self.setMinimumHeight(needed)


def beside(box: QWidget, text: QLabel) -> QHBoxLayout:
    """What is chosen in a view, and beside it a text of two lines, which keeps its height so that nothing below it moves."""
    row = QHBoxLayout()
    row.setContentsMargins(6, 4, 6, 2)
    row.setSpacing(8)
    row.addWidget(box)
    row.addWidget(text, 1)
    text.setMinimumHeight(2 * text.fontMetrics().lineSpacing() + 2)
    return row
