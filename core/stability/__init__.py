"""Stability of the flexible camshaft (Kim1990, corrected): tongues, monodromy, wind-up, forbidden speeds."""

from core.plot import Figure, Plot, PlotCurve
from core.stability.coefficients import (
    APPROXIMATE,
    EQUATIONS,
    EXACT,
    Coefficients,
    DrivenMechanism,
    coefficients,
    coefficients_of_all,
    kim_edges,
    kim_matrix,
    own_sizes,
)
from core.stability.critical_speeds import (
    Chart,
    ForbiddenBand,
    Machine,
    Stiffness,
    averages_plots,
    bands,
    chart,
    coefficients_plot,
    contact_marks,
    first_guess,
    flexible,
    harmonics_plot,
    history_plot,
    steady_plots,
    stiffness_for,
)
from core.stability.floquet import monodromy, refined, tongues
from core.stability.stage import (
    LABELS,
    LOST,
    STABLE,
    UNKNOWN_VERDICT,
    UNSTABLE,
    Stability,
    Verdict,
    contact_forces,
    findings,
    stability,
)
from core.stability.steady import Follower, SteadyTurn, branch, shoot, steady_response, steady_turn, sum_of
from core.stability.tongues import EDGE_ERROR, ETA_MAX, Tongues, count_up_to, harmonic_tongues, tongues_of_order
from core.stability.windup import Averages, History, Touching, histories, history, mean_wind_up

__all__ = [
    "APPROXIMATE", "EDGE_ERROR", "EQUATIONS", "ETA_MAX", "EXACT", "LABELS", "LOST", "STABLE", "UNKNOWN_VERDICT", "UNSTABLE", "Averages",
    "Chart", "Coefficients", "DrivenMechanism", "Figure", "Follower", "ForbiddenBand", "History", "Machine", "Plot", "PlotCurve",
    "Stability", "SteadyTurn", "Stiffness", "Tongues", "Touching", "Verdict", "averages_plots", "bands", "branch", "chart",
    "coefficients", "coefficients_of_all", "coefficients_plot", "contact_forces", "contact_marks", "count_up_to", "findings",
    "first_guess", "flexible", "harmonic_tongues", "harmonics_plot", "histories", "history", "history_plot", "kim_edges",
    "kim_matrix", "mean_wind_up", "monodromy", "own_sizes", "refined", "shoot", "stability", "steady_plots", "steady_response",
    "steady_turn", "stiffness_for", "sum_of", "tongues", "tongues_of_order",
]  # fmt: skip
