"""What is solved: a linkage in a frame of its own, where that frame stands, what drives it, and what its parts are called."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np

from core.design import FRAME_LINK, Linkage
from core.design.topology import GROUP, INPUT, SolutionStep
from core.errors import NoSolution
from core.frozen import frozen
from core.mechanism.branches import Branch
from core.mechanism.dyads import DYADS, DyadSolution, pin_of, placed, turned_like
from core.mechanism.groups import GroupSolution, group_solution, newton
from core.mechanism.kinematics import FRAME, FRAME_POSE, REVOLUTE, SLIDING, Dyad, Pair, Pose
from core.mechanism.linkage import Joint, JointEnd, SolutionPlan, plan_of, planned
from core.motion import MotionState, largest_rate, motion_at, program
from core.numerics.derivatives import Derivatives, body_vector, constant, cross, heading, product, scaled, sum_of, unit

# -- all links of a linkage at any positions of its driver, step by step ----------------------------------------


@frozen(eq=False)
class InputSolution:
    """A second driving link: where it is."""

    pose: Pose


@frozen(eq=False)
class Solved:
    """Link -> pose (the frame included), NaN where it cannot be assembled; what each step found."""

    poses: dict[int, Pose]
    steps: tuple[DyadSolution | GroupSolution | InputSolution, ...]


def driver_pose(plan: SolutionPlan, q: Derivatives) -> Pose:
    """The driving link at q: its angle [rad] where it is pinned to the frame, else its slide [m]."""
    on, own = plan.driver.first, plan.driver.second
    if plan.driver.revolute:
        pin = constant(on.point)
        return placed(pin, own.point, lambda: unit(q[0]), q)
    turned = on.along / own.along
    start = on.point - own.point * turned
    origin = Derivatives(lambda order: q[order] * on.along if order else q[0] * on.along + start)
    return Pose(origin, constant(np.angle(turned)), unit=np.atleast_1d(turned))


def at_driver(values: np.ndarray) -> Derivatives:
    """Driver positions (n,) as q at unit speed: then every derivative is by the driver's coordinate."""
    return Derivatives.of((values, np.ones(1), np.zeros(1), np.zeros(1)))


def solve(plan: SolutionPlan, q: Derivatives, branch: Branch, steps: int | None = None) -> Solved:
    """The poses of all links for the driver at q (n,) [rad or m], NaN where links do not meet; with three derivatives by what
    q's are by: the motion's angle, or the driver's own coordinate.

    branch: sides beyond change points, and where Newton starts; steps: solve only so many of the plan's.
    """
    poses: dict[int, Pose] = {FRAME_LINK: FRAME_POSE}
    if not plan.inner:
        poses[plan.linkage.driver.link] = driver_pose(plan, q)
    found: list[DyadSolution | GroupSolution | InputSolution] = []
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for i, (step, joints) in enumerate(plan.steps[:steps]):
            if step.kind == GROUP:
                found.append(_grouped(plan, i, q, branch, poses))
                continue
            if step.kind == INPUT:
                poses[step.links[0]] = _driven_too(plan, step.links[0], joints[0], q, poses)
                found.append(InputSolution(poses[step.links[0]]))
                continue
            closed = DYADS[step.kind](poses, joints, branch.side(i, plan.side(step.joint), q[0]))
            poses[step.links[0]], poses[step.links[1]] = closed.poses
            for bridge in branch.bridges.get(i, ()):
                bridge.apply(q, poses)
            found.append(closed)
    return Solved(poses, tuple(found))


def _driven_too(plan: SolutionPlan, link: int, pin: Joint, q: Derivatives, poses: dict[int, Pose]) -> Pose:
    """A second driving link: its angle against another link, or its place on the line there, is ratio q + offset; its angle that of its
    own motion at q."""
    row, own = next(each for each in plan.linkage.drivers if each.link == link), plan.linkage.own_motions.get(link)
    given = scaled(q, plan.gains[link]) if own is None else motion_at(program(own), q)
    if not pin.revolute:
        return _slid(pin, given, row.offset_mm * 1e-3, poses[row.on])
    turned = sum_of(poses[row.on].turn, given)
    offset = np.deg2rad(row.offset_deg)
    angle = Derivatives(lambda order: turned[order] if order else turned[0] + offset)
    return placed(pin_of(poses, pin.first), pin.second.point, lambda: unit(angle[0]), angle)


def _slid(pair: Joint, given: Derivatives, offset: float, on: Pose) -> Pose:
    """A link on the line of a known one: given + offset [m] on from where their points lie on each other."""
    heading, turn = turned_like(on, pair.first.along / pair.second.along)
    place = Derivatives(lambda order: given[order] if order else given[0] + offset)
    at = sum_of(on.carried(pair.first.point), product(body_vector(pair.first.along * on.unit, on.turn), place))
    return placed(at, pair.second.point, heading, turn)


def _grouped(plan: SolutionPlan, index: int, q: Derivatives, branch: Branch, poses: dict[int, Pose]) -> GroupSolution:
    group = plan.group(index)
    x, last = newton(group, poses, q, branch.tracks[index].start(q[0]))
    x[:, ~(last < LARGEST_CORRECTION)] = np.nan
    result = group_solution(group, poses, q, x)
    poses.update(result.poses)
    return result


LARGEST_CORRECTION = 1e-8
"""A last correction of Newton larger than this, relative to the size, is no position."""


# -- what rounding leaves of each link's pose, carried from the frame outwards ----------------------------------


@frozen(eq=False)
class ErrorBound:
    """Bounds of the errors of a link's origin [m] and angle [rad], in units of eps."""

    origin: np.ndarray
    angle: np.ndarray


def error_bounds(plan: SolutionPlan, solved: Solved) -> dict[int, ErrorBound]:
    """The bounds (n,) for every link.

    A dyad's coordinates x answer an error δ of its loop by |δ||c_other|/|c1 × c2|; the loop's own rounding is relative
    to the size of its terms.
    """
    poses = solved.poses
    zero = np.zeros(1)
    driver = plan.driver
    turned = np.ones(1) if driver.revolute else zero
    found = {FRAME_LINK: ErrorBound(zero, zero)}
    if not plan.inner:
        found[plan.linkage.driver.link] = ErrorBound(
            abs(driver.first.point) + abs(driver.second.point) * turned + 1e-300, turned
        )
    with np.errstate(divide="ignore", invalid="ignore"):
        for (step, joints), result in zip(plan.steps, solved.steps, strict=True):
            if isinstance(result, InputSolution):
                _input(plan, step.links[0], joints[0], poses, found)
            elif isinstance(result, GroupSolution):
                _group(step, joints, result, poses, found)
            else:
                _dyad(step, joints, result, poses, found)
    return found


def condition(plan: SolutionPlan, solved: Solved) -> np.ndarray:
    """(n,) the largest bound of any link, its whole length turned by its angle's error, relative to the size."""
    rows = [d.origin / plan.size + d.angle for d in error_bounds(plan, solved).values()]
    worst = np.max(np.broadcast_arrays(*rows), axis=0)
    return np.where(np.isnan(worst), np.inf, 4.0 * worst + 4.0)  # at a dead centre 0 · ∞ of a pin at its link's origin


def _at(held: JointEnd, poses: dict[int, Pose], found: dict[int, ErrorBound]) -> np.ndarray:
    """Of a point of a known link."""
    bound = found[held.link]
    return np.asarray(
        bound.origin + abs(held.point) * bound.angle + np.abs(poses[held.link].origin[0]) + abs(held.point)
    )


def _input(plan: SolutionPlan, link: int, pin: Joint, poses: dict[int, Pose], found: dict[int, ErrorBound]) -> None:
    """Its angle goes by the driver's, its place by its pin; of what slides the place on the line by the driver's."""
    on = next(each.on for each in plan.linkage.drivers if each.link == link)
    own = plan.linkage.own_motions.get(link)
    slope = abs(plan.gains[link]) if own is None else largest_rate(own)
    if not pin.revolute:
        angle = found[on].angle + 1.0
        reach = np.abs(poses[link].origin[0] - poses[on].origin[0])
        slid = slope * (1.0 + 2.0 * np.pi) + reach * (1.0 + angle)
        found[link] = ErrorBound(_at(pin.first, poses, found) + slid + abs(pin.second.point) * (1.0 + angle), angle)
        return
    angle = found[on].angle + 1.0 + slope * (1.0 + 2.0 * np.pi * (plan.linkage.turns or 1))
    found[link] = ErrorBound(_at(pin.first, poses, found) + abs(pin.second.point) * (1.0 + angle), angle)


def _dyad(
    step: SolutionStep,
    joints: tuple[Joint, ...],
    closed: DyadSolution,
    poses: dict[int, Pose],
    found: dict[int, ErrorBound],
) -> None:
    """A link that slides keeps its angle against what it slides on; along a known guide it goes by its coordinate."""
    a, b = step.links
    outer_a, inner, outer_b = joints
    c1, c2 = closed.columns
    det = np.abs(cross(c1, c2))
    at_a, at_b = (_at(outer.first, poses, found) for outer in (outer_a, outer_b))
    guide_a, guide_b = (found[outer.first.link].angle + 1.0 for outer in (outer_a, outer_b))
    turned = sum(guide - 1.0 for guide, outer in ((guide_a, outer_a), (guide_b, outer_b)) if not outer.revolute)
    miss = at_a + at_b + closed.reach * (2.0 + turned)
    x1, x2 = 2.0 + np.abs(c2) * miss / det, 2.0 + np.abs(c1) * miss / det
    angle_b = (x2 if inner.revolute else x1) if outer_b.revolute else guide_b
    angle_a = (x1 if inner.revolute else angle_b) if outer_a.revolute else guide_a
    placed_a = outer_a.second if outer_a.revolute else inner.first
    placed_b = inner.second if inner.revolute and not outer_b.revolute else outer_b.second
    slid_a, slid_b = (0.0 if outer.revolute else x + miss for outer, x in ((outer_a, x1), (outer_b, x2)))
    found[a] = ErrorBound(at_a + slid_a + abs(placed_a.point) * angle_a, angle_a)
    found[b] = ErrorBound(at_b + slid_b + abs(placed_b.point) * angle_b, angle_b)


def _group(
    step: SolutionStep,
    joints: tuple[Joint, ...],
    result: GroupSolution,
    poses: dict[int, Pose],
    found: dict[int, ErrorBound],
) -> None:
    """By the size of J's inverse; lengths there are in units of the size."""
    known = [_at(h, poses, found) for j in joints for h in (j.first, j.second) if h.link not in step.links]
    size = max(abs(h.point) for j in joints for h in (j.first, j.second)) or 1.0
    inverse = np.full(result.determinant.shape, np.inf)
    fine = np.isfinite(result.determinant) & (result.determinant != 0.0)
    inverse[fine] = np.abs(np.linalg.pinv(result.matrix[fine])).sum(axis=2).max(axis=1)
    miss = np.max(np.broadcast_arrays(*known), axis=0) / size + 8.0
    for link in step.links:
        found[link] = ErrorBound(size * inverse * miss + np.abs(poses[link].origin[0]), inverse * miss + 1.0)


# -- what is solved ---------------------------------------------------------------------------------------------


ROLLER = "roller"


def _none() -> Mapping[Any, Any]:
    return MappingProxyType({})


@frozen
class ReferencePoint:
    """The point of a link that the cam acts on: a roller's centre, the centre of a shoe, a knife's edge.

    ``body`` is the name of the body that stands for it: the link's own where the point is its origin.
    """

    link: int
    point: str
    body: str = ROLLER


@frozen(eq=False)
class Mechanism:
    """A linkage ready to be solved, and how it is read.

    linkage      links, pairs and driver, in the mechanism's own frame
    place, turn  of that frame in the global one: its origin [m], complex, and the angle of its x axis [rad]
    start, sense the driver stands at q = start + sense y, y the motion [m or rad]
    bodies       link -> name of its body
    pairs        joint -> name of the pair; by: joint -> link that exerts the force which tables name so (else the one
                 that is solved first); points: joint of a sliding pair -> name of the point of the link that slides
    coordinates  name as in tables -> link (its angle in the own frame) or joint of a sliding pair (its slide)
    angles       link -> its angle in the own frame at the base position [rad], whole turns included
    base         the base position: name -> (value in SI, unit)
    singular     joint of a dyad -> code of the finding where the sine of its transmission angle vanishes; more:
                 further codes, from the solved poses in the own frame
    ranged       its links are laid out one by one: where the driver can move is searched, and bodies go by number
    refuse       the answer where links do not meet or lie in line, from the motion, the solution and where it is lost (n,)
    require      start, motion: raises NoSolution for a motion that the mechanism cannot follow although its links meet
    """

    linkage: Linkage
    bodies: Mapping[int, str]
    reference: ReferencePoint | None = None
    place: complex = 0j
    turn: float = 0.0
    start: float = 0.0
    sense: float = 1.0
    pairs: Mapping[str, str] = field(default_factory=_none)
    by: Mapping[str, int] = field(default_factory=_none)
    points: Mapping[str, str] = field(default_factory=_none)
    coordinates: Mapping[str, int | str] = field(default_factory=_none)
    angles: Mapping[int, float] = field(default_factory=_none)
    base: Mapping[str, tuple[float, str]] = field(default_factory=_none)
    singular: Mapping[str, str] = field(default_factory=_none)
    more_singular: Callable[[Solved], Mapping[str, np.ndarray]] | None = None
    ranged: bool = False
    refuse: Callable[[MotionState, Solved, np.ndarray], NoSolution] | None = None
    require: Callable[[float, MotionState], None] | None = None

    @cached_property
    def plan(self) -> SolutionPlan:
        """What solving its linkage needs."""
        return plan_of(self.linkage) if self.ranged else planned(self.linkage)  # built anew for each length

    @cached_property
    def pair_names(self) -> Mapping[Joint, str]:
        """Every pair with its name, the driver's first; further links on one pin add theirs."""
        names: dict[Joint, str] = {}
        for joint in self.plan.joints:
            name = self.pairs.get(joint.name, joint.name)
            taken = name in names.values()
            names[joint] = f"{name}_{self.bodies[joint.second.link]}" if taken else name
        return MappingProxyType(names)

    @cached_property
    def joined(self) -> Mapping[str, Pair]:
        """Name -> pair as the kinematics has it."""
        return MappingProxyType({name: self._pair(joint) for joint, name in self.pair_names.items()})

    def _pair(self, joint: Joint) -> Pair:
        on, body = joint.first.link, joint.second.link
        name = self.points.get(joint.name, joint.name)
        if not joint.revolute:
            along = joint.first.along
            if on == FRAME_LINK:
                along = along * heading(self.turn)
            return Pair(SLIDING, self._name(on), self._name(body), name, along)
        if self.by.get(joint.name) == body:
            on, body = body, on
        return Pair(REVOLUTE, self._name(on), self._name(body), name)

    def _name(self, link: int) -> str:
        return self.bodies.get(link, FRAME)

    @cached_property
    def dyads(self) -> tuple[Dyad, ...]:
        """Dyads and groups, those that are solved last first."""
        names, bodies, linkage = self.pair_names, self.bodies, self.linkage
        on = {each.link: self._name(each.on) for each in linkage.drivers}
        ratios, own = (self.plan.gains, linkage.own_motions) if on else ({}, {})
        return tuple(
            Dyad(
                step.kind, tuple(bodies[n] for n in step.links), tuple(names[j] for j in joints),
                on.get(step.links[0], "") if step.kind == INPUT else "", ratios.get(step.links[0], 0.0),
                step.links[0] in own and step.kind == INPUT,
                names[self.plan.driver] if self.plan.inner and self.plan.driver in joints else "",
            )
            for step, joints in reversed(self.plan.steps)
        )  # fmt: skip

    @cached_property
    def places(self) -> Mapping[int, Mapping[str, complex]]:
        """Link -> name -> point in its frame [m]; of sliding pairs too."""
        found = {link: dict(points) for link, points in self.plan.points.items()}
        for joint in self.plan.joints:
            if not joint.revolute:
                for held in (joint.first, joint.second):
                    found[held.link].setdefault(self.points.get(joint.name, joint.name), held.point)
        return MappingProxyType({link: MappingProxyType(points) for link, points in found.items()})

    def place_of(self, link: int, point: str) -> tuple[str, complex]:
        """A named point of a link as a body and a place [m] in its frame, of the frame in the global one. Raises KeyError."""
        at = self.plan.points[link][point]
        if link not in self.bodies:
            return FRAME, self.place + at * heading(self.turn)
        return self.bodies[link], at

    @cached_property
    def ground(self) -> str:
        """The pair that holds the reference's link, or the driver, on the frame; empty where none does."""
        link = self.linkage.driver.link if self.reference is None else self.reference.link
        held = (name for j, name in self.pair_names.items() if {j.first.link, j.second.link} == {FRAME_LINK, link})
        return next(held, "")


def body_name(link: int) -> str:
    """The name of a link of a [linkage] among the bodies."""
    return FRAME if link == FRAME_LINK else f"link{link}"


def link_number(body: str) -> int:
    """The number of the link that is this body of a [linkage]."""
    return FRAME_LINK if body == FRAME else int(body.removeprefix("link"))


def mechanism_of(linkage: Linkage, reference: ReferencePoint | None = None) -> Mechanism:
    """A [linkage] of the file as it stands: its frame is the global one, its bodies are called by their links' numbers."""
    sliding = {str(s.link): s.link for s in linkage.sliders}
    names = MappingProxyType({n: body_name(n) for n in sorted(linkage.by_number)})
    coordinates: dict[str, int | str] = {name: n for n, name in names.items() if n != FRAME_LINK}
    coordinates.update({f"slide{joint}": joint for joint in sliding})
    return Mechanism(linkage, names, reference, coordinates=MappingProxyType(coordinates), ranged=True)
