"""Motion laws: one table of curves, one evaluator, and splines of least jerk."""

from core.laws.pieces import Acceleration, Piece, PieceTable, Sine, asymmetric, integrate, shifted, split, trimmed
from core.laws.polynomial import NoSpline, hermite, least_jerk
from core.laws.table import (
    ALIASES,
    EVERY_LAW,
    FLAT_FORMULA,
    FLAT_WHERE,
    LAWS,
    Law,
    Peaks,
    find_law,
    law_groups,
    named_law,
    peaks,
    scca,
)
from core.numerics.derivatives import ORDERS

__all__ = [
    "ALIASES",
    "EVERY_LAW",
    "FLAT_FORMULA",
    "FLAT_WHERE",
    "LAWS",
    "ORDERS",
    "Acceleration",
    "Law",
    "NoSpline",
    "Peaks",
    "Piece",
    "PieceTable",
    "Sine",
    "asymmetric",
    "find_law",
    "hermite",
    "integrate",
    "law_groups",
    "least_jerk",
    "named_law",
    "peaks",
    "scca",
    "shifted",
    "split",
    "trimmed",
]
