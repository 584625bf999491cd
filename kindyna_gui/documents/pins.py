"""Pinned variants of the design, and the bands between which machines built to its tolerances lie."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import QObject, Signal

from core.design import Design, only
from core.design.camshaft import unsolved_motions
from core.design.curves import solve_laws
from core.errors import KindynaError, NoSolution
from core.frozen import frozen
from core.study import Camshaft, Quantity, Study
from kindyna_gui.background import Background, PendingResult
from kindyna_gui.documents.edits import SAMPLES
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import reason
from kindyna_gui.pictures.plots.quantities import counterparts, values_of
from kindyna_gui.rebuilt import single_shot
from kindyna_gui.requirements import Unavailable

if TYPE_CHECKING:
    from kindyna_gui.pictures.plots.xy import Line

REST_MS = 300  # from the last change of the design to the computation of its bands
MOST = 3  # pinned variants
Band = Mapping[str, np.ndarray]
"""Column -> percentiles (5, 360) over the cam angle; of a shaft: name of a drive ("" for all), or quantity of the motor ->
percentiles (5, 360) over the machine angle."""
Key = tuple[int, str] | str
"""Number of a drive and a column of it; or a key of ``SHAFT_BANDS``."""
SHAFT, MOTOR = "shaft", "motor"
SHAFT_BANDS = {SHAFT: "shaft_bands", MOTOR: "motor_bands"}  # functions of ``core.varying``, imported late


# -- bands -----------------------------------------------------------------------------------------------


def scatters(design: Design) -> bool:
    """Whether a design has tolerances or a waviness, so that built machines differ from it."""
    return bool(design.tolerances) or design.waviness is not None


class Bands(QObject):
    """Bands of the selected drive and of its shaft; only bands of visible plots are computed, in the background.

    Signal: ``changed`` when there are other bands, or none.
    """

    changed = Signal()

    @staticmethod
    def of(session: Session) -> Bands:
        """Return the bands of a session; they are created on the first call."""
        return session.findChild(Bands) or Bands(session)

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._session = session
        self.is_shown = False
        self._design = session.full_design
        self._bands: dict[Key, Any] = {}
        self._requested: dict[Key, None] = {}
        self._work = Background(self)
        self._work.result.connect(self._add)
        self._soon = single_shot(self, self._compute, REST_MS)
        session.full_design_changed.connect(self._renew)

    def set_shown(self, on: bool) -> None:
        """Set whether plots show bands."""
        if on != self.is_shown:
            self.is_shown = on
            self._forget()
            self.changed.emit()

    def _renew(self) -> None:
        """Discard the bands of another design: its tolerances, or other drives on the shaft, may differ."""
        if self._design != self._session.full_design:
            self._forget()
            if self.is_shown:
                self.changed.emit()

    def _forget(self) -> None:
        self._design = self._session.full_design
        self._bands, self._requested = {}, {}
        self._work.stop()
        self._soon.stop()

    @property
    def busy(self) -> bool:
        """Whether bands are being computed, or about to be."""
        return self._soon.isActive() or self._work.busy

    def close(self) -> None:
        """Discard the bands and end the computation."""
        self._forget()
        self._work.close()

    def read(self, rows: Sequence[Quantity], drive: int | None = None) -> Band:
        """Return the known bands of these quantities of a drive, by default the selected one.

        The others are computed in the background, and ``changed`` reports them.
        """
        if drive is None and self._session.is_on_balancer:
            return {}
        number = self._session.chosen if drive is None else drive
        return {key[1]: band for key, band in self._read([(number, row.slug) for row in rows]).items()}

    def of_shaft(self) -> Band:
        """Return the bands of the torque of each drive and of all together [N m], as ``read``."""
        return dict(self._read([SHAFT]).get(SHAFT, {}))

    def of_motor(self) -> Band:
        """Return the bands of ``motor_torque`` [N m] and ``camshaft_speed`` [rad/s] with the flywheel, as ``read``."""
        return dict(self._read([MOTOR]).get(MOTOR, {}))

    def _read(self, keys: Sequence[Key]) -> dict[Key, Any]:
        if not self.is_shown or not scatters(self._session.full_design):
            return {}
        if self._design != self._session.full_design:  # a view may read before ``_renew`` is called
            self._forget()
        new = [key for key in keys if key not in self._bands and key not in self._requested]
        if new:
            self._requested |= dict.fromkeys(new)
            self._soon.start()
        return {key: self._bands[key] for key in keys if self._bands.get(key) is not None}

    def _compute(self) -> None:
        if self._session.drag_source is not None:
            self._soon.start()
            return
        design, keys = self._session.full_design, [key for key in self._requested if key not in self._bands]
        jobs: list[Any] = []
        drive_keys = [key for key in keys if isinstance(key, tuple)]
        for number in sorted({key[0] for key in drive_keys}):
            columns = tuple(key for key in drive_keys if key[0] == number)
            jobs += [(columns, partial(_drive_bands, design, columns, quick)) for quick in (True, False)]
        jobs += [((key,), partial(_shaft_bands, design, key)) for key in SHAFT_BANDS if key in keys]
        self._work.start(jobs)

    def _add(self, keys: tuple[Key, ...], result: Mapping[Key, Any] | KindynaError) -> None:
        bands = {} if isinstance(result, KindynaError) else result
        self._bands |= dict.fromkeys(key for key in keys if key not in self._bands) | dict(bands)
        if bands:
            self.changed.emit()


def _drive_bands(design: Design, keys: Sequence[tuple[int, str]], quick: bool) -> Mapping[Key, Any]:
    from core.varying import drive_bands

    number = keys[0][0]
    bands = drive_bands(design, number, [slug for _, slug in keys], quick)
    return {(number, slug): band for slug, band in bands.items()}


def _shaft_bands(design: Design, key: str) -> Mapping[Key, Any]:
    from core import varying

    return {key: getattr(varying, SHAFT_BANDS[key])(design)}


# -- pinned variants -------------------------------------------------------------------------------------


@frozen
class Pin:
    """A pinned variant: its name and its full design."""

    name: str
    design: Any


class Pins(QObject):
    """Up to three pinned variants of a session's design; the last one is compared with it.

    They are removed when another design is opened, and undoing that step does not restore them.

    Signal: ``changed`` when another variant is compared, or none.
    """

    changed = Signal()

    @staticmethod
    def of(session: Session) -> Pins:
        """Return the pinned variants of a session; they are created on the first call."""
        return session.findChild(Pins) or Pins(session)

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._session = session
        self.rows: tuple[Pin, ...] = ()
        self._number = 0
        self._studies: dict[tuple[int, int], Study] = {}
        self._lacking: dict[tuple[object, ...], str] = {}  # study and quantities -> why it has no curve of them
        self._laws = PendingResult(
            self, "the laws of a pinned variant", "Calculating the optimal laws of a pinned variant"
        )
        self._laws.known.connect(self.changed)
        self._note_file()
        session.file_changed.connect(self._note_file)
        session.started.connect(self._leave)

    @property
    def front(self) -> Pin | None:
        """The variant that the design is compared with."""
        return self.rows[-1] if self.rows else None

    @property
    def named_design(self) -> tuple[Design, str] | None:
        """The full design and the name of the variant that the design is compared with."""
        return None if self.front is None else (self.front.design, self.front.name)

    def pin(self, design: Design, name: str = "") -> Pin:
        """Pin a design; the oldest variant is removed where there are three."""
        self._number += 1
        row = Pin(name or f"variant {self._number}", design)
        self._set_rows((*self.rows, row)[-MOST:])
        return row

    def pin_change(self, before: Design, after: Design, name: str) -> None:
        """Pin both designs of a change; the design is compared with the first one."""
        self.pin(after, name)
        self.pin(before, f"before {name}")

    def unpin(self) -> None:
        """Remove the variant that the design is compared with."""
        self._set_rows(self.rows[:-1])

    def bring(self, row: Pin) -> None:
        """Compare the design with another variant, unless that was removed."""
        if any(pin is row for pin in self.rows):
            self._set_rows((*(pin for pin in self.rows if pin is not row), row))

    def _leave(self) -> None:
        """Remove the variants of another design; a file that is read again is the same design."""
        if self._session.path is None or self._file != (self._session.document, self._session.path):
            self._number = 0
            self._set_rows(())

    def _note_file(self) -> None:
        self._file = (self._session.document, self._session.path)

    def _set_rows(self, rows: tuple[Pin, ...]) -> None:
        self.rows = rows
        self._studies.clear()
        self._lacking.clear()
        self._laws.drop()
        self.changed.emit()

    def reference(self, rows: Sequence[Quantity]) -> tuple[Study | None, str]:
        """Return the variant's study where it has some of these quantities; else None, and the reason."""
        study, front = self.study, self.front
        if study is None or front is None:
            return None, ""
        key = id(study), *((row.name, row.unit.symbol) for row in rows)
        if key not in self._lacking:
            try:
                with self.named():
                    curves = counterparts(study, rows)
                    for row in curves.values():
                        values_of(study, row)
                self._lacking[key] = "" if curves else f"Pinned {front.name} has no such curve"
            except Unavailable as error:
                self._lacking[key] = str(error)
        lacking = self._lacking[key]
        return None if lacking else study, lacking

    def shaft_lines(self, draw: Callable[[Camshaft[Study]], Iterable[Line]]) -> list[Line]:
        """Return the curves that a plot draws of a shaft, for the shaft of the variant; none where that has none."""
        study, front = self.full_study, self.front
        if study is None or front is None or not study.design.listed:
            return []
        from kindyna_gui.pictures.plots.xy import reference_lines  # loads pyqtgraph, as the plots that ask have

        try:
            return reference_lines(draw(study.camshaft), front.name)
        except KindynaError:
            return []

    @property
    def _has_laws(self) -> bool:
        """Whether there is a variant whose optimal laws are solved; else they are, in the background."""
        if self.front is None:
            return False
        motions = unsolved_motions(self.front.design)
        return not motions or not self._laws.later(motions, partial(solve_laws, motions))

    @property
    def full_study(self) -> Study | None:
        """The study of the full design of the variant, once its laws are known; computed when it is read."""
        return self._study(-1) if self._has_laws else None

    @property
    def study(self) -> Study | None:
        """The study of the variant's drive with the number of the selected one, once its laws are known.

        None where it has no such drive.
        """
        if self.front is None or not self._has_laws:
            return None
        if not self.front.design.listed:
            return self._study(-1) if not self._session.has_several_drives else None
        drives = self.front.design.drives
        return (
            self._study(self._session.chosen)
            if self._session.has_several_drives and self._session.chosen < len(drives)
            else None
        )

    @contextmanager
    def named(self) -> Iterator[None]:
        """Name the variant in errors inside the context, by raising Unavailable instead of NoSolution."""
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
