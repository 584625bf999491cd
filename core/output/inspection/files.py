"""An inspection as files: the table of lift, what a measured table deviates from it, and a summary that says what they are."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from core.errors import KindynaError
from core.output.export import SUMMARY, csv
from core.output.inspection.comparison import ProfileComparison
from core.output.inspection.lift import Inspection
from core.output.profile.drawing import SENSES
from core.output.summary import to_json
from core.project.files import require_own_json, write_into

ENDING = ".csv"
COLUMNS = ("cam_angle_deg", "lift_mm", "lower_mm", "upper_mm")
ROWS = (
    "cam_angle_deg",
    "measured_mm",
    "lift_mm",
    "lower_mm",
    "upper_mm",
    "deviation_mm",
    "normal_deviation_mm",
    "line",
)
DEVIATION = "_deviation"  # behind the name of the table


def require_name(path: Path) -> None:
    """Raises KindynaError where a file of this name holds no such table."""
    if path.suffix.lower() != ENDING:
        raise KindynaError(
            f"{path}: no table of lift is written as {path.suffix or 'a name without ending'}; allowed: {ENDING}"
        )


def _names(path: Path, compared: bool) -> list[str]:
    """Of the table, of its deviations, and of the summary."""
    return [path.name, *([f"{path.stem}{DEVIATION}{path.suffix}"] if compared else []), SUMMARY]


def facts(made: Inspection, comparison: ProfileComparison | None = None) -> dict[str, Any]:
    """What the table is, as ``summary.json`` says it."""
    at, table = made.probing, made.table
    stated: dict[str, Any] = {
        "design": at.study.design.name,
        "quantity": "lift of a probe on a line through the cam centre, above the base",
        "flank": at.request.flank,
        "probe": at.kind.label,
        "probe_radius_mm": at.radius if at.kind.radius else None,
        "direction_deg": float(np.rad2deg(at.direction)),
        "rotation": SENSES[at.study.sense][0],
        "units": {"length": "mm", "angle": "deg"},
        "least_profile_radius_mm": at.least_radius.value,
        "base_mm": at.base,
        "tolerance_mm": at.request.tolerance_mm,
        "points": int(table.degrees.size),
        "largest_lift_mm": float(table.lift.max()),
        "findings": [
            {"code": f.code, "severity": f.severity, "cam_angle_deg": f.cam_angle_deg, "message": f.message}
            for f in at.findings
        ],
    }
    return stated if comparison is None else {**stated, "measured": verdict_facts(comparison)}


def verdict_facts(comparison: ProfileComparison) -> dict[str, Any]:
    """What a measured table came to."""
    row, most = comparison.worst, comparison.most
    return {
        "file": comparison.name,
        "rows": int(comparison.lines.size),
        "fitted": comparison.fitted,
        "angle_offset_deg": comparison.angle_offset,
        "lift_offset_mm": comparison.lift_offset,
        "largest_normal_deviation_mm": float(comparison.normal[row]),
        "cam_angle_deg": float(comparison.table.degrees[row]),
        "line": int(comparison.lines[row]),
        "largest_deviation_mm": float(comparison.deviation[most]),
        "largest_deviation_at_deg": float(comparison.table.degrees[most]),
        "largest_deviation_line": int(comparison.lines[most]),
        "rms_deviation_mm": float(np.sqrt(np.mean(comparison.deviation**2))),
        "rows_out": int(comparison.out.sum()),
        "in_tolerance": comparison.in_tolerance,
        "notes": list(comparison.notes),
        "findings": [
            {"code": f.code, "severity": f.severity, "cam_angle_deg": f.cam_angle_deg, "message": f.message}
            for f in comparison.findings
        ],
    }


def files(made: Inspection, path: Path, comparison: ProfileComparison | None = None) -> dict[str, bytes]:
    """File name -> content."""
    table = made.table
    texts = [csv(COLUMNS, _plain(table.degrees, table.lift, table.lower, table.upper))]
    if comparison is not None:
        at = comparison.table
        columns = _plain(
            at.degrees,
            comparison.measured,
            at.lift,
            at.lower,
            at.upper,
            comparison.deviation,
            comparison.normal,
            comparison.lines,
        )
        texts.append(csv(ROWS, columns))
    texts.append(to_json({"file": path.name, **facts(made, comparison)}))
    return {name: text.encode() for name, text in zip(_names(path, comparison is not None), texts, strict=True)}


def _plain(*columns: np.ndarray) -> list[np.ndarray]:
    return [column + 0.0 for column in columns]  # no minus zero


def write(made: Inspection, path: Path, comparison: ProfileComparison | None = None) -> list[Path]:
    """Write the tables and the summary beside them; the paths. Raises FileError, KindynaError, and then nothing has changed."""
    require_name(path)
    texts = files(made, path, comparison)
    require_own_json(path.parent / SUMMARY, {"file", "base_mm"})
    write_into(path.parent, texts, typed=path.name)
    return [path.parent / name for name in texts]


__all__ = ["COLUMNS", "ENDING", "ROWS", "facts", "files", "require_name", "verdict_facts", "write"]
