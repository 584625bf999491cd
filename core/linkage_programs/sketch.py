"""What every program's linkage comes down to: joints at places, each with the links that it joins."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

from core.errors import MISSING, DesignError, Fault
from core.frozen import frozen

GROUND = "ground"
PIN, SLIDE, SLIDING_PIN = "R", "P", "RP"
PIXEL = "1/96 in"
"""Unit of a drawing on the screen."""


@frozen
class LeftOut:
    """What could not be carried over, and why."""

    what: str
    why: str


@frozen
class SketchJoint:
    """A joint where it stands, in the program's own unit: a pin of all its links (of one: a point that is followed), or along a line
    at ``angle_deg`` of the first of them, with the others: as a slide they do not turn on it, as a sliding pin they do. ``through``: a
    point of that line, where the joint is on it but for the rounding of the text."""

    name: str
    at: complex
    links: tuple[str, ...]
    kind: str = PIN
    angle_deg: float = 0.0
    through: complex | None = None


@frozen
class Swing:
    """Motion out and back at constant speed, ``cycles`` a minute: ``stroke`` [deg, or the program's unit]; ``start``: how much of out and
    back is behind it as drawn; ``sign`` of the way out."""

    stroke: float
    start: float
    cycles: float
    sign: float = 1.0


@frozen(kw_only=True)
class SketchInput:
    """What drives: the joint of this name, or, with ``length``, the link of two joints whose length changes. Speed [rpm] of what turns,
    None where it is unknown; ``swing`` of what moves out and back; manual: the program turns it by hand only."""

    name: str
    rpm: float | None = None
    swing: Swing | None = None
    length: bool = False
    manual: bool = False

    @property
    def label(self) -> str:
        """Its name for the user."""
        return f"actuator {self.name.removeprefix('link')}" if self.length else self.name

    @property
    def joint(self) -> str:
        """Name of the joint where it drives; of a length the slide between tube and rod."""
        return f"{self.name}_slide" if self.length else self.name


@frozen
class Wheels:
    """Two links that turn against their carrier, ``ratio`` of the second for one of the first."""

    first: str
    second: str
    carrier: str
    ratio: float

    def on(self, merged: Mapping[str, str]) -> Wheels:
        """Of links that are one with others: of those."""
        first, second, carrier = (merged[link] for link in (self.first, self.second, self.carrier))
        return Wheels(first, second, carrier, self.ratio)


@frozen
class SketchMass:
    """Mass of a link [kg], its moment of inertia about its centre of mass [kg m²], and where that is, in the program's own unit."""

    link: str
    mass_kg: float
    inertia_kg_m2: float
    at: complex


@frozen
class SketchForce:
    """A force [N] that keeps its direction, at a place of a link, in the program's own unit."""

    name: str
    link: str
    at: complex
    newton: complex


@frozen
class Sketch:
    """Joints; ``welded``: pairs of links that are one; inputs in the order of the text; unit of lengths, empty where it is unknown."""

    joints: tuple[SketchJoint, ...]
    welded: tuple[tuple[str, str], ...] = ()
    inputs: tuple[SketchInput, ...] = ()
    unit: str = ""
    left_out: tuple[LeftOut, ...] = ()
    wheels: tuple[Wheels, ...] = ()
    masses: tuple[SketchMass, ...] = ()
    forces: tuple[SketchForce, ...] = ()
    gravity: bool = True


def refused(source: str, problem: str, allowed: str) -> DesignError:
    """A text that is no linkage of this program."""
    return DesignError([Fault(source, MISSING, problem, allowed)])


def distinct(names: Iterable[str]) -> list[str]:
    """The names, one that is there already with a number behind it."""
    taken: set[str] = set()
    counts: Counter[str] = Counter()
    result = []
    for name in names:
        unique = name
        while unique in taken:
            counts[name] += 1
            unique = f"{name}_{counts[name] + 1}"
        taken.add(unique)
        result.append(unique)
    return result
