"""Designs, edited by the paths of their files; the results that hold one: studies, searches."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from core.commands.common import LEAST_SAMPLES, MOST_SAMPLES, studied
from core.design.design import Design as CoreDesign
from core.errors import KindynaError
from core.output.summary import to_json
from core.project import from_table, load, loads, one_of, save
from core.project.reading_faults import subjects
from core.project.writing import dumps
from core.study.many import many
from core.study.study import Study as CoreStudy
from kindyna._checks import (
    Array,
    brief,
    mapping,
    number,
    path_of,
    path_to_write,
    read_only,
    text,
    texts,
    unknown,
    vector,
    whole,
)
from kindyna._columns import Columns
from kindyna._fields import edited_design, file_values
from kindyna._options import names_arguments, requested
from kindyna._results import Finding, ManyResult, many_result
from kindyna._study import StudyResults

__all__ = ["Design", "FindResult", "Optimum", "Study", "design", "example", "examples", "measured", "open"]


@dataclass(frozen=True, repr=False)
class Design:
    """A design: what was typed, without results. It cannot be changed; designs of equal content are equal.

    ``d[path]`` is the value at a path, spelled as in files: ``d["cam.base_radius_mm"]``, ``d["motion.segments[1].law"]``,
    ``d["linkage.links[2].points.B.x_mm"]``.

    Examples
    --------
    >>> import kindyna as kd
    >>> d = kd.example("transfer_lift")
    >>> d["cam.base_radius_mm"]
    400.0
    >>> d.edit({"cam.base_radius_mm": 430.0}).study().extreme("pressure_angle_deg")
    Extreme(value=19.02..., angle_deg=305.7..., unit='°')
    """

    _design: CoreDesign

    @property
    def name(self) -> str:
        """Name of the design."""
        return self._design.name

    @property
    def kind(self) -> str:
        """Kind of mechanism: of a follower, ``linkage``, ``motion``; ``shaft`` where drives are listed."""
        return "shaft" if self._design.listed else self._design.drive.kind

    @property
    def toml(self) -> str:
        """Text of its file, with all digits of every number."""
        return dumps(self._design)

    def __getitem__(self, path: str) -> Any:
        values = file_values(self._design)
        if text("path", path) not in values:
            raise unknown("field of this design", path, values)
        return values[path]

    def fields(self) -> dict[str, float | int | str | bool | None]:
        """Return path -> value of every number, word and flag that can be edited; None for an optional one that is not given.

        Examples
        --------
        >>> import kindyna as kd
        >>> kd.example("transfer_lift").fields()["follower.rod_mm"]
        845.0
        """
        return {path: value for path, value in file_values(self._design).items() if not isinstance(value, tuple)}

    def edit(self, values: Mapping[str, Any]) -> Design:
        """Return the design with other values, all set at once.

        Neighbours that must follow do so, as in the window: where a span or a rise changes, the segments that are not named make up
        for it.

        Parameters
        ----------
        values : mapping of str -> float, int, str, bool or None
            Path -> new value; None removes an optional one.

        Raises
        ------
        KeyError
            The design lacks a path.
        TypeError, ValueError
            A value is not of the kind of its field, or not finite.
        KindynaError
            The new design has faults; ``faults`` lists all of them.

        Examples
        --------
        >>> import kindyna as kd
        >>> d = kd.example("transfer_lift").edit({"motion.segments[1].span_deg": 50.0, "motion.segments[1].law": "cycloidal"})
        >>> d["motion.segments[1].law"], round(d["motion.segments[2].span_deg"], 6)
        ('cycloidal', 198.5)
        """
        self._require_fields("values", values)
        return Design(edited_design(self._design, values))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the design to a file, whole or not at all.

        Parameters
        ----------
        path : str or path
            The file, by custom ``NAME.toml``; its folder is created, and a file of this name replaced.

        Raises
        ------
        KindynaError
            It cannot be written.

        Examples
        --------
        >>> import kindyna as kd
        >>> d = kd.example("rocker_cam")
        >>> d.save("rocker.toml")
        >>> kd.open("rocker.toml") == d
        True
        """
        save(self._design, path_to_write("path", path))

    @names_arguments
    def study(self, samples: int = 360, drive: str = "") -> Study:
        """Return a study at equally spaced angles.

        Parameters
        ----------
        samples : int
            Angles per turn.
        drive : str
            Name of a drive, of a design that lists them; without it the drives together on their shaft.

        Raises
        ------
        KindynaError
            There is no such drive.

        Examples
        --------
        >>> import kindyna as kd
        >>> kd.example("transfer_lift").study(samples=1440).angle_deg[:3].tolist()
        [0.0, 0.25, 0.5]
        >>> kd.example("transfer_unit").study(drive="Lift")
        <kindyna.Study 360 angles of 'Transfer unit, drive Lift'>
        """
        count = whole("samples", samples)
        if not LEAST_SAMPLES <= count <= MOST_SAMPLES:
            raise ValueError(f"samples = {count}: angles per turn; allowed: {LEAST_SAMPLES} ... {MOST_SAMPLES}")
        only = one_of(self._design, drive) if text("drive", drive) else self._design
        return Study(self if only is self._design else Design(only), Columns(CoreStudy(only, count), None))

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Limits that the design exceeds, errors first. Raises KindynaError where the mechanism has no solution."""
        return self.study().findings

    @names_arguments
    def find(
        self, goal: str, limits: Mapping[str, float | None] | None = None, drive: str = "", **options: Any
    ) -> FindResult:
        """Return the dimension that its limits allow, as the command ``find``.

        Parameters
        ----------
        goal : str
            ``base-radius``, ``offset``, ``spring``, ``flywheel`` and others, as the command lists them.
        limits : mapping of str -> float or None
            Limit, or a varied field's path with ``_min`` or ``_max`` -> value; None removes a typical limit.
        drive : str
            Name of a drive, of a design that lists them.
        **options : number, text, flag or list
            Options of the command: ``for_``, the property of the torque that phases minimise; ``vary``, a list of ``PATH=LOW:HIGH`` for
            ``top-speed``; ``round``, the step of the values, True for the default steps.

        Raises
        ------
        KeyError
            There is no such goal or option.
        TypeError, ValueError
            A limit or an option has a wrong value.
        KindynaError
            There is no such limit, or no value satisfies every limit; the text has the best one.

        Examples
        --------
        >>> import kindyna as kd
        >>> f = kd.example("transfer_lift").find("base-radius", limits={"pressure_angle_return_deg": 20})
        >>> f.answer["cam.base_radius_mm"], f.curve.shape
        (378.45..., (44, 2))
        """
        from core.commands.find import FindArguments, search  # a design is edited and studied without it
        from core.varying import SEARCHES

        if text("goal", goal) not in SEARCHES:
            raise unknown("goal of find", goal, SEARCHES)
        given = tuple(
            (text("limit", key), None if value is None else number(key, value))
            for key, value in mapping("limits", limits or {}).items()
        )
        fixed = {"design": Path(), "what": goal, "drive": text("drive", drive), "limit": given}
        solution = search(self._design, requested(FindArguments, options, "into", "json", **fixed))
        answer = {path: _plain(value) for path, value in solution.answer.items()}
        if not solution.is_valid:
            raise _no_solution(f"find {goal}: no value satisfies every limit", answer, solution.violations)
        curve = read_only(np.array(solution.curve, dtype=float).reshape(-1, 2))
        reached = {key: float(value) for key, value in solution.reached.items()}
        binding = tuple({"limit": limit, "per_percent": change} for limit, change in solution.binding)
        return FindResult(answer, reached, curve, Design(solution.machine), self._before(answer), binding)

    def many(
        self,
        values: Mapping[str, ArrayLike],
        quantities: Sequence[str],
        polish: bool = True,
        executor: Executor | None = None,
    ) -> ManyResult:
        """Return figures of m designs that differ in some numbers.

        Parameters
        ----------
        values : mapping of str -> ndarray (m,) [unit at the end of the path]
            Path -> its numbers.
        quantities : sequence of str
            Channel and statistic, as ``pressure_angle_deg:max``: max, min, abs, rms, mean, range; or a total.
        polish : bool
            Refine the extremes; without it they are those of the nodes, to about 1e-3.
        executor : concurrent.futures.Executor, optional
            Evaluates blocks of designs; the values do not depend on it.

        Raises
        ------
        KeyError
            The design lacks a path.
        TypeError, ValueError
            The numbers have no common shape (m,), or there is no such quantity.

        Examples
        --------
        >>> import numpy as np
        >>> import kindyna as kd
        >>> m = kd.example("transfer_lift").many({"cam.base_radius_mm": np.linspace(390, 420, 1000)}, ["drive_torque_nm:abs"])
        >>> m.value["drive_torque_nm:abs"].shape, round(m.value["drive_torque_nm:abs"].min())
        ((1000,), 7503)
        """
        self._require_fields("values", values)
        inputs = {path: vector(path, numbers) for path, numbers in values.items()}
        return many_result(
            inputs, many(self._design, inputs, texts("quantities", quantities), polish=polish, executor=executor)
        )

    @names_arguments
    def vary(
        self, values: Mapping[str, Sequence[float | str] | ArrayLike], quantities: Sequence[str], workers: int = 1
    ) -> ManyResult:
        """Return figures of all combinations of values, the first field changing slowest, as the command ``vary``.

        Parameters
        ----------
        values : mapping of str -> list or ndarray of numbers, list of words, or (low, high, steps)
            Path -> its values; a tuple is a range of so many values, its ends included.
        quantities : sequence of str
            As for ``many``.
        workers : int
            Processes that compute.

        Raises
        ------
        KeyError
            The design lacks a path.
        TypeError, ValueError
            A value is of the wrong kind.
        KindynaError
            A field does not accept a value, a quantity does not exist, or there are too many designs; ``faults`` lists all that is wrong.

        Examples
        --------
        >>> import kindyna as kd
        >>> fields = {"cam.base_radius_mm": (390, 420, 3), "motion.segments[1].law": ["modified-sine", "cycloidal"]}
        >>> m = kd.example("transfer_lift").vary(fields, ["pressure_angle_deg:max"])
        >>> m.inputs["cam.base_radius_mm"].tolist()
        [390.0, 390.0, 405.0, 405.0, 420.0, 420.0]
        """
        from core.varying.space import Space, study_values
        from core.varying.space import workers as processes
        from kindyna._varied import fixed_column, process_count, varied_study, varied_values

        self._require_fields("values", values)
        fields = {path: varied_values(path, given) for path, given in values.items()}
        study = varied_study(self._design, fields, quantities={key: {} for key in texts("quantities", quantities)})
        space = Space(study)
        space.require_few()
        columns = space.columns(0, space.count)
        with processes(process_count(workers)) as (executor, _):
            results = study_values(study, columns, executor=executor)
        return many_result({path: fixed_column(column) for path, column in columns.items()}, results)

    @names_arguments
    def optimise(
        self,
        vary: Mapping[str, tuple[float, float] | Sequence[str]],
        minimise: str = "",
        limits: Mapping[str, Mapping[str, float]] | None = None,
        *,
        maximise: str = "",
        **options: Any,
    ) -> Optimum:
        """Return the best design within limits, as the command ``optimise``.

        Parameters
        ----------
        vary : mapping of str -> (low, high) or list of words
            Path -> its bounds, or its choices.
        minimise : str
            Figure to be minimised, as ``drive_torque_nm:abs``, a total, or the path of a varied number.
        limits : mapping of str -> mapping, optional
            Figure -> its least value ``min`` and greatest value ``max``.
        maximise : str, optional
            Figure or path to be maximised, in place of ``minimise``: ``shaft.speed_rpm`` gives the fastest machine.
        **options : number, text, flag or list
            Options of the command: ``round``, the step of the values, True for the default steps.

        Raises
        ------
        KeyError
            The design lacks a path, or there is no such option.
        TypeError, ValueError
            A bound, limit or option is of the wrong kind.
        KindynaError
            A field does not accept a bound, a figure does not exist (``faults`` lists all that is wrong), or no design satisfies every
            limit; the text has the best one.

        Examples
        --------
        >>> import kindyna as kd
        >>> o = kd.example("rocker_cam").optimise(
        ...     vary={"cam.base_radius_mm": (40, 90)},
        ...     minimise="drive_torque_nm:abs",
        ...     limits={"pressure_angle_deg:max": {"max": 35}},
        ... )
        >>> round(o.answer["cam.base_radius_mm"], 2), round(o.goal, 3)
        (57.55, 5.492)
        """
        from core.commands.studies import OptimiseArguments, best_design, optimum_data
        from kindyna._varied import limit_ends, varied_range, varied_study

        self._require_fields("vary", vary)
        fields = {path: varied_range(path, bounds) for path, bounds in vary.items()}
        ends = {key: limit_ends(key, values) for key, values in mapping("limits", limits or {}).items()}
        if bool(text("minimise", minimise)) == bool(text("maximise", maximise)):
            raise ValueError(f"minimise = {minimise!r}, maximise = {maximise!r}: give one of the two")
        goal = {minimise or maximise: {"minimise": bool(minimise)}}
        study = varied_study(self._design, fields, limits=ends, goals=goal)
        request = requested(OptimiseArguments, options, "into", "json", study=Path())
        optimum, notes = best_design(study, request)
        if not optimum.is_feasible:
            raise _no_solution("optimise: no design satisfies every limit", optimum.answer, (*notes, optimum.rejection))
        row = optimum_data(optimum, notes)
        return Optimum(
            row["answer"],
            float(row["goal"]),
            tuple(row["binding"]),
            row["starts"],
            row["agreeing"],
            Design(optimum.design),
            self._before(row["answer"]),
        )

    def compare(self, other: Design) -> dict[str, Any]:
        """Return inputs that differ, results of both and their findings, as ``compare --json``.

        Parameters
        ----------
        other : Design
            The second design.

        Raises
        ------
        KindynaError
            One of them has no solution.

        Examples
        --------
        >>> import kindyna as kd
        >>> d = kd.example("transfer_lift")
        >>> d.compare(d.edit({"cam.base_radius_mm": 430.0}))["inputs"]
        [{'path': 'cam.base_radius_mm', 'a': 400.0, 'b': 430.0}]
        """
        from json import loads as parsed

        from core.output.compare import compare_designs, compared_design, comparison_data

        if not isinstance(other, Design):
            raise TypeError(f"other = {other!r}: a Design is needed, not {type(other).__name__}")
        sides = (compared_design(studied(design)) for design in (self._design, other._design))
        data: dict[str, Any] = parsed(to_json(comparison_data(compare_designs(*sides))))
        return data

    def __repr__(self) -> str:
        return brief(f"<kindyna.Design {self.kind}: {self.name!r}>")

    def _repr_html_(self) -> str:
        return self.study()._repr_html_()

    def _ipython_key_completions_(self) -> list[str]:
        return list(file_values(self._design))

    def _require_fields(self, what: str, values: Any) -> None:
        """Raise TypeError for no mapping, KeyError where the design lacks one of its paths."""
        known = file_values(self._design)
        for path in mapping(what, values):
            if text("path", path) not in known:
                raise unknown("field of this design", path, known)

    def _before(self, answer: Iterable[str]) -> dict[str, Any]:
        values = file_values(self._design)
        return {path: values[path] for path in answer if path in values}


def _plain(value: Any) -> Any:
    """Return a word as it is, and a number as a float."""
    return value if isinstance(value, str) else float(value)


def _values_text(values: Mapping[str, Any]) -> str:
    """Return values with nine digits: ``cam.base_radius_mm = 378.458808, motion.segments[1].law = cycloidal``."""
    return ", ".join(
        f"{path} = {value if isinstance(value, str) else f'{value:.9g}'}" for path, value in values.items()
    )


def _no_solution(problem: str, best: Mapping[str, Any], violations: Iterable[str]) -> KindynaError:
    """Return the error with the best that there is."""
    return KindynaError(f"{problem}; the best, {_values_text(best)}, violates: {'; '.join(filter(None, violations))}")


# -- results that hold a design ----------------------------------------------------------------------------------


class Study(StudyResults["Design"]):
    """A design and what follows from it; each result is computed when it is first read.

    ``s[name]`` is a channel's values at the angles of the study, ndarray (n,) in the unit of its name; ``channels`` lists them.

    Examples
    --------
    >>> import kindyna as kd
    >>> s = kd.example("transfer_lift").study(samples=720)
    >>> s["drive_torque_nm"].shape
    (720,)
    >>> s.at([58.0, 59.0])["pressure_angle_deg"].round(3).tolist()
    [17.59, 17.587]
    >>> s.profile()[0].round(3).tolist()
    [343.772, 327.79]
    """


@dataclass(frozen=True, eq=False, repr=False)
class FindResult:
    """A dimension that satisfies every limit.

    Attributes
    ----------
    answer : path -> value, a number or a word
    reached : limit -> value reached with the answer
    curve : ndarray (n, 2), the varied value and what it reaches; of the top speed the speed after each step of the search
    design : the design with the answer
    binding : what holds the top speed, the strongest first, each with ``limit`` and ``per_percent``, the change for 1 % of relief

    Examples
    --------
    >>> import kindyna as kd
    >>> f = kd.example("transfer_lift").find("base-radius", limits={"pressure_angle_return_deg": 20})
    >>> f
    <kindyna.FindResult cam.base_radius_mm = 378.458808>
    >>> round(f.design.study().extreme("pressure_angle_deg").value, 6)
    20.0
    """

    answer: Mapping[str, Any]
    reached: Mapping[str, float]
    curve: Array
    design: Design
    _before: Mapping[str, Any]
    binding: Sequence[Mapping[str, Any]] = ()

    def _repr_html_(self) -> str:
        from kindyna._html import found_html  # only notebooks need it

        return found_html(self.design.study()._columns, self._before, self.answer, self.reached)

    def __repr__(self) -> str:
        return brief(f"<kindyna.FindResult {_values_text(self.answer)}>")


@dataclass(frozen=True, eq=False, repr=False)
class Optimum:
    """The best design within limits.

    Attributes
    ----------
    answer : path -> value, a number or a word
    goal : the figure that is minimised
    binding : active limits, each with ``limit`` and ``per_percent``, the change of the goal for 1 % more of it
    starts : number of starts of the search
    agreeing : number of starts that led to this design
    design : the design

    Examples
    --------
    >>> import kindyna as kd
    >>> d = kd.example("rocker_cam")
    >>> limits = {"pressure_angle_deg:max": {"max": 35}}
    >>> o = d.optimise({"cam.base_radius_mm": (40, 90)}, minimise="drive_torque_nm:abs", limits=limits)
    >>> f"{o.answer['cam.base_radius_mm']:.2f}", f"{o.goal:.3f}"
    ('57.55', '5.492')
    """

    answer: Mapping[str, Any]
    goal: float
    binding: tuple[Mapping[str, Any], ...]
    starts: int
    agreeing: int
    design: Design
    _before: Mapping[str, Any]

    def _repr_html_(self) -> str:
        from kindyna._html import optimum_html

        note = f"best of {self.starts} starts, {self.agreeing} of which lead to it"
        columns = self.design.study()._columns
        return optimum_html(columns, self._before, self.answer, self.goal, self.binding, note)

    def __repr__(self) -> str:
        return brief(f"<kindyna.Optimum {self.goal:.9g}: {_values_text(self.answer)}>")


# -- where designs come from ------------------------------------------------------------------------------------


def open(path: str | os.PathLike[str]) -> Design:
    """Return the design in a file.

    Parameters
    ----------
    path : str or path
        A design file (``.toml``).

    Raises
    ------
    KindynaError
        It cannot be read; ``faults`` lists all wrong entries.

    Examples
    --------
    >>> import kindyna as kd
    >>> kd.example("four_bar").save("four_bar.toml")
    >>> kd.open("four_bar.toml") == kd.example("four_bar")
    True
    """
    return Design(load(path_of("path", path)))


def design(table: Mapping[str, Any] | str) -> Design:
    """Return the design in tables, with keys as in files, or in the text of a file.

    Parameters
    ----------
    table : mapping or str
        Tables as nested mappings, or the text of a design file. The table that is present, ``follower``, ``linkage`` or ``drives``,
        tells the kind of design; ``motion`` alone is a design too.

    Raises
    ------
    KindynaError
        Keys are unknown or missing, or values are out of their range; ``faults`` lists all of them.

    Examples
    --------
    >>> import kindyna as kd
    >>> rise = {"law": "cycloidal", "span_deg": 180.0, "rise_mm": 20.0}
    >>> segments = [rise, {**rise, "rise_mm": -20.0}]
    >>> d = kd.design({"format": 1, "name": "Lift", "motion": {"start_mm": 0.0, "segments": segments}})
    >>> d
    <kindyna.Design motion: 'Lift'>
    >>> round(d.study().extreme("displacement_mm").value, 9)
    20.0
    """
    if isinstance(table, str):
        return Design(loads(table))
    if not isinstance(table, Mapping):
        raise TypeError(f"table = {table!r}: a mapping or the text of a file is needed, not {type(table).__name__}")
    return Design(from_table(table))


@names_arguments
def measured(table: str | os.PathLike[str], **options: Any) -> Design:
    """Return the motion of a measured table as a design of its own, as the command ``measured``.

    Parameters
    ----------
    table : str or path
        CSV, text or workbook with a row for each angle.
    **options : number, text, flag or list
        Options of the command, with ``_`` for ``-``: ``column``, ``columns``, ``sheet``, ``speed``, ``error``, ``leave_out``, ``half``,
        ``mirror``, ``no_laws``, ``controller`` and others.

    Raises
    ------
    KeyError
        There is no such option.
    TypeError, ValueError
        An option has a wrong value.
    KindynaError
        The table cannot be read, or no motion fits it; ``faults`` lists its wrong cells.

    Examples
    --------
    >>> import kindyna as kd
    >>> import numpy as np
    >>> lift = kd.example("tappet_flat").study(samples=72)
    >>> rows = np.column_stack((lift.angle_deg, lift["displacement_mm"].round(4)))
    >>> np.savetxt("lift.csv", rows, delimiter=",", header="cam_angle_deg,lift_mm", comments="")
    >>> kd.measured("lift.csv", speed=300)
    <kindyna.Design motion: 'lift'>
    """
    from core.commands.tables import MeasuredArguments, measured_design  # few designs are measured

    left_out = ("segment", "as_is", "joined", "into", "drive", "json")
    request = requested(MeasuredArguments, options, *left_out, table=Path(path_of("table", table)))
    return Design(measured_design(request))


def example(slug: str) -> Design:
    """Return an example.

    Parameters
    ----------
    slug : str
        Its name in ``examples()``.

    Raises
    ------
    KeyError
        There is no such example; the text names the nearest.

    Examples
    --------
    >>> import kindyna as kd
    >>> kd.example("rocker_cam")
    <kindyna.Design oscillating: 'Rocker with a roller'>
    """
    rows = {row.file: row.path for _, examples in subjects() for row in examples}
    if text("slug", slug) not in rows:
        raise unknown("example", slug, rows)
    return Design(load(rows[slug]))


def examples() -> dict[str, str]:
    """Return name -> title of all examples, in the order of the window's menu.

    Examples
    --------
    >>> import kindyna as kd
    >>> kd.examples()["transfer_lift"]
    'Transfer lift'
    """
    return {row.file: row.name for _, rows in subjects() for row in rows}
