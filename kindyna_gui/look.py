"""Look of the window: palette and style sheet, theme and font size, focus frame, icons, and small labels and buttons."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

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
    QDockWidget,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QLineEdit,
    QMainWindow,
    QMenu,
    QMenuBar,
    QPushButton,
    QScrollArea,
    QSizePolicy,
    QTabBar,
    QToolBar,
    QToolButton,
    QWidget,
)
from shiboken6 import isValid

from core.findings import ERROR, NOTE, WARNING
from kindyna_gui import settings
from kindyna_gui.pictures.style import DARK, LIGHT, SCREEN, Theme, brush, cached_by_theme, draw_in
from kindyna_gui.places import icon_file
from kindyna_gui.rebuilt import fill
from kindyna_gui.requirements import suggestions_for
from kindyna_gui.settings import DISPLAY, choose_font_scale, in_file_units

Described = TypeVar("Described", bound=QWidget)
ICON_SCALES = (1, 2, 3)  # dots per pixel that icons are made for
DEFAULT_FONT = "default font"  # property of the application: its font at 100 % font size
STYLED = "styled"  # property of the application: whether it has its style and its focus frames
PALETTE_PASSES_SHEET = Qt.ApplicationAttribute.AA_UseStyleSheetPropagationInWidgetStyles
"""Without it widgets under a style sheet would keep the palette that they were created with."""
_SCHEMES = {"light": Qt.ColorScheme.Light, "dark": Qt.ColorScheme.Dark, "system": Qt.ColorScheme.Unknown}
_ROLES = {
    QPalette.ColorRole.Window: "desk",
    QPalette.ColorRole.WindowText: "ink",
    QPalette.ColorRole.Base: "paper",
    QPalette.ColorRole.AlternateBase: "row",
    QPalette.ColorRole.Text: "ink",
    QPalette.ColorRole.PlaceholderText: "quiet",
    QPalette.ColorRole.Button: "button",
    QPalette.ColorRole.ButtonText: "ink",
    QPalette.ColorRole.BrightText: "line",  # only the style sheet paints with it
    QPalette.ColorRole.ToolTipBase: "tip",
    QPalette.ColorRole.ToolTipText: "ink",
    QPalette.ColorRole.Highlight: "chosen",
    QPalette.ColorRole.HighlightedText: "paper",
    QPalette.ColorRole.Link: "chosen",
    QPalette.ColorRole.LinkVisited: "title",  # only the style sheet: links have one colour
    QPalette.ColorRole.Light: "light",
    QPalette.ColorRole.Midlight: "midlight",
    QPalette.ColorRole.Mid: "mid",
    QPalette.ColorRole.Dark: "dark",
    QPalette.ColorRole.Shadow: "shadow",
    QPalette.ColorRole.Accent: "chosen",
}
"""Role of Qt -> tone of the theme."""
_TEXT_ROLES = (QPalette.ColorRole.WindowText, QPalette.ColorRole.Text, QPalette.ColorRole.ButtonText)
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
"""Colour in the file of an icon -> tone that replaces it in a dark theme."""

# -- theme and font size ---------------------------------------------------------------------------------


_SHEET_ROLES = {
    "ink": "window-text",
    "tip": "tooltip-base",
    "line": "bright-text",
    "desk": "window",
    "title": "link-visited",
    "quiet": "placeholder-text",
}
"""Tone of the theme -> role of the palette in a style sheet."""
_WITH_SHEET = (QMainWindow, QDockWidget, QTabBar, QHeaderView)
"""Widgets that the style sheet colours; Qt keeps their colours until they are polished again."""


def _style_sheet(tone: Callable[[str], str] = lambda tone: f"palette({_SHEET_ROLES[tone]})") -> str:
    """Style sheet of the window, without animated docks: Qt crashes where a dock is deleted while it moves.

    Its colours are roles of the palette, because Qt takes long to replace a style sheet; ``tone`` returns others.
    """
    ink, tip, line, desk, title, quiet = map(tone, _SHEET_ROLES)
    return f"""
QToolTip {{ color: {ink}; background: {tip}; border: 1px solid {line}; padding: 3px; }}
QMainWindow::separator {{ background: {desk}; width: 5px; height: 5px; }}
QMainWindow::separator:hover {{ background: {line}; }}
QDockWidget, QToolBar, QTabBar, QDockWidgetGroupWindow, CentralPages {{ widget-animation-duration: 0; }}
QDockWidget {{ titlebar-close-icon: url({icon_file("close")}); titlebar-normal-icon: url({icon_file("float")}); }}
QDockWidget::title {{ background: {title}; padding: 4px 6px; text-align: left; }}
QTabBar::close-button {{ image: url({icon_file("close")}); }}
QTabBar::close-button:hover {{ background: {line}; border-radius: 2px; }}
QStatusBar::item {{ border: none; }}
QHeaderView::section {{ background: {desk}; color: {quiet}; border: none; border-bottom: 1px solid {line};
                        padding: 3px 4px; }}
"""


def palette() -> QPalette:
    """Palette of the theme with a colour for every role, so that none comes from the desktop."""
    result = QPalette()
    for role, tone in _ROLES.items():
        result.setColor(role, QColor(getattr(SCREEN, tone)))
    for role in _TEXT_ROLES:
        result.setColor(QPalette.ColorGroup.Disabled, role, QColor(SCREEN.greyed))
    result.setColor(QPalette.ColorGroup.Disabled, QPalette.ColorRole.Highlight, QColor(SCREEN.line))
    result.setColor(QPalette.ColorGroup.Inactive, QPalette.ColorRole.Highlight, QColor(SCREEN.idle))
    result.setColor(QPalette.ColorGroup.Inactive, QPalette.ColorRole.HighlightedText, QColor(SCREEN.ink))
    return result


def apply_style(app: QApplication) -> None:
    """Apply palette, style sheet and icon to the application, unless it has them: that would lay out every window again."""
    colours, sheet, window_role = palette(), _style_sheet(), QPalette.ColorRole.Window
    has_colours = app.palette().color(window_role) == colours.color(window_role)
    if app.styleSheet() == sheet and has_colours:
        return
    if app.property(STYLED) is None:
        app.setProperty(STYLED, True)
        app.setStyle("Fusion")
        app.setAttribute(PALETTE_PASSES_SHEET)
        app.focusChanged.connect(FocusRing.move_on)
    if not has_colours:
        app.setPalette(colours)
    if app.styleSheet() != sheet:
        app.setStyleSheet(sheet)
    else:
        for widget in app.allWidgets():
            if isinstance(widget, _WITH_SHEET):
                app.style().polish(widget)
    app.setWindowIcon(icon("kindyna"))


def apply_preferences(
    preferences: settings.Preferences, app: QApplication, desktop: Qt.ColorScheme | None = None
) -> None:
    """Apply units, theme and font size; ``desktop`` is the desktop's theme where it differs from Qt's information."""
    hints = app.styleHints()
    settings.apply(preferences, app)
    hints.setColorScheme(_SCHEMES[preferences.theme])
    scheme = hints.colorScheme() if desktop is None or preferences.theme != "system" else desktop
    is_dark = preferences.theme == "dark" or (preferences.theme == "system" and scheme == Qt.ColorScheme.Dark)
    before, theme = replace(SCREEN), DARK if is_dark else LIGHT
    has_new_font, has_new_theme = _set_font_size(app, preferences.font), theme != before
    if has_new_theme:
        draw_in(theme)
    apply_style(app)
    if not (has_new_theme or has_new_font) or not app.topLevelWidgets():
        return
    _update_parts(app.topLevelWidgets(), before, theme, has_new_font)
    DISPLAY.changed.emit()


class ThemedPart(QWidget):
    """A part of the window that changes to another theme when it comes into sight."""

    def __init__(self) -> None:
        super().__init__()
        self._theme = replace(SCREEN)  # of its colours

    def on_screen(self) -> bool:
        """Whether something of the part can be seen."""
        return self.isVisible()

    def show_theme(self) -> None:
        """Change to the theme of the window, unless the part has it."""
        if self._theme != SCREEN:
            self.update_theme()

    def update_theme(self, with_hidden: bool = False) -> None:
        """Change to the theme and font size of the window; ``with_hidden``: the parts in it that cannot be seen, too."""
        before, self._theme = self._theme, replace(SCREEN)
        _update_widgets([self], before, self._theme)
        _update_parts(_children(self), before, self._theme, with_hidden)


def _children(widget: QWidget) -> list[QWidget]:
    """Direct children without windows, which the application lists itself."""
    children = widget.findChildren(QWidget, options=Qt.FindChildOption.FindDirectChildrenOnly)
    return [child for child in children if not child.isWindow()]


def _parts(widgets: Iterable[QWidget]) -> Iterator[QWidget]:
    """Widgets with all that is in them, without the content of themed parts."""
    for widget in widgets:
        yield widget
        if not isinstance(widget, ThemedPart):
            yield from _parts(_children(widget))


def _update_parts(widgets: Iterable[QWidget], before: Theme, theme: Theme, with_hidden: bool) -> None:
    """Update widgets and all that is in them; themed parts that cannot be seen are updated when they are shown."""
    parts = list(_parts(widgets))  # first: an update may delete widgets
    _update_widgets((part for part in parts if not isinstance(part, ThemedPart)), before, theme)
    for part in parts:
        if isinstance(part, ThemedPart) and isValid(part) and (with_hidden or part.on_screen()):
            part.update_theme(with_hidden)


def _update_widgets(widgets: Iterable[QWidget], before: Theme, theme: Theme) -> None:
    """Replace the colours of one theme by those of another, and update what depends on the font size."""
    from kindyna_gui.pictures.recolour import swap_between  # not needed at the start: a window opens in its theme

    swap = swap_between(before, theme) if theme != before else None
    for widget in widgets:
        if not isValid(widget):  # deleted by the update of another widget
            continue
        if swap is not None:
            swap.widget(widget)
        if callable(update_style := getattr(widget, "update_style", None)):
            update_style()


@contextmanager
def on_paper(widget: QWidget) -> Iterator[None]:
    """Show a widget within the context as in a file: in the light theme, with font size and units of files."""
    screen, sheet = replace(SCREEN), widget.styleSheet()
    parts = [widget, *widget.findChildren(QWidget)]
    plain = [part for part in parts if not part.testAttribute(Qt.WidgetAttribute.WA_SetPalette)]
    with in_file_units():
        draw_in(LIGHT)
        _update_widgets(parts, screen, LIGHT)
        widget.setStyleSheet(_style_sheet(partial(getattr, SCREEN)))
        for part in plain:  # with a style sheet they do not inherit the palette
            part.setPalette(palette())
        try:
            yield
        finally:
            draw_in(screen)
            widget.setStyleSheet(sheet)
            for part in plain:
                part.setPalette(QPalette())
    _update_widgets(parts, LIGHT, screen)


def _set_font_size(app: QApplication, percent: int) -> bool:
    """Set the font size; returns whether it has changed."""
    if app.property(DEFAULT_FONT) is None:
        app.setProperty(DEFAULT_FONT, app.font())
    default = app.property(DEFAULT_FONT)
    font = QFont(default)
    if default.pointSizeF() > 0.0:
        font.setPointSizeF(default.pointSizeF() * percent / 100.0)
    else:
        font.setPixelSize(round(default.pixelSize() * percent / 100.0))
    if not choose_font_scale(percent / 100.0):
        return False
    app.setStyleSheet("")  # with a style sheet, widgets would not change their font
    app.setFont(font)
    return True


# -- keyboard focus --------------------------------------------------------------------------------------


class FocusRing(QWidget):
    """Frame around the widget with the keyboard focus, where Qt shows none: drawings, plots, scrolled pages.

    Each window has one frame. It is visible once the user has moved the focus by keys.
    """

    WIDTH = 2
    _around: QWidget | None = None  # class attributes, because events arrive after the instance's are deleted
    _watched: Sequence[QWidget] = ()

    @classmethod
    def move_on(cls, _: QWidget | None, focused: QWidget | None) -> None:
        """Move the frame to the widget that has received the focus."""
        if focused is None:
            return
        window = focused.window()
        ring = window.findChild(FocusRing, options=Qt.FindChildOption.FindDirectChildrenOnly)
        if not isinstance(focused, _SHOWN_BY_QT) or (isinstance(focused, QPushButton) and focused.isFlat()):
            (ring or cls(window)).follow(focused)
        elif ring is not None:
            ring.follow(None)

    def __init__(self, window: QWidget) -> None:
        super().__init__(window, focusPolicy=Qt.FocusPolicy.NoFocus)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)

    def follow(self, widget: QWidget | None) -> None:
        """Frame this widget and follow its movements, or frame none."""
        for parent in self._watched:
            if isValid(parent):
                parent.removeEventFilter(self)
        self._around, watched = widget, []
        while widget is not None:
            widget.installEventFilter(self)
            watched.append(widget)
            widget = None if widget.isWindow() else widget.parentWidget()
        self._watched = watched
        self._update_frame()

    def _update_frame(self) -> None:
        window, at = self.window(), self._around
        visible = QRect()
        if at is not None and isValid(at) and at.hasFocus() and at.isVisible() and window.testAttribute(_BY_KEYS):
            visible = window.rect()
            for parent in self._watched:
                visible &= QRect(parent.mapTo(window, QPoint()), parent.size())
        self.setGeometry(visible)
        self.setVisible(not visible.isEmpty())
        self.raise_()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() in _MOVES:
            self._update_frame()
        return False

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setPen(QPen(QColor(SCREEN.chosen), self.WIDTH))
        painter.drawRect(self.rect().adjusted(1, 1, -1, -1))
        painter.end()


# -- icons, buttons and bars -----------------------------------------------------------------------------


@cached_by_theme
def icon(name: str) -> QIcon:
    """Icon of ``resources/icons`` in the colours of the theme; empty where there is no such file."""
    file = icon_file(name)
    if not SCREEN.is_dark or not file:
        return QIcon(file)
    source = Path(file).read_text("utf-8")
    for light, tone in _ICON_COLOURS:
        source = source.replace(light, getattr(SCREEN, tone))
    result = QIcon()
    for scale in ICON_SCALES:
        buffer = QBuffer()
        buffer.setData(QByteArray(source.encode()))
        reader = QImageReader(buffer, QByteArray(b"svg"))
        reader.setScaledSize(reader.size() * scale)
        result.addPixmap(QPixmap.fromImage(reader.read()))
    return result


def text_button(text: str, *, checks: bool = False, flat: bool = False) -> QToolButton:
    """Button with a text; ``checks`` makes it checkable, ``flat`` shows its frame only under the mouse."""
    button = QToolButton(autoRaise=flat)
    button.setText(text)
    button.setCheckable(checks)
    return button


def tool_bar(title: str, parent: QWidget | None = None) -> QToolBar:
    """Fixed tool bar, whose extension button has a name for screen readers."""
    bar = QToolBar(title, parent, movable=False)
    bar.setAccessibleName(title)
    extension = bar.findChild(QToolButton, "qt_toolbar_ext_button")
    if isinstance(extension, QToolButton):
        extension.setAccessibleName(f"{title}: more")
    return bar


def described(widget: Described, *, name: str = "", tip: str = "") -> Described:
    """Give a widget its name for screen readers, and its tip, where they are not empty; return the widget."""
    if name:
        widget.setAccessibleName(name)
    if tip:
        widget.setToolTip(tip)
    return widget


def coloured(widget: Described, colour: str) -> Described:
    """Set the colour of a widget's text, without a style sheet, and return the widget."""
    colours = widget.palette()
    colours.setColor(QPalette.ColorRole.WindowText, QColor(colour))
    widget.setPalette(colours)
    return widget


# -- signs of severity -----------------------------------------------------------------------------------


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
"""Severity, or "none" -> shape, tone of the theme or colour, and strokes in the colour of the paper.

Shape and strokes distinguish the signs without colour.
"""


@cached_by_theme
def sign(severity: str) -> QIcon:
    """Icon of a severity, or of "none"."""
    shape, colour, strokes = _SIGNS[severity]
    result = QIcon()
    for scale in ICON_SCALES:
        pixmap = QPixmap(QSize(16, 16) * scale)
        pixmap.setDevicePixelRatio(scale)
        pixmap.fill(Qt.GlobalColor.transparent)
        painter = QPainter(pixmap)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        shape(painter, getattr(SCREEN, colour, colour))
        _bars(painter, strokes)
        painter.end()
        result.addPixmap(pixmap)
    return result


# -- labels ----------------------------------------------------------------------------------------------


def linked(sentence: str) -> str:
    """Sentence followed by its remedies, as links to menu entries."""
    remedies = suggestions_for(sentence)
    if not remedies:
        return sentence
    from html import escape  # imported here to save start-up time

    links = (f'<a href="{remedy.entry}">{escape(remedy.text)}</a>' for remedy in remedies)
    return " ".join((escape(sentence), *links))


class MessageLabel(QLabel):
    """Label with a text that wraps; it is hidden where the text is empty."""

    def __init__(self, colour: str) -> None:
        super().__init__(wordWrap=True)
        coloured(self, colour)
        self.setForegroundRole(QPalette.ColorRole.WindowText)  # else that of texts where the background is paper
        self.setTextInteractionFlags(
            Qt.TextInteractionFlag.TextSelectableByMouse | Qt.TextInteractionFlag.LinksAccessibleByMouse
        )
        self.hide()

    def show_message(self, text: str) -> None:
        """Show this text, or hide the label where it is empty."""
        if text != self.text() or self.isHidden() == bool(text):
            self.setText(text)
            self.setVisible(bool(text))


def bold_label(text: str) -> QLabel:
    """Label for a heading in a dialog."""
    label = QLabel(text)
    font = label.font()
    font.setBold(True)
    label.setFont(font)
    return label


def answer_label() -> QLabel:
    """Label for the first words of a view: its verdict, and the number to act on."""
    label = bold_label("")
    label.setWordWrap(True)
    label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    label.setContentsMargins(8, 6, 8, 2)
    return label


class Note(MessageLabel):
    """Message below a drawing or plot that says what is omitted and why; it does not widen its parent."""

    def __init__(self, colour: str = "", margin: int = 6) -> None:
        super().__init__(colour or SCREEN.limit)
        self.setMargin(margin)
        self.setMinimumSize(1, 1)


class SteadyText(QWidget):
    """Text that may change in every frame; the layout changes only when it needs more lines than before."""

    def __init__(self, colour: str = "") -> None:
        super().__init__()
        self._label = QLabel(self, wordWrap=True, textInteractionFlags=Qt.TextInteractionFlag.TextSelectableByMouse)
        if colour:
            coloured(self._label, colour)
        self.setMinimumHeight(self._label.fontMetrics().height())

    def text(self) -> str:
        """Text that is shown."""
        return self._label.text()

    def show_text(self, text: str) -> None:
        """Show this text; the height increases with it and never decreases, so that nothing below moves."""
        if text != self.text():
            self._label.setText(text)
            self._grow()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._label.setGeometry(self.rect())
        if event.size().width() != event.oldSize().width():  # the height for the previous width no longer applies
            self.setMinimumHeight(max(self._label.heightForWidth(self.width()), self._label.fontMetrics().height()))

    def _grow(self) -> None:
        needed = self._label.heightForWidth(self.width())
        if needed > self.minimumHeight():
            self.setMinimumHeight(needed)


class Picture(QWidget):
    """Drawing fitted to its widget, faint while another one is calculated; subclasses implement ``draw``.

    ``shown``: what is drawn; None: only the message.
    """

    def __init__(self, name: str, least: QSize, hint: QSize) -> None:
        super().__init__()
        self.shown: Any = None
        self._faint, self._message = False, ""
        self._hint = hint
        self.setAccessibleName(name)
        self.setMinimumSize(least)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def sizeHint(self) -> QSize:
        return self._hint

    def show_picture(self, shown: Any, message: str = "") -> None:
        """Draw this; None: show only the message."""
        self.shown, self._faint, self._message = shown, False, message
        self.update()

    def wait(self) -> None:
        """Draw faintly what was drawn last."""
        self._faint = True
        self.update()

    def draw(self, painter: QPainter) -> None:
        """Paint what is shown, on paper."""
        raise NotImplementedError

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), brush(SCREEN.paper))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setOpacity(0.35 if self._faint else 1.0)
        if self.shown is not None:
            self.draw(painter)
        else:
            painter.setPen(SCREEN.pen(SCREEN.quiet))
            painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap, self._message)
        painter.end()


def scrolled(content: QWidget, *, sideways: bool = True) -> QScrollArea:
    """Area without a frame that scrolls its content, only up and down unless ``sideways``; it takes no focus."""
    area = QScrollArea(widgetResizable=True)
    area.setFrameShape(QScrollArea.Shape.NoFrame)
    area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
    if not sideways:
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
    area.setWidget(content)
    return area


def row_with_text(box: QWidget, text: QLabel) -> QHBoxLayout:
    """Row of a selection box and a text with a fixed height of two lines, so that nothing below it moves."""
    row = fill(QHBoxLayout(), box, (text, 1), margins=(6, 4, 6, 2), spacing=8)
    text.setMinimumHeight(2 * text.fontMetrics().lineSpacing() + 2)
    return row
