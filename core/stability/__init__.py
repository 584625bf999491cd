"""Stability of the flexible camshaft (Kim1990, corrected): tongues, monodromy, wind-up, forbidden speeds."""

from core.plot import Figure, Plot, PlotCurve
from core.stability.coefficients import (
    APPROXIMATE,
    EQUATIONS,
    EXACT,
    Coefficients,
    DrivenMechanism,
    coefficients,
    driven_sizes,
    kim_edges,
    kim_matrix,
    shaft_coefficients,
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
    harmonics_plot,
    history_plot,
    steady_plots,
    stiffness_for,
    with_flexible_shaft,
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
    margin_text,
    nearest_bands,
    speed_sentence,
    stability,
)
from core.stability.steady import Follower, SteadyTurn, branch, fourier_sum, shoot, steady_response, steady_turn
from core.stability.tongues import EDGE_ERROR, ETA_MAX, Tongues, count_up_to, harmonic_tongues, tongues_of_order
from core.stability.windup import Averages, FollowerContact, History, histories, history, mean_wind_up

__all__ = [
    "APPROXIMATE", "EDGE_ERROR", "EQUATIONS", "ETA_MAX", "EXACT", "LABELS", "LOST", "STABLE", "UNKNOWN_VERDICT",
    "UNSTABLE", "Averages", "Chart", "Coefficients", "DrivenMechanism", "Figure", "Follower", "FollowerContact",
    "ForbiddenBand", "History", "Machine", "Plot", "PlotCurve", "Stability", "SteadyTurn", "Stiffness", "Tongues",
    "Verdict", "averages_plots", "bands", "branch", "chart", "coefficients", "coefficients_plot", "contact_forces",
    "contact_marks", "count_up_to", "driven_sizes", "findings", "first_guess", "fourier_sum", "harmonic_tongues",
    "harmonics_plot", "histories", "history", "history_plot", "kim_edges", "kim_matrix", "margin_text",
    "mean_wind_up", "monodromy", "nearest_bands", "refined", "shaft_coefficients", "shoot", "speed_sentence",
    "stability", "steady_plots", "steady_response", "steady_turn", "stiffness_for", "tongues", "tongues_of_order",
    "with_flexible_shaft",
]  # fmt: skip
