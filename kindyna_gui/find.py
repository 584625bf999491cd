"""Find: search a dimension that meets all limits, and plot what it costs.

The search runs in the background whenever the design or a limit changes while the view can be seen.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import (
    QBoxLayout,
    QHBoxLayout,
    QLabel,
    QProgressBar,
    QPushButton,
    QStackedWidget,
    QVBoxLayout,
)

from core.design import Design, get, with_only
from core.errors import KindynaError
from core.find import (
    LIMITS,
    LimitValue,
    Solution,
    StatedLimits,
    available_searches,
    round_solution,
    same_design,
    varied_fields,
)
from core.numerics.lazy import Cancelled
from core.study import Study
from core.varying import MACHINE_SEARCHES, available_machine_searches, search
from kindyna_gui.documents.pins import Pins
from kindyna_gui.documents.session import Session
from kindyna_gui.find_rows import (
    LimitRows,
    active_limits,
    answers_tip,
    axis_title,
    choices_of,
    initial_limits,
    keys_of,
    solution_html,
    start_value,
    step_name,
    title_of,
    typed_text,
    unit_of,
)
from kindyna_gui.forms.exact_switch import EXACT, ExactSwitch, takes_exact
from kindyna_gui.forms.fields import fill_choices
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.labels import reason, sentence
from kindyna_gui.look import described
from kindyna_gui.pictures.plots.xy import Dots, Line, Rule, XYPlot
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import short
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import STRETCH, connect_all, fill, single_shot, widget_with
from kindyna_gui.requirements import NO_SIZES, Unavailable
from kindyna_gui.settings import size_of
from kindyna_gui.view import BackgroundView

# -- trade plot ------------------------------------------------------------------------------------------

ROOM = 1.6  # highest value shown of a rising curve, as a multiple of the highest marked value
MARK_DIGITS = 6  # of the result next to its line
SIDE_MARGIN = 0.03  # left free on both sides, as a share of the width


def show_solution(plot: XYPlot, design: Design, solution: Solution) -> None:
    """Draw the result of a search.

    The curve shows a limited quantity over the dimension. The limit is a horizontal line, the result a vertical line
    and a dot, the present value a ring.
    """
    if solution.curve_over:
        _show_steps(plot, design, solution)
        return
    path, key = next(iter(solution.answer)), solution.curve_of
    low, high = solution.near
    curve = np.array([point for point in solution.curve if low <= point[0] <= high])
    x, y = curve[:, 0], np.where(np.isfinite(curve[:, 1]), curve[:, 1], np.nan)
    limit = solution.limits.get(key)
    answer = (solution.answer[path], solution.reached.get(key, solution.answer.get(key, np.nan)))
    now = (solution.present[path], solution.before.get(key, solution.present.get(key)))
    if key in solution.answer:  # a second varied field: plot it over the first one
        path, key, x, y, answer, now = key, path, y, x, answer[::-1], now[::-1]
    size = size_of(unit_of(design, path).symbol), size_of(unit_of(design, key).symbol)
    x, y, answer = x / size[0], y / size[1], (answer[0] / size[0], answer[1] / size[1])
    dots, rules = [_dot(answer)], []
    if now[0] is not None and now[1] is not None and np.isfinite(now[1]):
        now = now[0] / size[0], now[1] / size[1]
        dots.append(_dot(now, hollow=True))
    if limit is not None:
        text = f"limit {typed_text(limit, unit_of(design, key))}" if limit or key not in LIMITS else "undercut"
        limit /= size[1]
        rules.append(Rule(limit, text, SCREEN.limit, level=True))
    rules.append(Rule(answer[0], short(answer[0], MARK_DIGITS), SCREEN.ink, low=True))
    plot.name_axes(axis_title(design, path), axis_title(design, key))
    colour = SCREEN.family("pressure-angle" if key in LIMITS and LIMITS[key].is_upper else "curvature")
    plot.show_lines([Line(x, _near_marks(y, [answer[1], now[1], limit]), colour)], rules=rules, dots=dots)
    margin = SIDE_MARGIN * float(np.ptp(x))  # else a dot at the end of the curve is cut
    plot.show_range((float(x.min()) - margin, float(x.max()) + margin))


def _show_steps(plot: XYPlot, design: Design, solution: Solution) -> None:
    """Draw the result after each step of the search, with the present value as a line."""
    key = solution.curve_of
    size = size_of(unit_of(design, key).symbol)
    x, y = np.array(solution.curve).T
    present = solution.present[key]
    rules = [] if present is None else [Rule(present / size, "now", SCREEN.quiet, level=True)]
    plot.name_axes(sentence(solution.curve_over), axis_title(design, key))
    plot.show_lines([Line(x, y / size, SCREEN.family("velocity"))], rules=rules, dots=[_dot((x[-1], y[-1] / size))])
    plot.show_range((float(x[0]) - 0.5, float(x[-1]) + 0.5))


def _dot(at: tuple[float, float], hollow: bool = False) -> Dots:
    return Dots(np.array(at[:1]), np.array(at[1:]), SCREEN.ink, hollow=hollow)


def _near_marks(y: np.ndarray, marks: Sequence[float | None]) -> np.ndarray:
    """Replace values far above or below all marks by NaN, so that the marks can be told apart."""
    marked = [value for value in marks if value is not None and np.isfinite(value)]
    most = ROOM * max((abs(value) for value in marked), default=np.inf)
    near = np.where(np.abs(y) <= most, y, np.nan) if most > 0.0 else y
    return near if np.isfinite(near).sum() > 1 else y


# -- find view -------------------------------------------------------------------------------------------

PATIENCE_MS = 300  # before progress is shown
TICK_MS = 200  # between two counts
POLL_MS = 25  # each poll delays the search, which can take less than a second
WIDE = 720  # pixels, from which the curve is next to the limits
ROW = 40  # height of a limit with its reason, pixels
LOW, TALL = 120, 440  # height of everything else: with the curve next to the limits, or below them, pixels
FORM_WIDTH, QWIDGETSIZE_MAX = 330, 16777215
ANSWER_LINES = 4  # reserved for the result, so that nothing below it moves
SAME = 1e-9  # relative difference below which a value is in the design already


class TrialCount:
    """Number of designs evaluated, written by the thread of the search."""

    def __init__(self) -> None:
        self.number = 0

    def update(self, number: int) -> None:
        """Store the number of designs tried so far; called from the thread of the search."""
        self.number = number


class FindView(BackgroundView):
    """Dimension to find, its limits, and the result with its curve."""

    is_design_wide = arranges_itself = True
    stages = ("linkage", "cam")
    pause_ms = 200

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player, POLL_MS)
        self._result: SearchResult | None = None
        self.searches = 0
        self._count = TrialCount()
        self._typed: dict[str, float | None] = {}  # limits that the user typed; None: removed
        self._defaults: Mapping[str, LimitValue] = {}  # limits without those typed
        self.what, self.choice, self.limits, self.plot = WordBox(), WordBox(), LimitRows(), XYPlot("", "")
        self.what.setAccessibleName("Dimension to find")
        self.choice.setAccessibleName("Which one")
        self.answer = QLabel(
            wordWrap=True,
            textFormat=Qt.TextFormat.RichText,
            alignment=Qt.AlignmentFlag.AlignTop,
            textInteractionFlags=Qt.TextInteractionFlag.TextSelectableByMouse,
        )
        self.update_style()
        self.take, self.cancel, self.again = (
            QPushButton("Take over"),
            QPushButton("Cancel"),
            QPushButton("Search again"),
        )
        self.take.setToolTip("Use the result in the design (one undo step)")
        self.exact = ExactSwitch()
        self.bar = described(QProgressBar(minimum=0, maximum=0, textVisible=False), name="Computing")
        self.bar.setFixedHeight(10)
        self.counted = QLabel()
        self._lay_out()
        self._work.result.connect(self._show_result)
        self._patience = single_shot(self, self._show_progress, PATIENCE_MS)
        self._tick = QTimer(self, interval=TICK_MS)
        connect_all(
            (self._tick.timeout, self._show_count),
            (self.what.activated, self._choose),
            (self.choice.activated, self._choose),
            (self.limits.changed, self._limit_typed),
            (self.limits.added, self._add_limit),
            (self.take.clicked, self._take_over),
            (EXACT.changed, self._show_solution),
            (self.cancel.clicked, self._work.cancel),
            (self.again.clicked, self._search),
            (session.started, self._typed.clear),
            (session.drive_chosen, self._typed.clear),
        )

    def update_style(self) -> None:
        """Reserve room for the result in the current font."""
        self.answer.setMinimumHeight(ANSWER_LINES * self.fontMetrics().lineSpacing() + 4)

    def _lay_out(self) -> None:
        self._footer = QStackedWidget()
        for parts in (
            (self.take, self.exact, STRETCH),
            ((self.bar, 1), self.counted, self.cancel),
            (self.again, STRETCH),
        ):
            page = widget_with(fill(QHBoxLayout(), *parts, margins=0))
            self._footer.addWidget(page)
        self._footer.setFixedHeight(self.take.sizeHint().height() + 2)
        self._form = widget_with(
            fill(QVBoxLayout(), self.what, self.choice, self.limits, STRETCH, margins=0, spacing=4)
        )
        result = fill(QVBoxLayout(), (self.plot, 1), self.answer, self._footer, margins=0, spacing=4)
        self._sides = fill(
            QBoxLayout(QBoxLayout.Direction.TopToBottom), self._form, (result, 1), margins=(8, 6, 8, 6), spacing=6
        )
        self.set_content_layout(self._sides)
        self.content.setMinimumWidth(
            FORM_WIDTH
        )  # not that of limits and curve next to each other: a dock could not shrink

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Place the curve next to the limits where the view is wide enough, else below them."""
        super().resizeEvent(event)
        wide = self.width() >= WIDE
        self.limits.set_explained(self._has_room_for_reasons(len(self.limits.boxes)))
        self._sides.setDirection(QBoxLayout.Direction.LeftToRight if wide else QBoxLayout.Direction.TopToBottom)
        self._form.setMinimumWidth(FORM_WIDTH if wide else 0)
        self._form.setMaximumWidth(FORM_WIDTH if wide else QWIDGETSIZE_MAX)

    def _has_room_for_reasons(self, limits: int) -> bool:
        """Whether the curve still has room where the reason is below each limit."""
        return self.height() - ROW * limits >= (LOW if self.width() >= WIDE else TALL)

    # -- choice of the search -------------------------------------------------------------------------------

    def refresh(self, study: Study) -> None:
        searches = self._available()
        if not searches:
            raise Unavailable(NO_SIZES)
        _fill(self.what, {what: title_of(what) for what in searches})
        self._search()

    def search_for(self, what: str, afresh: bool = False) -> None:
        """Start this search where the design has it; ``afresh``: without the limits typed before."""
        if afresh:
            self._typed.clear()
        self.pull()
        row = self.what.findData(what)
        if row >= 0 and not self.in_trouble:
            self.what.setCurrentIndex(row)
            self._search()

    def _available(self) -> tuple[str, ...]:
        """Searches for the current drive and for the shaft."""
        for_drive = () if self.session.is_on_balancer else available_searches(self.session.design)
        return (*for_drive, *available_machine_searches(self.session.full_design))

    @property
    def _design(self) -> Design:
        """Design to search in: of the current drive, or of all drives."""
        design: Design = self.session.full_design if self._search_key in MACHINE_SEARCHES else self.session.design
        return design

    @property
    def _search_key(self) -> str:
        return str(self.what.currentData())

    def _show_limits(self, design: Design) -> None:
        """Show the limits of the design or typical limits, where the user has not replaced or removed them."""
        keys = self._keys(design)
        typed = {key: value for key, value in self._typed.items() if key in keys}
        limits = active_limits(keys, self._defaults, typed)
        self.limits.show_limits(design, limits, keys, self._has_room_for_reasons(len(limits)))

    def _keys(self, design: Design) -> tuple[str, ...]:
        """Keys of all quantities that can be limited in this search."""
        paths = (
            ()
            if self._search_key in MACHINE_SEARCHES
            else varied_fields(design, self._search_key, self.choice.currentData() or "")
        )
        return keys_of(design, self._search_key, paths)

    def _choose(self, _: int) -> None:
        self._search()

    def _limit_typed(self, key: str, value: float | None) -> None:
        """Use a typed limit; None: return to the default limit, or remove the default."""
        if value is not None or self._typed.pop(key, None) is None or key not in self._defaults:
            self._typed[key] = value
        self._search()

    def _add_limit(self, key: str) -> None:
        if key in self._defaults:
            self._typed.pop(key, None)
        else:
            self._typed[key] = start_value(key, self.solution)
        self._search()
        self.limits.focus(key)

    # -- the search -----------------------------------------------------------------------------------------

    def _search(self) -> None:
        """Search under the current limits; a search that still runs is stopped."""
        if (
            self.is_unavailable or self._search_key not in self._available()
        ):  # the list is still that of the previous design
            return
        design, what = self._design, self._search_key
        choices = choices_of(design, what)
        _fill(self.choice, choices)
        self.choice.setVisible(len(choices) > 1)
        choice = self.choice.currentData() or ""
        keys = self._keys(design)
        stated = {key: value for key, value in self._typed.items() if key in keys}
        self._show_limits(design)
        self._stop_work()
        self.searches += 1
        self._count = TrialCount()
        if what in MACHINE_SEARCHES:
            aim = {"aim": choice} if choice else {}
            job = partial(_search_result, design, what, stated, notify=self._count.update, **aim)
        else:
            machine = partial(with_only, self.session.full_design, self.session.chosen)
            job = partial(
                _search_result, design, what, stated, choice=choice, machine=machine, notify=self._count.update
            )
        self._patience.start()
        self._work.start([(design, job)])

    def _stop_work(self) -> None:
        """Stop the search and discard the result of the previous design."""
        super()._stop_work()
        self._hide_progress()
        self.take.setEnabled(False)
        self._result = None

    def _hide_progress(self) -> None:
        self._patience.stop()
        self._tick.stop()
        self._footer.setCurrentIndex(0)

    def _show_progress(self) -> None:
        """Replace the previous result by the progress of the search."""
        self._show_count()
        self.plot.show_message("Searching …")
        self.answer.setText("")
        self._footer.setCurrentIndex(1)
        self._tick.start()

    def _show_count(self) -> None:
        self.counted.setText(f"{self._count.number} designs tried" if self._count.number else "")

    def _show_result(self, design: Design, outcome: SearchResult | KindynaError | Cancelled) -> None:
        self._hide_progress()
        result: Any = outcome
        if isinstance(outcome, SearchResult):
            self._result, self._defaults, result = outcome, outcome.defaults, outcome.result
            self._show_limits(design)
        if isinstance(result, Solution):
            self._show_solution()
            return
        if isinstance(result, Cancelled):
            self._footer.setCurrentIndex(2)
            self.plot.show_message("The search was cancelled.")
            self.answer.setText("")
            return
        self.plot.show_message("No curve: the search has no result.")
        self.answer.setText(f"<span style='color:{SCREEN.limit}'>{reason(design, result)}</span>")

    @property
    def solution(self) -> Solution | None:
        """Solution of the search, rounded unless *Exact* is on; None where there is none."""
        if self._result is None or isinstance(self._result.result, KindynaError):
            return None
        return self._result.result if takes_exact() else self._result.rounded

    def _show_solution(self) -> None:
        if self.solution is not None:
            show_solution(self.plot, self._design, self.solution)
            self.answer.setText(solution_html(self._design, self.solution))
            self.answer.setToolTip(answers_tip(self._design, self.solution))
            self._offer_take_over()

    def _offer_take_over(self) -> None:
        solution, design = self.solution, self._design
        if solution is None:
            return
        is_new = any(_differ(get(design, path), get(solution.design, path)) for path in solution.answer)
        self.take.setEnabled(solution.is_valid and is_new)
        self.take.setText("Take over" if is_new or not solution.is_valid else "Taken over")

    def _take_over(self) -> None:
        """Use the result in the design, as one step."""
        solution = self.solution
        if solution is None:
            return
        before, label = self.session.full_design, step_name(self._design, self._search_key, solution)
        self.session.put_full_design(solution.machine, label, next(iter(solution.answer)))
        self.session.end_gesture()
        if solution.curve_over:
            Pins.of(self.session).pin_change(before, solution.machine, solution.target)


class SearchResult(NamedTuple):
    """Default limits of a search, and its exact and its rounded solution, or the reason why there is none."""

    defaults: Mapping[str, LimitValue]
    result: Solution | KindynaError
    rounded: Solution | None = None


def _search_result(design: Design, what: str, stated: StatedLimits, **options: Any) -> SearchResult:
    """Search, and check the cam of the solution in the same thread."""
    defaults = initial_limits(design, what)
    try:
        result = search(design, what, stated, **options)
        rounded = round_solution(result, design, machine=options.get("machine", same_design))
        _ = result.errors, rounded.errors
    except KindynaError as error:
        return SearchResult(defaults, error)
    return SearchResult(defaults, result, rounded)


def _fill(box: WordBox, rows: Mapping[str, str]) -> None:
    """Offer these rows; the selected row stays selected where it still exists."""
    if [(box.itemData(i), box.itemText(i)) for i in range(box.count())] != list(rows.items()):
        fill_choices(box, rows)


def _differ(present: Any, value: Any) -> bool:
    if isinstance(value, str):
        return bool(present != value)
    return present is None or abs(present - value) > SAME * max(abs(present), abs(value))
