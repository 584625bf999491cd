"""Many designs at once: one design with some of its numbers varied, and what is asked of a quantity over the turn of each.

The stages are those of one design. Their axis of angles carries the nodes of all designs one after the other, and a number that is
varied stands in the design as a ``Column``. What cannot be taken so (``together`` says what) is computed design by design.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from functools import cached_property, lru_cache, partial
from math import ceil
from typing import Any, NamedTuple

import numpy as np

from core import cam, dynamics
from core.design import Design, Motion, edited, entries, put, row_at
from core.errors import NoAnswer, noting
from core.followers import BUILDERS
from core.frozen import frozen
from core.mechanism import DriverRanges, SolutionPlan, at_driver, swept
from core.mechanism.change_points import Branch
from core.mechanism.driver_ranges import PATH
from core.mechanism.solving import solve
from core.motion import TURN, Angles, MotionState, Program
from core.motion.cuts import CutProgram
from core.motion.extremes import Extreme, Range
from core.numerics.columns import column, taken
from core.numerics.derivatives import Derivatives
from core.study.contact_stress import roller_lives
from core.study.extremes import PROFILE_CURVATURES, exists, extremes_of, undercut_on
from core.study.highest import Search, refined
from core.study.quantities import OF_MOTOR, names_of, quantity
from core.study.study import Study
from core.units import split_unit

NO_VALUE, UNDERCUT, OUT_OF_RANGE = "no-value", "undercut", "out-of-range"
"""Reasons beside the codes of errors and findings: the design has no such quantity, as a stress where nothing fits; what touches the cam
is undercut, and the values are as they come; a number lies outside the range of its field."""

OVER_TURN = ("max", "min", "abs", "rms", "mean", "range")
"""What can be asked of a quantity over the turn: its largest and least value, the largest of either sign, root mean square, mean, and
largest less least value."""

TOTALS: Mapping[str, Callable[[Study], float]] = {
    "flywheel_inertia_kg_m2": lambda study: study.flywheel.needed_inertia,
    "energy_j": lambda study: study.flywheel.energy_swing,
    "life_hours": lambda study: min((life.hours for life in roller_lives(study)), default=np.nan),
}
"""Totals of a turn: the flywheel that keeps the fluctuation, the energy that it takes up and gives back, life of the shortest-lived
roller."""

POINTS = 60_000  # cam angles of a block: its arrays stay in the cache, and take far less than 256 MiB
DENSE, SPARSE = np.deg2rad(3.6), np.deg2rad(15.0)  # mean distance of nodes, in a dwell
LEAST, MOST = 13, 129  # nodes of a piece
BY_ROUNDING = 1e-9  # of an extreme: of values that are equal to that the smallest cam angle is named


@frozen(eq=False)
class Many:
    """Of m designs: what was asked -> value (m,), and cam angle [deg] (m,) of an extreme, else NaN; in the unit of the quantity's column.

    reason  (m,) why a design has no value, or none to build by: code of the error or finding; else empty
    """

    value: Mapping[str, np.ndarray]
    angle_deg: Mapping[str, np.ndarray]
    reason: np.ndarray


class Asked(NamedTuple):
    """One thing asked: its key as given; the quantity, what of it over the turn, and its unit in SI; a total has no quantity."""

    key: str
    name: str
    of: str
    unit: float


class _Results(NamedTuple):
    """Of the designs of a block: rows as what is asked, (k, m)."""

    value: np.ndarray
    theta: np.ndarray
    reason: np.ndarray


def many(
    design: Design,
    values: Mapping[str, Any],
    quantities: Sequence[str],
    *,
    polish: bool = True,
    executor: Any = None,
) -> Many:
    """What is asked of each of m designs, which differ in the numbers at some paths.

    values      path -> (m,), in the unit of the field, as ``design.put`` takes it
    quantities  ``"<column>:max"``, or min, abs, rms, mean, range (``OVER_TURN``) of a quantity by its column, as
                ``pressure_angle_deg:max``; or one of ``TOTALS``
    polish      extremes are refined; without it they are those of the nodes, to about 1e-3
    executor    any of the shape of ``concurrent.futures.Executor``; values do not depend on it

    A design that has no answer is NaN, with its reason. Raises ValueError for what cannot be asked.
    """
    infos = {path: _info(design, path) for path in values}
    given, asked = _given(values, infos), [asked_of(design, each) for each in quantities]
    if not asked:
        raise ValueError("quantities: none is asked for")
    rows = np.array(list(given.values()))
    size = _block_size(design)
    parts = [rows[:, first : first + size] for first in range(0, rows.shape[1], size)]
    work = partial(_block, design, infos, tuple(asked), polish)
    if executor is None:
        found = [work(part) for part in parts]
    else:
        found = [future.result() for future in [executor.submit(work, part) for part in parts]]
    value, theta = (np.concatenate(rows, axis=1) for rows in zip(*((f.value, f.theta) for f in found), strict=True))
    return Many(
        {each.key: value[i] / each.unit for i, each in enumerate(asked)},
        {each.key: np.rad2deg(theta[i]) for i, each in enumerate(asked)},
        np.concatenate([f.reason for f in found]),
    )


# -- what is given and asked -------------------------------------------------------------------------------


def _given(values: Mapping[str, Any], infos: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """The columns as numbers (m,). Raises ValueError, naming the path."""
    if not values:
        raise ValueError("values: no path is varied")
    found: dict[str, np.ndarray] = {}
    for path, each in values.items():
        info, rows = infos[path], np.asarray(each)
        if info is None or info.choices or info.whole or info.flag:
            raise ValueError(f"{path}: only a number that need not be whole can be varied")
        if rows.dtype.kind not in "iuf":
            raise ValueError(f"{path}: numbers are needed, not {rows.dtype}")
        if rows.ndim != 1 or not rows.size:
            raise ValueError(f"{path}: a list of numbers is needed, at least one; it has the shape {rows.shape}")
        first, other = next(iter(found.items()), (path, rows))
        if rows.size != other.size:
            raise ValueError(f"{path}: {rows.size} values, but {first} has {other.size}: as many are needed")
        found[path] = rows.astype(float)
    return found


def _info(design: Design, path: str) -> Any:
    for name in design.tables:
        for entry in entries(design, name):
            if entry.path == path:
                return entry.info
    raise ValueError(f"{path}: no such number in this design")


def asked_of(design: Design, key: str) -> Asked:
    """What a key asks. Raises ValueError, naming it."""
    if key in TOTALS:
        return Asked(key, "", key, 1.0)
    slug, _, of = key.partition(":")
    if of not in OVER_TURN:
        raise ValueError(f"{key}: asked is <column>:{'|'.join(OVER_TURN)}, or {', '.join(TOTALS)}")
    name = "" if design.listed else _columns(design).get(slug, "")
    if not name or quantity(name).turns:
        raise ValueError(f"{key}: this design has no such column with extremes")
    return Asked(key, name, of, split_unit(slug)[1].factor)


@lru_cache(maxsize=16)
def _columns(design: Design) -> Mapping[str, str]:
    """Column, by whose unit a value counts -> quantity."""
    rows = (quantity(name) for name in names_of(design))
    return {row.slug.format(m=design.drive.motion_unit): row.name for row in rows if row.slug}


# -- design by design --------------------------------------------------------------------------------------


def _one(design: Design, asked: Sequence[Asked]) -> tuple[list[float], list[float], str]:
    """Values, cam angles [rad] and reason of a single design."""
    study, reasons = Study(design), []
    values, thetas = [np.nan] * len(asked), [np.nan] * len(asked)
    for i, each in enumerate(asked):
        try:
            values[i], thetas[i] = _asked_of_one(study, each)
        except NoAnswer as error:
            reasons.append(error.code)
        except _NoValue as error:
            reasons.append(str(error))
    if (
        not reasons
        and "cam" in study.stages
        and any(a.name and quantity(a.name).stage in ("cam", "dynamics") for a in asked)
    ):
        reasons += [UNDERCUT for flank in study.cam.flanks if undercut_on(study, flank.name)]
    return values, thetas, reasons[0] if reasons else ""


class _NoValue(Exception):
    """A design that could have a value has none; its reason."""


def _asked_of_one(study: Study, asked: Asked) -> tuple[float, float]:
    if not asked.name:
        return float(TOTALS[asked.of](study)), np.nan
    row = quantity(asked.name)
    if row.stage == "dynamics" and study.jam is not None:
        raise _NoValue(dynamics.jam_finding(study.jam, study.jamming_pair).code)
    if not exists(study, row):
        raise _NoValue(UNDERCUT if row.fitting else NO_VALUE)
    if asked.of in ("rms", "mean"):
        angles, weight = nodes_of(study.program)
        return _mean(np.broadcast_to(row.value(study.at(angles)), angles.theta.size), weight, asked.of), np.nan
    found = extremes_of(study, row.stage, (asked.name,))[asked.name]
    value, theta = _of_range(asked.of, *((each.value, each.theta) for each in (found.low, found.high)))
    return float(value), float(theta)


def _mean(values: np.ndarray, weight: np.ndarray, of: str) -> Any:
    """Mean or root mean square over the turn of values (..., n) at nodes of these weights (n,)."""
    return np.sqrt((values * values * weight).sum(axis=-1)) if of == "rms" else (values * weight).sum(axis=-1)


def _of_range(of: str, low: tuple[Any, Any], high: tuple[Any, Any]) -> tuple[Any, Any]:
    """Value and cam angle of what is asked, from the least and the largest value with theirs."""
    if of == "range":
        return high[0] - low[0], np.full(np.shape(high[0]), np.nan)
    if of == "abs":
        upper = np.abs(high[0]) >= np.abs(low[0])
        return np.where(upper, np.abs(high[0]), np.abs(low[0])), np.where(upper, high[1], low[1])
    return low if of == "min" else high


# -- nodes -------------------------------------------------------------------------------------------------


def nodes_of(program: Any) -> tuple[Angles, np.ndarray]:
    """Nodes (n,) of one turn by which extremes are bracketed, and the weights (n,) of a mean: of every piece those of Clenshaw and
    Curtis, both its ends among them."""
    theta, piece, weight = [], [], []
    moves = np.broadcast_to(getattr(program, "velocity_signs", 1.0), program.starts.shape) != 0.0
    for i, (a, b) in enumerate(zip(program.starts.tolist(), program.ends.tolist(), strict=True)):
        count = min(max(ceil((b - a) / (DENSE if moves[i] else SPARSE)) | 1, LEAST if moves[i] else 5), MOST)
        x, w = _clenshaw_curtis(count)
        theta.append(a + (b - a) * x)
        theta[-1][-1] = b
        weight.append(w * ((b - a) / TURN))
        piece.append(np.full(count, i))
    return Angles(np.concatenate(theta), np.concatenate(piece)), np.concatenate(weight)


@lru_cache(maxsize=128)
def _clenshaw_curtis(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes 0 ... 1 (count,), an odd number of them, and their weights."""
    n = count - 1
    k = np.arange(count)
    x = np.sin(0.5 * np.pi * k / n) ** 2
    j = np.arange(1, n // 2 + 1)
    b = np.where(2 * j == n, 1.0, 2.0) / (4.0 * j * j - 1.0)
    w = (1.0 - (np.cos(2.0 * np.pi * np.outer(k, j) / n) * b).sum(axis=1)) / n
    w[[0, -1]] *= 0.5
    return x, w


def _block_size(design: Design) -> int:
    """Designs of a block; it depends on nothing that is varied."""
    motion = design.drives[0].motion
    points = 128 if motion is None or len(design.drives) > 1 else nodes_of(Study(design).uncut)[0].theta.size
    return max(1, POINTS // points)


# -- together ----------------------------------------------------------------------------------------------

_MOTION = "motion."
_VARIED = ("follower.", "cam.", "loads.", "shaft.", _MOTION)
_SWITCHES = re.compile(r"loads\.process\[\d+\]\.(cam_|position_|points)")
"""When a process force works, by which the turn is cut into pieces."""
_READS_CENTRES = frozenset({"instant_centre", "instant_centre_x", "instant_centre_y", "instant_centre_velocity"})


def together(design: Design, paths: Sequence[str], asked: Asked) -> bool:
    """Whether what is asked of designs that differ in these paths is computed of all at once: lengths, angles, masses, springs,
    friction and speed of a follower, and quantities that follow at each angle by itself."""
    if design.listed or design.drive.links or not asked.name:
        return False
    row = quantity(asked.name)
    return (
        all(path.startswith(_VARIED) and not _SWITCHES.match(path) for path in paths)
        and not (design.drive.loads.process and any(path.startswith(_MOTION) for path in paths))
        and row.stage in ("motion", "linkage", "cam", "dynamics")
        and asked.name not in OF_MOTOR | _READS_CENTRES
        and not row.needs.startswith("elastic")
    )


def _block(
    design: Design, infos: Mapping[str, Any], asked: tuple[Asked, ...], polish: bool, rows: np.ndarray
) -> _Results:
    """What is asked of the designs with these numbers (p, m)."""
    paths, m = tuple(infos), rows.shape[1]
    found = _Results(np.full((len(asked), m), np.nan), np.full((len(asked), m), np.nan), np.full(m, "", dtype=object))
    inside = np.all([_admitted(info, row) for info, row in zip(infos.values(), rows, strict=True)], axis=0)
    for k in np.flatnonzero(inside).tolist() if any(path.startswith(_MOTION) for path in paths) else ():
        segments = _motion_of(_varied(design, paths, rows[:, k].tolist())).segments
        inside[k] = all(segment.span_deg > 0.0 for segment in segments)
    found.reason[~inside] = OUT_OF_RANGE
    good = np.flatnonzero(inside)
    if not good.size:
        return found
    chosen = np.array([together(design, paths, each) for each in asked])
    at_once, alone = np.flatnonzero(chosen), np.flatnonzero(~chosen)
    further = {int(k): alone for k in good} if alone.size else {}
    if at_once.size:
        block = _Together(design, paths, rows[:, good])
        part = block.results([asked[i] for i in at_once], polish)
        found.value[np.ix_(at_once, good)], found.theta[np.ix_(at_once, good)] = part.value, part.theta
        found.reason[good] = part.reason
        for k in good[block.turns_back].tolist():
            further[k], found.reason[k] = np.arange(len(asked)), ""
    for k, which in further.items():
        values, thetas, reason = _one(_varied(design, paths, rows[:, k].tolist()), [asked[i] for i in which])
        found.value[which, k], found.theta[which, k] = values, thetas
        found.reason[k] = found.reason[k] or reason
    return found


def _varied(design: Design, paths: Sequence[str], numbers: Sequence[Any]) -> Design:
    """The design with these numbers; a span or a rise takes from segments that are not varied what it gains, as where it is typed."""
    kept = {row_at(path)[1] for path in paths if path.startswith(_MOTION)}
    for path, number in zip(paths, numbers, strict=True):
        change = path.startswith(_MOTION)
        design = edited(design, path, number, kept) if change else put(design, path, number)
    return design


def _motion_of(design: Design) -> Motion:
    assert design.drive.motion is not None, "a path of a motion"
    return design.drive.motion


def _admitted(info: Any, row: np.ndarray) -> np.ndarray:
    """Whether each number (m,) lies in the range of its field."""
    above = row > info.low if info.open_low else row >= info.low
    return np.asarray(above & (row <= info.high) & np.isfinite(row))


class _Motions:
    """The motions of m designs, of as many pieces each: one after the other in one table.

    other  (m,) designs whose motion has another number of pieces; in their place stands that of the first that has not
    """

    def __init__(self, programs: Sequence[Program]) -> None:
        count = np.array([each.starts.size for each in programs])
        self.pieces = int(np.bincount(count).argmax())
        self.other = count != self.pieces
        first = programs[int(np.argmin(self.other))]
        self.programs = [first if other else each for each, other in zip(programs, self.other.tolist(), strict=True)]
        self._stacked = Program.stacked(self.programs)
        self.starts, self.ends = (each.reshape(-1, self.pieces) for each in (self._stacked.starts, self._stacked.ends))

    def stretched(self, plain: Any) -> np.ndarray:
        """How much longer each piece is than that of the plain motion (m, p)."""
        return np.asarray((self.ends - self.starts) / (plain.ends - plain.starts))

    def own(self, plain: Any, theta: np.ndarray, piece: np.ndarray, owner: np.ndarray) -> np.ndarray:
        """The cam angles of designs where their pieces are gone through as far as those of the plain motion at angles (n,)."""
        part = (theta - plain.starts[piece]) / (plain.ends - plain.starts)[piece]
        first, last = self.starts[owner, piece], self.ends[owner, piece]
        return np.where(theta == plain.ends[piece], last, first + (last - first) * part)

    def state(self, theta: np.ndarray, piece: np.ndarray, owner: np.ndarray) -> MotionState:
        """At their own angles (n,)."""
        return self._stacked.state(Angles(theta, owner * self.pieces + piece))


class _Turning:
    """The angle of a link of m designs without jumps: all its swing lies within half a turn of its middle (m,)."""

    def __init__(self, middle: Callable[[], np.ndarray], owner: np.ndarray) -> None:
        self._middle, self._owner = middle, owner

    def of(self, q: Derivatives, angle: Derivatives) -> Derivatives:
        """As ``Turning.of``."""

        def first() -> np.ndarray:
            own = angle[0]
            return np.asarray(own - TURN * np.rint((own - self._middle()[self._owner]) / TURN))

        return Derivatives(lambda order: angle[order] if order else first())


class _Together:
    """The designs of a block: the parts of a study with a column (m,) for each number that is varied."""

    def __init__(self, design: Design, paths: tuple[str, ...], rows: np.ndarray) -> None:
        self.plain, self.count = design, rows.shape[1]
        self.reason = np.full(self.count, "", dtype=object)
        self.nobody = np.zeros(self.count, dtype=bool)
        self.lost: dict[str, np.ndarray] = {}
        self._owner: np.ndarray | None = None
        self._stage = "linkage"
        moving = [i for i, path in enumerate(paths) if path.startswith(_MOTION)]
        for i in set(range(len(paths))) - set(moving):
            design = put(design, paths[i], column(rows[i]))
        self.design, drive = design, design.drive
        own = (
            [_varied(self.plain, [paths[i] for i in moving], row) for row in rows[moving].T.tolist()] if moving else []
        )
        self.motions = _Motions([Program(_motion_of(each)) for each in own]) if own else None
        uncut = Study(self.plain).uncut
        switches = tuple(sorted(Study(self.plain).loading.cuts(uncut).tolist()))
        self.program: Any = CutProgram(uncut, switches) if switches else uncut
        self.turns_back = self.nobody if self.motions is None else self.motions.other
        with noting(self._note), np.errstate(all="ignore"):
            row = BUILDERS[type(drive.mechanism)]
            self.mechanism = row.build(*row.needs(drive.mechanism, drive.cam))
            self.loading = dynamics.loading_of(drive.mechanism, drive.loads, self.mechanism)

    def _note(self, code: str, lost: Any) -> None:
        """Which designs have no answer from a stage on."""
        lost = np.asarray(lost)
        which = self.nobody.copy()
        if self._owner is None or lost.size == 1:
            which |= lost
        else:
            which[self._owner[np.broadcast_to(lost, self._owner.shape)]] = True
        self.lost[self._stage] = self.lost.get(self._stage, self.nobody) | which
        self._because(which, code)

    def _because(self, which: np.ndarray, code: str) -> None:
        self.reason[which & (self.reason == "")] = code

    # -- values ---------------------------------------------------------------------------------------------

    def study(self, state: MotionState, owner: np.ndarray) -> Study:
        """A study of all at the positions of a motion (n,), of which each belongs to the design ``owner`` (n,)."""
        made: dict[int, Any] = {}
        there = Study(taken(self.design, owner, made), angles=state.angles)
        mechanism = self._mechanism_at(owner, made)
        turning: Any = {link: _Turning(partial(self._middle, link), owner) for link in self.mechanism.angles}
        driver_ranges = DriverRanges(mechanism.plan, 0.0, 0.0, (), (), Branch(0.0), turning)
        loading = taken(self.loading, owner, made)
        vars(there).update(
            program=self.program, drive=state, mechanism=mechanism, driver_ranges=driver_ranges, loading=loading
        )
        return there

    def _mechanism_at(self, owner: np.ndarray, made: dict[int, Any]) -> Any:
        own, plan = self.mechanism, self.mechanism.plan
        names = [f.name for f in fields(own) if f.name not in ("linkage", "base", "angles")]
        there = replace(own, **{name: taken(getattr(own, name), owner, made) for name in names})
        parts = {name: taken(getattr(plan, name), owner, made) for name in ("points", "driver", "steps", "sides")}
        vars(there)["plan"] = SolutionPlan(linkage=plan.linkage, **parts)
        return there

    @cached_property
    def _middles(self) -> Mapping[int, np.ndarray]:
        """Middle of the swing of every link whose angle is counted from the base position (m,) [rad]."""
        programs = [self.program] if self.motions is None else self.motions.programs
        y = np.broadcast_to([np.linspace(*swept(each), PATH) for each in programs], (self.count, PATH))
        owner, row = np.repeat(np.arange(self.count), PATH), np.arange(self.count)
        there = self._mechanism_at(owner, {})
        q = there.start + there.sense * y.ravel()
        poses = solve(there.plan, at_driver(np.asarray(q)), Branch(0.0)).poses
        found = {}
        for link, first in self.mechanism.angles.items():
            angle = np.unwrap(np.broadcast_to(poses[link].turn[0], owner.shape).reshape(-1, PATH), axis=1)
            i = np.clip((y <= 0.0).sum(axis=1), 1, PATH - 1)
            part = (0.0 - y[row, i - 1]) / (y[row, i] - y[row, i - 1])
            base = angle[row, i - 1] + part * (angle[row, i] - angle[row, i - 1])
            angle = angle + (TURN * np.rint((first - base) / TURN))[:, None]
            found[link] = np.asarray(0.5 * (angle.max(axis=1) + angle.min(axis=1)))
        return found

    def _middle(self, link: int) -> np.ndarray:
        return self._middles[link]

    def values(self, names: Sequence[str], state: MotionState, owner: np.ndarray) -> dict[str, np.ndarray]:
        """The quantities (n,), by name, and the jamming factor as ``jam``. What has no answer is noted."""
        there, self._owner = self.study(state, owner), owner
        with noting(self._note), np.errstate(all="ignore"):
            for self._stage in ("linkage", "cam", "dynamics"):
                if any(_STAGES.index(_stage_of(name)) >= _STAGES.index(self._stage) for name in names):
                    getattr(there, self._stage)
            if any(_stage_of(name) == "dynamics" for name in names):
                self._look_for_turns(there)
            rows = {name: there.dynamics.jam if name == JAM else quantity(name).value(there) for name in names}
            return {name: np.broadcast_to(np.asarray(row), owner.shape) for name, row in rows.items()}

    def _look_for_turns(self, there: Study) -> None:
        """Designs in which a pair that rubs slips one way and then the other: their turn is cut there, which that of others is not."""
        assert self._owner is not None
        for friction in self.loading.frictions:
            if friction.pair != there.linkage.driver_name:
                slip = np.broadcast_to(there.linkage.slip(friction.pair), self._owner.shape)
                both = [np.bincount(self._owner[sign * slip > 0.0], minlength=self.count) > 0 for sign in (-1.0, 1.0)]
                self.turns_back = self.turns_back | (both[0] & both[1])

    # -- what is asked --------------------------------------------------------------------------------------

    def results(self, asked: Sequence[Asked], polish: bool) -> _Results:
        """Of each design."""
        angles, weight = nodes_of(self.program)
        if self.motions is not None:
            weight = weight * self.motions.stretched(self.program)[:, angles.piece]
        stages = {quantity(each.name).stage for each in asked}
        searches = dict.fromkeys((each.name, side) for each in asked for side in _SIDES[each.of])
        further = self._further(stages)
        searches |= dict.fromkeys(further)
        names = list(dict.fromkeys([*(each.name for each in asked), *(name for name, _ in further)]))
        sampled = self._at_nodes(names, angles)
        found = refined(
            [Search(name, side) for name, side in searches],
            sampled,
            angles,
            lambda theta, piece, owner: self.values(names, self._state(theta, piece, owner), owner),
            polish,
        )
        extremes = {
            name: Range(*(_ends(found.get(Search(name, side), _NOT_ASKED)) for side in (-1.0, 1.0)))
            for name in dict.fromkeys(name for name, _ in searches)
        }
        undercut = self._undercut(extremes) if "cam" in stages or "dynamics" in stages else {}
        for flank, curvature in PROFILE_CURVATURES.items():
            if curvature in extremes and flank in undercut:
                extremes[curvature] = _through_cusp(extremes[curvature], undercut[flank])
        anywhere = np.any(list(undercut.values()), axis=0) if undercut else self.nobody
        if (JAM, 1.0) in searches:
            jams = np.asarray(extremes[JAM].high.value >= dynamics.JAMS)
            self._stage, self.lost["dynamics"] = "dynamics", self.lost.get("dynamics", self.nobody) | jams
            self._because(jams, self._jam_code())
        self._because(anywhere, UNDERCUT)
        value, theta = [], []
        for each in asked:
            row = quantity(each.name)
            if each.of in ("rms", "mean"):
                one: tuple[Any, Any] = _mean(sampled[each.name], weight, each.of), np.full(self.count, np.nan)
            else:
                ends = extremes[each.name]
                one = _of_range(each.of, (ends.low.value, ends.low.theta), (ends.high.value, ends.high.theta))
            nothing = self._lost_at(row.stage) | (anywhere if row.fitting else False)
            value.append(np.where(nothing, np.nan, one[0]))
            theta.append(np.where(nothing, np.nan, one[1]))
        places = np.array(theta)
        if self.motions is not None:
            at = np.where(np.isnan(places), 0.0, places)
            own = self.motions.own(
                self.program, at, self.program.angles(at.ravel()).piece.reshape(at.shape), np.arange(self.count)
            )
            places = np.where(np.isnan(places), np.nan, own)
        return _Results(np.array(value), places, self.reason)

    def _state(self, theta: np.ndarray, piece: np.ndarray, owner: np.ndarray) -> MotionState:
        """The motion of each design at cam angles of the plain one (n,)."""
        if self.motions is None:
            state: MotionState = self.program.state(Angles(theta, piece))
            return state
        return self.motions.state(self.motions.own(self.program, theta, piece, owner), piece, owner)

    def _at_nodes(self, names: Sequence[str], angles: Angles) -> dict[str, np.ndarray]:
        """The quantities at the nodes of every design (m, n): the motion is the same for all."""
        n, m = angles.theta.size, self.count
        if self.motions is not None:
            owner = np.repeat(np.arange(m), n)
            found = self.values(names, self._state(np.tile(angles.theta, m), np.tile(angles.piece, m), owner), owner)
            return {name: row.reshape(m, n) for name, row in found.items()}
        state = self.program.state(angles)
        unit = angles.unit

        def spread(row: np.ndarray) -> np.ndarray:
            return np.tile(row, m)

        every = Angles(spread(angles.theta), spread(angles.piece), unit=lambda: spread(unit))
        moved = Derivatives(lambda order: spread(state.displacement[order]))
        within = lambda: np.tile(state.within, (1, m))  # noqa: E731
        every_state = MotionState(every, moved, spread(state.velocity_sign), within)
        found = self.values(names, every_state, np.repeat(np.arange(m), n))
        return {name: row.reshape(m, n) for name, row in found.items()}

    def _lost_at(self, stage: str) -> np.ndarray:
        before = _STAGES[1 : _STAGES.index(stage) + 1]
        return np.any([self.nobody, *(self.lost[s] for s in before if s in self.lost)], axis=0)

    def _further(self, stages: set[str]) -> list[tuple[str, float]]:
        """What tells of errors: whether friction jams, whether a flank is undercut."""
        found = [(JAM, 1.0)] if "dynamics" in stages and self.loading.rubs else []
        if stages & {"cam", "dynamics"}:
            drive, reads = self.plain.drive, _Reads()
            for flank in self._flanks():
                cam.undercut(reads, flank, drive.face, drive.cam)
            found += reads.read
        return found

    def _flanks(self) -> tuple[str, ...]:
        return cam.form_row(self.plain.drive.cam.form).flanks

    def _undercut(self, extremes: Mapping[str, Range]) -> dict[str, np.ndarray]:
        """Flank -> which designs (m,)."""
        drive, programs = self.design.drive, [self.program] if self.motions is None else self.motions.programs
        corners = np.array([any(join.jumps[:2].any() for join in each.joins) for each in programs])
        with np.errstate(all="ignore"):
            return {
                flank: np.asarray(cam.undercut(extremes, flank, drive.face, drive.cam)) | corners
                for flank in self._flanks()
            }

    def _jam_code(self) -> str:
        friction = next(iter(self.loading.frictions), None)
        return dynamics.jam_finding(Extreme(1.0, 0.0), friction).code


_STAGES = ("motion", "linkage", "cam", "dynamics")
JAM = "jam"
_NOT_ASKED = np.zeros(0), np.zeros(0)
_SIDES = {"max": (1.0,), "min": (-1.0,), "abs": (-1.0, 1.0), "range": (-1.0, 1.0), "rms": (), "mean": ()}


def _stage_of(name: str) -> str:
    return "dynamics" if name == JAM else quantity(name).stage


def _ends(found: tuple[np.ndarray, np.ndarray]) -> Extreme:
    """Of m designs at once."""
    return Extreme(*found)  # type: ignore[arg-type]


def _through_cusp(found: Range, there: np.ndarray) -> Range:
    """As of one design: a curvature grows without limit at a cusp, and comes back from below where the profile runs backwards."""
    low, high = found.low, found.high
    return Range(
        Extreme(np.where(there & (low.value < 0.0), -np.inf, low.value), low.theta),  # type: ignore[arg-type]
        Extreme(np.where(there, np.inf, high.value), high.theta),  # type: ignore[arg-type]
    )


class _Reads(dict[str, Any]):
    """In place of extremes: which sides of which quantities are read."""

    def __init__(self) -> None:
        super().__init__()
        self.read: list[tuple[str, float]] = []

    def __missing__(self, name: str) -> Any:
        return _Side(name, self.read)


class _Side:
    def __init__(self, name: str, read: list[tuple[str, float]]) -> None:
        self._name, self._read = name, read

    @property
    def low(self) -> Extreme:
        self._read.append((self._name, -1.0))
        return Extreme(np.nan, np.nan)

    @property
    def high(self) -> Extreme:
        self._read.append((self._name, 1.0))
        return Extreme(np.nan, np.nan)
