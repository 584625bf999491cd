"""A measured table of lift against what the same probe measures on the exact profile."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from core.cam import INNER, OUTER, faces_of
from core.design import Design
from core.errors import KindynaError, NoCam, angle_ranges
from core.findings import ERROR, NOTE, Finding
from core.frozen import frozen
from core.measured import ColumnChoice, RowFault, TableError, layout, read_sheet, read_table
from core.measured.table import MeasuredTable as Measured
from core.measured.table import gaps
from core.measured.units import ANGLE_UNITS, TIME_UNITS, meaning
from core.motion import TURN, Angles
from core.motion.extremes import Extreme, find_extremes, piecewise_angles
from core.numerics.derivatives import cross, dot
from core.numerics.lazy import checkpoint
from core.output.export import SUMMARY, csv
from core.output.files.made import exact_curve
from core.output.files.probe import PROBES, InspectionRequest, ProbeKind, Readings, Stretches, readings, stretches
from core.output.files.profile_curve import Exact, ProfileCurve, hollow, side
from core.output.files.profile_files import SENSES
from core.output.files.profile_request import ProfileRequest as Profile
from core.output.summary import to_json
from core.project.files import require_own_json, write_into
from core.requests import require_in_range
from core.study import Study

# -- the lift that a probe measures on the exact profile over the cam angle, with the band that a ---------------


USUAL_DEG = 90.0  # where the follower has no direction
LITTLE = 1e-6  # mm that nobody measures
FLAT = 1e-9  # of the curvature of the base circle: what bends less is straight


@frozen(eq=False)
class LiftTable:
    """Lift over the cam angle.

    degrees       (n,) cam angle
    lift          (n,) [mm] of the exact profile, above the base
    lower, upper  (n,) [mm] of a profile that is off by the tolerance either way
    slope         (n,) [mm/rad] of the lift by the cam angle
    cosine        (n,) of the angle between the profile's normal and the line of measurement
    place         (n,) complex [mm] where the profile is touched, in the cam's own frame
    normal        (n,) complex unit vector there, away from the cam
    """

    degrees: np.ndarray
    lift: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    slope: np.ndarray
    cosine: np.ndarray
    place: np.ndarray
    normal: np.ndarray


@frozen(eq=False)
class Probing:
    """A probe set to a cam.

    kind       row of ``PROBES``
    radius     [mm] of a round probe, 0 of others
    direction  [rad] of the line of measurement, from the cam centre
    exact      the profile, and on which side of it the probe runs (+1 left of its tangent)
    outward    +1 where that is away from the cam centre, -1 on the outer flank of a groove
    """

    study: Study
    request: InspectionRequest
    kind: ProbeKind
    radius: float
    direction: float
    exact: Exact
    side: float
    outward: float

    # -- what is fixed for all angles --------------------------------------------------------------------------

    @cached_property
    def curve(self) -> ProfileCurve:
        """The profile with its arc length."""
        return ProfileCurve(self.exact, self.study.program.starts, self.study.program.ends)

    @cached_property
    def least_radius(self) -> Extreme:
        """Of the profile, its distance from the cam centre [mm]."""
        return find_extremes(lambda angles: {"": np.abs(self.exact(angles).z)}, self.study.program)[""].low

    @property
    def base(self) -> float:
        """Distance of the probe's centre or face from the cam centre [mm] at which the lift is 0."""
        return self.least_radius.value + self.outward * self.radius

    @cached_property
    def bends(self) -> tuple[Extreme, Extreme]:
        """The profile's most convex and most hollow curvature [1/mm], hollow being positive."""
        found = find_extremes(lambda angles: {"": self.side * self.exact(angles).curvature}, self.study.program)[""]
        return found.low, found.high

    @cached_property
    def _parts(self) -> dict[float, Stretches]:
        return {}

    # -- measuring ---------------------------------------------------------------------------------------------

    def readings(self, theta: np.ndarray, beside: float = 0.0) -> Readings:
        """What the probe measures at cam angles (n,) [rad] on the profile moved ``beside`` [mm] towards it.

        Raises NoCam where the line of measurement does not meet the cam.
        """
        guide = self.kind.guide(self.exact, self.side, self.radius + beside)
        if beside not in self._parts:
            self._parts[beside] = stretches(guide, self.study.program)
        directions = self.direction - self.study.sense * theta
        made = readings(self.kind, guide, self.exact, self._parts[beside], directions, self.outward)
        missed = ~np.isfinite(made.distance)
        if missed.any():
            raise NoCam(
                "the probe's line does not meet the profile",
                "cam.base_radius_mm",
                "enlarge the base radius, so that the cam centre lies inside the cam",
                angle_ranges(theta, missed),
            )
        return made

    def lift(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Lift [mm] and its derivative by the cam angle [mm/rad] (n,) at any cam angles (n,) [rad]."""
        made = self.readings(theta)
        return made.distance - self.base, -self.study.sense * made.slope

    def table(self, degrees: np.ndarray) -> LiftTable:
        """Everything at cam angles (n,) [deg]."""
        theta = np.deg2rad(degrees)
        made, band = self.readings(theta), self.request.tolerance_mm
        lower, upper = (
            made.distance if not band else self.readings(theta, sign * self.outward * band).distance
            for sign in (-1.0, 1.0)
        )
        normal = self.side * 1j * made.contact.tangent
        cosine = self.outward * dot(normal, np.exp(1j * (self.direction - self.study.sense * theta)))
        return LiftTable(
            degrees,
            made.distance - self.base,
            lower - self.base,
            upper - self.base,
            -self.study.sense * made.slope,
            cosine,
            made.contact.z,
            normal,
        )

    # -- what it does not measure --------------------------------------------------------------------------------

    def _angle(self, direction: complex) -> float:
        """Cam angle [deg] at which a direction of the cam's own frame comes to the line of measurement."""
        angle = self.study.sense * (self.direction - np.angle(direction))
        return float(np.mod(np.rad2deg(angle), 360.0)) % 360.0

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """Where the probe does not reach, at its cam angles: notes, for what it measures is right all the same."""
        found = (self._bridged(),) if self.kind.flat else (self._hollow(), self._overhang())
        return tuple(each for each in found if each is not None)

    def _hollow(self) -> Finding | None:
        """A round probe that is too large for a hollow; a point, and one no larger than the follower, reaches everywhere."""
        if self.radius <= own_probe(self.study.design, self.request.flank)[1]:
            return None
        found = hollow(self.curve, self.exact, self.study.program, self.side, self.radius)
        if found is None:
            return None
        there = self.exact(self.study.program.angles(np.deg2rad([found.begin])))
        centre = complex(there.z[0] + self.side * self.radius * 1j * there.tangent[0])
        left = f", which leaves {found.left:.3g} mm between them" if found.left > LITTLE else ""
        return self._not_reached(centre, found.radius, left)

    def _bridged(self) -> Finding | None:
        """A flat face over any hollow."""
        sharpest = self.bends[1]
        if sharpest.value <= FLAT / self.least_radius.value:
            return None
        there = self.exact(self.study.program.angles(np.array([sharpest.theta])))
        return self._not_reached(complex(self.side * 1j * there.tangent[0]), 1.0 / sharpest.value, "")

    def _not_reached(self, direction: complex, radius: float, left: str) -> Finding:
        least = f", of radius {radius:.5g} mm," if np.isfinite(radius) else " between two parts of it"
        probe = self.kind.label + (f", radius {self.radius:.6g} mm" if self.kind.radius else "")
        values: dict[str, float | str] = {"probe": probe, "hollow": least, "left": left, "radius_mm": radius}
        return Finding("probe-hollow", NOTE, "inspection.radius_mm", self._angle(direction), values)

    def _overhang(self) -> Finding | None:
        """Where the path of a round probe's centre turns back over itself."""

        def facing(angles: Angles) -> np.ndarray:
            there = self.exact(angles)
            normal = self.side * 1j * there.tangent
            place = there.z + self.radius * normal
            return np.asarray(self.outward * dot(normal, place) / np.abs(place))

        lowest = find_extremes(lambda angles: {"": facing(angles)}, self.study.program)[""].low
        if lowest.value > 0.0:
            return None
        there = self.exact(self.study.program.angles(np.array([lowest.theta])))
        centre = complex(there.z[0] + self.side * self.radius * 1j * there.tangent[0])
        return Finding("probe-overhang", NOTE, "inspection.radius_mm", self._angle(centre), {})


@frozen(eq=False)
class Inspection:
    """The table of a probe over one turn."""

    probing: Probing
    table: LiftTable


def probing(study: Study, request: InspectionRequest) -> Probing:
    """A probe set to the study's cam.

    Raises NoSuchStage, NoCam as ``core.output.files.files.job_of`` does, and KindynaError for a probe, radius or tolerance that cannot
    be.
    """
    flank = Profile(request.flank, samples=request.samples, fit="polyline")
    exact = exact_curve(study, flank)
    usual, own = own_probe(study.design, request.flank)
    name = request.probe or usual
    if name not in PROBES:
        raise KindynaError(f"probe {name!r}: none of that name; allowed: {', '.join(PROBES)}")
    kind = PROBES[name]
    require_in_range(request)
    radius = _radius(request, kind, own)
    on = side(study, study_flank(study, request.flank))
    direction = np.deg2rad(own_direction(study.design) if request.direction_deg is None else request.direction_deg)
    z = exact(piecewise_angles(study.program)).z
    area = float(cross(z, np.roll(z, -1)).sum())
    made = Probing(study, request, kind, radius, float(direction), exact, on, -float(np.sign(area)) * on)
    _require_room(made)
    _require_tolerance(made)
    return made


def own_probe(design: Design, flank: str) -> tuple[str, float]:
    """The row of ``PROBES`` that touches a flank as the cam's own follower does, and its radius [mm]; of an outer flank with play
    the roller that is there, which is smaller than the one that the flank is made for."""
    face = faces_of(design.drive.face, design.drive.cam)[INNER if flank == OUTER else flank]
    alike = (slug for slug, kind in PROBES.items() if (kind.flat, kind.radius) == (face.straight, face.radius_mm > 0.0))
    return next(alike), face.radius_mm


def study_flank(study: Study, name: str) -> int:
    """Its place among the flanks of the cam."""
    return [each.name for each in study.at(Angles(np.zeros(1), np.zeros(1, dtype=int))).cam.flanks].index(name)


def own_direction(design: Design) -> float:
    """Where the follower stands, seen from the cam centre [deg], where it has a direction; else 90."""
    return float(getattr(design.drive.mechanism, "direction_deg", USUAL_DEG))


def _radius(request: InspectionRequest, kind: ProbeKind, own: float) -> float:
    given = request.radius_mm
    if not kind.radius:
        if given:
            raise KindynaError(f"radius {given:g} mm: a {kind.label} has none; leave it out, or take a roller")
        return 0.0
    radius = own if given is None else given
    if not (np.isfinite(radius) and radius > 0.0):
        said = "a roller of what radius? the cam's own follower has none" if given is None else f"radius {given:g} mm"
        raise KindynaError(f"{said}; allowed: above 0 (a point has none)")
    return radius


def _require_room(made: Probing) -> None:
    """Inside a groove there is room for the probe."""
    if made.outward > 0.0:
        return
    if made.kind.flat:
        raise KindynaError("probe flat: it does not get at a flank that surrounds it; take a roller or a point")
    faces = faces_of(made.study.design.drive.face, made.study.design.drive.cam)
    room = 0.5 * sum(face.radius_mm for face in faces.values()) if OUTER in faces else np.inf
    if made.radius > room:
        raise KindynaError(
            f"radius {made.radius:g} mm: the probe does not go into the groove; allowed: at most {room:.9g} mm"
        )


def _require_tolerance(made: Probing) -> None:
    """A profile that is off by so much is still a profile."""
    band = made.request.tolerance_mm
    if not (np.isfinite(band) and band >= 0.0):
        raise KindynaError(f"tolerance {band:g} mm: allowed: 0 or more")
    convex = -made.bends[0].value
    most = min(made.least_radius.value, 1.0 / convex if convex > 0.0 else np.inf)
    if band >= most:
        raise KindynaError(
            f"tolerance {band:g} mm: as large as the profile's least convex radius or its distance from the cam centre; "
            f"allowed: below {most:.5g} mm"
        )


def inspection(study: Study, request: InspectionRequest) -> Inspection:
    """The table at equally spaced cam angles; raises as ``probing`` does."""
    made = probing(study, request)
    return Inspection(made, made.table(360.0 * np.arange(request.samples) / request.samples))


# -- A measured table of lift against what the same probe measures on the exact profile -------------------------


TRIES = 720  # zero marks that are tried before the best is refined
MOST_ROWS = 2_000  # of the table, by which they are tried
STEPS, HALVINGS = 60, 40  # of Gauss and Newton's method
LEAST_FITTED = 4  # rows by which two unknowns are fitted
DIGITS = 1e-9  # mm: a row so much beyond the band lies on it


@frozen(eq=False)
class ProfileComparison:
    """Measured rows (n,) beside the exact profile.

    name          of the file; ``lines`` (n,) of it, in the order of the rows
    table         what the probe measures on the exact profile at the rows' cam angles
    measured      (n,) [mm] lift, the fitted offset taken off
    angle_offset  [deg]: cam angle = angle of the row + this; lift_offset [mm]: measured lift = lift of the row - this; both 0
                  where they were not fitted
    fitted        whether they were, by least squares
    notes         how the file was read
    gaps          stretches (from, to) [deg] without a row
    """

    probing: Probing
    name: str
    lines: np.ndarray
    table: LiftTable
    measured: np.ndarray
    angle_offset: float
    lift_offset: float
    fitted: bool
    notes: tuple[str, ...]
    gaps: tuple[tuple[float, float], ...]

    @property
    def deviation(self) -> np.ndarray:
        """Measured lift less that of the exact profile (n,) [mm]."""
        return self.measured - self.table.lift

    @property
    def normal(self) -> np.ndarray:
        """The same normal to the profile (n,) [mm], positive where the cam stands proud (on a groove's outer flank: lies back)."""
        return self.deviation * self.table.cosine

    @property
    def worst(self) -> int:
        """The row with the largest deviation normal to the profile."""
        return int(np.argmax(np.abs(self.normal)))

    @property
    def most(self) -> int:
        """The row with the largest deviation of lift: where the pressure angle is large it is another one."""
        return int(np.argmax(np.abs(self.deviation)))

    @property
    def out(self) -> np.ndarray:
        """(n,) whether the row lies outside of the band."""
        return (self.measured < self.table.lower - DIGITS) | (self.measured > self.table.upper + DIGITS)

    @property
    def in_tolerance(self) -> bool:
        """Whether every row is within the tolerance."""
        return not self.out.any()

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What stands against the cam, and what was not measured."""
        found = list(self.probing.findings)
        if not self.in_tolerance:
            row = int(np.argmax(np.where(self.out, np.abs(self.normal), -1.0)))
            values = {
                "deviation_mm": float(self.deviation[row]), "normal_mm": float(self.normal[row]),
                "limit_mm": self.probing.request.tolerance_mm,
            }  # fmt: skip
            found.append(
                Finding("out-of-tolerance", ERROR, "inspection.tolerance_mm", float(self.table.degrees[row]), values)
            )
        for begin, end in self.gaps:
            found.append(Finding("not-measured", NOTE, "inspection.measured", None, {"from_deg": begin, "to_deg": end}))
        return tuple(found)


def measured_lift(data: bytes, name: str) -> Measured:
    """The lift in a file's bytes: cam angles in degrees unless its header says otherwise, lengths in the unit that it says.

    Raises TableError where a row is wrong, where the values are no lengths, or the angles no angles.
    """
    sheet = read_sheet(data, name)
    how = layout(sheet)
    if meaning(sheet.names[how.angle_column]).unit not in (*ANGLE_UNITS, *TIME_UNITS):
        how = layout(sheet, ColumnChoice(angle_unit="deg"))
    if how.quantity != "displacement":
        raise TableError(
            name, [RowFault(0, f"column {how.value_column + 1} holds a {how.quantity}; wanted: the lift in mm")]
        )
    return read_table(sheet, how)


def compare(probing: Probing, measured: Measured, fit: bool = False) -> ProfileComparison:
    """Measured rows beside the exact profile; fit: the zero mark of the angles and that of the lift are unknown and chosen so that
    the sum of squares is least.

    Raises KindynaError where the rows are too few to be fitted.
    """
    theta, lift = np.deg2rad(measured.angles), measured.values
    shift, level = _fitted(probing, theta, lift) if fit else (0.0, 0.0)
    offset = float(np.rad2deg(np.remainder(shift + 0.5 * TURN, TURN) - 0.5 * TURN))
    table = probing.table(np.mod(measured.angles + offset, 360.0))
    missing = [tuple(float(np.mod(end + offset, 360.0)) for end in gap) for gap in gaps(measured.angles)]
    notes = tuple(note for note in (*measured.layout.guesses, *measured.notes) if not note.startswith("no rows from"))
    return ProfileComparison(
        probing,
        measured.name,
        measured.lines,
        table,
        lift - level,
        offset,
        level,
        fit,
        notes,
        tuple((begin, end or 360.0) for begin, end in missing),
    )


def _fitted(probing: Probing, theta: np.ndarray, lift: np.ndarray) -> tuple[float, float]:
    """Shift of the angles [rad] and level of the lift [mm] with the least Σ (lift - level - L(theta + shift))²: the best of many
    shifts, refined by Gauss and Newton's method, each step halved until it helps."""
    if theta.size < LEAST_FITTED:
        raise KindynaError(f"{theta.size} rows: too few to fit zero mark and level; allowed: {LEAST_FITTED} and more")
    grid = TURN * np.arange(TRIES) / TRIES
    nominal = probing.lift(grid)[0]
    some = slice(None, None, 1 + theta.size // MOST_ROWS)

    def trial(shift: float) -> float:
        return float(np.var(lift[some] - np.interp(theta[some] + shift, grid, nominal, period=TURN)))

    shift = float(min(grid.tolist(), key=trial))

    def residual(shift: float) -> tuple[np.ndarray, np.ndarray, float]:
        exact, slope = probing.lift(np.mod(theta + shift, TURN))
        left = lift - exact
        return left - left.mean(), slope - slope.mean(), float(left.mean())

    left, slope, level = residual(shift)
    for _ in range(STEPS):
        checkpoint()
        steepness = float(slope @ slope)
        if steepness <= (1e-12 * probing.base) ** 2:  # a circle about the cam centre has no zero mark
            break
        step = float(left @ slope) / steepness
        for _ in range(HALVINGS):
            nearer = residual(shift + step)
            if nearer[0] @ nearer[0] <= left @ left:
                break
            step *= 0.5
        else:
            break
        shift += step
        left, slope, level = nearer
        if abs(step) <= 1e-15 * TURN:
            break
    return shift, level


# -- an inspection as files -------------------------------------------------------------------------------------


ENDING = ".csv"
COLUMNS = ("cam_angle_deg", "lift_mm", "lower_mm", "upper_mm")
ROWS = (
    "cam_angle_deg",
    "measured_mm",
    "lift_mm",
    "lower_mm",
    "upper_mm",
    "deviation_mm",
    "normal_deviation_mm",
    "line",
)
DEVIATION = "_deviation"  # behind the name of the table


def require_name(path: Path) -> None:
    """Raises KindynaError where a file of this name holds no such table."""
    if path.suffix.lower() != ENDING:
        raise KindynaError(
            f"{path}: no table of lift is written as {path.suffix or 'a name without ending'}; allowed: {ENDING}"
        )


def _names(path: Path, compared: bool) -> list[str]:
    """Of the table, of its deviations, and of the summary."""
    return [path.name, *([f"{path.stem}{DEVIATION}{path.suffix}"] if compared else []), SUMMARY]


def facts(made: Inspection, comparison: ProfileComparison | None = None) -> dict[str, Any]:
    """What the table is, as ``summary.json`` says it."""
    at, table = made.probing, made.table
    stated: dict[str, Any] = {
        "design": at.study.design.name,
        "quantity": "lift of a probe on a line through the cam centre, above the base",
        "flank": at.request.flank,
        "probe": at.kind.label,
        "probe_radius_mm": at.radius if at.kind.radius else None,
        "direction_deg": float(np.rad2deg(at.direction)),
        "rotation": SENSES[at.study.sense][0],
        "units": {"length": "mm", "angle": "deg"},
        "least_profile_radius_mm": at.least_radius.value,
        "base_mm": at.base,
        "tolerance_mm": at.request.tolerance_mm,
        "points": int(table.degrees.size),
        "largest_lift_mm": float(table.lift.max()),
        "findings": [
            {"code": f.code, "severity": f.severity, "cam_angle_deg": f.cam_angle_deg, "message": f.message}
            for f in at.findings
        ],
    }
    return stated if comparison is None else {**stated, "measured": verdict_facts(comparison)}


def verdict_facts(comparison: ProfileComparison) -> dict[str, Any]:
    """What a measured table came to."""
    row, most = comparison.worst, comparison.most
    return {
        "file": comparison.name,
        "rows": int(comparison.lines.size),
        "fitted": comparison.fitted,
        "angle_offset_deg": comparison.angle_offset,
        "lift_offset_mm": comparison.lift_offset,
        "largest_normal_deviation_mm": float(comparison.normal[row]),
        "cam_angle_deg": float(comparison.table.degrees[row]),
        "line": int(comparison.lines[row]),
        "largest_deviation_mm": float(comparison.deviation[most]),
        "largest_deviation_at_deg": float(comparison.table.degrees[most]),
        "largest_deviation_line": int(comparison.lines[most]),
        "rms_deviation_mm": float(np.sqrt(np.mean(comparison.deviation**2))),
        "rows_out": int(comparison.out.sum()),
        "in_tolerance": comparison.in_tolerance,
        "notes": list(comparison.notes),
        "findings": [
            {"code": f.code, "severity": f.severity, "cam_angle_deg": f.cam_angle_deg, "message": f.message}
            for f in comparison.findings
        ],
    }


def files(made: Inspection, path: Path, comparison: ProfileComparison | None = None) -> dict[str, bytes]:
    """File name -> content."""
    table = made.table
    texts = [csv(COLUMNS, _plain(table.degrees, table.lift, table.lower, table.upper))]
    if comparison is not None:
        at = comparison.table
        columns = _plain(
            at.degrees,
            comparison.measured,
            at.lift,
            at.lower,
            at.upper,
            comparison.deviation,
            comparison.normal,
            comparison.lines,
        )
        texts.append(csv(ROWS, columns))
    texts.append(to_json({"file": path.name, **facts(made, comparison)}))
    return {name: text.encode() for name, text in zip(_names(path, comparison is not None), texts, strict=True)}


def _plain(*columns: np.ndarray) -> list[np.ndarray]:
    return [column + 0.0 for column in columns]  # no minus zero


def write_inspection(made: Inspection, path: Path, comparison: ProfileComparison | None = None) -> list[Path]:
    """Write the tables and the summary beside them; the paths. Raises FileError, KindynaError, and then nothing has changed."""
    require_name(path)
    texts = files(made, path, comparison)
    require_own_json(path.parent / SUMMARY, {"file", "base_mm"})
    write_into(path.parent, texts, typed=path.name)
    return [path.parent / name for name in texts]
