"""Which quantities a plot of the window shows: its usual ones, or of a design without them those of links that stand for them;
and why others cannot be drawn."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache, partial
from math import isfinite
from types import MappingProxyType

import numpy as np

from core.design import Design
from core.errors import KindynaError
from core.output.channels import channels, existing
from core.stress import RollerLife
from core.study import STAGES, Quantity, Study, quantities_of, quantity, roller_lives
from core.study.quantities import OF_MEMBERS, TRANSMISSION, member_of, names_of, shape_of
from kindyna_gui.labels import grouped, reason
from kindyna_gui.pictures.plots.curves import different
from kindyna_gui.requirements import LED_BY_NO_CAM, why_no_pressure

NO_TURN = 1e-9  # [rad] a link that turns less than this does not turn
MOST = 4  # curves in one plot that can still be told apart
Pick = Callable[[tuple[str, ...]], list[str]]


def _first(*wanted: str) -> Pick:
    return lambda names: [next((n for n in wanted if n in names), "")]


def _of(*shapes: str) -> Pick:
    """The names of the first of these shapes that has any."""
    return _or(*(partial(_shaped, shape) for shape in shapes))


def _shaped(shape: str, names: tuple[str, ...]) -> list[str]:
    return [n for n in names if shape_of(n) == shape]


def _or(*picks: Pick) -> Pick:
    """The names of the first pick that has any."""

    def pick(names: tuple[str, ...]) -> list[str]:
        chosen: list[str] = []
        for each in picks:
            chosen = chosen or [n for n in each(names) if n]
        return chosen

    return pick


_PLOTS: Mapping[str, Pick] = MappingProxyType(
    {
        "displacement": _or(_first("displacement"), _of("link.{}", "slide.{}")),
        "velocity": _or(_first("velocity"), _of("link.{}_velocity", "slide.{}_velocity")),
        "acceleration": _or(_first("acceleration"), _of("link.{}_acceleration", "slide.{}_acceleration")),
        "pressure_angle": _or(_first("pressure_angle"), _of(TRANSMISSION)),
        "pitch_curvature": _first("pitch_curvature", "profile_curvature"),
        "drive_torque": _first("drive_torque", "driver_torque", "driver_force", "force", "output_torque"),
        "contact_force": _or(_first("contact_force"), _of("force.{}_size"), _first("output_power")),
    }
)
"""First quantity of a plot of the window -> what it shows of a linkage: of those that turn, or where none does, of those that slide."""


def quantities_for(study: Study, usual: Sequence[str]) -> tuple[str, ...]:
    """The quantities of a plot: the usual ones that the design can have, or those that stand in their place."""
    possible = names_of(study.design)
    if usual[0] in possible:
        return tuple(n for n in usual if n in possible)
    pick = _PLOTS.get(usual[0])
    chosen = pick(_names(study)) if pick is not None else [n for n in usual if n in possible]
    return tuple([n for n in chosen if n][:MOST])


@lru_cache(maxsize=2)  # of the design in place and the one before: all plots ask
def _names(study: Study) -> tuple[str, ...]:
    """The quantities of a linkage worth a curve: without angles that go round, and links that never turn."""
    try:
        rows = quantities_of(study)
        turning = study.driver_ranges.turning
    except KindynaError:  # no mechanism yet, or none that can be assembled
        return ()
    at_rest = {str(n) for n, turn in turning.items() if np.ptp(turn.angle) < NO_TURN}
    links = {row.name for row in OF_MEMBERS["link"]}
    return tuple(
        n for n, row in rows.items() if not row.is_periodic and not (shape_of(n) in links and member_of(n) in at_rest)
    )


_TITLES: Mapping[str, str] = MappingProxyType(
    {
        "link.{}": "Angle",
        "link.{}_velocity": "Angular velocity",
        "link.{}_acceleration": "Angular accel.",
        "slide.{}": "Slide",
        "slide.{}_velocity": "Slide velocity",
        "slide.{}_acceleration": "Slide accel.",
        TRANSMISSION: "Transmission angle",
        "force.{}_size": "Joint forces",
        "force": "Force",
        "output_torque": "Torque",
        "output_power": "Power",
        "driver_torque": "Driver torque",
        "driver_force": "Driver force",
    }
)
"""Shape of a quantity's name -> what a plot of it is called."""


def title_for(design: Design, usual: str, title: str) -> str:
    """What a plot of the window is called: ``title`` where it shows its usual quantity, or nothing."""
    return _title(names_of(design), usual, title)


@lru_cache(maxsize=256)
def _title(possible: tuple[str, ...], usual: str, title: str) -> str:
    pick = _PLOTS.get(usual)
    if usual in possible or pick is None:
        return title
    chosen = next((name for name in pick(possible) if name), "")
    return _TITLES.get(shape_of(chosen), title)


def first_graph(study: Study) -> list[list[str]]:
    """The plots a new graph of a linkage begins with."""
    rows = (quantities_for(study, [name]) for name in ("displacement", "velocity", "acceleration"))
    return [list(row) for row in rows if row]


def why_empty(study: Study, usual: Sequence[str]) -> str:
    """Why a plot of the window is empty, in a sentence."""
    names = " nor ".join(name.replace("_", " ") for name in usual)
    name = usual[0].replace("_", " ")
    if usual[0] in ("pressure_angle", "pitch_curvature"):
        return f"{LED_BY_NO_CAM}there is no {name}."
    if usual[0] == "contact_pressure":
        return why_no_pressure(study)
    if usual[0] == "jerk":
        return "No motion drives this linkage: the graph shows what its links and points do."
    return f"This mechanism has no {names}."


def rows_of(study: Study, quantities: Iterable[str]) -> list[Quantity]:
    """The channels of these quantities that this kind of design can have, in the given order."""
    available = {row.name: row for row in channels(study.design)}
    return [available[name] for name in quantities if name in available]


def stages_of(quantities: Iterable[str]) -> tuple[str, ...]:
    """The stages that these quantities need, each once, in the order of a study."""
    wanted = {quantity(name).stage for name in quantities}
    return tuple(stage for stage in STAGES if stage in wanted)


def split(study: Study, rows: Sequence[Quantity]) -> tuple[list[Quantity], list[str]]:
    """Those rows that can be drawn, without any that equals one before it; and a line for each that is left out, but for
    what only stands beside another for comparison.

    Raises NoSolution where a stage that all of them need has none.
    """
    available = existing(study, rows)
    drawn = different(study, available)
    reasons = [why_missing(study, row) for row in rows if row not in available and not row.approximates]
    reasons += [f"{row.label} is the same curve" for row in available if row not in drawn and not row.approximates]
    return drawn, reasons


def figures_of(study: Study, usual: Sequence[str]) -> list[str]:
    """Lines of figures that belong to a plot of the window: below the contact pressure the life of the rollers."""
    return (
        [_life(each, len(roller_lives(study))) for each in roller_lives(study)]
        if usual[0] == "contact_pressure"
        else []
    )


def _life(life: RollerLife, of: int) -> str:
    which = f"the {life.roller} roller" if of > 1 else "the roller"
    if not isfinite(life.hours):
        return f"Nothing loads {which}"
    return f"Life of {which}, L10: {grouped(life.million_turns)} million turns, {grouped(life.hours)} h at {grouped(life.rpm)} rpm"


def why_missing(study: Study, row: Quantity) -> str:
    """Why this design has no such channel."""
    try:
        row.values(study)
    except KindynaError as error:
        return f"No {row.label[:1].lower()}{row.label[1:]}: {reason(study.design, error)}"
    return f"No {row.label[:1].lower()}{row.label[1:]} exists here"
