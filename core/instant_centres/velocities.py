"""Velocity ratios by instant centres: angular velocities with directed distances, mechanical advantage (Velocity, 6.4)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from core.frozen import frozen
from core.instant_centres.centre import Centres
from core.instant_centres.linkage import CentreTable, Key
from core.mechanism.kinematics import FRAME


def angular_ratio(table: CentreTable, body: str, driver: str) -> np.ndarray:
    """ω_body/ω_driver = I_1d I_db / I_1b I_db, distances directed along the line of the three centres (n,).

    A centre of the body on the frame at infinity gives 0: it does not turn. NaN where the three coincide.
    """
    return ratio_arms(table, body, driver).ratio


def mechanical_advantage(table: CentreTable, output: str, driver: str) -> np.ndarray:
    """Torque at the output for a torque of 1 at the driver, without losses: ω_driver/ω_output (n,)."""
    with np.errstate(divide="ignore"):
        return 1.0 / angular_ratio(table, output, driver)


@frozen(eq=False)
class RatioArms:
    """Two distances on one line whose quotient is a velocity ratio: both bodies have one velocity at their common centre.

    body, base             the ratio is ω_body/ω_base
    other, own, common     the keys of I_1base, I_1body and I_base,body
    base_arm               (n,) I_1base I_base,body [m], never negative
    body_arm               (n,) I_1body I_base,body [m], negative where it points the other way; infinite where the body
                           does not turn: its velocity is then ω_base · base_arm
    ratio                  (n,)
    """

    body: str
    base: str
    other: Key
    own: Key
    common: Key
    base_arm: np.ndarray
    body_arm: np.ndarray
    ratio: np.ndarray


def ratio_arms(table: CentreTable, body: str, base: str) -> RatioArms:
    """The distances by which a body's angular velocity follows from that of another moving body."""
    keys = table.key(FRAME, base), table.key(FRAME, body), table.key(base, body)
    other, own, common = (table.centres[key] for key in keys)
    to_base, to_body = _arm(common, other), _arm(common, own)
    # the three lie on one line: along the longer of the two arms
    along = np.where(np.abs(to_base) > np.abs(to_body), to_base, to_body)
    with np.errstate(divide="ignore", invalid="ignore"):
        above, below = (to_base * along.conjugate()).real, (to_body * along.conjugate()).real
        ratio = np.asarray(own.weight * above / (other.weight * below)) + 0.0
        base_arm = np.abs(to_base / (common.weight * other.weight))
        body_arm = np.abs(to_body / (common.weight * own.weight))
        body_arm = np.where(own.far(table.size), np.inf, np.where(ratio < 0.0, -body_arm, body_arm))
    return RatioArms(body, base, *keys, base_arm, body_arm, ratio)


def _arm(common: Centres, held: Centres) -> np.ndarray:
    """From one centre to another, times both weights (n,)."""
    return np.asarray(common.point * held.weight - held.point * common.weight)


# -- which bodies are compared --------------------------------------------------------------------------------


def to_driver(table: CentreTable, driver: str) -> tuple[tuple[str, str], ...]:
    """Every moving body with the driver."""
    return tuple((body, driver) for body in table.bodies if body not in (FRAME, driver))


def link_by_link(table: CentreTable, driver: str) -> tuple[tuple[str, str], ...]:
    """Every moving body with the one on whose pin it hangs, from the driver outwards, as the lecture goes through its
    six-bar; with the driver where no pin joins it to a body before it."""
    reached, found = [driver], []
    waiting = [body for body in table.bodies if body not in (FRAME, driver)]
    while waiting:
        pinned = ((body, base) for base in reached for body in waiting if _pinned(table, body, base))
        body, base = next(pinned, (waiting[0], driver))
        found.append((body, base))
        reached.append(body)
        waiting.remove(body)
    return tuple(found)


def _pinned(table: CentreTable, a: str, b: str) -> bool:
    key = table.key(a, b)
    return key in table.primary and bool((table.centres[key].weight != 0.0).all())


CHAINS: Mapping[str, Callable[[CentreTable, str], tuple[tuple[str, str], ...]]] = MappingProxyType(
    {"ratios": to_driver, "chain": link_by_link}
)
"""Which body is compared with which: each with the driver, or from link to link."""
