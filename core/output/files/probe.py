"""What a probe measures on the exact profile: where it touches first on its line through the cam centre, by brackets and Newton's
method on the curve in closed form."""

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
from core.output.files.profile_curve import CurveSamples, Exact
from core.output.files.profile_request import flank_choice
from core.requests import option

# -- what a probe measures on the exact profile -----------------------------------------------------------------


AT_ONCE = 32_768  # directions that are measured together
PASSES = 70  # of the search for a contact: halving alone comes to the last bit in fewer
HALVINGS = 30  # of a stretch's end: the direction stands still there, an error counts by its square
SMALL = 1e-7  # [rad], steps that may be rounding
NEAR = 1e-9  # [rad], beyond a bracket: its end is meant
SLACK = 1e-12  # [rad], by which the directions of a stretch are widened: none falls between two
STILL = 1e-12  # of the fastest turning: slower is none


@frozen(eq=False)
class ProbePlace:
    """A place of the profile as the probe sees it.

    along     (n,) complex, its direction is that of measurement when the probe touches there
    rate      (n,) complex, its derivative by the profile's own cam angle
    place     (n,) complex [mm], of the probe: its centre, or the point that the flat face touches
    """

    along: np.ndarray
    rate: np.ndarray
    place: np.ndarray

    @property
    def turning(self) -> np.ndarray:
        """(n,), how fast the direction turns."""
        return np.asarray(cross(self.along, self.rate) / np.abs(self.along) ** 2)


Guide = Callable[[Angles], ProbePlace]


def _round_guide(exact: Exact, side: float, by: float) -> Guide:
    """Its centre runs along the curve beside the profile, and stands on the line of measurement."""

    def at(angles: Angles) -> ProbePlace:
        there = exact(angles)
        place = there.z + side * by * 1j * there.tangent
        return ProbePlace(place, there.speed * (1.0 - side * by * there.curvature) * there.tangent, place)

    return at


def _flat_guide(exact: Exact, side: float, by: float) -> Guide:
    """Its face stands across the line of measurement: the profile's normal along it."""

    def at(angles: Angles) -> ProbePlace:
        there = exact(angles)
        normal = side * 1j * there.tangent
        return ProbePlace(normal, 1j * there.curvature * there.speed * normal, there.z + by * normal)

    return at


def _round_slope(place: np.ndarray, tangent: np.ndarray, line: np.ndarray) -> np.ndarray:
    """dR/dψ = R cot of the angle between the path's tangent and the line."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(dot(place, line) * dot(tangent, line) / cross(line, tangent))


def _flat_slope(place: np.ndarray, tangent: np.ndarray, line: np.ndarray) -> np.ndarray:
    """dh/dψ = how far beside the line the face is touched."""
    return np.asarray(cross(line, place))


@frozen
class ProbeKind:
    """One row of ``PROBES``.

    label   what it is called
    radius  whether one belongs to it
    flat    whether it lies across the line of measurement
    guide   of the exact profile, the side on which the probe runs (+1 left of its tangent), and how far beside it [mm] its
            centre or face stands
    slope   of the distance by the direction [mm/rad], from place, tangent and direction of the line
    """

    label: str
    radius: bool
    flat: bool
    guide: Callable[[Exact, float, float], Guide]
    slope: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]


PROBES: Mapping[str, ProbeKind] = MappingProxyType(
    {
        "roller": ProbeKind("roller or ball", True, False, _round_guide, _round_slope),
        "flat": ProbeKind("flat face", False, True, _flat_guide, _flat_slope),
        "point": ProbeKind("point", False, False, _round_guide, _round_slope),
    }
)


@frozen(eq=False)
class Readings:
    """What a probe measures in n directions.

    distance  (n,) [mm] from the cam centre along the direction, of the probe's centre or face
    slope     (n,) [mm/rad] of it by the direction
    contact   the profile at the places that it touches, and their own cam angles (n,) [rad]
    theta     (n,)
    """

    distance: np.ndarray
    slope: np.ndarray
    contact: CurveSamples
    theta: np.ndarray


@frozen(eq=False)
class Stretches:
    """m stretches of the profile, in each of which the direction turns one way only.

    low, high    (m,) own cam angles [rad];  piece (m,) of the motion
    begin, end   (m,) directions there [rad], running on
    """

    low: np.ndarray
    high: np.ndarray
    piece: np.ndarray
    begin: np.ndarray
    end: np.ndarray


def stretches(guide: Guide, program: CompiledMotion) -> Stretches:
    """The profile cut where the direction turns round: at inflections under a flat face, at cusps of the path of a round probe's
    centre, and where that path runs along the line of measurement."""
    angles = piecewise_angles(program)
    angles = _with(angles, _between(angles, guide(angles).turning))
    turning = guide(angles).turning
    turning = np.where(np.abs(turning) <= STILL * np.abs(turning).max(), 0.0, turning)
    same = angles.piece[1:] == angles.piece[:-1]
    ends = np.flatnonzero((turning[1:] * turning[:-1] < 0.0) & same)
    if ends.size:
        low, high, piece = angles.theta[ends], angles.theta[ends + 1], angles.piece[ends]
        sign = np.sign(turning[ends])
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            before = sign * guide(Angles(middle, piece)).turning > 0.0
            low, high = np.where(before, middle, low), np.where(before, high, middle)
        angles = _with(angles, Angles(0.5 * (low + high), piece))
    direction = np.unwrap(np.angle(guide(angles).along))
    first = np.flatnonzero(angles.piece[1:] == angles.piece[:-1])
    return Stretches(
        angles.theta[first], angles.theta[first + 1], angles.piece[first], direction[first], direction[first + 1]
    )


def _between(angles: Angles, turning: np.ndarray) -> Angles:
    """Vertices of the parabolas through three neighbours each where the slowest turning stands between samples: there it may turn
    round and back unseen."""
    theta, way = angles.theta, turning * np.sign(turning.sum())
    a, b, c = way[:-2], way[1:-1], way[2:]
    whole = (angles.piece[2:] == angles.piece[:-2]) & (b <= a) & (b <= c) & (a + c > 2.0 * b) & (b > 0.0)
    rows = np.flatnonzero(whole) + 1
    left, right = theta[rows] - theta[rows - 1], theta[rows + 1] - theta[rows]
    before, after = (way[rows] - way[rows - 1]) / left, (way[rows + 1] - way[rows]) / right
    bend = (after - before) / (left + right)
    slope = before + bend * left
    keep = bend > 0.0
    move = np.clip(-slope[keep] / (2.0 * bend[keep]), -left[keep], right[keep])
    return Angles(theta[rows][keep] + move, angles.piece[rows][keep])


def _with(angles: Angles, more: Angles) -> Angles:
    theta, piece = np.append(angles.theta, more.theta), np.append(angles.piece, more.piece)
    order = np.lexsort((theta, piece))
    return Angles(theta[order], piece[order])


def readings(
    kind: ProbeKind, guide: Guide, exact: Exact, parts: Stretches, directions: np.ndarray, outward: float
) -> Readings:
    """Where the probe touches first in each direction (n,) [rad], from outside (outward +1), or from inside (-1).

    Of all places of its path on the line of measurement the farthest from the cam centre, or the nearest: any other is reached
    through the profile only. Where there is none the distance is NaN.
    """
    blocks = [directions[i : i + AT_ONCE] for i in range(0, directions.size, AT_ONCE)]
    found = [_touched(guide, parts, np.exp(1j * block), np.mod(block, TURN), outward) for block in blocks]
    theta, piece, known = (np.concatenate(each) for each in zip(*found, strict=True))
    at = Angles(theta, piece)
    contact, place, line = exact(at), guide(at).place, np.exp(1j * directions)
    distance = np.where(known, dot(place, line), np.nan)
    return Readings(distance, kind.slope(place, contact.tangent, line), contact, theta)


def _touched(
    guide: Guide, parts: Stretches, line: np.ndarray, direction: np.ndarray, outward: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Own cam angle and piece (n,) of the first touch on each line (n,), and whether there is one."""
    checkpoint()
    rows, stretch = _on_line(parts, direction)
    theta = _contacts(guide, parts, line[rows], direction[rows], stretch)
    piece = parts.piece[stretch]
    reached = outward * dot(guide(Angles(theta, piece)).place, line[rows])
    order = np.lexsort((-reached, rows))
    which, first = np.unique(rows[order], return_index=True)
    best = order[first]
    known = np.zeros(line.size, dtype=bool)
    known[which] = True
    own, of_piece = np.zeros(line.size), np.zeros(line.size, dtype=int)
    own[which], of_piece[which] = theta[best], piece[best]
    return own, of_piece, known


def _on_line(parts: Stretches, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Every pair of a line, by its direction (n,) [rad] in 0 ... 2π, and a stretch that it meets."""
    order = np.argsort(direction, kind="stable")
    turns = np.concatenate([direction[order] + turn for turn in (-TURN, 0.0, TURN)])
    low, high = np.minimum(parts.begin, parts.end), np.maximum(parts.begin, parts.end)
    back = TURN * np.floor(low / TURN)
    first = np.searchsorted(turns, low - back - SLACK, side="left")
    count = np.searchsorted(turns, high - back + SLACK, side="right") - first
    stretch = np.repeat(np.arange(count.size), count)
    place = np.arange(stretch.size) - np.repeat(np.cumsum(count) - count, count) + np.repeat(first, count)
    return order[place % order.size], stretch


def _contacts(
    guide: Guide, parts: Stretches, line: np.ndarray, direction: np.ndarray, stretch: np.ndarray
) -> np.ndarray:
    """Own cam angles (k,) at which the probe touches on lines (k,) within stretches (k,): Newton's method on the sine of the angle
    between its path and the line, kept within a bracket."""
    low, high, piece = parts.low[stretch].copy(), parts.high[stretch].copy(), parts.piece[stretch]
    begin, end = parts.begin[stretch], parts.end[stretch]
    sign = np.where(end >= begin, 1.0, -1.0)
    ahead = np.remainder(direction - begin + pi, TURN) - pi
    share = np.clip(ahead / np.where(end == begin, 1.0, end - begin), 0.0, 1.0)
    theta = low + share * (high - low)
    open_rows, last = np.arange(theta.size), np.full(theta.size, np.inf)
    for _ in range(PASSES):
        if not open_rows.size:
            break
        checkpoint()
        here, there = theta[open_rows], guide(Angles(theta[open_rows], piece[open_rows]))
        off = sign[open_rows] * cross(line[open_rows], there.along)
        slope = sign[open_rows] * cross(line[open_rows], there.rate)
        low[open_rows] = np.where(off <= 0.0, here, low[open_rows])
        high[open_rows] = np.where(off >= 0.0, here, high[open_rows])
        a, b = low[open_rows], high[open_rows]
        with np.errstate(divide="ignore", invalid="ignore"):
            new = here - off / slope
        new = np.where(
            (new >= a - NEAR) & (new <= b + NEAR), np.clip(new, a, b), 0.5 * (a + b)
        )  # at an end: it may lie there
        theta[open_rows] = new
        step = np.abs(new - here)
        rounding = (step < SMALL) & (
            step > 0.75 * last[open_rows]
        )  # where the path all but stands still, no step gets nearer
        last[open_rows] = step
        open_rows = open_rows[(step > 2.0 * EPS * np.maximum(np.abs(here), 1.0)) & ~rounding]
    return theta


# -- how a cut cam is inspected ---------------------------------------------------------------------------------


@frozen
class InspectionRequest:
    """One inspection.

    probe          row of ``PROBES``; None: as the cam's own follower touches it
    radius_mm      of a round probe; None: that of the cam's own follower
    tolerance_mm   ±, normal to the profile
    samples        equally spaced cam angles of the table
    flank          name of one of the cam's flanks
    direction_deg  in which the probe stands as seen from the cam centre, in the global frame; None: that of the follower where it
                   has one, else 90
    """

    probe: str | None = option(
        choice("Probe", tuple(PROBES), default=None, help="what touches the cam"),
        default_text="as its own follower does",
        words={name: row.label.capitalize() for name, row in PROBES.items()},
    )
    radius_mm: float | None = option(
        length("Radius", default=None, help="of a roller or ball"), default_text="that of the cam's own follower"
    )
    tolerance_mm: float = number("Tolerance", 0.0, 1e9, default=0.02, help="half the band, normal to the profile")
    samples: int = whole("Cam angles", 4, 1_000_000, default=360, help="equally spaced cam angles")
    flank: str = flank_choice()
    direction_deg: float | None = option(
        number(
            "Direction",
            default=None,
            help="where the probe stands, seen from the cam centre, counter-clockwise from the x axis",
        ),
        default_text="as the follower, else 90",
    )
