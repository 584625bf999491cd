"""Motions from measured tables: reading them, fitting them within their measuring error, telling what was found."""

from core.measured.columns import NOTHING_SAID, Layout, Wish, layout
from core.measured.fitting import Contradiction, Fit, FitError, fit, guess_error
from core.measured.outliers import Outliers, outliers
from core.measured.sheet import DECIMALS, DELIMITERS, RowFault, Sheet, TableError, read_sheet
from core.measured.summary import (
    detected,
    figures,
    fit_data,
    fit_text,
    into_design,
    notes,
    row_line,
    suspicions,
    worst_first,
)
from core.measured.table import Table, read_table
from core.measured.units import ANGLE_UNITS, QUANTITIES, TIME_UNITS, value_units

__all__ = [
    "ANGLE_UNITS",
    "DECIMALS",
    "DELIMITERS",
    "NOTHING_SAID",
    "QUANTITIES",
    "TIME_UNITS",
    "Contradiction",
    "Fit",
    "FitError",
    "Layout",
    "Outliers",
    "RowFault",
    "Sheet",
    "Table",
    "TableError",
    "Wish",
    "detected",
    "figures",
    "fit",
    "fit_data",
    "fit_text",
    "guess_error",
    "into_design",
    "layout",
    "notes",
    "outliers",
    "read_sheet",
    "read_table",
    "row_line",
    "suspicions",
    "value_units",
    "worst_first",
]
