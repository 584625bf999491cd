"""What a probe measures on the exact profile: its first contact on a line through the cam centre.

Contacts are bracketed and computed by Newton's method on the curve in closed form.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import pi
from types import MappingProxyType

import numpy as np

from core.design.fields import choice, length, number, whole
from core.frozen import frozen
from core.motion import EPS, TURN, Angles, CompiledMotion
from core.motion.extremes import piecewise_angles
from core.numerics.derivatives import cross, dot
from core.numerics.lazy import checkpoint
from core.output.files.profile_curve import CurveSamples, ExactCurve
from core.output.files.profile_request import flank_choice
from core.requests import option

# -- kinds of probes --------------------------------------------------------------------------------------------


AT_ONCE = 32_768  # directions that are measured together
PASSES = 70  # of the search for a contact: halving alone reaches the last bit in fewer
HALVINGS = 30  # of a section's end: the direction is stationary there, so an error counts by its square
SMALL = 1e-7  # [rad], steps that may be rounding
NEAR = 1e-9  # [rad], beyond a bracket: counts as its end
SLACK = 1e-12  # [rad], widening of the directions of a section, so that no direction is between two sections
STILL = 1e-12  # relative to the fastest rotation: slower counts as none


@frozen(eq=False)
class ProbePosition:
    """Positions of a probe in contact with n points of the profile, in the cam's frame.

    Attributes
    ----------
    heading : (n,) complex vectors whose direction is that of measurement at this contact
    rate : (n,) derivatives of ``heading`` by the profile's cam angle
    point : (n,) complex points of the probe, its centre or the contact of a flat face [mm]
    """

    heading: np.ndarray
    rate: np.ndarray
    point: np.ndarray

    @property
    def turning(self) -> np.ndarray:
        """Derivative of the direction by the profile's cam angle (n,), dimensionless."""
        return np.asarray(cross(self.heading, self.rate) / np.abs(self.heading) ** 2)


ProbeGuide = Callable[[Angles], ProbePosition]


def _round_guide(exact: ExactCurve, side: float, by: float) -> ProbeGuide:
    """The centre of a round probe runs along an offset curve of the profile; it is on the line of measurement."""

    def at(angles: Angles) -> ProbePosition:
        samples = exact(angles)
        point = samples.z + side * by * 1j * samples.tangent
        return ProbePosition(point, samples.speed * (1.0 - side * by * samples.curvature) * samples.tangent, point)

    return at


def _flat_guide(exact: ExactCurve, side: float, by: float) -> ProbeGuide:
    """A flat face is perpendicular to the line of measurement, which is parallel to the profile's normal."""

    def at(angles: Angles) -> ProbePosition:
        samples = exact(angles)
        normal = side * 1j * samples.tangent
        return ProbePosition(normal, 1j * samples.curvature * samples.speed * normal, samples.z + by * normal)

    return at


def _round_slope(point: np.ndarray, tangent: np.ndarray, line: np.ndarray) -> np.ndarray:
    """dR/dψ = R cot of the angle between the path's tangent and the line."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(dot(point, line) * dot(tangent, line) / cross(line, tangent))


def _flat_slope(point: np.ndarray, tangent: np.ndarray, line: np.ndarray) -> np.ndarray:
    """dh/dψ: distance of the contact on the face from the line."""
    return np.asarray(cross(line, point))


@frozen
class ProbeKind:
    """One row of ``PROBES``.

    Attributes
    ----------
    label : name of the probe
    radius : whether it has a radius
    flat : whether its face is perpendicular to the line of measurement
    guide : positions of the probe, from the exact profile, the side on which it runs (+1 left of the tangent), and the
        distance [mm] of its centre or face from the profile
    slope : derivative of the distance by the direction [mm/rad], from point, tangent and direction of the line
    """

    label: str
    radius: bool
    flat: bool
    guide: Callable[[ExactCurve, float, float], ProbeGuide]
    slope: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]


PROBES: Mapping[str, ProbeKind] = MappingProxyType(
    {
        "roller": ProbeKind("roller or ball", True, False, _round_guide, _round_slope),
        "flat": ProbeKind("flat face", False, True, _flat_guide, _flat_slope),
        "point": ProbeKind("point", False, False, _round_guide, _round_slope),
    }
)


# -- readings ---------------------------------------------------------------------------------------------------


@frozen(eq=False)
class Readings:
    """Readings of a probe in n directions.

    Attributes
    ----------
    distance : (n,) distance of the probe's centre or face from the cam centre along the direction [mm]
    slope : (n,) its derivative by the direction [mm/rad]
    contact : points of the profile in contact
    theta : (n,) cam angles of these points on the profile [rad]
    """

    distance: np.ndarray
    slope: np.ndarray
    contact: CurveSamples
    theta: np.ndarray


@frozen(eq=False)
class ProfileSections:
    """m sections of the profile; in each the direction of measurement rotates in one sense only.

    Attributes
    ----------
    low, high : (m,) cam angles of both ends on the profile [rad]
    piece : (m,) piece of the motion
    begin, end : (m,) directions at both ends, unwrapped [rad]
    """

    low: np.ndarray
    high: np.ndarray
    piece: np.ndarray
    begin: np.ndarray
    end: np.ndarray


def profile_sections(guide: ProbeGuide, motion: CompiledMotion) -> ProfileSections:
    """Sections of the profile between reversals of the direction of measurement.

    It reverses at inflections under a flat face, at cusps of the path of a round probe's centre, and where that path is
    tangent to the line of measurement.
    """
    angles = piecewise_angles(motion)
    angles = _insert(angles, _slowest(angles, guide(angles).turning))
    turning = guide(angles).turning
    turning = np.where(np.abs(turning) <= STILL * np.abs(turning).max(), 0.0, turning)
    same = angles.piece[1:] == angles.piece[:-1]
    reversals = np.flatnonzero((turning[1:] * turning[:-1] < 0.0) & same)
    if reversals.size:
        low, high, piece = angles.theta[reversals], angles.theta[reversals + 1], angles.piece[reversals]
        sign = np.sign(turning[reversals])
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            is_before = sign * guide(Angles(middle, piece)).turning > 0.0
            low, high = np.where(is_before, middle, low), np.where(is_before, high, middle)
        angles = _insert(angles, Angles(0.5 * (low + high), piece))
    direction = np.unwrap(np.angle(guide(angles).heading))
    first = np.flatnonzero(angles.piece[1:] == angles.piece[:-1])
    return ProfileSections(
        angles.theta[first], angles.theta[first + 1], angles.piece[first], direction[first], direction[first + 1]
    )


def _slowest(angles: Angles, turning: np.ndarray) -> Angles:
    """Angles of the least rotation between samples, by parabolas: the direction may reverse twice there, unseen."""
    theta, rotation = angles.theta, turning * np.sign(turning.sum())
    a, b, c = rotation[:-2], rotation[1:-1], rotation[2:]
    is_minimum = (angles.piece[2:] == angles.piece[:-2]) & (b <= a) & (b <= c) & (a + c > 2.0 * b) & (b > 0.0)
    rows = np.flatnonzero(is_minimum) + 1
    left, right = theta[rows] - theta[rows - 1], theta[rows + 1] - theta[rows]
    before, after = (rotation[rows] - rotation[rows - 1]) / left, (rotation[rows + 1] - rotation[rows]) / right
    curvature = (after - before) / (left + right)
    slope = before + curvature * left
    is_convex = curvature > 0.0
    move = np.clip(-slope[is_convex] / (2.0 * curvature[is_convex]), -left[is_convex], right[is_convex])
    return Angles(theta[rows][is_convex] + move, angles.piece[rows][is_convex])


def _insert(angles: Angles, added: Angles) -> Angles:
    """Both sets of angles in order of piece and angle."""
    theta, piece = np.append(angles.theta, added.theta), np.append(angles.piece, added.piece)
    order = np.lexsort((theta, piece))
    return Angles(theta[order], piece[order])


def probe_readings(
    kind: ProbeKind,
    guide: ProbeGuide,
    exact: ExactCurve,
    parts: ProfileSections,
    directions: np.ndarray,
    outward: float,
) -> Readings:
    """Readings of a probe at its first contact in given directions.

    Of all its positions on the line of measurement, the one farthest from the cam centre, or nearest on an inner wall.

    Parameters
    ----------
    kind : ProbeKind
    guide : ProbeGuide
    exact : ExactCurve
    parts : ProfileSections
    directions : ndarray (n,) [rad]
        Directions in the cam's frame.
    outward : float
        +1 for a probe outside of the profile, -1 inside of it.

    Returns
    -------
    Readings
        The distance is NaN where the line does not meet the profile.
    """
    blocks = [directions[i : i + AT_ONCE] for i in range(0, directions.size, AT_ONCE)]
    contacts = [_first_contact(guide, parts, np.exp(1j * block), np.mod(block, TURN), outward) for block in blocks]
    theta, piece, has_contact = (np.concatenate(part) for part in zip(*contacts, strict=True))
    at = Angles(theta, piece)
    contact, point, line = exact(at), guide(at).point, np.exp(1j * directions)
    distance = np.where(has_contact, dot(point, line), np.nan)
    return Readings(distance, kind.slope(point, contact.tangent, line), contact, theta)


def _first_contact(
    guide: ProbeGuide, parts: ProfileSections, line: np.ndarray, direction: np.ndarray, outward: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cam angle on the profile and piece (n,) of the first contact on each line (n,), and whether there is a contact."""
    checkpoint()
    rows, section = _lines_on_sections(parts, direction)
    theta = _contacts(guide, parts, line[rows], direction[rows], section)
    piece = parts.piece[section]
    reached = outward * dot(guide(Angles(theta, piece)).point, line[rows])
    order = np.lexsort((-reached, rows))
    which, first = np.unique(rows[order], return_index=True)
    best = order[first]
    has_contact = np.zeros(line.size, dtype=bool)
    has_contact[which] = True
    first_theta, first_piece = np.zeros(line.size), np.zeros(line.size, dtype=int)
    first_theta[which], first_piece[which] = theta[best], piece[best]
    return first_theta, first_piece, has_contact


def _lines_on_sections(parts: ProfileSections, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of a line, by its direction (n,) [rad] from 0 to 2π, and a section that it meets."""
    order = np.argsort(direction, kind="stable")
    turns = np.concatenate([direction[order] + turn for turn in (-TURN, 0.0, TURN)])
    low, high = np.minimum(parts.begin, parts.end), np.maximum(parts.begin, parts.end)
    back = TURN * np.floor(low / TURN)
    first = np.searchsorted(turns, low - back - SLACK, side="left")
    count = np.searchsorted(turns, high - back + SLACK, side="right") - first
    section = np.repeat(np.arange(count.size), count)
    index = np.arange(section.size) - np.repeat(np.cumsum(count) - count, count) + np.repeat(first, count)
    return order[index % order.size], section


def _contacts(
    guide: ProbeGuide, parts: ProfileSections, line: np.ndarray, direction: np.ndarray, section: np.ndarray
) -> np.ndarray:
    """Cam angles (k,) of contacts on lines (k,) within sections (k,).

    Newton's method, within brackets, on the sine of the angle between line and heading.
    """
    low, high, piece = parts.low[section].copy(), parts.high[section].copy(), parts.piece[section]
    begin, end = parts.begin[section], parts.end[section]
    sign = np.where(end >= begin, 1.0, -1.0)
    from_begin = np.remainder(direction - begin + pi, TURN) - pi
    share = np.clip(from_begin / np.where(end == begin, 1.0, end - begin), 0.0, 1.0)
    theta = low + share * (high - low)
    open_rows, last = np.arange(theta.size), np.full(theta.size, np.inf)
    for _ in range(PASSES):
        if not open_rows.size:
            break
        checkpoint()
        angle, position = theta[open_rows], guide(Angles(theta[open_rows], piece[open_rows]))
        error = sign[open_rows] * cross(line[open_rows], position.heading)
        slope = sign[open_rows] * cross(line[open_rows], position.rate)
        low[open_rows] = np.where(error <= 0.0, angle, low[open_rows])
        high[open_rows] = np.where(error >= 0.0, angle, high[open_rows])
        a, b = low[open_rows], high[open_rows]
        with np.errstate(divide="ignore", invalid="ignore"):
            new = angle - error / slope
        is_inside = (new >= a - NEAR) & (new <= b + NEAR)  # an end may be the contact
        new = np.where(is_inside, np.clip(new, a, b), 0.5 * (a + b))
        theta[open_rows] = new
        step = np.abs(new - angle)
        rounding = (step < SMALL) & (step > 0.75 * last[open_rows])  # near a stationary path no step improves it
        last[open_rows] = step
        open_rows = open_rows[(step > 2.0 * EPS * np.maximum(np.abs(angle), 1.0)) & ~rounding]
    return theta


# -- request ----------------------------------------------------------------------------------------------------


@frozen
class InspectionRequest:
    """Inspection of a cut cam.

    Attributes
    ----------
    probe : row of ``PROBES``; None for a contact like the follower's
    radius_mm : radius of a round probe; None for that of the follower
    tolerance_mm : ± tolerance normal to the profile
    samples : number of equally spaced cam angles in the table
    flank : name of one of the cam's flanks
    direction_deg : direction of the probe from the cam centre in the global frame; None for the follower's, else 90
    """

    probe: str | None = option(
        choice("Probe", tuple(PROBES), default=None, help="shape of the probe in contact with the cam"),
        default_text="the same as the follower",
        words={name: row.label.capitalize() for name, row in PROBES.items()},
    )
    radius_mm: float | None = option(
        length("Radius", default=None, help="of a roller or ball"), default_text="that of the follower"
    )
    tolerance_mm: float = number("Tolerance", 0.0, 1e9, default=0.02, help="half the band, normal to the profile")
    samples: int = whole("Cam angles", 4, 1_000_000, default=360, help="equally spaced cam angles")
    flank: str = flank_choice()
    direction_deg: float | None = option(
        number(
            "Direction",
            default=None,
            help="from the cam centre to the probe, counter-clockwise from the x axis",
        ),
        default_text="that of the follower, else 90",
    )
