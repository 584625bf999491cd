"""The request of the study dock: numbers and words to vary, figures to compute with their limits, and goals."""

from __future__ import annotations

from collections.abc import Mapping

from PySide6.QtCore import QObject, Signal

from core.design import Design, get
from core.study import TOTALS, Study
from core.varying import (
    Limits,
    Question,
    Span,
    StudyFile,
    VariedField,
    default_span,
    field_info,
    question_of_file,
    request_keys,
    suggested_figures,
    valid_words,
)
from core.varying.space import QUIET_LAWS
from core.varying.surveys import SEED


class StudyRequest(QObject):
    """Numbers and words to vary, figures to compute, and goals, as edited in the dock.

    Attributes
    ----------
    spans : dict of str to Span
        Path of a varied number and its bounds.
    words : dict of str to tuple of str
        Path of a varied word and the words to try.
    figures : dict of str to Limits
        Key of a figure and its least and greatest allowed value.
    goals : dict of str to bool
        Key of a figure or path of a varied number, and True if it is minimised.
    robust : float or None
        Share of machines that must keep the limits.
    shown : str
        Key of the figure that colours the plots.
    seed : int
        Seed of Sobol's points and of random machines.
    """

    changed = Signal()
    """An edit has changed the request; ``load``, ``clear`` and ``restrict_to`` do not emit it."""

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.clear()

    def clear(self) -> None:
        """Remove all numbers, words, figures and goals."""
        self.spans: dict[str, Span] = {}
        self.words: dict[str, tuple[str, ...]] = {}
        self.figures: dict[str, Limits] = {}
        self.goals: dict[str, bool] = {}
        self.robust: float | None = None
        self.shown = ""
        self.seed = SEED
        self._typed: Mapping[str, VariedField] = {}  # rows of the study file that was opened
        self._valid_words: dict[str, tuple[str, ...]] = {}

    def question(self) -> Question:
        """Return the request as a study of core."""
        return Question(
            tuple(self.spans.values()), self.words, self.figures, self.goals, self.robust, self._typed, self.seed
        )

    def load(self, file: StudyFile) -> None:
        """Replace the request by that of a study file."""
        question = question_of_file(file)
        self.spans = {span.path: span for span in question.spans}
        self.words, self._typed, self.seed = dict(question.words), question.typed, question.seed
        self.figures, self.goals, self.robust = dict(question.figures), dict(question.goals), question.robust
        self.shown = next((key for key in self.goals if key in self.figures), next(iter(self.figures), ""))

    def restrict_to(self, design: Design, fields: tuple[str, ...]) -> None:
        """Remove the numbers, words, figures and goals that a design does not have; fields: those that can be varied."""
        keys = set(request_keys(design))
        self.spans = {path: span for path, span in self.spans.items() if path in fields}
        self.words = {path: words for path, words in self.words.items() if self.valid_words(design, path)}
        self.figures = {key: limits for key, limits in self.figures.items() if key.partition(":")[0] in keys}
        self.goals = {
            key: minimised for key, minimised in self.goals.items() if key in self.figures or key in self.spans
        }
        if self.shown not in self.figures:
            self.shown = next(iter(self.figures), "")

    # -- varied numbers and words -------------------------------------------------------------------------

    def vary(self, design: Design, study: Study, path: str) -> None:
        """Vary a number or a word of a design, whose study suggests figures.

        Raises ValueError where the number has no default bounds.
        """
        if path in self.spans or path in self.words:
            return
        info = field_info(design, path)
        if info is not None and info.choices:
            current = get(design, path)
            self.words[path] = tuple(
                word
                for word in self.valid_words(design, path)
                if word in QUIET_LAWS or word == current or not path.endswith(".law")
            )
        else:
            self.spans[path] = default_span(design, path)
        if not self.figures:
            self.figures = dict(suggested_figures(study, path))
            self.shown = next(iter(self.figures), "")
        self.changed.emit()

    def set_span(self, span: Span) -> None:
        """Set the bounds of a varied number."""
        self.spans[span.path] = span
        self.changed.emit()

    def set_words(self, path: str, words: tuple[str, ...]) -> None:
        """Set the words to try; an empty selection is ignored."""
        self.words[path] = words or self.words[path]
        self.changed.emit()

    def keep_fixed(self, path: str) -> None:
        """Vary this number or word no longer."""
        self.spans.pop(path, None)
        self.goals.pop(path, None)
        self.words.pop(path, None)
        self.changed.emit()

    def valid_words(self, design: Design, path: str) -> tuple[str, ...]:
        """Return the words that are valid at a path of the design, none where it has no word there."""
        info = field_info(design, path)
        if info is None or not info.choices:
            return ()
        if path not in self._valid_words:
            self._valid_words[path] = valid_words(design, path, info.choices)
        return self._valid_words[path]

    # -- figures ------------------------------------------------------------------------------------------

    @property
    def has_limits(self) -> bool:
        """Whether a figure has a limit."""
        return any(limits != (None, None) for limits in self.figures.values())

    def add_figure(self, slug: str) -> None:
        """Compute a total, or the peak of a quantity."""
        key = slug if slug in TOTALS else f"{slug}:abs"
        self.figures.setdefault(key, (None, None))
        self.shown = key
        self.changed.emit()

    def change_figure(self, before: str, key: str, limits: Limits) -> None:
        """Replace the key and the limits of a figure, at the same position."""
        self.figures = {
            key if name == before else name: limits if name == before else row for name, row in self.figures.items()
        }
        self.goals = {key if name == before else name: minimised for name, minimised in self.goals.items()}
        if self.shown == before:
            self.shown = key
        self.changed.emit()

    def remove_figure(self, key: str) -> None:
        """Compute a figure no longer."""
        del self.figures[key]
        self.goals.pop(key, None)
        if self.shown == key:
            self.shown = next(iter(self.figures), "")
        self.changed.emit()

    # -- goals --------------------------------------------------------------------------------------------

    def set_goals(self, goals: dict[str, bool]) -> None:
        """Replace the goals: key of a figure or path of a varied number, and True if it is minimised."""
        self.goals = goals
        self.changed.emit()

    def set_robust(self, share: float | None) -> None:
        """Set the share of machines that must keep the limits, None for no such goal."""
        self.robust = share
