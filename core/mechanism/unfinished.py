"""Mobility of a linkage that is drawn: free degrees of freedom, overconstrained links, a missing driver, and the part that moves.

The mobility is not counted from the pairs, but is the rank of the velocity equations J x' = 0 at the drawn pose and near it. Where
J has its full rank anywhere, it has it almost everywhere; so a dead centre is not taken for a free part, and three parallel cranks
on one rod are overconstrained only where their lengths disagree. The unknowns are the velocities of all moving links, three numbers
each, with lengths in units of the size.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from core.design import CRANK, FRAME_LINK, Design, Linkage
from core.design.topology import driver_pair, driver_turns, gains, input_slides, is_pin, pins, solving_order
from core.errors import KindynaError
from core.frozen import frozen
from core.mechanism.drawing_edits import with_driving_link
from core.mechanism.drawn import PointPositions, assembled_positions, drawn_position, frame_link, point_positions
from core.mechanism.driver_ranges import DriverRanges, driver_ranges_of
from core.mechanism.drivers import CrankMotion, motion_extent
from core.mechanism.mechanism import Mechanism, body_name, mechanism_of
from core.mechanism.solving import solve_mechanism
from core.motion import CompiledMotion, program
from core.numerics.derivatives import heading, vector

# -- mobility of a drawing --------------------------------------------------------------------------------------


_TINY = 1e-7  # smaller velocities, or coefficients of a dependence, are zero
_RANK = 1e-8  # of the largest singular value
_STEP = 0.03  # to a neighbouring pose, in radians and in parts of the size
_ROUNDS = 12  # of Newton's method
_CLOSED = 1e-10
_OPEN = 1e-3  # of the size: a drawing with larger gaps is not assembled


@frozen
class Mobility:
    """Mobility of a linkage, and what prevents it from being a mechanism.

    Attributes
    ----------
    freedom : int
        Degrees of freedom without a driver.
    surplus : int
        Constraints that are too many, so that the driver cannot move.
    loose : tuple of int
        Links that can move with the driver at rest.
    points : tuple of str
        Free ends of the loose links.
    overconstrained : tuple of int
        Links overconstrained by each other.
    redundant : tuple of int
        Redundant links, which still can move, at least near the drawn pose.
    driven : tuple of int
        Links whose motion the driver determines.
    has_driver : bool
        There is a driver.
    possible_drivers : tuple of int
        Links that could be the driver, where there is none.
    has_ground : bool
        The frame has a point, or something slides on it.
    """

    freedom: int
    surplus: int
    loose: tuple[int, ...]
    points: tuple[str, ...]
    overconstrained: tuple[int, ...]
    redundant: tuple[int, ...]
    driven: tuple[int, ...]
    has_driver: bool
    possible_drivers: tuple[int, ...]
    has_ground: bool = True

    @property
    def is_finished(self) -> bool:
        """Whether the linkage is a mechanism."""
        return self.has_driver and not self.freedom and not self.surplus

    @property
    def sentences(self) -> tuple[str, ...]:
        """Problems with their remedies, one line each."""
        plural = "" if self.freedom == 1 else "s"
        if not self.has_ground:
            return (f"{self.freedom} degree{plural} of freedom without a driver: ground a point",)
        todo = []
        loose, verb = (
            (_and(self.points), "hang")
            if self.points
            else (_links(self.loose), "move")
            if self.has_driver
            else ("", "")
        )
        if loose and self.loose:
            is_plural = len(self.points or self.loose) > 1
            pronoun = "them" if is_plural else "it"
            todo.append(f"{loose} {verb}{'' if is_plural else 's'} loose: join {pronoun} or ground {pronoun}")
        if not self.has_driver:
            could = _links(self.possible_drivers, "or")
            todo.append(f"let {could} drive" if could else "no link on the frame could drive")
        sentences = []
        if self.freedom:
            sentences.append(f"{self.freedom} degree{plural} of freedom without a driver: {'; '.join(todo)}")
        elif not self.has_driver:
            sentences.append("no degree of freedom: it cannot move")
        if self.surplus:
            verb = "overconstrain each other" if len(self.overconstrained) > 1 else "is overconstrained"
            sentences.append(f"{self.surplus} too many: {_links(self.overconstrained)} {verb}")
        return tuple(sentences)


def _and(names: Sequence[str], word: str = "and") -> str:
    return f"{', '.join(names[:-1])} {word} {names[-1]}" if len(names) > 1 else "".join(names)


def _links(numbers: Sequence[int], word: str = "and") -> str:
    return "" if not numbers else f"link{'s' if len(numbers) > 1 else ''} {_and([str(n) for n in numbers], word)}"


def mobility(linkage: Linkage) -> Mobility:
    """Mobility of a linkage whose names of links, points and pairs have no faults."""
    equations = _Equations(linkage)
    pose = equations.drawn()
    rows = equations.rows(pose)
    null, left = _spaces(rows, equations.moving)
    if null.shape[1] or left.shape[0]:  # a dead centre has more freedom than the poses near it
        for near in equations.near(pose):
            other = equations.rows(near)
            spaces = _spaces(other, equations.moving)
            if spaces[0].shape[1] < null.shape[1]:
                rows, (null, left) = other, spaces
    loose = equations.moving_links(null)
    free, _ = _spaces(rows[equations.driven :], equations.moving)
    moving = equations.moving_links(free)
    drives = bool(equations.driven)
    locked = null.shape[1] + equations.driven > free.shape[1] or not equations.is_closed(pose)
    dependent = equations.dependent(rows) if left.shape[0] else ()
    return Mobility(
        freedom=null.shape[1],
        surplus=left.shape[0] if locked else 0,
        loose=loose,
        points=_loose_ends(linkage, loose),
        overconstrained=dependent if locked else (),
        redundant=() if locked else dependent,
        driven=tuple(n for n in moving if n not in loose) if drives else (),
        has_driver=drives,
        possible_drivers=() if drives else _possible_drivers(linkage, moving),
        has_ground=bool(frame_link(linkage).points) or any(FRAME_LINK in (s.link, s.on) for s in linkage.sliders),
    )


def is_overconstrained(linkage: Linkage) -> bool:
    """Whether a linkage without faults is overconstrained as it is drawn."""
    return bool(solving_order(linkage).redundant) and not mobility(linkage).is_finished


def driven_part(linkage: Linkage, lack: Mobility) -> Linkage | None:
    """The part of an incomplete linkage that moves with its driver; None where nothing moves, or it is overconstrained."""
    if not lack.driven or lack.surplus:
        return None
    numbers = {FRAME_LINK, *lack.driven}
    moving = set(lack.driven) | set(lack.loose)
    numbers |= {link.number for link in linkage.links if link.number not in moving}
    links = tuple(link for link in linkage.links if link.number in numbers)
    names = {name for link in links for name in link.places}
    drawn = linkage.drawn and replace(linkage.drawn, points=tuple(p for p in linkage.drawn.points if p.name in names))
    sliders = tuple(s for s in linkage.sliders if {s.link, s.on} <= numbers)
    joints = names | {str(s.link) for s in sliders}
    branch = tuple(side for side in linkage.branch if side.joint in joints)
    return replace(linkage, links=links, sliders=sliders, drawn=drawn, branch=branch)


def _possible_drivers(linkage: Linkage, moving: Iterable[int]) -> tuple[int, ...]:
    """Moving links with a pin on the frame; where there are none, those that slide on it."""
    pairs = {n: driver_pair(replace(linkage, driver=replace(linkage.driver, link=n, on=FRAME_LINK))) for n in moving}
    pinned = tuple(n for n, pair in pairs.items() if pair is not None and is_pin(pair))
    return pinned or tuple(n for n, pair in pairs.items() if pair is not None)


def _loose_ends(linkage: Linkage, loose: Sequence[int]) -> tuple[str, ...]:
    """Free ends of loose links: points of one link only, on links with less than two pairs."""
    all_pins = pins(linkage)
    pin_names = {pin.name for pin in all_pins}
    ends: dict[str, None] = {}
    for link in linkage.links:
        count = sum(link.number in pin.links for pin in all_pins)
        count += sum(link.number in (s.link, s.on) for s in linkage.sliders)
        if link.number in loose and count < 2:
            ends |= dict.fromkeys(name for name in link.places if name not in pin_names)
    return tuple(ends)


def _spaces(rows: np.ndarray, moving: int) -> tuple[np.ndarray, np.ndarray]:
    """Right null space (3n, k) and left null space (r, m) of rows (m, 3n)."""
    if not rows.size:
        return np.eye(3 * moving), np.zeros((rows.shape[0], rows.shape[0]))
    u, s, vh = np.linalg.svd(rows)
    rank = int((s > _RANK * s[0]).sum())
    return vh[rank:].T, u[:, rank:].T


class _Equations:
    """Velocity equations of a linkage: columns x, y, turn of each moving link; rows of the drivers, then two of each pair."""

    def __init__(self, linkage: Linkage) -> None:
        self._linkage = linkage
        self._numbers = [link.number for link in linkage.links if link.number != FRAME_LINK]
        self.moving = len(self._numbers)
        self._at = {n: i for i, n in enumerate(self._numbers)} | {FRAME_LINK: self.moving}
        points = {link.number: link.places for link in linkage.links}
        extents = [abs(z - w) for at in points.values() for z in at.values() for w in at.values()]
        self._size = max([*extents, 1e-9])
        self._points = {n: {name: z / self._size for name, z in at.items()} for n, at in points.items()}
        pin_pairs = [(pin, pin.links[0], n) for pin in pins(linkage) for n in pin.links[1:]]
        self._pairs: list[tuple[str, int, int]] = [(pin.name, a, b) for pin, a, b in pin_pairs]
        self._pairs += [(str(s.link), s.on, s.link) for s in linkage.sliders]
        self._a = np.array([self._at[a] for _, a, _ in pin_pairs], dtype=int)
        self._b = np.array([self._at[b] for _, _, b in pin_pairs], dtype=int)
        self._pa = np.array([self._points[a][pin.name] for pin, a, _ in pin_pairs], dtype=complex)
        self._pb = np.array([self._points[b][pin.name] for pin, _, b in pin_pairs], dtype=complex)
        self._on = np.array([self._at[s.on] for s in linkage.sliders], dtype=int)
        self._slides = np.array([self._at[s.link] for s in linkage.sliders], dtype=int)
        through = [vector(s.through_x_mm, s.through_y_mm) / self._size for s in linkage.sliders]
        self._through = np.array(through, dtype=complex)
        self._along = np.array([heading(np.deg2rad(s.angle_deg)) for s in linkage.sliders], dtype=complex)
        driver, against = linkage.driver.link, linkage.driver.on
        drives = driver in self._at and driver != FRAME_LINK and against in self._at
        pair = driver_pair(linkage) if drives else None
        ratios, length = gains(linkage), 1e-3 * self._size
        self._second = [
            (
                self._at[row.link],
                self._at[row.on],
                ratios[row.link] * length ** (input_slides(linkage, row) * -1.0 + (not driver_turns(linkage))),
            )
            for row in linkage.drivers
            if drives and {row.link, row.on} <= self._at.keys() and row.link in ratios
        ]
        self.driven = int(drives) + len(self._second)
        self._turns = pair is None or is_pin(pair) or linkage.driver.kind == CRANK

    def drawn(self) -> np.ndarray:
        """Drawn pose, assembled as well as possible: origin and x axis (2, n + 1) complex of every link."""
        drawn = self._linkage.drawn
        positions = {name: z / self._size for name, z in drawn.places.items()} if drawn else {}
        positions |= self._points.get(FRAME_LINK, {})
        pose = np.zeros((2, self.moving + 1), dtype=complex)
        pose[1] = 1.0
        lines = {s.link: e for s, e in zip(self._linkage.sliders, self._along, strict=True) if s.on == FRAME_LINK}
        for n in self._numbers:
            i, points = self._at[n], self._points[n]
            known = [name for name in points if name in positions]
            local, drawn_at = (np.array([at[name] for name in known], dtype=complex) for at in (points, positions))
            axis = lines.get(n, 1.0 + 0j)
            if (
                n == self._linkage.driver.link
                and self._linkage.driver.on == FRAME_LINK
                and drawn is not None
                and drawn.driver_deg is not None
            ):
                axis = heading(np.deg2rad(drawn.driver_deg))
            if len(known) > 1:
                rotation = np.vdot(local - local.mean(), drawn_at - drawn_at.mean())
                axis = rotation / abs(rotation) if abs(rotation) > 0.0 else axis
            pose[1, i] = axis
            pose[0, i] = (drawn_at.mean() - local.mean() * axis) if known else 0j
        return self._closed(pose)

    def _gaps(self, pose: np.ndarray) -> np.ndarray:
        """Gaps of all pairs (m,); 0 in the rows of the drivers."""
        z, u = pose
        pin = z[self._b] + self._pb * u[self._b] - z[self._a] - self._pa * u[self._a]
        line = self._along * u[self._on]
        turn = np.angle(u[self._slides] / line) if line.size else np.zeros(0)
        distance = z[self._slides] - z[self._on] - self._through * u[self._on]
        across = (distance * line.conj()).imag
        return np.concatenate(
            (np.zeros(self.driven), np.stack((pin.real, pin.imag), 1).ravel(), np.stack((turn, across), 1).ravel())
        )

    def is_closed(self, pose: np.ndarray) -> bool:
        """Whether all pairs are closed."""
        return bool(np.abs(self._gaps(pose)).max(initial=0.0) < _OPEN)

    def rows(self, pose: np.ndarray) -> np.ndarray:
        """Jacobian J (m, 3n) at a pose, without the columns of the frame."""
        z, u = pose
        m = self.driven + 2 * self._a.size + 2 * self._on.size
        rows = np.zeros((m, 3 * (self.moving + 1)))
        first = self.driven + 2 * np.arange(self._a.size)
        for at, arms, sign in ((self._a, self._pa, -1.0), (self._b, self._pb, 1.0)):
            arm = 1j * arms * u[at]
            rows[first, 3 * at] = rows[first + 1, 3 * at + 1] = sign
            rows[first, 3 * at + 2], rows[first + 1, 3 * at + 2] = sign * arm.real, sign * arm.imag
        first = self.driven + 2 * self._a.size + 2 * np.arange(self._on.size)
        line = self._along * u[self._on]
        distance = z[self._slides] - z[self._on]
        for at, sign in ((self._on, -1.0), (self._slides, 1.0)):
            rows[first, 3 * at + 2] = sign
            rows[first + 1, 3 * at], rows[first + 1, 3 * at + 1] = -sign * line.imag, sign * line.real
        rows[first + 1, 3 * self._on + 2] = -(distance * line.conj()).real
        if self.driven:
            column, against = (3 * self._at[n] for n in (self._linkage.driver.link, self._linkage.driver.on))
            self._drive(rows[0], column, against, pose, line)
            for i, (link, on, ratio) in enumerate(self._second, 1):
                self._drive(rows[i], 3 * link, 3 * on, pose, line)
                driver = np.zeros_like(rows[i])
                self._drive(driver, column, against, pose, line)
                rows[i] -= ratio * driver
        return rows[:, : 3 * self.moving]

    def _drive(self, row: np.ndarray, column: int, against: int, pose: np.ndarray, line: np.ndarray) -> None:
        """Write into a row the velocity of a driven link against another, rotation or slide, by the columns of both."""
        ends = zip(3 * self._slides, 3 * self._on, strict=True)
        sliders = [i for i, pair in enumerate(ends) if {column, against} == {*pair}]
        if not sliders or (self._turns and column == 3 * self._at[self._linkage.driver.link]):
            row[column + 2], row[against + 2] = 1.0, -1.0
            return
        i = sliders[0]
        slides, on, along = self._slides[i], self._on[i], line[i]
        row[3 * slides : 3 * slides + 2] = along.real, along.imag
        row[3 * on : 3 * on + 2] = -along.real, -along.imag
        row[3 * on + 2] = -(1j * self._through[i] * pose[1][on] * along.conj()).real

    def _displaced(self, pose: np.ndarray, change: np.ndarray) -> np.ndarray:
        """The pose with a change (3n,) added to its coordinates."""
        parts = change.reshape(-1, 3)
        result = pose.copy()
        result[0, :-1] += parts[:, 0] + 1j * parts[:, 1]
        result[1, :-1] *= np.exp(1j * parts[:, 2])
        return result

    def _closed(self, pose: np.ndarray) -> np.ndarray:
        """The pose with its pairs closed as far as possible, by Newton's method with the shortest steps."""
        for _ in range(_ROUNDS):
            gaps = self._gaps(pose)
            if not gaps.size or np.abs(gaps).max() < _CLOSED:
                break
            rows = self.rows(pose)
            change = -np.linalg.lstsq(rows[self.driven :], gaps[self.driven :], rcond=_RANK)[0]
            longest = np.abs(change).max(initial=0.0)
            pose = self._displaced(pose, change * min(1.0, 0.5 / max(longest, 1e-300)))
        return pose

    def near(self, pose: np.ndarray) -> Iterable[np.ndarray]:
        """Two poses near this one, displaced in the free directions and closed again."""
        free, _ = _spaces(self.rows(pose)[self.driven :], self.moving)
        if not free.shape[1]:
            return
        for k in (1, 2):
            mixed = free @ np.cos(np.arange(1.0, free.shape[1] + 1) * k)
            longest = np.abs(mixed).max()
            if longest > 0.0:
                yield self._closed(self._displaced(pose, mixed * (_STEP / longest)))

    def moving_links(self, null: np.ndarray) -> tuple[int, ...]:
        """Numbers of the links that move in a null space (3n, k)."""
        if not null.shape[1]:
            return ()
        speed = np.abs(null).reshape(self.moving, -1).max(axis=1)
        return tuple(n for n, v in zip(self._numbers, speed.tolist(), strict=True) if v > _TINY)

    def dependent(self, rows: np.ndarray) -> tuple[int, ...]:
        """Moving links of the first rows that are linearly dependent."""
        for count in range(1, rows.shape[0] + 1):
            _, left = _spaces(rows[:count], self.moving)
            if left.shape[0]:
                break
        share = np.abs(left[0]) > _TINY * np.abs(left[0]).max()
        dependent_pairs = {(int(i) - self.driven) // 2 for i in np.flatnonzero(share) if i >= self.driven}
        joints: dict[int, set[str]] = {}
        for pair in dependent_pairs:
            name, *links = self._pairs[pair]
            for n in links:
                joints.setdefault(n, set()).add(name)
        return tuple(
            n for n in self._numbers if len(joints.get(n, ())) > 1
        )  # a link with one joint only carries others


# -- motion of an incomplete drawing with its driver ------------------------------------------------------------


_PATH, _LOOSE_PATH = (
    180,
    49,
)  # points of a path that the driver determines, and of another, which are assembled one by one
_AS_DRAWN = 1e-9  # [rad or m] a driver position nearer to the drawn one is equal to it


@frozen(eq=False)
class DrivenPart:
    """The part of an incomplete linkage that moves with its driver."""

    design: Design
    mechanism: Mechanism
    ranges: DriverRanges
    runs: CrankMotion | CompiledMotion

    @property
    def drawn_theta(self) -> float | None:
        """Angle [rad] of the crank or the cycle at the drawn driver position; None where the driver follows a motion."""
        drawn = self.mechanism.linkage.drawn
        return self.runs.theta(drawn_position(drawn)) if drawn and isinstance(self.runs, CrankMotion) else None

    def positions(self, theta: float) -> PointPositions:
        """Positions [mm] of all points at an angle [rad] of the crank, the cycle or the cam.

        Points that the driver does not determine move from their drawn positions as little as necessary.
        """
        linkage, part = self.design.drive.linkage, self.mechanism.linkage
        as_drawn = point_positions(linkage)
        state = self.runs.state(self.runs.angles(np.array([theta])))
        if linkage.drawn and abs(float(state.displacement[0][0]) - drawn_position(linkage.drawn)) < _AS_DRAWN:
            return as_drawn
        kinematics = solve_mechanism(self.mechanism, state, self.ranges)
        fixed = frame_link(linkage).places
        led = {
            name: complex(kinematics.bodies[body_name(link.number)].position(name)[0]) * 1e3
            for link in part.links
            for name in link.places
            if name not in fixed
        }
        positions = {**as_drawn, **led}
        try:
            return assembled_positions(linkage, positions, {*fixed, *led})
        except KindynaError:  # the other links do not reach: they stay as drawn
            return positions

    def paths(self, names: Collection[str]) -> dict[str, np.ndarray]:
        """Paths of points over the range of the driver.

        Parameters
        ----------
        names : collection of str
            Points; those that the driver does not determine move from their drawn positions as little as necessary.

        Returns
        -------
        dict of str to ndarray (n,) complex [mm]
        """
        state = self.runs.state(self.runs.angles(np.linspace(0.0, 2.0 * np.pi, _PATH, endpoint=False)))
        kinematics = solve_mechanism(self.mechanism, state, self.ranges)
        paths = {
            name: kinematics.bodies[body_name(link.number)].position(name) * 1e3
            for link in self.mechanism.linkage.links
            for name in link.places
            if link.number != FRAME_LINK and name in names
        }
        if others := [name for name in names if name not in paths]:
            poses = [self.positions(theta) for theta in np.linspace(0.0, 2.0 * np.pi, _LOOSE_PATH)]
            paths |= {name: np.array([pose[name] for pose in poses]) for name in others if name in poses[0]}
        return paths


def movable_part_of(design: Design, lack: Mobility) -> DrivenPart | None:
    """The part of a drawing that moves with its driver; without one, what the first possible driver would move; or None."""
    if lack.has_driver:
        return driven_part_of(design, lack)
    for number in lack.possible_drivers:
        with suppress(KindynaError):
            driven = with_driving_link(design, number)
            part = driven_part_of(driven, mobility(driven.drive.linkage))
            if part is not None:
                return part
    return None


def driven_part_of(design: Design, lack: Mobility) -> DrivenPart | None:
    """The part of an incomplete drawing that moves with its driver; None where nothing moves."""
    part = driven_part(design.drive.linkage, lack)
    if part is None or part.drawn is None:
        return None
    motion, crank = design.drive.motion, part.driver.kind == CRANK
    if not crank and motion is None:
        return None
    try:
        ranges = driver_ranges_of(part) if crank else driver_ranges_of(part, *motion_extent(program(motion)))
    except KindynaError:
        return None
    if not ranges.ranges:
        return None
    return DrivenPart(design, mechanism_of(part), ranges, CrankMotion(ranges) if crank else program(motion))
