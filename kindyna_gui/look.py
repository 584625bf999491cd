"""The look of the window: a light, quiet drawing office, whatever the desktop's own theme is."""

from __future__ import annotations

from functools import cache

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QIcon, QPainter, QPainterPath, QPalette, QPen, QPixmap
from PySide6.QtWidgets import QApplication, QToolButton, QWidget

from core.findings import ERROR, NOTE, WARNING
from kindyna_gui.pictures.style import LIGHT
from kindyna_gui.places import icon_file

INK, QUIET, PAPER, WRONG = LIGHT.ink, LIGHT.quiet, LIGHT.paper, LIGHT.limit
DESK = "#F1F1EF"  # what is around the papers
LINE = "#C9CBCC"
CHOSEN = "#2F6690"
ASSUMED = "#A05A00"
GOOD = "#2E7D32"

_ROLES = {
    QPalette.ColorRole.Window: DESK,
    QPalette.ColorRole.WindowText: INK,
    QPalette.ColorRole.Base: PAPER,
    QPalette.ColorRole.AlternateBase: "#F7F7F5",
    QPalette.ColorRole.Text: INK,
    QPalette.ColorRole.PlaceholderText: QUIET,
    QPalette.ColorRole.Button: "#F4F4F2",
    QPalette.ColorRole.ButtonText: INK,
    QPalette.ColorRole.BrightText: PAPER,
    QPalette.ColorRole.ToolTipBase: "#FFFDF2",
    QPalette.ColorRole.ToolTipText: INK,
    QPalette.ColorRole.Highlight: CHOSEN,
    QPalette.ColorRole.HighlightedText: PAPER,
    QPalette.ColorRole.Link: CHOSEN,
    QPalette.ColorRole.LinkVisited: CHOSEN,
    QPalette.ColorRole.Light: "#FFFFFF",
    QPalette.ColorRole.Midlight: "#E8E8E5",
    QPalette.ColorRole.Mid: "#B9BBBB",
    QPalette.ColorRole.Dark: "#9A9C9D",
    QPalette.ColorRole.Shadow: "#6E7072",
    QPalette.ColorRole.Accent: CHOSEN,
}
_FADED = (
    QPalette.ColorRole.WindowText,
    QPalette.ColorRole.Text,
    QPalette.ColorRole.ButtonText,
)

_SHEET = f"""
QToolTip {{ color: {INK}; background: #FFFDF2; border: 1px solid {LINE}; padding: 3px; }}
QMainWindow::separator {{ background: {DESK}; width: 5px; height: 5px; }}
QMainWindow::separator:hover {{ background: {LINE}; }}
QDockWidget::title {{ background: #E6E7E6; padding: 4px 6px; text-align: left; }}
QTabBar::close-button {{ image: url({icon_file("close")}); }}
QTabBar::close-button:hover {{ background: {LINE}; border-radius: 2px; }}
QStatusBar::item {{ border: none; }}
QHeaderView::section {{ background: {DESK}; color: {QUIET}; border: none; border-bottom: 1px solid {LINE};
                        padding: 3px 4px; }}
"""


def palette() -> QPalette:
    """Light colours for every role, so that none is left to a dark desktop."""
    made = QPalette()
    for role, colour in _ROLES.items():
        made.setColor(role, QColor(colour))
    for role in _FADED:
        made.setColor(QPalette.ColorGroup.Disabled, role, QColor("#9A9EA2"))
    made.setColor(QPalette.ColorGroup.Disabled, QPalette.ColorRole.Highlight, QColor("#C4CBD1"))
    made.setColor(QPalette.ColorGroup.Inactive, QPalette.ColorRole.Highlight, QColor("#B8CAD8"))
    made.setColor(QPalette.ColorGroup.Inactive, QPalette.ColorRole.HighlightedText, QColor(INK))
    return made


def dress(app: QApplication) -> None:
    """Give the application its look. What it has already stays, for every window there is would be laid out anew."""
    light, ground = palette(), QPalette.ColorRole.Window
    if app.styleSheet() == _SHEET and app.palette().color(ground) == light.color(ground):
        return
    app.setStyle("Fusion")
    app.styleHints().setColorScheme(Qt.ColorScheme.Light)
    app.setPalette(light)
    app.setStyleSheet(_SHEET)
    app.setWindowIcon(icon("kindyna"))


@cache
def icon(name: str) -> QIcon:
    """An icon of ``resources/icons``; empty where there is none."""
    return QIcon(icon_file(name))


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
