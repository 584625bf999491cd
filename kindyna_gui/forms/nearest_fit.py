"""The remedy of values that do not fit together: the nearest value of one field with which they do."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

from PySide6.QtCore import QObject

from core.design import Design, Entry, entry_at, get
from core.errors import DesignError
from core.study import Study
from kindyna_gui.background import Background
from kindyna_gui.documents.edits import SAMPLES, fits_together
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.form import IncompleteBar
from kindyna_gui.labels import entry_name, name_of, step_text, value_text
from kindyna_gui.rebuilt import connect_all, single_shot

PAUSE_MS = 150  # from the last edit to the search
Trial = tuple[str, float | None]
"""Path of a number, and its last valid value."""
Nearest = tuple[str, float] | None
"""Path and value with which the design fits together."""


class NearestFit(QObject):
    """Searches in the background for the nearest fitting value, and offers it in the bar about values that do not fit.

    It is a value of the field typed last, else of one that the reasons name.
    """

    def __init__(self, session: Session, bar: IncompleteBar) -> None:
        super().__init__(bar)
        self._session, self._bar = session, bar
        self._nearest: Nearest = None
        self._work = Background(self)
        self._pause = single_shot(self, self._search, PAUSE_MS)
        connect_all((self._work.result, self._offer), (bar.use_requested, self._use))

    @property
    def busy(self) -> bool:
        """Whether a search is running, or about to begin."""
        return self._pause.isActive() or self._work.busy

    def restart(self) -> None:
        """Search for the present values, after a pause."""
        self._work.stop()
        self._pause.stop()
        self._bar.show_use("")
        if self._session.misfit.reasons and not self._session.is_incomplete_linkage:
            self._pause.start()

    def close(self) -> None:
        """Stop for good."""
        self._pause.stop()
        self._work.close()

    def _search(self) -> None:
        session = self._session
        if session.misfit.reasons:
            stages = tuple(session.stages_on_screen())
            self._work.start([(session.typed, partial(_nearest, session.typed, tuple(self._trials()), stages))])

    def _trials(self) -> Iterator[Trial]:
        """Numbers of the drive that may mend it: that typed last, then those that the reasons name; motions close otherwise."""
        session = self._session
        for path in dict.fromkeys((session.misfit.path, *(path for path, _, _ in session.misfit.reasons))):
            entry = _number_at(session.typed, path)
            if entry is None or path.startswith("motion") or session.holder(path) is not session.typed:
                continue
            try:
                yield path, get(session.design, path)
            except (KeyError, DesignError):  # only the typed design has it
                yield path, None

    def _offer(self, design: Design, nearest: Nearest) -> None:
        if design is not self._session.typed or not isinstance(nearest, tuple):
            return
        self._nearest = nearest
        path, value = nearest
        entry = _number_at(design, path)
        if entry is not None:
            name = "" if path == self._session.misfit.path else f"{entry_name(design, entry)}: "
            self._bar.show_use(f"{name}{'use' if name else 'Use'} {value_text(value, entry.unit)}")

    def _use(self) -> None:
        """Enter the value, as one undo step."""
        session = self._session
        if self._nearest is None:
            return
        path, value = self._nearest
        entry = _number_at(session.typed, path)
        if entry is not None:
            session.end_gesture()
            session.edit(path, value, step_text(name_of(session.typed, path), value, entry.unit))
            session.end_gesture()


def _number_at(design: Design, path: str) -> Entry | None:
    entry = entry_at(design, path) if path else None
    return entry if entry is not None and isinstance(entry.value, float) else None


def _nearest(design: Design, trials: Sequence[Trial], stages: Sequence[str]) -> Nearest:
    from core.find.fitting import nearest_fitting_value  # only here, to save start-up time

    def fits(trial: Design) -> bool:
        return fits_together(Study(trial, SAMPLES), stages)

    for path, valid in trials:
        if (value := nearest_fitting_value(design, path, fits, valid)) is not None:
            return path, value
    return None


__all__ = ["NearestFit"]
