"""Motion laws as one table walked by one evaluator."""

from core.laws.pieces import ORDERS, Acceleration, Piece, PieceTable, Sine, integrate
from core.laws.table import ALIASES, LAWS, Law, find_law, scca

__all__ = [
    "ALIASES",
    "LAWS",
    "ORDERS",
    "Acceleration",
    "Law",
    "Piece",
    "PieceTable",
    "Sine",
    "find_law",
    "integrate",
    "scca",
]
