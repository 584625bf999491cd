"""Linkages from dyads: a four-bar, a slider-crank or an inverted slider-crank, drawn at one position of its body."""

from __future__ import annotations

import cmath
from collections.abc import Callable
from math import degrees, pi
from types import MappingProxyType

import numpy as np

from core.design import CRANK, Design, Drawn, Drive, Driver, Link, Linkage, LinkageLoads, LinkPoint, Slider
from core.frozen import frozen
from core.mechanism.kinematics import Kinematics
from core.synthesis.dyads import GUIDE, PIN, TURNING_GUIDE, Dyad

FOUR_BAR, SLIDER_CRANK, INVERTED = "four-bar", "slider-crank", "inverted-slider-crank"
KINDS = MappingProxyType({PIN: FOUR_BAR, GUIDE: SLIDER_CRANK, TURNING_GUIDE: INVERTED})
"""Kind of the dyad next to the driver -> kind of the linkage; the driver's dyad has two pins."""
SPEED = 60.0
"""Speed of the driver of a new linkage [rpm]."""
FRAME, CRANK_LINK, COUPLER, SIDE_LINK = 1, 2, 3, 4
CRANK_PIVOT, CRANK_PIN, SIDE_PIN, SIDE_PIVOT, TRACER = "O2", "A", "B", "O4", "P"

Errors = Callable[[Kinematics], tuple[np.ndarray, np.ndarray]]
"""Kinematics (n,) at the driver positions of the task -> errors (n,) [mm] and (n,) [deg]."""


@frozen(eq=False)
class Candidate:
    """A linkage proposed for a task.

    Attributes
    ----------
    linkage : Linkage
        Link 1 is the frame, 2 the driver, 3 the coupler; drawn at a position of the task.
    kind : str
        One of ``KINDS``.
    positions : ndarray (n,) [rad]
        Driver angles of the task's positions, in their order.
    errors : callable
        Deviations from the task at these angles.
    expected : float
        Largest error with which it was proposed [mm].
    """

    linkage: Linkage
    kind: str
    positions: np.ndarray
    errors: Errors
    expected: float = 0.0

    @property
    def design(self) -> Design:
        """The linkage as a design."""
        drive = Drive(None, self.linkage, None, LinkageLoads())
        return Design(self.kind.capitalize(), None, (drive,))


def linkage_of(first: Dyad, second: Dyad, z: complex, angle: float, *, tracer: bool = True) -> Linkage:
    """Linkage of two dyads, the first one with two pins and driving, drawn at a position of the body.

    Parameters
    ----------
    first, second : Dyad
    z : complex
        Origin of the body [mm].
    angle : float
        Angle of the body [rad]; link 3 has its frame.
    tracer : bool
        Give link 3 a point P at its origin.

    Returns
    -------
    Linkage
    """
    turn = cmath.rect(1.0, angle)
    crank_pin = z + first.moving * turn
    crank = crank_pin - first.fixed
    frame, coupler = {CRANK_PIVOT: first.fixed}, {CRANK_PIN: first.moving}
    side: dict[str, complex] = {}
    drawn = {CRANK_PIN: crank_pin}
    sliders: tuple[Slider, ...] = ()
    if second.kind == TURNING_GUIDE:
        frame[SIDE_PIVOT], side[SIDE_PIVOT] = second.fixed, 0j
        sliders = (_slider(COUPLER, second.moving, second.line),)
    else:
        coupler[SIDE_PIN] = second.moving
        drawn[SIDE_PIN] = z + second.moving * turn
        if second.kind == PIN:
            frame[SIDE_PIVOT], side[SIDE_PIVOT] = second.fixed, 0j
            side[SIDE_PIN] = complex(abs(drawn[SIDE_PIN] - second.fixed))
        else:
            side[SIDE_PIN] = 0j
            sliders = (_slider(FRAME, second.fixed, second.line),)
    if tracer:
        coupler[TRACER], drawn[TRACER] = 0j, z
    links = (
        link_with(FRAME, frame),
        link_with(CRANK_LINK, {CRANK_PIVOT: 0j, CRANK_PIN: complex(abs(crank))}),
        link_with(COUPLER, coupler),
        link_with(SIDE_LINK, side),
    )
    pose = Drawn(degrees(cmath.phase(crank)), None, _points(drawn))
    return Linkage(links, sliders, Driver(CRANK_LINK, CRANK, SPEED), drawn=pose)


def _slider(on: int, through: complex, direction: float) -> Slider:
    return Slider(
        link=SIDE_LINK, on=on, through_x_mm=through.real, through_y_mm=through.imag, angle_deg=degrees(direction)
    )


def link_with(number: int, places: dict[str, complex]) -> Link:
    """Link with named points in its frame [mm]."""
    return Link(number, _points(places))


def _points(places: dict[str, complex]) -> tuple[LinkPoint, ...]:
    return tuple(LinkPoint(name, z.real, z.imag) for name, z in places.items())


def driver_angles(first: Dyad, z: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Angles of the driver at positions of the body.

    Parameters
    ----------
    first : Dyad
        With two pins.
    z : ndarray (n,) complex [mm]
        Origins of the body.
    turn : ndarray (n,) complex, dimensionless
        Unit vectors of its x axis.

    Returns
    -------
    ndarray (n,) [rad]
    """
    return np.angle(z + first.moving * turn - first.fixed)


def is_in_order(angles: np.ndarray) -> bool:
    """Whether angles are in their order around the circle, in either direction.

    Parameters
    ----------
    angles : ndarray (n,) [rad]
    """
    steps = np.diff(np.append(angles, angles[0]))
    return any(round(float(np.mod(sign * steps, 2.0 * pi).sum() / (2.0 * pi))) == 1 for sign in (1.0, -1.0))


def is_degenerate(first: Dyad, second: Dyad, size: float) -> bool:
    """Whether two dyads are one, or have a link without length."""
    tiny = 1e-6 * size
    if second.kind == PIN:
        return abs(first.fixed - second.fixed) <= tiny or abs(first.moving - second.moving) <= tiny
    if second.kind == GUIDE:
        return abs(first.moving - second.moving) <= tiny
    return abs(first.fixed - second.fixed) <= tiny
