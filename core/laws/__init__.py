"""Motion laws as one table walked by one evaluator."""

from core.laws.peaks import Peaks, peaks, peaks_of
from core.laws.pieces import ORDERS, Acceleration, Piece, PieceTable, Sine, integrate, runs_of
from core.laws.polynomial import NoSpline, hermite, least_jerk
from core.laws.shapes import asymmetric, cut
from core.laws.table import ALIASES, LAWS, Law, find_law, scca

__all__ = [
    "ALIASES",
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
    "cut",
    "find_law",
    "hermite",
    "integrate",
    "least_jerk",
    "peaks",
    "peaks_of",
    "runs_of",
    "scca",
]
