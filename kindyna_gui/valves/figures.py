"""Figures of an inlet and an exhaust valve next to each other: a table for the cam card, and the view Valve figures."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from core.design import Design
from core.frozen import frozen
from core.study import Study
from core.valves import LIFTS, ValveTiming, crank_text, valve_data, valve_pairs, valve_timings
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.look import answer_label
from kindyna_gui.pictures.units import brief, number, short, with_unit
from kindyna_gui.player import Player
from kindyna_gui.requirements import NO_VALVE, Unavailable
from kindyna_gui.settings import size_of, symbol_of
from kindyna_gui.view import View

HEADINGS = (
    TableHeading("Valve train", wide=True),
    TableHeading("Inlet", number=True),
    TableHeading("Exhaust", number=True),
)
LOBE_ROW, VALVE_ROW = ("lobe", 1.27, "lobe, 0.050 in"), ("valve", 1.0, "valve, 1 mm")
"""What is lifted, the lift of an event [mm], and both in words."""
NAMES = ("intake", "exhaust")

Valve = Mapping[str, Any]

# -- texts of the figures ---------------------------------------------------------------------------------------


def _degrees(value: float) -> str:
    return f"{number(value, 1)}°"


def _event(row: tuple[str, float, str], key: str) -> Callable[[Valve], str]:
    """Text of the duration, the opening or the closing at a row."""

    def text(valve: Valve) -> str:
        for event in valve["events"]:
            if (event["of"], event["at_mm"]) == row[:2]:
                value = event[key]
                return _degrees(value) if key == "duration_deg" else _crank(value)
        return ""

    return text


def _crank(value: float) -> str:
    """Crank angle by its nearest dead centre, such as ``20.5° BTDC``."""
    angle, centre = crank_text(round(value, 1)).split()
    return f"{number(float(angle), 1)}° {centre}"


def _plain(key: str, unit: str = "", most: int = 4) -> Callable[[Valve], str]:
    """Text of a figure in a unit."""
    return lambda valve: brief(valve[key], unit, most) if key in valve else ""


def _end(key: str, unit: str, sign: float = 1.0) -> Callable[[Valve], str]:
    """Text of the greatest value of a range, or of the greatest negative one."""
    return lambda valve: with_unit(short(max(sign * end for end in valve[key]), 4), unit) if key in valve else ""


def _ratio(valve: Valve) -> str:
    return " … ".join(short(end, 3) for end in valve.get("rocker_ratio", ()))


def _springs(key: str, unit: str, combine: Callable[[list[float]], float]) -> Callable[[Valve], str]:
    """Text of a figure of all springs together; of a pair of values the last one, at the greatest lift."""

    def text(valve: Valve) -> str:
        values = [spring[key] for spring in valve.get("springs", ()) if key in spring]
        values = [value[-1] if isinstance(value, list) else value for value in values]
        return brief(combine(values), unit, 4) if values else ""

    return text


def _clearance(valve: Valve) -> str:
    return brief(valve["clearance"]["least_mm"], "mm", 3) if "clearance" in valve else ""


def _clearance_at(valve: Valve) -> str:
    return _crank(valve["clearance"]["crank_deg"]) if "clearance" in valve else ""


@frozen
class FigureRow:
    """A row of the table: its words, the text of a valve, whether the cam card shows it, and a tip."""

    label: str
    text: Callable[[Valve], str]
    on_card: bool = False
    tip: str = ""


FIGURE_ROWS = (
    FigureRow("Lobe lift", _plain("lobe_lift_mm", "mm", 6), tip="greatest lift of the motion"),
    FigureRow("Valve lift", _plain("valve_lift_mm", "mm", 6), tip="greatest, through the train, the lash taken off"),
    *(
        FigureRow(f"{words}, {row[2]}", _event(row, key), key == "duration_deg", f"at this lift of the {row[0]}")
        for row in (LOBE_ROW, VALVE_ROW)
        for words, key in (("Duration", "duration_deg"), ("Opens", "opens_deg"), ("Closes", "closes_deg"))
    ),
    FigureRow(
        "Left to coil bind", _springs("bind_mm", "mm", min), True, "travel at the greatest lift; at most 0: binds"
    ),
    FigureRow("Float speed, engine", _plain("float_rpm", "rpm"), True, "from here on the follower leaves the cam"),
    FigureRow("Piston clearance", _clearance, True, "least distance of valve and piston; at most 0: they hit"),
    FigureRow("at crank angle", _clearance_at),
    FigureRow("Valve lift at TDC", _plain("lift_at_tdc_mm", "mm"), True),
    FigureRow("Greatest velocity", _end("velocity_mm_per_deg", "mm/°"), tip="of the motion, by cam angle"),
    FigureRow("Flank acceleration", _end("acceleration_mm_per_deg2", "mm/°²"), tip="the greatest, by cam angle"),
    FigureRow("Nose deceleration", _end("acceleration_mm_per_deg2", "mm/°²", -1.0), tip="the greatest, by cam angle"),
    FigureRow("Opening velocity", _plain("opening_velocity_mm_s", "mm/s"), tip="of the valve as the lash is taken up"),
    FigureRow("Seating velocity", _plain("seating_velocity_mm_s", "mm/s"), True, "of the valve as it meets its seat"),
    FigureRow("Rocker ratio", _ratio),
    FigureRow("Least tappet diameter", _plain("least_tappet_diameter_mm", "mm"), True),
    FigureRow("Least convex radius", _plain("convex_radius_mm", "mm"), tip="of the cam's profile"),
    FigureRow("Least hollow radius", _plain("concave_radius_mm", "mm"), True, "a grinding wheel must be smaller"),
    FigureRow("Spring force, closed", _springs("seat_n", "N", sum), tip="all springs together"),
    FigureRow("Spring force, open", _springs("open_n", "N", sum), tip="all springs together"),
    FigureRow("Spring stress", _springs("stress_mpa", "MPa", max), tip="greatest, corrected"),
    FigureRow("Fatigue safety", _springs("goodman", "", min), tip="Goodman's safety; below 1 the spring fatigues"),
    FigureRow("Natural frequency", _springs("natural_hz", "Hz", min), tip="of the slowest spring"),
)


def figure_rows(valves: Sequence[Valve | None], is_card: bool = False) -> list[TableRow]:
    """Rows of the figures of an inlet and an exhaust valve; figures that neither has are left out."""
    rows = []
    for row in FIGURE_ROWS:
        texts = ["" if valve is None else row.text(valve) for valve in valves]
        if any(texts) and (row.on_card or not is_card):
            rows.append(TableRow((row.label, *texts), tip=row.tip))
    return rows


def pair_rows(pair: Mapping[str, Any]) -> list[TableRow]:
    """Rows of separation, advance and overlaps of an inlet and an exhaust valve."""
    rows = [("Separation", _degrees(pair["separation_deg"])), ("Advance", _degrees(pair["advance_deg"]))]
    for of, at_mm, words in (LOBE_ROW, VALVE_ROW):
        rows += [
            (f"Overlap, {words}", _degrees(row["deg"]))
            for row in pair["overlap"]
            if (row["of"], row["at_mm"]) == (of, at_mm)
        ]
    if "overlap_area_mm_deg" in pair:
        area = pair["overlap_area_mm_deg"] / size_of("mm")
        rows.append(("Overlap area", f"{short(area)} {symbol_of('mm')}·°"))
    return [TableRow((label, text, "")) for label, text in rows]


LEAST = (
    ("clearance to the piston", "mm", lambda valve: [valve["clearance"]["least_mm"]] if "clearance" in valve else []),
    ("left to coil bind", "mm", lambda valve: [spring["bind_mm"] for spring in valve.get("springs", ())]),
    ("float speed of the engine", "rpm", lambda valve: [valve["float_rpm"]] if "float_rpm" in valve else []),
)
"""Words, unit and values of a valve of the figures in the verdict."""


def figures_verdict(valves: Sequence[Valve | None]) -> str:
    """Whether valves hit the piston or springs bind, then the least of each figure of both valves, as a sentence."""
    present = [valve for valve in valves if valve is not None]
    faults, texts = [], []
    for words, unit, read in LEAST:
        rows = sorted((value, valve["drive"]) for valve in present for value in read(valve))
        faults += [f"{name}: {words} {brief(value, unit, 3)}" for value, name in rows if value <= 0.0]
        texts += [f"{words} {brief(value, unit, 4 if unit == 'rpm' else 3)}" for value, _ in rows[:1] if value > 0.0]
    text = ", ".join([*faults, *texts])
    return f"{text[:1].upper()}{text[1:]}." if text else ""


# -- the view ---------------------------------------------------------------------------------------------------


def chosen_valves(timings: Sequence[ValveTiming], chosen: str) -> tuple[ValveTiming | None, ValveTiming | None]:
    """Inlet and exhaust valve of the pair of a drive, else of the first pair, else a single valve on its side."""
    pairs = [(pair.inlet, pair.exhaust) for pair in valve_pairs(timings)]
    of_drive = [pair for pair in pairs if chosen in (pair[0].name, pair[1].name)]
    if of_drive or pairs:
        return (of_drive or pairs)[0]
    single = next((timing for timing in timings if timing.name == chosen), timings[0])
    return (single, None) if single.centre > 0.0 else (None, single)


class ValveFiguresView(View):
    """Table of the figures of the inlet and the exhaust valve of the chosen drive's cylinder."""

    is_design_wide = True
    stages = ("linkage", "cam", "dynamics")
    pause_ms = 200

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.answer, self.table = answer_label(), RowsTable(HEADINGS)
        self.set_column(self.answer, self.table, grows=self.table)

    def refresh(self, study: Study) -> None:
        design = self.session.full_design
        if not design.has_valves:
            raise Unavailable(NO_VALVE)
        valves, pairs = shown_figures(design, self.session.names[self.session.chosen])
        self.answer.setText(figures_verdict(valves))
        self.table.show_rows([*(row for pair in pairs for row in pair_rows(pair)), *figure_rows(valves)])


def shown_figures(design: Design, chosen: str = "") -> tuple[list[Valve | None], Sequence[Mapping[str, Any]]]:
    """Figures of an inlet and an exhaust valve, as the command ``valve`` gives them, and of their pair."""
    chosen_pair = chosen_valves(valve_timings(design), chosen)
    data = valve_data([timing for timing in chosen_pair if timing is not None], LIFTS)
    rows: Iterator[Valve] = iter(data["valves"])
    return [None if timing is None else next(rows) for timing in chosen_pair], data["pairs"]
