"""What is solved: a linkage in a frame of its own, where that frame stands, what drives it, and what its parts are called."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np

from core.design import FRAME_LINK, Linkage
from core.design.topology import INPUT
from core.errors import NoAnswer
from core.frozen import frozen
from core.mechanism.kinematics import FRAME, REVOLUTE, SLIDING, Dyad, Pair
from core.mechanism.plan import Joint, SolutionPlan, plan_of, planned
from core.mechanism.solving import Solved
from core.motion import MotionState
from core.numerics.vectors import heading

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
    require      start, motion: raises NoAnswer for a motion that the mechanism cannot follow although its links meet
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
    refuse: Callable[[MotionState, Solved, np.ndarray], NoAnswer] | None = None
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
