"""A linkage prepared for its solution: lengths in metres, and the links and pairs of each step."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import lru_cache
from types import MappingProxyType

from core.design import FRAME_LINK, UNITS, Driver, Link, Linkage, LinkPoint, SecondDriver, Slider, si
from core.design.topology import GROUP, INPUT, SolutionStep, driver_pair, gains, is_pin, pins, slider_of, solving_order
from core.errors import DesignError, Fault
from core.frozen import frozen
from core.numerics.derivatives import heading, vector
from core.numerics.lazy import greatest, lazy

_MM = UNITS["mm"].factor


@frozen
class JointEnd:
    """One link of a pair: its point [m], complex, and for a sliding pair the unit vector of the line, both in the link's frame."""

    link: int
    point: complex
    along: complex = 1.0 + 0j


@frozen(eq=False)
class Joint:
    """A pair of two links; `first` is the known or the outer one."""

    name: str
    revolute: bool
    first: JointEnd
    second: JointEnd


@frozen
class LinkGroup:
    """Links solved together.

    Attributes
    ----------
    links : tuple of int
        Numbers of the links.
    joints : tuple of Joint
        All their pairs.
    size : float
        Size of the linkage [m].
    driven : Joint or None
        The pair among `joints` that drives.
    """

    links: tuple[int, ...]
    joints: tuple[Joint, ...]
    size: float
    driven: Joint | None = None


Ends = tuple[str, int, int]
"""Key of a pair, and the numbers of its first and second link."""


@frozen(eq=False)
class PlanStructure:
    """Part of a solution plan that no length changes.

    Attributes
    ----------
    driver : Ends
        The driving pair.
    steps : tuple of (SolutionStep, tuple of Ends)
        In the order of solution.
    redundant : tuple of int
        Links constrained by more pairs than necessary.
    is_inner : bool
        Whether the driver moves against a moving link.
    """

    driver: Ends
    steps: tuple[tuple[SolutionStep, tuple[Ends, ...]], ...]
    redundant: tuple[int, ...]
    is_inner: bool

    @property
    def pairs(self) -> tuple[Ends, ...]:
        """All pairs of the linkage, in the order of solution."""
        rest = tuple(ends for _, pairs in self.steps for ends in pairs)
        return rest if self.is_inner else (self.driver, *rest)


@frozen(eq=False)
class SolutionPlan:
    """Steps that solve a linkage.

    Attributes
    ----------
    linkage : Linkage
    points : mapping of int to mapping of str to complex
        Points of each link in its frame [m], by link and name.
    driver : Joint
        Pair between the driving link (second) and the frame or the link against which it is driven (first); where a link slides
        there, the sliding link is the second.
    steps : tuple of (SolutionStep, tuple of Joint)
        In the order of solution; the joints of a step are in the order of `SolutionStep.pairs`.
    sides : mapping of str to int
        Joint -> +1 or -1, where the file states one.
    structure : PlanStructure
        The same for all lengths.
    """

    linkage: Linkage
    points: Mapping[int, Mapping[str, complex]]
    driver: Joint
    steps: tuple[tuple[SolutionStep, tuple[Joint, ...]], ...]
    sides: Mapping[str, int]
    structure: PlanStructure

    @property
    def is_inner(self) -> bool:
        """Whether the driver moves against a moving link."""
        return self.structure.is_inner

    @property
    def redundant(self) -> tuple[int, ...]:
        """Links constrained by more pairs than necessary."""
        return self.structure.redundant

    @lazy
    def joints(self) -> tuple[Joint, ...]:
        """All pairs of the linkage, in the order of solution."""
        rest = tuple(joint for _, joints in self.steps for joint in joints)
        return rest if self.is_inner else (self.driver, *rest)

    def group(self, index: int) -> LinkGroup:
        """Links of the step with this index, which are solved together."""
        step, joints = self.steps[index]
        return LinkGroup(
            step.links, joints, self.size, self.driver if self.is_inner and self.driver in joints else None
        )

    def side(self, joint: str) -> float:
        """Side of a joint, +1 where the file states none."""
        return self.sides.get(joint, 1) * 1.0

    @lazy
    def gains(self) -> Mapping[int, float]:
        """Ratio in SI by link of a second driver; see `topology.gains`."""
        return gains(self.linkage)

    @lazy
    def size(self) -> float:
        """Size of the linkage: largest extent of a link [m]."""
        return _size(self.linkage, self.points)


@lru_cache(maxsize=64)
def plan_of(linkage: Linkage) -> SolutionPlan:
    """Solution plan of a linkage, cached; see `new_plan`."""
    return new_plan(linkage)


def new_plan(linkage: Linkage) -> SolutionPlan:
    """Solution plan of a linkage without faults.

    Raises
    ------
    DesignError
        The driver does not determine every link.
    """
    structure = _structure(
        tuple([(link.number, tuple([p.name for p in link.points])) for link in linkage.links]),
        tuple([(slider.link, slider.on) for slider in linkage.sliders]),
        ((linkage.driver.link, linkage.driver.on), *[(row.link, row.on) for row in linkage.drivers]),
    )
    points = MappingProxyType(
        {
            link.number: MappingProxyType({p.name: vector(p.x_mm, p.y_mm) * _MM for p in link.points})
            for link in linkage.links
        }
    )

    def joint(ends: Ends) -> Joint:
        key, first, second = ends
        if is_pin(key):
            return Joint(key, True, JointEnd(first, points[first][key]), JointEnd(second, points[second][key]))
        slider = slider_of(linkage, key)
        return Joint(key, False, _on_line(slider, first), _on_line(slider, second))

    driving_joint = joint(structure.driver)
    return SolutionPlan(
        linkage,
        points,
        driving_joint,
        tuple(
            [
                (step, tuple([driving_joint if ends == structure.driver else joint(ends) for ends in pairs]))
                for step, pairs in structure.steps
            ]
        ),
        linkage.sides,
        structure,
    )


@lru_cache(maxsize=64)
def _structure(
    links: tuple[tuple[int, tuple[str, ...]], ...],
    sliders: tuple[tuple[int, int], ...],
    drivers: tuple[tuple[int, int], ...],
) -> PlanStructure:
    """Structure of the plans of all linkages with these connections.

    Parameters
    ----------
    links : tuple of (int, tuple of str)
        Number of each link and the names of its points.
    sliders, drivers : tuple of (int, int)
        The link that slides or is driven, and the link against which it moves; the first driver first.
    """
    linkage = Linkage(  # without lengths
        tuple(Link(number, tuple(LinkPoint(name, 0.0, 0.0) for name in names)) for number, names in links),
        tuple(Slider(link=link, on=on) for link, on in sliders),
        Driver(drivers[0][0], on=drivers[0][1]),
        drivers=tuple(SecondDriver(link=link, on=on) for link, on in drivers[1:]),
    )
    order = solving_order(linkage)
    pair = driver_pair(linkage)
    if pair is None or order.undetermined:
        raise DesignError([Fault("linkage", linkage.driver.link, "the driver does not lead every link")])
    finder = _JointFinder(linkage)
    known = {FRAME_LINK}
    driver = finder.driving_pair(pair)
    if linkage.driver.on == FRAME_LINK:
        known.add(linkage.driver.link)
    steps = []
    for step in order.steps:
        pairs = {GROUP: finder.group_pairs, INPUT: finder.input_pairs}.get(step.kind, finder.dyad_pairs)(step, known)
        steps.append((step, tuple(driver if set(ends) == set(driver) else ends for ends in pairs)))
        known |= set(step.links)
    return PlanStructure(driver, tuple(steps), order.redundant, linkage.driver.on != FRAME_LINK)


class _JointFinder:
    """The links of the pairs of a linkage, from the keys of the pairs."""

    def __init__(self, linkage: Linkage) -> None:
        self._linkage = linkage
        self._pins = {pin.name: pin for pin in pins(linkage)}
        self._driving = driver_pair(linkage)

    def ends(self, key: str, known: set[int], link: int) -> Ends:
        """The pair `key` between a link and a known link, preferably the frame."""
        if is_pin(key):
            return key, min(n for n in self._pins[key].links if n in known and n != link), link
        slider = slider_of(self._linkage, key)
        return key, slider.on if slider.link == link else slider.link, link

    def driving_pair(self, key: str) -> Ends:
        """The driving pair; the sliding link of a sliding pair is the last."""
        driver = self._linkage.driver
        if driver.on == FRAME_LINK or is_pin(key):
            return key, driver.on, driver.link
        slider = slider_of(self._linkage, key)
        return key, slider.on, slider.link

    def dyad_pairs(self, step: SolutionStep, known: set[int]) -> Iterator[Ends]:
        """The two outer pairs with known links, and the inner pair between them."""
        a, b = step.links
        for key, partners, link in zip(step.pairs, (known, {a}, known), (a, b, b), strict=True):
            yield self.ends(key, partners, link)

    def input_pairs(self, step: SolutionStep, known: set[int]) -> Iterator[Ends]:
        """The pair between a second driving link and a known link."""
        yield self.ends(step.pairs[0], known, step.links[0])

    def group_pairs(self, step: SolutionStep, known: set[int]) -> Iterator[Ends]:
        """All pairs of a group; a pin of n links counts as n - 1 pairs with one of the links."""
        for key in step.pairs:
            if is_pin(key):
                links = self._pins[key].links
                inner, outer = [n for n in links if n in step.links], [n for n in links if n in known]
                driver = self._linkage.driver
                if key == self._driving and driver.on != FRAME_LINK:  # the driving pair must be one of the pairs
                    rest = [n for n in (*outer, *inner) if n != driver.on]
                    yield from ((key, driver.on, n) for n in rest if n in inner or driver.on in inner)
                    continue
                hub, others = (outer[0], inner) if outer else (inner[0], inner[1:])
                yield from ((key, hub, n) for n in others)
            else:
                slider = slider_of(self._linkage, key)
                link = slider.link if slider.link in step.links else slider.on
                yield self.ends(key, {slider.on, slider.link} - {link}, link)


def _on_line(slider: Slider, link: int) -> JointEnd:
    """End of a sliding pair on a link; the line is the x axis of the sliding link."""
    if link == slider.link:
        return JointEnd(link, 0j)
    s = si(slider)
    return JointEnd(link, vector(s.through_x, s.through_y), heading(s.angle))


def _size(linkage: Linkage, points: Mapping[int, Mapping[str, complex]]) -> float:
    extents = [abs(a - b) for at in points.values() for a in at.values() for b in at.values()]
    lines = [abs(vector(s.through_x_mm, s.through_y_mm)) * _MM for s in linkage.sliders]
    return greatest([*extents, *lines, 1e-9])
