"""Find."""

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
    QWidget,
)

from core.design import Design, get, with_only
from core.errors import KindynaError
from core.find import (
    LIMITS,
    SHAFT_SEARCHES,
    LimitValue,
    Solution,
    StatedLimits,
    available_searches,
    available_shaft_searches,
    find,
    varied_fields,
)
from core.numerics.lazy import Cancelled
from core.study import Study
from kindyna_gui.documents.session import Session
from kindyna_gui.find_rows import (
    LimitRows,
    answer_html,
    axis_title,
    holding,
    keys_of,
    places_of,
    start_value,
    step_name,
    title_of,
    typed_text,
    unit_of,
    usual_of,
)
from kindyna_gui.forms.fields import fill_choices
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.labels import reason
from kindyna_gui.pictures.plots.xy import Dots, Line, Rule, XYPlot
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import short
from kindyna_gui.player import Player
from kindyna_gui.requirements import NO_SIZES, Unavailable
from kindyna_gui.settings import size_of
from kindyna_gui.view import BackgroundView

# -- trade plot ------------------------------------------------------------------------------------------

ROOM = 1.6  # of the highest value that is marked, shown of a curve that goes on rising
MARK_DIGITS = 6  # of the answer beside its line
BESIDE = 0.03  # of the width, left free on both sides


def show_solution(plot: XYPlot, design: Design, solution: Solution) -> None:
    """Draw what a search has found: a curve over one value, the limit level, the answer upright and a dot, the present value a
    ring."""
    path, key = next(iter(solution.answer)), solution.curve_of
    low, high = solution.near
    curve = np.array([point for point in solution.curve if low <= point[0] <= high])
    x, y = curve[:, 0], np.where(np.isfinite(curve[:, 1]), curve[:, 1], np.nan)
    limit = solution.limits.get(key)
    answer = (solution.answer[path], solution.reached.get(key, solution.answer.get(key, np.nan)))
    now = (solution.present[path], solution.before.get(key, solution.present.get(key)))
    if key in solution.answer:  # another field that is varied: the first one is what it is bought with
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
    rules.append(Rule(answer[0], short(answer[0], min(MARK_DIGITS, solution.digits)), SCREEN.ink, low=True))
    plot.name_axes(axis_title(design, path), axis_title(design, key))
    colour = SCREEN.family("pressure-angle" if key in LIMITS and LIMITS[key].is_upper else "curvature")
    plot.show_lines([Line(x, _what_matters(y, [answer[1], now[1], limit]), colour)], rules=rules, dots=dots)
    beside = BESIDE * float(np.ptp(x))  # else a dot at the end of the curve is cut
    plot.show_range((float(x.min()) - beside, float(x.max()) + beside))


def _dot(at: tuple[float, float], hollow: bool = False) -> Dots:
    return Dots(np.array(at[:1]), np.array(at[1:]), SCREEN.ink, hollow=hollow)


def _what_matters(y: np.ndarray, pins: Sequence[float | None]) -> np.ndarray:
    """The values (n,) without those that are far above or below all that are marked, else these would be seen at one height."""
    marked = [value for value in pins if value is not None and np.isfinite(value)]
    most = ROOM * max((abs(value) for value in marked), default=np.inf)
    near = np.where(np.abs(y) <= most, y, np.nan) if most > 0.0 else y
    return near if np.isfinite(near).sum() > 1 else y


# -- find view -------------------------------------------------------------------------------------------

PATIENCE_MS = 300  # before progress is shown
TICK_MS = 200  # between two counts
POLL_MS = 25  # a search may take a second, and is held up each time
WIDE = 720  # pixels, from which the curve stands beside the limits
ROW, LOW, TALL = (
    40,
    120,
    440,
)  # pixels: of a limit with its reason; what the rest takes, the curve beside the limits or below them
FORM_WIDTH, QWIDGETSIZE_MAX = 330, 16777215
ANSWER_LINES = 4  # kept free for the answer, so that nothing below it moves
SAME = 1e-9  # part of a value to which it is in place already


class TrialCount:
    """How many designs were evaluated; the other thread writes it."""

    def __init__(self) -> None:
        self.number = 0

    def tell(self, number: int) -> None:
        """So many designs have been tried by now; called from the search beside the window."""
        self.number = number


class FindView(BackgroundView):
    """Seeks beside the window, when the design or a limit changes while it can be seen."""

    is_design_wide = True
    stages = ("linkage", "cam")
    pause_ms = 200

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player, POLL_MS)
        self.solution: Solution | None = None
        self.searches = 0
        self._count = TrialCount()
        self._typed: dict[str, float | None] = {}  # limits as the user wants them; None: taken away
        self._usual: Mapping[str, LimitValue] = {}  # those that hold else
        self.what, self.place, self.limits, self.plot = WordBox(), WordBox(), LimitRows(), XYPlot("", "")
        self.plot.setMinimumSize(220, 110)
        self.what.setAccessibleName("What is wanted")
        self.place.setAccessibleName("Which of them")
        self.answer = QLabel(wordWrap=True, textFormat=Qt.TextFormat.RichText, alignment=Qt.AlignmentFlag.AlignTop)
        self.answer.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.update_style()
        self.take, self.cancel, self.again = (
            QPushButton("Take over"),
            QPushButton("Cancel"),
            QPushButton("Search again"),
        )
        self.take.setToolTip("Put the answer into the design; Undo takes it back")
        self.bar = QProgressBar(minimum=0, maximum=0, textVisible=False)
        self.bar.setAccessibleName("Computing")
        self.bar.setFixedHeight(10)
        self.counted = QLabel()
        self._lay_out()
        self._work.result.connect(self._answered)
        self._patience = QTimer(self, singleShot=True, interval=PATIENCE_MS)
        self._patience.timeout.connect(self._show_progress)
        self._tick = QTimer(self, interval=TICK_MS)
        self._tick.timeout.connect(self._show_count)
        self.what.activated.connect(self._choose)
        self.place.activated.connect(self._choose)
        self.limits.changed.connect(self._limit_typed)
        self.limits.wanted.connect(self._limit_wanted)
        self.take.clicked.connect(self._take_over)
        self.cancel.clicked.connect(self._work.cancel)
        self.again.clicked.connect(self._search)
        session.started.connect(self._typed.clear)
        session.drive_chosen.connect(self._typed.clear)

    def update_style(self) -> None:
        """The answer has its room, whatever it is."""
        self.answer.setMinimumHeight(ANSWER_LINES * self.fontMetrics().lineSpacing() + 4)

    def _lay_out(self) -> None:
        self._foot = QStackedWidget()
        for parts in ((self.take,), (self.bar, self.counted, self.cancel), (self.again,)):
            page = QWidget()
            row = QHBoxLayout(page)
            row.setContentsMargins(0, 0, 0, 0)
            for part in parts:
                row.addWidget(part, 1 if part is self.bar else 0)
            if self.bar not in parts:
                row.addStretch(1)
            self._foot.addWidget(page)
        self._foot.setFixedHeight(self.take.sizeHint().height() + 2)
        self._form = QWidget()
        form = QVBoxLayout(self._form)
        form.setContentsMargins(0, 0, 0, 0)
        form.setSpacing(4)
        for field in (self.what, self.place, self.limits):
            form.addWidget(field)
        form.addStretch(1)
        result = QVBoxLayout()
        result.setContentsMargins(0, 0, 0, 0)
        result.setSpacing(4)
        result.addWidget(self.plot, 1)
        result.addWidget(self.answer)
        result.addWidget(self._foot)
        self._sides = QBoxLayout(QBoxLayout.Direction.TopToBottom)
        self._sides.setContentsMargins(8, 6, 8, 6)
        self._sides.setSpacing(6)
        self._sides.addWidget(self._form)
        self._sides.addLayout(result, 1)
        self.set_content_layout(self._sides)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """The curve stands beside the limits where there is room, else below them; reasons stand below the limits where there is."""
        super().resizeEvent(event)
        wide = self.width() >= WIDE
        self.limits.set_explained(self._explains(len(self.limits.boxes)))
        self._sides.setDirection(QBoxLayout.Direction.LeftToRight if wide else QBoxLayout.Direction.TopToBottom)
        self._form.setMinimumWidth(FORM_WIDTH if wide else 0)
        self._form.setMaximumWidth(FORM_WIDTH if wide else QWIDGETSIZE_MAX)

    def _explains(self, limits: int) -> bool:
        """Whether the reasons of so many limits stand below them: where that leaves room for the curve."""
        return self.height() - ROW * limits >= (LOW if self.width() >= WIDE else TALL)

    # -- what is sought -------------------------------------------------------------------------------------

    def refresh(self, study: Study) -> None:
        rows = self._offered()
        if not rows:
            raise Unavailable(NO_SIZES)
        _fill(self.what, {what: title_of(what) for what in rows})
        self._search()

    def want(self, what: str, afresh: bool = False) -> None:
        """Seek this, where the design has it; afresh: under the limits that hold where none is typed."""
        if afresh:
            self._typed.clear()
        self.pull()
        row = self.what.findData(what)
        if row >= 0 and not self.in_trouble:
            self.what.setCurrentIndex(row)
            self._search()

    def _offered(self) -> tuple[str, ...]:
        """Of the drive at hand, and of the whole shaft."""
        own = () if self.session.on_balancer else available_searches(self.session.design)
        return (*own, *available_shaft_searches(self.session.full_design))

    @property
    def _design(self) -> Design:
        """What is sought in: the drive at hand, or the whole."""
        design: Design = self.session.full_design if self._wanted in SHAFT_SEARCHES else self.session.design
        return design

    @property
    def _wanted(self) -> str:
        return str(self.what.currentData())

    def _show_limits(self, design: Design) -> None:
        """Those that hold: the design's own or the usual ones, as far as the user has not typed others or taken them away."""
        keys = self._keys(design)
        typed = {key: value for key, value in self._typed.items() if key in keys}
        held = holding(keys, self._usual, typed)
        self.limits.show_limits(design, held, keys, self._explains(len(held)))

    def _keys(self, design: Design) -> tuple[str, ...]:
        """Everything that may be limited."""
        paths = (
            ()
            if self._wanted in SHAFT_SEARCHES
            else varied_fields(design, self._wanted, self.place.currentData() or "")
        )
        return keys_of(design, self._wanted, paths)

    def _choose(self, _: int) -> None:
        self._search()

    def _limit_typed(self, key: str, value: float | None) -> None:
        """None: a typed one goes back to the usual one where there is one, a usual one is taken away."""
        if value is None and self._typed.pop(key, None) is not None and key in self._usual:
            self._search()
            return
        self._typed[key] = value
        self._search()

    def _limit_wanted(self, key: str) -> None:
        if key in self._usual:
            self._typed.pop(key, None)
        else:
            self._typed[key] = start_value(key, self.solution)
        self._search()
        self.limits.focus(key)

    # -- the search -----------------------------------------------------------------------------------------

    def _search(self) -> None:
        """Seek under the limits at hand; what was sought before is given up."""
        if (
            self.is_unavailable or self._wanted not in self._offered()
        ):  # as long as the list is that of the design before
            return
        design, what = self._design, self._wanted
        places = places_of(design, what)
        _fill(self.place, places)
        self.place.setVisible(len(places) > 1)
        place = self.place.currentData() or ""
        keys = self._keys(design)
        stated = {key: value for key, value in self._typed.items() if key in keys}
        self._show_limits(design)
        self._stop_work()
        self.searches += 1
        self._count = TrialCount()
        if what in SHAFT_SEARCHES:
            job = partial(_sought, design, what, stated, **({"aim": place} if place else {}))
        else:
            whole, number = self.session.full_design, self.session.chosen
            machine = partial(with_only, whole, number)
            job = partial(_sought, design, what, stated, choice=place, machine=machine, notify=self._count.tell)
        self._patience.start()
        self._work.start([(design, job)])

    def _stop_work(self) -> None:
        """Nothing is sought, and there is no answer to the design at hand."""
        super()._stop_work()
        self._quiet()
        self.take.setEnabled(False)
        self.solution = None

    def _quiet(self) -> None:
        self._patience.stop()
        self._tick.stop()
        self._foot.setCurrentIndex(0)

    def _show_progress(self) -> None:
        """What stands there answers another question."""
        self._show_count()
        self.plot.show_message("Searching …")
        self.answer.setText("")
        self._foot.setCurrentIndex(1)
        self._tick.start()

    def _show_count(self) -> None:
        self.counted.setText(f"{self._count.number} designs tried" if self._count.number else "")

    def _answered(self, design: Design, found: SearchResult | KindynaError | Cancelled) -> None:
        self._quiet()
        result: Any = found
        if isinstance(found, SearchResult):
            self._usual, result = found.usual, found.result
            self._show_limits(design)
        if isinstance(result, Solution):
            self.solution = result
            show_solution(self.plot, design, result)
            self.answer.setText(answer_html(design, result))
            self._offer_take_over()
            return
        if isinstance(result, Cancelled):
            self._foot.setCurrentIndex(2)
            self.plot.show_message("The search was cancelled.")
            self.answer.setText("")
            return
        self.plot.show_message("No curve: there is no answer.")
        self.answer.setText(f"<span style='color:{SCREEN.limit}'>{reason(design, result)}</span>")

    def _offer_take_over(self) -> None:
        found, design = self.solution, self._design
        if found is None:
            return
        apart = any(_differ(get(design, path), get(found.design, path)) for path in found.answer)
        self.take.setEnabled(found.is_valid and apart)
        self.take.setText("Take over" if apart or not found.is_valid else "Taken over")

    def _take_over(self) -> None:
        """The answer into the design, as one step."""
        if self.solution is None:
            return
        found, design = self.solution, self._design
        self.session.put_full_design(found.machine, step_name(design, self._wanted, found), next(iter(found.answer)))
        self.session.end_gesture()


class SearchResult(NamedTuple):
    """The limits that hold where none is typed, and the answer, or why there is none."""

    usual: Mapping[str, LimitValue]
    result: Solution | KindynaError


def _sought(design: Design, what: str, stated: StatedLimits, **how: Any) -> SearchResult:
    """The answer, with what is wrong with its cam looked at in the same go, not when it is shown."""
    try:
        found: Solution | KindynaError = find(design, what, stated, **how)
        _ = found.errors if isinstance(found, Solution) else ()
    except KindynaError as error:
        found = error
    return SearchResult(usual_of(design, what), found)


def _fill(box: WordBox, rows: Mapping[str, str]) -> None:
    """Offer these; what was chosen stays so where it is still there."""
    if [(box.itemData(i), box.itemText(i)) for i in range(box.count())] != list(rows.items()):
        fill_choices(box, rows)


def _differ(present: float | None, found: float) -> bool:
    return present is None or abs(present - found) > SAME * max(abs(present), abs(found))
