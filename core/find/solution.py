"""The solution of a search, and the judgement of other values of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import field, replace
from types import MappingProxyType
from typing import Any, NamedTuple

from core.design import Design
from core.find.trial import FindingsCheck, MachineOf
from core.findings import ERROR
from core.frozen import frozen
from core.study import Study, findings_of

ROOT_DIGITS = 9  # certain digits of a root


class Judgement(NamedTuple):
    """The design with given values of a search, and what the limits of the search say about it.

    Attributes
    ----------
    design : Design
    answer : dict
        Path -> value, of the varied fields and of those that change with them.
    reached : dict
        Limit -> value reached, in its unit.
    violations : tuple of str
        Violated limits and new findings; empty where every limit is satisfied.
    """

    design: Design
    answer: Mapping[str, float]
    reached: Mapping[str, float]
    violations: tuple[str, ...]


class Judge(NamedTuple):
    """Paths of the varied fields of a search, and the function that judges values of them."""

    paths: tuple[str, ...]
    at: Callable[[Mapping[str, float]], Judgement]


def out_of_bounds(
    values: Mapping[str, float], bounds: Mapping[str, tuple[float | None, float | None]]
) -> tuple[str, ...]:
    """Texts for values outside their bounds; None: no bound."""
    return tuple(
        f"{path} = {value:.9g}: outside its bounds"
        for path, value in values.items()
        for low, high in [bounds.get(path, (None, None))]
        if not (-math.inf if low is None else low) <= value <= (math.inf if high is None else high)
    )


_EMPTY: Mapping[str, Any] = MappingProxyType({})


@frozen
class Solution:
    """Result of a search.

    Attributes
    ----------
    target : str
        Which of the values within the limits it is.
    design : Design
        With the result; with the values of `applied` in place of it.
    answer : dict
        Path -> value as in the file.
    reached : dict
        Limit -> value reached, in its unit; infinite where the figure does not exist.
    limits : dict
        Limit -> its value.
    curve : tuple of (float, float)
        Values of the first field, or of `curve_over`, and of the figure `curve_of`.
    curve_over : str
        Name of the first values where they are not those of a field; else empty.
    near : (float, float)
        Range of the first field about the solution and the present value, in which the curve is close.
    present : dict
        Path -> value in the present design; None where it has none.
    before : dict
        Limit, of all that exist -> value reached by the present design; empty where this has no cam. Of a rounded result also
        the largest torque of the cam.
    violations : tuple of str
        Why the result is not valid; empty where it satisfies every limit.
    end : str
        Bound at which the solution is, where no limit determines it; else empty.
    digits : int
        Certain significant digits of the result.
    reasons : dict
        Limit -> reason of its value, for limits that the user did not state.
    next_findings : tuple of str
        New findings with the next value, which determine the solution where no limit does.
    notes : tuple of str
        Notes with the result, where no result is free of them.
    applied : dict
        Path -> value that also enters the machine: a speed below a result that is a fact, or the flywheel it now
        requires.
    complete : Design or None
        The machine with all that; None: `design`.
    assumed : dict
        Path -> assumed value on which the result depends.
    binding : tuple of (str, float)
        Limit that holds the result -> its change for 1 % of relief, the strongest first; of the top speed.
    judge : Judge or None
        Judgement of other values of the result.
    exact : dict
        Path -> exact value of a rounded result; empty where it is not rounded.
    rounding : dict
        Path -> step to which it is rounded.
    cost : dict
        Quantity -> its value with the exact and with the rounded result.
    """

    target: str
    design: Design
    answer: Mapping[str, float]
    reached: Mapping[str, float]
    limits: Mapping[str, float]
    curve: tuple[tuple[float, float], ...]
    curve_of: str
    near: tuple[float, float]
    present: Mapping[str, float | None]
    before: Mapping[str, float]
    violations: tuple[str, ...] = ()
    end: str = ""
    digits: int = ROOT_DIGITS
    reasons: Mapping[str, str] = field(default_factory=lambda: _EMPTY)
    next_findings: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    applied: Mapping[str, float] = field(default_factory=lambda: _EMPTY)
    complete: Design | None = None
    assumed: Mapping[str, float] = field(default_factory=lambda: _EMPTY)
    binding: tuple[tuple[str, float], ...] = ()
    curve_over: str = ""
    judge: Judge | None = field(default=None, compare=False, repr=False)
    exact: Mapping[str, float] = field(default_factory=lambda: _EMPTY)
    rounding: Mapping[str, float] = field(default_factory=lambda: _EMPTY)
    cost: Mapping[str, tuple[float, float]] = field(default_factory=lambda: _EMPTY)

    @property
    def is_valid(self) -> bool:
        """Whether the result satisfies every limit."""
        return not self.violations

    @property
    def machine(self) -> Design:
        """The machine with the result."""
        return self.design if self.complete is None else self.complete

    @property
    def errors(self) -> tuple[str, ...]:
        """Errors of the cam that no limit of the search covers, for example of its hub or its cutter."""
        if not self.is_valid or all(not drive.has_disk for drive in self.design.drives):
            return ()
        findings = findings_of(Study(self.design), ("cam",))
        return tuple(finding.message for finding in findings if finding.severity == ERROR)


def search_with_findings(
    search: Callable[[FindingsCheck], Solution], design: Design, machine: MachineOf, waived: Collection[str]
) -> Solution:
    """Solution of a search that adds no finding to the machine; where every solution adds notes, with these."""
    checked = FindingsCheck(design, machine, waived)
    solution = search(checked)
    if solution.is_valid or not checked.has_notes:
        return solution
    solution = search(FindingsCheck(design, machine, waived, notes=False))
    return replace(solution, notes=checked.new(solution.design)) if solution.is_valid else solution
