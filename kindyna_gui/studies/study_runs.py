"""Study: running, opening, pages."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from PySide6.QtCore import QPointF, Qt, Signal
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import QLabel, QMenu, QPushButton, QStackedWidget, QVBoxLayout, QWidget

from core.design import Design
from core.process import resources
from core.varying import READY, Survey, ready_study
from kindyna_gui import dialogs
from kindyna_gui.rebuilt import clear_menu
from kindyna_gui.studies.plots import FrontPlot, Measured, ParallelPlot, SurveyPlot
from kindyna_gui.studies.texts import name_of, number_text, reason_text, span_title, value_text

# -- opening ---------------------------------------------------------------------------------------------


def example_studies() -> list[tuple[str, Path]]:
    """Those that come with the program: what the first line of each says, and its file."""
    files = sorted((resources() / "studies").glob("*.toml"))
    return [(path.read_text("utf-8").partition("\n")[0].removeprefix("# ").removesuffix("."), path) for path in files]


class StudyMenu(QPushButton):
    """ready (StudyFile): of the design at hand; opened (Path): the file of a study.

    of   the whole design at hand, and the number of its drive that is shown
    """

    ready = Signal(object)
    opened = Signal(object)

    def __init__(self, of: Callable[[], tuple[Design, int]]) -> None:
        super().__init__("Open a study")
        self._of = of
        self.setAutoDefault(False)
        menu = QMenu(self)
        menu.aboutToShow.connect(self._fill)
        menu.setToolTipsVisible(True)
        self.setMenu(menu)

    def _fill(self) -> None:
        menu = self.menu()
        clear_menu(menu)
        design, drive = self._of()
        menu.addSection("For this design")
        for name, row in READY.items():
            file = ready_study(design, name, min(drive, len(design.drives) - 1))
            action = menu.addAction(row.title, partial(self.ready.emit, file))
            action.setEnabled(file is not None)
        menu.addSection("Examples")
        for text, path in example_studies():
            menu.addAction(text, partial(self.opened.emit, path))
        menu.addSeparator()
        menu.addAction("From a file …", self._ask)

    def _ask(self) -> None:
        path = dialogs.file_to_open(self, "Open a study", "Studies (*.toml)")
        if path is not None:
            self.opened.emit(path)


# -- survey pages ----------------------------------------------------------------------------------------

MOST_CURVES = 4
LEAST_CURVE, LEAST = 70, (240, 180)  # height of a curve, size of the page, pixels
MARGIN = 4


class SurveyPages(QStackedWidget):
    """What a survey has found; the design stands in it."""

    def __init__(self) -> None:
        super().__init__()
        self.map, self.parallel, self.front = SurveyPlot(), ParallelPlot(), FrontPlot()
        self.curves = [SurveyPlot(upright=True) for _ in range(MOST_CURVES)]
        self._whole: Design | None = None
        self._found: Survey | None = None
        self._every: Sequence[Measured] = ()
        self._curves_page = QWidget()
        stacked = QVBoxLayout(self._curves_page)
        stacked.setContentsMargins(0, 0, 0, 0)
        stacked.setSpacing(0)
        for plot in self.curves:
            plot.setMinimumHeight(LEAST_CURVE)
            stacked.addWidget(plot, 1)
        for page in (self.map, self._curves_page, self.parallel, self.front):
            self.addWidget(page)
        self.setMinimumSize(*LEAST)
        self.tip = QLabel(self.map)
        self.tip.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.tip.setMargin(MARGIN)
        self.tip.setBackgroundRole(QPalette.ColorRole.Base)
        self.tip.setAutoFillBackground(True)
        self.tip.hide()
        for plot in (self.map, *self.curves):
            plot.hovered.connect(partial(self._hover, plot))
        self.parallel.hovered.connect(self._hover_line)

    # -- what is drawn --------------------------------------------------------------------------------------

    def draw(
        self,
        whole: Design,
        found: Survey,
        every: Sequence[Measured],
        chosen: str,
        own: Mapping[str, float],
        front: bool,
    ) -> None:
        """Show a survey of the design, and what is asked of it; chosen: key of what is coloured; own: what the design at hand has of that;
        front: the front stays before it."""
        self._whole, self._found, self._every = whole, found, every
        self.tip.hide()
        titles = [span_title(whole, span.path) for span in found.spans]
        pages: Mapping[int, QWidget] = {1: self._curves_page, 2: self.map}
        page = pages.get(len(found.spans), self.parallel)
        if not front:
            self.setCurrentWidget(page)
        shown = next(each for each in every if each.key == chosen)
        if page is self._curves_page:
            self._draw_curves(found, every, shown, titles[0])
        elif page is self.map:
            self.map.show_map(found, shown, every, (titles[0], titles[1]))
        else:
            self._draw_designs(found, every, shown, titles, own)

    def _draw_curves(self, found: Survey, every: Sequence[Measured], shown: Measured, title: str) -> None:
        (span,) = found.spans
        chosen = sorted(every, key=lambda each: each is not shown)[:MOST_CURVES]
        rows = [each for each in every if each in chosen]
        for plot, each in zip(self.curves, rows, strict=False):
            plot.show_curve(np.linspace(span.low, span.high, found.count), found.value[each.key], each, title)
            plot.show_numbers(each is rows[-1], title)
        for i, plot in enumerate(self.curves):
            plot.setVisible(i < len(rows))

    def _draw_designs(
        self, found: Survey, every: Sequence[Measured], shown: Measured, titles: Sequence[str], own: Mapping[str, float]
    ) -> None:
        built = found.reason == ""
        rows = np.vstack([found.points, *(np.where(built, found.value[each.key], np.nan) for each in every)])
        kept = built.copy()
        for each in every:
            kept &= each.kept(found.value[each.key])
        limits = [()] * len(found.spans) + [each.limits for each in every]
        names = [*titles, *(each.title for each in every)]
        here = [own.get(key, np.nan) for key in (*(span.path for span in found.spans), *(each.key for each in every))]
        bounds = [(span.low, span.high) for span in found.spans]
        self.parallel.show_designs(names, rows, bounds, limits, kept, here, shown.colour)

    def place(self, numbers: Sequence[float]) -> None:
        """The cross, or the upright line, where the design stands."""
        if len(numbers) == 1:
            for plot in self.curves:
                plot.place_own((numbers[0], 0.0))
        elif len(numbers) == 2:
            self.map.place_own((numbers[0], numbers[1]))

    # -- under the mouse ------------------------------------------------------------------------------------

    def _hover(self, plot: SurveyPlot, at: tuple[float, float] | None) -> None:
        """All values where the mouse is."""
        if at is None or self._found is None or plot.message:
            self.tip.hide()
            return
        self._show_tip(plot, self._found.nearest(at[: len(self._found.spans)]), plot.mouse_at)

    def _hover_line(self, number: int | None) -> None:
        if number is None or self._found is None:
            self.tip.hide()
        else:
            self._show_tip(self.parallel, number, QPointF(0.0, 0.0))

    def _show_tip(self, plot: QWidget, number: int, mouse: QPointF) -> None:
        found, whole = self._found, self._whole
        assert found is not None, "as the caller saw"
        assert whole is not None, "as the caller saw"
        lines = [
            f"{name_of(whole, span.path)} {number_text(span.path, float(value))}"
            for span, value in zip(found.spans, found.points[:, number], strict=True)
        ]
        code = str(found.reason[number])
        if code:
            lines.append(reason_text(code))
        for each in self._every:
            value = float(found.value[each.key][number])
            if value == value:
                passed = "" if each.kept(np.array(value)) else "  beyond its limit"
                lines.append(f"{each.name} {value_text(each.key, value)}{passed}")
        self.tip.setParent(plot)
        self.tip.setText("\n".join(lines))
        self.tip.adjustSize()
        right, low = mouse.x() > 0.5 * plot.width(), mouse.y() > 0.5 * plot.height()
        x = MARGIN * 15 if right else plot.width() - self.tip.width() - 18
        self.tip.move(max(0, x), 24 if low else max(24, plot.height() - self.tip.height() - 44))
        self.tip.show()
        self.tip.raise_()
