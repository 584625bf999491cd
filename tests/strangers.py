"""Rows that nobody here knows, added to the tables before anything reads them: ``pytest -p strangers``."""

import gc
from collections.abc import Mapping
from typing import Any

from core.laws import EVERY_LAW, LAWS, Law, Piece
from core.laws.table import SERIES


def add(table: Mapping[str, Any], key: str, row: Any) -> None:
    """Into the dict behind a table that is only read."""
    (rows,) = gc.get_referents(table)
    rows[key] = row


TREFOIL = Law(
    "trefoil",
    "Trefoil",
    SERIES,
    (Piece(0.0, (0.0, 0.0, 0.0, 4.0, -3.0)),),
    ("s = 4 u³ - 3 u⁴",),
    "Stranger 2000: s = 4u^3 - 3u^4",
    "TRE",
)
for each in (LAWS, EVERY_LAW):
    add(each, TREFOIL.slug, TREFOIL)
