"""Dimensions found rather than tried: the smallest, the largest or the best value of a field that keeps its limits."""

from core.find.goals import WANTED, LimitReading
from core.find.offer import OF_PRESSURE, Stated, Trade, offered, trade, traded, usual_limits, varied
from core.find.ranking import (
    FIGURES,
    Ranked,
    RankingColumn,
    blend_candidates,
    figures_of,
    in_order,
    law_candidates,
    moving_segments,
    ranked,
    ranking,
)
from core.find.search import Solution
from core.find.shaft import EXTRA, ON_SHAFT, offered_on_shaft
from core.find.spring import SEARCHES, find, remedy_of
from core.find.trial import alone
from core.study.limits import ANY_PRESSURE, BOUNDS, FORCE, LIMITS, USER, LimitValue

__all__ = [
    "ANY_PRESSURE", "BOUNDS", "EXTRA", "FIGURES", "FORCE", "LIMITS", "OF_PRESSURE", "ON_SHAFT", "SEARCHES", "USER", "WANTED",
    "LimitReading", "LimitValue", "Ranked", "RankingColumn", "Solution", "Stated", "Trade", "alone", "blend_candidates", "figures_of",
    "find", "in_order", "law_candidates", "moving_segments", "offered", "offered_on_shaft", "ranked", "ranking", "remedy_of",
    "trade", "traded", "usual_limits", "varied",
]  # fmt: skip
