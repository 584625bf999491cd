"""Findings: limits that a design exceeds, and the table of their sentences and remedies."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from core.frozen import frozen
from core.number_text import RESULT_DIGITS, compared_texts, result_text, rounded_up, typed_text

ERROR, WARNING, NOTE = "error", "warning", "note"


@frozen
class Finding:
    """One exceeded limit.

    Attributes
    ----------
    code : key of ``ROWS``
    severity : ``error`` (the machine cannot work), ``warning`` or ``note``
    field : path of the input that remedies it
    cam_angle_deg : angle of the worst value [deg], None where the finding concerns the full turn
    values : name -> value in the sentence, in the unit that the sentence states
    """

    code: str
    severity: str
    field: str
    cam_angle_deg: float | None
    values: Mapping[str, float | str] = dataclasses.field(default_factory=lambda: MappingProxyType({}))

    @property
    def message(self) -> str:
        """The sentence, with figures for reading; compared figures have as many digits as distinguish them."""
        row, values = self._row, {"face": "roller", **self.values}
        numbers = [float(values.get(name, 1.0)) for name in row.compared]
        texts = {name: _Figure(value) if isinstance(value, float) else value for name, value in values.items()}
        texts |= zip(row.compared, compared_texts(numbers), strict=True)
        return row.sentence.format(**texts, at=self._at)

    @property
    def remedy(self) -> Remedy:
        """Remedy that the window offers, where the design has it: see ``core.find.remedy_of``."""
        return self._row.remedy

    @property
    def _row(self) -> FindingRow:
        """Row of the code or of its variant, for a face, a flank, play, fatigue or an infinite factor; limits of the user share one row."""
        factor = self.values.get("factor")
        if "play_mm" in self.values:
            variant: float | str = "play"
        elif "safety" in self.values:
            variant = "fatigue"
        else:
            variant = "endless" if factor == math.inf else self.values.get("face", "")
        keys = (f"{self.code}.{suffix}" for suffix in (variant, self.values.get("flank", "")))
        return ROWS.get(next((key for key in keys if key in ROWS), self.code), USER_LIMIT)

    @property
    def _at(self) -> str:
        """The cam angle as part of a sentence."""
        angle = self.cam_angle_deg
        return "" if angle is None or not math.isfinite(angle) else f" at {result_text(angle)} deg"

    @property
    def states_angle(self) -> bool:
        """Whether the sentence states the cam angle."""
        return "{at}" in self._row.sentence


class _Figure(float):
    """Value of a sentence: a result, with the format ``up`` rounded up, or with ``typed`` a number that is typed."""

    def __format__(self, spec: str) -> str:
        if spec == "typed":
            return typed_text(f"{float(self):.9g}")
        return result_text(rounded_up(float(self), RESULT_DIGITS) if spec == "up" else self)


def _compared(*names: str) -> tuple[str, ...]:
    return names


class Remedy(NamedTuple):
    """Remedy that the window offers with a finding.

    Attributes
    ----------
    label : text of its button; {name} is replaced by the name of the field
    find : search that computes the remedy, if the design has it
    of : field of the findings that have this search; empty: any field
    field : field to which the button leads; empty: the finding's field
    masses : whether the button gives the links masses
    """

    label: str = "{name}"
    find: str = ""
    of: str = ""
    field: str = ""
    masses: bool = False


_BASE_RADIUS = Remedy("Find base radius", "base-radius")
_LARGER = _BASE_RADIUS._replace(of="cam.base_radius_mm")
_FACE_WIDTH, _SPRING, _PRELOAD, _FLYWHEEL, _PHASES = (
    Remedy(f"Find {search.replace('-', ' ')}", search)
    for search in ("face-width", "spring", "preload", "flywheel", "phases")
)
_INNER, _CENTRES, _ROLLER = (
    Remedy(f"Find {search.replace('-', ' ')}", search)
    for search in ("inner-distance", "centre-distance", "roller-radius")
)
_THICKNESS = Remedy(field="cam.thickness_mm")
_ADD, _MASSES = Remedy("Add {name}"), Remedy("Add masses", masses=True)


class FindingRow(NamedTuple):
    """Row of a code: its sentence with values in braces, the figures that it compares, its remedy, and the severities that it can have."""

    sentence: str
    compared: tuple[str, ...] = ()
    remedy: Remedy = Remedy()
    severities: tuple[str, ...] = (WARNING,)


USER_LIMIT = FindingRow("{what} {value} {unit}{at}, your limit {limit} {unit}: {remedy}", _compared("value", "limit"))
"""Row of every limit of quantities that a user states; their codes have no row in ``ROWS``."""
ROWS: Mapping[str, FindingRow] = MappingProxyType(
    {
        "jump-displacement": FindingRow("displacement jumps by {jump} {unit_name} at a join: no follower can do this", severities=(ERROR,)),
        "jump-velocity": FindingRow("velocity jumps by {jump} {unit_name}/rad at a join: infinite acceleration", severities=(ERROR,)),
        "jump-acceleration": FindingRow("acceleration jumps by {jump} {unit_name}/rad² at a join: infinite jerk"),
        "uneven-advance": FindingRow(
            "the advance of {advance:typed} deg per turn is neither a whole fraction nor a multiple of 360 deg, "
            "so that the output does not return to the same stops; the nearest valid advance is {near:typed} deg", severities=(NOTE,),
        ),
        "pressure-angle": FindingRow(
            "pressure angle {value} deg{at}, limit {limit} deg: enlarge the base radius, or lengthen the rise",
            _compared("value", "limit"), _LARGER, severities=(WARNING, ERROR),
        ),
        "pressure-angle.barrel": FindingRow(
            "pressure angle {value} deg{at}, limit {limit} deg: enlarge the inner distance of the roller, or lengthen the rise",
            _compared("value", "limit"), _INNER, severities=(WARNING, ERROR),
        ),
        "pressure-angle.globoidal": FindingRow(
            "pressure angle {value} deg{at}, limit {limit} deg: enlarge the centre distance, or lengthen the rise",
            _compared("value", "limit"), _CENTRES, severities=(WARNING, ERROR),
        ),
        "pressure-angle.flat": FindingRow(
            "pressure angle {value} deg{at}, limit {limit} deg: reduce the {what} of the face", _compared("value", "limit"),
            severities=(WARNING, ERROR),
        ),
        "roller-pressure-angle": FindingRow(
            "pressure angle {value} deg{at}, limit {limit} deg: attach the roller at another point, or move the cam's centre",
            _compared("value", "limit"), severities=(WARNING, ERROR),
        ),
        "undercut": FindingRow(
            "undercut: the pitch curve's smallest radius is {pitch_radius_mm} mm{at}, the roller's {roller_radius_mm} mm: enlarge the base "
            "radius, or use a smaller roller", _compared("pitch_radius_mm", "roller_radius_mm"), _BASE_RADIUS, severities=(ERROR,),
        ),
        **{
            f"undercut.{kind}": FindingRow(
                "undercut: a flank has an edge{at} under the roller of {roller_radius_mm:typed} mm: use a smaller roller, or {remedy}",
                remedy=_ROLLER, severities=(ERROR,),
            )
            for kind in ("barrel", "globoidal")
        },
        "rib-vanishes": FindingRow(
            "the rib between two rollers has a thickness of {thickness_mm} mm{at}: use smaller rollers, or fewer of them",
            remedy=_ROLLER, severities=(ERROR,),
        ),
        "turret-free": FindingRow(
            "only {count} roller is on the rib{at}, so that the turret is not held in one sense: enlarge the length of the blank, or start "
            "the motion with two rollers astride of the rib", severities=(ERROR,),
        ),
        "groove-leaves-blank": FindingRow(
            "the groove leaves the blank{at}: it reaches {reach_mm} mm from the middle of the blank, which ends at {half_mm} mm: enlarge "
            "the length of the blank", _compared("reach_mm", "half_mm"), severities=(WARNING,),
        ),
        "undercut.shoe": FindingRow(
            "undercut: the pitch curve's smallest radius is {pitch_radius_mm} mm{at}, the shoe's {shoe_radius_mm} mm: enlarge the base "
            "radius, or use a shoe of smaller radius", _compared("pitch_radius_mm", "shoe_radius_mm"), _BASE_RADIUS, severities=(ERROR,),
        ),
        "undercut.flat": FindingRow(
            "undercut: under the flat face the profile's least radius of curvature is {radius_mm} mm{at}, it must be above 0: "
            "{remedy}", remedy=_BASE_RADIUS, severities=(ERROR,),
        ),
        "outer-undercut": FindingRow(
            "undercut of the groove's outer flank: the pitch curve's smallest concave radius is {pitch_radius_mm} mm{at}, roller and play "
            "{roller_radius_mm} mm: use a smaller roller, or enlarge the base radius",
            _compared("pitch_radius_mm", "roller_radius_mm"), _LARGER, severities=(ERROR,),
        ),
        "groove-flanks-meet": FindingRow(
            "two sections of the groove overlap{at} and at {other_deg} deg, by {overlap_mm} mm: use a smaller "
            "roller, or enlarge the base radius", severities=(ERROR,),
        ),
        "second-undercut": FindingRow(
            "undercut of the second cam: its pitch curve's smallest radius is {pitch_radius_mm} mm{at}, the second roller's "
            "{roller_radius_mm} mm: move the second roller outwards, or use a smaller one",
            _compared("pitch_radius_mm", "roller_radius_mm"), severities=(ERROR,),
        ),
        "second-pressure-angle": FindingRow(
            "pressure angle of the second roller {value} deg{at}, limit {limit} deg: {remedy}", _compared("value", "limit"),
            severities=(WARNING, ERROR),
        ),
        "second-roller-meets-hub": FindingRow(
            "the second roller meets the {what} of the first cam{at}: its least distance from the cam centre is {distance_mm} mm, the "
            "radius of the {what} {radius_mm} mm: move the roller outwards, or use a smaller one", _compared("distance_mm", "radius_mm"),
            severities=(ERROR,),
        ),
        "second-roller-pushes-along": FindingRow(
            "the second roller pushes the follower in the same direction as the first{at}, so the pair does not constrain it: put the "
            "second roller on the other side of the cam centre", severities=(ERROR,),
        ),
        "flank-change": FindingRow("the contact changes to the {to}{at}", severities=(NOTE,)),
        "flank-change.play": FindingRow(
            "the contact changes to the {to}{at}: over a play of {play_mm} mm it strikes with {impact_m_s} m/s", severities=(NOTE,),
        ),
        "face-too-narrow": FindingRow(
            "the contact leaves the flat face{at}: its position is {contact_mm} mm, {needed_mm} mm from the face's centre; half the "
            "face's width is {half_width_mm} mm: widen the face, or move its centre",
            _compared("needed_mm", "half_width_mm"), _FACE_WIDTH, severities=(ERROR,),
        ),
        "pressure-angle-rise": FindingRow(
            "pressure angle {value} deg on the rise{at}, your limit {limit} deg: {remedy}", _compared("value", "limit"), _LARGER,
        ),
        "pressure-angle-return": FindingRow(
            "pressure angle {value} deg on the return{at}, your limit {limit} deg: {remedy}", _compared("value", "limit"), _LARGER,
        ),
        "pressure-angle-rise.second": FindingRow(
            "pressure angle of the second roller {value} deg on the rise{at}, your limit {limit} deg: {remedy}",
            _compared("value", "limit"),
        ),
        "pressure-angle-return.second": FindingRow(
            "pressure angle of the second roller {value} deg on the return{at}, your limit {limit} deg: {remedy}",
            _compared("value", "limit"),
        ),
        "convex-radius": FindingRow(
            "the profile's smallest convex radius is {value} mm{at}, {whose} {limit} mm{why}: make the cam larger, or its motion gentler",
            _compared("value", "limit"), _LARGER,
        ),
        "polar-radius": FindingRow(
            "the profile's least distance from the cam centre is {value} mm{at}, {whose} {limit} mm{why}: make the cam larger, or "
            "state the actual bore and hub", _compared("value", "limit"), _LARGER,
        ),
        "concave-radius": FindingRow(
            "the profile's smallest concave radius is {value} mm{at}, {whose} {limit} mm{why}: make the cam larger, or its motion "
            "gentler", _compared("value", "limit"), _LARGER,
        ),
        "contact-pressure": FindingRow(
            "contact pressure {value} MPa{at}, your limit {limit} MPa: widen the cam, enlarge roller or base radius, or lower the "
            "force", _compared("value", "limit"), _THICKNESS,
        ),
        "material-pressure": FindingRow(
            "contact pressure {value} MPa{at}, the {what}'s {material} allows {limit} MPa ({source}): widen the cam, enlarge roller or "
            "base radius, or lower the force", _compared("value", "limit"), _THICKNESS,
        ),
        "no-contact-pressure": FindingRow("no contact pressure: give {missing}", remedy=_ADD, severities=(NOTE, WARNING)),
        "no-contact-pressure-edge": FindingRow(
            "no contact pressure: a {face} touches in a line without width, for which Hertz's equations do not hold: use a roller or a "
            "shoe", severities=(NOTE, WARNING),
        ),
        "no-contact-pressure-undercut": FindingRow(
            "no contact pressure: the profile is undercut, the {face} does not fit it",
            severities=(NOTE, WARNING),
        ),
        "profile-meets-hub": FindingRow(
            "the profile's least distance from the cam centre is {radius_mm} mm{at}, the radius of the {what} {limit_mm} mm: make the "
            "cam larger, or the {what} smaller", _compared("radius_mm", "limit_mm"), _BASE_RADIUS, severities=(ERROR,),
        ),
        "profile-meets-keyway": FindingRow(
            "the profile cuts {overlap_mm} mm into the keyway{at}: turn the keyway, make it shallower, or make the cam larger",
            remedy=_BASE_RADIUS, severities=(ERROR,),
        ),
        "cutter-too-large": FindingRow(
            "the cutter's radius of {cutter_mm} mm is larger than the profile's concave radius of {radius_mm} mm{at}: use a cutter "
            "no larger than that", _compared("cutter_mm", "radius_mm"), severities=(ERROR,),
        ),
        "cutter-wider-than-groove": FindingRow(
            "the cutter's radius of {cutter_mm} mm is more than half the width of the groove, {radius_mm} mm: use a cutter no larger "
            "than that", _compared("cutter_mm", "radius_mm"), severities=(ERROR,),
        ),
        "self-intersection": FindingRow(
            "the {which} crosses itself: it passes the same point{at} and at {other_deg} deg; make the cam larger, the roller "
            "smaller or the motion gentler", remedy=_LARGER, severities=(ERROR,),
        ),
        "servo-peak": FindingRow(
            "the servo's motor must give {value} {unit}{at}, its peak is {limit}: use a larger motor, another gear ratio, or a "
            "gentler motion", _compared("value", "limit"), severities=(ERROR,),
        ),
        "servo-rms": FindingRow(
            "the servo's motor gives {value} {unit} as rms over the turn, rated {limit}: use a larger motor, another gear ratio, "
            "or a lower speed", _compared("value", "limit"), severities=(ERROR,),
        ),
        "servo-speed": FindingRow(
            "the servo's motor runs at {value} {unit}{at}, rated {limit}: use a smaller gear ratio, or a lower speed",
            _compared("value", "limit"),
        ),
        "separation": FindingRow(
            "the {face} leaves the cam: contact force {force_n} N; it lifts off at {speed_rpm} rpm and above: add closing force or "
            "lower the speed", remedy=_SPRING, severities=(ERROR,),
        ),
        "lash-beyond-ramp": FindingRow(
            "the valve {verb} on the flank of the lobe: the lash is taken up at {lash_mm} mm of lobe lift, the ramp ends at {ramp_mm} mm: "
            "enlarge the ramp, or reduce the lash", _compared("lash_mm", "ramp_mm"),
        ),
        "piston-valve": FindingRow(
            "the valve hits the piston: clearance {clearance_mm} mm at {crank_deg} deg of the crank from TDC of overlap: enlarge the "
            "clearance at TDC by a pocket, or reduce lift, duration or overlap"
        ),
        "coil-bind": FindingRow(
            "the {spring} binds: at the greatest lift of {lift_mm} mm {bind_mm} mm are left between its coils: enlarge the installed "
            "length, or reduce wire or coils"
        ),
        "spring-stress.fatigue": FindingRow(
            "fatigue of the {spring}: safety {safety}, limit 1 (Goodman, shear stress {seat_mpa} to {value} MPa): enlarge the wire, or "
            "reduce the lift or the force"
        ),
        "spring-surge": FindingRow(
            "surge of the valve spring takes the {face} off the cam: contact force {force_n} N{at}; raise its natural frequency of "
            "{natural_hz} Hz by fewer active coils, or its force, or lower the speed"
        ),
        "elastic-separation": FindingRow(
            "the {face} of the elastic follower leaves the cam{at}: contact force {force_n} N in steady running, though a rigid one "
            "would stay on it: add closing force, stiffness or damping, lower the speed, or use a gentler motion", remedy=_SPRING,
        ),
        "contact-force-low": FindingRow(
            "contact force {value} N{at}, it must be at least {limit} N: enlarge the spring's preload or rate, or lower the speed",
            _compared("value", "limit"), _PRELOAD,
        ),
        "jamming": FindingRow(
            "friction jams the guide: the friction coefficient times the slope of the pushing force is {factor}, it must be below 1: "
            "reduce the friction, or the pressure angle", _compared("factor", "limit"), severities=(ERROR,),
        ),
        "jamming.endless": FindingRow(
            "friction jams the guide: the pushing force is perpendicular to it, so that any friction locks it: reduce the pressure angle",
            severities=(ERROR,),
        ),
        "pair-jamming": FindingRow(
            "friction jams the mechanism{at}, most of all at {pair}: the factor by which friction increases itself is {factor}, it must "
            "be below 1: reduce its coefficient, or use a thinner pin or a longer slide", _compared("factor", "limit"), severities=(ERROR,),
        ),
        "spring-ends-meet": FindingRow(
            "the ends of {name} meet{at}, where its force has no direction: attach it elsewhere, or give it a free length of 0 and no "
            "damper", severities=(ERROR,),
        ),
        "spring-no-length": FindingRow(
            "both ends of {name} coincide over the full turn, so that it exerts no force: attach one of them elsewhere",
            severities=(ERROR,),
        ),
        "spring-idle": FindingRow("{name} has no rate and no damping: give one of them, or remove it"),
        "process-idle": FindingRow("{name} has neither force nor torque: give it one, or remove it"),
        "process-never": FindingRow("{name} never acts: the motion does not reach its positions; change them, or remove it"),
        "spring-winds-up": FindingRow(
            "{name} is wound up by {turns} turns with each turn of the shaft: put it between links that swing", severities=(ERROR,),
        ),
        "torsion-still": FindingRow(
            "the links of {name} do not turn relative to each other, so that it does no work: put it between links that do, or use a "
            "spring between two points"
        ),
        "damper-still": FindingRow(
            "the ends of the damper of {name} do not move relative to each other: attach it elsewhere, or remove it"
        ),
        "contact-jamming": FindingRow(
            "sliding friction of the contact jams the follower: its lever arm is {factor} times that of the cam's force{at}, it must be "
            "below 1: reduce the friction, or enlarge the base radius", _compared("factor", "limit"), severities=(ERROR,),
        ),
        "contact-jamming.endless": FindingRow(
            "sliding friction of the contact jams the follower: the cam's force has no lever arm{at}, so that any friction locks it: "
            "enlarge the base radius", severities=(ERROR,),
        ),
        "dead-centre": FindingRow(
            "rod and arm come close to one line (dead centre): the sine of the angle between them is {value}",
            severities=(WARNING, ERROR),
        ),
        "rod-across-guide": FindingRow(
            "the rod comes close to a right angle with the guide, where the arm cannot drive the slider: the cosine of "
            "that angle is {value}", severities=(WARNING, ERROR),
        ),
        "pad-in-line": FindingRow(
            "the pad's arm comes close to the direction of the valve, which the rocker cannot open there: the sine of the angle "
            "between them is {value}; change the pad's angle"
        ),
        "pushrod-in-line": FindingRow(
            "pushrod and push arm come close to one line (dead centre): the sine of the angle between them is {value}; move the "
            "pivot, or change a length"
        ),
        "crank-cannot-turn": FindingRow(
            "the crank cannot turn fully: the linkage can be assembled only for crank angles within {ranges}, and locks at {joints}",
            severities=(ERROR,),
        ),
        "swinging-driver": FindingRow(
            "the crank cannot turn fully: it swings between {low}° ({low_joint} locks) and {high}° ({high_joint} locks), "
            "as drawn{others}", severities=(NOTE,),
        ),
        "redundant-links": FindingRow(
            "links {links} are constrained by more pairs than necessary; their lengths agree over the full turn, and must agree in the "
            "built machine", severities=(NOTE,),
        ),
        "undetermined-reactions": FindingRow(
            "statics does not determine the forces in {pairs}, since more pairs than necessary constrain the links: these forces are "
            "left out; the driver's torque and the balance of power are valid", severities=(NOTE,),
        ),
        "no-common-period": FindingRow(
            "the linkage does not return to its first position within {most} turns of the driver: the first {shown} shown, the "
            "following turns differ", severities=(NOTE,),
        ),
        "wheels-apart": FindingRow(
            "the wheels of link {link} (pitch circles of {first} and {second} mm) do not touch: their centres are {distance} "
            "mm from each other, which is {gap} mm {how}; change the radii, the module or the centres"
        ),
        "change-point": FindingRow(
            "the links at {joint} become collinear, where both assemblies coincide (change point); the motion continues "
            "smoothly, but in the built machine play decides which assembly follows"
        ),
        "linkage-dead-centre": FindingRow(
            "dead centre: the links at {joint} become collinear, transmission angle {value} deg",
            severities=(ERROR,),
        ),
        "transmission-angle": FindingRow(
            "transmission angle of {joint} {value} deg{at}, limit {limit} deg: change the lengths of the links that meet there",
            _compared("value", "limit"),
        ),
        "unstable-speed": FindingRow(
            "{rpm} rpm is in a forbidden band of speed, {rpm_lo} ... {rpm_hi} rpm (tongue {n}): twist of the shaft grows by up to "
            "{growth_percent} % per turn; change its stiffness or the speed", _compared("rpm", "rpm_lo", "rpm_hi"),
            severities=(WARNING, ERROR),
        ),
        "unstable-shaft": FindingRow(
            "at {rpm} rpm twist of the shaft grows by {growth_percent} % per turn; change its stiffness or the speed",
            severities=(WARNING, ERROR),
        ),
        "near-unstable-speed": FindingRow(
            "{rpm} rpm is near a forbidden band of speed, {rpm_lo} ... {rpm_hi} rpm (tongue {n}), in which twist of the shaft grows "
            "by up to {growth_percent} % per turn", _compared("rpm", "rpm_lo", "rpm_hi"), severities=(NOTE,),
        ),
        "above-all-speeds": FindingRow(
            "{rpm} rpm is above {top_rpm} rpm, and at every speed above that the shaft is unstable", _compared("rpm", "top_rpm"),
            severities=(ERROR,),
        ),
        "no-stability": FindingRow("the stability of the shaft cannot be computed: {why}; {hint}", severities=(NOTE,)),
        "no-elastic-follower": FindingRow("the vibration of the follower cannot be computed: {why}; {hint}"),
        "motor-stalls": FindingRow(
            "the motor stalls: a flywheel of {inertia_kg_m2} kg·m² does not carry the load over its peak{at}, at least "
            "{least_kg_m2:up} kg·m² are needed; a steeper motor slope needs less", remedy=_FLYWHEEL, severities=(ERROR,),
        ),
        "speed-fluctuates": FindingRow(
            "the speed fluctuates by {percent} %, limit {wanted_percent} %: a flywheel of {inertia_kg_m2:up} kg·m² keeps it "
            "within the limit",
            _compared("percent", "wanted_percent"), _FLYWHEEL, severities=(NOTE,),
        ),
        "probe-hollow": FindingRow(
            "the probe ({probe}) does not reach into a hollow of the profile{hollow}{at}: the lift there is that of a probe which "
            "touches at two points{left}", severities=(NOTE,),
        ),
        "probe-overhang": FindingRow(
            "the line of measurement runs along the profile{at}: the profile behind it is hidden from the probe, and the lift jumps",
            severities=(NOTE,),
        ),
        "out-of-tolerance": FindingRow(
            "the measured lift deviates by {deviation_mm} mm{at}, {normal_mm} mm normal to the profile; tolerance {limit_mm} mm",
            _compared("deviation_mm", "normal_mm", "limit_mm"), severities=(ERROR,),
        ),
        "not-measured": FindingRow("no measured rows from {from_deg} to {to_deg} deg: the cam is not assessed there", severities=(NOTE,)),
        "no-drive": FindingRow("no solution, the other drives are computed without this one: {why}{at}; {hint}", severities=(ERROR,)),
        "timing-broken": FindingRow(
            "{second} comes {after_deg} deg after {first}, at machine angle {second_deg} deg; it must come at least {least_deg} deg "
            "after it: change the phase or the motion of one of the two drives", _compared("after_deg", "least_deg"), _PHASES,
            severities=(ERROR,),
        ),
        "timing-contradicts": FindingRow(
            "in the current order of their events no phases satisfy {rows} together: they require {excess_deg} deg more than "
            "a turn has; reduce one of their distances, lengthen a dwell between their events, or turn one drive past the other",
            severities=(ERROR,),
        ),
        "clearance": FindingRow(
            "{first} and {second} come within {value_mm} mm of each other{at}; they must keep {least_mm} mm: {hint}",
            _compared("value_mm", "least_mm"),
        ),
        "collision": FindingRow(
            "{first} and {second} meet{at}, in all over {over_deg} deg of the turn: {hint}", severities=(ERROR,)
        ),
        "no-load": FindingRow("no masses and no forces are given: all forces and the torque are zero", remedy=_MASSES, severities=(NOTE,)),
    }
)  # fmt: skip
"""Code, or code.variant -> row."""


LEAST_BOUND = 1e-12
"""Promised accuracy of every channel, relative to its size: the least bound of a residual."""


@frozen
class Residual:
    """One line of the certificate: a figure that is zero in exact arithmetic, relative to the size of its channel.

    Attributes
    ----------
    value : the residual
    derived : bound of its rounding error
    left_out : number of cases that the residual does not cover
    cases : number and kind of all cases, ``1984 triples``
    remark : what limits the proof, ``local``
    """

    value: float
    derived: float
    left_out: int = 0
    cases: str = ""
    remark: str = ""

    @property
    def bound(self) -> float:
        """The larger of the derived bound and the promised accuracy."""
        return max(self.derived, LEAST_BOUND)

    @property
    def kept(self) -> bool:
        """Whether the residual is within its bound."""
        return self.value <= self.bound

    @property
    def note(self) -> str:
        """The number of cases left out, in words, or the remark."""
        return f"{self.left_out} of {self.cases} left out" if self.left_out else self.remark
