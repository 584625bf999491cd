"""The sections of the report of several drives on a shaft: their timing, torque, flywheel and stability together."""

from __future__ import annotations

import math
from collections.abc import Sequence

from core.design import Design, distances
from core.output.lines import printable
from core.output.report.parts import Cell, Number, Section, section, table
from core.output.summary import torque as torque_of
from core.output.timing import event_rows
from core.shaft import peaks
from core.study import Camshaft, Study


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
