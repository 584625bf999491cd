"""The report of a study as plain text: what was asked, what came out, what exceeds its limit, what proves it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from core.channels import Channel, channels
from core.design import UNITS, entries
from core.findings import Finding
from core.laws import find_law
from core.study import Study
from core.summary import extremes, flywheel, joins

_ASSUMED = "*"


def digits(value: float | None, most: int = 6) -> str:
    """A number for reading: six significant digits, never an exponent where a plain number will do."""
    if value is None:
        return "infinite"
    if value == 0.0:
        return "0"
    size = math.floor(math.log10(abs(value)))
    if size < -4 or size > 8:
        return f"{value:.{most - 1}e}"
    return f"{value:.{max(0, most - 1 - size)}f}"


def columns(rows: Sequence[Sequence[str]], left: int = 1) -> list[str]:
    """Rows as aligned text; the first ``left`` columns flush left, the others right."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return [
        "  ".join(
            c.ljust(w) if i < left else c.rjust(w) for i, (c, w) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]


def printable(text: str) -> str:
    """The text on one line, without what a terminal would obey."""
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text)


def finding_line(finding: Finding) -> str:
    where = "" if finding.cam_angle_deg is None else f" at cam angle {digits(finding.cam_angle_deg)} °"
    return f"{finding.severity}: {finding.message}{where} [{finding.field}]"


def _heading(text: str) -> list[str]:
    return ["", text, "-" * len(text)]


def _inputs(study: Study) -> list[str]:
    lines = []
    for name in ("follower", "cam", "shaft", "loads"):
        rows = []
        for entry in entries(study.design, name):
            value = f"{entry.value:.10g}" if isinstance(entry.value, float) else str(entry.value)
            mark = _ASSUMED if entry.path in study.design.assumed else ""
            rows.append((entry.info.label, value, entry.unit.symbol, mark))
        lines += _heading(name.capitalize()) + columns(rows)
    if study.design.assumed:
        lines += ["", f"{_ASSUMED} assumed, not taken from a source"]
    return lines


def _law_label(slug: str) -> str:
    law = find_law(slug)
    return law.label if law is not None else slug


def _motion(study: Study) -> list[str]:
    motion = study.design.drive.motion
    unit = UNITS[motion.unit].symbol
    rows: list[Sequence[str]] = [("Segment", "from °", "to °", f"rise {unit}")]
    at = 0.0
    for segment in motion.segments:
        end = at + segment.span_deg
        rows.append((_law_label(segment.curve.law), f"{at:.10g}", f"{end:.10g}", f"{segment.rise:.10g}"))
        at = end
    lines = _heading("Motion") + columns(rows)
    told: list[Sequence[str]] = [("Join at °", "s", "v", "a", "j")]
    told += [(digits(j["cam_angle_deg"]), *(digits(j[k]) for k in "svaj")) for j in joins(study)]
    return [*lines, "", f"Jumps at the joins, {unit} per radian of cam angle", *columns(told, left=0)]


def _base(study: Study) -> list[str]:
    rows = [(name, digits(v / UNITS[u].factor, 10), UNITS[u].symbol) for name, (v, u) in study.linkage.base.items()]
    return _heading("Base position") + columns(rows)


def _extremes(study: Study, rows: Iterable[Channel], stages: Sequence[str]) -> list[str]:
    found = extremes(study, stages)
    told: list[Sequence[str]] = [("", "unit", "lowest", "at °", "highest", "at °")]
    for row in rows:
        if row.slug in found:
            low, high = found[row.slug]["min"], found[row.slug]["max"]
            told.append(
                (row.label, row.unit.symbol, digits(low["value"]), digits(low["cam_angle_deg"]),
                 digits(high["value"]), digits(high["cam_angle_deg"]))
            )  # fmt: skip
    return _heading("Extremes over one turn") + columns(told, left=2)


def _flywheel(study: Study) -> list[str]:
    wheel, shaft = flywheel(study), study.design.shaft
    if not wheel:
        return []
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
    return _heading("Flywheel") + columns(rows)


def _findings(study: Study, stages: Sequence[str]) -> list[str]:
    found = study.findings(tuple(stages))
    return _heading("Findings") + ([finding_line(f) for f in found] or ["none"])


def _certificate(study: Study, stages: Sequence[str]) -> list[str]:
    rows: list[Sequence[str]] = [("", "residual", "bound", "")]
    for name, residual in study.certificate(tuple(stages)).items():
        verdict = "kept" if residual.kept else "NOT KEPT"
        rows.append((name.replace("_", " "), f"{residual.value:.2e}", f"{residual.bound:.2e}", verdict))
    return _heading("Certificate") + columns(rows)


def report(study: Study) -> str:
    """The whole report, lines ending with a newline. Raises NoAnswer where the design has none."""
    stages = study.stages
    name = printable(study.design.name)
    lines = [name, "=" * len(name)]
    lines += _inputs(study) + _motion(study) + _base(study)
    lines += _extremes(study, channels(study.design), stages)
    lines += _flywheel(study) + _findings(study, stages) + _certificate(study, stages)
    return "\n".join(lines) + "\n"
