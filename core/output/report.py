"""The report of a study as plain text: what was asked, what came out, what exceeds its limit, what proves it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from core.design import CRANK, UNITS, Design, distances, entries
from core.laws import find_law
from core.output.channels import Channel, channels
from core.output.contact_files import lift_off_lines
from core.output.lines import columns, digits, finding_line, printable
from core.output.shaft_summary import answers, shaft_flywheel, shaft_torque
from core.output.summary import extremes, flywheel, joins, mechanism, stability, verdict_rows
from core.output.timing import event_rows
from core.output.vibration_files import elastic_lines
from core.shaft import peaks
from core.study import ShaftStudy, Study
from core.study.cam_checks import limit_rows

if TYPE_CHECKING:  # no design without a flexible shaft loads it
    from core.stability import Stability, SteadyTurn, Verdict

_ASSUMED = "*"


def _heading(text: str) -> list[str]:
    return ["", text, "-" * len(text)]


_APART = ("motion", "linkage")  # which have tables of their own


def _inputs(study: Study) -> list[str]:
    lines = []
    for name in study.design.tables:
        if name in _APART:
            continue
        rows = []
        for entry in entries(study.design, name):
            if entry.value is None:
                continue
            value = f"{entry.value:.10g}" if isinstance(entry.value, float) else str(entry.value)
            mark = _ASSUMED if entry.path in study.design.assumed else ""
            rows.append((entry.info.label, value, entry.unit.symbol, mark))
        if rows:
            lines += _heading(name.capitalize()) + columns(rows)
    if study.design.assumed:
        lines += ["", f"{_ASSUMED} assumed, not taken from a source"]
    return lines


def linkage_inputs(study: Study) -> list[str]:
    """Links with their points, sliding pairs, driver and branches, and what follows from how they hang together."""
    linkage, assumed = study.design.drive.linkage, study.design.assumed
    rows: list[Sequence[str]] = [("Link", "point", "x mm", "y mm", "")]
    for i, link in enumerate(linkage.links):
        for place in link.points:
            at = f"linkage.links[{i}].points"
            marked = any(path in assumed for path in (at, f"{at}.{place.name}", f"{at}.{place.name}.x_mm"))
            place_mm = f"{place.x_mm:.10g}", f"{place.y_mm:.10g}"
            rows.append((str(link.number), place.name, *place_mm, _ASSUMED if marked else ""))
    lines = _heading("Linkage") + columns(rows, left=2)
    if linkage.sliders:
        rows = [("Slider", "on link", "through x mm", "y mm", "angle °")]
        for s in linkage.sliders:
            rows.append((str(s.link), str(s.on), *(f"{v:.10g}" for v in (s.through_x_mm, s.through_y_mm, s.angle_deg))))
        lines += ["", *columns(rows)]
    driver, facts = linkage.driver, mechanism(study)
    moved_by = "turns" if driver.kind == CRANK else "follows the motion"
    lines += ["", f"Link {driver.link} {moved_by}, {driver.speed_rpm:.10g} rpm"]
    lines += [f"Branch {', '.join(f'{s.joint} {s.side:+d}' for s in linkage.branch)}"] if linkage.branch else []
    lines += [f"Solved as {', '.join(d['kind'] + ' ' + '-'.join(map(str, d['links'])) for d in facts['dyads'])}"]
    if facts["four_bar"]:
        lines += [f"Four-bar: {facts['four_bar']['kind']} (Grashof)"]
    return lines


def _law_label(slug: str) -> str:
    law = find_law(slug)
    return law.label if law is not None else slug


def _motion(study: Study) -> list[str]:
    if "motion" not in study.stages:
        return []
    motion = study.program.motion
    unit = UNITS[motion.unit].symbol
    rows: list[Sequence[str]] = [("Segment", "from °", "to °", f"rise {unit}")]
    at = 0.0
    for segment in motion.segments:
        end = at + segment.span_deg
        rows.append((_law_label(segment.curve.law), f"{at:.10g}", f"{end:.10g}", f"{segment.rise:.10g}"))
        at = end
    lines = _heading("Motion") + columns(rows)
    jumps: list[Sequence[str]] = [("Join at °", "s", "v", "a", "j")]
    jumps += [(digits(j["cam_angle_deg"]), *(digits(j[k]) for k in "svaj")) for j in joins(study)]
    return [*lines, "", f"Jumps at the joins, {unit} per radian of cam angle", *columns(jumps, left=0)]


def _base(study: Study) -> list[str]:
    if not study.linkage.base:
        return []
    rows = [(name, digits(v / UNITS[u].factor, 10), UNITS[u].symbol) for name, (v, u) in study.linkage.base.items()]
    return _heading("Base position") + columns(rows)


def _extremes(study: Study, rows: Iterable[Channel], stages: Sequence[str]) -> list[str]:
    values = extremes(study, stages)
    table: list[Sequence[str]] = [("", "unit", "lowest", "at °", "highest", "at °")]
    for row in rows:
        if row.slug in values:
            low, high = values[row.slug]["min"], values[row.slug]["max"]
            table.append(
                (row.label, row.unit.symbol, digits(low["value"]), digits(low["cam_angle_deg"]),
                 digits(high["value"]), digits(high["cam_angle_deg"]))
            )  # fmt: skip
    return _heading("Extremes over one turn") + columns(table, left=2)


def _limits(study: Study, stages: Sequence[str]) -> list[str]:
    """The figures of a cam beside their limits."""
    table: list[Sequence[str]] = [("", "unit", "worst", "at °", "limit", "whose")]
    for row in limit_rows(study, stages):
        limit = "" if row.limit is None else digits(row.limit)
        table.append((row.label, UNITS[row.unit].symbol, digits(row.value), digits(row.cam_angle_deg), limit, row.source))
    return _heading("Limits of the cam") + columns(table, left=2) if len(table) > 1 else []


def _life(study: Study) -> list[str]:
    """Rolling life of every roller whose load rating is stated."""
    rows: list[Sequence[str]] = [("Roller", "equivalent load N", "mean rpm", "million turns", "hours")]
    for each in study.roller_lives:
        figures = (each.load, each.rpm, each.million_turns, each.hours)
        rows.append((each.roller, *(digits(value) if math.isfinite(value) else "no end" for value in figures)))
    return _heading("Rolling life L10, ISO 281") + columns(rows) if len(rows) > 1 else []


def _contact(study: Study) -> list[str]:
    """From which speed the follower leaves the cam."""
    lines = lift_off_lines(study) if "cam" in study.stages else []
    return _heading("Keeping contact") + lines if lines else []


def _vibration(study: Study) -> list[str]:
    """How an elastic follower vibrates in its dwells."""
    lines = elastic_lines(study) if study.is_elastic else []
    return _heading("Elastic follower") + lines if lines else []


def _flywheel(study: Study | ShaftStudy, wheel: Mapping[str, float | None]) -> list[str]:
    if not wheel:
        return []
    shaft = study.design.camshaft
    rows = [
        ("Mean torque", digits(wheel["mean_torque_nm"]), "N·m"),
        ("Energy swing", digits(wheel["energy_swing_j"]), "J"),
        (
            f"Flywheel for {100 * shaft.speed_fluctuation:g} % speed fluctuation",
            digits(wheel["needed_inertia_kg_m2"]),
            "kg·m²",
        ),
        ("Flywheel fitted", digits(shaft.flywheel_inertia_kg_m2), "kg·m²"),
    ]
    if wheel["fluctuation"] is None:
        rows.append(("Speed", "the motor stalls", ""))
    else:
        rows += [
            ("Fluctuation of speed reached", digits(100.0 * wheel["fluctuation"]), "%"),
            ("Lowest speed", digits(wheel["min_speed_rpm"]), "rpm"),
            ("Highest speed", digits(wheel["max_speed_rpm"]), "rpm"),
        ]
    return _heading("Flywheel") + columns(rows)


def _stability(study: Study | ShaftStudy) -> list[str]:
    values = stability(study)
    if not values:
        return []
    rows = [
        ("Frequency ratio η", digits(values["eta"]), ""),
        ("Inertia ratio Q", digits(values["q"]), ""),
        ("Natural frequency of the shaft", digits(values["natural_rpm"]), "rpm"),
        ("Harmonics", str(values["harmonics"]), ""),
        ("Error of an edge η", f"{values['edge_error']:.0e}", ""),
    ]
    lines = _heading("Stability of the flexible shaft") + columns(rows) + _forbidden(values)
    verdicts = _verdicts("At the speed of the machine", values["verdicts"])
    orbit = _steady(study.stability.steady_turn, values["steady"]) if study.stability is not None and "steady" in values else []
    return [*lines, "", *verdicts, *_needed(study, values), *orbit]


def _verdicts(head: str, rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """What each model says of a point."""
    from core.stability import LABELS  # no design without a flexible shaft loads it

    lost = any(row["leaves_cam_at_turns"] is not None for row in rows)
    table: list[Sequence[str]] = [(head, "", "growth a turn %", "wind-up °", *(["off the cam at turn"] if lost else []))]
    for row in rows:
        word = {True: "stable", False: "unstable", None: "no answer"}[row["stable"]]
        numbers = (row["growth_percent_per_turn"], row["largest_wind_up_deg"])
        texts = [digits(v, 6) if math.isfinite(v) else "" for v in numbers]
        off = row["leaves_cam_at_turns"]
        table.append((LABELS[row["model"]], word, *texts, *(["" if off is None else digits(off, 5)] if lost else [])))
    return columns(table, left=2)


ZERO = 1e-9  # of the torque's amplitude: a mean below it is rounding
LARGEST = 5  # harmonics that are named


def _steady(turn: SteadyTurn | None, values: Mapping[str, Any]) -> list[str]:
    """What the steady response does to followers and shaft, and its largest harmonics beside the linear ones."""
    if turn is None:
        return []
    rows: list[Sequence[str]] = [("Over a turn of the steady response", "unit", "lowest", "at °", "highest", "at °")]
    named = [("Wind-up of the shaft", "°", values["wind_up_deg"]), ("Torque in the shaft", "N·m", values["shaft_torque_nm"])]
    for each in values["follower_error"]:
        of = f", {printable(each['drive'])}" if each["drive"] else ""
        named.append((f"Follower's error{of}", UNITS[each["unit"]].symbol, each))
    rows += [(name, unit, *(digits(e[key]) for e in (v["min"], v["max"]) for key in ("value", "cam_angle_deg"))) for name, unit, v in named]
    mean, amplitude = values["mean_shaft_torque_nm"], values["shaft_torque_amplitude_nm"]
    mean = 0.0 if abs(mean) < ZERO * amplitude else mean
    fatigue = [("Torque in the shaft, mean", digits(mean), "N·m"), ("alternating, amplitude", digits(amplitude), "N·m")]
    return ["", *columns(rows, left=2), "", *columns(fatigue), "", *_harmonics(turn)]


def _harmonics(turn: SteadyTurn) -> list[str]:
    from core.stability import APPROXIMATE, EXACT

    sizes = [720.0 * np.abs(each) for each in (turn.harmonics(), turn.linear()[EXACT], turn.linear()[APPROXIMATE])]
    table: list[Sequence[str]] = [("Largest harmonics of the wind-up, °", "steady", "linear (21)", "Kim1990 (27), of (22)")]
    for k in sorted((1 + np.argsort(-sizes[0][1:], kind="stable")[:LARGEST]).tolist()):
        table.append((f"{k} × shaft speed", *(digits(each[k], 4) if math.isfinite(each[k]) else "no answer" for each in sizes)))
    return columns(table)


def _forbidden(values: dict[str, Any]) -> list[str]:
    if not values["bands"]:
        return ["", "No forbidden band of speed"]
    rows: list[Sequence[str]] = [
        ("Forbidden speeds", "from rpm", "to rpm", "from η", "to η", "growth a turn %", "turns to double")
    ]
    for band in values["bands"]:
        growth = band["growth_percent_per_turn"]
        edges = (digits(band[k], 8) for k in ("rpm_lo", "rpm_hi", "eta_hi", "eta_lo"))
        rows.append(
            (f"tongue {band['n']}", *edges, digits(growth, 3), digits(math.log(2.0) / math.log1p(growth / 100.0), 3))
        )
    return ["", *columns(rows)]


def _needed(study: Study | ShaftStudy, values: dict[str, Any]) -> list[str]:
    needed, now = values["stiffness"], study.design.camshaft.elastic
    if now is None or needed["allowed"]:
        return ["", "At this speed the shaft keeps clear of the forbidden bands."]
    softer = needed["greatest_softer_nm_per_rad"]
    stiffer = f"a stiffness from {digits(needed['least_stiffer_nm_per_rad'])} N·m/rad on"
    return [
        "",
        f"To keep clear of the forbidden bands at this speed: {stiffer}{f', or up to {digits(softer)} N·m/rad' if softer else ''}.",
    ]


def _findings(study: Study | ShaftStudy, stages: Sequence[str]) -> list[str]:
    findings = study.findings(tuple(stages))
    return _heading("Findings") + ([finding_line(f, study.angle_name) for f in findings] or ["none"])


def _certificate(study: Study | ShaftStudy, stages: Sequence[str]) -> list[str]:
    rows: list[Sequence[str]] = [("", "residual", "bound", "", "")]
    for name, residual in study.certificate(tuple(stages)).items():
        verdict = "kept" if residual.kept else "NOT KEPT"
        rows.append(
            (name.replace("_", " "), f"{residual.value:.2e}", f"{residual.bound:.2e}", verdict, residual.note)
        )
    return _heading("Certificate") + columns(rows)


def stability_text(study: Study | ShaftStudy) -> str:
    """The report's section on the flexible shaft alone."""
    return "\n".join(_stability(study)[1:]) + "\n"


def point_text(shaft: Stability, eta: float, q: float, verdicts: Sequence[Verdict]) -> str:
    """What every model says of any point of the chart."""
    head = f"At η = {digits(eta)}, Q = {digits(q)}, {digits(shaft.machine.rpm(eta))} rpm"
    return "\n".join(_verdicts(head, verdict_rows(verdicts))) + "\n"


def report(study: Study) -> str:
    """The whole report, lines ending with a newline. Raises NoAnswer where the design has none."""
    stages = study.stages
    name = printable(study.design.name)
    lines = [name, "=" * len(name)]
    lines += linkage_inputs(study) if study.design.drive.links else []
    lines += _inputs(study) + _motion(study) + _base(study)
    lines += _extremes(study, channels(study.design), stages) + _limits(study, stages) + _contact(study) + _vibration(study) + _life(study)
    lines += _flywheel(study, flywheel(study)) + _stability(study) + _findings(study, stages) + _certificate(study, stages)
    return "\n".join(lines) + "\n"


# -- several drives on a shaft --------------------------------------------------------------------------


def shaft_report(study: ShaftStudy) -> str:
    """The whole report of a shaft: its drives, their timing, torque, flywheel, stability, findings; then each drive's own."""
    name = printable(study.design.name)
    lines = [name, "=" * len(name), *_drives(study), *_timing(study), *_torque(study), *_flywheel(study, shaft_flywheel(study))]
    lines += (_stability(study) if answers(study) else []) + _findings(study, ()) + _certificate(study, ())
    texts = ["\n".join(lines) + "\n"]
    texts += [report(each) for drive, each in study.drives.items() if drive not in study.failures]
    return "\n\n".join(texts)


def _drives(study: ShaftStudy) -> list[str]:
    rows: list[Sequence[str]] = [("Drive", "phase °", "", "lowest N·m", "at °", "highest N·m", "at °")]
    for (name, each), drive in zip(study.drives.items(), study.design.drives, strict=True):
        figures = ["no answer", "", "", ""] if name in study.failures else [""] * 4
        if each.loads_shaft and name not in study.failures:
            found = peaks(study.drive_load(name))
            figures = [digits(v) for e in (found.low, found.high) for v in (e.value, math.degrees(e.theta))]
        rows.append((printable(name), f"{drive.phase_deg:.10g}", "mirrored" if drive.mirrored else "", *figures))
    return [*_heading("Drives, by machine angle"), *columns(rows)]


def _timing(study: ShaftStudy) -> list[str]:
    rows: list[Sequence[str]] = [("First", "at °", "second", "at °", "after °", "least °", "")]
    for row, at in zip(study.design.timing, distances(study.design), strict=True):
        figures = (digits(at.first_deg), printable(row.second), digits(at.second_deg), digits(at.after_deg), digits(row.least_deg))
        rows.append((printable(row.first), *figures, "kept" if at.kept else "BROKEN"))
    return [*(_heading("Timing") + columns(rows) if len(rows) > 1 else []), *_events(study.design)]


def _events(design: Design) -> list[str]:
    """Where rises and returns start and end, in the order of the turn."""
    rows: list[Sequence[str]] = [("Event", "at °", "ms")]
    rows += [(printable(name), digits(angle), digits(time)) for name, angle, time in event_rows(design)]
    return _heading("Events, by machine angle") + columns(rows) if len(rows) > 1 else []


def _torque(study: ShaftStudy) -> list[str]:
    figures = shaft_torque(study)
    if not figures:
        return []
    labels = {"mean_nm": "Mean", "rms_nm": "Root mean square", "peak_nm": "Greatest", "peak_power_w": "Peak power"}
    rows = [(label, digits(figures[key]), "W" if key.endswith("_w") else "N·m") for key, label in labels.items()]
    return _heading("Torque of all drives at constant speed") + columns(rows)
