"""Motions linked to other files: a table, a sum of motions, or the driver's motion that gives a linkage's output a required motion.

A linked motion without a closed form has a Chebyshev interpolant of the jerk on each piece. Position, velocity and acceleration are
its integrals from their exact values at the start, within rounding of the function at every angle.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise
from types import MappingProxyType
from typing import Any

import numpy as np

from core.design import (
    CRANK,
    FRAME_LINK,
    UNITS,
    ComputedCurve,
    Design,
    Follows,
    Linkage,
    Motion,
    Origin,
    Segment,
    with_drive,
)
from core.design.motion_edits import files_of, motion_of, require_motion, without_marks
from core.design.motions import InverseOrigin, TableOrigin
from core.design.topology import driver_turns
from core.errors import DesignError, Fault, KindynaError
from core.frozen import frozen
from core.laws import Piece
from core.motion import Angles, CompiledMotion, program
from core.motion.program import piece_ends
from core.motion.tables import tabled
from core.number_text import result_text
from core.units import split_unit

TURN = 2.0 * np.pi
Loader = Callable[[str, Sequence[str]], Design]
"""Path of a design file, and the files being read, each linked from the one before -> the design of its one drive."""
Rows = Callable[[np.ndarray, float], np.ndarray]
"""Function of angles (n,) [rad], and of an angle inside their piece, for the value and three derivatives (4, n) [SI]."""


def linked_motion(origin: Origin, requested: Motion | None, unit: str, chain: Sequence[str], load: Loader) -> Motion:
    """Motion of an origin.

    Parameters
    ----------
    origin : Origin
    requested : Motion or None
        Required motion of the output, for an inverse.
    unit : str
        Unit of the design's motion, where it is known.
    chain : sequence of str
        Files being read, that of the design last.
    load : Loader
        Reads a further file.

    Returns
    -------
    Motion

    Raises
    ------
    DesignError
        A file cannot be read or gives no motion.
    """
    folder = os.path.dirname(chain[-1]) if chain else os.getcwd()
    motion, files = _MOTIONS[origin.key](_Request(origin, requested, unit, folder, chain, load))
    result = (motion.start, motion.segments, motion.advance)
    return replace(motion, follows=Follows(origin, folder, requested, tuple(dict.fromkeys(files)), result))


def with_linked_motion(
    design: Design, files: Sequence[str], home: str | None, load: Loader, output: str = ""
) -> Design:
    """The design with a motion linked to files.

    Parameters
    ----------
    design : Design
    files : sequence of str
        One table; or one linkage together with `output`; or designs whose motions are added.
    home : str or None
        Path of the design's file, to which the linked paths are relative; None where it has none yet.
    load : Loader
        Reads a design file.
    output : str
        Output of a linkage, which is to have the design's present motion.

    Returns
    -------
    Design

    Raises
    ------
    DesignError
        A file cannot be read or gives no motion, or the unit of the motion does not fit.
    """
    folder, motion = os.path.dirname(os.path.abspath(home)) if home else "", require_motion(design)
    names = tuple(os.path.relpath(path, folder) if folder else os.path.abspath(path) for path in files)
    tables = [name for name in names if not name.lower().endswith(".toml")]
    if tables and len(names) > 1:
        raise _error("motion.from.table", tables[0], "is one of several files", "one table, or designs alone")
    if tables:
        origin = Origin(from_=TableOrigin(tables[0]))
    else:
        origin = Origin(inverse=InverseOrigin(names[0], output)) if output else Origin(sum=names)
    chain = (os.path.abspath(home),) if home else ()
    linked = linked_motion(origin, motion if output else None, motion.unit, chain, load)
    if linked.unit != motion.unit and not design.drive.is_alone:
        problem = f"gives a motion in {linked.unit}, but this design has one in {motion.unit}"
        raise _error(f"motion.{origin.key}", ", ".join(names), problem, f"a motion in {motion.unit}")
    return with_drive(without_marks(design), motion=linked)


def output_units(design: Design) -> dict[str, str]:
    """Unit of the motion by number of each moving link of a linkage; empty for another design."""
    if design.listed or not design.drive.is_linkage:
        return {}
    linkage = design.drive.linkage
    slides = {str(slider.link) for slider in linkage.sliders}
    return {str(n): "mm" if str(n) in slides else "deg" for n in sorted(linkage.by_number) if n != FRAME_LINK}


def with_unlinked_motion(design: Design) -> Design:
    """The design with its linked motion replaced by an editable copy; segments without a closed form become tables.

    The tables are within `TABLE_ERROR` of the stroke.
    """
    motion = require_motion(design)
    if motion.follows is None:
        return design
    compiled = program(motion)
    segments = [
        tabled(compiled, i, segment) if isinstance(segment.curve, ComputedCurve) else segment
        for i, segment in enumerate(motion.segments)
    ]
    return with_drive(without_marks(design), motion=replace(motion, segments=tuple(segments), follows=None))


def with_unlinked_motions(design: Design) -> Design:
    """The design with every linked motion of its drives replaced by an editable copy."""
    from core.design import only, with_only

    for i, drive in enumerate(design.drives):
        if drive.motion is not None and drive.motion.follows is not None:
            design = with_only(design, i, with_unlinked_motion(only(design, i)))
    return design


# -- other files ------------------------------------------------------------------------------------------


@frozen
class _Request:
    """Arguments of `linked_motion`, and the folder of the design's file."""

    origin: Origin
    requested: Motion | None
    unit: str
    folder: str
    chain: Sequence[str]
    load: Loader


def _linked_design(path: str, name: str, request: _Request) -> tuple[Design, list[str]]:
    """Design of the one drive of another file, and the files read for it. Raises DesignError."""
    file = os.path.normpath(os.path.join(request.folder, name))
    chain = [os.path.realpath(path) for path in request.chain]
    if os.path.realpath(file) in chain:
        circle = [os.path.basename(path) for path in [*chain[chain.index(os.path.realpath(file)) :], file]]
        raise _error(
            path, name, f"the files go in a circle: {' > '.join(circle)}", "a file that does not follow from this one"
        )
    try:
        design = request.load(file, request.chain)
    except DesignError as error:
        raise DesignError(
            Fault(path, name, str(fault)) if "circle" in fault.problem else Fault(path, name, f"there {fault}")
            for fault in error.faults[:3]
        ) from error
    except KindynaError as error:
        raise _error(path, name, str(error)) from error
    return design, [file, *files_of(design)]


def _error(path: str, value: Any, problem: str, allowed: str = "") -> DesignError:
    return DesignError([Fault(path, value, problem, allowed)])


# -- a table ----------------------------------------------------------------------------------------------


def _table_motion(request: _Request) -> tuple[Motion, list[str]]:
    from core.measured import ColumnChoice, fit, is_workbook, layout, read_sheet, read_table, read_workbook
    from core.measured.sheet import line_ranges
    from core.project.files import read_bytes

    origin, unit = request.origin, request.unit
    assert origin.from_ is not None
    table, column = origin.from_.table, origin.from_.column
    file, symbol = os.path.normpath(os.path.join(request.folder, table)), split_unit(column)[1].symbol
    try:
        data = read_bytes(file)
        sheet = read_workbook(data, table) if is_workbook(data) else read_sheet(data, table)
        how = layout(
            sheet,
            ColumnChoice(column=column, angle_column=origin.from_.angle_column),
            "deg" if symbol == "deg" or (not column and unit == "deg") else "mm" if symbol else unit,
        )
        rows = read_table(sheet, how)
        fitted = fit(rows)
    except KindynaError as error:
        raise DesignError(Fault("motion.from.table", table, line) for line in str(error).split("\n")[:3]) from error
    if fitted.left_out:
        lines = line_ranges(sheet.rows[i].line for i in fitted.left_out)
        raise _error(
            "motion.from.table", table, f"{lines}: no motion passes through these rows", "rows that fit; see measured"
        )
    return fitted.motion, [file]


# -- a sum ------------------------------------------------------------------------------------------------


def _sum_motion(request: _Request) -> tuple[Motion, list[str]]:
    motions: list[Motion] = []
    files: list[str] = []
    for i, name in enumerate(request.origin.sum):
        path = f"motion.sum[{i}]"
        design, read = _linked_design(path, name, request)
        motion = motion_of(design)
        if motion is None:
            raise _error(path, name, "has no motion: its crank turns at constant speed", "a design with [motion]")
        if motions and motion.unit != motions[0].unit:
            raise _error(path, name, f"is in {motion.unit}, the others in {motions[0].unit}", "motions of one unit")
        motions.append(motion)
        files += read
    parts = [program(motion) for motion in motions]

    def rows(theta: np.ndarray, inside: float) -> np.ndarray:
        return np.asarray(sum(_on_piece(part, theta, inside) for part in parts))

    gains = [motion.advance for motion in motions if motion.advance is not None]
    fitted = _fitted(rows, parts, motions[0].unit, sum(gains) if gains else None)
    return replace(fitted, start=sum(motion.first for motion in motions)), files


def _on_piece(part: CompiledMotion, theta: np.ndarray, inside: float) -> np.ndarray:
    piece = int(part.angles(np.array([inside])).piece[0])
    return part.state(Angles(theta, np.full(theta.size, piece))).y


# -- an inverse -------------------------------------------------------------------------------------------


def _inverse_motion(request: _Request) -> tuple[Motion, list[str]]:
    origin, requested = request.origin, request.requested
    assert origin.inverse is not None
    assert requested is not None
    name, path = origin.inverse.linkage, "motion.inverse.linkage"
    design, files = _linked_design(path, name, request)
    if not design.drive.is_linkage:
        raise _error(path, name, f"is no linkage but a {design.drive.label.lower()}", "a design with [linkage]")
    try:
        branch = _Branch(design, origin.inverse.output, requested)
    except DesignError:
        raise
    except KindynaError as error:
        raise _error(path, name, str(error)) from error
    part = program(requested)

    def rows(theta: np.ndarray, inside: float) -> np.ndarray:
        return branch.inverse(theta, _on_piece(part, theta, inside))

    unit = "deg" if driver_turns(design.drive.linkage) else "mm"
    first = rows(np.zeros(1), part.ends[0] * 0.5)[0, 0]
    last = rows(np.array([TURN]), 0.5 * (part.starts[-1] + TURN))[0, 0]
    gain = float(last - first) / UNITS[unit].factor
    if requested.advance and branch.period:
        gain = round(gain / (branch.period / UNITS[unit].factor)) * branch.period / UNITS[unit].factor
    fitted = _fitted(rows, [part], unit, gain if requested.advance else None)
    return replace(fitted, start=float(first) / UNITS[unit].factor), files


SAMPLES = 2881  # of the driver's range, between which an output goes monotonously but for its dead centres
DEAD = 1e-6  # of the largest transmission: less is a dead centre


REACHED = (
    1e-8  # of the way between two dead centres: a motion this near reaches one, where its acceleration has no limit
)


class _Branch:
    """Part of a driver's range, between two dead centres of an output, in which the driver's position x follows from the output's y.

    It contains the start of the requested motion. A rotating driver without dead centres continues turn by turn.

    Attributes
    ----------
    period : float
        Cycle of the linkage [rad of the driver]; 0 where the branch does not continue periodically.
    """

    def __init__(self, design: Design, output: str, requested: Motion) -> None:
        self._requested = requested
        self._linkage, self._name = _driven(design), _coordinate(design, output, requested)
        self._turns = driver_turns(self._linkage)
        low, high, is_full = self._range(design)
        at = np.linspace(low, high, SAMPLES)
        y, rate = self.forward(at)[:2]
        if requested.unit == "deg":
            y = np.unwrap(y)
        slow = DEAD * float(np.abs(rate).max())
        begin = requested.first * requested.scale
        first = self._first(design, at, y, begin)
        i = int(np.clip(np.searchsorted(at, first) - 1, 0, SAMPLES - 2))
        sign = np.sign(y[i + 1] - y[i])
        right = np.flatnonzero(rate[i + 1 :] * sign <= slow)
        left = np.flatnonzero(rate[: i + 1] * sign <= slow)
        self.period = self._cycle if is_full and not right.size and not left.size else 0.0
        a = 0 if not left.size else int(left[-1])
        b = SAMPLES - 1 if not right.size else i + 1 + int(right[0])
        if is_full and not self.period:  # a crank, whose branch may extend beyond the sampled turn
            return self._set_beyond_turn(at, y, rate, first, sign, slow, begin)
        y_first = y[i] + (first - at[i]) / (at[i + 1] - at[i]) * (y[i + 1] - y[i])
        self._set_samples(at[a : b + 1], y[a : b + 1], y_first, begin, (bool(left.size), bool(right.size)))

    def _set_beyond_turn(
        self, at: np.ndarray, y: np.ndarray, rate: np.ndarray, first: float, sign: float, slow: float, begin: float
    ) -> None:
        """Set the branch from three turns of samples."""
        gain = y[-1] - y[0]
        three = np.concatenate((at[:-1] - self._cycle, at[:-1], at + self._cycle))
        values = np.concatenate((y[:-1] - gain, y[:-1], y + gain))
        rates = np.concatenate((rate[:-1], rate[:-1], rate)) * sign
        i = int(np.searchsorted(three, first) - 1)
        left, right = np.flatnonzero(rates[: i + 1] <= slow), np.flatnonzero(rates[i + 1 :] <= slow)
        a, b = int(left[-1]), i + 1 + int(right[0])
        y_first = values[i] + (first - three[i]) / (three[i + 1] - three[i]) * (values[i + 1] - values[i])
        self._set_samples(three[a : b + 1], values[a : b + 1], y_first, begin, (True, True))

    def _set_samples(
        self, at: np.ndarray, y: np.ndarray, y_first: float, begin: float, dead: tuple[bool, bool]
    ) -> None:
        """Set the samples of the branch, with ends that are dead centres at their exact positions."""
        from scipy.optimize import brentq

        at, y = at.copy(), y.copy()
        for end, inner, is_dead in ((0, 1, dead[0]), (-1, -2, dead[1])):
            rates = self._within(at[[inner, end]])[1]
            if is_dead and rates[0] * rates[1] < 0.0:
                at[end] = brentq(lambda x: self._within(np.array([x]))[1, 0], at[inner], at[end], xtol=1e-14)
                top = float(self._within(at[[end]])[0, 0])
                y[end] = top + (TURN * np.rint((y[inner] - top) / TURN) if self._requested.unit == "deg" else 0.0)
        y = y + (TURN * np.rint((begin - y_first) / TURN) if self._requested.unit == "deg" else 0.0)
        rising = y[-1] > y[0]
        self._x, self._y = (at, y) if rising else (at[::-1], y[::-1])
        self._gain = float(y[-1] - y[0]) if self.period else 0.0

    def _range(self, design: Design) -> tuple[float, float, bool]:
        """Ends [rad or m] of the driver's range, and whether it is a full turn."""
        from core.mechanism import driver_ranges_of, motion_extent, plan_of

        if self._turns:
            self._driver_ranges = driver_ranges_of(self._linkage)
        else:
            motion = design.drive.motion
            assert motion is not None
            low, high = motion_extent(program(replace(motion, follows=None)))
            margin = 2.0 * plan_of(self._linkage).size
            self._driver_ranges = driver_ranges_of(self._linkage, low - margin, high + margin)
        self._cycle = TURN * self._driver_ranges.turns
        ranges, start = self._driver_ranges.ranges, self._driver_start(design)
        is_full = self._turns and len(ranges) == 1 and ranges[0].is_free and not self._driver_ranges.is_swinging
        nearest = min(ranges, key=lambda r: max(r.low - start, start - r.high, 0.0))
        inset = 0.0 if is_full else 1e-9 * (nearest.high - nearest.low)
        return nearest.low + inset, nearest.high - inset, is_full

    def _driver_start(self, design: Design) -> float:
        """Position [rad or m] of the linkage's driver: start of its motion, else as drawn, else 0."""
        motion, drawn = design.drive.motion, design.drive.linkage.drawn
        if motion is not None:
            return motion.first * motion.scale
        return 0.0 if drawn is None or drawn.driver_deg is None else float(np.deg2rad(drawn.driver_deg))

    def _first(self, design: Design, at: np.ndarray, y: np.ndarray, begin: float) -> float:
        """Position of the driver at cam angle 0: the nearest to `_driver_start` at which the output is at the start of its motion.

        Of a crank that is neither drawn nor driven by a motion, the first one from 0 on.
        """
        error = y - begin
        if self._requested.unit == "deg":
            error = np.remainder(error + np.pi, TURN) - np.pi
        is_continuous = np.abs(np.diff(error)) < np.pi if self._requested.unit == "deg" else True
        meets = np.flatnonzero((np.sign(error[1:]) != np.sign(error[:-1])) & is_continuous)
        if not meets.size:
            unit, scale = self._requested.unit, self._requested.scale
            raise _error(
                "motion.start_" + unit, self._requested.start, f"at cam angle 0 deg output {self._name} cannot have this position",
                f"{result_text(float(y.min()) / scale, 6)} ... {result_text(float(y.max()) / scale, 6)} {unit}",
            )  # fmt: skip
        x = at[meets] + error[meets] / (error[meets] - error[meets + 1]) * (at[meets + 1] - at[meets])
        motion, drawn = design.drive.motion, design.drive.linkage.drawn
        start = self._driver_start(design)
        if not self._turns:
            return float(x[np.argmin(np.abs(x - start))])
        if motion is None and drawn is None:
            return float(x[np.argmin(np.mod(x, TURN))])
        return float(x[np.argmin(np.abs(np.remainder(x - start + np.pi, TURN) - np.pi))])

    def forward(self, x: np.ndarray) -> np.ndarray:
        """Output and three derivatives by the driver (4, n) [SI], at driver positions (n,) [rad or m]."""
        from core.mechanism import unit_speed_kinematics

        solved = unit_speed_kinematics(self._linkage, np.asarray(x), self._driver_ranges)
        return solved.coordinates[self._name].all

    def inverse(self, theta: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Driver position with three derivatives by the cam angle (4, n) [SI], from the output's y (4, n) [SI].

        Newton's method on y = f(x), then the chain rule solved for x' and the higher derivatives. Raises DesignError at dead centres.
        """
        target, turns = y[0], np.zeros(theta.size)
        if self.period:
            turns = np.floor((target - self._y[0]) / abs(self._gain)) * np.sign(self._gain)
            target = target - turns * self._gain
        self._require_reachable(theta, target)
        x = np.interp(target, self._y, self._x)
        low, high = min(self._x[0], self._x[-1]), max(self._x[0], self._x[-1])
        for _ in range(20):
            f = self._within(x)
            error = f[0] - target
            if self._requested.unit == "deg":
                error = np.remainder(error + np.pi, TURN) - np.pi
            step = error / f[1]
            x = np.clip(x - step, low, high)
            if np.abs(step).max() <= 4e-16 * max(1.0, float(np.abs(x).max())):
                break
        f = self._within(x)
        first = y[1] / f[1]
        second = (y[2] - f[2] * first**2) / f[1]
        third = (y[3] - 3.0 * f[2] * first * second - f[3] * first**3) / f[1]
        return np.array([x + turns * self.period, first, second, third])

    def _within(self, x: np.ndarray) -> np.ndarray:
        return self.forward(np.mod(x, self._cycle) if self._turns and not self._driver_ranges.is_swinging else x)

    def _require_reachable(self, theta: np.ndarray, target: np.ndarray) -> None:
        """Raise DesignError where the output would reach a dead centre."""
        if self.period:
            return
        close = REACHED * (self._y[-1] - self._y[0])
        beyond = (target <= self._y[0] + close) | (target >= self._y[-1] - close)
        if beyond.any():
            scale, unit = self._requested.scale, self._requested.unit
            ends = f"{result_text(self._y[0] / scale, 6)} ... {result_text(self._y[-1] / scale, 6)} {unit}"
            i = int(np.argmax(beyond))
            end = self._x[0] if target[i] <= self._y[0] + close else self._x[-1]
            position = f"{result_text(np.rad2deg(end))} deg" if self._turns else f"{result_text(1e3 * end)} mm"
            raise _error(
                "motion.inverse", f"{result_text(target[i] / scale, 6)} {unit}",
                f"at cam angle {result_text(np.rad2deg(theta[i]))} deg output {self._name} meets a dead centre, the driver at {position}",
                f"between {ends}",
            )  # fmt: skip


def _driven(design: Design) -> Linkage:
    """The linkage with a driver that can have any position; a rotating one becomes a crank."""
    linkage: Linkage = design.drive.posed if isinstance(design.drive.posed, Linkage) else design.drive.linkage
    return replace(linkage, driver=replace(linkage.driver, kind=CRANK)) if driver_turns(linkage) else linkage


def _coordinate(design: Design, output: str, requested: Motion) -> str:
    """Name of an output's coordinate, the slide or the angle of a link. Raises DesignError for another unit than the motion's."""
    from core.mechanism import body_name

    allowed = output_units(design)
    if output not in allowed:
        raise _error("motion.inverse.output", output, "no link of this number moves there", " | ".join(allowed))
    unit = allowed[output]
    if requested.unit != unit:
        problem = f"is in {unit}, but the typed motion is in {requested.unit}"
        raise _error("motion.inverse.output", output, problem, f"start_{unit} and rise_{unit}")
    return f"slide{output}" if unit == "mm" else body_name(int(output))


_MOTIONS: Mapping[str, Callable[[_Request], tuple[Motion, list[str]]]] = MappingProxyType(
    {"from": _table_motion, "sum": _sum_motion, "inverse": _inverse_motion}
)


# -- pieces -----------------------------------------------------------------------------------------------

DEGREE = 12
CLOSE = 2e-13  # of the largest jerk: error at which an interpolant is accepted
MOST_HALVINGS = 7


def _fitted(rows: Rows, parts: Sequence[CompiledMotion], unit: str, advance: float | None) -> Motion:
    """Motion of a function with the pieces of several compiled motions, with a segment between any two of their joins."""
    scale = UNITS[unit].factor
    joins = piece_ends([np.array([join.theta for join in part.joins]) for part in parts])
    ends = piece_ends([part.starts for part in parts])
    segments = []
    for low, high in pairwise(joins.tolist()):
        inner = [low, *(e for e in ends.tolist() if low + 1e-11 < e < high - 1e-11), high]
        level = rows(np.array([low]), 0.5 * (inner[0] + inner[1]))[:, 0]
        rise = float(rows(np.array([high]), 0.5 * (inner[-2] + inner[-1]))[0, 0] - level[0]) / scale
        pieces = [piece for a, b in pairwise(inner) for piece in _pieces(rows, a, b, low, high, level[0], scale)]
        if all(not any(piece.polynomial[1:]) for piece in pieces):
            segments.append(Segment(float(np.rad2deg(high - low)), 0.0))
        else:
            segments.append(Segment(float(np.rad2deg(high - low)), rise, ComputedCurve(tuple(pieces))))
    spans = [round(segment.span_deg, 11) for segment in segments]
    spans[-1] = 360.0 - sum(spans[:-1])
    segments = [replace(segment, span_deg=span) for segment, span in zip(segments, spans, strict=True)]
    return Motion(0.0, tuple(segments), unit, advance)


@lru_cache(maxsize=1)
def _nodes() -> tuple[np.ndarray, np.ndarray]:
    """Chebyshev nodes in 0 ... 1, and their powers."""
    t = 0.5 - 0.5 * np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
    return t, np.vander(t, increasing=True)


def _pieces(
    rows: Rows, a: float, b: float, low: float, high: float, level: float, scale: float, halvings: int = 0
) -> Iterator[Piece]:
    """Pieces over a ... b [rad] of a segment from low to high [rad] with the level at its start; halved until they are accurate."""
    t, powers = _nodes()
    width, inside = b - a, 0.5 * (a + b)
    jerk = rows(a + width * t, inside)[3]
    coefficients = np.linalg.solve(powers, jerk)
    between = np.array([0.0, *(0.5 * (t[1:] + t[:-1])), 1.0])
    true = rows(a + width * between, inside)
    error = np.abs(np.polynomial.polynomial.polyval(between, coefficients) - true[3]).max()
    rounding = 1e-15 * np.abs(true[:3]).max(axis=1) @ (width ** np.array([-3.0, -2.0, -1.0])) if halvings > 3 else 0.0
    if error > CLOSE * np.abs(jerk).max() + rounding and halvings < MOST_HALVINGS:
        yield from _pieces(rows, a, inside, low, high, level, scale, halvings + 1)
        yield from _pieces(rows, inside, b, low, high, level, scale, halvings + 1)
        return
    start, k = true[:, 0], np.arange(DEGREE + 1)
    integral = width**3 * coefficients / ((k + 1) * (k + 2) * (k + 3))
    polynomial = np.array([start[0] - level, start[1] * width, 0.5 * start[2] * width**2, *integral]) / scale
    span = high - low
    yield Piece((a - low) / span, tuple((polynomial * (span / width) ** np.arange(polynomial.size)).tolist()))
