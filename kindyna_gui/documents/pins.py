"""Variants that are pinned: designs that the one at hand is held against."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from PySide6.QtCore import QObject, Signal

from core.design import Design, only
from core.errors import NoSolution
from core.frozen import frozen
from core.study import Study
from kindyna_gui.documents.refusal import SAMPLES
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import reason
from kindyna_gui.requirements import NotHere

MOST = 3


@frozen
class Pin:
    """A variant: what it is called, and its whole design."""

    name: str
    design: Any


class Pins(QObject):
    """Up to three variants, the last one pinned in front; of a session, found as its child.

    changed   another variant is in front, or none
    """

    changed = Signal()

    @staticmethod
    def of(session: Session) -> Pins:
        """Those of a session, made when they are first asked for."""
        return session.findChild(Pins) or Pins(session)

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._session = session
        self.rows: tuple[Pin, ...] = ()
        self._number = 0
        self._studies: dict[tuple[int, int], Study] = {}
        session.started.connect(self.changed)

    @property
    def front(self) -> Pin | None:
        """What the design at hand is held against."""
        return self.rows[-1] if self.rows else None

    def pin(self, design: Design, name: str = "") -> Pin:
        """Pin a design; the oldest goes where there are three."""
        self._number += 1
        row = Pin(name or f"variant {self._number}", design)
        self._keep((*self.rows, row)[-MOST:])
        return row

    def unpin(self) -> None:
        """Let the one in front go."""
        self._keep(self.rows[:-1])

    def bring(self, row: Pin) -> None:
        """Bring one to the front, unless it has gone."""
        if any(each is row for each in self.rows):
            self._keep((*(each for each in self.rows if each is not row), row))

    def _keep(self, rows: tuple[Pin, ...]) -> None:
        self.rows = rows
        self._studies.clear()
        self.changed.emit()

    @property
    def whole_study(self) -> Study | None:
        """Of the one in front, all drives of it; computed when it is read."""
        return None if self.front is None else self._study(-1)

    @property
    def study(self) -> Study | None:
        """Of the drive that is shown, where the one in front has as many."""
        if self.front is None:
            return None
        if not self.front.design.listed:
            return self._study(-1) if not self._session.several else None
        drives = self.front.design.drives
        return (
            self._study(self._session.chosen) if self._session.several and self._session.chosen < len(drives) else None
        )

    @contextmanager
    def named(self) -> Iterator[None]:
        """What has no answer inside is said to be the one in front, not the design at hand. Raises NotHere."""
        try:
            yield
        except NoSolution as error:
            assert self.front is not None
            raise NotHere(f"Pinned {self.front.name}: {reason(self.front.design, error)}") from error

    def _study(self, drive: int) -> Study:
        assert self.front is not None
        key = id(self.front), drive
        if key not in self._studies:
            design = self.front.design if drive < 0 else only(self.front.design, drive)
            self._studies[key] = Study(design, SAMPLES)
        return self._studies[key]


__all__ = ["MOST", "Pin", "Pins"]
