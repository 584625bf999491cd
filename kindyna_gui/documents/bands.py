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
Key = tuple[int, str] | str
"""Number of a drive and a column of it; or one of ``SHAFT_QUANTITIES``."""
SHAFT, MOTOR = "shaft", "motor"
SHAFT_QUANTITIES = {SHAFT: "shaft_bands", MOTOR: "motor_bands"}  # functions of ``core.varying``, imported late


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
        self._of = session.whole
        self._known: dict[Key, Any] = {}
        self._wanted: dict[Key, None] = {}
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
        if self._of != self._session.whole:
            self._forget()
            if self.asked:
                self.changed.emit()

    def _forget(self) -> None:
        self._of = self._session.whole
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

    def read(self, rows: Sequence[Quantity], drive: int | None = None) -> Band:
        """Those of these quantities that are there, of the drive at hand or another; the others are computed, and told of by
        ``changed``."""
        if drive is None and self._session.on_balancer:
            return {}
        number = self._session.chosen if drive is None else drive
        return {key[1]: band for key, band in self._read([(number, row.slug) for row in rows]).items()}

    def of_shaft(self) -> Band:
        """Those of the torque of each drive and of all together [N m], as ``read``."""
        found: Band = self._read([SHAFT]).get(SHAFT, {})
        return found

    def of_motor(self) -> Band:
        """Those of ``motor_torque`` [N m] and ``camshaft_speed`` [rad/s] behind the flywheel of all, as ``read``."""
        found: Band = self._read([MOTOR]).get(MOTOR, {})
        return found

    def _read(self, keys: Sequence[Key]) -> dict[Key, Any]:
        if not self.asked or not scatters(self._session.whole):
            return {}
        if self._of != self._session.whole:  # a view may come before ``_renew``
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
        whole, wanted = self._session.whole, [key for key in self._wanted if key not in self._known]
        jobs: list[Any] = []
        of_drives = [key for key in wanted if isinstance(key, tuple)]
        for number in sorted({key[0] for key in of_drives}):
            keys = tuple(key for key in of_drives if key[0] == number)
            jobs += [(keys, partial(_of_drive, whole, keys, quick)) for quick in (True, False)]
        jobs += [((key,), partial(_of_shaft, whole, key)) for key in SHAFT_QUANTITIES if key in wanted]
        self._work.start(jobs)

    def _found(self, keys: tuple[Key, ...], found: Mapping[Key, Any] | KindynaError) -> None:
        if isinstance(found, KindynaError):
            found = {}
        self._known |= dict.fromkeys(key for key in keys if key not in self._known) | dict(found)
        if found:
            self.changed.emit()


def _of_drive(whole: Design, keys: Sequence[tuple[int, str]], quick: bool) -> Mapping[Key, Any]:
    from core.varying import drive_bands

    number = keys[0][0]
    found = drive_bands(whole, number, [slug for _, slug in keys], quick)
    return {(number, slug): band for slug, band in found.items()}


def _of_shaft(whole: Design, key: str) -> Mapping[Key, Any]:
    from core import varying

    return {key: getattr(varying, SHAFT_QUANTITIES[key])(whole)}


__all__ = ["Band", "Bands", "scatters"]
