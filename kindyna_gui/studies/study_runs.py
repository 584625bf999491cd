"""Background runs of the study dock, study files, and the pages that show a survey."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial
from os.path import relpath
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QObject, QPointF, Qt, Signal
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import QLabel, QMenu, QPushButton, QStackedWidget, QVBoxLayout, QWidget

from core.design import Design, edited, get, put
from core.errors import KindynaError
from core.process import resources
from core.varying import (
    READY,
    Limits,
    Question,
    Span,
    StudyFile,
    StudyOfMany,
    Survey,
    ToleranceResult,
    file_of_question,
    load_study,
    ready_study,
    refined_survey,
    save_study,
    study_of,
    survey,
    tolerance_result,
    with_values,
)
from core.varying.tolerances import SHARE
from kindyna_gui import dialogs
from kindyna_gui.background import Background
from kindyna_gui.documents.figures import name_of
from kindyna_gui.documents.session import Session
from kindyna_gui.rebuilt import clear_menu, connect_all, fill, single_shot, widget_with
from kindyna_gui.studies.plots import FrontPlot, ParallelPlot, SurveyPlot, SurveyQuantity
from kindyna_gui.studies.texts import number_text, reason_text, span_title, value_text
from kindyna_gui.view import View, ViewHost

COARSE, FINE = 16, 64  # designs along each number: first survey, final one
FINE_CURVE, FINE_LINES = 129, 32  # final survey of one number; of more than two, whose square counts
REFINED = 0  # in the key of a job, in place of the number of designs
REST_MS = 300  # without a change of the design, before machines are simulated
SURVEY_WAIT_S = 30.0
MOST_CURVES = 4
LEAST_CURVE, LEAST_PAGE = 70, (240, 180)  # height of a curve, size of the page, pixels
MARGIN = 4

# -- background runs -------------------------------------------------------------------------------------


class _BackgroundRun(QObject):
    """Background work on a request of a view, which starts after a pause, and only while the view is visible."""

    def __init__(self, view: View, pause_ms: int) -> None:
        super().__init__(view)
        self._view = view
        self._request: tuple[Any, ...] = ()
        self._work = Background(self)
        self._work.result.connect(self._receive)
        self._timer = single_shot(self, self._start_if_visible, pause_ms)

    @property
    def busy(self) -> bool:
        """Whether a request is being computed, or about to be."""
        return self._work.busy or self._timer.isActive()

    def stop(self) -> None:
        """Stop the computation; the next request starts it again."""
        self._request = ()
        self._timer.stop()
        self._work.stop()

    def close(self) -> None:
        """Stop for good."""
        self.stop()
        self._work.close()

    def _replace(self, request: tuple[Any, ...]) -> bool:
        """Replace the request by a new one; return whether it is new."""
        if request == self._request:
            return False
        self.stop()
        self._request = request
        self._timer.start()
        return True

    def _start_if_visible(self) -> None:
        if self._view.on_screen():
            self._start()
        else:
            self._request = ()
            self._view.invalidate()

    def _start(self) -> None:
        raise NotImplementedError

    def _receive(self, key: tuple[Any, ...], result: Any) -> None:
        raise NotImplementedError


class SurveyRun(_BackgroundRun):
    """Surveys of a design in the background: coarse, then fine, then with finer cells along the limits.

    A new survey is started only if something else than the varied numbers changes.

    Attributes
    ----------
    survey : Survey or None
        The latest survey, None before the first one.
    """

    finished = Signal(object)
    """The KindynaError of a survey that failed, None after a successful one."""

    def __init__(self, view: View) -> None:
        super().__init__(view, 0)
        self.survey: Survey | None = None
        self._design = view.session.full_design
        self._figures: Mapping[str, Limits] = {}
        self._unrefined: Survey | None = None
        self._refined_limits: Mapping[str, Limits] = {}

    @property
    def is_computing(self) -> bool:
        """Whether a survey is being computed."""
        return self._work.busy

    def request(self, design: Design, spans: tuple[Span, ...], figures: Mapping[str, Limits], seed: int) -> bool:
        """Start a survey of a design if none was started yet; return whether a survey of this request is available."""
        try:
            fixed = with_values(design, {span.path: span.low for span in spans})
        except KindynaError:
            fixed = design
        self._design, self._figures = design, dict(figures)
        if self._replace((replace(fixed, tolerances=(), waviness=None), spans, tuple(figures), seed)):
            self._unrefined = None
            return False
        if self._unrefined is not None and self._refined_limits != self._figures:
            self.survey = self._unrefined
            self._refine(self._unrefined)
        return self.survey is not None

    def clear(self) -> None:
        """Stop, and remove the survey."""
        self.stop()
        self.survey = None

    def settle(self) -> None:
        """Wait for the results of what was requested."""
        if self._timer.isActive():
            self._timer.stop()
            self._start_if_visible()
        self._work.wait(SURVEY_WAIT_S)

    def _start(self) -> None:
        _, spans, keys, seed = self._request
        finest = {1: FINE_CURVE, 2: FINE}.get(len(spans), FINE_LINES)
        job = partial(survey, self._design, spans, keys)
        self._work.start([((self._request, count), partial(job, count, seed)) for count in (COARSE, finest)])

    def _receive(self, key: tuple[Any, ...], result: Survey | KindynaError) -> None:
        request, count = key
        if request != self._request:
            return
        if isinstance(result, KindynaError):
            self.survey = None
            self.finished.emit(result)
            return
        self.survey = result
        self.finished.emit(None)
        if count != REFINED and len(result.spans) == 2 and result.count == FINE and not self._work.busy:
            self._refine(result)

    def _refine(self, unrefined: Survey) -> None:
        """Compute finer cells along the limits."""
        self._unrefined, self._refined_limits = unrefined, self._figures
        job = partial(refined_survey, self._design, unrefined, dict(self._figures))
        self._work.start([((self._request, REFINED), job)])


class ToleranceRun(_BackgroundRun):
    """Simulation in the background of machines built to the tolerances of a design, once the design rests."""

    finished = Signal(object, bool)
    """The ToleranceResult or the KindynaError, and whether the tolerances to tighten are computed."""

    def __init__(self, view: View) -> None:
        super().__init__(view, REST_MS)

    def request(self, design: Design, figures: Mapping[str, Limits], seed: int, tighter: bool) -> bool:
        """Simulate machines of a design if that was not requested yet; return whether it was not.

        tighter: also compute which tolerances to tighten if too few machines keep the limits.
        """
        return self._replace((design, tuple(figures.items()), seed, tighter))

    def _start(self) -> None:
        if self._view.session.drag_source is self._view:  # the mouse still changes the design
            self._timer.start()
        else:
            self._simulate(tighten=False)

    def _simulate(self, tighten: bool) -> None:
        design, figures, seed, _ = self._request
        job = partial(tolerance_result, design, dict(figures), tighten, seed=seed)
        self._work.start([((self._request, tighten), job)])

    def _receive(self, key: tuple[Any, ...], result: ToleranceResult | KindynaError) -> None:
        request, has_tighter = key
        if request != self._request or (has_tighter and isinstance(result, KindynaError)):
            return
        share = result.share if isinstance(result, ToleranceResult) else None
        self.finished.emit(result, has_tighter)
        if share is not None and share.value < SHARE and request[-1] and not has_tighter:
            self._simulate(tighten=True)


# -- designs of a search ---------------------------------------------------------------------------------


def design_of_front(design: Design, study: StudyOfMany, point: Mapping[str, Any]) -> Design:
    """Return a design with the varied values of a point of the front. Raises KindynaError."""
    values = {row.field: point[row.field] for row in study.file.vary}
    for path, value in values.items():
        if isinstance(value, str):
            design = edited(design, path, value)
    return with_values(design, {path: value for path, value in values.items() if not isinstance(value, str)})


def differs_only_in(first: Design, second: Design, paths: Sequence[str]) -> bool:
    """Whether two designs differ at most in these fields and in tolerances."""
    try:
        second = replace(second, tolerances=first.tolerances, waviness=first.waviness, assumed=first.assumed)
        for path in paths:
            second = put(second, path, get(first, path))
    except KindynaError:
        return False
    return second == first


# -- study files -----------------------------------------------------------------------------------------


def open_study(path: Path, session: Session, host: ViewHost | None) -> StudyFile | None:
    """Open a study file for the current design if the study names its file or equals it, else with the design it names.

    Returns None where the user keeps the current design. Raises KindynaError.
    """
    study = load_study(path)
    named = (path.parent / study.file.design).resolve()
    if study.base == session.full_design:
        return study.file
    if session.path is not None and session.path.resolve() == named:
        return study_of(study.file, session.full_design).file
    return study.file if host is not None and host.open_design(named) else None


def save_request(question: Question, session: Session, parent: QWidget) -> str:
    """Save a request as a study file, which names the file of the design; return a message, empty where cancelled."""
    design_path = session.path
    if design_path is None:
        return "A study names the file of its design: save the design first"
    path = dialogs.study_to_save(parent, design_path.with_name(f"{design_path.stem}_study.toml"))
    if path is None:
        return ""
    try:
        save_study(file_of_question(question, relpath(design_path, path.parent)), path)
    except KindynaError as error:
        return str(error)
    return f"Saved {path.name} for the last saved version of {design_path.name}"


def example_studies() -> list[tuple[str, Path]]:
    """Return the title, which is the first line, and the path of each example study."""
    files = sorted((resources() / "studies").glob("*.toml"))
    return [(path.read_text("utf-8").partition("\n")[0].removeprefix("# ").removesuffix("."), path) for path in files]


class StudyMenu(QPushButton):
    """Button that offers studies of the current design, examples, and files.

    Signals: ``ready`` (StudyFile), a study of the current design; ``opened`` (Path), the file of a study.
    ``current`` returns the current design and the number of the drive that is shown.
    """

    ready = Signal(object)
    opened = Signal(object)

    def __init__(self, current: Callable[[], tuple[Design, int]]) -> None:
        super().__init__("Open a study")
        self._current = current
        self.setAutoDefault(False)
        menu = QMenu(self)
        menu.aboutToShow.connect(self._fill)
        menu.setToolTipsVisible(True)
        self.setMenu(menu)

    def _fill(self) -> None:
        menu = self.menu()
        clear_menu(menu)
        design, drive = self._current()
        menu.addSection("For this design")
        for name, row in READY.items():
            file = ready_study(design, name, min(drive, len(design.drives) - 1))
            action = menu.addAction(row.title, partial(self.ready.emit, file))
            action.setEnabled(file is not None)
        menu.addSection("Examples")
        for text, path in example_studies():
            menu.addAction(text, partial(self.opened.emit, path))
        menu.addSeparator()
        menu.addAction("From a file …", self._choose_file)

    def _choose_file(self) -> None:
        path = dialogs.file_to_open(self, "Open a study", "Studies (*.toml)")
        if path is not None:
            self.opened.emit(path)


# -- pages of a survey -----------------------------------------------------------------------------------


class SurveyPages(QStackedWidget):
    """Plots of a survey, in which the current design is marked: curves, map, parallel coordinates, front.

    All but the map are created when they are first needed.

    Signals
    - picked, grabbed, dragged, released: those of the map and the curves
    - brushed, line_picked: ranges of parallel coordinates have changed, and a line of them is clicked
    - front_picked: a design of the front is clicked
    """

    picked = Signal(float, float)
    grabbed = Signal()
    dragged = Signal(float, float)
    released = Signal(bool)
    brushed = Signal()
    line_picked = Signal(int)
    front_picked = Signal(int)

    def __init__(self) -> None:
        super().__init__()
        self.map = self._survey_plot()
        self._design: Design | None = None
        self._survey: Survey | None = None
        self._quantities: Sequence[SurveyQuantity] = ()
        self.addWidget(self.map)
        self.setMinimumSize(*LEAST_PAGE)
        self.tip = QLabel(self.map, margin=MARGIN)
        self.tip.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.tip.setBackgroundRole(QPalette.ColorRole.Base)
        self.tip.setAutoFillBackground(True)
        self.tip.hide()

    def _survey_plot(self, upright: bool = False) -> SurveyPlot:
        plot = SurveyPlot(upright=upright)
        connect_all(
            (plot.hovered, partial(self._hover, plot)),
            (plot.picked, self.picked),
            (plot.grabbed, self.grabbed),
            (plot.dragged, self.dragged),
            (plot.released, self.released),
        )
        return plot

    @cached_property
    def curves(self) -> list[SurveyPlot]:
        """Plots over one number."""
        plots = [self._survey_plot(upright=True) for _ in range(MOST_CURVES)]
        for plot in plots:
            plot.setMinimumHeight(LEAST_CURVE)
        return plots

    @cached_property
    def _curves_page(self) -> QWidget:
        page = widget_with(fill(QVBoxLayout(), *((plot, 1) for plot in self.curves), margins=0, spacing=0))
        self.addWidget(page)
        return page

    @cached_property
    def parallel(self) -> ParallelPlot:
        """Parallel coordinates of three and more numbers."""
        plot = ParallelPlot()
        connect_all((plot.hovered, self._hover_line), (plot.brushed, self.brushed), (plot.picked, self.line_picked))
        self.addWidget(plot)
        return plot

    @cached_property
    def front(self) -> FrontPlot:
        """Front of two goals."""
        plot = FrontPlot()
        plot.picked.connect(self.front_picked)
        self.addWidget(plot)
        return plot

    def mark(self, at: tuple[float, float], refused: bool) -> None:
        """Move the cross of every map and curve to a point."""
        for plot in (self.map, *vars(self).get("curves", ())):
            plot.mark_design(at, refused=refused)

    def show_path(self, rows: np.ndarray, starts: np.ndarray) -> None:
        """Show the steps (m, spans) of a search on the map, or across the axes."""
        for plot in (self.map, *([self.parallel] if "parallel" in vars(self) or rows.shape[1] > 2 else [])):
            plot.show_path(rows, starts)

    def draw(
        self,
        design: Design,
        survey: Survey,
        quantities: Sequence[SurveyQuantity],
        shown_key: str,
        values: Mapping[str, float],
        keeps_front: bool,
    ) -> None:
        """Show a survey of the design, coloured by one quantity.

        shown_key: key of the quantity that colours the plots; values: numbers and figures of the current design;
        keeps_front: the page with the front of designs remains in front.
        """
        self._design, self._survey, self._quantities = design, survey, quantities
        self.tip.hide()
        titles = [span_title(design, span.path) for span in survey.spans]
        count = len(survey.spans)
        page = self._curves_page if count == 1 else self.map if count == 2 else self.parallel
        if not keeps_front:
            self.setCurrentWidget(page)
        shown = next(quantity for quantity in quantities if quantity.key == shown_key)
        if count == 1:
            self._draw_curves(survey, quantities, shown, titles[0])
        elif count == 2:
            self.map.show_map(survey, shown, quantities, (titles[0], titles[1]))
        else:
            self._draw_designs(survey, quantities, shown, titles, values)

    def _draw_curves(
        self, survey: Survey, quantities: Sequence[SurveyQuantity], shown: SurveyQuantity, title: str
    ) -> None:
        (span,) = survey.spans
        selected = sorted(quantities, key=lambda quantity: quantity is not shown)[:MOST_CURVES]
        rows = [quantity for quantity in quantities if quantity in selected]
        x = np.linspace(span.low, span.high, survey.count)
        for plot, quantity in zip(self.curves, rows, strict=False):
            plot.show_curve(x, survey.value[quantity.key], quantity, title)
            plot.show_numbers(quantity is rows[-1], title)
        for i, plot in enumerate(self.curves):
            plot.setVisible(i < len(rows))

    def _draw_designs(
        self,
        survey: Survey,
        quantities: Sequence[SurveyQuantity],
        shown: SurveyQuantity,
        titles: Sequence[str],
        values: Mapping[str, float],
    ) -> None:
        built = survey.reason == ""
        columns = [np.where(built, survey.value[quantity.key], np.nan) for quantity in quantities]
        within = built.copy()
        for quantity in quantities:
            within &= quantity.is_within(survey.value[quantity.key])
        keys = [*(span.path for span in survey.spans), *(quantity.key for quantity in quantities)]
        self.parallel.show_designs(
            titles=[*titles, *(quantity.title for quantity in quantities)],
            rows=np.vstack([survey.points, *columns]),
            bounds=[(span.low, span.high) for span in survey.spans],
            limits=[()] * len(survey.spans) + [quantity.limits for quantity in quantities],
            within=within,
            current=[values.get(key, np.nan) for key in keys],
            colour=shown.colour,
        )

    def mark_design(self, numbers: Sequence[float]) -> None:
        """Move the cross, or the upright line, to the varied numbers of the current design."""
        if len(numbers) == 1:
            for plot in self.curves:
                plot.mark_design((numbers[0], 0.0))
        elif len(numbers) == 2:
            self.map.mark_design((numbers[0], numbers[1]))

    def _hover(self, plot: SurveyPlot, at: tuple[float, float] | None) -> None:
        if at is None or self._survey is None or plot.message:
            self.tip.hide()
        else:
            self._show_tip(plot, self._survey.nearest(at[: len(self._survey.spans)]), plot.mouse_at)

    def _hover_line(self, number: int | None) -> None:
        if number is None or self._survey is None:
            self.tip.hide()
        else:
            self._show_tip(self.parallel, number, QPointF(0.0, 0.0))

    def _show_tip(self, plot: QWidget, number: int, mouse: QPointF) -> None:
        """Show all values of one design of the survey, or the reason why it has none."""
        survey, design = self._survey, self._design
        assert survey is not None, "as the caller saw"
        assert design is not None, "as the caller saw"
        lines = [
            f"{name_of(design, span.path)} {number_text(span.path, float(value))}"
            for span, value in zip(survey.spans, survey.points[:, number], strict=True)
        ]
        code = str(survey.reason[number])
        if code:
            lines.append(reason_text(code))
        for quantity in self._quantities:
            value = float(survey.value[quantity.key][number])
            if value == value:
                note = "" if quantity.is_within(np.array(value)) else "  beyond its limit"
                lines.append(f"{quantity.name} {value_text(quantity.key, value)}{note}")
        self.tip.setParent(plot)
        self.tip.setText("\n".join(lines))
        self.tip.adjustSize()
        is_right, is_low = mouse.x() > 0.5 * plot.width(), mouse.y() > 0.5 * plot.height()
        x = MARGIN * 15 if is_right else plot.width() - self.tip.width() - 18
        self.tip.move(max(0, x), 24 if is_low else max(24, plot.height() - self.tip.height() - 44))
        self.tip.show()
        self.tip.raise_()
