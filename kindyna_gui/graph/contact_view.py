"""Keeping contact: the contact force over cam angle and speed, and the flight of a follower that has left its cam."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np
from PySide6.QtWidgets import QLabel

from core.design import UNITS, Design, require_motion
from core.dynamics import ContactMap, Flights
from core.errors import KindynaError
from core.output.subject_files import lift_off_lines, map_of
from core.study import Study
from kindyna_gui.background_view import BackgroundView
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.amount import fill_choices
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.labels import reason
from kindyna_gui.note import beside
from kindyna_gui.pictures.plots.contact_map import ACROSS, show_map
from kindyna_gui.pictures.plots.xy import Line, XYPlot
from kindyna_gui.pictures.style import BLUE, DASHED, VERMILION
from kindyna_gui.pictures.units import short, with_unit
from kindyna_gui.player import Player
from kindyna_gui.requirements import NO_FLIGHT, NotHere

HELD = "A groove, or a conjugate pair, holds the follower from both sides: it cannot leave its cam."
MAP, FLIGHT = "map", "flight"
PAGES = {MAP: "Force over speed", FLIGHT: "Flight after lift-off"}
ANGLES, SPEEDS = 361, 80
PAGE_WIDTH = 150  # pixels
MOST_TURNS = 3
POINTS = 361  # of the motion, in each turn


class ContactView(BackgroundView):
    """Computed beside the window, and only what is on top while it can be seen."""

    stages = ("linkage", "cam", "dynamics")
    pause_ms = 150

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.page, self.text = WordBox(), QLabel(wordWrap=True)
        self.page.setAccessibleName("What is shown")
        fill_choices(self.page, PAGES)
        self.page.setMinimumWidth(PAGE_WIDTH)
        self.plot = XYPlot(ACROSS, "")
        self.plot.setMinimumSize(220, 100)
        self._work.result.connect(self._computed)
        self.page.activated.connect(self._choose)
        row = beside(self.page, self.text)
        self.set_column(row, self.plot, grows=self.plot)

    def refresh(self, study: Study) -> None:
        if study.design.drive.cam is None:
            raise NotHere(NO_FLIGHT)
        if study.is_form_closed:
            raise NotHere(HELD)
        study.contact_force  # noqa: B018 - says why, where no contact can be lost
        page = str(self.page.currentData())
        self._work.start([((page, study.design), partial(_COMPUTED[page], study.design))])

    def _choose(self, _: int) -> None:
        self.plot.show_message("")
        self._stale = True
        self.pull()

    def _computed(self, key: tuple[str, Design], result: Any) -> None:
        _, design = key
        if isinstance(result, KindynaError):
            self.text.setText("")
            self.plot.show_message(reason(design, result))
            return
        lines, found = result
        self.text.setText(" ".join(lines))
        if isinstance(found, ContactMap):
            show_map(self.plot, found, design.speed_rpm)
        elif isinstance(found, Flights):
            self._show_flights(design, found)

    def _show_flights(self, design: Design, found: Flights) -> None:
        """The follower's way beside the motion, with where each flight ends."""
        if not found.flights:
            self.plot.show_message(f"At {short(design.speed_rpm, 6)} rpm the follower stays on the cam.")
            return
        study, unit = Study(design), UNITS[require_motion(design).unit]
        last = max((one.theta[-1] for one in found.flights), default=0.0)
        turns = min(MOST_TURNS, max(1, math.ceil(last / (2.0 * math.pi))))
        theta = np.linspace(0.0, 2.0 * math.pi * turns, POINTS * turns)
        motion = study.at_theta(np.mod(theta, 2.0 * math.pi)).motion.displacement[0]
        lines = [Line(np.rad2deg(theta), motion / unit.factor, BLUE, "motion", DASHED)]
        for i, one in enumerate(one for one in found.flights if one.lift < theta[-1]):
            inside = one.theta <= theta[-1]
            way = Line(np.rad2deg(one.theta[inside]), one.y[inside] / unit.factor, VERMILION, "" if i else "flight")
            lines.append(way)
        first = found.flights[0]
        marks = [(math.degrees(first.lift), "off")]
        if first.land < theta[-1]:
            marks.append((math.degrees(first.land), "on"))
        self.plot.name_axes(ACROSS, f"Displacement, {unit.symbol}")
        self.plot.show_lines(lines, tuple(marks))

    def settle(self) -> None:
        super().settle()
        self._work.wait(30.0)


def _map(design: Design) -> tuple[list[str], ContactMap]:
    study = Study(design)
    return lift_off_lines(study), map_of(study, np.linspace(0.0, 2.0 * math.pi, ANGLES)[:-1], None, SPEEDS)


def _flights(design: Design) -> tuple[list[str], Flights]:
    study = Study(design)
    found = study.flights()
    return _flight_text(study, found), found


def _flight_text(study: Study, found: Flights) -> list[str]:
    """The first flight, and how many there are."""
    if not found.flights:
        return lift_off_lines(study)
    first, unit = found.flights[0], UNITS[study.program.motion.unit]
    text = (
        f"Off at {math.degrees(first.lift):.2f}°, {with_unit(short(first.height / unit.factor, 4), unit.symbol)} high"
    )
    if math.isfinite(first.land):
        text += f", on at {math.degrees(first.land):.2f}° with {short(first.speed / unit.factor, 4)} {unit.symbol}/s"
    if not found.steady:
        return [f"{text}; flights do not repeat in three turns."]
    count = len(found.flights) - found.repeats
    return [
        f"{text}; {count} flight{'s' if count > 1 else ''} {'a turn' if found.turns == 1 else f'in {found.turns} turns'}"
    ]


_COMPUTED = {MAP: _map, FLIGHT: _flights}
