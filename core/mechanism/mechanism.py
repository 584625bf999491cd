"""Position solution of a linkage, bounds of its rounding errors, and the mechanism: a linkage with its frame, driver and names."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, replace
from functools import lru_cache
from types import MappingProxyType
from typing import Any

import numpy as np

from core.design import FRAME_LINK, Linkage
from core.design.topology import GROUP, INPUT, SolutionStep, is_pin
from core.errors import NoSolution
from core.frozen import frozen
from core.mechanism.branches import Branch
from core.mechanism.dyads import DYADS, DyadSolution, pin_of, pose_through, turned_like
from core.mechanism.groups import GroupSolution, group_solution, newton
from core.mechanism.kinematics import FRAME, FRAME_POSE, REVOLUTE, SLIDING, Dyad, Pair, Pose
from core.mechanism.linkage import Ends, Joint, JointEnd, PlanStructure, SolutionPlan, new_plan, plan_of
from core.motion import MotionState, largest_rate, motion_at, program
from core.numerics.derivatives import Derivatives, body_vector, constant, cross, heading, product, scaled, sum_of, unit
from core.numerics.lazy import lazy

# -- solution of all links, step by step ------------------------------------------------------------------------


@frozen(eq=False)
class InputSolution:
    """Pose of a second driving link."""

    pose: Pose


@frozen(eq=False)
class LinkageSolution:
    """Pose of each link, the frame included, NaN where it cannot be assembled; and the solution of each step."""

    poses: dict[int, Pose]
    steps: tuple[DyadSolution | GroupSolution | InputSolution, ...]


def driver_pose(plan: SolutionPlan, q: Derivatives) -> Pose:
    """Pose of the driving link: q (n,) is its angle [rad] where it is pinned to the frame, else its slide [m]."""
    on, end = plan.driver.first, plan.driver.second
    if plan.driver.revolute:
        pin = constant(on.point)
        return pose_through(pin, end.point, lambda: unit(q[0]), q)
    direction = on.along / end.along
    start = on.point - end.point * direction
    origin = Derivatives(lambda order: q[order] * on.along if order else q[0] * on.along + start)
    return Pose(origin, constant(np.angle(direction)), unit=np.atleast_1d(direction))


def at_driver(values: np.ndarray) -> Derivatives:
    """Driver coordinate q with q' = 1 and no higher derivatives, so that every derivative is by the driver's coordinate.

    Parameters
    ----------
    values : ndarray (n,) [rad or m]
        Driver positions.

    Returns
    -------
    Derivatives
    """
    return Derivatives.of((values, np.ones(1), np.zeros(1), np.zeros(1)))


def solve(plan: SolutionPlan, q: Derivatives, branch: Branch, steps: int | None = None) -> LinkageSolution:
    """Poses of all links with three derivatives, NaN where links do not meet.

    Parameters
    ----------
    plan : SolutionPlan
    q : Derivatives
        Driver position (n,) [rad or m]; its derivatives are by the motion's angle or by the driver's coordinate, and those of the
        poses are by the same.
    branch : Branch
        Sides beyond change points, and first guesses of groups.
    steps : int, optional
        Number of steps of the plan to solve; all by default.

    Returns
    -------
    LinkageSolution
    """
    poses: dict[int, Pose] = {FRAME_LINK: FRAME_POSE}
    if not plan.is_inner:
        poses[plan.linkage.driver.link] = driver_pose(plan, q)
    solutions: list[DyadSolution | GroupSolution | InputSolution] = []
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for i, (step, joints) in enumerate(plan.steps[:steps]):
            if step.kind == GROUP:
                solutions.append(_solve_group(plan, i, q, branch, poses))
                continue
            if step.kind == INPUT:
                poses[step.links[0]] = _second_driver_pose(plan, step.links[0], joints[0], q, poses)
                solutions.append(InputSolution(poses[step.links[0]]))
                continue
            dyad = DYADS[step.kind](poses, joints, branch.side(i, plan.side(step.joint), q[0]))
            poses[step.links[0]], poses[step.links[1]] = dyad.poses
            for bridge in branch.bridges.get(i, ()):
                bridge.apply(q, poses)
            solutions.append(dyad)
    return LinkageSolution(poses, tuple(solutions))


def _second_driver_pose(plan: SolutionPlan, link: int, pin: Joint, q: Derivatives, poses: dict[int, Pose]) -> Pose:
    """Pose of a second driving link: its coordinate is ratio q + offset, or its separate motion at q plus the offset."""
    row, motion = next(row for row in plan.linkage.drivers if row.link == link), plan.linkage.own_motions.get(link)
    coordinate = scaled(q, plan.gains[link]) if motion is None else motion_at(program(motion), q)
    if not pin.revolute:
        return _sliding_pose(pin, coordinate, row.offset_mm * 1e-3, poses[row.on])
    turn = sum_of(poses[row.on].turn, coordinate)
    offset = np.deg2rad(row.offset_deg)
    angle = Derivatives(lambda order: turn[order] if order else turn[0] + offset)
    return pose_through(pin_of(poses, pin.first), pin.second.point, lambda: unit(angle[0]), angle)


def _sliding_pose(pair: Joint, coordinate: Derivatives, offset: float, on: Pose) -> Pose:
    """Pose of a link on the line of a known one: its point is coordinate + offset [m] from the line's point."""
    heading, turn = turned_like(on, pair.first.along / pair.second.along)
    slide = Derivatives(lambda order: coordinate[order] if order else coordinate[0] + offset)
    at = sum_of(on.fixed_point(pair.first.point), product(body_vector(pair.first.along * on.unit, on.turn), slide))
    return pose_through(at, pair.second.point, heading, turn)


def _solve_group(
    plan: SolutionPlan, index: int, q: Derivatives, branch: Branch, poses: dict[int, Pose]
) -> GroupSolution:
    """Solution of a group, whose poses are added to `poses`."""
    group = plan.group(index)
    x, last = newton(group, poses, q, branch.tracks[index].first_guess(q[0]))
    x[:, ~(last < LARGEST_CORRECTION)] = np.nan
    result = group_solution(group, poses, q, x)
    poses.update(result.poses)
    return result


LARGEST_CORRECTION = 1e-8
"""Newton's method has failed where its last correction, relative to the size, is larger."""


# -- bounds of rounding errors ----------------------------------------------------------------------------------


@frozen(eq=False)
class ErrorBound:
    """Bounds of the rounding errors of a link's pose, in units of the machine epsilon.

    Attributes
    ----------
    origin : ndarray (n,) [m]
    angle : ndarray (n,) [rad]
    """

    origin: np.ndarray
    angle: np.ndarray


def error_bounds(plan: SolutionPlan, solution: LinkageSolution) -> dict[int, ErrorBound]:
    """Error bounds of every link, accumulated from the frame outwards.

    An error δ of a dyad's loop changes its coordinates x1, x2 by |δ||c2|/|c1 × c2| and |δ||c1|/|c1 × c2|. The rounding error of the
    loop is relative to the size of its terms.
    """
    poses = solution.poses
    zero = np.zeros(1)
    driver = plan.driver
    rotation = np.ones(1) if driver.revolute else zero
    bounds = {FRAME_LINK: ErrorBound(zero, zero)}
    if not plan.is_inner:
        bounds[plan.linkage.driver.link] = ErrorBound(
            abs(driver.first.point) + abs(driver.second.point) * rotation + 1e-300, rotation
        )
    with np.errstate(divide="ignore", invalid="ignore"):
        for (step, joints), result in zip(plan.steps, solution.steps, strict=True):
            if isinstance(result, InputSolution):
                _add_input_bound(plan, step.links[0], joints[0], poses, bounds)
            elif isinstance(result, GroupSolution):
                _add_group_bounds(step, joints, result, poses, bounds)
            else:
                _add_dyad_bounds(step, joints, result, poses, bounds)
    return bounds


def condition(plan: SolutionPlan, solution: LinkageSolution) -> np.ndarray:
    """Condition of the position solution: largest error bound of any point, relative to the size.

    Parameters
    ----------
    plan : SolutionPlan
    solution : LinkageSolution

    Returns
    -------
    ndarray (n,), dimensionless
        In units of the machine epsilon; infinite at a dead centre.
    """
    rows = [d.origin / plan.size + d.angle for d in error_bounds(plan, solution).values()]
    worst = np.max(np.broadcast_arrays(*rows), axis=0)
    return np.where(np.isnan(worst), np.inf, 4.0 * worst + 4.0)  # NaN is 0 · ∞ of a pin at its link's origin


def _point_bound(end: JointEnd, poses: dict[int, Pose], bounds: dict[int, ErrorBound]) -> np.ndarray:
    """Error bound [m] of a point of a known link, in units of the machine epsilon."""
    bound = bounds[end.link]
    return np.asarray(bound.origin + abs(end.point) * bound.angle + np.abs(poses[end.link].origin[0]) + abs(end.point))


def _add_input_bound(
    plan: SolutionPlan, link: int, pin: Joint, poses: dict[int, Pose], bounds: dict[int, ErrorBound]
) -> None:
    """Add the bounds of a second driving link, whose coordinate follows the driver's."""
    on = next(row.on for row in plan.linkage.drivers if row.link == link)
    motion = plan.linkage.own_motions.get(link)
    slope = abs(plan.gains[link]) if motion is None else largest_rate(motion)
    if not pin.revolute:
        angle = bounds[on].angle + 1.0
        reach = np.abs(poses[link].origin[0] - poses[on].origin[0])
        slide = slope * (1.0 + 2.0 * np.pi) + reach * (1.0 + angle)
        point = _point_bound(pin.first, poses, bounds)
        bounds[link] = ErrorBound(point + slide + abs(pin.second.point) * (1.0 + angle), angle)
        return
    angle = bounds[on].angle + 1.0 + slope * (1.0 + 2.0 * np.pi * (plan.linkage.turns or 1))
    bounds[link] = ErrorBound(_point_bound(pin.first, poses, bounds) + abs(pin.second.point) * (1.0 + angle), angle)


def _add_dyad_bounds(
    step: SolutionStep,
    joints: tuple[Joint, ...],
    dyad: DyadSolution,
    poses: dict[int, Pose],
    bounds: dict[int, ErrorBound],
) -> None:
    """Add the bounds of a dyad's links; a sliding link has the angle of its guide, and its position on a known guide is a coordinate."""
    a, b = step.links
    outer_a, inner, outer_b = joints
    c1, c2 = dyad.columns
    det = np.abs(cross(c1, c2))
    pin_a, pin_b = (_point_bound(outer.first, poses, bounds) for outer in (outer_a, outer_b))
    guide_a, guide_b = (bounds[outer.first.link].angle + 1.0 for outer in (outer_a, outer_b))
    guide_bound = sum(guide - 1.0 for guide, outer in ((guide_a, outer_a), (guide_b, outer_b)) if not outer.revolute)
    miss = pin_a + pin_b + dyad.reach * (2.0 + guide_bound)
    x1, x2 = 2.0 + np.abs(c2) * miss / det, 2.0 + np.abs(c1) * miss / det
    angle_b = (x2 if inner.revolute else x1) if outer_b.revolute else guide_b
    angle_a = (x1 if inner.revolute else angle_b) if outer_a.revolute else guide_a
    end_a = outer_a.second if outer_a.revolute else inner.first
    end_b = inner.second if inner.revolute and not outer_b.revolute else outer_b.second
    slide_a, slide_b = (0.0 if outer.revolute else x + miss for outer, x in ((outer_a, x1), (outer_b, x2)))
    bounds[a] = ErrorBound(pin_a + slide_a + abs(end_a.point) * angle_a, angle_a)
    bounds[b] = ErrorBound(pin_b + slide_b + abs(end_b.point) * angle_b, angle_b)


def _add_group_bounds(
    step: SolutionStep,
    joints: tuple[Joint, ...],
    result: GroupSolution,
    poses: dict[int, Pose],
    bounds: dict[int, ErrorBound],
) -> None:
    """Add the bounds of a group's links, by the norm of the inverse of J, whose lengths are in units of the size."""
    known = [
        _point_bound(end, poses, bounds) for j in joints for end in (j.first, j.second) if end.link not in step.links
    ]
    size = max(abs(end.point) for j in joints for end in (j.first, j.second)) or 1.0
    inverse = np.full(result.determinant.shape, np.inf)
    fine = np.isfinite(result.determinant) & (result.determinant != 0.0)
    inverse[fine] = np.abs(np.linalg.pinv(result.matrix[fine])).sum(axis=2).max(axis=1)
    miss = np.max(np.broadcast_arrays(*known), axis=0) / size + 8.0
    for link in step.links:
        bounds[link] = ErrorBound(size * inverse * miss + np.abs(poses[link].origin[0]), inverse * miss + 1.0)


# -- mechanisms -------------------------------------------------------------------------------------------------


ROLLER = "roller"


def _empty() -> Mapping[Any, Any]:
    return MappingProxyType({})


@frozen
class ReferencePoint:
    """Point of a link on which the cam acts: the centre of a roller or of a shoe, or the edge of a knife.

    `body` names the body that represents it, which is the link's where the point is the link's origin.
    """

    link: int
    point: str
    body: str = ROLLER


@frozen(eq=False)
class Names:
    """Names of the parts of a kind of mechanism, whatever its lengths.

    Attributes
    ----------
    bodies : mapping of int to str
        Name of the body by link.
    reference : ReferencePoint or None
        Point on which a cam acts.
    pairs : mapping of str to str
        Name of the pair by joint.
    force_links : mapping of str to int
        Link, by joint, that exerts the joint force which tables give; by default the link that is solved first.
    points : mapping of str to str
        Name of the sliding link's point, by the joint of a sliding pair.
    coordinates : mapping of str to int or str
        By the name in tables: a link, for its angle in the mechanism's frame, or the joint of a sliding pair, for its slide.
    singular : mapping of str to str
        Code of the finding by joint of a dyad, where the sine of its transmission angle vanishes.
    """

    bodies: Mapping[int, str]
    reference: ReferencePoint | None = None
    pairs: Mapping[str, str] = field(default_factory=_empty)
    force_links: Mapping[str, int] = field(default_factory=_empty)
    points: Mapping[str, str] = field(default_factory=_empty)
    coordinates: Mapping[str, int | str] = field(default_factory=_empty)
    singular: Mapping[str, str] = field(default_factory=_empty)

    def body(self, link: int) -> str:
        """Name of the body of a link, the frame included."""
        return self.bodies.get(link, FRAME)

    def point(self, joint: str) -> str:
        """Name of the point of a pair on its body."""
        return self.points.get(joint, joint)


@frozen(eq=False)
class NamedPairs:
    """Pairs and dyads of a kind of mechanism, by name and without any length.

    Attributes
    ----------
    names : tuple of str
        Name of each joint of the plan, the driver's first; further links on one pin append the name of their body.
    pairs : mapping of str to Pair
        A sliding pair has the axis 1, in place of the direction of its line.
    dyads : tuple of Dyad
        In the reverse of the order of solution; a second driving body has the ratio 0.
    ground : str
        Name of the pair between the frame and the reference point's link, or the driver; empty where there is none.
    """

    names: tuple[str, ...]
    pairs: Mapping[str, Pair]
    dyads: tuple[Dyad, ...]
    ground: str


@lru_cache(maxsize=64)
def named_pairs(structure: PlanStructure, names: Names) -> NamedPairs:
    """Pairs and dyads of a structure by name; cached, since a changed length does not change them."""
    by_ends: dict[Ends, str] = {}
    for ends in structure.pairs:
        key, _, second = ends
        name = names.pairs.get(key, key)
        by_ends[ends] = f"{name}_{names.bodies[second]}" if name in by_ends.values() else name
    link = structure.driver[2] if names.reference is None else names.reference.link
    grounds = (name for (_, *links), name in by_ends.items() if set(links) == {FRAME_LINK, link})
    return NamedPairs(
        tuple(by_ends[ends] for ends in structure.pairs),
        MappingProxyType({name: _pair(names, *ends) for ends, name in by_ends.items()}),
        tuple(_dyad(structure, names, by_ends, step, pairs) for step, pairs in reversed(structure.steps)),
        next(grounds, ""),
    )


def _pair(names: Names, key: str, on: int, body: int) -> Pair:
    if not is_pin(key):
        return Pair(SLIDING, names.body(on), names.body(body), names.point(key), 1.0 + 0j)
    if names.force_links.get(key) == body:
        on, body = body, on
    return Pair(REVOLUTE, names.body(on), names.body(body), names.point(key))


def _dyad(
    structure: PlanStructure, names: Names, by_ends: Mapping[Ends, str], step: SolutionStep, pairs: tuple[Ends, ...]
) -> Dyad:
    driven = by_ends[structure.driver] if structure.is_inner and structure.driver in pairs else ""
    return Dyad(
        step.kind, tuple(names.bodies[n] for n in step.links), tuple(by_ends[ends] for ends in pairs), driven=driven
    )


@frozen(eq=False)
class Mechanism:
    """A linkage with the position of its frame, its driver, and the names of its parts.

    Attributes
    ----------
    linkage : Linkage
        Links, pairs and driver, in the frame of the mechanism.
    names : Names
        Of bodies, pairs, points and coordinates.
    origin, turn : complex, float
        Origin [m] of the mechanism's frame in the global frame, and the angle of its x axis [rad].
    start, driver_sign : float
        The driver's coordinate is q = start + driver_sign y, with the motion y [m or rad].
    angles : mapping of int to float
        Angle [rad] of a link in the mechanism's frame at the base position, including whole turns.
    base : mapping of str to (float, str)
        Values of the base position in SI, with the unit in which they are displayed.
    more_singular : callable, optional
        Further measures by code, from the solution in the mechanism's frame.
    ranged : bool
        A linkage given link by link: the ranges of its driver are searched, and its bodies are named by number.
    refuse : callable, optional
        Error where links do not meet or are in line, from the motion, the solution and the mask (n,) of failed positions.
    require : callable, optional
        Raises NoSolution for a motion, from `start`, that the mechanism cannot follow although its links meet.
    """

    linkage: Linkage
    names: Names
    origin: complex = 0j
    turn: float = 0.0
    start: float = 0.0
    driver_sign: float = 1.0
    angles: Mapping[int, float] = field(default_factory=_empty)
    base: Mapping[str, tuple[float, str]] = field(default_factory=_empty)
    more_singular: Callable[[LinkageSolution], Mapping[str, np.ndarray]] | None = None
    ranged: bool = False
    refuse: Callable[[MotionState, LinkageSolution, np.ndarray], NoSolution] | None = None
    require: Callable[[float, MotionState], None] | None = None

    @lazy
    def plan(self) -> SolutionPlan:
        """Solution plan of the linkage."""
        return plan_of(self.linkage) if self.ranged else new_plan(self.linkage)  # a follower has new lengths each time

    @property
    def bodies(self) -> Mapping[int, str]:
        """Name of the body by link."""
        return self.names.bodies

    @property
    def _named(self) -> NamedPairs:
        return named_pairs(self.plan.structure, self.names)

    @property
    def pair_names(self) -> Mapping[Joint, str]:
        """Name of every pair, the driver's first; further links on one pin append the name of their body."""
        return MappingProxyType(dict(zip(self.plan.joints, self._named.names, strict=True)))

    @lazy
    def pairs_by_name(self) -> Mapping[str, Pair]:
        """Pairs of the Kinematics by name."""
        pairs = dict(self._named.pairs)
        for joint, name in zip(self.plan.joints, pairs, strict=True):
            if not joint.revolute:
                axis = joint.first.along
                if joint.first.link == FRAME_LINK:
                    axis = axis * heading(self.turn)
                pair = pairs[name]
                pairs[name] = Pair(pair.kind, pair.on, pair.body, pair.point, axis)
        return MappingProxyType(pairs)

    @lazy
    def dyads(self) -> tuple[Dyad, ...]:
        """Dyads and groups, in the reverse of the order of solution."""
        dyads, linkage = self._named.dyads, self.linkage
        if not linkage.drivers:
            return dyads
        on, gains, motions = {row.link: row.on for row in linkage.drivers}, self.plan.gains, linkage.own_motions
        links = [step.links[0] if step.kind == INPUT else None for step, _ in reversed(self.plan.steps)]
        return tuple(
            dyad
            if link is None
            else replace(dyad, on=self.names.body(on[link]), ratio=gains.get(link, 0.0), by_motion=link in motions)
            for link, dyad in zip(links, dyads, strict=True)
        )

    @lazy
    def link_points(self) -> Mapping[int, Mapping[str, complex]]:
        """Points in their link's frame [m] by link and name, including those of sliding pairs."""
        result = {link: dict(points) for link, points in self.plan.points.items()}
        for joint in self.plan.joints:
            if not joint.revolute:
                for end in (joint.first, joint.second):
                    result[end.link].setdefault(self.names.point(joint.name), end.point)
        return MappingProxyType({link: MappingProxyType(points) for link, points in result.items()})

    def body_point(self, link: int, point: str) -> tuple[str, complex]:
        """Body of a link's named point, and the point [m] in that body's frame; the frame's points are global.

        Raises
        ------
        KeyError
            The link has no such point.
        """
        at = self.plan.points[link][point]
        if link not in self.bodies:
            return FRAME, self.origin + at * heading(self.turn)
        return self.bodies[link], at

    @property
    def ground(self) -> str:
        """Name of the pair between the frame and the reference point's link, or the driver; empty where there is none."""
        return self._named.ground


def body_name(link: int) -> str:
    """Name of the body of a link of a [linkage]."""
    return FRAME if link == FRAME_LINK else f"link{link}"


def link_number(body: str) -> int:
    """Number of the link of a [linkage] whose body has this name."""
    return FRAME_LINK if body == FRAME else int(body.removeprefix("link"))


def mechanism_of(linkage: Linkage, reference: ReferencePoint | None = None) -> Mechanism:
    """Mechanism of a [linkage] of the file: its frame is the global frame, its bodies have the numbers of their links."""
    numbers = tuple(sorted(link.number for link in linkage.links))
    names = _link_names(numbers, tuple(slider.link for slider in linkage.sliders), reference)
    return Mechanism(linkage, names, ranged=True)


@lru_cache(maxsize=64)
def _link_names(links: tuple[int, ...], sliding: tuple[int, ...], reference: ReferencePoint | None) -> Names:
    bodies = {link: body_name(link) for link in links}
    coordinates: dict[str, int | str] = {name: link for link, name in bodies.items() if link != FRAME_LINK}
    coordinates.update({f"slide{link}": str(link) for link in sliding})
    return Names(MappingProxyType(bodies), reference, coordinates=MappingProxyType(coordinates))
