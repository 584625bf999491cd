"""Many designs at once, through the stages of a single study.

The axis of angles has the nodes of all designs one after the other; a varied number of the design is a ``Column``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields, replace
from functools import partial
from math import ceil
from typing import Any, NamedTuple

import numpy as np

from core import cam, dynamics
from core.design import FRAME_LINK, Design, Motion, get, put
from core.design.curves import with_all_pieces
from core.errors import collecting_failures
from core.followers import BUILDERS
from core.mechanism import CrankMotion, DriverRange, DriverRanges, SolutionPlan, at_driver, motion_extent
from core.mechanism.branches import Branch
from core.mechanism.driver_ranges import PATH, SIDED, near_zero
from core.mechanism.mechanism import solve
from core.motion import TURN, Angles, MotionState, program
from core.motion.extremes import Extreme, Extremes
from core.motion.program import SubdividedTurn
from core.numerics.derivatives import Derivatives, cross, replace_nan
from core.numerics.lazy import ColumnMap, at_owners, column, lazy, part_mapper, repeated_values
from core.study.block_motions import AngleAboutMiddle, AngleAlongSamples, BlockMotions
from core.study.extremes import PROFILE_CURVATURES
from core.study.highest import Search, clenshaw_curtis_nodes, refined_extremes
from core.study.quantities import quantity
from core.study.quantity_requests import QuantityRequest, extreme_statistic, mean_statistic
from core.study.study import Study

MAX_POSITIONS = 90_000
"""Positions at a time: fewer cost more calls of numpy, more exceed the memory that a process retains, at twice the time."""
PATH_SAMPLES, MIN_GAP = 97, 5e-3
"""Positions at which a linkage is followed, and the gap to a dead centre or change point, by its size, that counts as none."""
EXTREME_ERROR = 0.02  # of an extreme between nodes
SearchResults = dict[Search, tuple[np.ndarray, np.ndarray]]
"""Search -> value and cam angle [rad], both (m,)."""
_FULL_TURN = DriverRanges(None, (DriverRange(0.0, TURN),), (), Branch(), {})  # type: ignore[arg-type]

SPEED_OF_DRIVER = "linkage.driver.speed_rpm"  # its sign is the sense of rotation
NO_VALUE, UNDERCUT = "no-value", "undercut"
"""Reasons besides the codes of errors: the design lacks the quantity, as a stress without a valid contact; the cam is undercut, and
the values are those of the undercut profile."""


class Results(NamedTuple):
    """Figures of the m designs of a block.

    Attributes
    ----------
    value : ndarray (k, m)
        Values of k figures in SI units; NaN where a design has none.
    theta : ndarray (k, m) [rad]
        Cam angles of extremes, else NaN.
    reason : ndarray (m,)
        Code that says why a design has no value; else empty.
    """

    value: np.ndarray
    theta: np.ndarray
    reason: np.ndarray


class _Path(NamedTuple):
    """Driver positions q (m, k), and the mask ``simple`` (m,) of linkages that stay clear of dead centres and change points."""

    q: np.ndarray
    simple: np.ndarray


class DesignBlock:
    """The designs of a block: the parts of a study, with a column (m,) for each varied number.

    Attributes
    ----------
    plain : Design
        The design without varied numbers.
    design, mechanism, loading, motions, program
        Parts of a study, with columns.
    count : int
        Number m of designs.
    reason : ndarray (m,)
        Code that says why a design has no value; else empty.
    failed : mapping of str -> ndarray (m,)
        Stage -> designs that fail there.
    separate : ndarray (m,)
        Designs to be computed one by one.
    """

    def __init__(self, design: Design, values: Mapping[str, np.ndarray], motion: Motion | None, count: int) -> None:
        """Set up from path -> numbers (count,), and a motion with columns, where the motions of the designs differ."""
        self._readers: dict[str, Callable[[Study], np.ndarray]] = {JAM: lambda study: study.dynamics.jam}
        self.plain, self.count = design, count
        self.reason = np.full(self.count, "", dtype=object)
        self.no_design = np.zeros(self.count, dtype=bool)
        self.failed: dict[str, np.ndarray] = {}
        self._owner: np.ndarray | None = None
        self._stage = "linkage"
        is_reversed = self.no_design
        for path, numbers in values.items():
            if path == SPEED_OF_DRIVER:
                is_reversed = numbers * get(design, path) < 0.0
                numbers = np.where(is_reversed, get(design, path), numbers)
            design = put(design, path, column(numbers))
        self.design, drive = design, design.drive
        uncut: Any = CrankMotion(_FULL_TURN) if design.by_crank else Study(self.plain).uncut
        if motion is not None:
            uncut = program(with_all_pieces(uncut.motion, motion))
        self.motions = None if motion is None else BlockMotions(uncut, motion, count)
        plain = Study(self.plain)
        switches, lash = tuple(sorted(plain.loading.cuts(uncut).tolist())), plain.lash
        self.program: Any = SubdividedTurn(uncut, switches) if switches else uncut
        self.separate = self.no_design if self.motions is None else self.motions.differing
        with collecting_failures(self._note), np.errstate(all="ignore"):
            row = BUILDERS[type(drive.mechanism)]
            self.mechanism = row.build(*row.needs(drive.mechanism, drive.cam))
            self.loading = dynamics.loading_of(drive.mechanism, drive.loads, self.mechanism, lash)
        if self.mechanism.ranged:
            is_drawn = drive.linkage.drawn is not None or bool(drive.linkage.drivers)  # solved one by one
            self.separate = self.separate | ~self._path.simple | is_reversed | is_drawn

    def _note(self, code: str, fails: Any) -> None:
        """Mark designs that fail at the current stage."""
        fails = np.asarray(fails)
        if not fails.any():
            return
        which = self.no_design.copy()
        if self._owner is None:
            which |= fails
        elif self._owner.ndim > 1:
            which[self._owner[:, 0]] = np.broadcast_to(fails, np.broadcast(fails, self._owner).shape).any(axis=1)
        else:
            which[self._owner[np.broadcast_to(fails, self._owner.shape)]] = True
        self.failed[self._stage] = self.failed.get(self._stage, self.no_design) | which
        self._add_reason(which, code)

    def _add_reason(self, which: np.ndarray, code: str) -> None:
        self.reason[which & (self.reason == "")] = code

    @property
    def is_form_closed(self) -> bool:
        """Whether the cam holds the follower from both sides."""
        return self.plain.drive.has_disk and bool(self.plain.drive.cam.form.holds)

    def add_reader(self, name: str, read: Callable[[Study], np.ndarray]) -> str:
        """Add a function of a study that ``values`` evaluates under a name, for the stage ``dynamics``.

        Parameters
        ----------
        name : str
        read : callable
            Study -> ndarray (n,) [SI unit].

        Returns
        -------
        str
            The name.
        """
        self._readers[name] = read
        return name

    def _stage_of(self, name: str) -> str:
        return "dynamics" if name in self._readers else quantity(name).stage

    # -- values ---------------------------------------------------------------------------------------------

    @lazy
    def _parts(self) -> tuple[Any, ...]:
        """Parts with columns, each with the function that takes its columns."""
        mechanism, plan = self.mechanism, self.mechanism.plan
        names = [f.name for f in fields(mechanism) if f.name not in ("linkage", "base", "angles")]
        parts = [
            {name: getattr(mechanism, name) for name in names},
            {name: getattr(plan, name) for name in ("points", "driver", "steps", "sides", "structure")},
            (self.design, self.loading),
        ]
        return tuple((part, part_mapper(part)) for part in parts)

    def study(self, state: MotionState, owner: np.ndarray, take: ColumnMap | None = None) -> Study:
        """Study of all designs at the positions of a motion.

        Parameters
        ----------
        state : MotionState
            Motion at n positions.
        owner : ndarray (n,), dimensionless
            Number of the design of each position.
        take : ColumnMap or None
            Faster function that takes columns at these positions.

        Returns
        -------
        Study
        """
        cache: dict[int, Any] = {}
        take = take or at_owners(owner)
        design, loading = _taken(self._parts[2], take, cache)
        study = Study(design, angles=state.angles)
        mechanism = self._mechanism_at(take, cache)
        turning: Any = {link: AngleAboutMiddle(partial(self._middle, link), owner) for link in self.mechanism.angles}
        if self.mechanism.ranged:
            turning = {n: AngleAlongSamples(self._path.q, partial(self._angle, n), owner) for n in self._driven_links}
        driver_ranges = DriverRanges(mechanism.plan, (), (), Branch(), turning)
        vars(study).update(
            program=self.program, drive=state, mechanism=mechanism, driver_ranges=driver_ranges, loading=loading
        )
        return study

    def _mechanism_at(self, take: ColumnMap, cache: dict[int, Any]) -> Any:
        parts, plan, _ = self._parts
        mechanism = replace(self.mechanism, **_taken(parts, take, cache))
        vars(mechanism)["plan"] = SolutionPlan(linkage=self.mechanism.plan.linkage, **_taken(plan, take, cache))
        return mechanism

    def _solved_along(self, count: int) -> Iterator[tuple[slice, np.ndarray, Any]]:
        """Slices of designs, positions (m, count) of their drivers evenly over their path, and the solved linkages."""
        low: Any = 0.0
        high: Any = TURN
        if not self.plain.by_crank:
            low, high = motion_extent(self.program) if self.motions is None else self.motions.motion_extent()
        every = np.broadcast_to(np.linspace(low, high, count, axis=-1), (self.count, count))
        for designs in equal_parts(self.count, count):
            mechanism = self._mechanism_at(repeated_values(designs, count), {})
            y = every[designs]
            q = mechanism.start + mechanism.driver_sign * y.ravel()
            yield designs, y, solve(mechanism.plan, at_driver(np.asarray(q)), Branch(0.0))

    @lazy
    def _path(self) -> _Path:
        """Path of the drivers of all designs."""
        size = np.broadcast_to(np.asarray(self.mechanism.plan.size), self.count)[:, None]
        with np.errstate(all="ignore"):
            parts = [(q, self._is_simple(q, solved, size[d])) for d, q, solved in self._solved_along(PATH_SAMPLES)]
        return _Path(*(np.concatenate(rows) for rows in zip(*parts, strict=True)))

    def _is_simple(self, q: np.ndarray, solved: Any, size: np.ndarray) -> np.ndarray:
        simple = np.ones(len(q), dtype=bool)
        for (step, _), closed in zip(self.mechanism.plan.steps, solved.steps, strict=True):
            if step.kind in SIDED:
                gap = np.broadcast_to(closed.gap, q.size).reshape(q.shape)
                simple &= (gap > MIN_GAP * size).all(axis=1)
            else:  # two lines, parallel where their sine changes its sign
                c1, c2 = closed.columns
                sine = np.broadcast_to(cross(c1, c2) / np.abs(c1) / np.abs(c2), q.size).reshape(q.shape)
                simple &= (sine * np.sign(sine[:, :1]) > MIN_GAP).all(axis=1)
        return simple

    @property
    def _driven_links(self) -> list[int]:
        """Numbers of the links except frame and driver."""
        linkage = self.mechanism.linkage
        return [link.number for link in linkage.links if link.number not in (FRAME_LINK, linkage.driver.link)]

    @lazy
    def _angles(self) -> Mapping[int, np.ndarray]:
        """Driven link -> its angle (m, k) [rad] at the positions of ``_path``, without jumps."""
        angles: dict[int, list[np.ndarray]] = {link: [] for link in self._driven_links}
        with np.errstate(all="ignore"):
            for _, q, solved in self._solved_along(PATH_SAMPLES):
                for link, rows in angles.items():
                    turn = np.broadcast_to(solved.poses[link].turn[0], q.size).reshape(q.shape)
                    rows.append(near_zero(np.unwrap(turn, axis=1)))
        return {link: np.concatenate(rows) for link, rows in angles.items()}

    @lazy
    def _middles(self) -> Mapping[int, np.ndarray]:
        """Link whose angle is counted from the base position -> middle of its swing (m,) [rad]."""
        middles: dict[int, list[np.ndarray]] = {link: [] for link in self.mechanism.angles}
        for designs, y, solved in self._solved_along(PATH):
            row = np.arange(len(y))
            i = np.clip((y <= 0.0).sum(axis=1), 1, PATH - 1)
            part = (0.0 - y[row, i - 1]) / (y[row, i] - y[row, i - 1])
            for link, first in self.mechanism.angles.items():
                angle = np.unwrap(np.broadcast_to(solved.poses[link].turn[0], y.size).reshape(-1, PATH), axis=1)
                base = angle[row, i - 1] + part * (angle[row, i] - angle[row, i - 1])
                start = np.broadcast_to(first, self.count)[designs]
                angle = angle + (TURN * np.rint((start - base) / TURN))[:, None]
                middles[link].append(np.asarray(0.5 * (angle.max(axis=1) + angle.min(axis=1))))
        return {link: np.concatenate(rows) for link, rows in middles.items()}

    def _angle(self, link: int) -> np.ndarray:
        return self._angles[link]

    def _middle(self, link: int) -> np.ndarray:
        return self._middles[link]

    def values(
        self, names: Sequence[str], state: MotionState, owner: np.ndarray, take: ColumnMap | None = None
    ) -> dict[str, np.ndarray]:
        """Quantities and added readers at the positions of a motion; designs that fail are marked.

        Parameters
        ----------
        names : sequence of str
        state : MotionState
            Motion at n positions, or at (m, n).
        owner : ndarray (n,) or (m, 1), dimensionless
            Number of the design of each position.
        take : ColumnMap or None
            As for ``study``.

        Returns
        -------
        dict of str -> ndarray (n,) or (m, n) [SI unit of the quantity]
        """

        def rows(study: Study) -> dict[str, np.ndarray]:
            values = {name: (self._readers.get(name) or quantity(name).value)(study) for name in names}
            shape = np.broadcast(owner, state.angles.piece).shape
            return {name: np.broadcast_to(np.asarray(row), shape) for name, row in values.items()}

        stage = max(map(self._stage_of, names), key=_STAGES.index, default="motion")
        return self.read(stage, state, owner, take, rows)

    def read(
        self,
        stage: str,
        state: MotionState,
        owner: np.ndarray,
        take: ColumnMap | None,
        function: Callable[[Study], Any],
    ) -> Any:
        """Result of a function of the study of all designs, solved up to a stage; designs that fail are marked.

        Parameters
        ----------
        stage : str
        state : MotionState
            Motion at n positions, or at (m, n).
        owner : ndarray (n,) or (m, 1), dimensionless
            Number of the design of each position.
        take : ColumnMap or None
            As for ``study``.
        function : callable
        """
        study, self._owner = self.study(state, owner, take), owner
        with collecting_failures(self._note), np.errstate(all="ignore"):
            for self._stage in _STAGES[1 : _STAGES.index(stage) + 1]:
                if self._stage in study.stages:
                    getattr(study, self._stage)
            if stage == "dynamics":
                self._separate_reversing(study)
            return function(study)

    def _separate_reversing(self, study: Study) -> None:
        """Mark designs in which the slip of a rubbing pair reverses as separate: their turn is cut at that angle."""
        assert self._owner is not None
        for friction in self.loading.frictions:
            if friction.pair != study.linkage.driver_name:
                slip, owner = np.broadcast_arrays(study.linkage.slip(friction.pair), self._owner)
                both = [np.bincount(owner[sign * slip > 0.0], minlength=self.count) > 0 for sign in (-1.0, 1.0)]
                self.separate = self.separate | (both[0] & both[1])

    # -- figures --------------------------------------------------------------------------------------------

    def results(self, requests: Sequence[QuantityRequest], polish: bool, loads: bool = False) -> Results:
        """Figures of quantities of all designs; with ``loads`` designs that jam are marked in any case."""
        angles, weight = clenshaw_curtis_nodes(self.program)
        stages = {quantity(request.name).stage for request in requests}
        searches = dict.fromkeys((request.name, side) for request in requests for side in _SIDES[request.statistic])
        further = self._error_searches(stages, loads)
        compared = [Search(*search) for search in further if search not in searches]
        names = list(dict.fromkeys([*(request.name for request in requests), *(name for name, _ in further)]))
        sampled = self.at_nodes(names, angles, np.arange(self.count))
        every = np.arange(self.count)
        peaks = self._searched([Search(*search) for search in searches], every, sampled, angles, polish)
        peaks |= self._compared(compared, peaks, sampled, angles, polish)
        searches |= dict.fromkeys(further)
        extremes = self._extremes_by_name(peaks)
        undercut = self._undercut(extremes) if "cam" in stages or "dynamics" in stages else {}
        for flank, curvature in PROFILE_CURVATURES.items():
            if curvature in extremes and flank in undercut:
                extremes[curvature] = _cusp_extremes(extremes[curvature], undercut[flank])
        any_undercut = np.any([*undercut.values(), self._corners], axis=0) if undercut else self.no_design
        if (JAM, 1.0) in searches:
            self._mark_jams(extremes[JAM].high)
        self._add_reason(any_undercut, UNDERCUT)
        values, thetas = [], []
        for request in requests:
            row, statistic = quantity(request.name), request.statistic
            value: Any
            if statistic in ("rms", "mean"):
                share = 1.0 if self.motions is None else self.motions.span_ratios()[:, angles.piece]
                value = mean_statistic(sampled[request.name], weight * share, statistic)
                theta = np.full(self.count, np.nan)
            else:
                low, high = extremes[request.name].low, extremes[request.name].high
                value, theta = extreme_statistic(statistic, (low.value, low.theta), (high.value, high.theta))
            has_none = self.failed_at(row.stage) | (any_undercut if row.needs_smooth_profile else False)
            is_periodic = self._is_periodic(request.name)
            if is_periodic is not None:
                has_none = has_none | is_periodic
                self._add_reason(is_periodic, NO_VALUE)
            values.append(np.where(has_none, np.nan, value))
            thetas.append(np.where(has_none, np.nan, theta))
        cam_angles = np.array(thetas).reshape(-1, self.count)
        if self.motions is not None:
            at = np.where(np.isnan(cam_angles), 0.0, cam_angles)
            piece = self.program.angles(at.ravel()).piece.reshape(at.shape)
            of_design = self.motions.cam_angles(at, piece, np.arange(self.count))
            cam_angles = np.where(np.isnan(cam_angles), np.nan, of_design)
        return Results(np.array(values).reshape(-1, self.count), cam_angles, self.reason)

    def mark_jams(self, jam: np.ndarray, angles: Angles, polish: bool) -> None:
        """Mark designs in which friction jams.

        Parameters
        ----------
        jam : ndarray (m, n), dimensionless
            Jam of every design at the nodes.
        angles : Angles (n,)
            Nodes by angles of the plain design.
        polish : bool
            Refine the jam where its error at the nodes spans the limit.
        """
        search = Search(JAM, 1.0)
        value, theta = self._searched([search], np.arange(self.count), {JAM: jam}, angles, False)[search]
        error = self._error(search, jam) if polish else np.zeros(self.count)
        near = np.flatnonzero((value - error >= dynamics.JAMS) != (value + error >= dynamics.JAMS))
        if near.size:
            nodes, _ = clenshaw_curtis_nodes(self.program)
            sampled = self.at_nodes([JAM], nodes, near)
            value[near], theta[near] = self._searched([search], near, sampled, nodes, True)[search]
        self._mark_jams(Extreme(value, theta))  # type: ignore[arg-type]

    def _mark_jams(self, highest: Extreme) -> None:
        """Mark designs in which friction jams, by the highest jam (m,) of all designs."""
        jams, theta = np.asarray(highest.value) >= dynamics.JAMS, np.asarray(highest.theta)
        self._stage, self.failed["dynamics"] = "dynamics", self.failed.get("dynamics", self.no_design) | jams
        for k, code in self._jam_codes(np.flatnonzero(jams), theta).items():
            self._add_reason(np.arange(self.count) == k, code)

    def _searched(
        self,
        searches: Sequence[Search],
        chosen: np.ndarray,
        sampled: Mapping[str, np.ndarray],
        angles: Angles,
        polish: bool,
    ) -> SearchResults:
        """Results of searches in the chosen designs (m,), from their values (m, n) at the nodes."""

        def at(theta: np.ndarray, piece: np.ndarray, owner: np.ndarray) -> Mapping[str, np.ndarray]:
            return self.values(names, self.state(theta, piece, chosen[owner]), chosen[owner])

        names = list(dict.fromkeys(name for name, _ in searches))
        return refined_extremes(searches, sampled, angles, at, polish)

    def _compared(
        self,
        searches: Sequence[Search],
        others: SearchResults,
        sampled: Mapping[str, np.ndarray],
        angles: Angles,
        polish: bool,
    ) -> SearchResults:
        """Results of searches that are only compared with a limit: refined where the error at the nodes spans the limit."""
        results = self._searched(searches, np.arange(self.count), sampled, angles, False)
        if not polish or not searches:
            return results
        errors = {search: self._error(search, sampled[search.name]) for search in results}
        verdicts = []
        for sign in (-1.0, 1.0):
            shifted = {s: (v + sign * errors[s], theta) for s, (v, theta) in results.items()}
            ends = self._extremes_by_name({**others, **shifted})
            jams = [ends[JAM].high.value >= dynamics.JAMS] if JAM in ends else []
            undercut = self._undercut(ends).values() if any(name != JAM for name, _ in searches) else ()
            verdicts.append(np.array([*undercut, *jams]).reshape(-1, self.count))
        near = np.flatnonzero((verdicts[0] != verdicts[1]).any(axis=0))
        if near.size:
            chosen = {name: sampled[name][near] for name in dict.fromkeys(search.name for search in searches)}
            for search, rows in self._searched(searches, near, chosen, angles, True).items():
                for row, new in zip(results[search], rows, strict=True):
                    row[near] = new
        return results

    def _error(self, search: Search, sampled: np.ndarray) -> np.ndarray:
        """Error (m,) of an extreme between nodes: the fall from the highest node to its neighbours, and a part of its value."""
        row, last = search.side * sampled, sampled.shape[1] - 1
        design, top = np.arange(len(row)), replace_nan(row, nan=-np.inf).argmax(axis=1)
        highest = row[design, top]
        neighbour = np.minimum(row[design, np.maximum(top - 1, 0)], row[design, np.minimum(top + 1, last)])
        return replace_nan(highest - neighbour, nan=np.inf) + EXTREME_ERROR * np.abs(highest)

    def _extremes_by_name(self, results: SearchResults) -> dict[str, Extremes]:
        """Name -> extremes of all designs, (m,) each; NaN for a side that was not searched."""
        missing = np.full(self.count, np.nan), np.full(self.count, np.nan)
        return {
            name: Extremes(*(Extreme(*results.get(Search(name, side), missing)) for side in (-1.0, 1.0)))  # type: ignore[arg-type]
            for name in dict.fromkeys(name for name, _ in results)
        }

    def state(self, theta: np.ndarray, piece: np.ndarray, owner: np.ndarray) -> MotionState:
        """Motion of designs at cam angles of the plain design.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Cam angles of the plain design.
        piece : ndarray (n,), dimensionless
            Numbers of their pieces.
        owner : ndarray (n,), dimensionless
            Numbers of the designs.

        Returns
        -------
        MotionState
        """
        if self.motions is None:
            state: MotionState = self.program.state(Angles(theta, piece))
            return state
        return self.motions.state(Angles(theta, piece), owner)

    def at_nodes(self, names: Sequence[str], angles: Angles, designs: np.ndarray) -> dict[str, np.ndarray]:
        """Quantities and added readers at the same nodes of some designs; designs that fail are marked.

        Parameters
        ----------
        names : sequence of str
        angles : Angles (n,)
            Nodes by angles of the plain design.
        designs : ndarray (m,), dimensionless
            Numbers of the designs.

        Returns
        -------
        dict of str -> ndarray (m, n) [SI unit of the quantity]
        """
        owners = [designs[part, None] for part in equal_parts(designs.size, angles.theta.size)]
        parts = [self.values(names, self._state_at(angles, owner), owner) for owner in owners]
        return {name: np.concatenate([part[name] for part in parts]) for name in names}

    def _state_at(self, angles: Angles, owner: np.ndarray) -> MotionState:
        """Motion of designs ``owner`` (m, 1) at angles (n,) of the plain design: (m, n) where the motions differ, else (n,)."""
        if self.motions is None:
            state: MotionState = self.program.state(angles)
            return state
        return self.motions.state(angles, owner)

    def spread(self, angles: Angles, designs: slice = slice(None)) -> tuple[MotionState, np.ndarray, ColumnMap]:
        """Motion of some designs at the same angles of the plain design, for ``read``.

        Parameters
        ----------
        angles : Angles (n,)
            Angles of the plain design.
        designs : slice
            The m designs.

        Returns
        -------
        state : MotionState
            Motion at (m n,) positions.
        owner : ndarray (m n,), dimensionless
            Number of the design of each position.
        take : ColumnMap
            Function that takes columns at these positions.
        """
        n, numbers = angles.theta.size, np.arange(self.count)[designs]
        owner, m, take = np.repeat(numbers, n), numbers.size, repeated_values(designs, n)

        def tiled(row: np.ndarray) -> np.ndarray:
            return np.tile(row, m)

        if self.motions is not None:
            return self.state(tiled(angles.theta), tiled(angles.piece), owner), owner, take
        state, unit = self.program.state(angles), angles.unit  # the motion is the same for all
        every = Angles(tiled(angles.theta), tiled(angles.piece), unit=lambda: tiled(unit))
        displacement = Derivatives(lambda order: tiled(state.displacement[order]))
        within = lambda: np.tile(state.within, (1, m))  # noqa: E731
        return MotionState(every, displacement, tiled(state.velocity_sign), within), owner, take

    def failed_at(self, stage: str) -> np.ndarray:
        """Mask of designs that have no solution at a stage.

        Returns
        -------
        ndarray (m,), dimensionless
        """
        before = _STAGES[1 : _STAGES.index(stage) + 1]
        return np.any([self.no_design, *(self.failed[s] for s in before if s in self.failed)], axis=0)

    def _error_searches(self, stages: set[str], loads: bool) -> list[tuple[str, float]]:
        """Searches that decide whether friction jams, and whether a flank is undercut."""
        searches = [(JAM, 1.0)] if (loads or "dynamics" in stages) and self.loading.has_friction else []
        if stages & {"cam", "dynamics"}:
            drive, recorder = self.plain.drive, _ReadRecorder()
            for flank in self._flanks():
                cam.undercut(recorder, flank, drive.face, drive.cam)
            searches += recorder.read
        return searches

    def _flanks(self) -> tuple[str, ...]:
        if not self.plain.drive.has_disk:
            return ()
        return cam.form_row(self.plain.drive.cam.form).flanks

    def _undercut(self, extremes: Mapping[str, Extremes]) -> dict[str, np.ndarray]:
        """Flank -> mask (m,) of designs in which it is undercut."""
        drive = self.design.drive
        with np.errstate(all="ignore"):
            return {
                flank: np.asarray(cam.undercut(extremes, flank, drive.face, drive.cam)) & ~self.no_design
                for flank in self._flanks()
            }

    def _is_periodic(self, name: str) -> np.ndarray | None:
        """Mask (m,) of designs in which the angle of a link rotates with the crank, without extremes; None for other quantities."""
        sort, _, link = name.partition(".")
        if sort != "link" or not link.isdecimal() or not self.plain.by_crank:
            return None
        angle = self._angles.get(int(link))
        return None if angle is None else np.abs(angle[:, -1] - angle[:, 0]) > np.pi

    @property
    def _corners(self) -> np.ndarray:
        """Mask (m,) of designs whose velocity jumps: the pitch curve has a corner there, which undercuts any profile."""
        if self.motions is not None:
            return self.motions.corners
        return np.full(self.count, any(join.jumps[:2].any() for join in self.program.joins))

    def _jam_codes(self, jammed: np.ndarray, theta: np.ndarray) -> dict[int, str]:
        """Design -> code of the pair that jams most, at cam angles (m,) of the plain design."""
        if not jammed.size:
            return {}
        at = self.program.angles(theta[jammed])
        with collecting_failures(lambda code, fails: None), np.errstate(all="ignore"):
            forces = self.study(self.state(at.theta, at.piece, jammed), jammed).dynamics
            rows = (np.broadcast_to(row, jammed.shape) for row in (forces.contact_jam, forces.most_jamming))
        frictions, codes = self.loading.frictions, {}
        for k, contact, most in zip(jammed.tolist(), *(row.tolist() for row in rows), strict=True):
            pair = None if not frictions or contact >= dynamics.JAMS else frictions[int(most)]
            codes[k] = dynamics.jam_finding(Extreme(1.0, 0.0), pair).code
        return codes


def equal_parts(count: int, angles: int) -> list[slice]:
    """Slices of designs with this number of angles each, of equal size, for at most MAX_POSITIONS positions at a time."""
    size = ceil(count / ceil(count / max(1, MAX_POSITIONS // angles)))
    return [slice(first, min(first + size, count)) for first in range(0, count, size)]


def _taken(part: tuple[Any, Any], take: ColumnMap, cache: dict[int, Any]) -> Any:
    """A part with its columns taken; ``cache`` maps columns, by identity, to what they became."""
    original, make = part
    return original if make is None else make(take, cache)


_STAGES = ("motion", "linkage", "cam", "dynamics")
JAM = "jam"
_SIDES = {"max": (1.0,), "min": (-1.0,), "abs": (-1.0, 1.0), "range": (-1.0, 1.0), "rms": (), "mean": ()}


def _cusp_extremes(curvature: Extremes, has_cusp: np.ndarray) -> Extremes:
    """Extremes of a curvature, infinite for designs with a cusp (m,): the profile runs backwards there, however short."""
    low, high = curvature.low, curvature.high
    return Extremes(
        Extreme(np.where(has_cusp, -np.inf, low.value), low.theta),  # type: ignore[arg-type]
        Extreme(np.where(has_cusp, np.inf, high.value), high.theta),  # type: ignore[arg-type]
    )


class _ReadRecorder(dict[str, Any]):
    """Takes the place of extremes, and records which sides of which quantities are read."""

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
