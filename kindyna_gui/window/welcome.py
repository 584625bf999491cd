"""The welcome page: examples by subject with images, a new design, tutorials, recent files."""

from __future__ import annotations

from functools import partial
from typing import Any

from PySide6.QtCore import QSize, Qt, QTimer
from PySide6.QtGui import QCloseEvent, QFontInfo, QImage, QPalette, QPixmap
from PySide6.QtWidgets import (
    QCheckBox,
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

from core.design import Motion
from core.design.camshaft import unsolved_motions
from core.design.curves import solve_laws
from core.errors import KindynaError
from core.papers import PAPERS
from core.project import load
from core.project.reading_faults import Example, subjects
from kindyna_gui import dialogs
from kindyna_gui.background import Background, Job
from kindyna_gui.look import coloured, described
from kindyna_gui.pictures.painter import thumbnail
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.places import lessons
from kindyna_gui.rebuilt import STRETCH, ContentArea, close_by_escape, fill
from kindyna_gui.window.base import Window

THUMB = QSize(132, 96)
WORDS = 228  # width of the text next to an image [pixels]
CARD = THUMB.width() + WORDS + 30
SIDE = 250  # width of the column at the left [pixels]
LARGEST = QSize(SIDE + 3 * CARD + 80, 900)
FRAME = QSize(60, 70)  # left free around the page on a small screen


class Card(QPushButton):
    """A button that opens an example, with its image, name, paper and description."""

    def __init__(self, example: Example) -> None:
        super().__init__()
        self.example = example
        self.setObjectName(f"example:{example.file}")
        self.setAccessibleName(f"{example.name}: {example.text}")
        self.setFlat(True)
        self.setCursor(Qt.CursorShape.PointingHandCursor)
        self.picture = QLabel()
        self.picture.setFixedSize(THUMB)
        heading = QLabel(example.name)
        bold = heading.font()
        bold.setBold(True)
        heading.setFont(bold)
        paper = coloured(QLabel(PAPERS[example.paper].label if example.paper else ""), SCREEN.quiet)
        paper.setForegroundRole(QPalette.ColorRole.WindowText)  # not the button's
        paper.setVisible(bool(example.paper))
        text = QLabel(example.text, wordWrap=True)
        text.setFixedWidth(WORDS)
        text.setFixedHeight(text.heightForWidth(WORDS))
        words = fill(QVBoxLayout(), heading, paper, text, STRETCH, spacing=2)
        self._row = fill(QHBoxLayout(self), (self.picture, 0, Qt.AlignmentFlag.AlignTop), words, margins=8, spacing=10)
        for label in self.findChildren(QLabel):
            label.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setFixedWidth(CARD)

    def sizeHint(self) -> QSize:
        return self._row.sizeHint()

    def minimumSizeHint(self) -> QSize:
        return self.sizeHint()

    def paint(self) -> tuple[Motion, ...]:
        """Paint the image from the design's file; none where it cannot be read, or has laws that are not solved: these are returned."""
        motions: tuple[Motion, ...] = ()
        try:
            design = load(self.example.path)
            motions = unsolved_motions(design)
            image = QImage() if motions else thumbnail(design, THUMB.width(), THUMB.height(), self.devicePixelRatioF())
        except KindynaError:
            image = QImage()
        self.picture.setPixmap(QPixmap.fromImage(image))
        return motions


class Welcome(QWidget):
    """New designs and recent files at the left, examples at the right.

    Images are painted one by one once the page is on the screen. ``room`` is the room on the screen [pixels], by default
    the screen's.
    """

    def __init__(self, window: Window, room: QSize | None = None) -> None:
        super().__init__(window, Qt.WindowType.Window, windowTitle="Welcome to KINDYNA")
        dialogs.give_help(self, "tour#opens when KINDYNA starts")
        self._window = window
        room = self.screen().availableGeometry().size() if room is None else room
        self.resize((room - FRAME).boundedTo(LARGEST))
        self.cards = [Card(example) for _, rows in subjects() for example in rows]
        for card in self.cards:
            card.clicked.connect(partial(window.documents.open_example, card.example.path))
        self.recent = ContentArea()
        self.at_start = described(
            QCheckBox("&Show at start"),
            tip="Show this page when KINDYNA starts without a file; the Help menu opens it at any time",
        )
        self.at_start.setChecked(window.settings.welcome)
        self.at_start.toggled.connect(partial(setattr, window.settings, "welcome"))
        fill(QHBoxLayout(self), self._side(), (self._examples((self.width() - SIDE - 60) // CARD), 1), margins=10)
        self._waiting = list(self.cards)
        self._unsolved: list[Job] = []  # cards whose designs have laws that are not solved
        self._laws = Background(self)
        self._laws.result.connect(self._paint_solved)
        self._soon = QTimer(self, interval=0)
        self._soon.timeout.connect(self._paint_next)
        window.session.started.connect(self.close)
        close_by_escape(self)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Give the keys to the drawing: Space plays."""
        super().closeEvent(event)
        self._laws.stop()
        drawing: Any = self._window.view("mechanism")
        if self.isVisible() and drawing is not None:
            self._window.activateWindow()
            drawing.canvas.setFocus(Qt.FocusReason.OtherFocusReason)

    def _side(self) -> QWidget:
        side = QWidget()
        side.setFixedWidth(SIDE)
        self.new_button, self.open_button = QPushButton("&New..."), QPushButton("&Open...")
        self.tour_button = described(QPushButton("&Tour"), tip="The window in five minutes")
        self.tutorials = [self._tutorial(name, title) for name, title in lessons()]
        self.new_button.setToolTip("Begin a new design with a mechanism chosen from images")
        self.open_button.setToolTip("Open a design file")
        self.new_button.clicked.connect(self._window.designing.new_by_picture)
        self.open_button.clicked.connect(self._window.documents.open_file)
        self.tour_button.clicked.connect(partial(self._window.show_help, "tour"))
        fill(
            QVBoxLayout(side),
            self.new_button,
            self.open_button,
            self.tour_button,
            12,
            *self.tutorials,
            12,
            self.recent,
            STRETCH,
            self.at_start,
            margins=(0, 4, 10, 0),
        )
        return side

    def _tutorial(self, name: str, title: str) -> QPushButton:
        button = described(QPushButton(f"Tutorial: {title.partition(',')[0]}", flat=True), tip=title)
        button.setStyleSheet("text-align: left")
        button.clicked.connect(self.close)
        button.clicked.connect(partial(self._window.begin_tutorial, name))
        return button

    def _examples(self, columns: int) -> QWidget:
        inside = QWidget(autoFillBackground=True)
        colours = inside.palette()
        colours.setColor(inside.backgroundRole(), SCREEN.paper)
        inside.setPalette(colours)
        stack, cards = fill(QVBoxLayout(inside), margins=(12, 8, 12, 12)), iter(self.cards)
        for title, rows in subjects():
            heading = QLabel(title)
            large = heading.font()
            large.setPixelSize(round(1.25 * QFontInfo(large).pixelSize()))
            heading.setFont(large)
            grid = fill(QGridLayout(), spacing=4)
            for number in range(len(rows)):
                grid.addWidget(next(cards), *divmod(number, max(columns, 1)), Qt.AlignmentFlag.AlignTop)
            grid.setColumnStretch(max(columns, 1), 1)
            fill(stack, heading, grid, 10)
        stack.addStretch(1)
        scrolled = QScrollArea(widgetResizable=True)
        scrolled.setFrameShape(QFrame.Shape.StyledPanel)
        scrolled.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        scrolled.setWidget(inside)
        return scrolled

    def open(self) -> None:
        """Show the page in front of all windows, with the current list of recent files."""
        self._list_recent()
        self.show()
        self.raise_()
        self.activateWindow()
        if self._waiting or self._unsolved:
            self._soon.start()

    def _list_recent(self) -> None:
        content, files = QWidget(), self._window.settings.recent
        heading = coloured(
            QLabel("Recent files" if files else "Recent files appear here.", wordWrap=True), SCREEN.quiet
        )
        column = fill(QVBoxLayout(content), heading, margins=0, spacing=2)
        for path in files:
            button = described(QPushButton(flat=True), tip=str(path))
            button.setText(
                button.fontMetrics().elidedText(path.name, Qt.TextElideMode.ElideMiddle, SIDE - 36).replace("&", "&&")
            )
            button.setStyleSheet("text-align: left")
            button.clicked.connect(partial(self._window.documents.open_path, path))
            column.addWidget(button)
        self.recent.replace(content)

    def _paint_next(self) -> None:
        if self._waiting and self.isVisible():
            card = self._waiting.pop(0)
            if motions := card.paint():
                self._unsolved.append((card, partial(solve_laws, motions)))
        else:
            self._soon.stop()
            self._laws.start(self._unsolved)

    def _paint_solved(self, card: Card, _: object) -> None:
        self._unsolved = [job for job in self._unsolved if job[0] is not card]
        card.paint()


__all__ = ["Welcome"]
