"""Pinned variants, bands."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from typing import Any

import numpy as np
from PySide6.QtCore import QObject, QTimer, Signal

from core.design import Design, only
from core.errors import KindynaError, NoSolution
from core.frozen import frozen
from core.study import Quantity, Study
from kindyna_gui.background import Background
from kindyna_gui.documents.edits import SAMPLES
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import reason
from kindyna_gui.requirements import Unavailable

# -- bands -----------------------------------------------------------------------------------------------

REST_MS = 300  # of the design, before machines are drawn
Band = Mapping[str, np.ndarray]
"""Column -> percentiles (5, 360) over the cam angle; or, of a shaft, name of a drive, empty of all, or of a quantity of the motor, -> those
over the machine angle."""
Key = tuple[int, str] | str
"""Number of a drive and a column of it; or one of ``OF_SHAFT``."""
SHAFT, MOTOR = "shaft", "motor"
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
        self._of = session.full_design
        self._known: dict[Key, Any] = {}
        self._wanted: dict[Key, None] = {}
        self._work = Background(self)
        self._work.result.connect(self._found)
        self._soon = QTimer(self, singleShot=True, interval=REST_MS)
        self._soon.timeout.connect(self._compute)
        session.full_design_changed.connect(self._renew)

    def ask(self, on: bool) -> None:
        """Whether plots show them."""
        if on != self.asked:
            self.asked = on
            self._forget()
            self.changed.emit()

    def _renew(self) -> None:
        """Also where the drive at hand stays the same: its tolerances, or other drives on the shaft, are others."""
        if self._of != self._session.full_design:
            self._forget()
            if self.asked:
                self.changed.emit()

    def _forget(self) -> None:
        self._of = self._session.full_design
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
        if not self.asked or not scatters(self._session.full_design):
            return {}
        if self._of != self._session.full_design:  # a view may come before ``_renew``
            self._forget()
        new = [key for key in keys if key not in self._known and key not in self._wanted]
        if new:
            self._wanted |= dict.fromkeys(new)
            self._soon.start()
        return {key: self._known[key] for key in keys if self._known.get(key) is not None}

    def _compute(self) -> None:
        if self._session.drag_source is not None:
            self._soon.start()
            return
        whole, wanted = self._session.full_design, [key for key in self._wanted if key not in self._known]
        jobs: list[Any] = []
        of_drives = [key for key in wanted if isinstance(key, tuple)]
        for number in sorted({key[0] for key in of_drives}):
            keys = tuple(key for key in of_drives if key[0] == number)
            jobs += [(keys, partial(_of_drive, whole, keys, quick)) for quick in (True, False)]
        jobs += [((key,), partial(_of_shaft, whole, key)) for key in OF_SHAFT if key in wanted]
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

    return {key: getattr(varying, OF_SHAFT[key])(whole)}


# -- pins ------------------------------------------------------------------------------------------------

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
    def full_study(self) -> Study | None:
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
        """What has no answer inside is said to be the one in front, not the design at hand. Raises Unavailable."""
        try:
            yield
        except NoSolution as error:
            assert self.front is not None
            raise Unavailable(f"Pinned {self.front.name}: {reason(self.front.design, error)}") from error

    def _study(self, drive: int) -> Study:
        assert self.front is not None
        key = id(self.front), drive
        if key not in self._studies:
            design = self.front.design if drive < 0 else only(self.front.design, drive)
            self._studies[key] = Study(design, SAMPLES)
        return self._studies[key]
