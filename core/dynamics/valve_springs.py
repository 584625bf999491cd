"""Helical springs that close a valve: rate and forces, stress, fatigue, natural frequency, and surge.

Sources: Shigley's *Mechanical Engineering Design*, ch. 10 (rate, Bergsträsser's factor, Zimmerli's limits); the wave in the spring is
that of a rod with one fixed end and one moved end (Marti, NACA TM 818).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, pi, sqrt

import numpy as np

from core.design import ValveSpring, si
from core.frozen import frozen

HARMONICS = 100
"""Harmonics of the valve's lift of which the surge consists."""
ZIMMERLI = {False: (241e6, 379e6), True: (398e6, 534e6)}
"""Whether shot-peened -> amplitude and mean of the shear stress [Pa] that a spring endures without end."""
SHEAR_PART = 0.67  # shear strength over tensile strength


@frozen
class HelicalSpring:
    """A valve spring in SI units.

    Attributes
    ----------
    rate : k = G d⁴/(8 D³ n) [N/m]
    preload : force of the closed valve [N]
    room : travel from the installed length to the solid one [m]
    active_mass : ρ π² d² D n/4 [kg]
    wire, coil : diameter d of the wire and mean diameter D of the coil [m]
    damping_ratio : of the first mode of surge
    shear_strength : 0.67 times the tensile strength [Pa]; None where that is not given
    peened : whether it is shot-peened
    """

    rate: float
    preload: float
    room: float
    active_mass: float
    wire: float
    coil: float
    damping_ratio: float
    shear_strength: float | None
    peened: bool

    @property
    def curvature_factor(self) -> float:
        """Bergsträsser's factor K = (4C + 2)/(4C - 3), C = D/d."""
        index = self.coil / self.wire
        return (4.0 * index + 2.0) / (4.0 * index - 3.0)

    @property
    def stress_per_force(self) -> float:
        """Corrected shear stress of one newton, K 8D/(π d³) [1/m²]."""
        return self.curvature_factor * 8.0 * self.coil / (pi * self.wire**3)

    @property
    def natural(self) -> float:
        """First natural frequency ω₁ = π √(k/m) of the spring between fixed ends [rad/s]."""
        return pi * sqrt(self.rate / self.active_mass)

    def force(self, lift: float) -> float:
        """Static force [N] at a lift of the valve [m]."""
        return self.preload + self.rate * lift

    def stress(self, lift: float) -> float:
        """Corrected shear stress [Pa] at a lift of the valve [m]."""
        return self.stress_per_force * self.force(lift)

    def safety(self, lift: float) -> float | None:
        """Goodman's safety n from 1/n = τ_a/S_e + τ_m/S_su up to a lift [m], S_e = S_a/(1 - S_m/S_su); None without strength."""
        if self.shear_strength is None:
            return None
        amplitude, mean = ZIMMERLI[self.peened]
        if self.shear_strength <= mean:
            return 0.0
        endurance = amplitude / (1.0 - mean / self.shear_strength)
        seat, top = self.stress(0.0), self.stress(lift)
        used = 0.5 * (top - seat) / endurance + 0.5 * (top + seat) / self.shear_strength
        return 1.0 / used if used > 0.0 else inf


def helical_spring(row: ValveSpring) -> HelicalSpring:
    """Valve spring as typed, in SI units."""
    s = si(row)
    rate = s.shear_modulus * s.wire**4 / (8.0 * s.coil**3 * row.active_coils)
    return HelicalSpring(
        rate=rate,
        preload=rate * (s.free - s.installed),
        room=s.installed - row.total_coils * s.wire,
        active_mass=0.25 * s.density * pi**2 * s.wire**2 * s.coil * row.active_coils,
        wire=s.wire,
        coil=s.coil,
        damping_ratio=row.damping_ratio,
        shear_strength=None if row.tensile_mpa is None else SHEAR_PART * s.tensile,
        peened=row.peened,
    )


def helical_springs(loads: object) -> tuple[HelicalSpring, ...]:
    """Valve springs of any loads; empty where they have none."""
    return tuple(helical_spring(row) for row in getattr(loads, "valve_springs", ()))


def surge_harmonics(springs: Sequence[HelicalSpring], lift: np.ndarray, omega: float) -> np.ndarray:
    """Harmonics of the force of springs above their preload, k c_n z_n cot z_n, z_n = π (n ω/ω₁) √(1 - 2i ζ ω₁/(n ω)).

    They are those of the periodic solution of u_tt + 2ζω₁ u_t = c² u_xx with one end fixed and the other moved by the lift
    Σ c_n e^{inθ}, so that the force contains the inertia of the spring.

    Parameters
    ----------
    springs : sequence of HelicalSpring
    lift : ndarray (n,) complex [m]
        Harmonics c_0, c_1, … of the valve's lift by cam angle.
    omega : float
        Speed of the camshaft ω [rad/s], positive.

    Returns
    -------
    ndarray (n,) complex [N]
    """
    speed = omega * np.arange(1, lift.size)
    force = np.zeros(lift.size, dtype=complex)
    for spring in springs:
        z = pi * speed / spring.natural * np.sqrt(1.0 - 2j * spring.damping_ratio * spring.natural / speed)
        force += spring.rate * lift * np.concatenate(([1.0], z / np.tan(z)))
    return force


def periodic_sum(harmonics: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """Real periodic function of harmonics, Σ c_n e^{inθ} with the conjugates of the negative ones.

    Parameters
    ----------
    harmonics : ndarray (m,) complex [any unit]
        c_0, c_1, …
    theta : ndarray (n,) [rad]

    Returns
    -------
    ndarray (n,) [the same]
    """
    turn = np.exp(1j * np.asarray(theta))
    total = np.full(turn.shape, harmonics[-1])
    for coefficient in harmonics[-2:0:-1]:  # Horner
        total = total * turn + coefficient
    return np.asarray(harmonics[0].real + 2.0 * (total * turn).real)
