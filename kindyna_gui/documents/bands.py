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
"""Column -> percentiles (5, 360) over the cam angle; or, of a shaft, name of a drive, empty of all, or of a quantity of the motor, -> those
over the machine angle."""
SHAFT, MOTOR = "\nshaft", "\nmotor"  # of all drives, among columns
OF_SHAFT = {SHAFT: "shaft_bands", MOTOR: "motor_bands"}  # functions of ``core.varying``, imported late


def scatters(design: Design) -> bool:
    """Whether machines differ from a design."""
    return bool(design.tolerances) or design.waviness is not None


class Bands(QObject):
    """Those of the drive that is shown, and of all on its shaft; nothing is computed before they are asked for, and then of what is in
    sight only.

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
        self._of = self._shown
        self._known: dict[str, Any] = {}
        self._wanted: dict[str, None] = {}
        self._work = Background(self)
        self._work.result.connect(self._found)
        self._soon = QTimer(self, singleShot=True, interval=REST_MS)
        self._soon.timeout.connect(self._compute)
        session.whole_changed.connect(self._renew)

    def ask(self, on: bool) -> None:
        """Whether plots show them."""
        if on != self.asked:
            self.asked = on
            self._forget()
            self.changed.emit()

    def _renew(self) -> None:
        """Also where the drive at hand stays the same: its tolerances, or other drives on the shaft, are others."""
        if self._of != self._shown:
            self._forget()
            if self.asked:
                self.changed.emit()

    @property
    def _shown(self) -> tuple[Design, int]:
        return self._session.whole, self._session.chosen

    def _forget(self) -> None:
        self._of = self._shown
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
        return {} if self._session.on_balancer else self._read([row.slug for row in rows])

    def of_shaft(self) -> Band:
        """Those of the torque of each drive and of all together [N m], as ``read``."""
        found: Band = self._read([SHAFT]).get(SHAFT, {})
        return found

    def of_motor(self) -> Band:
        """Those of ``motor_torque`` [N m] and ``camshaft_speed`` [rad/s] behind the flywheel of all, as ``read``."""
        found: Band = self._read([MOTOR]).get(MOTOR, {})
        return found

    def _read(self, keys: Sequence[str]) -> dict[str, Any]:
        if not self.asked or not scatters(self._session.whole):
            return {}
        if self._of != self._shown:  # a view may come before ``_renew``
            self._forget()
        new = [key for key in keys if key not in self._known and key not in self._wanted]
        if new:
            self._wanted |= dict.fromkeys(new)
            self._soon.start()
        return {key: self._known[key] for key in keys if self._known.get(key) is not None}

    def _compute(self) -> None:
        if self._session.held is not None:
            self._soon.start()
            return
        from core.varying import bands_of, tolerances_of

        session, wanted = self._session, [key for key in self._wanted if key not in self._known]
        slugs = tuple(key for key in wanted if key not in OF_SHAFT)
        job = partial(bands_of, session.design, tolerances_of(session.whole, session.chosen), slugs)
        jobs: list[Any] = [(slugs, partial(job, quick)) for quick in (True, False)] if slugs else []
        jobs += [((key,), partial(_of_shaft, key, session.whole)) for key in OF_SHAFT if key in wanted]
        self._work.start(jobs)

    def _found(self, slugs: tuple[str, ...], found: Band | KindynaError) -> None:
        if isinstance(found, KindynaError):
            found = {}
        self._known |= dict.fromkeys(slug for slug in slugs if slug not in self._known) | dict(found)
        if found:
            self.changed.emit()


def _of_shaft(key: str, whole: Design) -> Mapping[str, Band]:
    from core import varying

    return {key: getattr(varying, OF_SHAFT[key])(whole)}


__all__ = ["Band", "Bands", "scatters"]
