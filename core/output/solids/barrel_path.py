"""Path of a cutter as large as the roller of a barrel cam, as G-code for a machine with a rotary axis A.

The axis of the cutter follows that of the roller, so the flanks follow without an offset. The machine has X along the axis of the cam, Z
along the cutter, and A about X; the frame of the design is X = z, Y = -y, Z = x.

Sources: ISO 6983 (words), ISO 841 (axes and their senses).
"""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, radians

import numpy as np

from core.errors import KindynaError, NoCam
from core.frozen import frozen
from core.number_text import rounded_up
from core.numerics.lazy import checkpoint
from core.output.files.gcode import DIGITS, coordinate, remark
from core.output.files.profile_files import SENSES, one_line
from core.output.files.profile_request import Machining
from core.output.solids.patches import motion_rows
from core.requests import require_in_range
from core.study import Study

MM = 1e3
SAMPLES = 8  # parts of a chord between which its distance from the path is computed
BETWEEN = 1.1  # largest distance of a chord, relative to the largest of its samples
MOST_POINTS = 100_000
HALF_DIGIT = 0.5 * 10.0**-DIGITS  # largest error of a rounded coordinate, mm or deg
ALONG = 9  # distances along the roller at which the flank of a pass for the play is compared


@frozen(eq=False)
class Pass:
    """One turn of the blank under the cutter.

    Attributes
    ----------
    depth : below the face of the blank [mm]
    theta : ndarray (n,) [rad]
        Cam angles from 0 to a full turn.
    centres : ndarray (n, 2) [mm]
        X and Y of the cutter's axis.
    is_reversed : whether the turn is cut from its end to its start
    """

    depth: float
    theta: np.ndarray
    centres: np.ndarray
    is_reversed: bool


@frozen(eq=False)
class BarrelPath:
    """Path of the cutter, one pass after the other, and the largest distance [mm] of the exact flanks from those it cuts."""

    study: Study
    tolerance: float
    machining: Machining
    passes: tuple[Pass, ...]
    deviation: float

    @property
    def points(self) -> int:
        """Number of points of all passes."""
        return sum(part.theta.size for part in self.passes)

    @property
    def face(self) -> float:
        """Radius of the blank [mm]."""
        return float(self.study.design.drive.cam.outer_radius_mm)


def barrel_path(study: Study, tolerance: float, machining: Machining) -> BarrelPath:
    """Path of the cutter through the groove of a barrel cam with one cylindrical roller.

    With a play of the groove a last pass at full depth cuts the flank behind the roller: the axis of the cutter is displaced by the play
    along the normal of that flank in the roller's middle.

    Raises
    ------
    KindynaError
        The cam is another one; the tolerance is too fine; the depth reaches the axis of the cam.
    NoCam
        The radius of the blank is missing.
    """
    require_in_range(machining)
    _require_barrel(study)
    study.surface  # noqa: B018 - raises where the cam does not exist
    cam = study.design.drive.cam
    rounding = 2.0**0.5 * HALF_DIGIT + radians(HALF_DIGIT) * cam.outer_radius_mm
    if tolerance <= 2.0 * rounding:
        raise KindynaError(
            f"tolerance {tolerance:g} mm: below the accuracy of such a file; allowed: {rounded_up(2.0 * rounding, 2):g} mm and more"
        )
    is_reversed = (study.sense < 0.0) != machining.conventional  # with M3, a cutter left of a flank climbs
    theta, centres, chords = _chords(study, tolerance - rounding, has_play=False)
    depths = _depths(study, machining)
    passes = [Pass(depth, theta, centres, is_reversed) for depth in depths]
    if study.machine.play:
        twist = _twist(study, theta)
        theta, centres, behind = _chords(study, tolerance - rounding - twist, has_play=True)
        passes.append(Pass(depths[-1], theta, centres, not is_reversed))
        chords = max(chords, behind + twist)
    return BarrelPath(study, tolerance, machining, tuple(passes), chords + rounding)


def _require_barrel(study: Study) -> None:
    """Raises KindynaError for a cam whose groove such a path does not cut, and NoCam where the blank is not known."""
    cam, motion = study.design.drive.cam, study.design.drive.motion
    advance = 0.0 if motion is None else motion.gain
    rows = (
        ("cam.kind", f"{cam.kind!r}", cam.kind == "barrel", "barrel"),
        ("cam.form", f"{cam.form.form!r}", cam.form.form == "groove", "groove"),
        ("cam.roller_taper_deg", f"{cam.roller_taper_deg:g}", not cam.roller_taper_deg, "0 deg, a cylindrical roller"),
        ("cam.rollers", f"{cam.rollers}", cam.rollers == 1, "1"),
        ("motion.advance_deg", f"{advance:g}", not advance, "no advance"),
    )
    for key, value, is_allowed, allowed in rows:
        if not is_allowed:
            raise KindynaError(
                f"{key} = {value}: G-code cuts the groove of a barrel cam by the axis of its one cylindrical roller; allowed: {allowed}"
            )
    if cam.outer_radius_mm is None:
        raise NoCam("missing: the radius of the blank, at which the cutter enters", "cam.outer_radius_mm", "add it")


# -- the path ---------------------------------------------------------------------------------------------------


def _centres(study: Study, theta: np.ndarray, piece: np.ndarray, has_play: bool) -> np.ndarray:
    """X and Y (n, 2) [mm] of the cutter's axis."""
    from core.spatial import BEHIND, flank, roller_axis

    machine, rows = study.machine, motion_rows(study, theta, piece)
    at = roller_axis(machine, rows.y).c
    if has_play:
        surface = flank(machine, rows, np.array([[machine.middle]]), study.sense, BEHIND)
        at = at + machine.play * surface.normal[:, 0]
    return MM * np.stack((at[2], -at[1]), axis=-1)


def _chords(study: Study, tolerance: float, has_play: bool) -> tuple[np.ndarray, np.ndarray, float]:
    """Cam angles [rad] and centres of the ends of chords within a tolerance [mm], and their largest distance from the path [mm].

    At every cam angle the axis of the cutter is parallel to the exact one, so the distance of both bounds that of the flanks.
    """
    program, parts = study.program, np.arange(1, SAMPLES) / SAMPLES
    angles, largest = [np.zeros(1)], 0.0
    centres: list[np.ndarray] = []
    for piece, (low, high) in enumerate(zip(program.starts, program.ends, strict=True)):
        if high <= low:
            continue
        theta = np.array([low, high])
        while True:
            checkpoint()
            ends = _centres(study, theta, np.full(theta.size, piece), has_play)
            inner = theta[:-1, None] + np.diff(theta)[:, None] * parts
            exact = _centres(study, inner.ravel(), np.full(inner.size, piece), has_play).reshape(*inner.shape, 2)
            chord = ends[:-1, None] + np.diff(ends, axis=0)[:, None] * parts[:, None]
            error = BETWEEN * np.linalg.norm(exact - chord, axis=-1).max(axis=1)
            if error.max() <= tolerance:
                break
            counts = np.maximum(np.ceil(np.sqrt(error / max(tolerance, 1e-300))), 1.0)
            if theta.size + counts.sum() > MOST_POINTS:
                raise KindynaError(
                    f"tolerance: the path requires more than {MOST_POINTS} points; choose a larger tolerance"
                )
            cuts = [np.linspace(a, b, int(n) + 1)[1:] for a, b, n in zip(theta[:-1], theta[1:], counts, strict=True)]
            theta = np.concatenate((theta[:1], *cuts))
        largest = max(largest, float(error.max()))
        centres += [ends[1:]] if centres else [ends]
        angles.append(theta[1:])
    return np.concatenate(angles), np.concatenate(centres), largest


def _twist(study: Study, theta: np.ndarray) -> float:
    """Largest material [mm] that the pass for the play leaves, √((r + p)² + p² - 2 p (r + p) cos δ) - r with roller radius r and play p.

    δ is the angle between the normal of the flank behind and that in the roller's middle. No point of the flank is cut into: it is at
    least r + p from every position of the roller's axis, from which the axis of the cutter is displaced by p.
    """
    from core.spatial import BEHIND, dots, flank

    machine = study.machine
    at = study.program.angles(theta[:-1])
    u = np.linspace(machine.inner, machine.outer, ALONG)[:, None]
    rows = motion_rows(study, at.theta, at.piece)
    normal = flank(machine, rows, u, study.sense, BEHIND).normal
    cos = float(dots(normal, normal[:, ALONG // 2, None]).min())
    r, p = MM * machine.radius, MM * machine.play
    return float(np.sqrt((r + p) ** 2 + p * p - 2.0 * p * (r + p) * cos)) - r


def _depths(study: Study, machining: Machining) -> list[float]:
    """Depths below the face of the blank [mm]: equal steps, none larger than requested, the last one at the floor."""
    cam, machine = study.design.drive.cam, study.machine
    depth = machining.depth_mm or cam.outer_radius_mm - MM * (machine.inner - machine.play)
    if depth >= cam.outer_radius_mm:
        raise KindynaError(
            f"depth {depth:g} mm: the cutter reaches the axis of the cam; allowed: below {cam.outer_radius_mm:g} mm"
        )
    count = ceil(depth / machining.step_mm * (1.0 - 1e-9)) if machining.step_mm else 1
    return [depth * number / count for number in range(1, count + 1)]


# -- G-code -----------------------------------------------------------------------------------------------------


def gcode_bytes(path: BarrelPath) -> bytes:
    """The G-code program of a path, in ASCII."""
    return ("\n".join(_lines(path)) + "\n").encode("ascii")


def _lines(path: BarrelPath) -> Iterator[str]:
    machining, sense = path.machining, path.study.sense
    up = f"G0 Z{coordinate(path.face + machining.safe_mm)}"
    start = _words(path.passes[0].centres[-1 if path.passes[0].is_reversed else 0])
    yield "%"
    yield from map(remark, _header(path))
    yield "G21 G17 G90 G94 G40 G80"
    yield up
    yield f"M0 {remark('Start spindle and coolant')}"
    yield f"G0 {start} A0."
    turned = 0.0
    for number, part in enumerate(path.passes, 1):
        if len(path.passes) > 1:
            yield remark(f"Pass {number} of {len(path.passes)}")
        is_play = path.study.machine.play > 0.0 and number == len(path.passes)
        order = slice(None, None, -1) if part.is_reversed else slice(None)
        theta, centres = part.theta[order], part.centres[order]
        if is_play:
            yield f"G1 {_words(centres[0])} F{coordinate(machining.plunge_mm_min)}"
        else:
            yield f"G1 Z{coordinate(path.face - part.depth)} F{coordinate(machining.plunge_mm_min)}"
        yield "G93"
        angles = turned - sense * np.rad2deg(theta - theta[0])
        yield from _moves(path, angles, centres)
        yield "G94"
        turned = float(angles[-1])
    yield up
    yield f"M0 {remark('Stop spindle and coolant')}"
    yield "M30"
    yield "%"


def _moves(path: BarrelPath, angles: np.ndarray, centres: np.ndarray) -> Iterator[str]:
    """Moves to every point but the first, each with the reciprocal of its duration [1/min]."""
    lengths = np.hypot(np.linalg.norm(np.diff(centres, axis=0), axis=1), np.deg2rad(np.diff(angles)) * path.face)
    for angle, centre, length in zip(angles[1:].tolist(), centres[1:], lengths.tolist(), strict=True):
        yield f"G1 {_words(centre)} A{coordinate(angle)} F{coordinate(path.machining.feed_mm_min / length)}"


def _words(centre: np.ndarray) -> str:
    return f"X{coordinate(float(centre[0]))} Y{coordinate(float(centre[1]))}"


def _header(path: BarrelPath) -> list[str]:
    study, machining, play = path.study, path.machining, MM * path.study.machine.play
    depths = [part.depth for part in path.passes if part.is_reversed == path.passes[0].is_reversed]
    first, second = ("conventional", "climb") if machining.conventional else ("climb", "conventional")
    behind = (
        f"flank behind {first} in a last pass, displaced by the play of {play:g} mm"
        if play
        else f"flank behind {second}"
    )
    return [
        f"Design: {one_line(study.design.name)}",
        f"Groove of a barrel cam; it turns {SENSES[study.sense][1]} ({SENSES[study.sense][0]}) seen from +X",
        "Units: mm and deg; absolute; zero point of the active offset: X0 is z = 0 of the design, Y0 Z0 the axis of the cam",
        "A about X, A0 cam angle 0 with the x axis of the cam along +Z",
        "Growing A: the cutter moves around the blank counter-clockwise seen from +X, the blank turns clockwise [ISO 841]",
        f"Cutter: cylindrical, radius {MM * study.machine.radius:g} mm, that of the roller, whose axis it follows, without compensation",
        f"Points: {path.points}, chords within a tolerance of {path.tolerance:g} mm",
        f"Deviation from the exact flanks: at most {rounded_up(path.deviation, 4)!r} mm",
        f"With M3: flank ahead {first} milling, {behind}",
        f"Feed {coordinate(machining.feed_mm_min)} mm/min at the face of the blank, as reciprocal time [G93]; "
        f"plunge {coordinate(machining.plunge_mm_min)} mm/min, rapid moves at Z{coordinate(path.face + machining.safe_mm)}",
        f"Depth {coordinate(depths[-1])} mm below the face Z{coordinate(path.face)} in {len(depths)} "
        f"pass{'es' * (len(depths) > 1)}; the cutter plunges on the path",
        "Tool, spindle and coolant are left to the machinist: the program stops for them",
    ]
