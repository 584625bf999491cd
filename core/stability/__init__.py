"""Stability of the flexible camshaft (Kim1990, corrected): tongues, monodromy, wind-up, forbidden speeds."""

from core.stability.chart import ETA_MAX, Cancelled, Chart, chart, count_up_to
from core.stability.claims import Claim, claims
from core.stability.coefficients import Coefficients, coefficients
from core.stability.contact import Contact, contact
from core.stability.edges import refined, tongues
from core.stability.equations import APPROXIMATE, EQUATIONS, EXACT
from core.stability.guess import first_guess
from core.stability.limits import findings
from core.stability.monodromy import Monodromy, monodromy
from core.stability.orbit import Orbit, branch, orbit, shoot
from core.stability.speeds import Band, Machine, Stiffness, bands, stiffness_for
from core.stability.stage import Stability, stability
from core.stability.tongues import Tongues, harmonic_tongues, tongues_of_order
from core.stability.verdicts import LABELS, Verdict, verdicts
from core.stability.windup import History, averages, histories, history

__all__ = [
    "APPROXIMATE", "EQUATIONS", "ETA_MAX", "EXACT", "LABELS", "Band", "Cancelled", "Chart", "Claim", "Coefficients",
    "Contact", "History", "Machine", "Monodromy", "Orbit", "Stability", "Stiffness", "Tongues", "Verdict", "averages",
    "bands", "branch", "chart", "claims", "coefficients", "contact", "count_up_to", "findings", "first_guess",
    "harmonic_tongues", "histories", "history", "monodromy", "orbit", "refined", "shoot", "stability",
    "stiffness_for", "tongues", "tongues_of_order", "verdicts",
]  # fmt: skip
