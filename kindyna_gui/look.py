"""The look of the window: a quiet drawing office, light or dark as the user prefers, whatever the desktop's own theme is."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QIcon, QPainter, QPainterPath, QPalette, QPen, QPixmap
from PySide6.QtWidgets import QApplication, QToolButton, QWidget

from core.findings import ERROR, NOTE, WARNING
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.places import icon_file

INK, QUIET, PAPER, WRONG = SCREEN.ink, SCREEN.quiet, SCREEN.paper, SCREEN.limit
DESK, LINE, CHOSEN, ASSUMED, GOOD, TITLE, BUTTON, ROW, TIP, GREYED, CHOSEN_ROW, BAND = (
    ("#2A2F35", "#4A525A", "#6DB3E0", "#E5A550", "#6FCF75", "#343A41", "#363C43", "#20252A", "#3A3A2E", "#6C757D", "#2C4356", "#3A4148")
    if SCREEN.is_dark
    else ("#F1F1EF", "#C9CBCC", "#2F6690", "#A05A00", "#2E7D32", "#E6E7E6", "#F4F4F2",
           "#F7F7F5", "#FFFDF2", "#9A9EA2", "#E4ECF2", "#DFE2E4")
)  # fmt: skip
"""What is around the papers; frames; what is chosen; assumed values; what is right; titles, buttons, every other row, tips; what is
disabled; the row that is chosen; the dwells beside the player."""

_ROLES = {
    QPalette.ColorRole.Window: DESK,
    QPalette.ColorRole.WindowText: INK,
    QPalette.ColorRole.Base: PAPER,
    QPalette.ColorRole.AlternateBase: ROW,
    QPalette.ColorRole.Text: INK,
    QPalette.ColorRole.PlaceholderText: QUIET,
    QPalette.ColorRole.Button: BUTTON,
    QPalette.ColorRole.ButtonText: INK,
    QPalette.ColorRole.BrightText: PAPER,
    QPalette.ColorRole.ToolTipBase: TIP,
    QPalette.ColorRole.ToolTipText: INK,
    QPalette.ColorRole.Highlight: CHOSEN,
    QPalette.ColorRole.HighlightedText: PAPER,
    QPalette.ColorRole.Link: CHOSEN,
    QPalette.ColorRole.LinkVisited: CHOSEN,
    QPalette.ColorRole.Light: "#4A525A" if SCREEN.is_dark else "#FFFFFF",
    QPalette.ColorRole.Midlight: "#3E454C" if SCREEN.is_dark else "#E8E8E5",
    QPalette.ColorRole.Mid: "#2A3036" if SCREEN.is_dark else "#B9BBBB",
    QPalette.ColorRole.Dark: "#1C2024" if SCREEN.is_dark else "#9A9C9D",
    QPalette.ColorRole.Shadow: "#101214" if SCREEN.is_dark else "#6E7072",
    QPalette.ColorRole.Accent: CHOSEN,
}
_FADED = (
    QPalette.ColorRole.WindowText,
    QPalette.ColorRole.Text,
    QPalette.ColorRole.ButtonText,
)

_SHEET = f"""
QToolTip {{ color: {INK}; background: {TIP}; border: 1px solid {LINE}; padding: 3px; }}
QMainWindow::separator {{ background: {DESK}; width: 5px; height: 5px; }}
QMainWindow::separator:hover {{ background: {LINE}; }}
QDockWidget::title {{ background: {TITLE}; padding: 4px 6px; text-align: left; }}
QTabBar::close-button {{ image: url({icon_file("close")}); }}
QTabBar::close-button:hover {{ background: {LINE}; border-radius: 2px; }}
QStatusBar::item {{ border: none; }}
QHeaderView::section {{ background: {DESK}; color: {QUIET}; border: none; border-bottom: 1px solid {LINE};
                        padding: 3px 4px; }}
"""


def palette() -> QPalette:
    """Colours for every role, so that none is left to the desktop."""
    made = QPalette()
    for role, colour in _ROLES.items():
        made.setColor(role, QColor(colour))
    for role in _FADED:
        made.setColor(QPalette.ColorGroup.Disabled, role, QColor(GREYED))
    made.setColor(QPalette.ColorGroup.Disabled, QPalette.ColorRole.Highlight, QColor(LINE))
    made.setColor(
        QPalette.ColorGroup.Inactive, QPalette.ColorRole.Highlight, QColor("#3B5163" if SCREEN.is_dark else "#B8CAD8")
    )
    made.setColor(QPalette.ColorGroup.Inactive, QPalette.ColorRole.HighlightedText, QColor(INK))
    return made


def dress(app: QApplication) -> None:
    """Give the application its look. What it has already stays, for every window there is would be laid out anew."""
    wanted, ground = palette(), QPalette.ColorRole.Window
    if app.styleSheet() == _SHEET and app.palette().color(ground) == wanted.color(ground):
        return
    app.setStyle("Fusion")
    app.styleHints().setColorScheme(Qt.ColorScheme.Dark if SCREEN.is_dark else Qt.ColorScheme.Light)
    app.setPalette(wanted)
    app.setStyleSheet(_SHEET)
    app.setWindowIcon(icon("kindyna"))


_ICON_COLOURS = (
    ("#3b4249", SCREEN.ink),
    ("#1c2126", SCREEN.ink),
    ("#ffffff", SCREEN.roller),
    ("#fff", SCREEN.roller),
    ("#2f6690", CHOSEN),
)
"""Of icons -> on dark paper."""


@cache
def icon(name: str) -> QIcon:
    """An icon of ``resources/icons``, its ink that of the theme; empty where there is none."""
    file = icon_file(name)
    if not SCREEN.is_dark or not file:
        return QIcon(file)
    drawn = Path(file).read_text("utf-8")
    for light, dark in _ICON_COLOURS:
        drawn = drawn.replace(light, dark)
    picture = QPixmap()
    picture.loadFromData(drawn.encode())
    return QIcon(picture)


def text_button(text: str, *, checks: bool = False, flat: bool = False) -> QToolButton:
    """A button with a text; checks: it stays down; flat: its frame is seen under the mouse only."""
    button = QToolButton(autoRaise=flat)
    button.setText(text)
    button.setCheckable(checks)
    return button


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
    painter.setPen(QPen(QColor(PAPER), 1.8, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
    for x1, y1, x2, y2 in rows:
        painter.drawLine(QPointF(x1, y1), QPointF(x2, y2))


_SIGNS = {
    ERROR: (_disc, WRONG, ((5.6, 5.6, 10.4, 10.4), (10.4, 5.6, 5.6, 10.4))),
    WARNING: (_triangle, "#D98200", ((8.0, 6.2, 8.0, 9.8), (8.0, 12.3, 8.0, 12.4))),
    NOTE: (_disc, "#5A7A94", ((8.0, 7.6, 8.0, 11.2), (8.0, 4.9, 8.0, 5.0))),
    "none": (_disc, GOOD, ((5.0, 8.3, 7.2, 10.5), (7.2, 10.5, 11.2, 5.8))),
}
"""Severity (or none) -> shape, colour, strokes in white; shape and strokes tell them apart without colour."""


@cache
def sign(severity: str) -> QIcon:
    """The icon of a severity, or of ``none``."""
    shape, colour, strokes = _SIGNS[severity]
    made = QIcon()
    for scale in (1, 2, 3):
        picture = QPixmap(QSize(16, 16) * scale)
        picture.setDevicePixelRatio(scale)
        picture.fill(Qt.GlobalColor.transparent)
        painter = QPainter(picture)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        shape(painter, colour)
        _bars(painter, strokes)
        painter.end()
        made.addPixmap(picture)
    return made
