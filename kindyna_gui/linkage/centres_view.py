"""Views of instant centres, of the circle diagram that constructs them, and of velocity and force polygons."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QPushButton, QTabWidget, QWidget

from core.errors import KindynaError
from core.frozen import frozen
from core.instant_centres import CAM, Construction, VelocityPolygon, velocity_polygon
from core.mechanism.kinematics import FRAME
from core.output.position import CentreRow, DifferenceRow, Link, LinkRow, Links, PointRow, Position
from core.study import Study
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import reason
from kindyna_gui.look import Note, SteadyText, described
from kindyna_gui.pictures.drawing.centre_parts import CircleDiagram, construction_text
from kindyna_gui.pictures.drawing.polygons import (
    PolygonDiagram,
    PolygonSheet,
    body_label,
    force_box,
    force_diagram,
    pair_box,
    pair_diagram,
    pair_label,
    velocity_box,
    velocity_diagram,
    velocity_step_text,
)
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import digits, number
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import fill, widget_with
from kindyna_gui.requirements import lists_links, require_centres, require_links
from kindyna_gui.settings import size_of, symbol_of
from kindyna_gui.view import View

MM, RPM = 1e3, math.pi / 30.0
BUTTON = 58  # width of a button next to the text of a step, pixels
_CENTRES = (
    TableHeading("Centre"),
    TableHeading("x", number=True, unit="mm"),
    TableHeading("y", number=True, unit="mm"),
    TableHeading("Construction", wide=True, spare=1),
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
NO_CENTRES = "Instant centres exist for linkages and for a disk cam with its follower; this design has neither."
NO_CIRCLE = "The circle diagram constructs the centres of a linkage; this design has none."
NO_POLYGON = "The velocity polygon is drawn for linkages; for the follower of a cam the mechanism shows the velocities."
VELOCITIES, FORCES_ON, FORCE_IN = "velocities", "body", "pair"
DiagramChoice = tuple[str, str]
"""Kind of polygon, and name of its body or pair."""

# -- instant centres -------------------------------------------------------------------------------------


def plain(value: float, unit: str = "") -> str:
    """Format a number in the unit on display; a dash if it is not defined."""
    value /= size_of(unit)
    return "\u2013" if math.isnan(value) else digits(value) if abs(value) >= 1e-9 else "0"


def label(links: Links) -> str:
    """Name of a centre: ``I13``, with a comma if a number has two digits, the two names if a body has a name."""
    a, b = map(str, links)
    return f"I{a}{b}" if len(a) == len(b) == 1 else f"I{a},{b}" if (a + b).isdigit() else f"{a}, {b}"


def method_text(row: CentreRow) -> str:
    """Construction of a centre: at sight, or the crossing of two lines, one of which may be the contact normal."""
    if not row.lines:
        return "at sight"
    a, b = row.links
    lines = [f"{label(_rising(a, t))}\u2013{label(_rising(b, t))}" for t in row.lines[:2]]
    lines += ["contact normal"] if len(lines) == 1 else []
    return " \u00d7 ".join(lines)


def _rising(a: Link, b: Link) -> Links:
    """Sort two links: numbers in rising order, then names, the frame first and the cam last."""
    first, second = sorted((a, b), key=lambda link: (isinstance(link, str), link == CAM, link != FRAME))
    return (first, second) if isinstance(a, str) or isinstance(b, str) or a < b else (b, a)


def _centre(row: CentreRow) -> TableRow:
    if row.point is not None:
        x, y = plain(row.point.real * MM, "mm"), plain(row.point.imag * MM, "mm")
    elif row.direction is not None:
        x, y = "at infinity", f"{plain(math.degrees(row.direction))}°"
    else:
        x, y = "none", "at rest"
    return TableRow(
        (label(row.links), x, y, method_text(row)),
        tip=f"Instant centre of {row.links[0]} and {row.links[1]}: {method_text(row)}",
    )


def _link(row: LinkRow) -> TableRow:
    cells = (str(row.link), *(plain(v) for v in (row.omega, row.omega / RPM, row.ratio, row.advantage)), "")
    return TableRow(
        cells,
        tip="Angular velocity, counter-clockwise positive; its ratio to driver or cam; torque for a driver torque of 1",
    )


def _speeds(v: complex) -> tuple[str, ...]:
    return tuple(plain(part, "mm/s") for part in (v.real, v.imag, abs(v)))


def _point(row: PointRow) -> TableRow:
    z, v = row.position * MM, row.velocity * MM
    return TableRow((row.name, *(plain(part, "mm") for part in (z.real, z.imag)), *_speeds(v), ""))


def _difference(row: DifferenceRow) -> TableRow:
    slides = row.link != row.on
    p, a = (f"{row.p}{row.link}", f"{row.a}{row.on}") if slides else (row.p, row.a)
    v = row.v_pa * MM
    on = f"the point under it on {row.on}, on which {row.link} slides" if slides else f"{a}, both on {row.link}"
    return TableRow(
        (f"V {p}{a}", str(row.link), *_speeds(v), ""),
        tip=f"Velocity of {p} relative to {on}: V {p} = V {a} + V {p}{a}",
    )


@frozen
class CentresPage:
    """A table: title, columns, and the function that returns its rows at a position."""

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
    """Tables that follow the player, computed for the page in front, and the distance between any two centres."""

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
        self.first, self.second = self._centre_box("First centre"), self._centre_box("Second centre")
        self.distance, self.transmission = SteadyText(), SteadyText(SCREEN.quiet)
        widgets = QLabel("From"), self.first, QLabel("to"), self.second, self.distance
        row = _row(widgets, self.distance, top=2, bottom=0)
        footer = _row([self.transmission], bottom=4)
        self.set_column(self.tabs, row, footer, grows=self.tabs, spacing=3)
        self.tabs.currentChanged.connect(self._fill_table)

    def _centre_box(self, name: str) -> QComboBox:
        box = described(QComboBox(), name=name, tip="Distance between two centres at this angle")
        box.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        box.activated.connect(lambda _: self._show_distance())
        return box

    def refresh(self, study: Study) -> None:
        require_centres(study, NO_CENTRES)
        self.now = None  # the units may be others
        self._show(self.session.at(self.player.theta))

    def follow(self, theta: float) -> None:
        try:
            require_centres(self.session.study, NO_CENTRES)
            self._show(self.session.at(theta))
        except KindynaError as error:
            self.transmission.show_text(reason(self.session.design, error))

    def _show(self, study: Study) -> None:
        """Show a study at one angle."""
        if self.now is not None and self.now.study is study:
            return
        now = Position(study)
        self._offer_centres([row.links for row in now.centres])
        self.now = now
        self._fill_table()
        self._show_distance()
        angles = ", ".join(f"{joint} {plain(math.degrees(angle))}°" for joint, angle in now.transmission)
        self.transmission.show_text(f"Transmission angle: {angles}" if angles else "")

    def page(self, name: str) -> RowsTable:
        """Bring one of ``PAGES`` to the front, and return its table."""
        self.tabs.setCurrentWidget(self.tables[name])
        return self.tables[name]

    def _fill_table(self, *_: object) -> None:
        """Fill the table in front."""
        name = list(PAGES)[self.tabs.currentIndex()]
        if self.now is not None:
            self.tables[name].update_rows(PAGES[name].rows(self.now))

    def _offer_centres(self, keys: Sequence[Links]) -> None:
        """Fill the lists of centres; select the pole of the driver and the next centre."""
        if keys == self._keys:
            return
        self._keys = list(keys)
        for box, index in ((self.first, 0), (self.second, 1)):
            box.clear()
            for key in keys:
                box.addItem(label(key), key)
            box.setCurrentIndex(min(index, box.count() - 1))

    def _show_distance(self) -> None:
        first, second = self.first.currentData(), self.second.currentData()
        if self.now is None or first is None or second is None:
            return
        gap = self.now.distance(tuple(first), tuple(second)) * MM
        self.distance.show_text(f"{plain(gap, 'mm')} {symbol_of('mm')}" if math.isfinite(gap) else "infinite")


# -- circle diagram --------------------------------------------------------------------------------------


class CircleView(View):
    """The circle diagram step by step; the mechanism shows the same step."""

    stages = ("linkage",)

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.diagram = CircleDiagram()
        self.text = QLabel(wordWrap=True, textInteractionFlags=Qt.TextInteractionFlag.TextSelectableByMouse)
        self.text.setMinimumSize(1, 1)
        self.text.setContentsMargins(8, 0, 8, 0)
        self.count = QLabel(alignment=Qt.AlignmentFlag.AlignCenter)
        self.back, self.next, self.end = QPushButton("&Back"), QPushButton("&Next"), QPushButton("&End")
        self.back.setToolTip("One step back")
        self.next.setToolTip("Find the next centre; its lines are drawn in the mechanism")
        self.end.setToolTip("End the construction; the drawing shows its layers again")
        self.back.clicked.connect(lambda: self._go(-1))
        self.next.clicked.connect(lambda: self._go(1))
        self.end.clicked.connect(lambda: session.choose_step(None))
        row = _row((self.back, self.count, self.next, self.end), self.count, bottom=6)
        self.set_column(self.diagram, self.text, row, grows=self.diagram, spacing=4)
        session.step_changed.connect(self._redraw)

    @property
    def _plan(self) -> Construction:
        return self.session.study.centres.construction

    def refresh(self, study: Study) -> None:
        require_links(study.design, NO_CIRCLE)
        plan, current = self._plan, self.session.step
        step = min(current or 0, len(plan.steps))
        self.diagram.show_step(self.session.study.centres.bodies, plan, step)
        more = (
            f" {len(plan.unreachable)} centres are not reached by two triangles."
            if plan.unreachable and step == len(plan.steps)
            else ""
        )
        self.text.setText(construction_text(plan, step) + more)
        self.count.setText(f"{step} of {len(plan.steps)}")
        self.back.setEnabled(step > 0)
        self.next.setEnabled(step < len(plan.steps))
        self.end.setEnabled(current is not None)

    def _redraw(self) -> None:
        if self.on_screen() and self.up_to_date and not self.in_trouble:
            self.refresh(self.session.study)
        else:
            self.invalidate()

    def _go(self, step: int) -> None:
        self.session.choose_step(min(max((self.session.step or 0) + step, 0), len(self._plan.steps)))


# -- velocity and force polygons -------------------------------------------------------------------------


class PolygonView(View):
    """Polygon that follows the player, selected in a list; at first velocities of a linkage, forces of a follower."""

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.choice = described(
            QComboBox(),
            tip="Diagram: velocities from one pole, the forces on a body head to tail, or the force in a pin or guide",
        )
        self.choice.setObjectName("polygon")
        self.choice.currentIndexChanged.connect(self._choose)
        self.sheet = PolygonSheet()
        self.note = Note()
        self.back, self.next, self.all = QPushButton("&Back"), QPushButton("&Next"), QPushButton("&All")
        self.back.setToolTip("Remove the last vector")
        self.next.setToolTip("Add the next vector, V_P = V_A + V_PA; the first click starts at the pole")
        self.all.setToolTip("Show all vectors")
        self.step_label = QLabel(wordWrap=True, alignment=Qt.AlignmentFlag.AlignCenter)
        self.step_label.setMinimumSize(1, 1)
        self.back.clicked.connect(lambda: self._step(-1))
        self.next.clicked.connect(lambda: self._step(1))
        self.all.clicked.connect(lambda: self._show_steps(None))
        for button in (self.back, self.next, self.all):
            button.setMaximumWidth(BUTTON)
        self.steps_row = widget_with(_row((self.back, self.step_label, self.next, self.all), self.step_label, bottom=4))
        self.set_column(self.choice, self.sheet, self.steps_row, self.note, grows=self.sheet)
        self._steps: int | None = None
        self._polygon: VelocityPolygon | None = None
        session.started.connect(partial(setattr, self, "_steps", None))
        self._chosen: DiagramChoice | None = None
        self._diagram: Callable[[Study], PolygonDiagram] | None = None

    @property
    def stages(self) -> tuple[str, ...]:  # type: ignore[override]
        """Stages of the selected polygon; forces are computed only while they are drawn."""
        kind, _ = self._current_choice()
        return ("linkage",) if kind == VELOCITIES else ("linkage", "cam", "dynamics")

    def _current_choice(self) -> DiagramChoice:
        """Return the selected polygon if the design has it, else the first."""
        rows = [choice for choice, _ in self._rows()]
        return self._chosen if self._chosen is not None and self._chosen in rows else rows[0]

    def _rows(self) -> list[tuple[DiagramChoice, str]]:
        """Return the polygons of this design, and their texts."""
        study = self.session.study
        rows = [((VELOCITIES, ""), "Velocities")] if lists_links(study.design) else []
        try:
            mechanism = study.mechanism
            pairs = mechanism.pair_names.values()
        except KindynaError:
            return rows or [((VELOCITIES, ""), "Velocities")]
        bodies = [body for body in mechanism.bodies.values() if body != FRAME] + [CAM] * study.has_disk
        rows += [((FORCES_ON, body), f"Forces on {body_label(body)}") for body in bodies]
        return rows + [((FORCE_IN, name), f"Force at {pair_label(name)} over the turn") for name in pairs]

    def _choose(self, index: int) -> None:
        if index >= 0:
            self.choose(*self.choice.itemData(index))

    def choose(self, kind: str, name: str = "") -> None:
        """Draw the velocities, the forces on a body, or the force in a pair; without a name for the first."""
        rows = [choice for choice, _ in self._rows() if choice[0] == kind]
        self._chosen = (kind, name) if name or not rows else rows[0]
        self.invalidate()

    def refresh(self, study: Study) -> None:
        current, rows = self._current_choice(), self._rows()
        with QSignalBlocker(self.choice):
            if [self.choice.itemText(i) for i in range(self.choice.count())] != [text for _, text in rows]:
                self.choice.clear()
                for choice, text in rows:
                    self.choice.addItem(text, choice)
            self.choice.setCurrentIndex([choice for choice, _ in rows].index(current))
        self._polygon = None
        kind, name = current
        diagrams = {VELOCITIES: self._velocities, FORCES_ON: self._forces_on, FORCE_IN: self._force_in}
        self._diagram = diagrams[kind](study, name)

    def _velocities(self, study: Study, _: str) -> Callable[[Study], PolygonDiagram]:
        self._polygon = velocity_polygon(study.linkage)
        self.sheet.set_box(velocity_box(self._polygon, study.omega))
        return lambda at_angle: velocity_diagram(velocity_polygon(at_angle.linkage), at_angle.omega, self._steps)

    # -- step by step ---------------------------------------------------------------------------------------

    def _step(self, change: int) -> None:
        """Add or remove a vector; if all are shown, Next starts at the pole, and Back removes the last."""
        if self._polygon is not None:
            most = len(self._polygon.steps)
            current = self._steps if self._steps is not None else most if change < 0 else -1
            self._show_steps(min(max(current + change, 0), most))

    def _show_steps(self, count: int | None) -> None:
        self._steps = count
        self.follow(self.player.theta)

    def _update_steps(self) -> None:
        polygon, count = self._polygon, self._steps
        self.steps_row.setVisible(polygon is not None)
        if polygon is not None:
            most = len(polygon.steps)
            self.step_label.setText(
                "" if count is None else f"{count} of {most}: {velocity_step_text(polygon, min(count, most))}"
            )
            self.back.setEnabled(count != 0)
            self.next.setEnabled(count != most)
            self.all.setEnabled(count is not None)

    # -- the diagram ----------------------------------------------------------------------------------------

    def _forces_on(self, study: Study, body: str) -> Callable[[Study], PolygonDiagram]:
        rows = study.free_bodies.get(body, ())
        self.sheet.set_box(force_box(rows))
        largest = max((float(np.abs(row.force[np.isfinite(row.force)]).max(initial=0.0)) for row in rows), default=0.0)
        return lambda at_angle: force_diagram(at_angle.free_bodies.get(body, ()), largest)

    def _force_in(self, study: Study, name: str) -> Callable[[Study], PolygonDiagram]:
        turn = study.dynamics.pairs[name]
        self.sheet.set_box(pair_box(turn))
        return lambda at_angle: pair_diagram(name, complex(at_angle.dynamics.pairs[name][0]), turn)

    def follow(self, theta: float) -> None:
        study = self.session.study
        if self._diagram is None:
            return
        self._update_steps()
        try:
            diagram = self._diagram(self.session.at(theta))
        except KindynaError as error:
            self.note.show_message(reason(study.design, error))
            return
        absent = self._chosen == (VELOCITIES, "") != self._current_choice()
        self.note.show_message(NO_POLYGON if absent else "")
        name = study.angle_name.capitalize()
        self.sheet.show_diagram(diagram, f"{name} {number(math.degrees(theta), 1)}°")


def _row(widgets: Sequence[QWidget], stretched: QWidget | None = None, *, top: int = 0, bottom: int = 0) -> QHBoxLayout:
    """Lay out widgets in a row, one of which takes the free width; margins in pixels."""
    parts = ((widget, 1 if widget is stretched else 0) for widget in widgets)
    return fill(QHBoxLayout(), *parts, margins=(8, top, 8, bottom))
