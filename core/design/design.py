"""A design: a shaft and the drives that it turns. A file has one drive, or a list of drives."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from types import MappingProxyType
from typing import Any, TypeVar

from core.design.curves import nose_deg
from core.design.engine import Engine, Valve
from core.design.fields import FileLayout, flag, number, placed
from core.design.follower_kinds import FOLLOWER_KINDS, kind_of
from core.design.followers import OF_SECOND, CamDetails, Face, Groove
from core.design.limits import NO_LIMITS, Limits, Tolerance, Waviness
from core.design.linkage import CRANK, MOTION, MOTION_SPEED, Link, Linkage, NamedMotion
from core.design.loads import Balancer
from core.design.motions import Motion
from core.design.outlines import ClearanceRow, Outline
from core.design.parts import ROTARY, Follower, Output, OutputLoads, Pushrod, Rocker, Servo, Shaft, face_of
from core.design.topology import driver_turns
from core.errors import DesignError, Fault
from core.frozen import frozen
from core.numerics.lazy import Column, first_value, lazy

D = TypeVar("D")
BLANK = frozenset(field.name for field in fields(CamDetails))
SECTIONS = ("motion", "follower", "linkage", "cam", "shaft", "engine", "valve", "loads", "limits", "servo")
"""Tables of a file in their order; no design has all of them. The motions of second drivers follow them."""
SHARED = ("shaft", "engine")
"""Tables that several drives share."""
_OPPOSITE = {"ccw": "cw", "cw": "ccw"}
MOTIONS = "motions."
"""Prefix of the name of a second driver's motion."""


_SEPARATE = FileLayout(in_file=False)  # in a separate table
_TABLES: Mapping[type, str] = MappingProxyType({Linkage: "linkage", Output: ""})  # all others are followers


@frozen
class Drive:
    """A motion with its mechanism, cam, loads and limits.

    Attributes
    ----------
    motion : None where a crank turns at constant speed
    mechanism : a follower, a linkage, or the output of a motion without a mechanism
    cam : None where no cam makes the motion
    loads, limits : loads, and limits of the user
    name : on a shaft of several drives; None where the design has one drive
    phase_deg : cam angle = machine angle - phase [deg]
    mirrored : whether it is designed as seen from the other end of the shaft, which then turns in the opposite sense
    carries : direction in space of its motion, where several drives carry one part; else empty
    servo : motor of the drive; None where it has none
    valve : valve that it moves; None where it has none
    """

    motion: Motion | None = placed(_SEPARATE)
    mechanism: Follower | Linkage | Output = placed(_SEPARATE)
    cam: Any = placed(_SEPARATE)  # Cam | LinkageCam | None, by the mechanism
    loads: Any = placed(_SEPARATE)  # Loads | LinkageLoads | OutputLoads
    limits: Limits = placed(_SEPARATE, NO_LIMITS)
    name: str | None = placed(FileLayout(missing="any text with a letter or a digit"), None)
    phase_deg: float = number("Phase", -3600.0, 3600.0, default=0.0, step=1.0, help="cam angle = machine angle - phase")
    mirrored: bool = flag(
        "Mirrored", help="designed as seen from the other end, where the shaft turns in the opposite sense"
    )
    carries: tuple[float, ...] = placed(FileLayout(each=float), ())
    servo: Servo | None = placed(_SEPARATE, None)
    valve: Valve | None = placed(_SEPARATE, None)

    @property
    def derived(self) -> tuple[str, ...]:
        """Fields that follow from others, and that a file does not contain."""
        return () if self.valve is None else ("phase_deg",)

    @property
    def phase(self) -> float:
        """Machine angle at cam angle 0 [deg], on a shaft of several drives: by the centre of its valve, else ``phase_deg``."""
        if self.valve is None or self.motion is None or self.name is None:
            return self.phase_deg
        return (0.5 * (self.valve.centre_deg + self.valve.cylinder_deg) - nose_deg(self.motion)) % 360.0

    @property
    def is_valve_motion(self) -> bool:
        """Whether the motion is that of the valve, the lash not taken off: not of a pushrod's tappet, or of another slider."""
        link = None if self.valve is None else self.valve.link
        return not isinstance(self.mechanism, Pushrod) and (link is None or link == self.linkage.driver.link)

    @property
    def has_valve(self) -> bool:
        """Whether the drive moves a valve: the train contains it, or the drive has a table ``[valve]``."""
        return isinstance(self.mechanism, Rocker | Pushrod) or self.valve is not None

    @property
    def carried_per_motion(self) -> float | None:
        """Displacement of the carried part per unit of the motion [m/m or m/rad], at the end of an arm; None where it is unknown."""
        if self.motion is None:
            return None
        arm = getattr(self.mechanism, "arm_mm", None)
        return 1.0 if self.motion.unit == "mm" else None if arm is None else 1e-3 * arm

    @property
    def table(self) -> str:
        """Name of the mechanism's table in the file; empty for a motion without a mechanism."""
        return _TABLES.get(type(self.mechanism), "follower")

    @property
    def is_alone(self) -> bool:
        """Whether the motion moves an output without a mechanism; a cam in space may move it."""
        return not self.table

    @property
    def has_disk(self) -> bool:
        """Whether it has a disk cam, which moves its follower or linkage."""
        return self.cam is not None and not self.is_alone

    @property
    def has_surface(self) -> bool:
        """Whether it has a cam in space, which moves its output."""
        return self.cam is not None and self.is_alone

    @property
    def tables(self) -> Mapping[str, Any]:
        """Name -> table of its file, in their order; limits always and only together with a cam."""
        parts = {
            "motion": self.motion,
            self.table: self.mechanism,
            "cam": self.cam,
            "loads": self.loads,
            "limits": None if self.cam is None else self.limits,
            "servo": self.servo,
            "valve": self.valve,
        }
        tables = {name: parts[name] for name in SECTIONS if parts.get(name) is not None}
        return tables | {f"{MOTIONS}{row.name}": row.motion for row in self.motions}

    @property
    def motions(self) -> tuple[NamedMotion, ...]:
        """Motions of second drivers."""
        return self.mechanism.motions if isinstance(self.mechanism, Linkage) else ()

    @property
    def sections(self) -> tuple[str, ...]:
        """Names of the tables that it may have, in their order."""
        without_cam = ("cam", "limits") if self.is_alone and self.cam is None else ()
        excluded = {"shaft", "engine", "follower", "linkage", *without_cam} - {self.table}
        return (*(name for name in SECTIONS if name not in excluded), *(f"{MOTIONS}{m.name}" for m in self.motions))

    @property
    def linkage(self) -> Linkage:
        """The mechanism of a drive with a linkage."""
        assert isinstance(self.mechanism, Linkage), "the mechanism is a follower"
        return self.mechanism

    @property
    def follower(self) -> Follower:
        """The mechanism of a drive with a follower."""
        assert not isinstance(self.mechanism, Linkage | Output), "the mechanism is a linkage or an output"
        return self.mechanism

    @property
    def posed(self) -> Follower | Linkage | Output:
        """The mechanism; in a drawn linkage the driver has a stated position, by default that of cam angle 0."""
        drawn = self.mechanism.drawn if isinstance(self.mechanism, Linkage) else None
        if drawn is None or self.motion is None or drawn.driver_deg is not None or drawn.driver_mm is not None:
            return self.mechanism
        position: dict[str, Any] = {"driver_deg" if driver_turns(self.linkage) else "driver_mm": self.motion.first}
        return replace(self.linkage, drawn=replace(drawn, **position))

    @property
    def is_linkage(self) -> bool:
        """Whether the mechanism is a linkage, with its links listed one by one."""
        return isinstance(self.mechanism, Linkage)

    @property
    def by_crank(self) -> bool:
        """Whether a crank at constant speed moves the mechanism, not a motion."""
        return self.is_linkage and self.linkage.driver.kind == CRANK

    @property
    def loads_shaft(self) -> bool:
        """Whether its torque acts on the shaft, by a cam or a crank."""
        return self.has_disk or self.by_crank or (self.has_surface and self.loaded)

    @property
    def kind(self) -> str:
        """Slug of the mechanism's kind: a follower's, ``linkage``, that of a cam in space, or ``motion`` without any."""
        if self.is_alone:
            return MOTION if self.cam is None else str(self.cam.kind)
        return kind_of(self.follower) if self.table == "follower" else self.table

    @property
    def label(self) -> str:
        """Kind of the mechanism, in words."""
        if self.is_linkage:
            return f"Linkage of {len(self.links)} links"
        if self.is_alone:
            return "Motion" if self.cam is None else str(self.cam.label)
        return FOLLOWER_KINDS[self.kind].label

    @property
    def signed_rpm(self) -> float:
        """Speed of the driver of a design without a shaft [rpm], negative clockwise."""
        return self.linkage.driver.speed_rpm if self.is_linkage else MOTION_SPEED

    @property
    def loaded(self) -> bool:
        """Whether there are forces to compute: always with links, for an output where it has loads or a servo."""
        if not isinstance(self.loads, OutputLoads):
            return True
        values = (getattr(self.loads, part.name) for part in fields(self.loads))
        return self.servo is not None or any(isinstance(value, Column) or value for value in values)

    @property
    def face(self) -> Face:
        """The follower's face on the cam, with its size, of a drive with a cam."""
        assert self.cam is not None, "a drive without a cam"
        face: Face = self.cam.face if self.is_linkage else face_of(self.follower, self.cam)
        return face

    @lazy
    def bare_cam(self) -> Any:
        """The cam without the fields that do not affect its profile."""
        if self.cam is None:
            return None
        blank = dict.fromkeys(field.name for field in fields(self.cam) if field.name in BLANK)
        bare, form = replace(self.cam, **blank), self.cam.form
        if isinstance(form, Groove):
            return replace(bare, form=Groove(form.play_mm))
        second = getattr(form, "second", None)
        if second is None:
            return bare
        return replace(bare, form=replace(form, second=replace(second, **dict.fromkeys(OF_SECOND))))

    @property
    def face_path(self) -> str:
        """Path of the face's word in the file."""
        return "cam.face" if self.is_linkage else "follower.face"

    @property
    def links(self) -> tuple[Link, ...]:
        """Links of a linkage; empty for a follower."""
        return self.linkage.links if self.is_linkage else ()

    @property
    def angle_name(self) -> str:
        """Name of the angle in tables and texts: ``cam angle``, or ``driver angle`` for a linkage."""
        return "driver angle" if self.is_linkage else "cam angle"

    @property
    def motion_unit(self) -> str:
        """Unit of the motion, mm or deg."""
        if self.motion is not None:
            return self.motion.unit
        return "deg" if self.is_linkage else FOLLOWER_KINDS[self.kind].motion_unit


@frozen
class TimingRow:
    """Sequence condition: the event ``second`` comes at least ``least_deg`` after ``first``.

    An event is a drive's name, a rise or return with its number, and start or end: ``feed.return.1.end``.
    """

    first: str = placed(FileLayout(missing="NAME.rise.1.start, or return, or end"))
    second: str = placed(FileLayout(missing="NAME.rise.1.start, or return, or end"))
    least_deg: float = number(
        "Least distance", -360.0, 360.0, default=0.0, step=1.0, help="second comes at least this much after first"
    )


@frozen
class Design:
    """A shaft with its drives.

    Attributes
    ----------
    name : of the design
    shaft : None where the driver of a linkage states the speed
    drives : one, or several with names
    assumed : paths of fields with assumed values
    timing : sequence conditions
    balancer : the balance cam, None where there is none
    tolerances, waviness : permitted deviations of the built machine
    engine : crank of a valve train; None where there is none
    outlines : outlines of bodies, between which clearances are computed
    clearances : clearances that pairs of bodies must keep
    """

    name: str
    shaft: Shaft | None
    drives: tuple[Drive, ...]
    assumed: tuple[str, ...] = ()
    timing: tuple[TimingRow, ...] = ()
    balancer: Balancer | None = None
    tolerances: tuple[Tolerance, ...] = ()
    waviness: Waviness | None = None
    engine: Engine | None = None
    outlines: tuple[Outline, ...] = ()
    clearances: tuple[ClearanceRow, ...] = ()

    def __post_init__(self) -> None:
        if any(drive.motion is not None and drive.motion.needs_machine for drive in self.drives):
            vars(self)["drives"] = tuple(map(self._with_machines, self.drives))

    def _with_machines(self, drive: Drive) -> Drive:
        """A drive whose optimal laws know the parts of their machine."""

        def machine(motion: Motion) -> Design:
            single = replace(
                drive, motion=motion, limits=NO_LIMITS, name=None, phase_deg=0.0, mirrored=False, carries=()
            )
            return Design("", self.shaft_of(drive), (single,), engine=self.engine)

        return drive if drive.motion is None else replace(drive, motion=drive.motion.in_machine(machine))

    def shaft_of(self, drive: Drive) -> Shaft | None:
        """Shaft with its speed and sense of rotation as seen by a drive."""
        if self.shaft is None:
            return None
        rotation = _OPPOSITE.get(self.shaft.rotation, self.shaft.rotation) if drive.mirrored else self.shaft.rotation
        return Shaft(rotation, self.shaft.speed_rpm)

    @property
    def listed(self) -> bool:
        """Whether its file has a list of named drives."""
        return any(drive.name is not None for drive in self.drives)

    @property
    def has_valves(self) -> bool:
        """Whether drives move valves of an engine."""
        return self.engine is not None and any(drive.valve is not None for drive in self.drives)

    @property
    def drive(self) -> Drive:
        """The drive of a design with one drive."""
        (drive,) = self.drives
        return drive

    @property
    def camshaft(self) -> Shaft:
        """The shaft of a design with a shaft."""
        assert self.shaft is not None, "a linkage without [shaft]"
        return self.shaft

    @property
    def tables(self) -> Mapping[str, Any]:
        """Name -> table of its file, in their order.

        With a list of drives: ``shaft``, ``drives[0]`` with its name and phase, ``drives[0].motion`` …, ``timing[0]`` ….
        """
        rows: dict[str, Any] = {f"outlines[{i}]": outline for i, outline in enumerate(self.outlines)}
        rows |= {f"clearances[{i}]": row for i, row in enumerate(self.clearances)}
        if self.listed:
            parts: dict[str, Any] = self._shared_tables
            for i, drive in enumerate(self.drives):
                parts |= {f"drives[{i}]": drive, **{f"drives[{i}].{name}": part for name, part in drive.tables.items()}}
            parts |= {f"timing[{i}]": row for i, row in enumerate(self.timing)}
            return parts | ({} if self.balancer is None else {"balancer": self.balancer}) | rows
        return {**self.drive_tables, **rows}

    @property
    def drive_tables(self) -> Mapping[str, Any]:
        """Name -> table of a design with one drive, in their order, without outlines and clearances."""
        parts = {**self.drive.tables, **self._shared_tables}
        return {name: parts[name] for name in (*SECTIONS, *parts) if name in parts}

    @property
    def _shared_tables(self) -> dict[str, Any]:
        """Name -> table of the shaft that several drives share."""
        shared = {"shaft": self.shaft, "engine": self.engine}
        return {name: part for name, part in shared.items() if part is not None}

    @property
    def sections(self) -> tuple[str, ...]:
        """Names of the tables that its file may have, in their order."""
        if self.listed:
            return tuple(dict.fromkeys((*SHARED, *self.tables, "balancer")))
        named = self.drive.sections
        return (*(n for n in SECTIONS if n in (*SHARED, *named)), *(n for n in named if n not in SECTIONS))

    @property
    def speed_rpm(self) -> float:
        """Speed of the shaft or the driver [rpm], positive."""
        return abs(self.drive.signed_rpm if self.shaft is None else self.shaft.speed_rpm)

    @property
    def sense(self) -> float:
        """Sense of rotation d of cam or crank: +1 counter-clockwise, -1 clockwise."""
        if self.shaft is not None:
            return self.shaft.sense
        return 1.0 if first_value(self.drive.signed_rpm) > 0.0 else -1.0

    @lazy
    def by_crank(self) -> bool:
        """Whether the only drive is moved by a crank at constant speed."""
        return not self.listed and self.drive.by_crank

    @property
    def angle_name(self) -> str:
        """Name of the angle in its findings."""
        return "cam angle" if self.listed else self.drive.angle_name

    @lazy
    def stages(self) -> tuple[str, ...]:
        """Stages that the design has, each after the stages on which it depends."""
        return tuple(name for name, has_stage in _STAGES.items() if has_stage(self))


def _any_drive(has_stage: Callable[[Drive], bool]) -> Callable[[Design], bool]:
    return lambda design: any(map(has_stage, design.drives))


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
"""All stages of a study, each after the stages on which it depends."""


def with_drive(design: Design, *, assumed: tuple[str, ...] | None = None, **parts: Any) -> Design:
    """Design with parts of its drive replaced, and its assumed paths where given."""
    marks = design.assumed if assumed is None else assumed
    return replace(design, drives=(replace(design.drive, **parts),), assumed=marks)


def with_table(design: Design, name: str, part: Any) -> Design:
    """Design with one table of its file replaced, or removed where the part is None."""
    if name in (*SHARED, "balancer"):
        return replace(design, **{name: part})
    return replace(design, drives=(with_drive_table(design.drive, name, part),))


def with_servo(design: Design) -> Design:
    """Design with a default servo motor, marked as assumed; a slide travels 10 mm per turn. The drive must have a motion."""
    motion = design.drive.motion
    assert motion is not None, "the drive has no motion"
    travel = 10.0 if motion.unit == "mm" else None
    paths = ("servo.gear_ratio", *(("servo.travel_mm_per_turn",) if travel else ()))
    return with_drive(design, servo=Servo(kind=ROTARY, travel_mm_per_turn=travel), assumed=(*design.assumed, *paths))


def without_servo(design: Design) -> Design:
    """Design without a servo motor, and without its assumed paths."""
    return with_drive(design, servo=None, assumed=tuple(p for p in design.assumed if not p.startswith("servo.")))


def with_drive_table(drive: Drive, name: str, part: Any) -> Drive:
    """Drive with one of its tables replaced, or removed where the part is None."""
    if name == "limits" and part is None:
        part = NO_LIMITS
    if name.startswith(MOTIONS):
        rest = [row for row in drive.motions if f"{MOTIONS}{row.name}" != name]
        added = [] if part is None else [NamedMotion(name.removeprefix(MOTIONS), part)]
        return replace(drive, mechanism=replace(drive.linkage, motions=(*rest, *added)))
    parts: dict[str, Any] = {"mechanism" if name == drive.table else name: part}
    return replace(drive, **parts)


def require_linkage(design: Design) -> Design:
    """Return the design where its mechanism is a linkage.

    Raises
    ------
    DesignError
        For any other mechanism.
    """
    if design.drive.is_linkage:
        return design
    table = design.drive.table or "motion"
    raise DesignError([Fault(table, f"[{table}]", "this kind of design cannot have it", "a design with [linkage]")])
