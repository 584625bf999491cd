"""Study: vary numbers and words of the design, compare many designs, and drag the current one over their map."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import groupby
from math import floor, log10
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QHideEvent
from PySide6.QtWidgets import (
    QHBoxLayout,
    QLabel,
    QPushButton,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from core.design import Design, Tolerance, get
from core.design.fields import in_sentence
from core.design.limits import Waviness
from core.errors import DesignError, KindynaError
from core.number_text import count_text
from core.study import Study
from core.varying import (
    StudyFile,
    Survey,
    ToleranceResult,
    can_be_varied,
    current_figures,
    default_tolerance,
    file_of_question,
    request_keys,
    rounded_optimum,
    study_of,
    whole_numbers,
    with_values,
)
from kindyna_gui import dialogs
from kindyna_gui.documents.edits import Refusal
from kindyna_gui.documents.figures import label_of, name_of
from kindyna_gui.documents.pins import Bands, Pins, scatters
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.exact_switch import takes_exact
from kindyna_gui.labels import reason
from kindyna_gui.look import described, scrolled
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import STRETCH, connect_all, fill, widget_with
from kindyna_gui.studies.best_page import BestPage, TolerancePage
from kindyna_gui.studies.board import Board, BoardFile, Card
from kindyna_gui.studies.plots import SurveyQuantity
from kindyna_gui.studies.rows import FigureRows, SpanRows
from kindyna_gui.studies.study_request import StudyRequest
from kindyna_gui.studies.study_runs import (
    StudyMenu,
    SurveyPages,
    SurveyRun,
    ToleranceRun,
    design_of_front,
    differs_only_in,
    open_study,
    save_request,
)
from kindyna_gui.studies.texts import (
    group_of,
    number_text,
    reason_text,
    section_of,
    share_html,
    survey_quantity,
    value_text,
)
from kindyna_gui.view import BackgroundView, ViewHost

TOLERANCE_TAB, BEST_TAB = 1, 2
FORM_WIDTH = 348  # pixels
MESSAGE_LINES = 2
DRAG_STEPS = 400  # distinguishable values of a number between its bounds when it is dragged
EMPTY = (
    "Right-click a number in the forms and choose “Vary this”, or choose one here on the left.\n"
    "One number gives curves, two a map, more give parallel coordinates."
)
WORDS_ONLY = "Words are tried one by one: find the best design on the left."
NO_QUANTITY = "Add a quantity on the left."
SIMULATING = "Simulating machines …"
NO_SHARE = "Enter a tolerance ± and a limit to see the share of machines within it."


class StudyView(BackgroundView):
    """The dock Study: forms on the left, plots of the survey on the right, the board of saved designs below.

    Attributes
    ----------
    request : StudyRequest
        What is varied and computed.
    surveys : SurveyRun
        The survey on display, computed in the background.
    """

    is_design_wide = True

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.request = StudyRequest(self)
        self.surveys, self._machines = SurveyRun(self), ToleranceRun(self)
        self._drawn: tuple[object, ...] = ()
        self._before: Design | None = None  # at the start of a drag
        self._refused = ""
        self._values: Mapping[str, float] = {}
        self._result: ToleranceResult | None = None
        self._menu_keys: tuple[object, ...] = ()
        self.rows, self.figure_rows, self.board = SpanRows(), FigureRows(), Board()
        self.tolerances, self.best = TolerancePage(), BestPage()
        self.pages = SurveyPages()
        self.map, self.tip = self.pages.map, self.pages.tip
        self.message = QLabel(wordWrap=True, alignment=Qt.AlignmentFlag.AlignTop)
        self.update_style()
        self.share = QLabel(wordWrap=True, textInteractionFlags=Qt.TextInteractionFlag.TextSelectableByMouse)
        self.bands = Bands.of(session)
        self._board_file = BoardFile(session, self.board)
        self.open = StudyMenu(lambda: (self._design, self.session.chosen))
        self.save = described(
            QPushButton("Save the study …", autoDefault=False),
            tip="Save a study file for the commands kindyna --headless vary and tolerance",
        )
        self._lay_out()
        self._connect()

    # -- layout -------------------------------------------------------------------------------------------

    def update_style(self) -> None:
        """Reserve the height of the message, so that nothing moves under the mouse."""
        self.message.setFixedHeight(MESSAGE_LINES * self.fontMetrics().lineSpacing() + 2)

    def _lay_out(self) -> None:
        """Lay out the page from outside in: a widget that is put into another one takes its style again, with all inside."""
        self._form, self.tabs = QWidget(), QTabWidget(documentMode=True)
        self._form.setFixedWidth(FORM_WIDTH)
        self.share.setContentsMargins(8, 0, 6, 4)
        result = fill(QVBoxLayout(), (self.pages, 1), self.message, self.board, margins=(0, 4, 6, 4), spacing=4)
        self.set_content_layout(fill(QHBoxLayout(), self._form, (result, 1), margins=0, spacing=0))
        files = fill(QHBoxLayout(), self.open, self.save, STRETCH, margins=(8, 0, 6, 0))
        fill(QVBoxLayout(self._form), files, (self.tabs, 1), self.share, margins=(0, 4, 0, 0), spacing=4)
        vary = widget_with(fill(QVBoxLayout(), self.rows, self.figure_rows, STRETCH, margins=(8, 6, 6, 6), spacing=10))
        for title, page in (("Vary", vary), ("Tolerances", self.tolerances), ("Best design", self.best)):
            self.tabs.addTab(scrolled(page, sideways=False), title)
        self.setFocusProxy(self.open)

    def _connect(self) -> None:
        connect_all(
            (self.request.changed, self._update),
            (self.surveys.finished, self._show_survey),
            (self._machines.finished, self._show_machines),
            (self.rows.add_requested, self.vary),
            (self.rows.changed, self.request.set_span),
            (self.rows.removed, self.request.keep_fixed),
            (self.rows.tolerance_changed, self._set_width),
            (self.rows.words_changed, self.request.set_words),
            (self.figure_rows.add_requested, self.request.add_figure),
            (self.figure_rows.changed, self.request.change_figure),
            (self.figure_rows.shown, self._show_figure),
            (self.figure_rows.removed, self.request.remove_figure),
            (
                self.tolerances.rows.add_requested,
                lambda path: self._set_tolerance(Tolerance(path, default_tolerance(self._design, path))),
            ),
            (self.tolerances.rows.changed, self._set_tolerance),
            (self.tolerances.rows.removed, self._remove_tolerance),
            (self.tolerances.waves.changed, self._set_waves),
            (self.tolerances.bands.toggled, self.bands.set_shown),
            (self.best.goals_changed, self.request.set_goals),
            (self.best.robust_changed, self.request.set_robust),
            (self.best.search_requested, self._search),
            (self.best.stepped, self._show_path),
            (self.best.finished, self._show_optimum),
            (self.best.take_over, self._apply_optimum),
            (self.pages.front_picked, self._apply_front_point),
            (self.pages.picked, self._pick),
            (self.pages.grabbed, self._grab),
            (self.pages.dragged, self._drag_to),
            (self.pages.released, self._release),
            (self.pages.brushed, self._draw),
            (self.pages.line_picked, self._pick_line),
            (self.tabs.currentChanged, self._change_tab),
            (self.open.ready, self.load_study),
            (self.open.opened, self._open_file),
            (self.save.clicked, self._save),
        )
        connect_all(
            (self.board.keep_requested, self._keep),
            (self.board.compared, self._show_compared),
            (self.board.reopened, lambda design: self._put(design, "Reopen a card")),
            (self._board_file.message, self.status_message),
            (self.session.refused, self._note_refusal),
            (self.session.started, self._clear),
        )

    def belong_to(self, window: ViewHost) -> None:
        super().belong_to(window)
        self.board.keep_requested.connect(lambda: window.show_message("Saved on the board"))
        self.board.pinned.connect(window.pin)

    # -- changes of the request ---------------------------------------------------------------------------

    def vary(self, path: str) -> None:
        """Vary a number or a word."""
        try:
            self.request.vary(self._design, self.session.full_study, path)
        except ValueError as error:
            self.status_message.emit(str(error))

    def load_study(self, file: StudyFile) -> None:
        """Replace the request by that of a study file of the current design."""
        self.request.load(file)
        self.best.clear()
        if self.request.goals:
            self.tabs.setCurrentIndex(BEST_TAB)
        self._update()

    def _show_figure(self, key: str) -> None:
        self.request.shown = key
        self._draw()

    def _clear(self) -> None:
        self.request.clear()
        self.surveys.clear()
        self.best.clear()

    def _update(self) -> None:
        self._stale = True
        if self.on_screen():
            self.pull()

    # -- display ------------------------------------------------------------------------------------------

    @property
    def _design(self) -> Design:
        design: Design = self.session.full_design
        return design

    def refresh(self, study: Study) -> None:
        design, request = self._design, self.request
        fields = tuple(can_be_varied(design))
        request.restrict_to(design, fields)
        self._fill_menus(fields)
        self._board_file.load()
        self.rows.show_varied(
            design,
            request.spans,
            request.words,
            {path: request.valid_words(design, path) for path in request.words},
        )
        self.figure_rows.show_figures(design, request.figures, request.shown)
        self.tolerances.show_design(design)
        self.best.show_goals(design, (*request.figures, *request.spans), request.goals, request.robust)
        self.save.setEnabled(bool(request.spans or request.words) and bool(request.figures))
        self.board.setVisible(bool(request.spans) or bool(self.board.cards))
        if not request.spans or not request.figures:
            self.surveys.clear()
            self.pages.setCurrentWidget(self.map)
            self.map.show_message(NO_QUANTITY if request.spans else WORDS_ONLY if request.words else EMPTY)
            self._say("")
        elif self.surveys.request(design, tuple(request.spans.values()), request.figures, request.seed):
            if self._drawn != self._shown_data:
                self._draw()
            self._mark_design()
        self.refresh_in_turn(self._show_current_values)
        self._request_machines()

    def _fill_menus(self, fields: tuple[str, ...]) -> None:
        """Fill the menus that add a row; they depend on the kind of design only."""
        design = self._design
        slugs = tuple(request_keys(design))
        if (fields, slugs) == self._menu_keys:
            return
        self._menu_keys = fields, slugs

        def scattering() -> list[str]:
            counts = whole_numbers(design, fields)
            return [path for path in fields if path not in counts]

        self.rows.offer(lambda: _grouped(design, fields, section_of, name_of), is_empty=not fields)
        self.figure_rows.offer(lambda: _grouped(design, slugs, group_of, label_of), is_empty=not slugs)
        self.tolerances.rows.offer(lambda: _grouped(design, scattering(), section_of, name_of), is_empty=not fields)

    @property
    def _shown_data(self) -> tuple[object, ...]:
        return self.surveys.survey, tuple(self.request.figures.items()), self.request.shown

    def _show_survey(self, error: KindynaError | None) -> None:
        if error is None:
            self._draw()
        else:
            self.map.show_message(reason(self.session.design, error))
            self.pages.setCurrentWidget(self.map)

    def _draw(self) -> None:
        survey, self._drawn = self.surveys.survey, self._shown_data
        if survey is None or not self.request.figures:
            return
        if any(key not in survey.value for key in self.request.figures):
            return  # the next survey is being computed
        quantities = [self._quantity(key) for key in self.request.figures]
        values = {**self._values, **dict(zip(self.request.spans, self._numbers(), strict=True))}
        self.pages.draw(self._design, survey, quantities, self.request.shown, values, self._shows_front)
        self._mark_design()
        self._describe(survey)

    def _quantity(self, key: str) -> SurveyQuantity:
        return survey_quantity(self._design, key, *self.request.figures.get(key, (None, None)))

    def _describe(self, survey: Survey) -> None:
        """Show the number of designs, and the most frequent reason why designs cannot be built."""
        failed = survey.reason[survey.reason != ""]
        text = f"{count_text(survey.reason.size)} designs"
        if failed.size:
            codes, counts = np.unique(failed.astype(str), return_counts=True)
            most = reason_text(str(codes[counts.argmax()]))
            text += f", {count_text(failed.size)} without a result, mostly: {in_sentence(most)}"
        self._say(f"{text}{' …' if self.surveys.is_computing else ''}")

    def _say(self, text: str) -> None:
        self.message.setText(text)
        self.message.setToolTip(text)

    def _numbers(self) -> list[float]:
        return [float(get(self._design, path)) for path in self.request.spans]

    def _mark_design(self) -> None:
        if self.session.drag_source is not self or not self._refused:
            self.pages.mark_design(self._numbers())

    def _show_current_values(self) -> None:
        """Show the figures of the current design; during a drag those of the nearest design of the survey."""
        figures, survey = self.request.figures, self.surveys.survey
        if not figures or not self.on_screen():
            return
        has_figures = survey is not None and set(figures) <= set(survey.value)
        try:
            if self.session.drag_source is self and survey is not None and has_figures:
                nearest = survey.nearest(self._numbers())
                self._values = {key: float(survey.value[key][nearest]) for key in figures}
            else:
                self._values, _ = current_figures(self.session.full_study, tuple(figures))
        except (KindynaError, ValueError):
            self._values = {}
        self.figure_rows.show_values(self._values)
        self._show_compared()
        if len(self.request.spans) > 2 and has_figures:
            self._draw()

    # -- tolerances ---------------------------------------------------------------------------------------

    def _set_width(self, path: str, width: float | None) -> None:
        """Set the tolerance ± of a number; None removes it."""
        if width is None:
            self._remove_tolerance(path)
        else:
            rows = self._design.tolerances
            before = next((row for row in rows if row.field == path), Tolerance(path, width))
            self._set_tolerance(replace(before, plus=width, minus=None))

    def _set_tolerance(self, tolerance: Tolerance) -> None:
        rows, path = self._design.tolerances, tolerance.field
        if any(row.field == path for row in rows):
            self._put_tolerances(tuple(tolerance if row.field == path else row for row in rows), path)
        else:
            self._put_tolerances((*rows, tolerance), path)

    def _remove_tolerance(self, path: str) -> None:
        self._put_tolerances(tuple(row for row in self._design.tolerances if row.field != path), path)

    def _put_tolerances(self, rows: tuple[Tolerance, ...], path: str) -> None:
        design = self._design
        if rows != design.tolerances:
            text = f"Tolerance of {in_sentence(name_of(design, path))}"
            self.session.put_full_design(replace(design, tolerances=rows), text)
            self.session.end_gesture()

    def _set_waves(self, waves: Waviness | None) -> None:
        if waves != self._design.waviness:
            self.session.put_full_design(replace(self._design, waviness=waves), "Waves of the profile")
            self.session.end_gesture()

    def _request_machines(self) -> None:
        """Simulate machines built to the tolerances, once the design rests."""
        request, can_scatter = self.request, scatters(self._design)
        if not can_scatter or not request.figures:
            self._machines.stop()
            self._show_tolerances(None)
        elif (
            self._machines.request(self._design, request.figures, request.seed, self._shows_tolerances)
            and request.has_limits
        ):
            self.share.setText(SIMULATING)
        if not can_scatter or not request.has_limits:
            self.share.setText(NO_SHARE if request.spans else "")

    def _show_machines(self, result: ToleranceResult | KindynaError, has_tighter: bool) -> None:
        if isinstance(result, KindynaError):
            self.share.setText(reason(self._design, result))
            self._show_tolerances(None)
            return
        if result.share is not None and not has_tighter:
            self.share.setText(share_html(self._design, result))
        self._show_tolerances(result, has_tighter)

    def _show_tolerances(self, result: ToleranceResult | None, has_tighter: bool = False) -> None:
        self._result = result
        self.tolerances.show_result(self._design, result, has_tighter)

    @property
    def _shows_tolerances(self) -> bool:
        return self.tabs.currentIndex() == TOLERANCE_TAB

    # -- best design --------------------------------------------------------------------------------------

    def _search(self) -> None:
        if not self.request.spans and not self.request.words:
            self.best.refuse("Nothing is varied: right-click a value and choose “Vary this”, or open a study.")
        elif not self.request.goals:
            self.best.refuse("Choose one of the quantities, or of the varied numbers, as the goal.")
        else:
            try:
                self.best.search(study_of(file_of_question(self.request.question()), self._design))
            except KindynaError as error:
                self.best.refuse(reason(self._design, error))

    def _show_path(self) -> None:
        """Show the path of the search on the map, or across the axes."""
        paths = list(self.request.spans)
        steps = [step for step in self.best.path if all(path in step[0] for path in paths)]
        steps.sort(key=lambda step: step[2])  # all starts advance in step
        rows = np.array([[step[0][path] for path in paths] for step in steps], dtype=float)
        starts = np.array([step[2] for step in steps], dtype=int)
        self.pages.show_path(rows.reshape(len(steps), len(paths)), starts)

    def _show_optimum(self) -> None:
        optimum, study = self.best.optimum, self.best.study
        if optimum is not None and study is not None and optimum.front:
            first, second = (self._quantity(goal.key) for goal in study.file.goals)
            points = [[point[goal.column] for point in optimum.front] for goal in study.file.goals]
            self.pages.front.show_front(np.array(points), first, second)
        self._change_tab(self.tabs.currentIndex())

    @property
    def _shows_front(self) -> bool:
        optimum = self.best.optimum
        return self.tabs.currentIndex() == BEST_TAB and optimum is not None and bool(optimum.front)

    def _change_tab(self, _: int) -> None:
        if self._shows_front:
            self.pages.setCurrentWidget(self.pages.front)
        elif self.surveys.survey is not None:
            self._draw()
        if self._result is None or self._shows_tolerances:
            self._request_machines()

    def _apply_optimum(self, optimum: Design) -> None:
        """Use the best design, unless the current one has changed elsewhere since the search began."""
        study, design = self.best.study, self._design
        if study is None or not differs_only_in(study.base, design, [row.field for row in study.file.vary]):
            self.best.refuse("The design has changed elsewhere since the search. Find the best again.")
            return
        optimum = replace(optimum, tolerances=design.tolerances, waviness=design.waviness)
        self._put(optimum, "Take over the best design")
        if study.file.goals[0].field:
            Pins.of(self.session).pin_change(design, optimum, in_sentence(name_of(design, study.file.goals[0].field)))

    def _apply_front_point(self, number: int) -> None:
        optimum, study = self.best.optimum, self.best.study
        if optimum is not None and study is not None:
            point = optimum.front[number]
            try:
                design = design_of_front(self._design, study, point)
                if not takes_exact():
                    answer = {row.field: point[row.field] for row in study.file.vary}
                    rounded = rounded_optimum(study, replace(optimum, answer=answer, design=design))
                    design = design_of_front(self._design, study, rounded.answer)
            except KindynaError as error:
                self.status_message.emit(reason(self._design, error))
            else:
                self._put(design, "Take over a design of the front")

    def _put(self, design: Design, text: str) -> None:
        """Use a design, as one step of Undo."""
        with self.session.one_step():
            self.session.put_full_design(design, text)

    # -- study files --------------------------------------------------------------------------------------

    def _open_file(self, path: Path) -> None:
        try:
            file = open_study(path, self.session, self.host)
        except KindynaError as error:
            lines = [str(fault) for fault in error.faults] if isinstance(error, DesignError) else [str(error)]
            dialogs.show_faults(self, f"{path.name} cannot be opened.", lines)
        else:
            if file is not None:
                self.load_study(file)

    def _save(self) -> None:
        message = save_request(self.request.question(), self.session, self)
        if message:
            self.status_message.emit(message)

    # -- mouse --------------------------------------------------------------------------------------------

    def _grab(self) -> None:
        self.player.play(False)
        self._before, self._refused = self._design, ""
        self.session.begin_drag(self)
        self.tip.hide()

    def _drag_to(self, x: float, y: float) -> None:
        """Move the cross to the mouse; the design follows as far as it can be built."""
        self._refused = ""
        self._set_numbers((x, y)[: len(self.request.spans)])
        self.pages.mark((x, y), refused=bool(self._refused))
        if self._refused:
            self._say(self._refused)
        elif self.surveys.survey is not None:
            self._describe(self.surveys.survey)

    def _release(self, is_dropped: bool) -> None:
        """End the drag; the cross returns to the design. Escape restores the design from before the drag."""
        if self.session.drag_source is not self:
            return
        path = next(iter(self.request.spans))
        if not is_dropped and self._before is not None:
            self.session.put_full_design(self._before, "Vary", path)
        self.session.end_drag()
        self._show_current_values()
        if self._refused:
            self.session.withdraw(path)
            self._refused = ""
        if self.surveys.survey is not None:
            self._describe(self.surveys.survey)
        self._mark_design()

    def _pick(self, x: float, y: float) -> None:
        self._refused = ""
        self._apply((x, y)[: len(self.request.spans)])
        if self._refused:
            self._say(self._refused)

    def _pick_line(self, number: int) -> None:
        if self.surveys.survey is not None:
            self._apply(self.surveys.survey.points[:, number].tolist())

    def _apply(self, numbers: Sequence[float]) -> None:
        """Set the varied numbers of the design, as one step of Undo."""
        with self.session.one_step():
            self._set_numbers(numbers)

    def _set_numbers(self, numbers: Sequence[float]) -> None:
        """Set the varied numbers of the design, rounded to what the plot distinguishes."""
        design, spans, values = self._design, self.request.spans, {}
        counts = whole_numbers(design, spans)
        for (path, span), number in zip(spans.items(), numbers, strict=True):
            digits = 0 if path in counts else -floor(log10((span.high - span.low) / DRAG_STEPS))
            values[path] = min(max(round(float(number), digits), span.low), span.high)
        path = next(iter(values))
        names = [in_sentence(name_of(design, key)) for key in values]
        try:
            changed = with_values(design, values)
        except KindynaError as error:
            self.session.refuse(path, reason(self.session.design, error))
        else:
            text = " and ".join(names) if len(names) < 3 else f"{len(names)} numbers"
            self.session.put_full_design(changed, f"Vary {text}", path)

    def _note_refusal(self, refusal: Refusal) -> None:
        self._refused = f"{refusal.reasons[0][1]}: {refusal.reasons[0][2]}" if refusal.reasons else "refused"

    # -- board --------------------------------------------------------------------------------------------

    def _keep(self) -> None:
        self._show_current_values()
        self.board.add(Card(self._design, self._card_values()))

    def _show_compared(self) -> None:
        if self.board.is_comparing:
            self.board.show_current(self._card_values())

    def _card_values(self) -> dict[str, tuple[float, str]]:
        """Return name -> (value, text) of the varied numbers and the figures of the current design."""
        design = self._design
        rows = {
            name_of(design, path): (number, f"{name_of(design, path)} {number_text(path, number)}")
            for path, number in zip(self.request.spans, self._numbers(), strict=True)
        }
        for quantity in map(self._quantity, self.request.figures):
            value = self._values.get(quantity.key, float("nan"))
            rows[quantity.name] = value, f"{quantity.name} {value_text(quantity.key, value)}"
        return rows

    # -- background work, files of pictures ---------------------------------------------------------------

    @property
    def busy(self) -> bool:
        return super().busy or self.surveys.busy or self._machines.busy or self.best.busy

    def settle(self) -> None:
        super().settle()
        self.surveys.settle()

    def leave(self) -> None:
        super().leave()
        self.surveys.close()
        self._machines.close()
        self.best.close_work()
        self.bands.close()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        for run in (self.surveys, self._machines):
            if run.busy:
                run.stop()
                self._stale = True

    def picture(self, ending: str) -> bytes:
        """Return the plot on display, without the forms, as the content of a file."""
        from kindyna_gui.pictures.painter import png, svg

        page: Any = self.pages.currentWidget()
        return self.on_paper(page, svg if ending == ".svg" else png)


def _grouped(
    design: Design, keys: Sequence[str], group: Callable[[Design, str], str], name: Callable[[Design, str], str]
) -> Mapping[str, Mapping[str, str]]:
    """Return names of rows by their groups: group -> key -> name."""
    groups: dict[str, dict[str, str]] = {}
    for title, members in groupby(keys, key=partial(group, design)):
        groups.setdefault(title, {}).update({key: name(design, key) for key in members})
    return groups


__all__ = ["StudyView"]
