"""Motions from measured tables: reading them, fitting them within their measuring error, telling what was found."""

from core.measured.columns import NOTHING_SAID, Layout, Wish, layout
from core.measured.fitting import Fit, FitError, fit, guess_error
from core.measured.sheet import DECIMALS, DELIMITERS, Sheet, TableError, read_sheet
from core.measured.table import Table, read_table
from core.measured.telling import (
    detected,
    figures,
    fit_data,
    fit_text,
    into_design,
    notes,
    row_line,
    suspicions,
)
from core.measured.words import ANGLE_UNITS, QUANTITIES, TIME_UNITS, value_units

__all__ = [
    "ANGLE_UNITS",
    "DECIMALS",
    "DELIMITERS",
    "NOTHING_SAID",
    "QUANTITIES",
    "TIME_UNITS",
    "Fit",
    "FitError",
    "Layout",
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
    "read_sheet",
    "read_table",
    "row_line",
    "suspicions",
    "value_units",
]
