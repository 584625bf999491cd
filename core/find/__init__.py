"""Search for dimensions: the smallest, largest or best value of a field within its limits."""

from core.find.goals import CAM_SEARCHES, LimitReading
from core.find.offer import (
    LIMIT_RANGES,
    OF_PRESSURE,
    StatedLimits,
    Trade,
    available_searches,
    default_limits,
    trade,
    traded_field,
    varied_fields,
)
from core.find.ranking import (
    FIGURES,
    RankingColumn,
    RankingRow,
    blend_candidates,
    law_candidates,
    moving_segments,
    ranking,
    ranking_columns,
    ranking_row,
    sorted_rows,
)
from core.find.rounding import rounded_values
from core.find.shaft import EXTRA, SHAFT_SEARCHES, available_shaft_searches
from core.find.solution import Solution
from core.find.spring import SEARCHES, find, remedy_of, round_solution
from core.find.trial import same_design
from core.study.limits import ANY_PRESSURE, BOUNDS, FORCE, LIMITS, USER, LimitValue

__all__ = [
    "ANY_PRESSURE",
    "BOUNDS",
    "CAM_SEARCHES",
    "EXTRA",
    "FIGURES",
    "FORCE",
    "LIMITS",
    "LIMIT_RANGES",
    "OF_PRESSURE",
    "SEARCHES",
    "SHAFT_SEARCHES",
    "USER",
    "LimitReading",
    "LimitValue",
    "RankingColumn",
    "RankingRow",
    "Solution",
    "StatedLimits",
    "Trade",
    "available_searches",
    "available_shaft_searches",
    "blend_candidates",
    "default_limits",
    "find",
    "law_candidates",
    "moving_segments",
    "ranking",
    "ranking_columns",
    "ranking_row",
    "remedy_of",
    "round_solution",
    "rounded_values",
    "same_design",
    "sorted_rows",
    "trade",
    "traded_field",
    "varied_fields",
]  # fmt: skip
