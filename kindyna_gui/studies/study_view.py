"""Study: numbers of the design are varied, and what that does is seen while the design is drawn over the map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import groupby
from math import floor, log10
from os.path import relpath
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QHideEvent
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from core.design import Design, Tolerance, edited, get, put
from core.design.limits import Waviness
from core.errors import DesignError, KindynaError
from core.study import TOTALS, Study
from core.varying import (
    Limits,
    Question,
    Span,
    StudyFile,
    Survey,
    ToleranceResult,
    VariedField,
    can_be_varied,
    current_figures,
    default_span,
    default_tolerance,
    field_info,
    file_of_question,
    load_study,
    question_of_file,
    refined_survey,
    request_keys,
    save_study,
    study_of,
    suggested_figures,
    survey,
    tolerance_result,
    valid_words,
    whole_numbers,
    with_values,
)
from core.varying.bands import QUIET_LAWS
from core.varying.surveys import SEED
from core.varying.tolerances import SHARE
from kindyna_gui import dialogs
from kindyna_gui.background import Background
from kindyna_gui.documents.edits import Refusal
from kindyna_gui.documents.pins import Bands, scatters
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import in_sentence, reason, thousands
from kindyna_gui.player import Player
from kindyna_gui.studies.best_page import BestPage, MadePage
from kindyna_gui.studies.board import Board, Card, read_cards, write_cards
from kindyna_gui.studies.plots import Measured
from kindyna_gui.studies.rows import AskedRows, SpanRows
from kindyna_gui.studies.study_runs import StudyMenu, SurveyPages
from kindyna_gui.studies.texts import (
    group_of,
    label_of,
    measured,
    name_of,
    number_text,
    reason_text,
    section_of,
    share_html,
    value_text,
)
from kindyna_gui.view import BackgroundView, ViewHost

REFINED = 0  # in place of a number of designs
COARSE, FINE = 16, 64  # designs along each number: first, and once there is time
ALONG, ACROSS_MORE = 129, 32  # the same of one number; of more than two, whose square counts
FORM_WIDTH = 348  # pixels
TOLD_LINES = 2
STEPS_ACROSS = 400  # a number that is drawn has as many digits as tell so many places of the plot apart
EMPTY = (
    "Right-click a number in the forms and choose “Vary this”, or choose one here on the left.\n"
    "One number gives curves, two a map, more give parallel coordinates."
)
WORDS_ONLY = "Words are tried one by one: find the best design on the left."
MADE, BEST = 1, 2  # tabs
REST_MS = 300  # of the design, before machines are drawn
DRAWN = "Machines are drawn by chance …"
NOTHING_ASKED = "Ask a quantity on the left."


class StudyView(BackgroundView):
    """What is asked of the designs is computed beside the window: coarsely, then finely; anew only where something else than the varied
    numbers changes.

    found   what is shown; None before the first
    """

    is_design_wide = True

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.found: Survey | None = None
        self.spans: dict[str, Span] = {}
        self.asked: dict[str, Limits] = {}
        self.shown = ""
        self.words: dict[str, tuple[str, ...]] = {}  # path -> those that are tried
        self.goals: dict[str, bool] = {}  # key -> whether it is made small
        self.robust: float | None = None
        self._typed: Mapping[str, VariedField] = {}  # of the file of the study that is asked
        self.seed = SEED
        self._possible: dict[str, tuple[str, ...]] = {}  # path -> words that go there
        self._of: tuple[object, ...] = ()  # what ``found`` is of, or what is being computed
        self._drawn: tuple[object, ...] = ()
        self._plain: Survey | None = None  # the map without finer cells
        self._refined_by: tuple[object, ...] = ()
        self._before: Design | None = None  # a drag began with
        self._refused = ""
        self._values: Mapping[str, float] = {}
        self.rows, self.asks, self.board = SpanRows(), AskedRows(), Board()
        self.made, self.best = MadePage(), BestPage()
        self.pages = SurveyPages()
        self.map, self.parallel, self.front, self.curves = (
            self.pages.map,
            self.pages.parallel,
            self.pages.front,
            self.pages.curves,
        )
        self.told = QLabel(wordWrap=True, alignment=Qt.AlignmentFlag.AlignTop)
        self.update_style()
        self.tip = self.pages.tip
        self.share = QLabel(wordWrap=True)
        self.share.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self._share_of: tuple[object, ...] = ()
        self._board_of = ""  # whose cards are on the board; empty: none are read yet
        self._made: ToleranceResult | None = None
        self.bands = Bands.of(session)
        self.open = StudyMenu(lambda: (self._whole, self.session.chosen))
        self.save = QPushButton("Save the study …")
        self.save.setAutoDefault(False)
        self.save.setToolTip("As a file for kindyna --headless vary, which makes its table, and tolerance")
        self._lay_out()
        self._connect()

    # -- building -------------------------------------------------------------------------------------------

    def update_style(self) -> None:
        """What is told has its room, so that nothing moves under the mouse."""
        self.told.setFixedHeight(TOLD_LINES * self.fontMetrics().lineSpacing() + 2)

    def _lay_out(self) -> None:
        vary = QWidget()
        column = QVBoxLayout(vary)
        column.setContentsMargins(8, 6, 6, 6)
        column.setSpacing(10)
        column.addWidget(self.rows)
        column.addWidget(self.asks)
        column.addStretch(1)
        self.tabs = QTabWidget()
        self.tabs.setDocumentMode(True)
        for title, page in (("Vary", vary), ("Tolerances", self.made), ("Best design", self.best)):
            scroll = QScrollArea(widgetResizable=True)
            scroll.setFrameShape(QFrame.Shape.NoFrame)
            scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
            scroll.setFocusPolicy(Qt.FocusPolicy.NoFocus)
            scroll.setWidget(page)
            self.tabs.addTab(scroll, title)
        files = QHBoxLayout()
        files.setContentsMargins(8, 0, 6, 0)
        files.addWidget(self.open)
        files.addWidget(self.save)
        files.addStretch(1)
        self.share.setContentsMargins(8, 0, 6, 4)
        self._form = QWidget()
        self._form.setFixedWidth(FORM_WIDTH)
        left = QVBoxLayout(self._form)
        left.setContentsMargins(0, 4, 0, 0)
        left.setSpacing(4)
        left.addLayout(files)
        left.addWidget(self.tabs, 1)
        left.addWidget(self.share)
        result = QVBoxLayout()
        result.setContentsMargins(0, 4, 6, 4)
        result.setSpacing(4)
        result.addWidget(self.pages, 1)
        result.addWidget(self.told)
        result.addWidget(self.board)
        sides = QHBoxLayout()
        sides.setContentsMargins(0, 0, 0, 0)
        sides.setSpacing(0)
        sides.addWidget(self._form)
        sides.addLayout(result, 1)
        self.set_content_layout(sides)
        self.setFocusProxy(self.open)

    def _connect(self) -> None:
        self._surveys = Background(self)
        self._surveys.result.connect(self._surveyed)
        self._shares = Background(self)
        self._shares.result.connect(self._shared)
        self._details = Background(self)
        self._details.result.connect(self._told_more)
        self._soon_share = QTimer(self, singleShot=True, interval=REST_MS)
        self._soon_share.timeout.connect(self._draw_machines)
        self._soon_survey = QTimer(self, singleShot=True, interval=0)
        self._soon_survey.timeout.connect(self._survey)
        self.rows.wanted.connect(self.vary)
        self.rows.changed.connect(self._span_changed)
        self.rows.removed.connect(self._span_removed)
        self.rows.spread.connect(self._spread)
        self.rows.chosen.connect(self._choose_words)
        self.made.rows.wanted.connect(
            lambda path: self._set_tolerance(Tolerance(path, default_tolerance(self._whole, path)))
        )
        self.made.rows.changed.connect(self._set_tolerance)
        self.made.rows.removed.connect(self._drop_tolerance)
        self.made.waves.changed.connect(self._set_waves)
        self.made.bands.toggled.connect(self.bands.ask)
        self.best.goals_changed.connect(self._set_goals)
        self.best.robust_changed.connect(self._set_robust)
        self.best.wanted.connect(self._search)
        self.best.stepped.connect(self._show_path)
        self.best.found.connect(self._show_answer)
        self.best.taken.connect(self._take_answer)
        self.tabs.currentChanged.connect(self._page_chosen)
        self.front.picked.connect(self._pick_of_front)
        self.open.ready.connect(self.ask_study)
        self.open.opened.connect(self._open_file)
        self.asks.wanted.connect(self._ask)
        self.asks.changed.connect(self._asked_changed)
        self.asks.shown.connect(self._show_key)
        self.asks.removed.connect(self._asked_removed)
        for plot in (self.map, *self.curves):
            plot.picked.connect(self._pick)
            plot.grabbed.connect(self._grab)
            plot.dragged.connect(self._pull_to)
            plot.released.connect(self._release)
        self.parallel.brushed.connect(self._draw)
        self.parallel.picked.connect(self._pick_line)
        self.board.kept.connect(self._keep)
        self.board.changed.connect(self._save_board)
        self.board.compared.connect(self._show_compared)
        self.save.clicked.connect(self._save)
        self.board.reopened.connect(self._reopen)
        self.session.refused.connect(self._note_refusal)
        self.session.started.connect(self._begin_anew)
        self.session.file_changed.connect(self._move_board)

    def belong_to(self, window: ViewHost) -> None:
        super().belong_to(window)
        self.board.kept.connect(lambda: window.show_message("Kept on the board"))
        self.board.pinned.connect(window.pin)

    # -- what is varied and asked ---------------------------------------------------------------------------

    def vary(self, path: str) -> None:
        """Vary this number, or word, too."""
        whole = self._whole
        if path in self.spans or path in self.words:
            return
        info = field_info(whole, path)
        if info is not None and info.choices:
            self._vary_word(path)
            return
        try:
            self.spans[path] = default_span(whole, path)
        except ValueError as error:
            self.status_message.emit(str(error))
            return
        self._ask_usual(path)
        self._anew()

    def _ask_usual(self, path: str) -> None:
        if not self.asked:
            self.asked = dict(suggested_figures(self.session.full_study, path))
            self.shown = next(iter(self.asked), "")

    def _vary_word(self, path: str) -> None:
        """Of laws those that are quiet at first, and the one in place."""
        possible = self._words_at(path)
        own = get(self._whole, path)
        self.words[path] = tuple(
            word for word in possible if word in QUIET_LAWS or word == own or not path.endswith(".law")
        )
        self._ask_usual(path)
        self._anew()

    def _choose_words(self, path: str, words: tuple[str, ...]) -> None:
        if words:
            self.words[path] = words
        self._anew()

    def _span_changed(self, span: Span) -> None:
        self.spans[span.path] = span
        self._anew()

    def _span_removed(self, path: str) -> None:
        self.spans.pop(path, None)
        self.words.pop(path, None)
        self._anew()

    def _ask(self, slug: str) -> None:
        key = slug if slug in TOTALS else f"{slug}:abs"
        self.asked.setdefault(key, (None, None))
        self.shown = key
        self._anew()

    def _asked_changed(self, before: str, key: str, limits: Limits) -> None:
        rows = {
            key if each == before else each: limits if each == before else held for each, held in self.asked.items()
        }
        self.asked, self.shown = rows, key if self.shown == before else self.shown
        self.goals = {key if each == before else each: small for each, small in self.goals.items()}
        self._anew()

    def _asked_removed(self, key: str) -> None:
        del self.asked[key]
        self.goals.pop(key, None)
        if self.shown == key:
            self.shown = next(iter(self.asked), "")
        self._anew()

    def _show_key(self, key: str) -> None:
        self.shown = key
        self._draw()

    def _begin_anew(self) -> None:
        self.spans, self.asked, self.shown, self.found, self._of = {}, {}, "", None, ()
        self.words, self.goals, self.robust, self._possible, self._typed = {}, {}, None, {}, {}
        self.seed = SEED
        self.best.forget()
        self._board_of = ""

    def _anew(self) -> None:
        self._stale = True
        if self.on_screen():
            self.pull()

    # -- showing --------------------------------------------------------------------------------------------

    @property
    def _whole(self) -> Design:
        whole: Design = self.session.full_design
        return whole

    def refresh(self, study: Study) -> None:
        whole = self._whole
        there, columns = tuple(can_be_varied(whole)), set(request_keys(whole))
        self.spans = {path: span for path, span in self.spans.items() if path in there}
        self.words = {path: words for path, words in self.words.items() if self._words_at(path)}
        self.asked = {key: held for key, held in self.asked.items() if key.partition(":")[0] in columns}
        self.goals = {key: small for key, small in self.goals.items() if key in self.asked}
        self.shown = self.shown if self.shown in self.asked else next(iter(self.asked), "")
        self._offer(there)
        if not self._board_of:
            self._board_of = self._board_name
            self.board.show_cards(read_cards(self._board_of))
        self.rows.show_varied(whole, self.spans, self.words, self._possible)
        self.asks.show_asked(whole, self.asked, self.shown)
        self.made.show_design(whole)
        self.best.show_goals(whole, self.asked, self.goals, self.robust)
        self.save.setEnabled(bool(self.spans or self.words) and bool(self.asked))
        self.board.setVisible(bool(self.spans) or bool(self.board.cards))
        if not self.spans or not self.asked:
            self._stop()
            self.found, self._of = None, ()
            self.pages.setCurrentWidget(self.map)
            self.map.show_message(NOTHING_ASKED if self.spans else WORDS_ONLY if self.words else EMPTY)
            self._say("")
            self.refresh_in_turn(self._show_present)
            self._ask_share()
            return
        wanted = self._question()
        if wanted != self._of:
            self._of, self._plain = wanted, None
            self._stop()
            self._soon_survey.start()
        elif self.found is not None:
            if self._plain is not None and self._refined_by != tuple(self.asked.items()):
                self.found = self._plain
                self._refine(self._plain)
            if self._drawn != self._drawing:
                self._draw()
            self._place()
        self.refresh_in_turn(self._show_present)
        self._ask_share()

    def _words_at(self, path: str) -> tuple[str, ...]:
        """Those that go at a path of the design, none where it has no word there."""
        info = field_info(self._whole, path)
        if info is None or not info.choices:
            return ()
        if path not in self._possible:
            self._possible[path] = valid_words(self._whole, path, info.choices)
        return self._possible[path]

    def _offer(self, there: Sequence[str]) -> None:
        """What the menus have: it depends on the kind of design only."""
        whole = self._whole
        kind = (there, tuple(request_keys(whole)))
        if kind == getattr(self, "_offered", None):
            return
        self._offered = kind
        whole_ones = whole_numbers(whole, there)
        for place, keys, group, name in (
            (self.rows, kind[0], section_of, name_of),
            (self.asks, kind[1], group_of, label_of),
            (self.made.rows, [path for path in there if path not in whole_ones], section_of, name_of),
        ):
            titles = [(group(whole, key), key) for key in keys]
            groups: dict[str, dict[str, str]] = {}
            for title, rows in groupby(titles, key=lambda row: row[0]):
                groups.setdefault(title, {}).update({key: name(whole, key) for _, key in rows})
            place.offer(groups)

    def _question(self) -> tuple[object, ...]:
        """All that the survey depends on: the design but for what is varied, and its tolerances, the bounds, what is asked."""
        try:
            rest = with_values(self._whole, {path: span.low for path, span in self.spans.items()})
        except KindynaError:
            rest = self._whole
        return replace(rest, tolerances=(), waviness=None), tuple(self.spans.values()), tuple(self.asked), self.seed

    def _survey(self) -> None:
        if not self.on_screen():
            self._of, self._stale = (), True
            return
        spans, keys = tuple(self.spans.values()), tuple(self.asked)
        finest = {1: ALONG, 2: FINE}.get(len(spans), ACROSS_MORE)
        job = partial(survey, self._whole, spans, keys)
        self._surveys.start([((self._of, count), partial(job, count, self.seed)) for count in (COARSE, finest)])

    def _surveyed(self, key: tuple[object, int], found: Survey | KindynaError) -> None:
        if key[0] != self._of:
            return
        if key[1] == REFINED and isinstance(found, Survey):
            self.found = found
            self._draw()
            return
        if isinstance(found, KindynaError):
            self.found = None
            self.map.show_message(reason(self.session.design, found))
            self.pages.setCurrentWidget(self.map)
            return
        self.found = found
        self._draw()
        if len(found.spans) == 2 and found.count == FINE and not self._surveys.busy:
            self._refine(found)

    def _refine(self, plain: Survey) -> None:
        """Finer cells where limits run."""
        self._plain, self._refined_by = plain, tuple(self.asked.items())
        self._surveys.start([((self._of, REFINED), partial(refined_survey, self._whole, plain, dict(self.asked)))])

    def _measured(self) -> list[Measured]:
        return [measured(self._whole, key, *held) for key, held in self.asked.items()]

    @property
    def _drawing(self) -> tuple[object, ...]:
        """What plots depend on."""
        return self.found, tuple(self.asked.items()), self.shown

    def _draw(self) -> None:
        found, self._drawn = self.found, self._drawing
        if found is None or not self.asked:
            return
        every = self._measured()
        if any(each.key not in found.value for each in every):
            return  # the next survey is on its way
        own = {**self._values, **dict(zip(self.spans, self._numbers(), strict=True))}
        self.pages.draw(self._whole, found, every, self.shown, own, self._shows_front)
        self._place()
        self._tell(found)

    def _tell(self, found: Survey) -> None:
        """How many designs there are, and why some cannot be built."""
        lost = found.reason[found.reason != ""]
        text = f"{thousands(found.reason.size)} designs"
        if lost.size:
            codes, counts = np.unique(lost.astype(str), return_counts=True)
            most = codes[counts.argmax()]
            text += f", {thousands(lost.size)} without an answer, most: {in_sentence(reason_text(str(most)))}"
        self._say(f"{text}{'' if not self._surveys.busy else ' …'}")

    def _say(self, text: str) -> None:
        self.told.setText(text)
        self.told.setToolTip(text)

    def _numbers(self) -> list[float]:
        return [float(get(self._whole, path)) for path in self.spans]

    def _place(self) -> None:
        """The cross where the design stands."""
        if self.session.drag_source is self and self._refused:
            return
        self.pages.place(self._numbers())

    def _show_present(self) -> None:
        """What is asked of the design at hand; while it is drawn that of the nearest one that is computed already."""
        if not self.asked or not self.on_screen():
            return
        found = self.found
        try:
            if self.session.drag_source is self and found is not None and set(self.asked) <= set(found.value):
                near = found.nearest(self._numbers())
                self._values = {key: float(found.value[key][near]) for key in self.asked}
            else:
                self._values, _ = current_figures(self.session.full_study, tuple(self.asked))
        except (KindynaError, ValueError):
            self._values = {}
        self.asks.show_values(self._values)
        self._show_compared()
        if len(self.spans) > 2 and self.found is not None and set(self.asked) <= set(self.found.value):
            self._draw()

    # -- what is made ---------------------------------------------------------------------------------------

    def _spread(self, path: str, width: float | None) -> None:
        """± of a number of what is made."""
        if width is None:
            self._drop_tolerance(path)
        else:
            held = next((row for row in self._whole.tolerances if row.field == path), Tolerance(path, width))
            self._set_tolerance(replace(held, plus=width, minus=None))

    def _set_tolerance(self, wanted: Tolerance) -> None:
        rows = self._whole.tolerances
        there = any(row.field == wanted.field for row in rows)
        self._put_tolerances(
            tuple(wanted if row.field == wanted.field else row for row in rows) if there else (*rows, wanted),
            wanted.field,
        )

    def _drop_tolerance(self, path: str) -> None:
        self._put_tolerances(tuple(row for row in self._whole.tolerances if row.field != path), path)

    def _put_tolerances(self, rows: tuple[Tolerance, ...], path: str) -> None:
        whole = self._whole
        if rows != whole.tolerances:
            self.session.put_full_design(
                replace(whole, tolerances=rows), f"Tolerance of {in_sentence(name_of(whole, path))}"
            )
            self.session.end_gesture()

    def _set_waves(self, waves: Waviness | None) -> None:
        if waves != self._whole.waviness:
            self.session.put_full_design(replace(self._whole, waviness=waves), "Waves of the profile")
            self.session.end_gesture()

    def _ask_share(self) -> None:
        """How many machines keep the limits, once the design rests."""
        wanted = (self._whole, tuple(self.asked.items()), self.seed, self._details_seen)
        limited = any(held != (None, None) for held in self.asked.values())
        if not scatters(self._whole) or not self.asked:
            self._end_share()
            self._share_of = ()
            self._show_made(None)
        elif wanted != self._share_of:
            self._end_share()
            self._share_of = wanted
            if limited:
                self.share.setText(DRAWN)
            self._soon_share.start()
        if not scatters(self._whole) or not limited:
            self.share.setText("A tolerance ± and a limit tell the share of machines within it." if self.spans else "")

    @property
    def _details_seen(self) -> bool:
        return self.tabs.currentIndex() == MADE

    def _end_share(self) -> None:
        self._shares.stop()
        self._details.stop()
        self._soon_share.stop()

    def _draw_machines(self) -> None:
        if not self.on_screen():
            self._share_of, self._stale = (), True
            return
        if self.session.drag_source is self:
            self._soon_share.start()
            return
        self._shares.start(
            [(self._share_of, partial(tolerance_result, self._whole, dict(self.asked), False, seed=self.seed))]
        )

    def _shared(self, key: tuple[object, ...], found: ToleranceResult | KindynaError) -> None:
        if key != self._share_of:
            return
        if isinstance(found, KindynaError):
            self.share.setText(reason(self._whole, found))
            self._show_made(None)
            return
        if found.share is not None:
            self.share.setText(share_html(self._whole, found))
            if found.share.value < SHARE and self._details_seen:
                self._details.start([(key, partial(tolerance_result, self._whole, dict(self.asked), seed=self.seed))])
        self._show_made(found)

    def _told_more(self, key: tuple[object, ...], found: ToleranceResult | KindynaError) -> None:
        if key == self._share_of and isinstance(found, ToleranceResult):
            self._show_made(found, sought=True)

    def _show_made(self, made: ToleranceResult | None, sought: bool = False) -> None:
        self._made = made
        self.made.show_result(self._whole, made, sought)

    # -- the best design ------------------------------------------------------------------------------------

    def _asks(self) -> Question:
        return Question(
            tuple(self.spans.values()), self.words, self.asked, self.goals, self.robust, self._typed, self.seed
        )

    def _set_goals(self, goals: dict[str, bool]) -> None:
        self.goals = goals
        self._anew()

    def _set_robust(self, share: float | None) -> None:
        self.robust = share

    def _search(self) -> None:
        if not self.spans and not self.words:
            self.best.refuse("Nothing is varied: right-click a value and choose “Vary this”, or open a study.")
        elif not self.goals:
            self.best.refuse("Choose a goal among what is asked.")
        else:
            try:
                study = study_of(file_of_question(self._asks()), self._whole)
            except KindynaError as error:
                self.best.refuse(reason(self._whole, error))
            else:
                self.best.search(study)

    def _show_path(self) -> None:
        """Where the search is, over the map or across the axes."""
        study, paths = self.best.study, list(self.spans)
        steps = [step for step in self.best.path if study is not None and all(path in step[0] for path in paths)]
        rows = [[step[0][path] for path in paths] for step in steps]
        starts = np.array([step[2] for step in steps], dtype=int)
        for plot in (self.map, self.parallel):
            plot.show_path(np.array(rows, dtype=float).reshape(len(rows), len(paths)), starts)

    def _show_answer(self) -> None:
        answer = self.best.answer
        if answer is not None and answer.front:
            first, second = (self._measured_of(goal.key) for goal in self.best.study.file.goals)  # type: ignore[union-attr]
            rows = [[point[goal.column] for point in answer.front] for goal in self.best.study.file.goals]  # type: ignore[union-attr]
            self.front.show_front(np.array(rows), first, second)
        self._page_chosen(self.tabs.currentIndex())

    def _measured_of(self, key: str) -> Measured:
        return measured(self._whole, key, *self.asked.get(key, (None, None)))

    @property
    def _shows_front(self) -> bool:
        answer = self.best.answer
        return self.tabs.currentIndex() == BEST and answer is not None and bool(answer.front)

    def _page_chosen(self, _: int) -> None:
        if self._shows_front:
            self.pages.setCurrentWidget(self.front)
        elif self.found is not None:
            self._draw()
        if self._made is None or self._details_seen:
            self._ask_share()

    def _take_answer(self, design: Design) -> None:
        """The answer in place of the design at hand, if that has not changed elsewhere since the search began."""
        study = self.best.study
        paths = [*self.spans, *self.words] if study is None else [row.field for row in study.file.vary]
        if study is None or not _alike(study.base, self._whole, paths):
            self.best.refuse("The design has changed elsewhere since; find the best once more.")
            return
        self.session.end_gesture()
        self.session.put_full_design(
            replace(design, tolerances=self._whole.tolerances, waviness=self._whole.waviness),
            "Take over the best design",
        )
        self.session.end_gesture()

    def _pick_of_front(self, number: int) -> None:
        answer, study = self.best.answer, self.best.study
        if answer is None or study is None:
            return
        point = answer.front[number]
        values = {row.field: point[row.field] for row in study.file.vary}
        self.session.end_gesture()
        with_all = self._whole
        try:
            for path, value in values.items():
                if isinstance(value, str):
                    with_all = edited(with_all, path, value)
            made = with_values(with_all, {path: value for path, value in values.items() if not isinstance(value, str)})
        except KindynaError as error:
            self.status_message.emit(reason(self._whole, error))
        else:
            self.session.put_full_design(made, "Take over a design of the front")
            self.session.end_gesture()

    # -- studies of files -----------------------------------------------------------------------------------

    def ask_study(self, file: StudyFile) -> None:
        """Ask what a study of this design asks, in place of what was asked."""
        question = question_of_file(file)
        self.spans = {span.path: span for span in question.spans}
        self.words, self._typed, self.seed = dict(question.words), question.typed, question.seed
        self.asked, self.goals, self.robust = dict(question.figures), dict(question.goals), question.robust
        self.shown = next((key for key in self.goals), next(iter(self.asked), ""))
        self.best.forget()
        if self.goals:
            self.tabs.setCurrentIndex(BEST)
        self._anew()

    def _open_file(self, path: Path) -> None:
        """A study from a file: of the design at hand where it names its file, or equals it; else that is opened first."""
        try:
            study = load_study(path)
            own, beside = self.session.path, (path.parent / study.file.design).resolve()
            if study.base == self._whole:
                self.ask_study(study.file)
            elif own is not None and own.resolve() == beside:
                self.ask_study(study_of(study.file, self._whole).file)
            elif self._host is not None and self._host.open_design(beside):
                self.ask_study(study.file)
        except KindynaError as error:
            lines = [str(fault) for fault in error.faults] if isinstance(error, DesignError) else [str(error)]
            dialogs.show_faults(self, f"{path.name} cannot be opened.", lines)

    # -- the mouse ------------------------------------------------------------------------------------------

    def _grab(self) -> None:
        self.player.play(False)
        self._before, self._refused = self._whole, ""
        self.session.begin_drag(self)
        self.tip.hide()

    def _pull_to(self, x: float, y: float) -> None:
        """The cross follows the mouse; the design does as far as it can be built."""
        at = (x, y)[: len(self.spans)]
        self._refused = ""
        self._take(self._rounded(at))
        for plot in (self.map, *self.curves):
            plot.place_own((x, y), refused=bool(self._refused))
        if self._refused:
            self._say(self._refused)
        elif self.found is not None:
            self._tell(self.found)

    def _release(self, here: bool) -> None:
        """Let go: where nothing can be built the cross goes back to the design; Escape takes the drag back."""
        if self.session.drag_source is not self:
            return
        if not here and self._before is not None:
            self.session.put_full_design(self._before, "Vary", next(iter(self.spans)))
        self.session.end_drag()
        self._show_present()
        if self._refused:
            self.session.withdraw(next(iter(self.spans)))
            self._refused = ""
        if self.found is not None:
            self._tell(self.found)
        self._place()

    def _pick(self, x: float, y: float) -> None:
        """A click takes the point over, as one step."""
        self.session.end_gesture()
        self._refused = ""
        self._take(self._rounded((x, y)[: len(self.spans)]))
        self.session.end_gesture()
        if self._refused:
            self._say(self._refused)

    def _pick_line(self, number: int) -> None:
        if self.found is not None:
            self.session.end_gesture()
            self._take(self._rounded(self.found.points[:, number].tolist()))
            self.session.end_gesture()

    def _rounded(self, at: Sequence[float]) -> dict[str, float]:
        """Numbers with as many digits as the plot tells apart, whole ones with none."""
        found, whole = {}, whole_numbers(self._whole, self.spans)
        for (path, span), value in zip(self.spans.items(), at, strict=True):
            digits = 0 if path in whole else -floor(log10((span.high - span.low) / STEPS_ACROSS))
            found[path] = min(max(round(float(value), digits), span.low), span.high)
        return found

    def _take(self, values: Mapping[str, float]) -> None:
        """These numbers into the design."""
        path = next(iter(values))
        names = [in_sentence(name_of(self._whole, each)) for each in values]
        label = f"Vary {' and '.join(names) if len(names) < 3 else f'{len(names)} numbers'}"
        try:
            made = with_values(self._whole, values)
        except KindynaError as error:
            self.session.refuse(path, reason(self.session.design, error))
            return
        self.session.put_full_design(made, label, path)

    def _note_refusal(self, refusal: Refusal) -> None:
        self._refused = f"{refusal.reasons[0][1]}: {refusal.reasons[0][2]}" if refusal.reasons else "refused"

    # -- the board ------------------------------------------------------------------------------------------

    @property
    def _board_name(self) -> str:
        """By which the cards are kept: the file of the design, else its name."""
        path = self.session.path
        return f"without a file: {self._whole.name}" if path is None else str(path.absolute())

    def _move_board(self) -> None:
        """Saved under another name the design takes its cards along."""
        path = self.session.path
        if self._board_of and path is not None and str(path.absolute()) != self._board_of:
            self._board_of = self._board_name
            self._save_board()

    def _save_board(self) -> None:
        try:
            write_cards(self._board_of, self.board.cards)
        except KindynaError as error:
            self.status_message.emit(f"The cards cannot be kept: {error}")

    def _show_compared(self) -> None:
        if self.board.comparing:
            self.board.show_present(self._present_rows())

    def _keep(self) -> None:
        self._show_present()
        self.board.put(Card(self._whole, self._present_rows()))

    def _present_rows(self) -> dict[str, tuple[float, str]]:
        """Name -> (value, text), of what is varied and asked, of the design at hand."""
        whole = self._whole
        rows = {
            name_of(whole, path): (number, f"{name_of(whole, path)} {number_text(path, number)}")
            for path, number in zip(self.spans, self._numbers(), strict=True)
        }
        for each in self._measured():
            value = self._values.get(each.key, float("nan"))
            rows[each.name] = value, f"{each.name} {value_text(each.key, value)}"
        return rows

    def _reopen(self, design: Design) -> None:
        self.session.end_gesture()
        self.session.put_full_design(design, "Reopen a card")
        self.session.end_gesture()

    def _save(self) -> None:
        """The study as a file beside the design, whose file it names."""
        own = self.session.path
        if own is None:
            self.status_message.emit("A study names the file of its design: save the design first")
            return
        path = dialogs.study_to_save(self, own.with_name(f"{own.stem}_study.toml"))
        if path is None:
            return
        try:
            save_study(file_of_question(self._asks(), relpath(own, path.parent)), path)
        except KindynaError as error:
            self.status_message.emit(str(error))
        else:
            self.status_message.emit(f"Saved {path.name}; its design is {own.name} as that file has it")

    # -- when -----------------------------------------------------------------------------------------------

    def _stop(self) -> None:
        self._soon_survey.stop()
        self._surveys.stop()

    @property
    def busy(self) -> bool:
        waits = self._soon_survey.isActive() or self._soon_share.isActive()
        works = (self._surveys, self._shares, self._details, self.best)
        return super().busy or waits or any(each.busy for each in works)

    def settle(self) -> None:
        super().settle()
        if self._soon_survey.isActive():
            self._soon_survey.stop()
            self._survey()
        self._surveys.wait(30.0)

    def leave(self) -> None:
        super().leave()
        self._stop()
        self._soon_share.stop()
        for each in (self._surveys, self._shares, self._details):
            each.close()
        self.best.close_work()
        self.bands.close()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        if self._surveys.busy or self._soon_survey.isActive():
            self._stop()
            self._of, self._stale = (), True
        if self._soon_share.isActive() or self._shares.busy or self._details.busy:
            self._end_share()
            self._share_of, self._stale = (), True

    def picture(self, ending: str) -> bytes:
        """The plot that is shown, without the forms."""
        from kindyna_gui.pictures.painter import png, svg

        page: Any = self.pages.currentWidget()
        return self.on_paper(page, svg if ending == ".svg" else png)


def _alike(one: Design, other: Design, paths: Sequence[str]) -> bool:
    """Whether two designs differ in these fields, and in tolerances, at most."""
    try:
        numbers = {path: get(one, path) for path in paths}
        made = replace(other, tolerances=one.tolerances, waviness=one.waviness, assumed=one.assumed)
        for path, value in numbers.items():
            made = put(made, path, value)
    except KindynaError:
        return False
    return made == one


__all__ = ["StudyView"]
