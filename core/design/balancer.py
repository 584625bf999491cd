"""A balance cam: it loads and frees a spring so that what is left of the shaft's torque is its mean."""

from __future__ import annotations

from core.design.fields import length, number
from core.frozen import frozen


@frozen(kw_only=True)
class Balancer:
    """A translating roller follower on a spring; its motion follows from the torque that it balances, at the shaft's speed.

    The motion begins at 0, where the spring has its preload; the follower's weight counts as preload.
    """

    spring_rate_n_per_mm: float = number("Spring rate", 0.0, help="a softer spring makes a longer stroke")
    preload_n: float = number(
        "Spring preload", 0.0, open_low=True, help="where the motion is 0; with none the cam would have a kink there"
    )
    follower_mass_kg: float = number("Follower mass", 0.0, default=0.0, help="with its roller")
    phase_deg: float = number("Phase", -360.0, 360.0, default=0.0, help="machine angle at the cam's zero mark")
    base_radius_mm: float = length("Base radius Br", help="smallest radius of the cam where the motion is 0")
    roller_radius_mm: float = length("Roller radius Rr")
