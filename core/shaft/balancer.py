"""A balance cam on a spring: the motion whose spring gives what the shaft's torque lacks of its mean, and takes what it has above.

With W(θ) = ∫(T - T̄)dθ, spring rate K and preload F0 the spring's energy F0 x + ½K x² = E0 - W, E0 the greatest W, so that the
motion begins at x = 0:

    x = 2(E0 - W)/(F0 + √(F0² + 2K(E0 - W))),   x' = -(T - T̄)/(F0 + Kx),   x'' = -(T' + Kx'²)/(F0 + Kx).

The torque of this follower is (F0 + Kx)x' = -(T - T̄). It balances one speed. With a mass its kinetic energy joins the spring's: see
``follower_mass``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from core.design import (
    Balancer,
    ComputedCurve,
    Design,
    Drive,
    Motion,
    RollerCam,
    Segment,
    Translating,
    TranslatingLoads,
    si,
)
from core.errors import NoAnswer
from core.laws import Piece, moved
from core.motion import TURN
from core.shaft.curve import NODES, LoadCurve, nodes, polyval, to_powers
from core.shaft.energy import energy_range, highest_at, unbalanced
from core.shaft.follower_mass import Energy, Panels, heavy_panels

JUMP = 1e-9  # of the torque's swing: more from one panel to the next is a jump
RESOLVED = 1e-12  # of the torque's swing: what the last coefficients of a panel may add to it
HALVINGS = 30
LEAST_PRELOAD = 1e-5  # of the spring's greatest force: with less the motion turns as sharply as at a kink
LEAST_SWING = 1e-12  # of the torque's size: less is rounding, and nothing to be balanced
MM = 1e3


def balance_drive(load: LoadCurve, balancer: Balancer, omega: float) -> Drive:
    """The balance cam as a drive of its own, whose cam angle is the machine angle less the balancer's phase.

    load: what is to be balanced at the speed omega [rad/s]. Raises NoAnswer where the torque jumps, or nothing follows it.
    """
    (found,) = balance_drives(load, [balancer], omega)
    if isinstance(found, NoAnswer):
        raise found
    return found


def balance_drives(load: LoadCurve, balancers: Sequence[Balancer], omega: float) -> list[Drive | NoAnswer]:
    """The same of many balance cams of one load; those with a mass on their followers, or none of them. In place of one that has no
    answer why it has none. Raises NoAnswer where the torque jumps."""
    _require_smooth(load)
    energy, found = _energy(load), [_too_slack(load, each) for each in balancers]
    good = [each for each, fault in zip(balancers, found, strict=True) if fault is None]
    heavy = bool(good) and bool(good[0].follower_mass_kg)
    made = iter(heavy_panels(energy, good, omega) if heavy else [_panels(energy, each) for each in good])
    return [fault or _drive(each, next(made)) for each, fault in zip(balancers, found, strict=True)]


def _drive(balancer: Balancer, panels: Panels | NoAnswer) -> Drive | NoAnswer:
    if isinstance(panels, NoAnswer):
        return panels
    loads = TranslatingLoads(
        spring_rate_n_per_mm=balancer.spring_rate_n_per_mm,
        preload_n=balancer.preload_n,
        gravity_m_s2=0.0,
        follower_mass_kg=balancer.follower_mass_kg,
    )
    cam = RollerCam(base_radius_mm=balancer.base_radius_mm, roller_radius_mm=balancer.roller_radius_mm)
    return Drive(motion=_motion_of(balancer, *panels), mechanism=Translating(), cam=cam, loads=loads)


def _motion_of(balancer: Balancer, start: np.ndarray, width: np.ndarray, coefficients: np.ndarray) -> Motion:
    """The motion [mm] by the cam's own angle: pieces of which x'' is fitted and x and x' are its integrals, so that the torque that
    it leaves is rounding."""
    pieces = _by_own_angle(start, width, MM * coefficients, np.deg2rad(balancer.phase_deg) % TURN)
    first = pieces[0].polynomial[0]
    shifted = tuple(Piece(p.start, (p.polynomial[0] - first, *p.polynomial[1:])) for p in pieces)
    return Motion(first, (Segment(360.0, 0.0, ComputedCurve(shifted)),))


def _require_smooth(load: LoadCurve) -> None:
    """Raises NoAnswer where the torque jumps: the motion would have a corner there."""
    ends, swing = load.torque.sum(axis=0), _swing(load)
    jump = np.roll(load.torque[0], -1) - ends
    jumps = np.abs(jump) > JUMP * swing
    if jumps.any():
        worst = int(np.argmax(np.abs(jump)))
        angles = np.sort(np.rad2deg((load.start + load.width)[jumps] % TURN))
        raise NoAnswer(
            f"the torque that it balances jumps, by up to {abs(float(jump[worst])):.6g} N m,",
            "balancer",
            "smooth the motions there, so that no acceleration jumps",
            [(float(a), float(a)) for a in angles],
        )


def _too_slack(load: LoadCurve, balancer: Balancer) -> NoAnswer | None:
    """What stands against its preload."""
    s = si(balancer)
    low, high = energy_range(load)
    least = LEAST_PRELOAD * np.sqrt(2.0 * s.spring_rate * (high - low))
    if s.preload >= least:
        return None
    angle = float(np.rad2deg(highest_at(load)))
    return NoAnswer(
        f"with {balancer.preload_n:g} N its spring is slack where the motion is least, and the motion has a kink there,",
        "balancer.preload_n",
        f"enlarge it, to {least:.3g} N at least",
        [(angle, angle)],
    )


def _swing(load: LoadCurve) -> float:
    """How far the torque goes from its mean [N m]; at least what rounding makes of it."""
    x, _ = nodes()
    values = polyval(x, unbalanced(load)[:, :, None])
    return float(max(np.abs(values).max(), LEAST_SWING * np.abs(load.mean)))


def _energy(load: LoadCurve) -> Energy:
    torque = unbalanced(load)
    orders = np.arange(1, NODES + 1)[:, None]
    given = load.width * torque / orders
    gained = given.sum(axis=0)
    _, highest = energy_range(load)
    begins = highest - np.concatenate(([0.0], np.cumsum(gained)[:-1]))
    return Energy(
        load.start, load.width, np.vstack((begins, -given)), torque, orders[:-1] * torque[1:] / load.width, _swing(load)
    )


def _panels(energy: Energy, balancer: Balancer) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Start, width (m,) [rad] and coefficients (NODES + 2, m) of r**k, of x [m]: the load's panels, halved where that takes more."""
    x, to_chebyshev = nodes()
    parent, low, share = np.arange(energy.start.size), np.zeros(energy.start.size), np.ones(energy.start.size)
    done: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
    for left in range(HALVINGS, -1, -1):
        width = share * energy.width[parent]
        _, _, bend, force = _motion(
            energy, balancer, np.repeat(parent, NODES), (low[:, None] + share[:, None] * x).ravel()
        )
        chebyshev = to_chebyshev @ bend.reshape(-1, NODES).T
        last = np.abs(chebyshev[-2:]).sum(axis=0) * width * force.reshape(-1, NODES).max(axis=1)
        fine = (last <= RESOLVED * energy.swing) | (left == 0)
        place, rate, _, _ = _motion(energy, balancer, parent[fine], low[fine])
        done.append(_integrated(energy, parent[fine], low[fine], width[fine], chebyshev[:, fine], place, rate))
        if fine.all():
            break
        parent, share = np.repeat(parent[~fine], 2), np.repeat(0.5 * share[~fine], 2)
        low = np.repeat(low[~fine], 2)
        low[1::2] += share[1::2]
    start, width = np.concatenate([part[0] for part in done]), np.concatenate([part[1] for part in done])
    order = np.argsort(start)
    return start[order], width[order], np.concatenate([part[2] for part in done], axis=1)[:, order]


def _integrated(
    energy: Energy,
    parent: np.ndarray,
    low: np.ndarray,
    width: np.ndarray,
    chebyshev: np.ndarray,
    place: np.ndarray,
    rate: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Start, width and coefficients of x, from the Chebyshev coefficients of x'', and x and x' where a panel begins."""
    bend = to_powers(NODES) @ chebyshev
    k = np.arange(NODES)[:, None]
    return (
        energy.start[parent] + low * energy.width[parent],
        width,
        np.vstack((place, width * rate, width**2 * bend / ((k + 1) * (k + 2)))),
    )


def _motion(energy: Energy, balancer: Balancer, panel: np.ndarray, r: np.ndarray) -> tuple[np.ndarray, ...]:
    """x [m], x', x'' and the spring's force [N] (n,) at places r of the load's panels."""
    s = si(balancer)
    stored = np.maximum(polyval(r, energy.energy[:, panel]), 0.0)
    torque, slope = (polyval(r, row[:, panel]) for row in (energy.torque, energy.slope))
    force = np.sqrt(s.preload**2 + 2.0 * s.spring_rate * stored)
    rate = -torque / force
    return 2.0 * stored / (s.preload + force), rate, -(slope + s.spring_rate * rate**2) / force, force


def _by_own_angle(start: np.ndarray, width: np.ndarray, coefficients: np.ndarray, phase: float) -> list[Piece]:
    """Pieces over u = 0 ... 1 of the cam's own turn, which begins at the machine angle ``phase``."""
    cut = int(np.searchsorted(start, phase, side="right")) - 1
    rows = [(float(a), float(h), c) for a, h, c in zip(start - phase, width, coefficients.T, strict=True)]
    begins, wide, row = rows[cut]
    ahead, tail = rows[cut + 1 :], [(a + TURN, h, c) for a, h, c in rows[:cut]]
    if begins < 0.0:
        tail.append((begins + TURN, wide, row))
        row = np.array(moved(row.tolist(), -begins / wide))
        begins = 0.0
    pieces = []
    for a, h, c in [(begins, wide, row), *ahead, *tail]:
        pieces.append(Piece(a / TURN, tuple((c * (TURN / h) ** np.arange(c.size)).tolist())))
    return pieces


FIRST_STROKE = 0.1  # [m] of a balance cam to begin with
SHARE = 0.25  # of the energy that its preload takes


def with_balancer(design: Design, energy_swing: float) -> Design:
    """The design with a balance cam to begin with, marked as assumed; energy_swing [J] of its torque."""
    marks = tuple(
        f"balancer.{key}" for key in ("spring_rate_n_per_mm", "preload_n", "base_radius_mm", "roller_radius_mm")
    )
    return replace(design, balancer=first_balancer(energy_swing), assumed=(*design.assumed, *marks))


def first_balancer(energy_swing: float) -> Balancer:
    """A balance cam to begin with, whose follower runs 100 mm for so much energy [J]: F0 s + ½ k s² = ΔE. All of it is to be changed."""
    work = max(energy_swing, 1.0)
    rate, preload = 2.0 * (1.0 - SHARE) * work / FIRST_STROKE**2, SHARE * work / FIRST_STROKE
    return Balancer(
        spring_rate_n_per_mm=float(f"{rate / 1e3:.3g}"),
        preload_n=float(f"{preload:.3g}"),
        base_radius_mm=200.0,
        roller_radius_mm=50.0,
    )
