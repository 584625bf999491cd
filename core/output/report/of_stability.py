"""The sections of a report on a flexible shaft: its place in the chart, forbidden speeds, verdicts, the steady response."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from core.design import UNITS
from core.output.lines import digits, printable
from core.output.report.parts import Block, Cell, Number, ReportTable, Section, Sentences, section, table
from core.output.summary import stability
from core.study import Study

if TYPE_CHECKING:  # no design without a flexible shaft loads it
    from core.stability import SteadyTurn

ZERO = 1e-9  # of the torque's amplitude: a mean below it is rounding
LARGEST = 5  # harmonics that are named
FIGURES = {"growth_percent_per_turn": "growth a turn %", "largest_wind_up_deg": "wind-up °"}  # of a verdict


def shaft_stability(study: Study) -> list[Section]:
    """All of it; nothing where the shaft is rigid or nothing excites it."""
    values = stability(study)
    if not values:
        return []
    rows: list[Sequence[Cell]] = [
        ("Frequency ratio η", Number(values["eta"]), ""),
        ("Inertia ratio Q", Number(values["q"]), ""),
        ("Natural frequency of the shaft", Number(values["natural_rpm"]), "rpm"),
        ("Harmonics", str(values["harmonics"]), ""),
        ("Error of an edge η", f"{values['edge_error']:.0e}", ""),
    ]
    turn = study.stability.steady_turn if study.stability is not None and "steady" in values else None
    said = {"largest_wind_up_deg": math.nan} if turn is not None else {}  # the steady response has it below
    return section(
        "Stability of the flexible shaft",
        table((), rows, slug="stability", keys=("eta", "q", "natural_rpm", "", "")),
        _forbidden(values),
        verdicts("At the speed of the machine", [{**row, **said} for row in values["verdicts"]]),
        _needed(study, values),
        *(_steady(turn, values["steady"]) if turn is not None else []),
    )


def _forbidden(values: Mapping[str, Any]) -> ReportTable | Sentences:
    if not values["bands"]:
        return Sentences(("No forbidden band of speed",))
    rows: list[Sequence[Cell]] = []
    for band in values["bands"]:
        growth = band["growth_percent_per_turn"]
        edges = (Number(band[k], 8) for k in ("rpm_lo", "rpm_hi", "eta_hi", "eta_lo"))
        doubling = math.log(2.0) / math.log1p(growth / 100.0)
        rows.append((f"tongue {band['n']}", *edges, Number(growth, 3), Number(doubling, 3)))
    head = ("Forbidden speeds", "from rpm", "to rpm", "from η", "to η", "growth a turn %", "turns to double")
    return table(head, rows, slug="bands")


def verdicts(head: str, rows: Sequence[Mapping[str, Any]]) -> ReportTable:
    """What each model says of a point."""
    from core.stability import LABELS  # no design without a flexible shaft loads it

    lost = any(row["leaves_cam_at_turns"] is not None for row in rows)
    named = any("leaves_cam" in row for row in rows)
    figures = {key: title for key, title in FIGURES.items() if any(math.isfinite(row[key]) for row in rows)}
    cells: list[Sequence[Cell]] = []
    for row in rows:
        off = row["leaves_cam_at_turns"]
        last: list[Cell] = ["" if off is None else Number(off, 5)] if lost else []
        last += [row.get("leaves_cam", "")] if named else []
        cells.append(
            (
                LABELS[row["model"]],
                row["state"],
                *(Number(row[key]) if math.isfinite(row[key]) else "" for key in figures),
                *last,
            )
        )
    names = (head, "", *figures.values(), *(["off the cam at turn"] if lost else []), *(["drive"] if named else []))
    return table(names, cells, left=2, slug="verdicts")


def _needed(study: Study, values: Mapping[str, Any]) -> Sentences:
    needed, now = values["stiffness"], study.design.camshaft.elastic
    if needed is None:
        return Sentences(("The shaft swings so often in a turn that no tongue is looked for near this speed.",))
    if now is None or needed["allowed"]:
        return Sentences(("At this speed the shaft keeps clear of the forbidden bands.",))
    softer = needed["greatest_softer_nm_per_rad"]
    stiffer = f"a stiffness from {digits(needed['least_stiffer_nm_per_rad'])} N·m/rad on"
    up_to = f", or up to {digits(softer)} N·m/rad" if softer else ""
    return Sentences((f"To keep clear of the forbidden bands at this speed: {stiffer}{up_to}.",))


def _steady(turn: SteadyTurn, values: Mapping[str, Any]) -> list[Block]:
    """What the steady response does to followers and shaft, and its largest harmonics beside the linear ones."""
    named = [
        ("Wind-up of the shaft", "°", values["wind_up_deg"]),
        ("Torque in the shaft", "N·m", values["shaft_torque_nm"]),
    ]
    for each in values["follower_error"]:
        of = f", {printable(each['drive'])}" if each["drive"] else ""
        named.append((f"Follower's error{of}", UNITS[each["unit"]].symbol, each))
    rows: list[Sequence[Cell]] = []
    for name, unit, v in named:
        rows.append(
            (name, unit, *(Number(end[key]) for end in (v["min"], v["max"]) for key in ("value", "cam_angle_deg")))
        )
    mean, amplitude = values["mean_shaft_torque_nm"], values["shaft_torque_amplitude_nm"]
    mean = 0.0 if abs(mean) < ZERO * amplitude else mean
    fatigue = [("Torque in the shaft, mean", Number(mean), "N·m"), ("alternating, amplitude", Number(amplitude), "N·m")]
    head = ("Over a turn of the steady response", "unit", "lowest", "at °", "highest", "at °")
    return [table(head, rows, left=2, slug="steady"), table((), fatigue), _harmonics(turn)]


def _harmonics(turn: SteadyTurn) -> ReportTable:
    from core.stability import APPROXIMATE, EXACT

    sizes = [720.0 * np.abs(each) for each in (turn.harmonics(), turn.linear()[EXACT], turn.linear()[APPROXIMATE])]
    rows: list[Sequence[Cell]] = []
    for k in sorted((1 + np.argsort(-sizes[0][1:], kind="stable")[:LARGEST]).tolist()):
        found = (Number(float(each[k]), 4) if math.isfinite(each[k]) else "no answer" for each in sizes)
        rows.append((f"{k} × shaft speed", *found))
    return table(
        ("Largest harmonics of the wind-up, °", "steady", "linear, exact (21)", "linear, approximate (22)"), rows
    )


__all__ = ["shaft_stability", "verdicts"]
