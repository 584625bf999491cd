"""Clearances of the bodies of a design: its pairs, their distance at any angle, the least one over the turn, and meetings.

Bodies of a design with one drive are compared by its own angle, those of several drives by the machine angle.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import combinations
from math import degrees, inf
from typing import Any, NamedTuple

import numpy as np

from core.clearance import (
    BodyMotion,
    Encounter,
    Intervals,
    ShapePair,
    body_motion,
    distances,
    intervals_of,
    joined,
    least_distance,
    meetings,
    nearest_points,
)
from core.clearance.bound import TOUCHING, relative
from core.clearance.outlines import BodyGeometry, drawing_of, outline_shape
from core.clearance.profile import profile_arcs
from core.clearance.shapes import MM, Shape
from core.design import Design, Outline
from core.design.camshaft import drive_names, phase_path, slugs
from core.design.outline_bodies import Body, body_named, body_of, body_words, outlined_bodies, pair_column
from core.design.outlines import CAM, CARRIED, FRAME, PLANES, ROLLER
from core.errors import KindynaError
from core.findings import ERROR, WARNING, Finding
from core.followers.outline_frames import outline_axis
from core.frozen import frozen
from core.mechanism.kinematics import REVOLUTE, Kinematics
from core.motion import TURN, Angles
from core.motion.extremes import Extreme, find_highest
from core.motion.program import MachineTurn
from core.numerics.lazy import checkpoint, lazy
from core.study.camshaft import Camshaft
from core.study.drive_study import DriveStudy
from core.study.stages import memory

TOLERANCE = 1e-6
"""Largest distance [m] between the least clearance and its proven lower bound, by default."""
_AXES = {plane: tuple("xyz".index(axis) for axis in plane) for plane in PLANES}

Pair = tuple[Body, Body]


@frozen(eq=False)
class LeastClearance:
    """Least clearance of two bodies over the turn.

    Attributes
    ----------
    names : tuple of str
        Names of both bodies.
    value : float [m]
        Least distance; 0 where they meet.
    at_least : float [m]
        Proven lower bound of it, never above the true least distance; 0 where they meet.
    theta : float [rad]
        Angle of the least distance; where they meet, that at which they begin to.
    points : tuple of complex [m]
        Nearest points of both bodies there, in the global frame; of the transferred part in its plane.
    meets : tuple of (float, float) [rad]
        Ranges of angles in which they meet; a range that begins above its end passes the end of the turn.
    """

    names: tuple[str, str]
    value: float
    at_least: float
    theta: float
    points: tuple[complex, complex]
    meets: tuple[tuple[float, float], ...] = ()


@frozen(eq=False)
class NearestBodies:
    """The nearest pair of bodies at n angles.

    Attributes
    ----------
    pairs : tuple of pairs of Body
    number : ndarray (n,) of int, dimensionless
        Number of the nearest pair.
    distance : ndarray (n,) [m]
    first, second : ndarray (n,) complex [m]
        Nearest points of both bodies in the global frame.
    """

    pairs: tuple[Pair, ...]
    number: np.ndarray
    distance: np.ndarray
    first: np.ndarray
    second: np.ndarray


class _Pin(NamedTuple):
    """A point that two bodies share, in the frames of both [m]."""

    first: Body
    first_point: complex
    second: Body
    second_point: complex


class Clearances:
    """Clearances of the bodies with outlines of a design.

    Shapes and results are cached by the parts of the design on which they depend. Methods raise KindynaError where a drawing
    cannot be read, and NoSolution where a drive has none.
    """

    def __init__(self, camshaft: Camshaft[Any]) -> None:
        self.design: Design = camshaft.design
        self._camshaft = camshaft
        self._studies: list[DriveStudy] = list(camshaft.drives.values())

    # -- bodies and pairs -----------------------------------------------------------------------------------

    @lazy
    def names(self) -> Mapping[Body, str]:
        """Body with outlines -> its name, in the order of the file."""
        return outlined_bodies(self.design)

    @lazy
    def outlines(self) -> Mapping[Body, tuple[Outline, ...]]:
        """Body -> its outlines."""
        rows: dict[Body, tuple[Outline, ...]] = dict.fromkeys(self.names, ())
        for outline in self.design.outlines:
            if (body := body_of(self.design, outline)) is not None:
                rows[body] = (*rows[body], outline)
        return rows

    @lazy
    def pairs(self) -> tuple[Pair, ...]:
        """Pairs with a common layer: those that do not touch by design, and those of ``[[clearances]]``."""
        able = [pair for pair in combinations(self.names, 2) if self._shares_layer(pair)]
        stated = {frozenset(body_named(self.design, text) for text in row.between) for row in self.design.clearances}
        touching = self._touching(able)
        return tuple(pair for pair in able if frozenset(pair) in stated or frozenset(pair) not in touching)

    def pair(self, texts: Sequence[str]) -> Pair:
        """The pair of two names. Raises KindynaError where a body is unknown, is named twice, or both have no common layer."""
        bodies = [body_named(self.design, text.strip()) for text in texts]
        if not self.names:
            raise KindynaError("outlines: the design has none; add [[outlines]] of the bodies to compare")
        for text, body in zip(texts, bodies, strict=True):
            if body not in self.names:
                allowed = " | ".join(self.names.values())
                raise KindynaError(f"pair: {text.strip()!r} is no body with an outline; allowed: {allowed}")
        order = {body: i for i, body in enumerate(self.names)}
        first, second = sorted((body for body in bodies if body is not None), key=lambda body: order[body])
        if first == second:
            raise KindynaError(
                f"pair: {' and '.join(texts)} are the same body; allowed: two of {' | '.join(self.names.values())}"
            )
        if not self._shares_layer((first, second)):
            raise KindynaError(f"pair: {' and '.join(texts)} have no common layer; change layer_from_mm or layer_to_mm")
        return first, second

    def require_pairs(self) -> tuple[Pair, ...]:
        """The pairs. Raises KindynaError where no outline exists, or no two bodies have a common layer."""
        if not self.names:
            raise KindynaError("outlines: the design has none; add [[outlines]] of the bodies to compare")
        if not self.pairs:
            raise KindynaError(
                "outlines: no two bodies that do not touch by design have a common layer; add an outline, or change layers"
            )
        return self.pairs

    def texts(self, pair: Pair) -> tuple[str, str]:
        """Names of both bodies."""
        return self.names[pair[0]], self.names[pair[1]]

    def column(self, pair: Pair) -> str:
        """Column of the pair in tables, ``link_3__frame_mm``."""
        return pair_column(self.texts(pair))

    @lazy
    def by_column(self) -> Mapping[str, Pair]:
        """Column -> pair."""
        return {self.column(pair): pair for pair in self.pairs}

    def required(self, pair: Pair) -> float:
        """Clearance that two bodies must keep [mm], by ``[[clearances]]``; 0 where none is stated."""
        rows = (
            row
            for row in self.design.clearances
            if {body_named(self.design, text) for text in row.between} == set(pair)
        )
        return max((row.least_mm for row in rows), default=0.0)

    def _shares_layer(self, pair: Pair) -> bool:
        return any(True for _ in self._planes(pair))

    def _planes(self, pair: Pair) -> Iterator[str | None]:
        """Planes in which two bodies have a common layer; None for that of the mechanism."""
        for plane in (None, *PLANES):
            layers = [[row.layer for row in self.outlines[body] if row.plane == plane] for body in pair]
            if any(max(a[0], b[0]) < min(a[1], b[1]) for a in layers[0] for b in layers[1]):
                yield plane

    def _touching(self, pairs: Sequence[Pair]) -> set[frozenset[Body]]:
        """Pairs that touch by design: a roller or a face and its cam, bodies pinned at a point inside the outlines of both."""
        result = {frozenset((Body(i, CAM), Body(i, ROLLER))) for i in range(len(self._studies))}
        for i, drive in enumerate(self.design.drives):
            if CAM in body_words(drive) and drive.face.slides:
                kinematics = self._first(i)
                result.add(frozenset((Body(i, CAM), Body(i, kinematics.carrier or kinematics.follower_body))))
        wanted = {frozenset(pair) for pair in pairs} - result
        for pin in self._pins():
            key = frozenset((pin.first, pin.second))
            if key in wanted and key not in result:
                ends = (pin.first, pin.first_point), (pin.second, pin.second_point)
                if all(self._is_inside(body, point) for body, point in ends):
                    result.add(key)
        return result

    def _is_inside(self, body: Body, point: complex) -> bool:
        if body.name == CAM and any(not (row.points or row.file) for row in self.outlines[body]):
            return True  # every profile encloses the centre of its cam
        return self.shape(body, None).contains(point)

    def pins_of(self, body: Body) -> list[complex]:
        """Points [m] of a body, in its frame, where pins join it to other bodies."""
        points = [
            point
            for pin in self._pins()
            for owner, point in ((pin.first, pin.first_point), (pin.second, pin.second_point))
            if owner == body
        ]
        return list(dict.fromkeys(points))

    def _pins(self) -> Iterator[_Pin]:
        """Points that two bodies share: pins, the centres of rollers and of cams."""
        cams = [i for i, drive in enumerate(self.design.drives) if CAM in body_words(drive)]
        on_shaft = [Body(None, FRAME), *(Body(i, CAM) for i in cams)]
        yield from (_Pin(first, 0j, second, 0j) for first, second in combinations(on_shaft, 2))
        for i in {body.drive for body in self.names if body.drive is not None}:
            yield from self._pins_of_drive(i)

    def _pins_of_drive(self, i: int) -> Iterator[_Pin]:
        drive, frame = self.design.drives[i], Body(None, FRAME)

        def seen(z: complex) -> complex:
            return -z.conjugate() if drive.mirrored else z

        kinematics = self._first(i)
        carrier = kinematics.carrier or kinematics.follower_body
        if (
            CAM in body_words(drive)
            and (point := kinematics.bodies[carrier].points.get(self._roller_point(i))) is not None
        ):
            yield _Pin(Body(i, ROLLER), 0j, Body(i, carrier), seen(point))
        if drive.links:
            links = {link.number: link.places for link in drive.links}
            for (m, first), (n, second) in combinations(links.items(), 2):
                bodies = (frame if k == 1 else Body(i, f"link{k}") for k in (m, n))
                a, b = bodies
                for name in first.keys() & second.keys():
                    yield _Pin(a, seen(first[name] * MM), b, seen(second[name] * MM))
            return
        for pair in kinematics.pairs.values():
            if pair.kind == REVOLUTE:
                body, other = kinematics.bodies[pair.body], kinematics.bodies.get(pair.on)
                local = body.points[pair.point]
                on = complex(body.position(pair.point)[0]) if other is None else other.points[pair.point]
                yield _Pin(Body(i, pair.body), seen(local), frame if other is None else Body(i, pair.on), seen(on))

    def _roller_point(self, i: int) -> str:
        return str(getattr(self.design.drives[i].cam, "point", "roller"))

    def _first(self, i: int) -> Kinematics:
        """Kinematics of a drive at the start of its turn."""
        study = self._studies[i]
        kinematics: Kinematics = study.at_theta(study.program.starts[:1]).linkage
        return kinematics

    # -- shapes ---------------------------------------------------------------------------------------------

    def shape(self, body: Body, plane: str | None) -> Shape:
        """Shape of the outlines of a body in a plane, in the frame of the body as seen from the first end of the shaft."""
        outlines = tuple(row for row in self.outlines[body] if row.plane == plane)
        drawings = tuple(map(drawing_of, outlines))
        number = body.drive if body.drive is not None else None
        parts = () if number is None else self._studies[number].depends_on("cam")
        mirrors = tuple(self._mirrors(body, row) for row in outlines)

        def compute() -> Shape:
            rows = zip(outlines, drawings, mirrors, strict=True)
            shapes = [(outline_shape(row, data, self._geometry(body)), mirror) for row, data, mirror in rows]
            return joined([shape.reflected() if mirror else shape for shape, mirror in shapes])

        shape: Shape = memory.get("outline", (body, outlines, drawings, mirrors, parts), compute)
        return shape

    def _mirrors(self, body: Body, outline: Outline) -> bool:
        """Whether an outline is given as seen from the other end of the shaft."""
        if body.drive is not None:
            return self.design.drives[body.drive].mirrored
        named = body_named(self.design, f"{outline.drive}.{FRAME}") if outline.drive else None
        return named is not None and self._drive_of(outline).mirrored

    def _drive_of(self, outline: Outline) -> Any:
        index = next(i for i, name in enumerate(slugs(self.design)) if outline.drive in (name, self._names[i]))
        return self.design.drives[index]

    @property
    def _names(self) -> list[str]:
        return list(self._camshaft.drives)

    def _geometry(self, body: Body) -> BodyGeometry:
        if body.drive is None:
            return BodyGeometry(np.zeros(0, dtype=complex))
        drive, study = self.design.drives[body.drive], self._studies[body.drive]
        if body.name == ROLLER:
            return BodyGeometry(np.zeros(0, dtype=complex), drive.face.radius_mm * MM)
        if body.name == CAM:
            return BodyGeometry(
                np.zeros(0, dtype=complex),
                profile=lambda: profile_arcs(lambda angles: study.at(angles).cam, study.program),
            )
        for link in drive.links:
            if body.name == f"link{link.number}":
                return BodyGeometry(np.array([z * MM for z in link.places.values()]))
        points = np.array(list(self._first(body.drive).bodies[body.name].points.values()))
        return BodyGeometry(points, unit=outline_axis(drive) if CAM in body_words(drive) else 1.0 + 0j)

    # -- motions --------------------------------------------------------------------------------------------

    @lazy
    def turn(self) -> Any:
        """Pieces of the turn, of the drive or of the machine."""
        single = self._camshaft.single_drive
        if single is not None:
            return single.program
        positions = self._camshaft.positions
        return MachineTurn([(study.program, positions[name]) for name, study in self._camshaft.drives.items()])

    @lazy
    def intervals(self) -> Intervals:
        """First intervals of the turn."""
        return intervals_of(self.turn)

    def angles(self, theta: np.ndarray) -> Angles:
        """Angles of the turn with their pieces.

        Parameters
        ----------
        theta : ndarray (n,) [rad]

        Returns
        -------
        Angles
        """
        angles: Angles = self.turn.angles(np.atleast_1d(theta))
        return angles

    def at(self, angles: Angles) -> MachinePose:
        """Poses of the bodies at angles of the turn."""
        if angles is self.intervals.angles:
            return self._at_intervals
        return MachinePose(self._camshaft, self.turn, angles)

    def pose_of(self, study: DriveStudy) -> MachinePose:
        """Poses of the bodies at the angles of a study of the only drive."""
        return MachinePose(self._camshaft, self.turn, study.angles, study)

    def of_member(self, study: DriveStudy, member: str) -> np.ndarray:
        """Distance of two bodies at the angles of a study of the only drive, d = min |q - p| over all points of both.

        Parameters
        ----------
        study : DriveStudy
        member : str
            Names of both bodies, as in the column: ``link_3__frame``.

        Returns
        -------
        ndarray (n,) [m]
            0 where they meet.
        """
        return self.distance(self.by_column[f"{member}_mm"], self.pose_of(study))

    @lazy
    def _at_intervals(self) -> MachinePose:
        return MachinePose(self._camshaft, self.turn, self.intervals.angles)

    def _encounters(self, pair: Pair) -> list[tuple[Encounter, str | None]]:
        """The two bodies in each plane in which they have a common layer."""
        result = []
        for plane in self._planes(pair):
            first, second = (self.shape(body, plane) for body in pair)

            def motions(angles: Angles, orders: int, plane: str | None = plane) -> tuple[BodyMotion, BodyMotion]:
                pose = self.at(angles)
                return pose.motion(pair[0], plane, orders), pose.motion(pair[1], plane, orders)

            result.append((Encounter(ShapePair.of(first, second), motions), plane))
        return result

    # -- results --------------------------------------------------------------------------------------------

    def distance(self, pair: Pair, pose: MachinePose) -> np.ndarray:
        """Distance of two bodies, 0 where they meet.

        Parameters
        ----------
        pair : tuple of Body
        pose : MachinePose
            Poses at n angles.

        Returns
        -------
        ndarray (n,) [m]
        """
        least = np.full(pose.angles.theta.size, inf)
        for encounter, plane in self._encounters(pair):
            first, second = (pose.motion(body, plane, 1) for body in pair)
            placement = relative(second, first).placement.spread(least.size)
            least = np.minimum(least, distances(encounter.shapes, placement).value)
        return np.where(least <= TOUCHING, 0.0, least)

    def nearest(self, pair: Pair, angles: Angles) -> tuple[complex, complex]:
        """Nearest points of two bodies at one angle, in the global frame [m]; of the transferred part in its plane."""
        _, first, second = self.nearest_points(pair, angles)
        return complex(first[0]), complex(second[0])

    def nearest_points(self, pair: Pair, angles: Angles) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Distance and nearest points of two bodies; one point where they meet.

        Parameters
        ----------
        pair : tuple of Body
        angles : Angles
            The n angles.

        Returns
        -------
        distance, first, second : ndarray (n,) [m], (n,) complex [m], (n,) complex [m]
            Points in the global frame; of the transferred part in its plane.
        """
        n = angles.theta.size
        best, points = np.full(n, inf), np.zeros((2, n), dtype=complex)
        for encounter, _ in self._encounters(pair):
            first, _ = encounter.motions(angles, 1)
            value, p, q = nearest_points(encounter.shapes, encounter.placement(angles, n))
            nearer = value < best
            best = np.where(nearer, value, best)
            points = np.where(nearer, first.origin[0] + first.turn[0] * np.array([p, q]), points)
        meets = best <= TOUCHING
        p, q = np.where(meets, points.mean(axis=0), points)
        return np.where(meets, 0.0, best), p, q

    def nearest_of_all(self, angles: Angles, drive: int | None = None) -> NearestBodies:
        """The pair of the plane of the mechanism that is nearest at each of n angles; its distance and nearest points.

        With ``drive`` only pairs of bodies of that drive and the frame. Without a pair the distances are infinite.
        """
        compared = [pair for pair in self.pairs if drive is None or {body.drive for body in pair} <= {drive, None}]
        pairs = [pair for pair in compared if None in self._planes(pair)]
        if not pairs:
            n = angles.theta.size
            nowhere = np.zeros(n, dtype=complex)
            return NearestBodies((), np.zeros(n, dtype=int), np.full(n, inf), nowhere, nowhere)
        rows = [self.nearest_points(pair, angles) for pair in pairs]
        distance = np.array([row[0] for row in rows])
        number = distance.argmin(axis=0)
        at = np.arange(number.size)
        first, second = (np.array([row[k] for row in rows])[number, at] for k in (1, 2))
        return NearestBodies(tuple(pairs), number, distance[number, at], first, second)

    def least(self, pair: Pair, tolerance: float = TOLERANCE) -> LeastClearance:
        """Least clearance of two bodies over the turn, proven to a tolerance [m]."""

        def compute() -> LeastClearance:
            encounters = [encounter for encounter, _ in self._encounters(pair)]
            found = [least_distance(encounter, self.intervals, tolerance) for encounter in encounters]
            best = min(found, key=lambda row: row.value)
            if best.value > TOUCHING:
                at = Angles(np.array([best.theta]), np.array([best.piece]))
                bound = max(min(row.bound for row in found), 0.0)
                return LeastClearance(self.texts(pair), best.value, bound, best.theta, self.nearest(pair, at))
            meets = _union([row for encounter in encounters for row in meetings(encounter, self.intervals)])
            theta = meets[0][0] if meets else best.theta
            return LeastClearance(
                self.texts(pair), 0.0, 0.0, theta, self.nearest(pair, self.angles(np.array([theta]))), meets
            )

        result: LeastClearance = memory.get("clearance", (*self._key(pair), tolerance), compute)
        return result

    def too_near(self, pair: Pair) -> tuple[tuple[float, float], ...]:
        """Ranges of angles [rad] in which two bodies meet, or are nearer than they must be; as ``LeastClearance.meets``."""
        level = self.required(pair) * MM

        def compute() -> tuple[tuple[float, float], ...]:
            if self.keeps(pair, level):
                return ()
            encounters = [encounter for encounter, _ in self._encounters(pair)]
            return _union([row for encounter in encounters for row in meetings(encounter, self.intervals, level)])

        ranges: tuple[tuple[float, float], ...] = memory.get("too near", (*self._key(pair), level), compute)
        return ranges

    def greatest(self, pair: Pair) -> Extreme:
        """Greatest distance of two bodies over the turn [m], refined between samples."""

        def compute() -> Extreme:
            return find_highest(lambda angles: {"": self.distance(pair, self.at(angles))}, self.turn)[""]

        result: Extreme = memory.get("greatest distance", self._key(pair), compute)
        return result

    def keeps(self, pair: Pair, least: float) -> bool:
        """Whether two bodies provably keep a clearance [m] over the turn; faster than `least`."""

        def compute() -> bool:
            found = (
                least_distance(encounter, self.intervals, TOLERANCE, least) for encounter, _ in self._encounters(pair)
            )
            return all(row.value > TOUCHING and row.bound >= least for row in found)

        kept: bool = memory.get("keeps clearance", (*self._key(pair), least), compute)
        return kept

    @property
    def key(self) -> tuple[Any, ...]:
        """All on which the clearances depend, but the drives: outlines, their drawings, and the pairs that are stated."""
        return self.design.outlines, drawings_of(self.design), self.design.clearances

    def _key(self, pair: Pair) -> tuple[Any, ...]:
        """All on which the distance of two bodies depends."""
        outlines = tuple(row for body in pair for row in self.outlines[body])
        numbers = {body.drive for body in pair if body.drive is not None}
        carries = any(body.name == CARRIED for body in pair)
        drives = [
            (study.depends_on("cam"), drive.phase if self.design.listed else 0.0, drive.mirrored, drive.carries)
            for i, (study, drive) in enumerate(zip(self._studies, self.design.drives, strict=True))
            if i in numbers or (carries and drive.carries)
        ]
        return pair, self.texts(pair), outlines, tuple(map(drawing_of, outlines)), tuple(drives), self.design.listed


class MachinePose:
    """Poses of all bodies at angles of the turn; the motion of each is computed when it is first read."""

    def __init__(self, camshaft: Camshaft[Any], turn: Any, angles: Angles, study: DriveStudy | None = None) -> None:
        self.angles = angles
        self._camshaft, self._turn, self._given = camshaft, turn, study
        self._known: dict[Any, Any] = {}

    def motion(self, body: Body, plane: str | None, orders: int) -> BodyMotion:
        """Motion of the frame of a body; `orders` rows: value and derivatives by the angle of the turn."""
        key = body, plane, orders
        if key not in self._known:
            self._known[key] = self._motion(body, plane, orders)
        motion: BodyMotion = self._known[key]
        return motion

    def _motion(self, body: Body, plane: str | None, orders: int) -> BodyMotion:
        zero = np.zeros((orders, 1))
        if body.name == FRAME:
            return body_motion(zero.astype(complex), zero)
        if body.drive is None:
            return body_motion(self._carried(plane or PLANES[0], orders), zero)
        study = self._study(body.drive)
        sign = self._sign(body.drive) ** np.arange(orders)[:, None]
        if body.name == CAM:
            angle = np.zeros((orders, study.theta.size))
            angle[0] = study.sense * study.theta
            angle[1:2] = study.sense
            origin = zero.astype(complex)
        else:
            kinematics = study.linkage
            pose = kinematics.follower if body.name == ROLLER else kinematics.bodies[body.name]
            origin = pose.origin[0][None] if orders == 1 else pose.z
            angle = pose.turn[0][None] if orders == 1 else pose.angle
        if self._camshaft.design.drives[body.drive].mirrored:
            origin, angle = -origin.conj(), -angle
        return body_motion(origin * sign, angle * sign)

    def _carried(self, plane: str, orders: int) -> np.ndarray:
        """Position of the transferred part in a plane (orders, n) complex [m]."""
        total = np.zeros((orders, self.angles.theta.size), dtype=complex)
        x, y = _AXES[plane]
        for i, drive in enumerate(self._camshaft.design.drives):
            if drive.carries:
                direction = np.array(drive.carries) / np.linalg.norm(drive.carries)
                travel = self._study(i).motion.displacement
                sign = self._sign(i) ** np.arange(orders)[:, None]
                rows = np.array([np.broadcast_to(travel[k], total.shape[1:]) for k in range(orders)])
                total += rows * sign * drive.carried_per_motion * complex(direction[x], direction[y])
        return total

    def _study(self, number: int) -> Any:
        """Study of a drive at these angles."""
        if self._given is not None:
            return self._given
        if number not in self._known:
            study = list(self._camshaft.drives.values())[number]
            is_single = self._camshaft.single_drive is not None
            self._known[number] = study.at(self.angles if is_single else self._turn.drive_angles(number, self.angles))
        return self._known[number]

    def _sign(self, number: int) -> float:
        """Derivative of a drive's angle by that of the turn, ±1."""
        if self._camshaft.single_drive is not None:
            return 1.0
        return list(self._camshaft.positions.values())[number].rotation_sign


def _union(ranges: list[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """Ranges in ascending order; of several planes overlapping ones joined."""
    result: list[tuple[float, float]] = []
    for begin, end in sorted(ranges):
        if result and result[-1][0] <= result[-1][1] and begin <= result[-1][1] <= max(begin, end):
            result[-1] = result[-1][0], max(end, result[-1][1])
        else:
            result.append((begin, end))
    return tuple(result)


def drawings_of(design: Design) -> tuple[bytes, ...]:
    """Contents of the drawings of all outlines. Raises FileError."""
    return tuple(map(drawing_of, design.outlines))


def nearest_points_of(study: Any, member: str) -> tuple[complex, complex]:
    """Nearest points of two bodies at the first angle of a study [m], in the global frame; member as ``link_3__frame``."""
    clearances: Clearances = study.clearances
    angles = Angles(study.theta[:1], study.angles.piece[:1])
    return clearances.nearest(clearances.by_column[f"{member}_mm"], angles)


def pair_members(study: Any) -> tuple[str, ...]:
    """Members of the quantities of clearances: ``link_3__frame``; empty where a drive has no solution or a drawing is missing."""
    if not study.design.outlines:
        return ()
    with suppress(KindynaError):
        clearances: Clearances = study.clearances
        return tuple(column.removesuffix("_mm") for column in clearances.by_column)
    return ()


# -- findings -------------------------------------------------------------------------------------------------


def clearance_findings(clearances: Clearances) -> list[Finding]:
    """Pairs that meet, and pairs that come nearer to each other than they may."""
    design, findings = clearances.design, []
    for pair in clearances.pairs:
        checkpoint()
        least = clearances.required(pair)
        if clearances.keeps(pair, least * MM):
            continue
        result = clearances.least(pair)
        if not result.meets and result.value >= least * MM:
            continue
        first, second = result.names
        values: dict[str, float | str] = {"first": first, "second": second, "hint": _hint(design, pair)}
        angle = degrees(result.theta)
        if result.meets:
            over = sum(degrees((end - begin) % TURN) or 360.0 for begin, end in result.meets)
            values["over_deg"] = over
            findings.append(Finding("collision", ERROR, _remedy_field(design, pair), angle, values))
        else:
            values |= {"value_mm": result.value / MM, "least_mm": least}
            findings.append(Finding("clearance", WARNING, _remedy_field(design, pair), angle, values))
    return findings


def _turned_drive(design: Design, pair: Pair) -> int | None:
    """Drive whose phase changes the distance of two bodies; None where both move with one drive."""
    numbers = [body.drive for body in pair if body.drive is not None]
    return numbers[-1] if design.listed and len(set(numbers)) > 1 else None


def _remedy_field(design: Design, pair: Pair) -> str:
    number = _turned_drive(design, pair)
    if number is not None:
        return phase_path(design, number)
    index = max(i for i, row in enumerate(design.outlines) if body_of(design, row) in pair)
    return f"outlines[{index}].{'round_mm' if design.outlines[index].round_mm else 'of'}"


def _hint(design: Design, pair: Pair) -> str:
    number = _turned_drive(design, pair)
    if number is not None:
        return f"change the phase or the motion of {drive_names(design)[number]}, or an outline"
    return "change an outline, its layer, or a length of the mechanism"
