"""Motions from measured tables: reading them, finding their wrong rows, fitting them within their measuring error."""

from typing import TYPE_CHECKING

from core.measured.sheet import (
    DECIMALS,
    DELIMITERS,
    RowFault,
    TableError,
    Worksheet,
    is_workbook,
    read_sheet,
    read_workbook,
    sheet_names,
)
from core.measured.units import ANGLE_UNITS, DERIVATIVES, QUANTITIES, TIME_UNITS, value_units
from core.process import lazy_attributes

if TYPE_CHECKING:
    from core.measured.columns import ALL_DETECTED, ColumnChoice, ColumnLayout, layout
    from core.measured.fitting import (
        ColumnFit,
        Contradiction,
        Errors,
        MotionFit,
        fit,
        guess_error,
        with_measured_motion,
    )
    from core.measured.gap import FitError, Gap, OpenTurnError, mirror_rows
    from core.measured.structure import AccelerationJump, SegmentFit, SwitchError, Switches, segment_kinds
    from core.measured.table import MeasuredColumn, MeasuredTable, load_points, load_table_text, read_table
else:
    __getattr__ = lazy_attributes(__name__, "columns", "table", "fitting", "gap", "structure")

__all__ = [
    "ALL_DETECTED",
    "ANGLE_UNITS",
    "DECIMALS",
    "DELIMITERS",
    "DERIVATIVES",
    "QUANTITIES",
    "TIME_UNITS",
    "AccelerationJump",
    "ColumnChoice",
    "ColumnFit",
    "ColumnLayout",
    "Contradiction",
    "Errors",
    "FitError",
    "Gap",
    "MeasuredColumn",
    "MeasuredTable",
    "MotionFit",
    "OpenTurnError",
    "RowFault",
    "SegmentFit",
    "SwitchError",
    "Switches",
    "TableError",
    "Worksheet",
    "fit",
    "guess_error",
    "is_workbook",
    "layout",
    "load_points",
    "load_table_text",
    "mirror_rows",
    "read_sheet",
    "read_table",
    "read_workbook",
    "segment_kinds",
    "sheet_names",
    "value_units",
    "with_measured_motion",
]
