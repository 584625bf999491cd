"""A linkage made ready for solving: lengths in metres, and for each step what it needs of the links."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property, lru_cache
from types import MappingProxyType

from core.design import FRAME_LINK, UNITS, Linkage, Slider, si
from core.design.topology import GROUP, SolutionStep, driver_pair, is_pin, pins, slider_of, solving_order
from core.errors import DesignError, Fault
from core.frozen import frozen
from core.numerics.columns import greatest
from core.numerics.vectors import heading, vector

_MM = UNITS["mm"].factor


@frozen
class JointEnd:
    """A link in a pair: a point of it [m] and, of a sliding pair, the direction of the line in its frame."""

    link: int
    point: complex
    along: complex = 1.0 + 0j


@frozen
class Joint:
    """A pair of two links; ``first`` is the known or the outer one."""

    name: str
    revolute: bool
    first: JointEnd
    second: JointEnd


@frozen
class SolutionPlan:
    """What solving a linkage needs.

    points    link -> name -> point in its frame [m]
    driver    the pair that holds the driving link (second) on the frame (first)
    steps     in the order of solution, with the joints of each in the order of ``SolutionStep.pairs``
    sides     joint -> +1 or -1, stated or not
    """

    linkage: Linkage
    points: Mapping[int, Mapping[str, complex]]
    driver: Joint
    steps: tuple[tuple[SolutionStep, tuple[Joint, ...]], ...]
    sides: Mapping[str, int]

    @property
    def joints(self) -> tuple[Joint, ...]:
        """Every pair of the linkage, in the order of solution."""
        return (self.driver, *(joint for _, joints in self.steps for joint in joints))

    def side(self, joint: str) -> float:
        """+1 where the file does not state another."""
        return self.sides.get(joint, 1) * 1.0

    @cached_property
    def size(self) -> float:
        """The largest extent of a link [m]."""
        return _size(self.linkage, self.points)


@lru_cache(maxsize=64)
def plan_of(linkage: Linkage) -> SolutionPlan:
    """The plan of a linkage without faults. Raises DesignError where its links do not determine each other."""
    order = solving_order(linkage)
    pair = driver_pair(linkage)
    if pair is None or order.overdetermined or order.undetermined:
        raise DesignError([Fault("linkage", linkage.driver.link, "the driver does not lead every link")])
    points = MappingProxyType(
        {link.number: MappingProxyType({name: at * _MM for name, at in link.places.items()}) for link in linkage.links}
    )
    make = _Joints(linkage, points)
    known = {FRAME_LINK}
    driver = make.joint(pair, known, linkage.driver.link)
    known.add(linkage.driver.link)
    steps = []
    for step in order.steps:
        steps.append((step, tuple(make.of_group(step, known) if step.kind == GROUP else make.of_dyad(step, known))))
        known |= set(step.links)
    return SolutionPlan(linkage, points, driver, tuple(steps), MappingProxyType(dict(linkage.sides)))


class _Joints:
    """Makes the joints of a linkage from the keys of its pairs."""

    def __init__(self, linkage: Linkage, points: Mapping[int, Mapping[str, complex]]) -> None:
        self._linkage, self._points = linkage, points
        self._pins = {pin.name: pin for pin in pins(linkage)}

    def joint(self, key: str, known: set[int], link: int) -> Joint:
        """The pair ``key`` of a link with one of the known ones, the frame rather than another."""
        if is_pin(key):
            other = min(n for n in self._pins[key].links if n in known and n != link)
            return Joint(key, True, JointEnd(other, self._points[other][key]), JointEnd(link, self._points[link][key]))
        slider = slider_of(self._linkage, key)
        other = slider.on if slider.link == link else slider.link
        return Joint(key, False, _on_line(slider, other), _on_line(slider, link))

    def of_dyad(self, step: SolutionStep, known: set[int]) -> Iterator[Joint]:
        """The two outer pairs with known links, and the inner one between them."""
        a, b = step.links
        for key, others, link in zip(step.pairs, (known, {a}, known), (a, b, b), strict=True):
            yield self.joint(key, others, link)

    def of_group(self, step: SolutionStep, known: set[int]) -> Iterator[Joint]:
        """Every pair of the group: a pin of n links is n - 1 pairs with one of them."""
        for key in step.pairs:
            if is_pin(key):
                links = self._pins[key].links
                own, held = [n for n in links if n in step.links], [n for n in links if n in known]
                hub, others = (held[0], own) if held else (own[0], own[1:])
                yield from (self.joint(key, {hub}, n) for n in others)
            else:
                slider = slider_of(self._linkage, key)
                link = slider.link if slider.link in step.links else slider.on
                yield self.joint(key, {slider.on, slider.link} - {link}, link)


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
