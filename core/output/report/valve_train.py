"""The chapter of a valve train: the cam card as it came out, events, springs, and each pair of inlet and exhaust valve."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from core.design import Design
from core.number_text import input_text
from core.output.lines import printable
from core.output.report.parts import Cell, Number, Section, section, table
from core.valves import LIFTS, crank_text, valve_data, valve_timings
from core.valves.figures import FIGURES, REFERENCE, SPRING_FIGURES

TYPED = (("centre_deg", "lobe centre", "crank °"), ("lash_mm", "lash", "mm"))
LIFT_ROWS = (("lobe_lift_mm", "lobe lift", "mm"), ("valve_lift_mm", "valve lift", "mm"))
"""Key of the data -> words and unit of the first rows of the card; those that are typed, and the greatest lifts."""
EVENT_HEADER = ("Valve", "lift of", "at mm", "opens °", "closes °", "duration crank °")


def valve_train(design: Design) -> list[Section]:
    """Card of every valve of a design, events at the default lifts, springs, and pairs. Raises KindynaError without valves."""
    data = valve_data(valve_timings(design), LIFTS)
    valves: Sequence[Mapping[str, Any]] = data["valves"]
    names = [printable(valve["drive"]) for valve in valves]
    return [
        *section("", table(("", *names, ""), _card(valves), slug="valves")),
        *section("Valve events, crank degrees", table(EVENT_HEADER, _events(valves), left=2, slug="valve_events")),
        *_springs(valves),
        *section("Inlet and exhaust", table((), _pairs(data["pairs"]), left=2, slug="valve_pairs")),
    ]


def _card(valves: Sequence[Mapping[str, Any]]) -> list[Sequence[Cell]]:
    """A row for every figure, a column for every valve; a range is a row for each end."""
    rows: list[Sequence[Cell]] = [
        (words, *(input_text(valve[key]) for valve in valves), unit) for key, words, unit in TYPED
    ]
    for key, words, unit in (*LIFT_ROWS, *FIGURES):
        cells = [valve.get(key) for valve in valves]
        if any(isinstance(cell, list) for cell in cells):
            for end, name in enumerate(("least", "greatest")):
                ends = [None if cell is None else cell[end] for cell in cells]
                rows.append(_row(f"{name} {words}", ends, unit))
        elif any(cell is not None for cell in cells):
            rows.append(_row(words, cells, unit))
    for lift in dict.fromkeys(lift for valve in valves for lift in valve.get("intensity_deg", {})):
        cells = [valve.get("intensity_deg", {}).get(lift) for valve in valves]
        rows.append(_row(f"intensity from {lift} to {REFERENCE:g} mm", cells, "crank °"))
    if any("clearance" in valve for valve in valves):
        rows.append(_row("least clearance to the piston", [_of(valve, "least_mm") for valve in valves], "mm"))
        angles = [_of(valve, "crank_deg") for valve in valves]
        rows.append(("at the crank angle", *("" if angle is None else crank_text(angle) for angle in angles), "°"))
    return rows


def _of(valve: Mapping[str, Any], key: str) -> float | None:
    clearance: Mapping[str, float] = valve.get("clearance", {})
    return clearance.get(key)


def _row(words: str, values: Iterable[float | None], unit: str) -> Sequence[Cell]:
    return (words, *("" if value is None else Number(value) for value in values), unit)


def _events(valves: Sequence[Mapping[str, Any]]) -> list[Sequence[Cell]]:
    """Opening, closing and duration; a valve without lash has those of its lobe where both lift alike."""
    rows: list[Sequence[Cell]] = []
    for valve in valves:
        known: dict[tuple[float, ...], str] = {}
        for event in valve["events"]:
            angles = event["at_mm"], event["opens_deg"], event["closes_deg"]
            known[angles] = f"{known[angles]}, {event['of']}" if angles in known else event["of"]
        rows += [
            (printable(valve["drive"]), of, f"{at:g}", crank_text(opens), crank_text(closes), Number(closes - opens))
            for (at, opens, closes), of in known.items()
        ]
    return rows


def _springs(valves: Sequence[Mapping[str, Any]]) -> list[Section]:
    """Figures of the valve springs, a column for each."""
    springs = [
        (f"{printable(valve['drive'])} {k}" if len(valve["springs"]) > 1 else printable(valve["drive"]), spring)
        for valve in valves
        for k, spring in enumerate(valve.get("springs", ()), 1)
    ]
    rows: list[Sequence[Cell]] = []
    for key, words, unit in SPRING_FIGURES:
        cells = [spring.get(key) for _, spring in springs]
        if any(isinstance(cell, list) for cell in cells):
            for end, name in enumerate(("closed", "at the greatest lift")):
                rows.append(_row(f"{words}, {name}", [cell[end] for cell in cells if cell is not None], unit))
        elif any(cell is not None for cell in cells):
            rows.append(_row(words, cells, unit))
    return section("Valve springs", table(("", *(name for name, _ in springs), ""), rows, slug="valve_springs"))


def _pairs(pairs: Sequence[Mapping[str, Any]]) -> list[Sequence[Cell]]:
    rows: list[Sequence[Cell]] = []
    for pair in pairs:
        names = f"{printable(pair['intake'])}, {printable(pair['exhaust'])}"
        rows.append((names, "separation, cam °", Number(pair["separation_deg"])))
        rows.append((names, "advance, cam °", Number(pair["advance_deg"])))
        known: dict[tuple[float, float], str] = {}
        for overlap in pair["overlap"]:
            key = overlap["at_mm"], overlap["deg"]
            known[key] = f"{known[key]}, {overlap['of']}" if key in known else overlap["of"]
        rows += [(names, f"overlap at {at:g} mm of the {of}, crank °", Number(deg)) for (at, deg), of in known.items()]
        if "overlap_area_mm_deg" in pair:
            rows.append((names, "overlap area, mm·crank °", Number(pair["overlap_area_mm_deg"])))
    return rows
