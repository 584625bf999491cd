"""The sections of a report: drives of a shaft, claims of papers, conventions, the flexible shaft, and a single drive."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from core.cam import SECOND
from core.design import CRANK, FRAME_LINK, UNITS, Design, distances, drive_at, entries, entry_at, is_assumed, only
from core.design.fields import in_sentence
from core.findings import Residual
from core.laws import find_law
from core.number_text import COMPARED_DIGITS, MOST_DIGITS, digits_apart, input_text, result_text, signed_text
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
    from core.stability import Stability, SteadyTurn


# -- several drives on a shaft --------------------------------------------------------------------------------


def drives(camshaft: Camshaft[Study]) -> list[Section]:
    """Every drive with its phase and its lowest and highest torque."""
    rows: list[Sequence[Cell]] = []
    for (name, study), drive in zip(camshaft.drives.items(), camshaft.design.drives, strict=True):
        figures: list[Cell] = ["no solution", "", "", ""] if name in camshaft.failures else [""] * 4
        if study.loads_shaft and name not in camshaft.failures:
            torque = peaks(camshaft.drive_load(name))
            figures = [Number(v) for end in (torque.low, torque.high) for v in (end.value, math.degrees(end.theta))]
        rows.append((printable(name), input_text(drive.phase), "mirrored" if drive.mirrored else "", *figures))
    header = ("Drive", "phase °", "", "lowest N·m", "at °", "highest N·m", "at °")
    keys = (f"{camshaft.slugs[name]}_torque_nm" for name in camshaft.drives)
    return section("Drives, by machine angle", table(header, rows, slug="drives", keys=keys))


def timing(design: Design) -> list[Section]:
    """Conditions on the order of events, and the events."""
    rows: list[Sequence[Cell]] = []
    for row, at in zip(design.timing, distances(design), strict=True):
        after = (Number(at.after_deg, COMPARED_DIGITS), input_text(row.least_deg), "kept" if at.kept else "BROKEN")
        rows.append((printable(row.first), printable(row.second), *after))
    header = ("First", "second", "after °", "least °", "")
    return [*section("Timing", table(header, rows, left=2, slug="timing")), *_events(design)]


def _events(design: Design) -> list[Section]:
    """Starts and ends of rises and returns, in the order of the turn."""
    rows = [(printable(name), Number(angle), Number(time)) for name, angle, time in event_rows(design)]
    return section("Events, by machine angle", table(("Event", "at °", "ms"), rows, slug="events"))


def torque(camshaft: Camshaft[Study]) -> list[Section]:
    """Figures of the torque of all drives."""
    figures = torque_of(camshaft)
    labels = {"mean_nm": "Mean", "rms_nm": "Root mean square", "peak_nm": "Greatest", "peak_power_w": "Peak power"}
    rows = [
        (label, Number(figures[key]), "W" if key.endswith("_w") else "N·m") for key, label in labels.items() if figures
    ]
    return section("Torque of all drives at constant speed", table((), rows, slug="torque", keys=labels))


# -- claims of papers -----------------------------------------------------------------------------------------


def paper_claims(design: Design) -> list[Section]:
    """A table for every paper of which the design is an unchanged example: what the paper says, and what is computed."""
    from core.papers import PAPERS, Examples, claims  # only a report needs them

    examples, sections = Examples(), list[Section]()
    for slug, paper in PAPERS.items():
        names = [name for name in paper.examples if examples.design(name) == design]
        rows = [
            (claim.where, claim.says, claim.here, claim.verdict)
            for claim in (claims(slug, examples) if names else ())
            if claim.row.example in names
        ]
        title = Sentences((f"{paper.label}: {paper.title}.",))
        header = ("where", "what it says", "here", "verdict")
        sections += section("", title, table(header, rows, left=4, slug="paper")) if rows else []
    return sections


# -- conventions and sources ----------------------------------------------------------------------------------


CONVENTIONS: Mapping[str, bool] = MappingProxyType(
    {
        "Global frame: origin at the centre of the cam or at the frame of the linkage, x to the right, y upwards, angles "
        "counter-clockwise.": True,
        "The cam angle θ grows with time in both senses of rotation; angle 0 is the start of the first segment.": False,
        "Vectors of the plane are written as complex numbers; · and × are their scalar and vector product, a bar the conjugate of a "
        "vector, or the mean of a scalar.": True,
        "A curvature is positive where the cam is convex. The contact force is positive where it presses the follower on the cam. "
        "A drive torque is positive where it drives.": True,
        "Extremes are refined to the true extreme of the continuous curve, not read from a table; where a quantity jumps, both sides "
        "count.": False,
        "Numbers are rounded for reading; summary.json of the same design has all digits.": False,
    }
)
"""Convention -> whether it applies to a mechanism only; the others apply to a motion alone too."""

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
"""Short name of a source, as in tables -> the source."""


def conventions(study: Study) -> list[Section]:
    """Conventions for all numbers, and the sources of equations and limits of the design."""
    all_limits = (row for drive in study.solved_drives.values() for row in limit_rows(drive, drive.stages))
    named = " ".join([*(row.source for row in equations_of(study)), *(row.source for row in all_limits)])
    rows = [(name, text) for name, text in SOURCES.items() if name in named]
    corrected = (
        "corrected: the printed equation is wrong, and the equation given here is computed."
        if "corrected" in named
        else ""
    )
    remark = Sentences((corrected,), is_remark=True) if corrected else None
    has_mechanism = any("linkage" in drive.stages for drive in study.solved_drives.values())
    texts = tuple(text for text, needs_mechanism in CONVENTIONS.items() if has_mechanism or not needs_mechanism)
    return [Section("", (Sentences(texts),)), *section("Sources", table((), rows, left=2), remark)]


# -- flexible shaft -------------------------------------------------------------------------------------------


ZERO = 1e-9  # of the torque's amplitude: a mean below it is rounding
LARGEST = 5  # harmonics that are listed
FIGURES = {"growth_percent_per_turn": "growth per turn %", "largest_wind_up_deg": "wind-up °"}  # of a verdict


def shaft_stability(study: Study) -> list[Section]:
    """Stability of the flexible shaft; empty where the shaft is rigid or nothing excites it."""
    values = stability(study)
    if not values:
        return []
    rows: list[Sequence[Cell]] = [
        ("Frequency ratio η", Number(values["eta"]), ""),
        ("Inertia ratio Q", Number(values["q"]), ""),
        ("Natural frequency of the shaft", Number(values["natural_rpm"]), "rpm"),
        ("Harmonics", str(values["harmonics"]), ""),
        ("Error of an edge η", result_text(values["edge_error"], 1), ""),
    ]
    shaft = study.stability
    turn = shaft.steady_turn if shaft is not None and "steady" in values else None
    hidden = {"largest_wind_up_deg": math.nan} if turn is not None else {}  # listed with the steady response
    return section(
        "Stability of the flexible shaft",
        *([] if shaft is None else [Sentences((_speed_sentence(shaft),))]),
        table((), rows, slug="stability", keys=("eta", "q", "natural_rpm", "", "")),
        _forbidden(values),
        verdicts("At the speed of the machine", [{**row, **hidden} for row in values["verdicts"]]),
        _needed(study, values),
        *(_steady(turn, values["steady"]) if turn is not None else []),
    )


def _speed_sentence(shaft: Stability) -> str:
    from core.stability import speed_sentence  # no design without a flexible shaft loads it

    return speed_sentence(shaft)


def _forbidden(values: Mapping[str, Any]) -> ReportTable | Sentences:
    if not values["bands"]:
        return Sentences(("No forbidden band of speed",))
    rows: list[Sequence[Cell]] = []
    for band in values["bands"]:
        growth = band["growth_percent_per_turn"]
        edges = (Number(band[k], MOST_DIGITS) for k in ("rpm_lo", "rpm_hi", "eta_hi", "eta_lo"))
        doubling = math.log(2.0) / math.log1p(growth / 100.0)
        rows.append((f"tongue {band['n']}", *edges, Number(growth, 3), Number(doubling, 3)))
    header = ("Forbidden speeds", "from rpm", "to rpm", "from η", "to η", "growth per turn %", "turns to double")
    return table(header, rows, slug="bands")


def verdicts(header: str, rows: Sequence[Mapping[str, Any]]) -> ReportTable:
    """Verdicts of the models at a point of the chart."""
    from core.stability import LABELS  # no design without a flexible shaft loads it

    has_loss = any(row["leaves_cam_at_turns"] is not None for row in rows)
    has_drive = any("leaves_cam" in row for row in rows)
    figures = {key: title for key, title in FIGURES.items() if any(math.isfinite(row[key]) for row in rows)}
    cells: list[Sequence[Cell]] = []
    for row in rows:
        turns = row["leaves_cam_at_turns"]
        last: list[Cell] = ["" if turns is None else Number(turns)] if has_loss else []
        last += [row.get("leaves_cam", "")] if has_drive else []
        cells.append(
            (
                LABELS[row["model"]],
                row["state"],
                *(Number(row[key]) if math.isfinite(row[key]) else "" for key in figures),
                *last,
            )
        )
    loss = ["off the cam at turn"] if has_loss else []
    titles = (header, "", *figures.values(), *loss, *(["drive"] if has_drive else []))
    return table(titles, cells, left=2, slug="verdicts")


def _needed(study: Study, values: Mapping[str, Any]) -> Sentences:
    needed, elastic = values["stiffness"], study.design.camshaft.elastic
    if needed is None:
        return Sentences(("The shaft vibrates so often in a turn that tongues are not computed near this speed.",))
    if elastic is None or needed["allowed"]:
        return Sentences(("The current stiffness keeps clear of the forbidden bands.",))
    softer = needed["greatest_softer_nm_per_rad"]
    stiffer = f"a stiffness from {digits(needed['least_stiffer_nm_per_rad'])} N·m/rad on"
    up_to = f", or up to {digits(softer)} N·m/rad" if softer else ""
    return Sentences((f"To keep clear of the forbidden bands at this speed: {stiffer}{up_to}.",))


def _steady(turn: SteadyTurn, values: Mapping[str, Any]) -> list[Block]:
    """Wind-up, torque and errors of the followers in the steady response, and its largest harmonics next to the linear ones."""
    extremes = [
        ("Wind-up of the shaft", "°", values["wind_up_deg"]),
        ("Torque in the shaft", "N·m", values["shaft_torque_nm"]),
    ]
    for error in values["follower_error"]:
        drive = f", {printable(error['drive'])}" if error["drive"] else ""
        extremes.append((f"Follower's error{drive}", UNITS[error["unit"]].symbol, error))
    rows: list[Sequence[Cell]] = []
    rows.extend(
        (name, unit, *(Number(end[key]) for end in (v["min"], v["max"]) for key in ("value", "cam_angle_deg")))
        for name, unit, v in extremes
    )
    mean, amplitude = values["mean_shaft_torque_nm"], values["shaft_torque_amplitude_nm"]
    mean = 0.0 if abs(mean) < ZERO * amplitude else mean
    fatigue = [("Torque in the shaft, mean", Number(mean), "N·m"), ("alternating, amplitude", Number(amplitude), "N·m")]
    header = ("Over a turn of the steady response", "unit", "lowest", "at °", "highest", "at °")
    return [table(header, rows, left=2, slug="steady"), table((), fatigue), _harmonics(turn)]


def _harmonics(turn: SteadyTurn) -> ReportTable:
    from core.stability import APPROXIMATE, EXACT

    sizes = [
        720.0 * np.abs(harmonics) for harmonics in (turn.harmonics(), turn.linear()[EXACT], turn.linear()[APPROXIMATE])
    ]
    rows: list[Sequence[Cell]] = []
    for k in sorted((1 + np.argsort(-sizes[0][1:], kind="stable")[:LARGEST]).tolist()):
        cells = (Number(float(size[k])) if math.isfinite(size[k]) else "no solution" for size in sizes)
        rows.append((f"{k} × shaft speed", *cells))
    return table(
        ("Largest harmonics of the wind-up, °", "steady", "linear, exact (21)", "linear, approximate (22)"), rows
    )


# -- inputs ---------------------------------------------------------------------------------------------------


ASSUMED, AS_ABOVE = "*", "as above"
SLOPE = "shaft.motor_slope_nm_s_per_rad"
OF_ROW = re.compile(r"(segment|link)s\[(\d+)\]")
SEPARATE_TABLES = ("motion", "linkage")  # they have sections of their own


def table_sections(design: Design, names: Iterable[str], why: bool = False) -> list[Section]:
    """A section with the values of every table of the file, assumed ones marked; with ``why`` the reasons are listed too."""
    sections: list[Section] = []
    for name in names:
        sections += section(name.capitalize(), *_input_blocks(design, name, why))
    return sections


def _input_blocks(design: Design, name: str, why: bool = False) -> Iterator[ReportTable]:
    """Tables with the values of a table of the file, of its rows one each."""
    tables: dict[str, tuple[list[Sequence[Cell]], list[str]]] = {"": ([], [])}
    given: set[str] = set()
    for entry in entries(design, name):
        if entry.value is None:
            continue
        value = input_text(entry.value) if isinstance(entry.value, float) else str(entry.value)
        assumed = next((path for path in design.assumed if entry.path in rows_of(path)), "")
        text = reason(design, assumed or entry.path) if why else ""
        reasons = (AS_ABOVE if text in given else text,) if why else ()
        given |= {text} - {""}
        row = ROW.match(entry.path)
        rows, keys = tables.setdefault(row[0] if row else "", ([], []))
        rows.append((entry.info.label, value, entry.unit.symbol, ASSUMED if assumed else "", *reasons))
        keys.append(entry.path)
    for path, (rows, keys) in tables.items():
        yield table((), rows, slug="inputs", keys=keys, title=row_title(design, path))


def rows_of(path: str) -> tuple[str, ...]:
    """Paths of the rows of a table with the value at a path: two coordinates of a point."""
    return (path, f"{path}_x_mm", f"{path}_y_mm")


def assumed_note(study: Study, is_listed: Callable[[str], bool] = lambda path: False) -> Sentences | None:
    """The meaning of the mark of an input, and the reasons of values that no table lists."""
    design = study.design
    reasons: dict[str, dict[str, None]] = {}
    for path, text in ((path, text) for path, text in reasons_of(design) if not is_listed(path)):
        reasons.setdefault(text, {})[_label(design, path)] = None
    why = [f"{(words := ', '.join(names))[:1].upper()}{words[1:]}: {text}" for text, names in reasons.items()]
    mark = [f"{ASSUMED} assumed, not taken from a source"] if design.assumed else []
    return Sentences((*mark, *why), is_remark=True) if mark or why else None


def _label(design: Design, path: str) -> str:
    """The label of a value, or its path where it is one of several rows."""
    numbered = drive_at(path)
    inside, drive = (path, "") if numbered is None else (numbered[1], f"{design.drives[numbered[0]].name}, ")
    entry = entry_at(only(design, numbered[0] if numbered else 0), inside)
    label = inside.rpartition("].")[2] if entry is None else entry.info.label
    row = OF_ROW.search(inside)
    if row:
        label = f"{label.replace('.', ' ')} of {row[1]} {int(row[2]) + 1}"
    return drive + in_sentence(label)


def linkage_inputs(study: Study) -> list[Section]:
    """Links with their points, sliding pairs, driver and branches, and the dyads that they form."""
    if not study.design.drive.links:
        return []
    linkage, assumed = study.design.drive.linkage, study.design.assumed
    rows: list[Sequence[Cell]] = []
    for i, link in enumerate(linkage.links):
        for point in link.points:
            at = f"linkage.links[{i}].points"
            is_marked = any(path in assumed for path in (at, f"{at}.{point.name}", f"{at}.{point.name}.x_mm"))
            position = input_text(point.x_mm), input_text(point.y_mm)
            rows.append((str(link.number), point.name, *position, ASSUMED if is_marked else ""))
    sliders: list[Sequence[Cell]] = []
    sliders.extend(
        (str(s.link), str(s.on), *map(input_text, (s.through_x_mm, s.through_y_mm, s.angle_deg)))
        for s in linkage.sliders
    )
    driver, facts = linkage.driver, mechanism(study)
    action = "turns" if driver.kind == CRANK else "follows the motion"
    against = "" if driver.on == FRAME_LINK else f" against link {driver.on}"
    lines = [f"Link {driver.link} {action}{against}, {input_text(driver.speed_rpm)} rpm"]
    lines += (
        [f"Branch {', '.join(f'{s.joint} {signed_text(s.side)}' for s in linkage.branch)}"] if linkage.branch else []
    )
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
"""Symbol of a derivative of the displacement by cam angle -> divisor of its unit."""


def motion(study: Study) -> list[Section]:
    """Segments of the motion, and the jumps at their joins."""
    if "motion" not in study.stages:
        return []
    motion = study.program.motion
    unit = UNITS[motion.unit].symbol
    rows: list[Sequence[Cell]] = []
    at = 0.0
    for segment in motion.segments:
        end = at + segment.span_deg
        rows.append(
            (
                _law_label(segment.curve.law),
                input_text(round(at, 9)),
                input_text(round(end, 9)),
                input_text(segment.rise),
            )
        )
        at = end
    jumps: list[Sequence[Cell]] = [
        (Number(j["cam_angle_deg"]), *(Number(j[k]) for k in PER_RADIAN)) for j in joins(study)
    ]
    return section(
        "Motion",
        *(() if motion.lobe is None else _input_blocks(study.design, "motion")),
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
    """Speed, work and stops over a turn of a motion without a cam."""
    if not has_cycle(study):
        return []
    turn, unit = motion_cycle(study), study.design.drive.motion_unit
    symbol, kind = UNITS[unit].symbol, "N" if unit == "mm" else "N·m"
    rows: list[Sequence[Cell]] = [("Mean speed", Number(turn.mean_speed), f"{symbol}/s")]
    if turn.work is not None:
        net = turn.work.given - turn.work.braked
        rows += [
            (
                "Root mean square of the force" if unit == "mm" else "Root mean square of the torque",
                Number(turn.work.rms),
                kind,
            ),
            ("Energy without recovery", Number(turn.work.given), "J"),
            ("Energy with recovery", Number(net, size=turn.work.given), "J"),
        ]
    stops = [(Number(stop.at_deg), Number(stop.position), Number(stop.error)) for stop in turn.stops]
    header = ("Stop from °", f"position {symbol}", f"index error {symbol}")
    return section(
        "Cycle", table((), rows, slug="cycle"), table(header, stops, left=0, slug="stops") if stops else None
    )


BASE_LABELS = {
    "slider": "Slider, L0", "phi": "Slider arm, φ0", "alpha": "Roller arm, α0", "beta": "Rod, β0", "follower": "Follower", "mu": "Face, μ",
    "rocker": "Rocker",
}  # fmt: skip
"""Name of a length or angle at the base position -> its label, with the symbol of Shin1995."""


def base(study: Study) -> list[Section]:
    """Lengths and angles at the base position."""
    if not study.linkage.base:
        return []
    base = study.linkage.base
    rows = [
        (BASE_LABELS.get(name, name), Number(v / UNITS[u].factor, MOST_DIGITS), UNITS[u].symbol)
        for name, (v, u) in base.items()
    ]
    level = [
        BASE_LABELS.get(name, name) for name, (v, u) in base.items() if u == "deg" and 0.0 < _off_level(v) < NEARLY
    ]
    note = f"{', '.join(level)}: nearly, but not exactly, a multiple of 90°, by the lengths in the file"
    return section(
        "Base position",
        table((), rows, slug="base", keys=(f"{name}_{u}" for name, (_, u) in base.items())),
        Sentences((note,), is_remark=True) if level else None,
    )


NEARLY = 1e-3
"""Deviation [deg] from a multiple of 90° below which a reader may take an angle for that multiple."""


def _off_level(angle: float) -> float:
    """Deviation of an angle [rad] from the nearest multiple of 90° [deg]."""
    degrees = math.degrees(angle)
    return abs(degrees - 90.0 * round(degrees / 90.0))


def listed_elsewhere(study: Study) -> frozenset[str]:
    """Quantities whose extremes another section lists: limits of the cam, flywheel or flexible shaft.

    Speed and motor torque are omitted without a flywheel too, where they are those of shaft and cam.
    """
    names = set(pressure_angles(study)) if study.has_disk else set()
    if "dynamics" in study.stages and (pressures := quantity_requests.peak_pressures(study)):
        names.add(
            "second_contact_pressure"
            if max(pressures, key=lambda name: pressures[name].value) == SECOND
            else "contact_pressure"
        )
    if flywheel_of(study):
        names |= {"camshaft_speed"} if study.levels_torque else {"camshaft_speed", "motor_torque"}
    if shaft_in_chart(study) is not None:
        names |= {"wind_up", "shaft_torque", "follower_error"}
    return frozenset(names)


def extreme_rows(study: Study, rows: Iterable[Quantity], stages: Sequence[str], slug: str = "extremes") -> ReportTable:
    """Lowest and highest values of quantities with their angles, without those that another section lists."""
    values, omitted = extremes(study, stages), listed_elsewhere(study)
    listed = [row for row in rows if row.slug in values and row.name not in omitted]
    cells: list[Sequence[Cell]] = []
    sizes: dict[str, float] = {}  # a value that is rounding against the greatest value of its unit is 0
    for row in channels(study.design):
        if row.slug not in values:
            continue
        ends = (abs(end["value"]) for end in values[row.slug].values() if math.isfinite(end["value"]))
        sizes[row.unit.symbol] = max((sizes.get(row.unit.symbol, 0.0), *ends))
    for row in listed:
        low, high = values[row.slug]["min"], values[row.slug]["max"]
        size = sizes[row.unit.symbol]
        figures = [
            cell for end in (low, high) for cell in (Number(end["value"], size=size), Number(end["cam_angle_deg"]))
        ]
        cells.append((row.label, row.unit.symbol, *figures))
    header = ("", "unit", "lowest", "at °", "highest", "at °")
    return table(header, cells, left=2, slug=slug, keys=(row.slug for row in listed))


def extreme_values(study: Study, rows: Iterable[Quantity], stages: Sequence[str]) -> list[Section]:
    """Extremes of quantities over one turn."""
    return section("Extremes over one turn", extreme_rows(study, rows, stages))


def limits(study: Study, stages: Sequence[str]) -> list[Section]:
    """Figures of a cam with their limits."""
    figures = tuple(limit_rows(study, stages))
    rows: list[Sequence[Cell]] = []
    for row in figures:
        most = digits_apart([value for value in (row.value, row.limit) if value is not None], COMPARED_DIGITS)
        limit = "" if row.limit is None else Number(row.limit, most)
        at = Number(row.cam_angle_deg)
        rows.append((row.label, UNITS[row.unit].symbol, Number(row.value, most), at, limit, row.source))
    header = ("", "unit", "worst", "at °", "limit", "whose")
    return section("Limits of the cam", table(header, rows, left=2, slug="limits", keys=(row.name for row in figures)))


def life(study: Study) -> list[Section]:
    """Rolling life of every roller with a load rating."""
    rows: list[Sequence[Cell]] = []
    for life in roller_lives(study):
        figures = (life.load, life.rpm, life.million_turns, life.hours)
        rows.append((life.roller, *(Number(value) if math.isfinite(value) else "unlimited" for value in figures)))
    return section(
        "Rolling life L10, ISO 281", table(("Roller", "equivalent load N", "mean rpm", "million turns", "hours"), rows)
    )


def contact(study: Study) -> list[Section]:
    """Speed from which the follower leaves the cam."""
    lines = lift_off_lines(study) if study.has_disk else []
    return section("Keeping contact", Sentences(tuple(lines)) if lines else None)


def vibration(study: Study) -> list[Section]:
    """Vibration of an elastic follower in its dwells."""
    lines = elastic_lines(study) if study.is_elastic else []
    return section("Elastic follower", Sentences(tuple(lines)) if lines else None)


def flywheel(study: Study, wheel: Mapping[str, float | None], with_mean: bool = True) -> list[Section]:
    """Flywheel that the speed needs, and the speed with the flywheel fitted; with_mean: with the mean torque."""
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
            f"Flywheel for {result_text(100.0 * shaft.speed_fluctuation)} % fluctuation of speed{guess}",
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
    """Findings."""
    lines = [finding_line(f, study.angle_name) for f in findings_of(study)]
    return section("Findings", Sentences(tuple(lines or ["none"])))


def certificate_rows(proof: Mapping[str, Residual]) -> ReportTable:
    """Residuals with their bounds."""
    rows: list[Sequence[str]] = []
    for name, residual in proof.items():
        verdict = "kept" if residual.kept else "NOT KEPT"
        rows.append(
            (name.replace("_", " "), digits(residual.value, 3), digits(residual.bound, 3), verdict, residual.note)
        )
    return table(("", "residual", "bound", "", ""), rows, slug="certificate", keys=proof)


def certificate(study: Study) -> list[Section]:
    """Residuals of the certificate."""
    return [Section("Certificate", (certificate_rows(certificate_of(study)),))]
