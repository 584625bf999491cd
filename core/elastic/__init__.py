"""Vibration of an elastic follower, modelled as one mass in the coordinate of the motion.

m z'' + c z' + k (z - s) + ks z = 0 is solved exactly over each piece of the motion, whose law is a sum of powers and sines.
"""

from core.elastic.follower import Elasticity, elasticity, kinematics_at_motion
from core.elastic.response import ResidualVibration, Response, Spectrum, spectrum

__all__ = ["Elasticity", "ResidualVibration", "Response", "Spectrum", "elasticity", "kinematics_at_motion", "spectrum"]
