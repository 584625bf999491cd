"""All searches for a dimension or a machine: those of ``core.find``, and those that are studies."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple

from core.design import Design
from core.errors import KindynaError
from core.find import SEARCHES as FIND_SEARCHES
from core.find import SHAFT_SEARCHES, Solution, StatedLimits, find, round_solution
from core.varying.request import VariedField
from core.varying.top_speed import TITLE, TOP_SPEED, default_limits, find_top_speed, has_top_speed


class MachineSearch(NamedTuple):
    """A search for the whole machine.

    Attributes
    ----------
    title : str
        Heading.
    is_available : callable
        Whether a design has what is searched for.
    default_limits : callable
        Keys of the limits for a design, with their default values, None where there is none.
    aims : dict
        Quantities one of which is minimised, where there is a choice.
    """

    title: str
    is_available: Callable[[Design], bool]
    default_limits: Callable[[Design], Mapping[str, float | None]]
    aims: Mapping[str, str] = MappingProxyType({})


MACHINE_SEARCHES: Mapping[str, MachineSearch] = MappingProxyType(
    {
        **{
            what: MachineSearch(row.title, row.is_available, row.default_limits, row.aims)
            for what, row in SHAFT_SEARCHES.items()
        },
        TOP_SPEED: MachineSearch(TITLE, has_top_speed, default_limits),
    }
)
"""Key of a search for the whole machine -> its row."""

SEARCHES: Mapping[str, str] = MappingProxyType(
    {
        **FIND_SEARCHES,
        TOP_SPEED: "the fastest machine within its limits: speed, spans and laws of segments that are no process windows, phases",
    }
)
"""Key of a search -> its help."""


def search(
    design: Design,
    what: str,
    stated: StatedLimits,
    *,
    vary: Sequence[VariedField] = (),
    notify: Callable[[int], object] = lambda count: None,
    rounding: float | None = None,
    **options: Any,
) -> Solution:
    """Solve a search.

    Parameters
    ----------
    design : Design
        One drive, or the whole machine for ``MACHINE_SEARCHES``.
    what : str
        Key of ``SEARCHES``.
    stated : dict
        Key of a limit, or path of a field with _min or _max -> value; None removes the limit.
    vary : sequence of VariedField
        Fields that the top speed varies.
    notify : callable
        Called with the number of designs, or of steps, so far.
    rounding : float or None
        Step to which the values are rounded, as of ``core.find.find``.
    **options
        Of ``core.find.find``.

    Raises
    ------
    KindynaError
        Where the search or a limit does not exist, or nothing solves it.
    """
    if what not in SEARCHES:
        raise KindynaError(f"find {what!r}: unknown; allowed: {' | '.join(SEARCHES)}")
    if what == TOP_SPEED:
        solution = find_top_speed(design, stated, vary, notify)
        return solution if rounding is None else round_solution(solution, design, rounding)
    if vary:
        raise KindynaError(
            f"--vary: {what} varies its own field; allowed: {TOP_SPEED}, or its bounds as --limit PATH_max=VALUE"
        )
    if what not in SHAFT_SEARCHES:
        options["notify"] = notify
    return find(design, what, stated, rounding=rounding, **options)


def available_machine_searches(design: Design) -> tuple[str, ...]:
    """Keys of ``MACHINE_SEARCHES`` that are available for a design."""
    return tuple(what for what, row in MACHINE_SEARCHES.items() if row.is_available(design))
