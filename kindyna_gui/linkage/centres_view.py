"""All instant centres, angular velocities and points of a mechanism at the angle at hand, as tables."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QTabWidget

from core.errors import KindynaError
from core.frozen import frozen
from core.instant_centres import CAM
from core.mechanism.kinematics import FRAME
from core.output.position import CentreRow, DifferenceRow, Link, LinkRow, Links, PointRow, Position
from core.study import Study
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import reason
from kindyna_gui.note import SteadyText
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import digits
from kindyna_gui.player import Player
from kindyna_gui.preferences.units import size_of, symbol_of
from kindyna_gui.requirements import require_centres
from kindyna_gui.view import View

MM, RPM = 1e3, math.pi / 30.0
DECIMALS = 6  # of lengths in mm and of velocities; rounding is far below
_CENTRES = (
    TableHeading("Centre"),
    TableHeading("x", number=True, unit="mm"),
    TableHeading("y", number=True, unit="mm"),
    TableHeading("Found", wide=True),
)
_LINKS = (
    TableHeading("Link"), TableHeading("ω, rad/s", number=True), TableHeading("ω, rpm", number=True),
        TableHeading("ω : driver", number=True),
    TableHeading("Advantage", number=True), TableHeading("", wide=True),
)  # fmt: skip
_SPEEDS = tuple(TableHeading(text, number=True, unit="mm/s") for text in ("vx", "vy", "|v|"))
_POINTS = (
    TableHeading("Point"),
    TableHeading("x", number=True, unit="mm"),
    TableHeading("y", number=True, unit="mm"),
    *_SPEEDS,
    TableHeading("", wide=True),
)
_DIFFERENCES = (TableHeading("Vector"), TableHeading("Link", number=True), *_SPEEDS, TableHeading("", wide=True))
ABSENT = "Instant centres are listed of linkages, and of a cam with its follower; this motion moves neither."


def plain(value: float, unit: str = "") -> str:
    """A number with as many decimals as are certain, as its unit is shown; what is not a number is a dash."""
    value /= size_of(unit)
    return "\u2013" if math.isnan(value) else digits(value, 8) if abs(value) >= 1e-9 else "0"


def label(links: Links) -> str:
    """``I13``, with a comma where a number has two digits, or a body has a name."""
    a, b = map(str, links)
    return f"I{a}{b}" if len(a) == len(b) == 1 else f"I{a},{b}" if (a + b).isdigit() else f"{a}, {b}"


def method_text(row: CentreRow) -> str:
    """How a centre follows: at sight, by its pair, or where which two lines cross, of which one may be the contact normal."""
    if not row.lines:
        return "at sight"
    a, b = row.links
    lines = [f"{label(_rising(a, t))}\u2013{label(_rising(b, t))}" for t in row.lines[:2]]
    lines += ["contact normal"] if len(lines) == 1 else []
    return " \u00d7 ".join(lines)


def _rising(a: Link, b: Link) -> Links:
    """Numbers in rising order, then names, the frame before and the cam behind all others."""
    first, second = sorted((a, b), key=lambda each: (isinstance(each, str), each == CAM, each != FRAME))
    return (first, second) if isinstance(a, str) or isinstance(b, str) or a < b else (b, a)


def _centre(row: CentreRow) -> TableRow:
    if row.place is not None:
        x, y = plain(row.place.real * MM, "mm"), plain(row.place.imag * MM, "mm")
    elif row.direction is not None:
        x, y = "at infinity", f"{plain(math.degrees(row.direction))}°"
    else:
        x, y = "none", "at rest"
    return TableRow(
        (label(row.links), x, y, method_text(row)),
        tip=f"Instant centre of {row.links[0]} and {row.links[1]}; found {method_text(row)}",
    )


def _link(row: LinkRow) -> TableRow:
    cells = (str(row.link), *(plain(v) for v in (row.omega, row.omega / RPM, row.ratio, row.advantage)), "")
    return TableRow(
        cells,
        tip="Angular velocity counter-clockwise; ratio to that of driver or cam, and torque for a torque of 1 at the driver",
    )


def _speeds(v: complex) -> tuple[str, ...]:
    return tuple(plain(part, "mm/s") for part in (v.real, v.imag, abs(v)))


def _point(row: PointRow) -> TableRow:
    z, v = row.place * MM, row.velocity * MM
    return TableRow((row.name, *(plain(part, "mm") for part in (z.real, z.imag)), *_speeds(v), ""))


def _difference(row: DifferenceRow) -> TableRow:
    slides = row.link != row.on
    p, a = (f"{row.p}{row.link}", f"{row.a}{row.on}") if slides else (row.p, row.a)
    v = row.v_pa * MM
    on = f"{row.on} under it, on which {row.link} slides" if slides else f"{a}, both on {row.link}"
    return TableRow(
        (f"V {p}{a}", str(row.link), *_speeds(v), ""),
        tip=f"Velocity of {p} against {on}: V {p} = V {a} + V {p}{a}",
    )


@frozen
class CentresPage:
    """A table: its title, its columns, and how a position fills it."""

    title: str
    headings: tuple[TableHeading, ...]
    rows: Callable[[Position], list[TableRow]]


PAGES: Mapping[str, CentresPage] = MappingProxyType(
    {
        "centres": CentresPage("Centres", _CENTRES, lambda now: [_centre(row) for row in now.centres]),
        "links": CentresPage("Links", _LINKS, lambda now: [_link(row) for row in now.links]),
        "points": CentresPage("Points", _POINTS, lambda now: [_point(row) for row in now.points]),
        "differences": CentresPage(
            "Differences", _DIFFERENCES, lambda now: [_difference(row) for row in now.differences]
        ),
    }
)


class CentresView(View):
    """Tables that follow the player, of which the one in front is made, and the distance between any two centres."""

    stages = ("linkage",)
    pause_ms = 120
    reading_ms = 100

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.now: Position | None = None
        self._keys: list[Links] = []
        self.tabs = QTabWidget(documentMode=True)
        self.tables = {name: RowsTable(page.headings) for name, page in PAGES.items()}
        for name, table in self.tables.items():
            table.setWordWrap(False)
            self.tabs.addTab(table, PAGES[name].title)
        self.one, self.other = self._chooser("First centre"), self._chooser("Second centre")
        self.distance, self.transmission = SteadyText(), SteadyText(SCREEN.quiet)
        row = QHBoxLayout()
        row.setContentsMargins(8, 2, 8, 0)
        row.addWidget(QLabel("From"))
        row.addWidget(self.one)
        row.addWidget(QLabel("to"))
        row.addWidget(self.other)
        row.addWidget(self.distance, 1)
        foot = QHBoxLayout()
        foot.setContentsMargins(8, 0, 8, 4)
        foot.addWidget(self.transmission)
        self.set_column(self.tabs, row, foot, grows=self.tabs, spacing=3)
        self.tabs.currentChanged.connect(self._fill_table)

    def _chooser(self, name: str) -> QComboBox:
        box = QComboBox()
        box.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        box.setAccessibleName(name)
        box.setToolTip("The distance between two centres at this angle")
        box.activated.connect(lambda _: self._show_distance())
        return box

    def refresh(self, study: Study) -> None:
        require_centres(study, ABSENT)
        self._show(self.session.at(self.player.theta))

    def follow(self, theta: float) -> None:
        try:
            require_centres(self.session.study, ABSENT)
            self._show(self.session.at(theta))
        except KindynaError as error:
            self.transmission.show_text(reason(self.session.design, error))

    def _show(self, there: Study) -> None:
        if self.now is not None and self.now.study is there:
            return
        now = Position(there)
        self._choose_from([row.links for row in now.centres])
        self.now = now
        self._fill_table()
        self._show_distance()
        angles = ", ".join(f"{joint} {plain(math.degrees(angle))}°" for joint, angle in now.transmission)
        self.transmission.show_text(f"Transmission angle: {angles}" if angles else "")

    def page(self, name: str) -> RowsTable:
        """Bring one of ``PAGES`` to the front; its table."""
        self.tabs.setCurrentWidget(self.tables[name])
        return self.tables[name]

    def _fill_table(self, *_: object) -> None:
        """The table in front; the others when they come there."""
        name = list(PAGES)[self.tabs.currentIndex()]
        if self.now is not None:
            self.tables[name].update_rows(PAGES[name].rows(self.now))

    def _choose_from(self, keys: Sequence[Links]) -> None:
        """The centres to choose from; at first the driver's pole and the next link's."""
        if keys == self._keys:
            return
        self._keys = list(keys)
        for box, first in ((self.one, 0), (self.other, 1)):
            box.clear()
            for key in keys:
                box.addItem(label(key), key)
            box.setCurrentIndex(min(first, box.count() - 1))

    def _show_distance(self) -> None:
        one, other = self.one.currentData(), self.other.currentData()
        if self.now is None or one is None or other is None:
            return
        gap = self.now.distance(tuple(one), tuple(other)) * MM
        self.distance.show_text(f"{plain(gap, 'mm')} {symbol_of('mm')}" if math.isfinite(gap) else "infinite")


__all__ = ["CentresView"]
