"""Findings: limits that a design exceeds. The sentence comes from a table, so that it can be translated."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

from core.frozen import frozen

ERROR, WARNING, NOTE = "error", "warning", "note"


@frozen
class Finding:
    """One limit reached.

    code           key of ``ROWS``
    severity       ``error`` (the machine will not work so), ``warning`` or ``note``
    field          path of the input that mends it
    cam_angle_deg  where it is worst, None where it holds for the whole cycle
    values         numbers of the sentence, in the units the sentence states
    """

    code: str
    severity: str
    field: str
    cam_angle_deg: float | None
    values: Mapping[str, float | str] = dataclasses.field(default_factory=lambda: MappingProxyType({}))

    @property
    def message(self) -> str:
        """The sentence. Figures that it compares have as many digits as tell them apart."""
        return self.with_digits(0)

    def with_digits(self, least: int) -> str:
        """The sentence, with so many digits at least of the figures that it compares, and of the cam angle."""
        digits, names = self._row.compared
        texts = dict(
            zip(names, apart([float(self.values.get(name, 1.0)) for name in names], max(digits, least)), strict=True)
        )
        return self._row.sentence.format(
            **{"face": "roller", **self.values, **texts}, at=self._at(max(ANGLE_DIGITS, least))
        )

    @property
    def remedy(self) -> Remedy:
        """What is offered to mend it, if the design has it: see ``core.find.remedy_of``."""
        return self._row.remedy

    @property
    def _row(self) -> Row:
        """Some codes have another one for some faces or flanks, where there is play, or where a factor is infinite; those of own limits
        of quantities share one."""
        factor = self.values.get("factor")
        variant = (
            "play" if "play_mm" in self.values else "endless" if factor == math.inf else self.values.get("face", "")
        )
        variants = (f"{self.code}.{each}" for each in (variant, self.values.get("flank", "")))
        return ROWS.get(next((each for each in variants if each in ROWS), self.code), OWN_LIMIT)

    def _at(self, digits: int) -> str:
        """The cam angle inside of a sentence."""
        angle = self.cam_angle_deg
        return "" if angle is None or not math.isfinite(angle) else f" at {angle:.{digits}g} deg"

    @property
    def says_angle(self) -> bool:
        """The sentence holds the cam angle."""
        return "{at}" in self._row.sentence


ANGLE_DIGITS = 5
MOST_DIGITS = 17  # of a double


def apart(numbers: Sequence[float], digits: int) -> list[str]:
    """Numbers as texts of so many digits, or of as many more as it takes that different numbers have different texts."""
    while True:
        texts = [f"{number:.{digits}g}" for number in numbers]
        if digits >= MOST_DIGITS or len(set(texts)) == len(set(numbers)):
            return texts
        digits += 1


class ComparedDigits(NamedTuple):
    """The least digits of the figures that a sentence compares, and their names; a limit that is none of its values is 1."""

    digits: int = 0
    names: tuple[str, ...] = ()


def _compared(digits: int, *names: str) -> ComparedDigits:
    return ComparedDigits(digits, names)


class Remedy(NamedTuple):
    """What a reader is offered beside a finding.

    label   of its button; {name}: the name of the field
    find    search that gives the answer, where the design has it, and ``of`` is the finding's field, or none
    field   where it leads, else to the finding's own field
    masses  give the links masses
    """

    label: str = "{name}"
    find: str = ""
    of: str = ""
    field: str = ""
    masses: bool = False


_BASE_RADIUS = Remedy("Find base radius", "base-radius")
_LARGER = _BASE_RADIUS._replace(of="cam.base_radius_mm")
_FACE_WIDTH, _SPRING, _PRELOAD, _FLYWHEEL, _PHASES = (
    Remedy(f"Find {what.replace('-', ' ')}", what) for what in ("face-width", "spring", "preload", "flywheel", "phases")
)
_THICKNESS = Remedy(field="cam.thickness_mm")
_ADD, _MASSES = Remedy("Add {name}"), Remedy("Add masses", masses=True)


class Row(NamedTuple):
    """What is said of a code: sentence, with its values in braces; figures that it compares; what is offered to mend it."""

    sentence: str
    compared: ComparedDigits = ComparedDigits()
    remedy: Remedy = Remedy()


OWN_LIMIT = Row("{what} {value} {unit}{at}, your own limit {limit} {unit}: {remedy}", _compared(5, "value", "limit"))
"""Of every limit of quantities that a user states: codes without a row."""
ROWS: Mapping[str, Row] = MappingProxyType(
    {
        "jump-displacement": Row("displacement jumps by {jump:.6g} {unit_name} at a join: no cam can do that"),
        "jump-velocity": Row("velocity jumps by {jump:.6g} {unit_name}/rad at a join: infinite acceleration"),
        "jump-acceleration": Row("acceleration jumps by {jump:.6g} {unit_name}/rad² at a join: infinite jerk"),
        "uneven-advance": Row(
            "an advance of {advance:.9g} deg a turn is no whole part of 360 deg, nor whole turns: what turns does not come to the same "
            "stops again; {near:.9g} deg is the next that does"
        ),
        "pressure-angle": Row(
            "pressure angle {value} deg{at}, limit {limit} deg: enlarge the base radius, or lengthen the rise",
            _compared(4, "value", "limit"), _LARGER,
        ),
        "pressure-angle.flat": Row(
            "pressure angle {value} deg{at}, limit {limit} deg: lessen the {what} of the face", _compared(4, "value", "limit"),
        ),
        "roller-pressure-angle": Row(
            "pressure angle {value} deg{at}, limit {limit} deg: carry the roller at another point, or move the cam's centre",
            _compared(4, "value", "limit"),
        ),
        "undercut": Row(
            "undercut: the pitch curve's smallest radius {pitch_radius_mm} mm{at}, the roller's {roller_radius_mm} mm: enlarge the base "
            "radius, or take a smaller roller", _compared(5, "pitch_radius_mm", "roller_radius_mm"), _BASE_RADIUS,
        ),
        "undercut.shoe": Row(
            "undercut: the pitch curve's smallest radius {pitch_radius_mm} mm{at}, the shoe's {shoe_radius_mm} mm: enlarge the base "
            "radius, or take a shoe of smaller radius", _compared(5, "pitch_radius_mm", "shoe_radius_mm"), _BASE_RADIUS,
        ),
        "undercut.flat": Row(
            "undercut: under the flat face the profile's radius of curvature comes down to {radius_mm:.5g} mm{at}, it must stay above 0: "
            "{remedy}", remedy=_BASE_RADIUS,
        ),
        "outer-undercut": Row(
            "undercut of the groove's outer flank: the pitch curve's smallest hollow radius {pitch_radius_mm} mm{at}, roller and play "
            "{roller_radius_mm} mm: take a smaller roller, or enlarge the base radius",
            _compared(5, "pitch_radius_mm", "roller_radius_mm"), _LARGER,
        ),
        "groove-flanks-meet": Row(
            "two stretches of the groove run into each other{at} and at {other_deg:.5g} deg: {overlap_mm:.5g} mm too near; take a smaller "
            "roller, or enlarge the base radius"
        ),
        "second-undercut": Row(
            "undercut of the second cam: its pitch curve's smallest radius {pitch_radius_mm} mm{at}, the second roller's "
            "{roller_radius_mm} mm: put the second roller farther out, or take a smaller one",
            _compared(5, "pitch_radius_mm", "roller_radius_mm"),
        ),
        "second-pressure-angle": Row(
            "pressure angle of the second roller {value} deg{at}, limit {limit} deg: {remedy}", _compared(4, "value", "limit"),
        ),
        "second-roller-meets-hub": Row(
            "the second roller meets the {what} of the first cam{at}: it comes as near as {distance_mm} mm to the cam centre, the {what} "
            "has a radius of {radius_mm} mm: put the roller farther out, or take a smaller one", _compared(5, "distance_mm", "radius_mm"),
        ),
        "second-roller-pushes-along": Row(
            "the second roller pushes the follower the same way as the first{at}, so the pair does not hold it: put the second roller on "
            "the other side of the cam centre"
        ),
        "flank-change": Row("the contact changes to the {to}{at}"),
        "flank-change.play": Row(
            "the contact changes to the {to}{at}: over a play of {play_mm:.5g} mm it strikes with {impact_m_s:.3g} m/s"
        ),
        "face-too-narrow": Row(
            "the contact leaves the flat face{at}: it runs to {contact_mm:.6g} mm, {needed_mm} mm from the face's centre, its half width "
            "is {half_width_mm} mm: widen the face, or move its centre", _compared(5, "needed_mm", "half_width_mm"), _FACE_WIDTH,
        ),
        "pressure-angle-rise": Row(
            "pressure angle {value} deg on the rise{at}, your own limit {limit} deg: {remedy}", _compared(4, "value", "limit"), _LARGER,
        ),
        "pressure-angle-return": Row(
            "pressure angle {value} deg on the return{at}, your own limit {limit} deg: {remedy}", _compared(4, "value", "limit"), _LARGER,
        ),
        "pressure-angle-rise.second": Row(
            "pressure angle of the second roller {value} deg on the rise{at}, your own limit {limit} deg: {remedy}",
            _compared(4, "value", "limit"),
        ),
        "pressure-angle-return.second": Row(
            "pressure angle of the second roller {value} deg on the return{at}, your own limit {limit} deg: {remedy}",
            _compared(4, "value", "limit"),
        ),
        "convex-radius": Row(
            "the profile's smallest convex radius is {value} mm{at}, {whose} {limit} mm{why}: make the cam larger, or its motion gentler",
            _compared(5, "value", "limit"), _LARGER,
        ),
        "polar-radius": Row(
            "the profile comes as near as {value} mm to the cam centre{at}, {whose} {limit} mm{why}: make the cam larger, or state bore "
            "and hub as they are", _compared(5, "value", "limit"), _LARGER,
        ),
        "concave-radius": Row(
            "the profile's smallest concave radius is {value} mm{at}, {whose} {limit} mm{why}: make the cam larger, or its motion "
            "gentler", _compared(5, "value", "limit"), _LARGER,
        ),
        "contact-pressure": Row(
            "contact pressure {value} MPa{at}, your own limit {limit} MPa: widen the cam, enlarge roller or base radius, or lower the "
            "force", _compared(5, "value", "limit"), _THICKNESS,
        ),
        "material-pressure": Row(
            "contact pressure {value} MPa{at}, the {what}'s {material} bears {limit} MPa ({source}): widen the cam, enlarge roller or "
            "base radius, or lower the force", _compared(5, "value", "limit"), _THICKNESS,
        ),
        "no-contact-pressure": Row("no contact pressure: give {missing}", remedy=_ADD),
        "no-contact-pressure-edge": Row(
            "no contact pressure: a {face} touches in a line without width, for which Hertz's equations do not hold; take a roller or a "
            "shoe"
        ),
        "no-contact-pressure-undercut": Row("no contact pressure: the profile is undercut, the {face} does not fit it"),
        "profile-meets-hub": Row(
            "the profile comes as near as {radius_mm} mm to the cam centre{at}, the {what} has a radius of {limit_mm} mm: make the cam "
            "larger, or the {what} smaller", _compared(5, "radius_mm", "limit_mm"), _BASE_RADIUS,
        ),
        "profile-meets-keyway": Row(
            "the profile cuts {overlap_mm:.4g} mm into the keyway{at}: turn the keyway, make it shallower, or make the cam larger",
            remedy=_BASE_RADIUS,
        ),
        "cutter-too-large": Row(
            "the cutter's radius of {cutter_mm} mm does not go into the hollow of the profile, of {radius_mm} mm{at}: take a cutter no "
            "larger than that", _compared(5, "cutter_mm", "radius_mm"),
        ),
        "cutter-wider-than-groove": Row(
            "the cutter's radius of {cutter_mm} mm is more than half the width of the groove, {radius_mm} mm: take a cutter no larger "
            "than that", _compared(5, "cutter_mm", "radius_mm"),
        ),
        "self-intersection": Row(
            "the {which} crosses itself: it passes the same place{at} and at {other_deg:.5g} deg; make the cam larger, the roller smaller "
            "or the motion gentler", remedy=_LARGER,
        ),
        "servo-peak": Row(
            "the servo's motor must give {value} {unit}{at}, its peak is {limit}: take a larger motor, another gear ratio, or a "
            "gentler motion", _compared(5, "value", "limit"),
        ),
        "servo-rms": Row(
            "the servo's motor gives {value} {unit} as rms over the turn, rated {limit}: take a larger motor, another gear ratio, "
            "or a lower speed", _compared(5, "value", "limit"),
        ),
        "servo-speed": Row(
            "the servo's motor runs at {value} {unit}{at}, rated {limit}: take a smaller gear ratio, or a lower speed",
            _compared(5, "value", "limit"),
        ),
        "separation": Row(
            "the {face} leaves the cam: contact force {force_n:.5g} N; it does so from {speed_rpm:.6g} rpm on: add closing force or lower "
            "the speed", remedy=_SPRING,
        ),
        "elastic-separation": Row(
            "the {face} of the elastic follower leaves the cam{at}: contact force {force_n:.5g} N in steady running, though a rigid one "
            "would stay: add closing force, stiffness or damping, lower the speed, or take a gentler motion", remedy=_SPRING,
        ),
        "contact-force-low": Row(
            "contact force {value} N{at}, it must stay at {limit} N at least: enlarge the spring's preload or rate, or lower the speed",
            _compared(5, "value", "limit"), _PRELOAD,
        ),
        "jamming": Row(
            "friction jams the guide: friction times the slope of what pushes is {factor}, must stay below 1; lower it, or the pressure "
            "angle", _compared(4, "factor", "limit"),
        ),
        "jamming.endless": Row(
            "friction jams the guide: what pushes stands across it, so that any friction holds it; lower the pressure angle"
        ),
        "pair-jamming": Row(
            "friction jams the mechanism{at}, most of all at {pair}: the factor by which friction feeds on itself is {factor}, must stay "
            "below 1: lower its coefficient, take a thinner pin, or a longer slide", _compared(4, "factor", "limit"),
        ),
        "spring-ends-meet": Row(
            "the ends of {name} meet{at}, where its force has no direction: attach it elsewhere, or give it a free length of 0 and no "
            "damper"
        ),
        "spring-no-length": Row(
            "both ends of {name} stand in one place all over the turn: it pulls at nothing; attach one of them elsewhere"
        ),
        "spring-idle": Row("{name} has no rate and no damping: give one of them, or take it away"),
        "process-idle": Row("{name} has neither force nor torque: give it one, or take it away"),
        "process-never": Row("{name} never works: the motion does not come to its positions; change them, or take it away"),
        "spring-winds-up": Row("{name} is wound up by {turns:.0f} turns with each turn of the shaft: put it between links that swing"),
        "torsion-still": Row(
            "the links of {name} do not turn against each other, so that it moves nothing: put it between links that turn, or take a "
            "spring between two points"
        ),
        "damper-still": Row("nothing moves at the damper of {name}: attach it elsewhere, or take it away"),
        "contact-jamming": Row(
            "sliding friction of the contact jams the follower: it takes {factor} of the lever that the cam's force has{at}, must stay "
            "below 1; lower it, or enlarge the base radius", _compared(4, "factor", "limit"),
        ),
        "contact-jamming.endless": Row(
            "sliding friction of the contact jams the follower: the cam's force has no lever{at}, so that any friction holds it; enlarge "
            "the base radius"
        ),
        "dead-centre": Row("rod and arm come close to one line (dead centre): sine of the angle between them {value:.3g}"),
        "rod-across-guide": Row(
            "the rod comes close to standing across the guide, where the arm cannot drive the slider: cosine of its angle {value:.3g}"
        ),
        "crank-cannot-turn": Row(
            "the crank cannot turn fully: the linkage can be assembled with it within {ranges} only, and locks at {joints}"
        ),
        "swinging-driver": Row(
            "the crank cannot turn fully: it goes to and fro between {low:.6g}° ({low_joint} locks) and {high:.6g}° ({high_joint} locks), "
            "where it is drawn{others}"
        ),
        "redundant-links": Row(
            "links {links} are held by more pairs than need be; their lengths agree all through the turn, as they will be made they must"
        ),
        "undetermined-reactions": Row(
            "statics does not fix the forces in {pairs}, since more pairs hold the links than need be: they are left out; the driver's "
            "torque and the balance of power hold"
        ),
        "no-common-period": Row(
            "the linkage does not return to its first position within {most} turns of the driver: the first {shown} shown, and the next "
            "differs from it"
        ),
        "wheels-apart": Row(
            "the wheels of link {link} (pitch circles of {first:.6g} and {second:.6g} mm) do not touch: their centres are {distance:.6g} "
            "mm from each other, which is {gap:.3g} mm {how}; change the radii, the module or the centres"
        ),
        "change-point": Row(
            "the links at {joint} come to lie in one line, where both ways to assemble them meet (change point); the motion goes on "
            "smoothly, but play decides"
        ),
        "linkage-dead-centre": Row("dead centre: the links at {joint} come to lie in one line, transmission angle {value:.3g} deg"),
        "transmission-angle": Row(
            "transmission angle of {joint} {value} deg{at}, limit {limit} deg: change the lengths of the links that meet there",
            _compared(4, "value", "limit"),
        ),
        "unstable-speed": Row(
            "{rpm} rpm lies in a forbidden band of speed, {rpm_lo} ... {rpm_hi} rpm (tongue {n:.0f}): twist of the shaft grows by up to "
            "{growth_percent:.3g} % a turn; change its stiffness or the speed", _compared(6, "rpm", "rpm_lo", "rpm_hi"),
        ),
        "unstable-shaft": Row(
            "at {rpm:.6g} rpm twist of the shaft grows by {growth_percent:.3g} % a turn; change its stiffness or the speed"
        ),
        "near-unstable-speed": Row(
            "{rpm} rpm is near a forbidden band of speed, {rpm_lo} ... {rpm_hi} rpm (tongue {n:.0f}), in which twist of the shaft grows "
            "by up to {growth_percent:.3g} % a turn", _compared(6, "rpm", "rpm_lo", "rpm_hi"),
        ),
        "above-all-speeds": Row(
            "{rpm} rpm is above {top_rpm} rpm, from where on the shaft does not hold the cam", _compared(6, "rpm", "top_rpm"),
        ),
        "no-stability": Row("no word on the stability of the shaft: {why}; {hint}"),
        "no-elastic-follower": Row("no word on the vibration of the follower: {why}; {hint}"),
        "motor-stalls": Row(
            "the motor stalls: a flywheel of {inertia_kg_m2:.6g} kg·m² does not carry the load over its peak{at}, {least_kg_m2:.3g} kg·m² "
            "and more do; a steeper motor slope needs less", remedy=_FLYWHEEL,
        ),
        "speed-fluctuates": Row(
            "the speed fluctuates by {percent} %, wanted {wanted_percent} %: a flywheel of {inertia_kg_m2:.6g} kg·m² keeps it so even",
            _compared(6, "percent", "wanted_percent"), _FLYWHEEL,
        ),
        "probe-hollow": Row(
            "the probe ({probe}) does not reach into a hollow of the profile{hollow}{at}: the lift there is that of a probe which touches "
            "at two places{left}"
        ),
        "probe-overhang": Row(
            "the line of measurement runs along the profile{at}: what lies behind is hidden from the probe, and the lift jumps"
        ),
        "out-of-tolerance": Row(
            "the measured lift is {deviation_mm} mm off{at}, {normal_mm} mm normal to the profile; tolerance {limit_mm} mm",
            _compared(4, "deviation_mm", "normal_mm", "limit_mm"),
        ),
        "not-measured": Row("no measured rows from {from_deg:.6g} to {to_deg:.6g} deg: nothing is said of the cam there"),
        "no-drive": Row("no answer, and the other drives go on without it: {why}{at}; {hint}"),
        "timing-broken": Row(
            "{second} comes {after_deg} deg after {first}, at machine angle {second_deg:.6g} deg; it must come {least_deg} deg after it "
            "at least: turn one of the two drives, or change its motion", _compared(5, "after_deg", "least_deg"), _PHASES,
        ),
        "timing-contradicts": Row(
            "in the order in which their events come now no phases keep {rows} together: they ask for {excess_deg:.5g} deg more than "
            "there is; lessen one of their distances, lengthen a dwell between their events, or turn one drive past the other"
        ),
        "no-load": Row("no masses and no forces are given: all forces and the torque are zero", remedy=_MASSES),
    }
)  # fmt: skip
"""By code, or code and variant: see ``Finding``."""


LEAST_BOUND = 1e-12
"""Accuracy that every channel promises, relative to its size: a residual within it is kept whatever rounding would allow."""


@frozen
class Residual:
    """One line of the certificate: a figure that exact arithmetic would make zero, relative to the size of its channel.

    derived   what rounding may make of it
    left_out  how many of the cases it says nothing of, and of which ones: ``cases`` is ``1984 triples``
    """

    value: float
    derived: float
    left_out: int = 0
    cases: str = ""

    @property
    def bound(self) -> float:
        """What it must keep: the larger of the derived bound and the promised accuracy."""
        return max(self.derived, LEAST_BOUND)

    @property
    def kept(self) -> bool:
        """Whether the residual is within its bound."""
        return self.value <= self.bound

    @property
    def note(self) -> str:
        """What was left out, in words."""
        return f"{self.left_out} of {self.cases} left out" if self.left_out else ""
