"""Many designs at once, through the stages of one.

Their axis of angles carries the nodes of all designs one after the other, and a number that is varied stands in the design as a
``Column``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields, replace
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np

from core import cam, dynamics
from core.design import FRAME_LINK, Design, Motion, get, put
from core.errors import collecting_failures
from core.followers import BUILDERS
from core.mechanism import CrankMotion, DriverRange, DriverRanges, SolutionPlan, at_driver, motion_extent
from core.mechanism.branches import Branch
from core.mechanism.driver_ranges import PATH, SIDED, near_zero
from core.mechanism.drivers import with_margin
from core.mechanism.mechanism import solve
from core.motion import TURN, Angles, CompiledMotion, MotionState, program
from core.motion.curves import has_common_pieces, with_all_pieces
from core.motion.extremes import Extreme, Extremes
from core.motion.program import SubdividedTurn
from core.numerics.derivatives import Derivatives, cross, replace_nan
from core.numerics.lazy import ColumnMap, at_owners, column, map_columns, one_design, part_mapper, repeated_values
from core.study.extremes import PROFILE_CURVATURES
from core.study.highest import Search, nodes_of, refined
from core.study.quantities import quantity
from core.study.quantity_requests import QuantityRequest, extreme_statistic, mean_statistic
from core.study.study import Study

POINTS = 180_000
"""Positions at a time: fewer cost more calls of numpy, more leave the memory that a process keeps."""
THROUGH, CLEAR = (
    97,
    5e-3,
)  # positions through which a linkage is followed; what it has left there, of its size, where nothing happens
DOUBT = 0.02  # of an extreme between nodes
SearchResults = dict[Search, tuple[np.ndarray, np.ndarray]]
"""Value and cam angle [rad], both (m,)."""
_WHOLE = DriverRanges(None, (DriverRange(0.0, TURN),), (), Branch(), {})  # type: ignore[arg-type]

SPEED_OF_DRIVER = "linkage.driver.speed_rpm"  # whose sign is the sense of rotation
NO_VALUE, UNDERCUT = "no-value", "undercut"
"""Reasons beside the codes of errors: the design has no such quantity, as a stress where nothing fits; what touches the cam is undercut,
and the values are as they come."""


class Results(NamedTuple):
    """Of the designs of a block: rows as what is asked, (k, m)."""

    value: np.ndarray
    theta: np.ndarray
    reason: np.ndarray


class Motions:
    """The motions of m designs, of as many pieces each as the plain one: one after the other in one table.

    other  (m,) designs whose motion has another number of pieces; in their place stands the plain one
    """

    def __init__(self, plain: CompiledMotion, motion: Motion, count: int) -> None:
        """motion: with a column (count,) for each number that is varied."""
        self._plain, self.other = plain, np.zeros(count, dtype=bool)
        self._alike = has_common_pieces(motion)
        if self._alike:
            self._stacked = CompiledMotion.from_columns(motion, count)
        else:  # their pieces depend on span and rise, or on a number of the curve
            self._stacked = self._one_by_one([CompiledMotion(map_columns(motion, one_design(k))) for k in range(count)])
        self.starts, self.ends = (each.reshape(count, -1) for each in (self._stacked.starts, self._stacked.ends))
        self.pieces = self.starts.shape[1]

    def _one_by_one(self, programs: Sequence[CompiledMotion]) -> CompiledMotion:
        self.other = np.array([each.starts.size != self._plain.starts.size for each in programs])
        return CompiledMotion.stacked(
            [self._plain if o else each for each, o in zip(programs, self.other.tolist(), strict=True)]
        )

    @property
    def corners(self) -> np.ndarray:
        """Motions whose displacement or velocity jumps (m,): none where every segment begins and ends at rest, however long it is."""
        if self._alike and self._plain.is_rest_to_rest:
            return np.zeros(self.starts.shape[0], dtype=bool)
        _, _, jumps = self._stacked.jumps(self.starts.shape[0], orders=2)
        return np.asarray(jumps.reshape(2, self.starts.shape[0], -1).any(axis=(0, 2)))

    def stretched(self) -> np.ndarray:
        """How much longer each piece is than that of the plain motion (m, p)."""
        return np.asarray((self.ends - self.starts) / (self._plain.ends - self._plain.starts))

    def own(self, theta: np.ndarray, piece: np.ndarray, owner: np.ndarray) -> np.ndarray:
        """The cam angles of designs where their pieces are gone through as far as those of the plain motion at angles (n,)."""
        at, plain = self._taken(piece, owner), self._plain
        part = (theta - plain.starts[piece]) / (plain.ends - plain.starts)[piece]
        found = at(self.starts) + at(self.ends - self.starts) * part
        last = theta == plain.ends[piece]
        of = owner if owner.ndim > 1 else np.broadcast_to(owner, last.shape)[last]
        found[..., last] = self.ends[of, piece[last]]
        return found

    def _taken(self, piece: np.ndarray, owner: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """What each piece of each motion has, (m, p) or one after the other, at pieces (n,) of the designs ``owner``, (n,) or (m, 1)."""
        if owner.ndim > 1:
            first = np.flatnonzero(np.diff(piece, prepend=-1))  # stretches of angles within one piece
            each, own = np.diff(first, append=piece.size), (owner, piece[first])
            return lambda row: np.repeat(row.reshape(-1, self.pieces)[own], each, axis=1)
        at = owner * self.pieces + piece
        return lambda row: row.ravel()[at]

    def state(self, angles: Angles, owner: np.ndarray) -> MotionState:
        """Where the plain motion is at angles (n,), of the designs ``owner``, (n,) or (m, 1)."""
        there = Angles(self.own(angles.theta, angles.piece, owner), owner * self.pieces + angles.piece)
        if self._alike:
            return self._stacked.state_from_curve(self._plain.curve(angles), there, self._taken(angles.piece, owner))
        flat = self._stacked.state(Angles(there.theta.ravel(), there.piece.ravel()))
        moved = Derivatives(lambda order: flat.displacement[order].reshape(there.theta.shape))
        return MotionState(there, moved, flat.velocity_sign.reshape(there.theta.shape))

    def motion_extent(self) -> tuple[np.ndarray, np.ndarray]:
        """As of one design, (m,) each."""
        every = np.arange(self.starts.size)
        ends = (self._stacked.state(Angles(theta.ravel(), every)) for theta in (self.starts, self.ends))
        return with_margin(np.concatenate([e.displacement[0].reshape(self.starts.shape) for e in ends], axis=1))


class AboutMiddle:
    """In place of an ``UnwrappedAngle``: that of a link of m designs, all whose swing lies within half a turn of its middle (m,)."""

    def __init__(self, middle: Callable[[], np.ndarray], owner: np.ndarray) -> None:
        self._middle, self._owner = middle, owner

    def unwrapped(self, q: Derivatives, angle: Derivatives) -> Derivatives:
        """As `UnwrappedAngle.unwrapped`."""

        def first() -> np.ndarray:
            own = angle[0]
            return np.asarray(own - TURN * np.rint((own - self._middle()[self._owner]) / TURN))

        return Derivatives(lambda order: angle[order] if order else first())


class Along:
    """In place of an ``UnwrappedAngle``: that of a link of m designs by samples (m, k) of driver position and angle."""

    def __init__(self, at: np.ndarray, angle: Callable[[], np.ndarray], owner: np.ndarray) -> None:
        self._at, self._angle, self._owner = at, angle, owner

    def unwrapped(self, q: Derivatives, angle: Derivatives) -> Derivatives:
        """As `UnwrappedAngle.unwrapped`."""

        def first() -> np.ndarray:
            own, low, last = self._owner, self._at[self._owner, 0], self._at.shape[1] - 1
            part = (q[0] - low) / ((self._at[own, -1] - low) / last)
            i = np.clip(np.floor(part), 0, last - 1).astype(int)
            known = self._angle()
            about = known[own, i] + (part - i) * (known[own, i + 1] - known[own, i])
            return np.asarray(angle[0] + TURN * np.rint((about - angle[0]) / TURN))

        return Derivatives(lambda order: angle[order] if order else first())


class _Through(NamedTuple):
    """Linkages at driver positions q (m, k): which are assembled everywhere, far from dead centres and change points."""

    q: np.ndarray
    simple: np.ndarray


class Together:
    """The designs of a block: the parts of a study with a column (m,) for each number that is varied."""

    def __init__(self, design: Design, values: Mapping[str, np.ndarray], motion: Motion | None, count: int) -> None:
        """values: path -> its numbers (count,); motion: with columns, where those of the designs differ."""
        self._readers: dict[str, Callable[[Study], np.ndarray]] = {JAM: lambda there: there.dynamics.jam}
        self.plain, self.count = design, count
        self.reason = np.full(self.count, "", dtype=object)
        self.nobody = np.zeros(self.count, dtype=bool)
        self.lost: dict[str, np.ndarray] = {}
        self._owner: np.ndarray | None = None
        self._stage = "linkage"
        other_sense = self.nobody
        for path, numbers in values.items():
            if path == SPEED_OF_DRIVER:
                other_sense = numbers * get(design, path) < 0.0
                numbers = np.where(other_sense, get(design, path), numbers)
            design = put(design, path, column(numbers))
        self.design, drive = design, design.drive
        uncut: Any = CrankMotion(_WHOLE) if design.by_crank else Study(self.plain).uncut
        if motion is not None:
            uncut = program(with_all_pieces(uncut.motion, motion))
        self.motions = None if motion is None else Motions(uncut, motion, count)
        switches = tuple(sorted(Study(self.plain).loading.cuts(uncut).tolist()))
        self.program: Any = SubdividedTurn(uncut, switches) if switches else uncut
        self.apart = self.nobody if self.motions is None else self.motions.other
        with collecting_failures(self._note), np.errstate(all="ignore"):
            row = BUILDERS[type(drive.mechanism)]
            self.mechanism = row.build(*row.needs(drive.mechanism, drive.cam))
            self.loading = dynamics.loading_of(drive.mechanism, drive.loads, self.mechanism)
        if self.mechanism.ranged:
            drawn = drive.linkage.drawn is not None or bool(drive.linkage.drivers)  # each goes by itself
            self.apart = self.apart | ~self._through.simple | other_sense | drawn

    def _note(self, code: str, lost: Any) -> None:
        """Which designs have no answer from a stage on."""
        lost = np.asarray(lost)
        if not lost.any():
            return
        which = self.nobody.copy()
        if self._owner is None:
            which |= lost
        elif self._owner.ndim > 1:
            which[self._owner[:, 0]] = np.broadcast_to(lost, np.broadcast(lost, self._owner).shape).any(axis=1)
        else:
            which[self._owner[np.broadcast_to(lost, self._owner.shape)]] = True
        self.lost[self._stage] = self.lost.get(self._stage, self.nobody) | which
        self._because(which, code)

    def _because(self, which: np.ndarray, code: str) -> None:
        self.reason[which & (self.reason == "")] = code

    @property
    def is_form_closed(self) -> bool:
        """Whether the cam holds the follower from both sides."""
        return self.plain.drive.cam is not None and bool(self.plain.drive.cam.form.holds)

    def reader(self, name: str, read: Callable[[Study], np.ndarray]) -> str:
        """What is no quantity, of the stage ``dynamics``, is read under a name, as those of ``values``."""
        self._readers[name] = read
        return name

    def _stage_of(self, name: str) -> str:
        return "dynamics" if name in self._readers else quantity(name).stage

    # -- values ---------------------------------------------------------------------------------------------

    @cached_property
    def _parts(self) -> tuple[Any, ...]:
        """What columns may stand in, and how each is taken."""
        own, plan = self.mechanism, self.mechanism.plan
        names = [f.name for f in fields(own) if f.name not in ("linkage", "base", "angles")]
        parts = [
            {name: getattr(own, name) for name in names},
            {name: getattr(plan, name) for name in ("points", "driver", "steps", "sides")},
            (self.design, self.loading),
        ]
        return tuple((part, part_mapper(part)) for part in parts)

    def study(self, state: MotionState, owner: np.ndarray, take: ColumnMap | None = None) -> Study:
        """A study of all at the positions of a motion (n,), of which each belongs to the design ``owner`` (n,); take: how columns are
        taken there, where there is a quicker way."""
        made: dict[int, Any] = {}
        take = take or at_owners(owner)
        design, loading = _taken(self._parts[2], take, made)
        there = Study(design, angles=state.angles)
        mechanism = self._mechanism_at(take, made)
        turning: Any = {link: AboutMiddle(partial(self._middle, link), owner) for link in self.mechanism.angles}
        if self.mechanism.ranged:
            turning = {n: Along(self._through.q, partial(self._angle, n), owner) for n in self._led}
        driver_ranges = DriverRanges(mechanism.plan, (), (), Branch(), turning)
        vars(there).update(
            program=self.program, drive=state, mechanism=mechanism, driver_ranges=driver_ranges, loading=loading
        )
        return there

    def _mechanism_at(self, take: ColumnMap, made: dict[int, Any]) -> Any:
        own, plan, _ = self._parts
        there = replace(self.mechanism, **_taken(own, take, made))
        vars(there)["plan"] = SolutionPlan(linkage=self.mechanism.plan.linkage, **_taken(plan, take, made))
        return there

    def _ranges(self, each: int) -> Iterator[slice]:
        """As many designs as are computed at a time at so many angles each."""
        size = max(1, POINTS // each)
        return (slice(first, min(first + size, self.count)) for first in range(0, self.count, size))

    def _solved_along(self, count: int) -> Iterator[tuple[slice, np.ndarray, Any]]:
        """Where the drivers of some designs stand (m, count), evenly through all that they do, and all links there."""
        low: Any = 0.0
        high: Any = TURN
        if not self.plain.by_crank:
            low, high = motion_extent(self.program) if self.motions is None else self.motions.motion_extent()
        every = np.broadcast_to(np.linspace(low, high, count, axis=-1), (self.count, count))
        for designs in self._ranges(count):
            there = self._mechanism_at(repeated_values(designs, count), {})
            y = every[designs]
            q = there.start + there.driver_sign * y.ravel()
            yield designs, y, solve(there.plan, at_driver(np.asarray(q)), Branch(0.0))

    @cached_property
    def _through(self) -> _Through:
        """The linkages through all that their drivers do."""
        size = np.broadcast_to(np.asarray(self.mechanism.plan.size), self.count)[:, None]
        with np.errstate(all="ignore"):
            parts = [(q, self._simple(q, solved, size[d])) for d, q, solved in self._solved_along(THROUGH)]
        return _Through(*(np.concatenate(rows) for rows in zip(*parts, strict=True)))

    def _simple(self, q: np.ndarray, solved: Any, size: np.ndarray) -> np.ndarray:
        simple = np.ones(len(q), dtype=bool)
        for (step, _), closed in zip(self.mechanism.plan.steps, solved.steps, strict=True):
            if step.kind in SIDED:
                room = np.broadcast_to(closed.gap, q.size).reshape(q.shape)
                simple &= (room > CLEAR * size).all(axis=1)
            else:  # two lines, parallel where their sine changes its sign
                c1, c2 = closed.columns
                sine = np.broadcast_to(cross(c1, c2) / np.abs(c1) / np.abs(c2), q.size).reshape(q.shape)
                simple &= (sine * np.sign(sine[:, :1]) > CLEAR).all(axis=1)
        return simple

    @property
    def _led(self) -> list[int]:
        """The links whose angles follow from the driver's."""
        links = self.mechanism.linkage.links
        return [each.number for each in links if each.number not in (FRAME_LINK, self.mechanism.linkage.driver.link)]

    @cached_property
    def _angles(self) -> Mapping[int, np.ndarray]:
        """Of these the angles at the same places (m, k), without a jump."""
        found: dict[int, list[np.ndarray]] = {link: [] for link in self._led}
        with np.errstate(all="ignore"):
            for _, q, solved in self._solved_along(THROUGH):
                for link, rows in found.items():
                    turn = np.broadcast_to(solved.poses[link].turn[0], q.size).reshape(q.shape)
                    rows.append(near_zero(np.unwrap(turn, axis=1)))
        return {link: np.concatenate(rows) for link, rows in found.items()}

    @cached_property
    def _middles(self) -> Mapping[int, np.ndarray]:
        """Middle of the swing of every link whose angle is counted from the base position (m,) [rad]."""
        found: dict[int, list[np.ndarray]] = {link: [] for link in self.mechanism.angles}
        for designs, y, solved in self._solved_along(PATH):
            row = np.arange(len(y))
            i = np.clip((y <= 0.0).sum(axis=1), 1, PATH - 1)
            part = (0.0 - y[row, i - 1]) / (y[row, i] - y[row, i - 1])
            for link, first in self.mechanism.angles.items():
                angle = np.unwrap(np.broadcast_to(solved.poses[link].turn[0], y.size).reshape(-1, PATH), axis=1)
                base = angle[row, i - 1] + part * (angle[row, i] - angle[row, i - 1])
                start = np.broadcast_to(first, self.count)[designs]
                angle = angle + (TURN * np.rint((start - base) / TURN))[:, None]
                found[link].append(np.asarray(0.5 * (angle.max(axis=1) + angle.min(axis=1))))
        return {link: np.concatenate(rows) for link, rows in found.items()}

    def _angle(self, link: int) -> np.ndarray:
        return self._angles[link]

    def _middle(self, link: int) -> np.ndarray:
        return self._middles[link]

    def values(
        self, names: Sequence[str], state: MotionState, owner: np.ndarray, take: ColumnMap | None = None
    ) -> dict[str, np.ndarray]:
        """The quantities (n,), by name, and what a ``reader`` reads. What has no answer is noted. take: as of ``study``."""

        def rows(there: Study) -> dict[str, np.ndarray]:
            found = {name: (self._readers.get(name) or quantity(name).value)(there) for name in names}
            shape = np.broadcast(owner, state.angles.piece).shape
            return {name: np.broadcast_to(np.asarray(row), shape) for name, row in found.items()}

        stage = max(map(self._stage_of, names), key=_STAGES.index, default="motion")
        return self.read(stage, state, owner, take, rows)

    def read(
        self, stage: str, state: MotionState, owner: np.ndarray, take: ColumnMap | None, what: Callable[[Study], Any]
    ) -> Any:
        """What is read of the study of all, as far as a stage. What has no answer is noted."""
        there, self._owner = self.study(state, owner, take), owner
        with collecting_failures(self._note), np.errstate(all="ignore"):
            for self._stage in _STAGES[1 : _STAGES.index(stage) + 1]:
                if self._stage in there.stages:
                    getattr(there, self._stage)
            if stage == "dynamics":
                self._look_for_turns(there)
            return what(there)

    def _look_for_turns(self, there: Study) -> None:
        """Designs in which a pair that rubs slips one way and then the other: their turn is cut there, which that of others is not."""
        assert self._owner is not None
        for friction in self.loading.frictions:
            if friction.pair != there.linkage.driver_name:
                slip, owner = np.broadcast_arrays(there.linkage.slip(friction.pair), self._owner)
                both = [np.bincount(owner[sign * slip > 0.0], minlength=self.count) > 0 for sign in (-1.0, 1.0)]
                self.apart = self.apart | (both[0] & both[1])

    # -- what is asked --------------------------------------------------------------------------------------

    def results(self, asked: Sequence[QuantityRequest], polish: bool, loads: bool = False) -> Results:
        """Of each design, by quantities; loads: it shall be known of each whether it jams, in any case."""
        angles, weight = nodes_of(self.program)
        if self.motions is not None:
            weight = weight * self.motions.stretched()[:, angles.piece]
        stages = {quantity(each.name).stage for each in asked}
        searches = dict.fromkeys((each.name, side) for each in asked for side in _SIDES[each.statistic])
        further = self._further(stages, loads)
        judged = [Search(*each) for each in further if each not in searches]
        names = list(dict.fromkeys([*(each.name for each in asked), *(name for name, _ in further)]))
        sampled = self._at_nodes(names, angles)
        every = np.arange(self.count)
        found = self._extremes([Search(*each) for each in searches], every, sampled, angles, polish)
        found |= self._judged(judged, found, sampled, angles, polish)
        searches |= dict.fromkeys(further)
        extremes = self._ranges_of(found)
        undercut = self._undercut(extremes) if "cam" in stages or "dynamics" in stages else {}
        for flank, curvature in PROFILE_CURVATURES.items():
            if curvature in extremes and flank in undercut:
                extremes[curvature] = _through_cusp(extremes[curvature], undercut[flank])
        anywhere = np.any([*undercut.values(), self._corners], axis=0) if undercut else self.nobody
        if (JAM, 1.0) in searches:
            jams = np.asarray(extremes[JAM].high.value >= dynamics.JAMS)
            self._stage, self.lost["dynamics"] = "dynamics", self.lost.get("dynamics", self.nobody) | jams
            for k, code in self._jam_codes(np.flatnonzero(jams), np.asarray(extremes[JAM].high.theta)).items():
                self._because(np.arange(self.count) == k, code)
        self._because(anywhere, UNDERCUT)
        value, theta = [], []
        for each in asked:
            row = quantity(each.name)
            if each.statistic in ("rms", "mean"):
                one: tuple[Any, Any] = (
                    mean_statistic(sampled[each.name], weight, each.statistic),
                    np.full(self.count, np.nan),
                )
            else:
                ends = extremes[each.name]
                one = extreme_statistic(
                    each.statistic, (ends.low.value, ends.low.theta), (ends.high.value, ends.high.theta)
                )
            nothing = self.lost_at(row.stage) | (anywhere if row.needs_smooth_profile else False)
            if round_ := self._goes_round(each.name):
                nothing = nothing | round_[0]
                self._because(round_[0], NO_VALUE)
            value.append(np.where(nothing, np.nan, one[0]))
            theta.append(np.where(nothing, np.nan, one[1]))
        places = np.array(theta).reshape(-1, self.count)
        if self.motions is not None:
            at = np.where(np.isnan(places), 0.0, places)
            piece = self.program.angles(at.ravel()).piece.reshape(at.shape)
            own = self.motions.own(at, piece, np.arange(self.count))
            places = np.where(np.isnan(places), np.nan, own)
        return Results(np.array(value).reshape(-1, self.count), places, self.reason)

    def _extremes(
        self,
        searches: Sequence[Search],
        some: np.ndarray,
        sampled: Mapping[str, np.ndarray],
        angles: Angles,
        polish: bool,
    ) -> SearchResults:
        """Of some designs (m,)."""
        names = list(dict.fromkeys(name for name, _ in searches))

        def at(theta: np.ndarray, piece: np.ndarray, owner: np.ndarray) -> Mapping[str, np.ndarray]:
            return self.values(names, self.state(theta, piece, some[owner]), some[owner])

        rows = {name: sampled[name] if some.size == self.count else sampled[name][some] for name in names}
        return refined(searches, rows, angles, at, polish)

    def _judged(
        self,
        searches: Sequence[Search],
        known: SearchResults,
        sampled: Mapping[str, np.ndarray],
        angles: Angles,
        polish: bool,
    ) -> SearchResults:
        """Extremes of which it is only asked on which side of a limit they lie: refined where they may lie on either."""
        found = self._extremes(searches, np.arange(self.count), sampled, angles, False)
        if not polish or not searches:
            return found
        doubts = {search: self._doubt(search, sampled[search.name]) for search in found}
        verdicts = []
        for sign in (-1.0, 1.0):
            moved = {s: (v + sign * doubts[s], theta) for s, (v, theta) in found.items()}
            ends = self._ranges_of({**known, **moved})
            jams = [ends[JAM].high.value >= dynamics.JAMS] if JAM in ends else []
            shaped = self._undercut(ends).values() if any(name != JAM for name, _ in searches) else ()
            verdicts.append(np.array([*shaped, *jams]).reshape(-1, self.count))
        near = np.flatnonzero((verdicts[0] != verdicts[1]).any(axis=0))
        if near.size:
            for search, rows in self._extremes(searches, near, sampled, angles, True).items():
                for row, new in zip(found[search], rows, strict=True):
                    row[near] = new
        return found

    def _doubt(self, search: Search, sampled: np.ndarray) -> np.ndarray:
        """By how much an extreme between nodes may be another (m,): what the nodes beside the outermost fall off by, and a part of it."""
        row, last = search.side * sampled, sampled.shape[1] - 1
        design, top = np.arange(len(row)), np.where(np.isnan(row), -np.inf, row).argmax(axis=1)
        own = row[design, top]
        beside = np.minimum(row[design, np.maximum(top - 1, 0)], row[design, np.minimum(top + 1, last)])
        return replace_nan(own - beside, nan=np.inf) + DOUBT * np.abs(own)

    def _ranges_of(self, found: SearchResults) -> dict[str, Extremes]:
        nothing = np.full(self.count, np.nan), np.full(self.count, np.nan)
        return {
            name: Extremes(*(_ends(found.get(Search(name, side), nothing)) for side in (-1.0, 1.0)))
            for name in dict.fromkeys(name for name, _ in found)
        }

    def state(self, theta: np.ndarray, piece: np.ndarray, owner: np.ndarray) -> MotionState:
        """The motion of each design at cam angles of the plain one (n,)."""
        if self.motions is None:
            state: MotionState = self.program.state(Angles(theta, piece))
            return state
        return self.motions.state(Angles(theta, piece), owner)

    def _at_nodes(self, names: Sequence[str], angles: Angles) -> dict[str, np.ndarray]:
        """The quantities at the nodes of every design (m, n)."""
        n, parts = angles.theta.size, []
        for designs in self._ranges(n):
            owner = np.arange(self.count)[designs, None]
            found = self.values(names, self._beside(angles, owner), owner)
            parts.append(found)
        return {name: np.concatenate([part[name] for part in parts]) for name in names}

    def _beside(self, angles: Angles, owner: np.ndarray) -> MotionState:
        """The motion of designs ``owner`` (m, 1) at angles (n,) of the plain one: (m, n) where they differ, else (n,)."""
        if self.motions is None:
            state: MotionState = self.program.state(angles)
            return state
        return self.motions.state(angles, owner)

    def spread(self, angles: Angles, designs: slice = slice(None)) -> tuple[MotionState, np.ndarray, ColumnMap]:
        """The motion of some designs at angles (n,) of the plain one, whose each is, both (m n,), and how columns are taken there."""
        n, some = angles.theta.size, np.arange(self.count)[designs]
        owner, m, take = np.repeat(some, n), some.size, repeated_values(designs, n)

        def spread(row: np.ndarray) -> np.ndarray:
            return np.tile(row, m)

        if self.motions is not None:
            return self.state(spread(angles.theta), spread(angles.piece), owner), owner, take
        state, unit = self.program.state(angles), angles.unit  # the motion is the same for all
        every = Angles(spread(angles.theta), spread(angles.piece), unit=lambda: spread(unit))
        moved = Derivatives(lambda order: spread(state.displacement[order]))
        within = lambda: np.tile(state.within, (1, m))  # noqa: E731
        return MotionState(every, moved, spread(state.velocity_sign), within), owner, take

    def lost_at(self, stage: str) -> np.ndarray:
        """Designs (m,) without an answer there."""
        before = _STAGES[1 : _STAGES.index(stage) + 1]
        return np.any([self.nobody, *(self.lost[s] for s in before if s in self.lost)], axis=0)

    def _further(self, stages: set[str], loads: bool) -> list[tuple[str, float]]:
        """What tells of errors: whether friction jams, whether a flank is undercut."""
        found = [(JAM, 1.0)] if (loads or "dynamics" in stages) and self.loading.has_friction else []
        if stages & {"cam", "dynamics"}:
            drive, reads = self.plain.drive, _Reads()
            for flank in self._flanks():
                cam.undercut(reads, flank, drive.face, drive.cam)
            found += reads.read
        return found

    def _flanks(self) -> tuple[str, ...]:
        if self.plain.drive.cam is None:
            return ()
        return cam.form_row(self.plain.drive.cam.form).flanks

    def _undercut(self, extremes: Mapping[str, Extremes]) -> dict[str, np.ndarray]:
        """Flank -> which designs (m,)."""
        drive = self.design.drive
        with np.errstate(all="ignore"):
            return {
                flank: np.asarray(cam.undercut(extremes, flank, drive.face, drive.cam)) & ~self.nobody
                for flank in self._flanks()
            }

    def _goes_round(self, name: str) -> list[np.ndarray]:
        """Designs in which an angle goes round with the crank (m,), which then has no extremes; empty of other quantities."""
        sort, _, link = name.partition(".")
        if sort != "link" or not link.isdecimal() or not self.plain.by_crank:
            return []
        angle = self._angles.get(int(link))
        return [] if angle is None else [np.abs(angle[:, -1] - angle[:, 0]) > np.pi]

    @property
    def _corners(self) -> np.ndarray:
        """Designs whose velocity jumps (m,): there the pitch curve has a corner, which is sharper than any roller."""
        if self.motions is not None:
            return self.motions.corners
        return np.full(self.count, any(join.jumps[:2].any() for join in self.program.joins))

    def _jam_codes(self, jammed: np.ndarray, theta: np.ndarray) -> dict[int, str]:
        """Design -> the code of what jams hardest in it, at these cam angles (m,) of the plain motion."""
        if not jammed.size:
            return {}
        at = self.program.angles(theta[jammed])
        with collecting_failures(lambda code, lost: None), np.errstate(all="ignore"):
            forces = self.study(self.state(at.theta, at.piece, jammed), jammed).dynamics
            rows = (np.broadcast_to(each, jammed.shape) for each in (forces.contact_jam, forces.most_jamming))
        frictions, found = self.loading.frictions, {}
        for k, contact, most in zip(jammed.tolist(), *(row.tolist() for row in rows), strict=True):
            pair = None if not frictions or contact >= dynamics.JAMS else frictions[int(most)]
            found[k] = dynamics.jam_finding(Extreme(1.0, 0.0), pair).code
        return found


def _taken(part: tuple[Any, Any], take: ColumnMap, made: dict[int, Any]) -> Any:
    whole, make = part
    return whole if make is None else make(take, made)


_STAGES = ("motion", "linkage", "cam", "dynamics")
JAM = "jam"
_SIDES = {"max": (1.0,), "min": (-1.0,), "abs": (-1.0, 1.0), "range": (-1.0, 1.0), "rms": (), "mean": ()}


def _ends(found: tuple[np.ndarray, np.ndarray]) -> Extreme:
    """Of m designs at once."""
    return Extreme(*found)  # type: ignore[arg-type]


def _through_cusp(found: Extremes, there: np.ndarray) -> Extremes:
    """As of one design: a curvature grows without limit at a cusp, and comes back from below where the profile runs backwards, however
    short that is."""
    low, high = found.low, found.high
    return Extremes(
        Extreme(np.where(there, -np.inf, low.value), low.theta),  # type: ignore[arg-type]
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
