"""Bands of what is made: between which values a quantity lies at each cam angle, in machines drawn by chance within the tolerances."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from PySide6.QtCore import QObject, QTimer, Signal

from core.design import Design
from core.errors import KindynaError
from core.study import Quantity
from kindyna_gui.background import Background
from kindyna_gui.documents.session import Session

REST_MS = 300  # of the design, before machines are drawn
Band = Mapping[str, np.ndarray]
"""Column -> percentiles (5, 360) over the cam angle."""


def scatters(design: Design) -> bool:
    """Whether machines differ from a design."""
    return bool(design.tolerances) or design.waviness is not None


class Bands(QObject):
    """Those of the drive that is shown; nothing is computed before they are asked for, and then of what is in sight only.

    changed   there are others, or none
    """

    changed = Signal()

    @staticmethod
    def of(session: Session) -> Bands:
        """Those of a session, made when they are first asked for."""
        return session.findChild(Bands) or Bands(session)

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._session = session
        self.asked = False
        self._known: dict[str, Any] = {}
        self._wanted: dict[str, None] = {}
        self._work = Background(self)
        self._work.result.connect(self._found)
        self._soon = QTimer(self, singleShot=True, interval=REST_MS)
        self._soon.timeout.connect(self._compute)
        session.design_changed.connect(self._forget)

    def ask(self, on: bool) -> None:
        """Whether plots show them."""
        if on != self.asked:
            self.asked = on
            self._forget()
            self.changed.emit()

    def _forget(self) -> None:
        self._known, self._wanted = {}, {}
        self._work.stop()
        self._soon.stop()

    @property
    def busy(self) -> bool:
        return self._soon.isActive() or self._work.busy

    def close(self) -> None:
        """The window closes."""
        self._forget()
        self._work.close()

    def read(self, rows: Sequence[Quantity]) -> Band:
        """Those of these quantities that are there; the others are computed, and told of by ``changed``."""
        if not self.asked or not scatters(self._session.whole) or self._session.on_balancer:
            return {}
        slugs = [row.slug for row in rows]
        new = [slug for slug in slugs if slug not in self._known and slug not in self._wanted]
        if new:
            self._wanted |= dict.fromkeys(new)
            self._soon.start()
        return {slug: self._known[slug] for slug in slugs if self._known.get(slug) is not None}

    def _compute(self) -> None:
        if self._session.held is not None:
            self._soon.start()
            return
        from core.varying import bands_of, tolerances_of

        session, slugs = self._session, tuple(slug for slug in self._wanted if slug not in self._known)
        tolerances = tolerances_of(session.whole, session.chosen)
        job = partial(bands_of, session.design, tolerances, slugs)
        self._work.start([(slugs, partial(job, quick)) for quick in (True, False)])

    def _found(self, slugs: tuple[str, ...], found: Band | KindynaError) -> None:
        if isinstance(found, KindynaError):
            found = {}
        self._known |= dict.fromkeys(slug for slug in slugs if slug not in self._known) | dict(found)
        if found:
            self.changed.emit()


__all__ = ["Band", "Bands", "scatters"]
