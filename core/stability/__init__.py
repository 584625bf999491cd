"""Stability of the flexible camshaft (Kim1990, corrected): tongues, monodromy, wind-up, forbidden speeds."""

from core.stability.chart import ETA_MAX, Chart, chart, count_up_to
from core.stability.claims import Claim, claims
from core.stability.coefficients import Coefficients, coefficients
from core.stability.contact import Contact, contact
from core.stability.critical_speeds import Band, Machine, Stiffness, bands, stiffness_for
from core.stability.equations import APPROXIMATE, EQUATIONS, EXACT
from core.stability.figures import Curve, Figure, Plot, averages_plots, coefficients_plot, contact_marks, history_plot
from core.stability.floquet import Monodromy, monodromy
from core.stability.floquet_edges import refined, tongues
from core.stability.guess import first_guess, flexible
from core.stability.limits import findings
from core.stability.means import TIMES, Averages, mean_wind_up
from core.stability.model_comparison import LABELS, Verdict, verdicts
from core.stability.stage import Stability, stability
from core.stability.steady_response import SteadyResponse, branch, shoot, steady_response
from core.stability.tongues import ERROR, Tongues, harmonic_tongues, tongues_of_order
from core.stability.windup import History, histories, history

__all__ = [
    "APPROXIMATE", "EQUATIONS", "ERROR", "ETA_MAX", "EXACT", "LABELS", "TIMES", "Averages", "Band", "Chart",
    "Claim", "Coefficients", "Contact", "Curve", "Figure", "History", "Machine", "Monodromy", "Plot",
    "Stability", "SteadyResponse", "Stiffness", "Tongues", "Verdict", "averages_plots", "bands", "branch",
    "chart", "claims", "coefficients", "coefficients_plot", "contact", "contact_marks", "count_up_to",
    "findings", "first_guess", "flexible", "harmonic_tongues", "histories", "history", "history_plot",
    "mean_wind_up", "monodromy", "refined", "shoot", "stability", "steady_response", "stiffness_for", "tongues",
    "tongues_of_order", "verdicts",
]  # fmt: skip
