"""The elastic follower: one mass on the follower's stiffness, driven by the motion of the cam: m z̈ + c ż + k(z - s) + k_s z = 0."""

from core.elastic.equivalent import Elasticity, Equivalent, by_motion, equivalent
from core.elastic.response import Dwell, ResidualVibration, Response, dwells
from core.elastic.spectrum import Spectrum, spectrum

__all__ = [
    "Dwell", "Elasticity", "Equivalent", "ResidualVibration", "Response", "Spectrum", "by_motion", "dwells", "equivalent", "spectrum",
]  # fmt: skip
