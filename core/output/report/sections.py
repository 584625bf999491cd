"""The sections of the report of several drives on a shaft: their timing, torque, flywheel and stability together."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from core.cam import SECOND
from core.design import CRANK, FRAME_LINK, UNITS, Design, distances, drive_at, entries, entry_at, is_assumed, only
from core.findings import Residual
from core.laws import find_law
from core.output.channels import channels, has_cycle, motion_cycle
from core.output.lines import digits, finding_line, printable
from core.output.load_text import ROW, row_title
from core.output.report.equations import equations_of
from core.output.report.parts import Block, Cell, Number, ReportTable, Section, Sentences, section, table
from core.output.subject_files import elastic_lines, lift_off_lines
from core.output.summary import extremes, joins, mechanism, stability
from core.output.summary import flywheel as flywheel_of
from core.output.summary import torque as torque_of
from core.output.timing import event_rows
from core.project.reading_faults import reason, reasons_of
from core.shaft import has_flywheel, peaks
from core.study import Camshaft, Quantity, Study, certificate_of, findings_of, quantity_requests, roller_lives
from core.study.cam_checks import limit_rows, pressure_angles
from core.study.study import shaft_in_chart

if TYPE_CHECKING:
    from core.stability import SteadyTurn


# -- the sections of the report of several drives on a shaft ----------------------------------------------------


def drives(camshaft: Camshaft[Study]) -> list[Section]:
    """Each drive with its phase and what it asks of the shaft."""
    rows: list[Sequence[Cell]] = []
    for (name, each), drive in zip(camshaft.drives.items(), camshaft.design.drives, strict=True):
        figures: list[Cell] = ["no answer", "", "", ""] if name in camshaft.failures else [""] * 4
        if each.loads_shaft and name not in camshaft.failures:
            found = peaks(camshaft.drive_load(name))
            figures = [Number(v) for e in (found.low, found.high) for v in (e.value, math.degrees(e.theta))]
        rows.append((printable(name), f"{drive.phase_deg:.10g}", "mirrored" if drive.mirrored else "", *figures))
    head = ("Drive", "phase °", "", "lowest N·m", "at °", "highest N·m", "at °")
    keys = (f"{camshaft.slugs[name]}_torque_nm" for name in camshaft.drives)
    return section("Drives, by machine angle", table(head, rows, slug="drives", keys=keys))


def timing(design: Design) -> list[Section]:
    """What must come after what, and where the events are."""
    rows: list[Sequence[Cell]] = []
    for row, at in zip(design.timing, distances(design), strict=True):
        after = (Number(at.after_deg), Number(row.least_deg), "kept" if at.kept else "BROKEN")
        rows.append((printable(row.first), printable(row.second), *after))
    head = ("First", "second", "after °", "least °", "")
    return [*section("Timing", table(head, rows, left=2, slug="timing")), *_events(design)]


def _events(design: Design) -> list[Section]:
    """Where rises and returns start and end, in the order of the turn."""
    rows = [(printable(name), Number(angle), Number(time)) for name, angle, time in event_rows(design)]
    return section("Events, by machine angle", table(("Event", "at °", "ms"), rows, slug="events"))


def torque(camshaft: Camshaft[Study]) -> list[Section]:
    """Figures of the sum of all drives."""
    figures = torque_of(camshaft)
    labels = {"mean_nm": "Mean", "rms_nm": "Root mean square", "peak_nm": "Greatest", "peak_power_w": "Peak power"}
    rows = [
        (label, Number(figures[key]), "W" if key.endswith("_w") else "N·m") for key, label in labels.items() if figures
    ]
    return section("Torque of all drives at constant speed", table((), rows, slug="torque", keys=labels))


# -- the section of a report that holds the example of a paper against what the paper says of it, ---------------


def of_papers(design: Design) -> list[Section]:
    """A table for each paper of which the design is an example, unchanged; in the order of the paper."""
    from core.papers import PAPERS, Examples, claims  # only a report asks for them

    examples, sections = Examples(), list[Section]()
    for slug, paper in PAPERS.items():
        own = {row.example for row in paper.rows if examples.design(row.example) == design}
        rows = [
            (each.where, each.says, each.here, each.verdict)
            for each in claims(slug, examples)
            if each.row.example in own
        ]
        of = Sentences((f"{paper.label}: {paper.title}.",))
        sections += (
            section("", of, table(("where", "what it says", "here", "verdict"), rows, left=4, slug="paper"))
            if rows
            else []
        )
    return sections


# -- the conventions of a report, and the sources of what stands in it ------------------------------------------


CONVENTIONS: Mapping[str, bool] = MappingProxyType(
    {
        "Global frame: origin at the centre of the cam or at the frame of the linkage, x to the right, y upwards, angles "
        "counter-clockwise.": True,
        "The cam angle θ grows with time, whichever way the shaft turns; angle 0 is the start of the first segment.": False,
        "Vectors of the plane are written as complex numbers; · and × are their scalar and vector product, a bar the conjugate of a "
        "vector, or the mean of a scalar.": True,
        "A curvature is positive where the cam is convex. The contact force is positive where it presses the follower on the cam. "
        "A drive torque is positive where it drives.": True,
        "Extremes are refined to the true extreme of the continuous curve, not read from a table; where a quantity jumps, both sides "
        "count.": False,
        "Numbers are rounded for reading; summary.json of the same design holds all their digits.": False,
    }
)
"""Convention -> whether it is of a mechanism; the others hold of a motion alone too."""

SOURCES: Mapping[str, str] = MappingProxyType(
    {
        "Shin1995": "J.-H. Shin, J.-S. Kim, K.-H. Ha: A Study on the Kinetodynamic Analysis for General Disk Cam Driving Slider "
        "Mechanisms. 1995.",
        "Kim1990": "H.-B. Kim, H.-S. Jeon, C.-W. Lee, Y.-S. Park: Dynamic Stability Analysis of a Single Cam Drive Mechanism. 1990.",
        "Yang": "M.-Y. Yang, T.-Y. Shon: Study on Blended Cam Design.",
        "Velocity": "Velocity Analysis, chapter 6 of a lecture on the kinematics of machines.",
        "Norton": "R. L. Norton: Cam Design and Manufacturing Handbook.",
        "Neklutin": "C. N. Neklutin: Mechanisms and Cams for Automatic Machines. 1969.",
        "Freudenstein": "F. Freudenstein: On the Dynamics of High-Speed Cam Profiles. 1960.",
        "Gutman": "A. S. Gutman: To Avoid Vibration, Try This New Cam Profile. 1961.",
        "VDI 2142": "VDI 2142: Design of plane cam mechanisms.",
        "ISO 281": "ISO 281: Rolling bearings, dynamic load ratings and rating life.",
    }
)
"""How a source is called in tables -> what it is."""


def conventions(study: Study) -> list[Section]:
    """What holds of every number, and the sources that equations and limits of this design name."""
    rows_of_all = (row for each in study.solved_drives.values() for row in limit_rows(each, each.stages))
    named = " ".join([*(row.source for row in equations_of(study)), *(row.source for row in rows_of_all)])
    rows = [(name, text) for name, text in SOURCES.items() if name in named]
    corrected = (
        "corrected: the printed equation is wrong there, and the one given here is computed."
        if "corrected" in named
        else ""
    )
    remark = Sentences((corrected,), mark=True) if corrected else None
    moves = any("linkage" in each.stages for each in study.solved_drives.values())
    texts = tuple(text for text, of_mechanism in CONVENTIONS.items() if moves or not of_mechanism)
    return [Section("", (Sentences(texts),)), *section("Sources", table((), rows, left=2), remark)]


# -- the sections of a report on a flexible shaft ---------------------------------------------------------------


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


# -- the sections of a study's report ---------------------------------------------------------------------------


ASSUMED, AS_ABOVE = "*", "as above"
SLOPE = "shaft.motor_slope_nm_s_per_rad"
DIGITS = 6  # of a number
OF_ROW = re.compile(r"(segment|link)s\[(\d+)\]")
APART = ("motion", "linkage")  # which have tables of their own


def table_sections(design: Design, names: Iterable[str], why: bool = False) -> list[Section]:
    """A section for each of these tables of the file with its values; what is assumed is marked. why: the reason stands beside it."""
    sections: list[Section] = []
    for name in names:
        tables: dict[str, tuple[list[Sequence[Cell]], list[str]]] = {"": ([], [])}
        given: set[str] = set()
        for entry in entries(design, name):
            if entry.value is None:
                continue
            value = f"{entry.value:.10g}" if isinstance(entry.value, float) else str(entry.value)
            assumed = next((path for path in design.assumed if entry.path in rows_of(path)), "")
            text = reason(design, assumed or entry.path) if why else ""
            reasons = (AS_ABOVE if text in given else text,) if why else ()
            given |= {text} - {""}
            row = ROW.match(entry.path)
            rows, keys = tables.setdefault(row[0] if row else "", ([], []))
            rows.append((entry.info.label, value, entry.unit.symbol, ASSUMED if assumed else "", *reasons))
            keys.append(entry.path)
        made = (
            table((), rows, slug="inputs", keys=keys, title=row_title(design, path))
            for path, (rows, keys) in tables.items()
        )
        sections += section(name.capitalize(), *made)
    return sections


def rows_of(path: str) -> tuple[str, ...]:
    """The rows of a table in which the value at a path stands: of a place its two coordinates."""
    return (path, f"{path}_x_mm", f"{path}_y_mm")


def assumed_note(study: Study, elsewhere: Callable[[str], bool] = lambda path: False) -> Sentences | None:
    """What the mark beside an input means, and why each value is what it is where that is known, and does not stand elsewhere."""
    design = study.design
    named: dict[str, dict[str, None]] = {}
    for path, text in ((path, text) for path, text in reasons_of(design) if not elsewhere(path)):
        named.setdefault(text, {})[_named(design, path)] = None
    why = [f"{(words := ', '.join(names))[:1].upper()}{words[1:]}: {text}" for text, names in named.items()]
    mark = [f"{ASSUMED} assumed, not taken from a source"] if design.assumed else []
    return Sentences((*mark, *why), mark=True) if mark or why else None


def _named(design: Design, path: str) -> str:
    """The label of a value, or its path where it is one of several rows."""
    own = drive_at(path)
    inside, drive = (path, "") if own is None else (own[1], f"{design.drives[own[0]].name}, ")
    entry = entry_at(only(design, own[0] if own else 0), inside)
    found = inside.rpartition("].")[2] if entry is None else entry.info.label
    row = OF_ROW.search(inside)
    if row:
        found = f"{found.replace('.', ' ')} of {row[1]} {int(row[2]) + 1}"
    return drive + (found if found[:2].isupper() else found[:1].lower() + found[1:])


def linkage_inputs(study: Study) -> list[Section]:
    """Links with their points, sliding pairs, driver and branches, and what follows from how they hang together."""
    if not study.design.drive.links:
        return []
    linkage, assumed = study.design.drive.linkage, study.design.assumed
    rows: list[Sequence[Cell]] = []
    for i, link in enumerate(linkage.links):
        for place in link.points:
            at = f"linkage.links[{i}].points"
            marked = any(path in assumed for path in (at, f"{at}.{place.name}", f"{at}.{place.name}.x_mm"))
            place_mm = f"{place.x_mm:.10g}", f"{place.y_mm:.10g}"
            rows.append((str(link.number), place.name, *place_mm, ASSUMED if marked else ""))
    sliders: list[Sequence[Cell]] = []
    for s in linkage.sliders:
        sliders.append((str(s.link), str(s.on), *(f"{v:.10g}" for v in (s.through_x_mm, s.through_y_mm, s.angle_deg))))
    driver, facts = linkage.driver, mechanism(study)
    moved_by = "turns" if driver.kind == CRANK else "follows the motion"
    against = "" if driver.on == FRAME_LINK else f" against link {driver.on}"
    lines = [f"Link {driver.link} {moved_by}{against}, {driver.speed_rpm:.10g} rpm"]
    lines += [f"Branch {', '.join(f'{s.joint} {s.side:+d}' for s in linkage.branch)}"] if linkage.branch else []
    lines += [f"Solved as {', '.join(d['kind'] + ' ' + '-'.join(map(str, d['links'])) for d in facts['dyads'])}"]
    if facts["four_bar"]:
        lines += [f"Four-bar: {facts['four_bar']['kind']} (Grashof)"]
    return section(
        "Linkage",
        table(("Link", "point", "x mm", "y mm", ""), rows, left=2),
        table(("Slider", "on link", "through x mm", "y mm", "angle °"), sliders),
        Sentences(tuple(lines)),
    )


def _law_label(slug: str) -> str:
    law = find_law(slug)
    return law.label if law is not None else slug


PER_RADIAN = {"s": "", "v": "/rad", "a": "/rad²", "j": "/rad³"}
"""Displacement and its derivatives by cam angle -> what their unit is divided by."""


def motion(study: Study) -> list[Section]:
    """Its segments, and what jumps between them."""
    if "motion" not in study.stages:
        return []
    typed = study.program.motion
    unit = UNITS[typed.unit].symbol
    rows: list[Sequence[Cell]] = []
    at = 0.0
    for segment in typed.segments:
        end = at + segment.span_deg
        rows.append((_law_label(segment.curve.law), f"{at:.10g}", f"{end:.10g}", f"{segment.rise:.10g}"))
        at = end
    jumps: list[Sequence[Cell]] = [
        (Number(j["cam_angle_deg"]), *(Number(j[k]) for k in PER_RADIAN)) for j in joins(study)
    ]
    return section(
        "Motion",
        table(("Segment", "from °", "to °", f"rise {unit}"), rows),
        table(
            ("Join at °", *(f"{letter} {unit}{per}" for letter, per in PER_RADIAN.items())),
            jumps,
            left=0,
            title="Jumps at the joins, by cam angle",
            slug="joins",
        ),
    )


def cycle(study: Study) -> list[Section]:
    """What a motion that no cam makes does in a turn, and how far its stops are off."""
    if not has_cycle(study):
        return []
    found, unit = motion_cycle(study), study.design.drive.motion_unit
    symbol, kind = UNITS[unit].symbol, "N" if unit == "mm" else "N·m"
    rows: list[Sequence[Cell]] = [("Mean speed", Number(found.mean_speed), f"{symbol}/s")]
    if found.work is not None:
        left = found.work.given - found.work.braked
        rows += [
            (
                "Root mean square of the force" if unit == "mm" else "Root mean square of the torque",
                Number(found.work.rms),
                kind,
            ),
            ("Energy without recovery", Number(found.work.given), "J"),
            ("Energy with recovery", Number(left, size=found.work.given), "J"),
        ]
    stops = [(Number(each.at_deg), Number(each.position), Number(each.error)) for each in found.stops]
    head = ("Stop from °", f"position {symbol}", f"index error {symbol}")
    return section("Cycle", table((), rows, slug="cycle"), table(head, stops, left=0, slug="stops") if stops else None)


AT_BASE = {
    "slider": "Slider, L0", "phi": "Slider arm, φ0", "alpha": "Roller arm, α0", "beta": "Rod, β0", "follower": "Follower", "mu": "Face, μ",
}  # fmt: skip
"""Names of what stands at the base position -> how a reader calls them, with the symbols of Shin1995."""


def base(study: Study) -> list[Section]:
    """The lengths and angles at the start."""
    if not study.linkage.base:
        return []
    found = study.linkage.base
    rows = [
        (AT_BASE.get(name, name), Number(v / UNITS[u].factor, 10), UNITS[u].symbol) for name, (v, u) in found.items()
    ]
    level = [AT_BASE.get(name, name) for name, (v, u) in found.items() if u == "deg" and 0.0 < _off_level(v) < NEARLY]
    note = f"{', '.join(level)}: nearly level, not exactly: the lengths as typed put it there, to all the digits shown"
    return section(
        "Base position",
        table((), rows, slug="base", keys=(f"{name}_{u}" for name, (_, u) in found.items())),
        Sentences((note,), mark=True) if level else None,
    )


NEARLY = 1e-3
"""[deg] from a multiple of 90°, within which a reader may take an angle for it."""


def _off_level(angle: float) -> float:
    """By how much an angle [rad] is off a multiple of 90° [deg]."""
    degrees = math.degrees(angle)
    return abs(degrees - 90.0 * round(degrees / 90.0))


def elsewhere(study: Study) -> frozenset[str]:
    """Quantities whose extremes stand in another section: among the limits of the cam, beside flywheel or flexible shaft; and speed and
    motor's torque that no flywheel changes, which are those of shaft and cam."""
    found = set(pressure_angles(study)) if "cam" in study.stages else set()
    if "dynamics" in study.stages and (pressed := quantity_requests.peak_pressures(study)):
        found.add(
            "second_contact_pressure"
            if max(pressed, key=lambda name: pressed[name].value) == SECOND
            else "contact_pressure"
        )
    if flywheel_of(study):
        found |= {"camshaft_speed"} if study.levels_torque else {"camshaft_speed", "motor_torque"}
    if shaft_in_chart(study) is not None:
        found |= {"wind_up", "shaft_torque", "follower_error"}
    return frozenset(found)


def extreme_rows(study: Study, rows: Iterable[Quantity], stages: Sequence[str], slug: str = "extremes") -> ReportTable:
    """Lowest and highest of the channels, each with its angle, but of those that stand elsewhere."""
    values, said = extremes(study, stages), elsewhere(study)
    there = [row for row in rows if row.slug in values and row.name not in said]
    cells: list[Sequence[Cell]] = []
    sizes: dict[str, float] = {}  # what is rounding beside the largest of its unit, of all that there are, is 0
    for row in channels(study.design):
        if row.slug not in values:
            continue
        ends = (abs(end["value"]) for end in values[row.slug].values() if math.isfinite(end["value"]))
        sizes[row.unit.symbol] = max((sizes.get(row.unit.symbol, 0.0), *ends))
    for row in there:
        low, high = values[row.slug]["min"], values[row.slug]["max"]
        size = sizes[row.unit.symbol]
        figures = [
            cell for end in (low, high) for cell in (Number(end["value"], size=size), Number(end["cam_angle_deg"]))
        ]
        cells.append((row.label, row.unit.symbol, *figures))
    head = ("", "unit", "lowest", "at °", "highest", "at °")
    return table(head, cells, left=2, slug=slug, keys=(row.slug for row in there))


def extreme_values(study: Study, rows: Iterable[Quantity], stages: Sequence[str]) -> list[Section]:
    """The section of extremes of these quantities over one turn."""
    return section("Extremes over one turn", extreme_rows(study, rows, stages))


def limits(study: Study, stages: Sequence[str]) -> list[Section]:
    """The figures of a cam beside their limits."""
    found = tuple(limit_rows(study, stages))
    rows: list[Sequence[Cell]] = []
    for row in found:
        limit = "" if row.limit is None else Number(row.limit)
        rows.append(
            (row.label, UNITS[row.unit].symbol, Number(row.value), Number(row.cam_angle_deg), limit, row.source)
        )
    head = ("", "unit", "worst", "at °", "limit", "whose")
    return section("Limits of the cam", table(head, rows, left=2, slug="limits", keys=(row.name for row in found)))


def life(study: Study) -> list[Section]:
    """Rolling life of every roller whose load rating is stated."""
    rows: list[Sequence[Cell]] = []
    for each in roller_lives(study):
        figures = (each.load, each.rpm, each.million_turns, each.hours)
        rows.append((each.roller, *(Number(value) if math.isfinite(value) else "no end" for value in figures)))
    return section(
        "Rolling life L10, ISO 281", table(("Roller", "equivalent load N", "mean rpm", "million turns", "hours"), rows)
    )


def contact(study: Study) -> list[Section]:
    """From which speed the follower leaves the cam."""
    lines = lift_off_lines(study) if "cam" in study.stages else []
    return section("Keeping contact", Sentences(tuple(lines)) if lines else None)


def vibration(study: Study) -> list[Section]:
    """How an elastic follower vibrates in its dwells."""
    lines = elastic_lines(study) if study.is_elastic else []
    return section("Elastic follower", Sentences(tuple(lines)) if lines else None)


def flywheel(study: Study, wheel: Mapping[str, float | None], with_mean: bool = True) -> list[Section]:
    """What the speed needs, and what the flywheel fitted makes of it; with_mean: with the mean torque."""
    if not wheel:
        return []
    shaft = study.design.camshaft
    fluctuation = wheel["fluctuation"]
    guess = f", motor slope {ASSUMED}" if is_assumed(study.design, SLOPE) else ""
    mean = (
        "Mean torque",
        Number(wheel["mean_torque_nm"], size=wheel["energy_swing_j"] or 0.0),
        "N·m",
        "mean_torque_nm",
    )
    rows: list[tuple[str, Cell, str, str]] = [
        *([mean] if with_mean else []),
        ("Energy swing ΔE", Number(wheel["energy_swing_j"]), "J", "energy_swing_j"),
        (
            f"Flywheel for {100 * shaft.speed_fluctuation:g} % fluctuation of speed{guess}",
            Number(wheel["needed_inertia_kg_m2"]),
            "kg·m²",
            "needed_inertia_kg_m2",
        ),
        ("Estimate of it by energy", Number(wheel["estimated_inertia_kg_m2"]), "kg·m²", "estimated_inertia_kg_m2"),
    ]
    if fluctuation is None:
        rows.append(("Speed", "the motor stalls", "", ""))
    elif has_flywheel(shaft):
        rows += [
            (f"Fluctuation of speed reached{guess}", Number(100.0 * fluctuation), "%", ""),
            ("Lowest speed", Number(wheel["min_speed_rpm"]), "rpm", "min_speed_rpm"),
            ("Highest speed", Number(wheel["max_speed_rpm"]), "rpm", "max_speed_rpm"),
        ]
    else:
        rows.append(("No flywheel is fitted: the speed is taken as constant", "", "", ""))
    return section("Flywheel", table((), (row[:3] for row in rows), slug="flywheel", keys=(row[3] for row in rows)))


def findings(study: Study) -> list[Section]:
    """What exceeds its limit, and what is worth knowing, with the digits of the tables."""
    lines = [finding_line(f, study.angle_name, DIGITS) for f in findings_of(study)]
    return section("Findings", Sentences(tuple(lines or ["none"])))


def certificate_rows(proof: Mapping[str, Residual]) -> ReportTable:
    """Every residual with its bound."""
    rows: list[Sequence[str]] = []
    for name, residual in proof.items():
        verdict = "kept" if residual.kept else "NOT KEPT"
        rows.append((name.replace("_", " "), f"{residual.value:.2e}", f"{residual.bound:.2e}", verdict, residual.note))
    return table(("", "residual", "bound", "", ""), rows, slug="certificate", keys=proof)


def certificate(study: Study) -> list[Section]:
    """The section with the residuals of the certificate."""
    return [Section("Certificate", (certificate_rows(certificate_of(study)),))]
