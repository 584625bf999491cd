"""A linkage made ready for solving: lengths in metres, and for each step what it needs of the links."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field
from functools import cached_property, lru_cache
from types import MappingProxyType
from typing import Any

from core.design import FRAME_LINK, UNITS, Linkage, Slider, si
from core.design.topology import GROUP, INPUT, SolutionStep, driver_pair, gains, is_pin, pins, slider_of, solving_order
from core.errors import DesignError, Fault
from core.frozen import frozen
from core.numerics.derivatives import heading, vector
from core.numerics.lazy import greatest

_MM = UNITS["mm"].factor


@frozen
class JointEnd:
    """A link in a pair: a point of it [m] and, of a sliding pair, the direction of the line in its frame."""

    link: int
    point: complex
    along: complex = 1.0 + 0j


@frozen(eq=False)
class Joint:
    """A pair of two links; ``first`` is the known or the outer one."""

    name: str
    revolute: bool
    first: JointEnd
    second: JointEnd


@frozen
class LinkGroup:
    """Links solved together: their numbers and all their pairs; size [m] of the linkage; driven: the one of the pairs that drives."""

    links: tuple[int, ...]
    joints: tuple[Joint, ...]
    size: float
    driven: Joint | None = None


@frozen
class SolutionPlan:
    """What solving a linkage needs.

    points    link -> name -> point in its frame [m]
    driver    the pair that holds the driving link (second) on the frame (first), or on the link against which it is driven; where a
              link slides there, that is the second
    steps     in the order of solution, with the joints of each in the order of ``SolutionStep.pairs``
    redundant links that more pairs hold than need be
    sides     joint -> +1 or -1, stated or not
    """

    linkage: Linkage
    points: Mapping[int, Mapping[str, complex]]
    driver: Joint
    steps: tuple[tuple[SolutionStep, tuple[Joint, ...]], ...]
    sides: Mapping[str, int]
    redundant: tuple[int, ...] = ()

    @property
    def inner(self) -> bool:
        """Whether the driver moves against a link that moves itself."""
        return self.linkage.driver.on != FRAME_LINK

    @property
    def joints(self) -> tuple[Joint, ...]:
        """Every pair of the linkage, in the order of solution."""
        rest = tuple(joint for _, joints in self.steps for joint in joints)
        return rest if self.inner else (self.driver, *rest)

    def group(self, index: int) -> LinkGroup:
        """The links of a step that are solved together."""
        step, joints = self.steps[index]
        return LinkGroup(step.links, joints, self.size, self.driver if self.inner and self.driver in joints else None)

    def side(self, joint: str) -> float:
        """+1 where the file does not state another."""
        return self.sides.get(joint, 1) * 1.0

    @cached_property
    def gains(self) -> Mapping[int, float]:
        """Link of a second driver -> its ratio in SI; see ``topology.gains``."""
        return gains(self.linkage)

    @cached_property
    def size(self) -> float:
        """The largest extent of a link [m]."""
        return _size(self.linkage, self.points)


@lru_cache(maxsize=64)
def plan_of(linkage: Linkage) -> SolutionPlan:
    """The plan of a linkage, kept; see ``planned``."""
    return planned(linkage)


def planned(linkage: Linkage) -> SolutionPlan:
    """The plan of a linkage without faults. Raises DesignError where its links do not determine each other."""
    links, slid = tuple((link.number, tuple(p.name for p in link.points)) for link in linkage.links), linkage.sliders
    driven = (linkage.driver.link, linkage.driver.on, *((each.link, each.on) for each in linkage.drivers))
    driver, steps, redundant = _joined(_Topology((links, tuple((s.link, s.on) for s in slid), driven), linkage))
    points = MappingProxyType(
        {
            link.number: MappingProxyType({p.name: vector(p.x_mm, p.y_mm) * _MM for p in link.points})
            for link in linkage.links
        }
    )

    def joint(of: _Ends) -> Joint:
        key, first, second = of
        if is_pin(key):
            return Joint(key, True, JointEnd(first, points[first][key]), JointEnd(second, points[second][key]))
        slider = slider_of(linkage, key)
        return Joint(key, False, _on_line(slider, first), _on_line(slider, second))

    drives = joint(driver)
    return SolutionPlan(
        linkage,
        points,
        drives,
        tuple((step, tuple(drives if each == driver else joint(each) for each in ends)) for step, ends in steps),
        MappingProxyType(dict(linkage.sides)),
        redundant,
    )


_Ends = tuple[str, int, int]
"""A pair by its key, with the first and the second of its links."""


@frozen
class _Topology:
    """What hangs on what: number and points' names of each link, both links of each slider, those driven; and a linkage of that
    kind, of which the lengths do not matter."""

    key: tuple[Any, ...]
    linkage: Linkage = field(compare=False)


@lru_cache(maxsize=64)
def _joined(topology: _Topology) -> tuple[_Ends, tuple[tuple[SolutionStep, tuple[_Ends, ...]], ...], tuple[int, ...]]:
    """The driver's pair, the steps with their pairs, and redundant links; kept, so that another length asks for nothing anew."""
    linkage = topology.linkage
    order = solving_order(linkage)
    pair = driver_pair(linkage)
    if pair is None or order.undetermined:
        raise DesignError([Fault("linkage", linkage.driver.link, "the driver does not lead every link")])
    make = _Joints(linkage)
    known = {FRAME_LINK}
    driver = make.driving(pair)
    if linkage.driver.on == FRAME_LINK:
        known.add(linkage.driver.link)
    steps = []
    for step in order.steps:
        of = {GROUP: make.of_group, INPUT: make.of_input}.get(step.kind, make.of_dyad)
        pairs = tuple(of(step, known))
        steps.append((step, tuple(driver if set(each) == set(driver) else each for each in pairs)))
        known |= set(step.links)
    return driver, tuple(steps), order.redundant


class _Joints:
    """Finds the links of the pairs of a linkage from their keys."""

    def __init__(self, linkage: Linkage) -> None:
        self._linkage = linkage
        self._pins = {pin.name: pin for pin in pins(linkage)}
        self._driving = driver_pair(linkage)

    def ends(self, key: str, known: set[int], link: int) -> _Ends:
        """The pair ``key`` of a link with one of the known ones, the frame rather than another."""
        if is_pin(key):
            return key, min(n for n in self._pins[key].links if n in known and n != link), link
        slider = slider_of(self._linkage, key)
        return key, slider.on if slider.link == link else slider.link, link

    def driving(self, key: str) -> _Ends:
        """The pair that drives: of one that slides the sliding link last."""
        driver = self._linkage.driver
        if driver.on == FRAME_LINK or is_pin(key):
            return key, driver.on, driver.link
        slider = slider_of(self._linkage, key)
        return key, slider.on, slider.link

    def of_dyad(self, step: SolutionStep, known: set[int]) -> Iterator[_Ends]:
        """The two outer pairs with known links, and the inner one between them."""
        a, b = step.links
        for key, others, link in zip(step.pairs, (known, {a}, known), (a, b, b), strict=True):
            yield self.ends(key, others, link)

    def of_input(self, step: SolutionStep, known: set[int]) -> Iterator[_Ends]:
        """The pin that holds it."""
        yield self.ends(step.pairs[0], known, step.links[0])

    def of_group(self, step: SolutionStep, known: set[int]) -> Iterator[_Ends]:
        """Every pair of the group: a pin of n links is n - 1 pairs with one of them."""
        for key in step.pairs:
            if is_pin(key):
                links = self._pins[key].links
                own, held = [n for n in links if n in step.links], [n for n in links if n in known]
                driver = self._linkage.driver
                if key == self._driving and driver.on != FRAME_LINK:  # the pair that drives must be one of them
                    rest = [n for n in (*held, *own) if n != driver.on]
                    yield from ((key, driver.on, n) for n in rest if n in own or driver.on in own)
                    continue
                hub, others = (held[0], own) if held else (own[0], own[1:])
                yield from ((key, hub, n) for n in others)
            else:
                slider = slider_of(self._linkage, key)
                link = slider.link if slider.link in step.links else slider.on
                yield self.ends(key, {slider.on, slider.link} - {link}, link)


def _on_line(slider: Slider, link: int) -> JointEnd:
    """A link on the line of a sliding pair: the one that slides has it as its own x axis."""
    if link == slider.link:
        return JointEnd(link, 0j)
    s = si(slider)
    return JointEnd(link, vector(s.through_x, s.through_y), heading(s.angle))


def _size(linkage: Linkage, points: Mapping[int, Mapping[str, complex]]) -> float:
    extents = [abs(a - b) for at in points.values() for a in at.values() for b in at.values()]
    lines = [abs(vector(s.through_x_mm, s.through_y_mm)) * _MM for s in linkage.sliders]
    return greatest([*extents, *lines, 1e-9])
