"""Motions from measured tables: reading them, finding their wrong rows, fitting them within their measuring error."""

from core.measured.columns import ALL_DETECTED, ColumnChoice, ColumnLayout, layout
from core.measured.fitting import ColumnFit, Contradiction, Errors, MotionFit, fit, guess_error, into_design
from core.measured.gap import FitError, Gap, OpenTurnError, mirrored
from core.measured.outliers import Outliers, outliers
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
from core.measured.structure import FoundJump, FoundSegment, SwitchError, Switches, switchable
from core.measured.table import MeasuredColumn, MeasuredTable, as_text, load_points, read_table
from core.measured.units import ANGLE_UNITS, DERIVATIVES, QUANTITIES, TIME_UNITS, value_units

__all__ = [
    "ALL_DETECTED",
    "ANGLE_UNITS",
    "DECIMALS",
    "DELIMITERS",
    "DERIVATIVES",
    "QUANTITIES",
    "TIME_UNITS",
    "ColumnChoice",
    "ColumnFit",
    "ColumnLayout",
    "Contradiction",
    "Errors",
    "FitError",
    "FoundJump",
    "FoundSegment",
    "Gap",
    "MeasuredColumn",
    "MeasuredTable",
    "MotionFit",
    "OpenTurnError",
    "Outliers",
    "RowFault",
    "SwitchError",
    "Switches",
    "TableError",
    "Worksheet",
    "as_text",
    "fit",
    "guess_error",
    "into_design",
    "is_workbook",
    "layout",
    "load_points",
    "mirrored",
    "outliers",
    "read_sheet",
    "read_table",
    "read_workbook",
    "sheet_names",
    "switchable",
    "value_units",
]
