"""Lift that a probe measures on the exact profile, and the deviations of a measured table from it."""

from __future__ import annotations

from collections.abc import Iterable
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
from core.number_text import result_text
from core.numerics.derivatives import cross, dot
from core.numerics.lazy import checkpoint
from core.output.export import SUMMARY, csv
from core.output.files.fitted_curve import exact_curve
from core.output.files.probe import (
    PROBES,
    InspectionRequest,
    ProbeKind,
    ProfileSections,
    Readings,
    probe_readings,
    profile_sections,
)
from core.output.files.profile_curve import ExactCurve, ProfileCurve, find_uncut_hollow, follower_side
from core.output.files.profile_files import SENSES
from core.output.files.profile_request import ProfileRequest as Profile
from core.output.summary import to_json
from core.project.files import require_own_csv, require_own_json, write_into
from core.requests import require_in_range
from core.study import Study

# -- lift of the exact profile, with its tolerance band ---------------------------------------------------------


DEFAULT_DIRECTION_DEG = 90.0  # for a follower without a direction
NEGLIGIBLE = 1e-6  # mm, below any measurement
FLAT = 1e-9  # relative to the curvature of the base circle: a smaller curvature counts as straight


@frozen(eq=False)
class LiftTable:
    """Lift over the cam angle.

    Attributes
    ----------
    degrees : (n,) cam angle [deg]
    lift : (n,) lift of the exact profile above the base [mm]
    lower, upper : (n,) lift of a profile at either end of the tolerance [mm]
    slope : (n,) derivative of the lift by the cam angle [mm/rad]
    cosine : (n,) cosine of the angle between the profile's normal and the line of measurement
    contact : (n,) complex contact point in the cam's own frame [mm]
    normal : (n,) complex unit vector at the contact, away from the cam
    """

    degrees: np.ndarray
    lift: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    slope: np.ndarray
    cosine: np.ndarray
    contact: np.ndarray
    normal: np.ndarray


@frozen(eq=False)
class ProbeSetup:
    """A probe set to a cam.

    Attributes
    ----------
    kind : row of ``PROBES``
    radius : radius of a round probe, else 0 [mm]
    direction : direction of the line of measurement from the cam centre [rad]
    exact : the profile in closed form
    side : side of the profile on which the probe runs, +1 left of its tangent
    outward : +1 where that side is away from the cam centre, -1 on the outer flank of a groove
    """

    study: Study
    request: InspectionRequest
    kind: ProbeKind
    radius: float
    direction: float
    exact: ExactCurve
    side: float
    outward: float

    # -- properties of the profile ------------------------------------------------------------------------------

    @cached_property
    def curve(self) -> ProfileCurve:
        """The profile by arc length."""
        return ProfileCurve(self.exact, self.study.program.starts, self.study.program.ends)

    @cached_property
    def least_radius(self) -> Extreme:
        """Least distance of the profile from the cam centre [mm]."""
        return find_extremes(lambda angles: {"": np.abs(self.exact(angles).z)}, self.study.program)[""].low

    @property
    def base(self) -> float:
        """Distance of the probe's centre or face from the cam centre [mm] at which the lift is 0."""
        return self.least_radius.value + self.outward * self.radius

    @cached_property
    def curvatures(self) -> tuple[Extreme, Extreme]:
        """Most convex and most concave curvature of the profile [1/mm], concave positive."""
        curvature = find_extremes(lambda angles: {"": self.side * self.exact(angles).curvature}, self.study.program)[""]
        return curvature.low, curvature.high

    @cached_property
    def _sections(self) -> dict[float, ProfileSections]:
        return {}

    # -- measuring ---------------------------------------------------------------------------------------------

    def readings(self, theta: np.ndarray, offset: float = 0.0) -> Readings:
        """Readings of the probe on the profile, or on one offset towards the probe.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Cam angles.
        offset : float
            Offset of the profile [mm].

        Returns
        -------
        Readings

        Raises
        ------
        NoCam
            The line of measurement does not meet the cam.
        """
        guide = self.kind.guide(self.exact, self.side, self.radius + offset)
        if offset not in self._sections:
            self._sections[offset] = profile_sections(guide, self.study.program)
        directions = self.direction - self.study.sense * theta
        result = probe_readings(self.kind, guide, self.exact, self._sections[offset], directions, self.outward)
        has_no_contact = ~np.isfinite(result.distance)
        if has_no_contact.any():
            raise NoCam(
                "the probe's line does not meet the profile",
                "cam.base_radius_mm",
                "enlarge the base radius, so that the cam centre lies inside the cam",
                angle_ranges(theta, has_no_contact),
            )
        return result

    def lift(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Lift that the probe measures, and its derivative by the cam angle.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Cam angles.

        Returns
        -------
        lift : ndarray (n,) [mm]
        slope : ndarray (n,) [mm/rad]
        """
        result = self.readings(theta)
        return result.distance - self.base, -self.study.sense * result.slope

    def table(self, degrees: np.ndarray) -> LiftTable:
        """Lift, tolerance band and contact at given cam angles.

        Parameters
        ----------
        degrees : ndarray (n,) [deg]

        Returns
        -------
        LiftTable
        """
        theta = np.deg2rad(degrees)
        result, band = self.readings(theta), self.request.tolerance_mm
        lower, upper = (
            result.distance if not band else self.readings(theta, sign * self.outward * band).distance
            for sign in (-1.0, 1.0)
        )
        normal = self.side * 1j * result.contact.tangent
        cosine = self.outward * dot(normal, np.exp(1j * (self.direction - self.study.sense * theta)))
        return LiftTable(
            degrees,
            result.distance - self.base,
            lower - self.base,
            upper - self.base,
            -self.study.sense * result.slope,
            cosine,
            result.contact.z,
            normal,
        )

    # -- findings ------------------------------------------------------------------------------------------------

    def _angle(self, direction: complex) -> float:
        """Cam angle [deg] at which a direction of the cam's own frame coincides with the line of measurement."""
        angle = self.study.sense * (self.direction - np.angle(direction))
        return float(np.mod(np.rad2deg(angle), 360.0)) % 360.0

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """Notes on parts of the profile that the probe does not reach; the measured lift is still correct."""
        findings = (self._flat_hollow(),) if self.kind.flat else (self._round_hollow(), self._overhang())
        return tuple(finding for finding in findings if finding is not None)

    def _round_hollow(self) -> Finding | None:
        """Finding for a hollow too narrow for a round probe; a probe no larger than the follower reaches everywhere."""
        if self.radius <= follower_probe(self.study.design, self.request.flank)[1]:
            return None
        gap = find_uncut_hollow(self.curve, self.exact, self.study.program, self.side, self.radius)
        if gap is None:
            return None
        samples = self.exact(self.study.program.angles(np.deg2rad([gap.begin])))
        centre = complex(samples.z[0] + self.side * self.radius * 1j * samples.tangent[0])
        uncut = f", which leaves {result_text(gap.uncut, 3)} mm between them" if gap.uncut > NEGLIGIBLE else ""
        return self._not_reached(centre, gap.radius, uncut)

    def _flat_hollow(self) -> Finding | None:
        """Finding for a hollow, which a flat face cannot reach."""
        sharpest = self.curvatures[1]
        if sharpest.value <= FLAT / self.least_radius.value:
            return None
        samples = self.exact(self.study.program.angles(np.array([sharpest.theta])))
        return self._not_reached(complex(self.side * 1j * samples.tangent[0]), 1.0 / sharpest.value, "")

    def _not_reached(self, direction: complex, radius: float, uncut: str) -> Finding:
        hollow = f", of radius {result_text(radius)} mm," if np.isfinite(radius) else " between two parts of it"
        probe = self.kind.label + (f", radius {result_text(self.radius)} mm" if self.kind.radius else "")
        values: dict[str, float | str] = {"probe": probe, "hollow": hollow, "left": uncut, "radius_mm": radius}
        return Finding("probe-hollow", NOTE, "inspection.radius_mm", self._angle(direction), values)

    def _overhang(self) -> Finding | None:
        """Finding where the path of a round probe's centre turns back over itself."""

        def facing(angles: Angles) -> np.ndarray:
            samples = self.exact(angles)
            normal = self.side * 1j * samples.tangent
            centre = samples.z + self.radius * normal
            return np.asarray(self.outward * dot(normal, centre) / np.abs(centre))

        lowest = find_extremes(lambda angles: {"": facing(angles)}, self.study.program)[""].low
        if lowest.value > 0.0:
            return None
        samples = self.exact(self.study.program.angles(np.array([lowest.theta])))
        centre = complex(samples.z[0] + self.side * self.radius * 1j * samples.tangent[0])
        return Finding("probe-overhang", NOTE, "inspection.radius_mm", self._angle(centre), {})


@frozen(eq=False)
class Inspection:
    """Table of a probe over one turn of the cam."""

    setup: ProbeSetup
    table: LiftTable


def set_up_probe(study: Study, request: InspectionRequest) -> ProbeSetup:
    """A probe set to the study's cam.

    Raises
    ------
    NoSuchStage, NoCam
        As `exact_curve`.
    KindynaError
        The probe, its radius or the tolerance is not allowed.
    """
    flank = Profile(request.flank, samples=request.samples, fit="polyline")
    exact = exact_curve(study, flank)
    default_probe, follower_radius = follower_probe(study.design, request.flank)
    name = request.probe or default_probe
    if name not in PROBES:
        raise KindynaError(f"probe {name!r}: none of that name; allowed: {', '.join(PROBES)}")
    kind = PROBES[name]
    require_in_range(request)
    radius = _radius(request, kind, follower_radius)
    probe_side = follower_side(study, flank_index(study, request.flank))
    direction = np.deg2rad(follower_direction(study.design) if request.direction_deg is None else request.direction_deg)
    z = exact(piecewise_angles(study.program)).z
    area = float(cross(z, np.roll(z, -1)).sum())
    setup = ProbeSetup(
        study, request, kind, radius, float(direction), exact, probe_side, -float(np.sign(area)) * probe_side
    )
    _require_room(setup)
    _require_tolerance(setup)
    return setup


def follower_probe(design: Design, flank: str) -> tuple[str, float]:
    """Row of ``PROBES`` that touches a flank as the follower does, and its radius [mm].

    On an outer flank with play it is the actual roller, which is smaller than the radius for which the flank is designed.
    """
    face = faces_of(design.drive.face, design.drive.cam)[INNER if flank == OUTER else flank]
    matching = (
        slug for slug, kind in PROBES.items() if (kind.flat, kind.radius) == (face.straight, face.radius_mm > 0.0)
    )
    return next(matching), face.radius_mm


def flank_index(study: Study, name: str) -> int:
    """Index of a flank among those of the cam."""
    return [flank.name for flank in study.at(Angles(np.zeros(1), np.zeros(1, dtype=int))).cam.flanks].index(name)


def follower_direction(design: Design) -> float:
    """Direction from the cam centre to the follower [deg]; 90 where the follower has none."""
    return float(getattr(design.drive.mechanism, "direction_deg", DEFAULT_DIRECTION_DEG))


def _radius(request: InspectionRequest, kind: ProbeKind, follower_radius: float) -> float:
    given = request.radius_mm
    if not kind.radius:
        if given:
            raise KindynaError(f"radius {given:g} mm: a {kind.label} has none; omit it, or choose a roller")
        return 0.0
    radius = follower_radius if given is None else given
    if not (np.isfinite(radius) and radius > 0.0):
        problem = "radius: the follower has none, and none is given" if given is None else f"radius {given:g} mm"
        raise KindynaError(f"{problem}; allowed: above 0 (a point has none)")
    return radius


def _require_room(setup: ProbeSetup) -> None:
    """Raises KindynaError for a probe that does not fit into a groove."""
    if setup.outward > 0.0:
        return
    if setup.kind.flat:
        raise KindynaError("probe flat: it cannot touch a flank that surrounds it; choose a roller or a point")
    faces = faces_of(setup.study.design.drive.face, setup.study.design.drive.cam)
    room = 0.5 * sum(face.radius_mm for face in faces.values()) if OUTER in faces else np.inf
    if setup.radius > room:
        raise KindynaError(
            f"radius {setup.radius:g} mm: the probe does not go into the groove; allowed: at most {result_text(room, 6)} mm"
        )


def _require_tolerance(setup: ProbeSetup) -> None:
    """Raises KindynaError for a tolerance at which the profile degenerates."""
    band = setup.request.tolerance_mm
    if not (np.isfinite(band) and band >= 0.0):
        raise KindynaError(f"tolerance {band:g} mm: allowed: 0 or more")
    convex = -setup.curvatures[0].value
    greatest = min(setup.least_radius.value, 1.0 / convex if convex > 0.0 else np.inf)
    if band >= greatest:
        raise KindynaError(
            f"tolerance {band:g} mm: as large as the profile's least convex radius or its distance from the cam centre; "
            f"allowed: below {result_text(greatest, 5)} mm"
        )


def inspection(study: Study, request: InspectionRequest) -> Inspection:
    """Table of a probe at equally spaced cam angles. Raises as `set_up_probe`."""
    setup = set_up_probe(study, request)
    return Inspection(setup, setup.table(360.0 * np.arange(request.samples) / request.samples))


# -- comparison with a measured table ---------------------------------------------------------------------------


TRIES = 720  # zero marks that are tried before the best is refined
MOST_ROWS = 2_000  # of the table that are used for it
STEPS, HALVINGS = 60, 40  # of the Gauss-Newton method
LEAST_FITTED = 4  # rows for two unknowns
ROUNDING = 1e-9  # mm: a row beyond the band by less is within it


@frozen(eq=False)
class ProfileComparison:
    """Measured rows compared with the exact profile.

    Attributes
    ----------
    name : name of the file
    lines : (n,) line numbers of the rows
    table : lift of the exact profile at the cam angles of the rows
    measured : (n,) measured lift, less the fitted offset [mm]
    angle_offset : cam angle = angle of the row + angle_offset [deg]; 0 where not fitted
    lift_offset : measured lift = lift of the row - lift_offset [mm]; 0 where not fitted
    is_fitted : whether both are fitted by least squares
    notes : how the file was read
    gaps : ranges (from, to) without rows [deg]
    """

    setup: ProbeSetup
    name: str
    lines: np.ndarray
    table: LiftTable
    measured: np.ndarray
    angle_offset: float
    lift_offset: float
    is_fitted: bool
    notes: tuple[str, ...]
    gaps: tuple[tuple[float, float], ...]

    @property
    def deviation(self) -> np.ndarray:
        """Measured lift less the lift of the exact profile (n,) [mm]."""
        return self.measured - self.table.lift

    @property
    def normal_deviation(self) -> np.ndarray:
        """Deviation normal to the profile (n,) [mm], positive outwards from the cam centre."""
        return self.deviation * self.table.cosine

    @property
    def worst_row(self) -> int:
        """Row with the largest deviation normal to the profile."""
        return int(np.argmax(np.abs(self.normal_deviation)))

    @property
    def is_outside(self) -> np.ndarray:
        """Whether a row is outside of the band (n,)."""
        return (self.measured < self.table.lower - ROUNDING) | (self.measured > self.table.upper + ROUNDING)

    @property
    def is_in_tolerance(self) -> bool:
        """Whether every row is within the band."""
        return not self.is_outside.any()

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Deviations beyond the tolerance, and ranges that were not measured."""
        findings = list(self.setup.findings)
        if not self.is_in_tolerance:
            row = int(np.argmax(np.where(self.is_outside, np.abs(self.normal_deviation), -1.0)))
            values = {
                "deviation_mm": float(self.deviation[row]), "normal_mm": float(self.normal_deviation[row]),
                "limit_mm": self.setup.request.tolerance_mm,
            }  # fmt: skip
            findings.append(
                Finding("out-of-tolerance", ERROR, "inspection.tolerance_mm", float(self.table.degrees[row]), values)
            )
        findings.extend(
            Finding("not-measured", NOTE, "inspection.measured", None, {"from_deg": begin, "to_deg": end})
            for begin, end in self.gaps
        )
        return tuple(findings)


def read_lift(data: bytes, name: str) -> Measured:
    """Measured lift from the bytes of a file.

    Angles are in degrees and lengths in mm unless the header states another unit. Raises TableError where a row is wrong,
    where the values are not lengths, or the angles not angles.
    """
    sheet = read_sheet(data, name)
    columns = layout(sheet)
    if meaning(sheet.names[columns.angle_column]).unit not in (*ANGLE_UNITS, *TIME_UNITS):
        columns = layout(sheet, ColumnChoice(angle_unit="deg"))
    if columns.quantity != "displacement":
        raise TableError(
            name,
            [RowFault(0, f"column {columns.value_column + 1} holds a {columns.quantity}; required: the lift in mm")],
        )
    return read_table(sheet, columns)


def compare(setup: ProbeSetup, measured: Measured, fit: bool = False) -> ProfileComparison:
    """Compare measured rows with the exact profile.

    Parameters
    ----------
    setup : ProbeSetup
    measured : MeasuredTable
    fit : bool
        Also fit the zero marks of angle and lift, by least squares.

    Raises
    ------
    KindynaError
        There are too few rows to fit.
    """
    theta, lift = np.deg2rad(measured.angles), measured.values
    shift, level = _fit_offsets(setup, theta, lift) if fit else (0.0, 0.0)
    offset = float(np.rad2deg(np.remainder(shift + 0.5 * TURN, TURN) - 0.5 * TURN))
    table = setup.table(np.mod(measured.angles + offset, 360.0))
    missing = [tuple(float(np.mod(end + offset, 360.0)) for end in gap) for gap in gaps(measured.angles)]
    notes = tuple(note for note in (*measured.layout.guesses, *measured.notes) if not note.startswith("no rows from"))
    return ProfileComparison(
        setup,
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


def _fit_offsets(setup: ProbeSetup, theta: np.ndarray, lift: np.ndarray) -> tuple[float, float]:
    """Shift of the angles [rad] and level of the lift [mm] with the least Σ (lift - level - L(theta + shift))².

    The best of many shifts, refined by the Gauss-Newton method with steps halved until they improve.
    """
    if theta.size < LEAST_FITTED:
        raise KindynaError(f"{theta.size} rows: too few to fit zero mark and level; allowed: {LEAST_FITTED} and more")
    grid = TURN * np.arange(TRIES) / TRIES
    nominal = setup.lift(grid)[0]
    sampled = slice(None, None, 1 + theta.size // MOST_ROWS)

    def trial(shift: float) -> float:
        return float(np.var(lift[sampled] - np.interp(theta[sampled] + shift, grid, nominal, period=TURN)))

    shift = float(min(grid.tolist(), key=trial))

    def residual(shift: float) -> tuple[np.ndarray, np.ndarray, float]:
        exact, slope = setup.lift(np.mod(theta + shift, TURN))
        remainder = lift - exact
        return remainder - remainder.mean(), slope - slope.mean(), float(remainder.mean())

    remainder, slope, level = residual(shift)
    for _ in range(STEPS):
        checkpoint()
        steepness = float(slope @ slope)
        if steepness <= (1e-12 * setup.base) ** 2:  # a circle about the cam centre has no zero mark
            break
        step = float(remainder @ slope) / steepness
        for _ in range(HALVINGS):
            improved = residual(shift + step)
            if improved[0] @ improved[0] <= remainder @ remainder:
                break
            step *= 0.5
        else:
            break
        shift += step
        remainder, slope, level = improved
        if abs(step) <= 1e-15 * TURN:
            break
    return shift, level


# -- files ------------------------------------------------------------------------------------------------------


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
DEVIATION = "_deviation"  # suffix of the table's name


def require_name(path: Path) -> None:
    """Raises KindynaError for the name of a file that is no table of lift."""
    if path.suffix.lower() != ENDING:
        raise KindynaError(
            f"{path}: a table of lift cannot have {path.suffix or 'a name without ending'}; allowed: {ENDING}"
        )


def facts(inspected: Inspection, comparison: ProfileComparison | None = None) -> dict[str, Any]:
    """Facts about the table for ``summary.json``."""
    setup, table = inspected.setup, inspected.table
    result: dict[str, Any] = {
        "design": setup.study.design.name,
        "quantity": "lift of a probe on a line through the cam centre, above the base",
        "flank": setup.request.flank,
        "probe": setup.kind.label,
        "probe_radius_mm": setup.radius if setup.kind.radius else None,
        "direction_deg": float(np.rad2deg(setup.direction)),
        "rotation": SENSES[setup.study.sense][0],
        "units": {"length": "mm", "angle": "deg"},
        "least_profile_radius_mm": setup.least_radius.value,
        "base_mm": setup.base,
        "tolerance_mm": setup.request.tolerance_mm,
        "points": int(table.degrees.size),
        "largest_lift_mm": float(table.lift.max()),
        "findings": _finding_facts(setup.findings),
    }
    return result if comparison is None else {**result, "measured": verdict_facts(comparison)}


def verdict_facts(comparison: ProfileComparison) -> dict[str, Any]:
    """Facts about the comparison with a measured table."""
    row, largest = comparison.worst_row, int(np.argmax(np.abs(comparison.deviation)))
    return {
        "file": comparison.name,
        "rows": int(comparison.lines.size),
        "fitted": comparison.is_fitted,
        "angle_offset_deg": comparison.angle_offset,
        "lift_offset_mm": comparison.lift_offset,
        "largest_normal_deviation_mm": float(comparison.normal_deviation[row]),
        "cam_angle_deg": float(comparison.table.degrees[row]),
        "line": int(comparison.lines[row]),
        "largest_deviation_mm": float(comparison.deviation[largest]),
        "largest_deviation_at_deg": float(comparison.table.degrees[largest]),
        "largest_deviation_line": int(comparison.lines[largest]),
        "rms_deviation_mm": float(np.sqrt(np.mean(comparison.deviation**2))),
        "rows_out": int(comparison.is_outside.sum()),
        "in_tolerance": comparison.is_in_tolerance,
        "notes": list(comparison.notes),
        "findings": _finding_facts(comparison.findings),
    }


def _finding_facts(findings: Iterable[Finding]) -> list[dict[str, Any]]:
    return [
        {"code": f.code, "severity": f.severity, "cam_angle_deg": f.cam_angle_deg, "message": f.message}
        for f in findings
    ]


def files(inspected: Inspection, path: Path, comparison: ProfileComparison | None = None) -> dict[str, bytes]:
    """File name -> content."""
    table = inspected.table
    texts = [csv(COLUMNS, _plain(table.degrees, table.lift, table.lower, table.upper))]
    if comparison is not None:
        exact = comparison.table
        columns = _plain(
            exact.degrees,
            comparison.measured,
            exact.lift,
            exact.lower,
            exact.upper,
            comparison.deviation,
            comparison.normal_deviation,
            comparison.lines,
        )
        texts.append(csv(ROWS, columns))
    texts.append(to_json({"file": path.name, **facts(inspected, comparison)}))
    names = [path.name, *([] if comparison is None else [_deviations_name(path)]), SUMMARY]
    return {name: text.encode() for name, text in zip(names, texts, strict=True)}


def _deviations_name(path: Path) -> str:
    return f"{path.stem}{DEVIATION}{path.suffix}"


def _plain(*columns: np.ndarray) -> list[np.ndarray]:
    return [column + 0.0 for column in columns]  # no minus zero


def write_inspection(inspected: Inspection, path: Path, comparison: ProfileComparison | None = None) -> list[Path]:
    """Write the tables and the summary, and return their paths. Raises FileError, KindynaError; then nothing has changed."""
    require_name(path)
    texts = files(inspected, path, comparison)
    require_own_json(path.parent / SUMMARY, {"file", "base_mm"})
    if comparison is not None:
        require_own_csv(path.parent / _deviations_name(path), ROWS)
    write_into(path.parent, texts, typed=path.name)
    return [path.parent / name for name in texts]
