"""Valve springs: their force over the turn without and with surge, and the engine speeds at which harmonics of the lift meet them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress

import numpy as np
from PySide6.QtWidgets import QLabel, QStackedWidget

from core.design import Design
from core.errors import KindynaError
from core.frozen import frozen
from core.output.drawing.palette import BLUE, VERMILION
from core.study import Study
from core.study.extremes import extremes_beyond_lash
from core.study.valve_findings import least_surging_contact
from core.study.valve_springs import springs_of
from core.valves.spring_speeds import Resonance, engine_rpm, float_rpm, resonances, spring_forces
from kindyna_gui.documents.pins import Pins
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.fields import fill_choices
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.look import row_with_text
from kindyna_gui.pictures.plots.xy import ACROSS, ROWS, CursorPlot, Dots, Line, reference_lines
from kindyna_gui.pictures.units import brief, readable, readable_text, short
from kindyna_gui.player import Player
from kindyna_gui.requirements import NO_VALVE_SPRINGS, Unavailable
from kindyna_gui.view import View

FORCE, SPEEDS = "force", "speeds"
PAGES = {FORCE: "Force", SPEEDS: "Harmonics"}
PAGE_WIDTH = 104  # pixels
SPEED = "Engine speed, rpm"
REACH = 1.25
"""End of the axis of speeds over the greater of the present and the float speed."""
NEAR = math.log(1.15)
"""A resonance is near the present speed up to this logarithm of their ratio."""
LABEL_GAP = 0.045  # of the axis, between the numbers of two harmonics
LEAST = 0.005  # of the largest harmonic on the axis: a smaller one is not drawn
DOT = 5.0  # pixels


@frozen(eq=False)
class SpringDiagram:
    """Figures of the valve springs of a design, as the view shows them.

    Attributes
    ----------
    rpm : present speed of the engine [rpm]
    most_rpm : end of the axis of speeds [rpm]
    springs : harmonics of the lift for each spring, within the axis
    static, true : (n,) force without and with surge, closed over the turn [N]
    angles : (n,) cam angle [deg]
    """

    rpm: float
    most_rpm: float
    springs: tuple[tuple[Resonance, ...], ...]
    angles: np.ndarray
    static: np.ndarray
    true: np.ndarray

    @property
    def surge(self) -> float:
        """Greatest difference that surge makes to the force [N]."""
        return float(np.abs(self.true - self.static).max())

    @property
    def strongest(self) -> Resonance:
        """Strongest harmonic that resonates near the present speed, else the one that resonates nearest to it."""
        rows = [row for spring in self.springs for row in spring]
        near = [row for row in rows if abs(math.log(row.engine_rpm / self.rpm)) <= NEAR]
        if near:
            return max(near, key=lambda row: row.lift_mm)
        return min(rows, key=lambda row: abs(math.log(row.engine_rpm / self.rpm)))


def spring_diagram(study: Study) -> SpringDiagram:
    """Calculate the figures of a study. Raises NoSolution where its train cannot be assembled."""
    rpm = engine_rpm(study)
    most = REACH * max(rpm, float_rpm(study) or 0.0)
    static, true = (np.append(force, force[0]) for force in spring_forces(study))
    angles = np.append(np.rad2deg(study.theta), 360.0)
    rows = resonances(study)
    within = tuple(tuple(row for row in spring if row.engine_rpm <= most) or spring[-1:] for spring in rows)
    return SpringDiagram(rpm, most, within, angles, static, true)


def verdict(study: Study, diagram: SpringDiagram) -> str:
    """Whether the springs hold the follower on the cam, with the number to act on, and the strongest harmonic near the speed."""
    speed = f"{short(diagram.rpm, 4)} rpm of the engine"
    least, limit = least_surging_contact(study), float_rpm(study)
    if least is not None and least.value <= 0.0:
        text = f"Surge lifts the follower off the cam at {speed}: it lacks {readable_text(-least.value, 'N', 3)}"
    elif least is not None:
        without = extremes_beyond_lash(study, "contact_force").low.value
        forces = (readable_text(force, "N", 3) for force in (least.value, without))
        text = "The follower stays on the cam at {}: at least {} with surge, {} without".format(speed, *forces)
    elif limit is not None and limit <= diagram.rpm:
        text = f"The follower leaves the cam from {short(limit, 4)} rpm of the engine on, without surge"
    else:
        text = f"Surge changes the spring force by up to {readable_text(diagram.surge, 'N', 3)} at {speed}"
    return f"{text}. {resonance_text(diagram.strongest)}."


def resonance_text(row: Resonance) -> str:
    """A harmonic, its resonance, and the force at it, such as ``Harmonic 10, 0.0668 mm, resonates at 5663 rpm with 99.8 N``."""
    force = f" with {readable_text(row.force_n, 'N', 3)}" if math.isfinite(row.force_n) else ""
    return f"Harmonic {row.n}, {brief(row.lift_mm, 'mm', 3)}, resonates at {short(row.engine_rpm, 4)} rpm{force}"


class SpringView(View):
    """Force of the valve springs over the turn, or the harmonics of the lift over the engine speed; the verdict is next to the choice."""

    stages = ("linkage", "cam", "dynamics")
    pause_ms = 150

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.pins = Pins.of(session)
        self.pins.changed.connect(self.invalidate)
        self.page, self.text = WordBox(), QLabel(wordWrap=True)
        self.page.setAccessibleName("Plot of the valve springs")
        fill_choices(self.page, PAGES)
        self.page.setMinimumWidth(PAGE_WIDTH)
        self.page.activated.connect(self._choose)
        self.force, self.speeds = CursorPlot(ACROSS), CursorPlot(SPEED, reads=True)
        self.force.setToolTip("Click or drag to set the cam angle")
        self.force.moved.connect(self._turn)
        self.speeds.read.connect(self._show_harmonic)
        self.plots = QStackedWidget()
        for plot in (self.force, self.speeds):
            self.plots.addWidget(plot)
        self._summary = ""
        self._diagram: SpringDiagram | None = None
        self.set_column(row_with_text(self.page, self.text), self.plots, grows=self.plots)

    def refresh(self, study: Study) -> None:
        if not springs_of(study.design):
            raise Unavailable(NO_VALVE_SPRINGS)
        self._diagram = diagram = spring_diagram(study)
        self._summary = verdict(study, diagram)
        self.text.setText(self._summary)
        (self._show_force if self.page.currentData() == FORCE else self._show_speeds)(
            diagram, *self._pinned(study.design)
        )

    def _choose(self, _: int) -> None:
        self.plots.setCurrentIndex(self.page.currentIndex())
        self._stale = True
        self.pull()

    def _pinned(self, design: Design) -> tuple[SpringDiagram | None, str]:
        """Figures of the pinned variant and its name; None where it has no valve springs, or equals the design."""
        study, front = self.pins.study, self.pins.front
        with suppress(KindynaError):
            if study is not None and front is not None and study.design != design and springs_of(study.design):
                return spring_diagram(study), front.name
        return None, ""

    def _show_force(self, diagram: SpringDiagram, pinned: SpringDiagram | None, name: str) -> None:
        unit = readable("N", float(np.abs(diagram.true).max()))

        def lines(shown: SpringDiagram) -> list[Line]:
            curves = ("static", shown.static, BLUE), ("true, with surge", shown.true, VERMILION)
            return [Line(shown.angles, y / unit.size, colour, label, read=True) for label, y, colour in curves]

        others = reference_lines(lines(pinned)[1:], name) if pinned is not None else []
        self.force.name_axes(ACROSS, f"Spring force, {unit.symbol}")
        self.force.show_lines([*lines(diagram), *others], display_unit=unit)

    def _show_speeds(self, diagram: SpringDiagram, pinned: SpringDiagram | None, name: str) -> None:
        largest = max(row.lift_mm for rows in diagram.springs for row in rows)
        unit = readable("mm", largest)
        names = ["harmonic of the lift"]
        if len(diagram.springs) > 1:
            names = [f"valve spring {i}" for i in range(1, 1 + len(diagram.springs))]

        def drawn(shown: SpringDiagram) -> list[list[Resonance]]:
            return [[row for row in rows if row.lift_mm >= LEAST * largest] for rows in shown.springs]

        def lines(shown: SpringDiagram) -> list[Line]:
            rows = zip(drawn(shown), ROWS, names, strict=False)
            return [Line(*_stems(stems, unit.size), colour, label) for stems, colour, label in rows if stems]

        dots = [
            Dots(*_tops(rows, unit.size), colour, DOT, texts=_numbers(rows, diagram.most_rpm))
            for rows, colour in zip(drawn(diagram), ROWS, strict=False)
        ]
        others = reference_lines(lines(pinned), name) if pinned is not None else []
        self.speeds.name_axes(SPEED, f"Lift of the harmonic, {unit.symbol}")
        self.speeds.show_lines([*lines(diagram), *others], ((diagram.rpm, "now"),), dots=dots)
        self.speeds.show_range(across=(0.0, diagram.most_rpm))

    def _show_harmonic(self, rpm: float | None) -> None:
        """Show the harmonic nearest to the mouse, or the verdict if the mouse is outside the plot."""
        if rpm is None or self._diagram is None:
            self.text.setText(self._summary)
            return
        rows = (row for spring in self._diagram.springs for row in spring)
        self.text.setText(f"{resonance_text(min(rows, key=lambda row: abs(row.engine_rpm - rpm)))}.")

    def follow(self, theta: float) -> None:
        self.force.point_out(math.degrees(theta) % 360.0)

    def _turn(self, angle: float) -> None:
        self.player.play(False)
        self.player.set_theta(math.radians(angle))


def _tops(rows: Sequence[Resonance], size: float) -> tuple[np.ndarray, np.ndarray]:
    """Engine speeds (n,) [rpm] and lifts (n,), in a unit of so many millimetres, of harmonics."""
    return np.array([row.engine_rpm for row in rows]), np.array([row.lift_mm / size for row in rows])


def _stems(rows: Sequence[Resonance], size: float) -> tuple[np.ndarray, np.ndarray]:
    """Points (3n,) of vertical lines from zero to each harmonic, as in ``_tops``."""
    speeds, lifts = _tops(rows, size)
    return np.repeat(speeds, 3), np.column_stack((0.0 * lifts, lifts, np.full(lifts.size, np.nan))).ravel()


def _numbers(rows: Sequence[Resonance], most_rpm: float) -> list[str]:
    """Numbers of the harmonics as texts, the largest first; empty where there is no room next to that of a larger one."""
    named: list[Resonance] = []
    for row in sorted(rows, key=lambda row: -row.lift_mm):
        if all(abs(row.engine_rpm - other.engine_rpm) >= LABEL_GAP * most_rpm for other in named):
            named.append(row)
    return [str(row.n) if row in named else "" for row in rows]
