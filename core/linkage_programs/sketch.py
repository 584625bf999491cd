"""What every program's linkage comes down to: joints at places, each with the links that it joins."""

from __future__ import annotations

from core.errors import MISSING, DesignError, Fault
from core.frozen import frozen

GROUND = "ground"
PIN, SLIDE, SLIDING_PIN = "R", "P", "RP"


@frozen
class LeftOut:
    """What could not be carried over, and why."""

    what: str
    why: str


@frozen
class SketchJoint:
    """A joint where it stands, in the program's own unit: a pin of all its links (of one: a point that is followed), or along a line
    at ``angle_deg`` of the first of them, with the others: as a slide they do not turn on it, as a sliding pin they do."""

    name: str
    at: complex
    links: tuple[str, ...]
    kind: str = PIN
    angle_deg: float = 0.0


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
    """Joints; ``welded``: pairs of links that are one; inputs: names of driven joints; speed of each [rpm], None where unknown; unit of
    lengths, empty where it is unknown; wheels: two links and the turn of the second for one of the first; actuators: links of two joints
    whose length is driven, by a stroke, so many times a minute."""

    joints: tuple[SketchJoint, ...]
    welded: tuple[tuple[str, str], ...] = ()
    inputs: tuple[str, ...] = ()
    speeds: tuple[float, ...] = ()
    unit: str = ""
    left_out: tuple[LeftOut, ...] = ()
    wheels: tuple[tuple[str, str, float], ...] = ()
    actuators: tuple[tuple[str, float, float], ...] = ()
    masses: tuple[SketchMass, ...] = ()
    forces: tuple[SketchForce, ...] = ()


def refused(source: str, problem: str, allowed: str) -> DesignError:
    """A text that is no linkage of this program."""
    return DesignError([Fault(source, MISSING, problem, allowed)])
