"""Which quantities a plot of the window shows: its usual ones, or of a design without them those of links that stand for them;
and why others cannot be drawn."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from math import isfinite
from types import MappingProxyType

import numpy as np

from core.design import Design
from core.errors import KindynaError, NoAnswer
from core.output.channels import Channel, channels, existing
from core.stress import RollerLife
from core.study import STAGES, Study, quantities_of, quantity, roller_lives
from core.study.quantities import names_of
from kindyna_gui.labels import grouped, reason
from kindyna_gui.pictures.plots.curves import different
from kindyna_gui.requirements import why_no_pressure

NO_TURN = 1e-9  # [rad] a link that turns less than this does not turn
MOST = 4  # curves in one plot that can still be told apart
Pick = Callable[[tuple[str, ...]], list[str]]


def _rate(ending: str) -> Pick:
    """Of the links that turn, or where none does, of those that slide."""

    def pick(names: tuple[str, ...]) -> list[str]:
        for of in ("link.", "slide."):
            chosen = [n for n in names if n.startswith(of) and n.removeprefix(of).lstrip("0123456789") == ending]
            if chosen:
                return chosen
        return []

    return pick


def _first(*wanted: str) -> Pick:
    return lambda names: [next((n for n in wanted if n in names), "")]


def _starting(start: str, ending: str = "") -> Pick:
    return lambda names: [n for n in names if n.startswith(start) and n.endswith(ending)]


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
        "displacement": _or(_first("displacement"), _rate("")),
        "velocity": _or(_first("velocity"), _rate("_velocity")),
        "acceleration": _or(_first("acceleration"), _rate("_acceleration")),
        "pressure_angle": _or(_first("pressure_angle"), _starting("transmission.")),
        "pitch_curvature": _first("pitch_curvature", "profile_curvature"),
        "drive_torque": _first("drive_torque", "driver_torque", "driver_force"),
        "contact_force": _or(_first("contact_force"), _starting("force.", "_size")),
    }
)
"""First quantity of a plot of the window -> what it shows of a linkage."""


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
        turning = study.course.turning
    except NoAnswer:
        return ()
    at_rest = {f"link.{n}" for n, turn in turning.items() if np.ptp(turn.angle) < NO_TURN}
    return tuple(
        n
        for n, row in rows.items()
        if not row.turns and n.removesuffix("_velocity").removesuffix("_acceleration") not in at_rest
    )


_TITLES: Mapping[str, str] = MappingProxyType(
    {
        r"link\.\d+": "Angle",
        r"link\.\d+_velocity": "Angular velocity",
        r"link\.\d+_acceleration": "Angular accel.",
        r"slide\.\d+": "Slide",
        r"slide\.\d+_velocity": "Slide velocity",
        r"slide\.\d+_acceleration": "Slide accel.",
        r"transmission\..*": "Transmission angle",
        r"force\..*_size": "Joint forces",
        "driver_torque": "Driver torque",
        "driver_force": "Driver force",
    }
)
"""Names of quantities, as patterns -> what a plot of them is called."""


def title_for(design: Design, usual: str, title: str) -> str:
    """What a plot of the window is called: ``title`` where it shows its usual quantity, or nothing."""
    return _title(names_of(design), usual, title)


@lru_cache(maxsize=256)
def _title(possible: tuple[str, ...], usual: str, title: str) -> str:
    pick = _PLOTS.get(usual)
    if usual in possible or pick is None:
        return title
    chosen = next((name for name in pick(possible) if name), "")
    return next((text for pattern, text in _TITLES.items() if re.fullmatch(pattern, chosen)), title)


def first_graph(study: Study) -> list[list[str]]:
    """The plots a new graph of a linkage begins with."""
    rows = (quantities_for(study, [name]) for name in ("displacement", "velocity", "acceleration"))
    return [list(row) for row in rows if row]


def why_empty(study: Study, usual: Sequence[str]) -> str:
    """Why a plot of the window is empty, in a sentence."""
    names = " nor ".join(name.replace("_", " ") for name in usual)
    name = usual[0].replace("_", " ")
    if usual[0] in ("pressure_angle", "pitch_curvature"):
        led = "motion" in study.stages
        hint = (
            "Compo > Cam roller puts one under a point" if led else "Compo > Driver lets a link follow a motion first"
        )
        return f"No cam makes this linkage move: there is no {name}. {hint}."
    if usual[0] == "contact_pressure":
        return why_no_pressure(study)
    if usual[0] == "jerk":
        return "No motion drives this linkage: the graph shows what its links and points do."
    return f"This mechanism has no {names}."


def rows_of(study: Study, quantities: Iterable[str]) -> list[Channel]:
    """The channels of these quantities that this kind of design can have, in the given order."""
    available = {row.quantity: row for row in channels(study.design)}
    return [available[name] for name in quantities if name in available]


def stages_of(quantities: Iterable[str]) -> tuple[str, ...]:
    """The stages that these quantities need, each once, in the order of a study."""
    wanted = {quantity(name).stage for name in quantities}
    return tuple(stage for stage in STAGES if stage in wanted)


def split(study: Study, rows: Sequence[Channel]) -> tuple[list[Channel], list[str]]:
    """Those rows that can be drawn, without any that equals one before it; and a line for each that is left out, but for
    what only stands beside another for comparison.

    Raises NoAnswer where a stage that all of them need has none.
    """
    available = existing(study, rows)
    drawn = different(study, available)
    reasons = [why_missing(study, row) for row in rows if row not in available and not row.beside]
    reasons += [f"{row.label} is the same curve" for row in available if row not in drawn and not row.beside]
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


def why_missing(study: Study, row: Channel) -> str:
    """Why this design has no such channel."""
    try:
        row.values(study)
    except KindynaError as error:
        return f"No {row.label[:1].lower()}{row.label[1:]}: {reason(study.design, error)}"
    return f"No {row.label[:1].lower()}{row.label[1:]} exists here"
