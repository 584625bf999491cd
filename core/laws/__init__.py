"""Motion laws as one table walked by one evaluator."""

from core.laws.peaks import Peaks, peaks, peaks_of
from core.laws.pieces import ORDERS, Acceleration, Piece, PieceTable, Sine, integrate
from core.laws.shapes import asymmetric
from core.laws.table import ALIASES, LAWS, Law, find_law, scca

__all__ = [
    "ALIASES",
    "LAWS",
    "ORDERS",
    "Acceleration",
    "Law",
    "Peaks",
    "Piece",
    "PieceTable",
    "Sine",
    "asymmetric",
    "find_law",
    "integrate",
    "peaks",
    "peaks_of",
    "scca",
]
