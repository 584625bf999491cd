"""The whole design: a shaft, and the drives that it turns. A file holds one drive, or lists any number of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from functools import cached_property
from types import MappingProxyType
from typing import Any, TypeVar

from core.design.fields import FileLayout, flag, number, placed
from core.design.followers import OF_SECOND, CamDetails, Face
from core.design.limits import NO_LIMITS, Limits, Tolerance, Waviness
from core.design.linkage import CRANK, MOTION, MOTION_SPEED, Link, Linkage, NamedMotion
from core.design.loads import Balancer
from core.design.parts import (
    FOLLOWER_KINDS,
    ROTARY,
    Follower,
    Motion,
    Output,
    OutputLoads,
    Servo,
    Shaft,
    face_of,
    kind_of,
)
from core.design.topology import driver_turns
from core.errors import DesignError, Fault
from core.frozen import frozen
from core.numerics.lazy import first_value

D = TypeVar("D")
BLANK = tuple(field.name for field in fields(CamDetails))
SECTIONS = ("motion", "follower", "linkage", "cam", "shaft", "loads", "limits", "servo")
"""The tables of a file in their order; no design has all of them. Behind them stand the motions of second drivers."""
MOTIONS = "motions."
"""Before the name of each."""


_APART = FileLayout(in_file=False)  # a table of its own
_TABLES: Mapping[type, str] = MappingProxyType({Linkage: "linkage", Output: ""})  # any other is a follower's


@frozen
class Drive:
    """What one motion moves: a follower or a linkage, the cam under it, the loads on it, and the user's own limits.

    ``motion`` is None where a crank turns at constant speed, ``cam`` where no cam makes the motion, ``servo`` where no motor of its own
    does. On a shaft of several a
    drive has a name (None where the design is of this drive alone), and stands turned back by its phase: its own angle is the
    machine angle less ``phase_deg``. A mirrored one is designed as seen from the other end, where the shaft turns the other way.
    ``carries`` is the direction in space along which it moves a part that several drives carry together; empty where it does not.
    """

    motion: Motion | None = placed(_APART)
    mechanism: Follower | Linkage | Output = placed(_APART)
    cam: Any = placed(_APART)  # Cam | LinkageCam | None, as the mechanism takes it
    loads: Any = placed(_APART)  # Loads | LinkageLoads | OutputLoads
    limits: Limits = placed(_APART, NO_LIMITS)
    name: str | None = placed(FileLayout(missing="any text with a letter or a digit"), None)
    phase_deg: float = number("Phase", -3600.0, 3600.0, default=0.0, step=1.0, help="own angle = machine angle - phase")
    mirrored: bool = flag("Mirrored", help="designed as seen from the other end, where the shaft turns the other way")
    carries: tuple[float, ...] = placed(FileLayout(each=float), ())
    servo: Servo | None = placed(_APART, None)

    @property
    def carried_per_motion(self) -> float | None:
        """How far what the drive carries goes for one metre of its motion, or for one radian, at the end of its arm [m]; None where
        nothing says it."""
        if self.motion is None:
            return None
        arm = getattr(self.mechanism, "arm_mm", None)
        return 1.0 if self.motion.unit == "mm" else None if arm is None else 1e-3 * arm

    @property
    def table(self) -> str:
        """The table of the file that holds the mechanism; empty where the motion is alone."""
        return _TABLES.get(type(self.mechanism), "follower")

    @property
    def is_alone(self) -> bool:
        """Whether the motion moves an output, and no mechanism."""
        return not self.table

    @property
    def tables(self) -> Mapping[str, Any]:
        """The tables of its file that it has, in their order; limits only where there is a cam, and then always."""
        parts = {
            "motion": self.motion,
            self.table: self.mechanism,
            "cam": self.cam,
            "loads": self.loads,
            "limits": None if self.cam is None else self.limits,
            "servo": self.servo,
        }
        tables = {name: parts[name] for name in SECTIONS if parts.get(name) is not None}
        return tables | {f"{MOTIONS}{each.name}": each.motion for each in self.motions}

    @property
    def motions(self) -> tuple[NamedMotion, ...]:
        """Of second drivers."""
        return self.mechanism.motions if isinstance(self.mechanism, Linkage) else ()

    @property
    def sections(self) -> tuple[str, ...]:
        """The tables that it may have, in their order."""
        others = {"shaft", "follower", "linkage", *(("cam", "limits") if self.is_alone else ())} - {self.table}
        return (*(name for name in SECTIONS if name not in others), *(f"{MOTIONS}{m.name}" for m in self.motions))

    @property
    def linkage(self) -> Linkage:
        """The mechanism, where it is a linkage."""
        assert isinstance(self.mechanism, Linkage), "a follower is no linkage"
        return self.mechanism

    @property
    def follower(self) -> Follower:
        """The mechanism, where it is a follower."""
        assert not isinstance(self.mechanism, Linkage | Output), "no follower"
        return self.mechanism

    @property
    def posed(self) -> Follower | Linkage | Output:
        """The mechanism, its driver, where it is a linkage that is drawn, at a place that is stated: where a motion begins."""
        drawn = self.mechanism.drawn if isinstance(self.mechanism, Linkage) else None
        if drawn is None or self.motion is None or drawn.driver_deg is not None or drawn.driver_mm is not None:
            return self.mechanism
        at: dict[str, Any] = {"driver_deg" if driver_turns(self.linkage) else "driver_mm": self.motion.start}
        return replace(self.linkage, drawn=replace(drawn, **at))

    @property
    def is_linkage(self) -> bool:
        """Whether its links are laid out one by one, rather than built by a follower."""
        return isinstance(self.mechanism, Linkage)

    @property
    def by_crank(self) -> bool:
        """Whether a crank turns at constant speed, and no motion moves the mechanism."""
        return self.is_linkage and self.linkage.driver.kind == CRANK

    @property
    def loads_shaft(self) -> bool:
        """Whether cam or crank make the shaft carry it; a motion that no cam makes is driven by something else."""
        return self.cam is not None or self.by_crank

    @property
    def kind(self) -> str:
        """Slug of the mechanism's kind: a follower's, ``linkage``, or ``motion`` where that is alone."""
        return kind_of(self.follower) if self.table == "follower" else self.table or MOTION

    @property
    def label(self) -> str:
        """Its kind in words."""
        if self.is_linkage:
            return f"Linkage of {len(self.links)} links"
        return "Motion" if self.is_alone else FOLLOWER_KINDS[self.kind].label

    @property
    def signed_rpm(self) -> float:
        """The speed of its driver where no shaft says it, negative clockwise."""
        return self.linkage.driver.speed_rpm if self.is_linkage else MOTION_SPEED

    @property
    def loaded(self) -> bool:
        """Whether there is anything that asks for a force: links always, an output where it has a mass, or a servo moves it."""
        if not isinstance(self.loads, OutputLoads):
            return True
        return self.servo is not None or self.loads != type(self.loads)()

    @property
    def face(self) -> Face:
        """What touches the cam, with its size, of a drive that has a cam."""
        assert self.cam is not None, "a drive without a cam"
        face: Face = self.cam.face if self.is_linkage else face_of(self.follower, self.cam)
        return face

    @cached_property
    def bare_cam(self) -> Any:
        """The cam without what its profile does not depend on."""
        if self.cam is None:
            return None
        bare, second = replace(self.cam, **dict.fromkeys(BLANK)), getattr(self.cam.form, "second", None)
        if second is None:
            return bare
        return replace(bare, form=replace(bare.form, second=replace(second, **dict.fromkeys(OF_SECOND))))

    @property
    def face_path(self) -> str:
        """Where the file has the word for it."""
        return "cam.face" if self.is_linkage else "follower.face"

    @property
    def links(self) -> tuple[Link, ...]:
        """The links that are listed one by one; none of a follower, which builds its own from its lengths."""
        return self.linkage.links if self.is_linkage else ()

    @property
    def angle_name(self) -> str:
        """What the angle of a turn is called in tables and texts: ``cam angle``, or ``driver angle`` of a linkage."""
        return "driver angle" if self.is_linkage else "cam angle"

    @property
    def motion_unit(self) -> str:
        """mm or deg: what the motion counts in."""
        if self.motion is not None:
            return self.motion.unit
        return "deg" if self.is_linkage else FOLLOWER_KINDS[self.kind].motion_unit


@frozen
class TimingRow:
    """One event at least so much after another: ``first`` and ``second`` are a drive's name and rise or return with its number,
    and start or end: ``feed.return.1.end``."""

    first: str = placed(FileLayout(missing="NAME.rise.1.start, or return, or end"))
    second: str = placed(FileLayout(missing="NAME.rise.1.start, or return, or end"))
    least_deg: float = number(
        "Least distance", -360.0, 360.0, default=0.0, step=1.0, help="second comes at least that much after first"
    )


@frozen
class Design:
    """A shaft with its drives. ``shaft`` is None where a linkage's own driver says how fast it turns; ``assumed`` lists the
    field paths whose values are guesses; ``timing`` what must come after what; ``balancer`` the balance cam, where there is one;
    ``tolerances`` and ``waviness`` how far it may be off as made."""

    name: str
    shaft: Shaft | None
    drives: tuple[Drive, ...]
    assumed: tuple[str, ...] = ()
    timing: tuple[TimingRow, ...] = ()
    balancer: Balancer | None = None
    tolerances: tuple[Tolerance, ...] = ()
    waviness: Waviness | None = None

    @property
    def listed(self) -> bool:
        """Whether its file lists its drives, each by its name."""
        return any(drive.name is not None for drive in self.drives)

    @property
    def drive(self) -> Drive:
        """The drive, of a design that has one."""
        (drive,) = self.drives
        return drive

    @property
    def camshaft(self) -> Shaft:
        """The shaft, of a design that has one."""
        assert self.shaft is not None, "a linkage without [shaft]"
        return self.shaft

    @property
    def tables(self) -> Mapping[str, Any]:
        """The tables of its file that it has, in their order; of a list of drives ``shaft``, then ``drives[0]`` with its name and
        phase, ``drives[0].motion`` and so on, ``timing[0]``."""
        shaft = {} if self.shaft is None else {"shaft": self.shaft}
        if self.listed:
            parts: dict[str, Any] = shaft
            for i, drive in enumerate(self.drives):
                parts |= {f"drives[{i}]": drive, **{f"drives[{i}].{name}": part for name, part in drive.tables.items()}}
            parts |= {f"timing[{i}]": each for i, each in enumerate(self.timing)}
            return parts if self.balancer is None else {**parts, "balancer": self.balancer}
        parts = {**self.drive.tables, **shaft}
        return {name: parts[name] for name in (*SECTIONS, *parts) if name in parts}

    @property
    def sections(self) -> tuple[str, ...]:
        """The tables that its file may have, in their order."""
        if self.listed:
            return tuple(dict.fromkeys(("shaft", *self.tables, "balancer")))
        named = self.drive.sections
        return (*(n for n in SECTIONS if n in ("shaft", *named)), *(n for n in named if n not in SECTIONS))

    @property
    def speed_rpm(self) -> float:
        """How fast the shaft or the driver turns, either way round."""
        return abs(self.drive.signed_rpm if self.shaft is None else self.shaft.speed_rpm)

    @property
    def sense(self) -> float:
        """d of the papers: +1 where cam or crank turns counter-clockwise, -1 clockwise."""
        if self.shaft is not None:
            return self.shaft.sense
        return 1.0 if first_value(self.drive.signed_rpm) > 0.0 else -1.0

    @property
    def by_crank(self) -> bool:
        """Whether a crank turns at constant speed, and no motion moves the mechanism, of a design that lists no drives."""
        return not self.listed and self.drive.by_crank

    @property
    def angle_name(self) -> str:
        """What the angles of its findings are called."""
        return "cam angle" if self.listed else self.drive.angle_name

    @property
    def stages(self) -> tuple[str, ...]:
        """Those of ``STAGES`` that it has, in the order in which they need each other."""
        return tuple(name for name, has in _STAGES.items() if has(self))


def _any_drive(has: Callable[[Drive], bool]) -> Callable[[Design], bool]:
    return lambda design: any(map(has, design.drives))


_STAGES: Mapping[str, Callable[[Design], bool]] = MappingProxyType(
    {
        "motion": _any_drive(lambda drive: drive.motion is not None),
        "linkage": _any_drive(lambda drive: not drive.is_alone),
        "cam": _any_drive(lambda drive: drive.cam is not None),
        "dynamics": _any_drive(lambda drive: drive.loaded),
        "stability": lambda design: design.shaft is not None and any(drive.loads_shaft for drive in design.drives),
    }
)
"""Stage -> whether a design has it."""
STAGES = tuple(_STAGES)
"""All stages that a study may have, in the order in which they need each other."""


def with_drive(design: Design, *, assumed: tuple[str, ...] | None = None, **parts: Any) -> Design:
    """The design with parts of its drive replaced, and what is assumed."""
    marks = design.assumed if assumed is None else assumed
    return replace(design, drives=(replace(design.drive, **parts),), assumed=marks)


def with_table(design: Design, name: str, part: Any) -> Design:
    """The design with one table of its file replaced, or taken away where the part is None."""
    if name in ("shaft", "balancer"):
        return replace(design, **{name: part})
    return replace(design, drives=(with_drive_table(design.drive, name, part),))


def with_servo(design: Design) -> Design:
    """The design with a servo motor to begin with, all of it assumed; a slide moves 10 mm a turn of it. There must be a motion."""
    motion = design.drive.motion
    assert motion is not None, "nothing moves"
    travel = 10.0 if motion.unit == "mm" else None
    paths = ("servo.gear_ratio", *(("servo.travel_mm_per_turn",) if travel else ()))
    return with_drive(design, servo=Servo(kind=ROTARY, travel_mm_per_turn=travel), assumed=(*design.assumed, *paths))


def without_servo(design: Design) -> Design:
    """The design without it, and nothing assumed of it."""
    return with_drive(design, servo=None, assumed=tuple(p for p in design.assumed if not p.startswith("servo.")))


def with_drive_table(drive: Drive, name: str, part: Any) -> Drive:
    """The drive with one of its tables replaced, or taken away where the part is None."""
    if name == "limits" and part is None:
        part = NO_LIMITS
    if name.startswith(MOTIONS):
        rest = [each for each in drive.motions if f"{MOTIONS}{each.name}" != name]
        added = [] if part is None else [NamedMotion(name.removeprefix(MOTIONS), part)]
        return replace(drive, mechanism=replace(drive.linkage, motions=(*rest, *added)))
    parts: dict[str, Any] = {"mechanism" if name == drive.table else name: part}
    return replace(drive, **parts)


def require_linkage(design: Design) -> Design:
    """The design, where it is a linkage. Raises DesignError."""
    if design.drive.is_linkage:
        return design
    table = design.drive.table or "motion"
    raise DesignError([Fault(table, f"[{table}]", "this kind of design does not take it", "a design with [linkage]")])
