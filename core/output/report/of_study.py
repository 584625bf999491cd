"""The sections of a study's report: what was asked, what came out, what exceeds its limit, what proves it."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence

from core.cam import SECOND
from core.design import CRANK, FRAME_LINK, UNITS, Design, drive_at, entries, entry_at, is_assumed, only
from core.findings import Residual
from core.laws import find_law
from core.output.channels import channels
from core.output.contact_files import lift_off_lines
from core.output.cycle import cycle_of, has_cycle
from core.output.lines import finding_line
from core.output.load_text import ROW, row_title
from core.output.report.parts import Cell, Number, ReportTable, Section, Sentences, section, table
from core.output.summary import extremes, joins, mechanism, shaft_in_chart
from core.output.summary import flywheel as flywheel_of
from core.output.vibration_files import elastic_lines
from core.project.reasons import reason, reasons_of
from core.shaft import levels
from core.study import Quantity, Study, certificate_of, contact_stress, findings_of, roller_lives
from core.study.cam_checks import limit_rows, pressure_angles

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
    found, unit = cycle_of(study), study.design.drive.motion_unit
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
    if "dynamics" in study.stages and (pressed := contact_stress.worst(study)):
        found.add(
            "second_contact_pressure"
            if max(pressed, key=lambda name: pressed[name].value) == SECOND
            else "contact_pressure"
        )
    if flywheel_of(study):
        found |= {"camshaft_speed"} if study.levelled else {"camshaft_speed", "motor_torque"}
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
        ("Estimate of it, ΔE/(C_s ω̄²)", Number(wheel["estimated_inertia_kg_m2"]), "kg·m²", "estimated_inertia_kg_m2"),
    ]
    if fluctuation is None:
        rows.append(("Speed", "the motor stalls", "", ""))
    elif levels(shaft):
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
