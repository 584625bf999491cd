"""What a drawing lacks to be a mechanism: parts that hang loose, links that hold each other, a driver that is missing.

Not by counting pairs, but by the rank of the velocity equations J x' = 0 at the drawn pose and near it: where J has its full rank
anywhere, it has it almost everywhere, so that a dead centre is no loose part, and three cranks on one rod hold each other only where
they do not agree. Unknown are the velocities of all moving links, three numbers each, lengths in units of the size.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from core.design import CRANK, FRAME_LINK, Design, Linkage
from core.design.topology import driver_pair, driver_turns, gains, input_slides, is_pin, pins, solving_order
from core.errors import KindynaError
from core.frozen import frozen
from core.mechanism.drawn import Places, closed, drawn_place, frame_of, places_of
from core.mechanism.driver_ranges import DriverRanges, driver_ranges_of
from core.mechanism.drivers import CrankProgram, swept
from core.mechanism.mechanism import Mechanism, body_name, mechanism_of
from core.mechanism.solving import solve_mechanism
from core.motion import CompiledMotion, program
from core.numerics.derivatives import heading, vector

# -- what a drawing lacks to be a mechanism ---------------------------------------------------------------------


_TINY = 1e-7  # a velocity, or a share in a dependence, below this is none
_RANK = 1e-8  # of the largest singular value
_STEP = 0.03  # radians, and parts of the size, to the next pose
_ROUNDS = 12  # of Newton
_CLOSED = 1e-10
_OPEN = 1e-3  # of the size: a drawing that is open by more is not put together


@frozen
class Unfinished:
    """What a linkage lacks to be a mechanism.

    freedom   degrees of freedom that no driver leads
    surplus   conditions that are too many, so that the driver cannot move; ``doubled``: the links that hold each other
    redundant links that hold each other without need, near the drawn pose at least
    loose     links that move although the driver stands still; points: their ends that hang loose
    led       links that the driver moves, as far as they are determined
    drives    whether there is a driver; could: the links that could be
    """

    freedom: int
    surplus: int
    loose: tuple[int, ...]
    points: tuple[str, ...]
    doubled: tuple[int, ...]
    redundant: tuple[int, ...]
    led: tuple[int, ...]
    drives: bool
    could: tuple[int, ...]

    @property
    def finished(self) -> bool:
        """Nothing is lacking."""
        return self.drives and not self.freedom and not self.surplus

    @property
    def sentences(self) -> tuple[str, ...]:
        """What is lacking and what to do, a line each."""
        todo = []
        loose, verb = (
            (_and(self.points), "hang") if self.points else (_links(self.loose), "move") if self.drives else ("", "")
        )
        if loose and self.loose:
            many = len(self.points or self.loose) > 1
            it = "them" if many else "it"
            todo.append(f"{loose} {verb}{'' if many else 's'} loose: join {it} or ground {it}")
        if not self.drives:
            could = _links(self.could, "or")
            todo.append(f"let {could} drive" if could else "no link is held on the frame that could drive")
        found = []
        if self.freedom:
            plural = "s" if self.freedom > 1 else ""
            found.append(f"{self.freedom} degree{plural} of freedom without a driver: {'; '.join(todo)}")
        elif not self.drives:
            found.append("no degree of freedom: it cannot move")
        if self.surplus:
            held = (
                f"{_links(self.doubled)} hold each other"
                if len(self.doubled) > 1
                else f"{_links(self.doubled)} is held twice"
            )
            found.append(f"{self.surplus} too many: {held}")
        return tuple(found)


def _and(names: Sequence[str], word: str = "and") -> str:
    return f"{', '.join(names[:-1])} {word} {names[-1]}" if len(names) > 1 else "".join(names)


def _links(numbers: Sequence[int], word: str = "and") -> str:
    return "" if not numbers else f"link{'s' if len(numbers) > 1 else ''} {_and([str(n) for n in numbers], word)}"


def unfinished(linkage: Linkage) -> Unfinished:
    """What the linkage lacks, whose links, points and pairs are named without faults."""
    equations = _Equations(linkage)
    pose = equations.drawn()
    rows = equations.rows(pose)
    null, left = _spaces(rows, equations.moving)
    if null.shape[1] or left.shape[0]:  # at a dead centre more than near it
        for near in equations.near(pose):
            other = equations.rows(near)
            spaces = _spaces(other, equations.moving)
            if spaces[0].shape[1] < null.shape[1]:
                rows, (null, left) = other, spaces
    loose = equations.moved(null)
    free, _ = _spaces(rows[equations.driven :], equations.moving)
    moved = equations.moved(free)
    drives = bool(equations.driven)
    locked = null.shape[1] + equations.driven > free.shape[1] or not equations.meets(pose)
    held = equations.dependent(rows) if left.shape[0] else ()
    return Unfinished(
        freedom=null.shape[1],
        surplus=left.shape[0] if locked else 0,
        loose=loose,
        points=_loose_ends(linkage, loose),
        doubled=held if locked else (),
        redundant=() if locked else held,
        led=tuple(n for n in moved if n not in loose) if drives else (),
        drives=drives,
        could=() if drives else _could(linkage, moved),
    )


def holds_itself(linkage: Linkage) -> bool:
    """Whether more pairs hold the links of a linkage without faults than need be, and do not agree where it is drawn."""
    return bool(solving_order(linkage).redundant) and not unfinished(linkage).finished


def led_part(linkage: Linkage, lack: Unfinished) -> Linkage | None:
    """The part of an unfinished linkage that moves with its driver, by itself; None where there is none, or it is held twice."""
    if not lack.led or lack.surplus:
        return None
    kept = {FRAME_LINK, *lack.led}
    moved = set(lack.led) | set(lack.loose)
    kept |= {link.number for link in linkage.links if link.number not in moved}
    links = tuple(link for link in linkage.links if link.number in kept)
    names = {name for link in links for name in link.places}
    drawn = linkage.drawn and replace(linkage.drawn, points=tuple(p for p in linkage.drawn.points if p.name in names))
    sliders = tuple(s for s in linkage.sliders if {s.link, s.on} <= kept)
    joints = names | {str(s.link) for s in sliders}
    branch = tuple(side for side in linkage.branch if side.joint in joints)
    return replace(linkage, links=links, sliders=sliders, drawn=drawn, branch=branch)


def _could(linkage: Linkage, moved: Iterable[int]) -> tuple[int, ...]:
    """The links that move and are held on the frame, by a pin if any is."""
    held = {n: driver_pair(replace(linkage, driver=replace(linkage.driver, link=n, on=FRAME_LINK))) for n in moved}
    pinned = tuple(n for n, pair in held.items() if pair is not None and is_pin(pair))
    return pinned or tuple(n for n, pair in held.items() if pair is not None)


def _loose_ends(linkage: Linkage, loose: Sequence[int]) -> tuple[str, ...]:
    """The points by which loose links are to be joined: those on one link only, of links that one pair holds."""
    joined = pins(linkage)
    found: dict[str, None] = {}
    for link in linkage.links:
        count = sum(link.number in pin.links for pin in joined)
        count += sum(link.number in (s.link, s.on) for s in linkage.sliders)
        if link.number in loose and count < 2:
            held = {pin.name for pin in joined}
            found |= dict.fromkeys(name for name in link.places if name not in held)
    return tuple(found)


def _spaces(rows: np.ndarray, moving: int) -> tuple[np.ndarray, np.ndarray]:
    """What rows (m, 3n) leave free (3n, k), and how they depend on each other (r, m)."""
    if not rows.size:
        return np.eye(3 * moving), np.zeros((rows.shape[0], rows.shape[0]))
    u, s, vh = np.linalg.svd(rows)
    rank = int((s > _RANK * s[0]).sum())
    return vh[rank:].T, u[:, rank:].T


class _Equations:
    """The velocity equations of a linkage: columns x, y, turn of each moving link, rows the driver and then its pairs, two each."""

    def __init__(self, linkage: Linkage) -> None:
        self._linkage = linkage
        self._numbers = [link.number for link in linkage.links if link.number != FRAME_LINK]
        self.moving = len(self._numbers)
        self._at = {n: i for i, n in enumerate(self._numbers)} | {FRAME_LINK: self.moving}
        places = {link.number: link.places for link in linkage.links}
        extents = [abs(z - w) for at in places.values() for z in at.values() for w in at.values()]
        self._size = max([*extents, 1e-9])
        self._places = {n: {name: z / self._size for name, z in at.items()} for n, at in places.items()}
        joined = [(pin, pin.links[0], n) for pin in pins(linkage) for n in pin.links[1:]]
        self._pairs: list[tuple[str, int, int]] = [(pin.name, a, b) for pin, a, b in joined]
        self._pairs += [(str(s.link), s.on, s.link) for s in linkage.sliders]
        self._a = np.array([self._at[a] for _, a, _ in joined], dtype=int)
        self._b = np.array([self._at[b] for _, _, b in joined], dtype=int)
        self._pa = np.array([self._places[a][pin.name] for pin, a, _ in joined], dtype=complex)
        self._pb = np.array([self._places[b][pin.name] for pin, _, b in joined], dtype=complex)
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
                self._at[each.link],
                self._at[each.on],
                ratios[each.link] * length ** (input_slides(linkage, each) * -1.0 + (not driver_turns(linkage))),
            )
            for each in linkage.drivers
            if drives and {each.link, each.on} <= self._at.keys() and each.link in ratios
        ]
        self.driven = int(drives) + len(self._second)
        self._turns = pair is None or is_pin(pair) or linkage.driver.kind == CRANK

    def drawn(self) -> np.ndarray:
        """Origin and x axis (2, n + 1) complex of every link where it is drawn, put together as nearly as it can be."""
        drawn = self._linkage.drawn
        sheet = {name: z / self._size for name, z in drawn.places.items()} if drawn else {}
        sheet |= self._places.get(FRAME_LINK, {})
        pose = np.zeros((2, self.moving + 1), dtype=complex)
        pose[1] = 1.0
        lines = {s.link: e for s, e in zip(self._linkage.sliders, self._along, strict=True) if s.on == FRAME_LINK}
        for n in self._numbers:
            i, own = self._at[n], self._places[n]
            known = [name for name in own if name in sheet]
            here, there = (np.array([at[name] for name in known], dtype=complex) for at in (own, sheet))
            axis = lines.get(n, 1.0 + 0j)
            if (
                n == self._linkage.driver.link
                and self._linkage.driver.on == FRAME_LINK
                and drawn is not None
                and drawn.driver_deg is not None
            ):
                axis = heading(np.deg2rad(drawn.driver_deg))
            if len(known) > 1:
                turned = np.vdot(here - here.mean(), there - there.mean())
                axis = turned / abs(turned) if abs(turned) > 0.0 else axis
            pose[1, i] = axis
            pose[0, i] = (there.mean() - here.mean() * axis) if known else 0j
        return self._closed(pose)

    def _gaps(self, pose: np.ndarray) -> np.ndarray:
        """How far every pair is open (m,), the driver's row 0."""
        z, u = pose
        pin = z[self._b] + self._pb * u[self._b] - z[self._a] - self._pa * u[self._a]
        line = self._along * u[self._on]
        turn = np.angle(u[self._slides] / line) if line.size else np.zeros(0)
        away = z[self._slides] - z[self._on] - self._through * u[self._on]
        across = (away * line.conj()).imag
        return np.concatenate(
            (np.zeros(self.driven), np.stack((pin.real, pin.imag), 1).ravel(), np.stack((turn, across), 1).ravel())
        )

    def meets(self, pose: np.ndarray) -> bool:
        """Whether all pairs are closed."""
        return bool(np.abs(self._gaps(pose)).max(initial=0.0) < _OPEN)

    def rows(self, pose: np.ndarray) -> np.ndarray:
        """J (m, 3n) at a pose; the frame's columns are left out."""
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
        away = z[self._slides] - z[self._on]
        for at, sign in ((self._on, -1.0), (self._slides, 1.0)):
            rows[first, 3 * at + 2] = sign
            rows[first + 1, 3 * at], rows[first + 1, 3 * at + 1] = -sign * line.imag, sign * line.real
        rows[first + 1, 3 * self._on + 2] = -(away * line.conj()).real
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
        """Into a row how a link that is driven turns against another, or slides on it: by the columns of both."""
        ends = zip(3 * self._slides, 3 * self._on, strict=True)
        own = [i for i, pair in enumerate(ends) if {column, against} == {*pair}]
        if not own or (self._turns and column == 3 * self._at[self._linkage.driver.link]):
            row[column + 2], row[against + 2] = 1.0, -1.0
            return
        slides, on, along = self._slides[own[0]], self._on[own[0]], line[own[0]]
        row[3 * slides : 3 * slides + 2] = along.real, along.imag
        row[3 * on : 3 * on + 2] = -along.real, -along.imag
        row[3 * on + 2] = -(1j * self._through[own[0]] * pose[1][on] * along.conj()).real

    def _moved(self, pose: np.ndarray, change: np.ndarray) -> np.ndarray:
        """A pose with all coordinates changed (3n,)."""
        parts = change.reshape(-1, 3)
        there = pose.copy()
        there[0, :-1] += parts[:, 0] + 1j * parts[:, 1]
        there[1, :-1] *= np.exp(1j * parts[:, 2])
        return there

    def _closed(self, pose: np.ndarray) -> np.ndarray:
        """The pose with its pairs closed by the shortest steps of Newton, as far as they can be."""
        for _ in range(_ROUNDS):
            gaps = self._gaps(pose)
            if not gaps.size or np.abs(gaps).max() < _CLOSED:
                break
            rows = self.rows(pose)
            change = -np.linalg.lstsq(rows[self.driven :], gaps[self.driven :], rcond=_RANK)[0]
            longest = np.abs(change).max(initial=0.0)
            pose = self._moved(pose, change * min(1.0, 0.5 / max(longest, 1e-300)))
        return pose

    def near(self, pose: np.ndarray) -> Iterable[np.ndarray]:
        """Two poses near this one, reached as far as its pairs let it move, and closed again."""
        free, _ = _spaces(self.rows(pose)[self.driven :], self.moving)
        if not free.shape[1]:
            return
        for k in (1, 2):
            mixed = free @ np.cos(np.arange(1.0, free.shape[1] + 1) * k)
            longest = np.abs(mixed).max()
            if longest > 0.0:
                yield self._closed(self._moved(pose, mixed * (_STEP / longest)))

    def moved(self, null: np.ndarray) -> tuple[int, ...]:
        """The links that move in what is left free (3n, k)."""
        if not null.shape[1]:
            return ()
        speed = np.abs(null).reshape(self.moving, -1).max(axis=1)
        return tuple(n for n, v in zip(self._numbers, speed.tolist(), strict=True) if v > _TINY)

    def dependent(self, rows: np.ndarray) -> tuple[int, ...]:
        """The moving links of the first pairs that hold each other: the fewest before which no row depends on those before it."""
        for count in range(1, rows.shape[0] + 1):
            _, left = _spaces(rows[:count], self.moving)
            if left.shape[0]:
                break
        share = np.abs(left[0]) > _TINY * np.abs(left[0]).max()
        held = {(int(i) - self.driven) // 2 for i in np.flatnonzero(share) if i >= self.driven}
        joints: dict[int, set[str]] = {}
        for pair in held:
            name, *links = self._pairs[pair]
            for n in links:
                joints.setdefault(n, set()).add(name)
        return tuple(n for n in self._numbers if len(joints.get(n, ())) > 1)  # with one joint it only carries others


# -- the part of an unfinished drawing that its driver leads, as it moves ---------------------------------------


_AS_DRAWN = 1e-9  # rad or m: the driver stands where it is drawn


@frozen(eq=False)
class LedPart:
    """What moves with the driver of a drawing that is no mechanism yet."""

    design: Design
    mechanism: Mechanism
    ranges: DriverRanges
    runs: CrankProgram | CompiledMotion

    @property
    def drawn_theta(self) -> float | None:
        """The angle [rad] of the crank, or of the cycle, at which the driver stands as it is drawn; None of one that follows a motion."""
        drawn = self.mechanism.linkage.drawn
        return self.runs.theta(drawn_place(drawn)) if drawn and isinstance(self.runs, CrankProgram) else None

    def places(self, theta: float) -> Places:
        """Where all points stand [mm] at an angle [rad] of the crank, the cycle or the cam.

        Those of the rest are moved from where they are drawn, as little as need be.
        """
        linkage, part = self.design.drive.linkage, self.mechanism.linkage
        as_drawn = places_of(linkage)
        state = self.runs.state(self.runs.angles(np.array([theta])))
        if linkage.drawn and abs(float(state.displacement[0][0]) - drawn_place(linkage.drawn)) < _AS_DRAWN:
            return as_drawn
        kinematics = solve_mechanism(self.mechanism, state, self.ranges)
        fixed = frame_of(linkage).places
        led = {
            name: complex(kinematics.bodies[body_name(link.number)].place(name)[0]) * 1e3
            for link in part.links
            for name in link.places
            if name not in fixed
        }
        places = {**as_drawn, **led}
        try:
            return closed(linkage, places, {*fixed, *led})
        except KindynaError:  # the rest does not reach: it stays where it is drawn
            return places


def led_part_of(design: Design, lack: Unfinished) -> LedPart | None:
    """What moves with the driver of an unfinished drawing; None where nothing does."""
    part = led_part(design.drive.linkage, lack)
    if part is None or part.drawn is None:
        return None
    motion, crank = design.drive.motion, part.driver.kind == CRANK
    if not crank and motion is None:
        return None
    try:
        ranges = driver_ranges_of(part) if crank else driver_ranges_of(part, *swept(program(motion)))
    except KindynaError:
        return None
    if not ranges.ranges:
        return None
    return LedPart(design, mechanism_of(part), ranges, CrankProgram(ranges) if crank else program(motion))
