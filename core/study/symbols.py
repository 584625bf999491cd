"""A symbol of formulas and its value at one angle of a study; and the row that a formula is."""

from __future__ import annotations

from collections.abc import Callable, Collection

import numpy as np

from core.design import UNITS, get
from core.frozen import frozen
from core.study.study import Study

MOTION, LINKAGE, CAM, DYNAMICS, STABILITY, LOADS = "motion", "linkage", "cam", "dynamics", "stability", "loads"
# -- rows -------------------------------------------------------------------------------------------------------


@frozen
class Formula:
    """One formula: as the report prints it, as it is evaluated, and what computes it.

    Attributes
    ----------
    name : quantity ({} for its member), figure of the summary, or residual; with ``.flat``: under a straight face; with
        ``.surface``: of a cam in space
    title : heading in the report, which prints rows of one title together
    lines : the equation, then equations of symbols in it
    letters : keys of ``LETTERS``, every symbol of the lines
    source : author, year and number, or the principle
    function : dotted name, within ``core``, of the function or attribute that computes it
    when : whether a design uses it, of its study and the names of its quantities; None: where it has the quantity
    working : form that is evaluated, where it is not the first line
    values : keys of the symbols of the evaluated form, where they are not those of the lines
    member : pair, body or roller, of a quantity whose name has none
    remark : what else a reader of the report should know
    """

    name: str
    title: str
    lines: tuple[str, ...]
    letters: str
    source: str
    function: str
    when: Callable[[Study, Collection[str]], bool] | None = None
    working: str = ""
    values: str = ""
    member: str = ""
    remark: str = ""

    @property
    def evaluated(self) -> str:
        """The form that is evaluated with the values of its symbols."""
        return self.working or self.lines[0]


@frozen
class Letter:
    """A symbol with its value.

    Attributes
    ----------
    symbol : as it is written
    meaning : in words
    value : in its unit
    unit : symbol of the unit
    origin : field or stage that it comes from
    column : column of the quantity that it is, which can be explained too
    """

    symbol: str
    meaning: str
    value: float
    unit: str
    origin: str
    column: str = ""


Text = str | Callable[[Study], str]


@frozen
class SymbolSource:
    """What a symbol means, and how it is read from a study at one angle.

    Attributes
    ----------
    meaning : in words
    unit : key of ``UNITS``; empty for a ratio, or where ``shown`` names the unit
    value : value in SI units, of a study and the formula's member; None for a symbol of general laws
    origin : field or stage
    column : column of the quantity that it is
    """

    meaning: str
    unit: Text = ""
    value: Callable[[Study, str], float] | None = None
    origin: Text = ""
    column: Text = ""

    def read(self, study: Study, symbol: str, member: str = "") -> Letter:
        """The symbol with its value at the study's angle."""
        assert self.value is not None, symbol
        unit, origin, column = (t if isinstance(t, str) else t(study) for t in (self.unit, self.origin, self.column))
        return letter(symbol, self.meaning, self.value(study, member), unit, origin, column=column)


def symbol_of(key: str) -> str:
    """The symbol of a key of ``LETTERS``."""
    return key.partition(".")[0]


def letter(
    symbol: str,
    meaning: str,
    value: float,
    unit: str = "",
    origin: str = DYNAMICS,
    shown: str = "",
    column: str = "",
) -> Letter:
    """A symbol by its value in SI units; unit: key of ``UNITS``, else ``shown`` is the name of the SI unit."""
    factor, name = (UNITS[unit].factor, UNITS[unit].symbol) if unit else (1.0, shown)
    return Letter(symbol, meaning, float(value) / factor + 0.0, name, origin, column)


# -- values -----------------------------------------------------------------------------------------------------

Point = Callable[[Study, str], complex]


def first(values: np.ndarray) -> float:
    """Value of a study at its first angle.

    Parameters
    ----------
    values : ndarray (n,) [SI unit of the quantity]

    Returns
    -------
    float
    """
    return float(np.atleast_1d(values)[0])


def first_complex(values: np.ndarray | complex) -> complex:
    """Complex value of a study at its first angle.

    Parameters
    ----------
    values : ndarray (n,) complex [SI unit of the quantity]

    Returns
    -------
    complex
    """
    return complex(np.atleast_1d(values)[0])


def motion_unit(study: Study) -> str:
    """Unit of the motion, mm or deg."""
    return study.design.drive.motion_unit


def speed_field(study: Study) -> str:
    """Path of the field with the speed."""
    return "linkage.driver.speed_rpm" if study.by_crank and study.design.shaft is None else "shaft.speed_rpm"


def segment_of(study: Study) -> tuple[int, float, float]:
    """Number of the segment at the angle, displacement at its start and rise [m or rad]."""
    motion = study.program.motion
    at, start, theta = 0.0, motion.first * motion.scale, float(np.rad2deg(study.theta[0]))
    for number, segment in enumerate(motion.segments):
        rise = segment.rise * motion.scale
        if theta < at + segment.span_deg - 1e-9 or number == len(motion.segments) - 1:
            return number, start, rise
        at, start = at + segment.span_deg, start + rise
    raise AssertionError("a motion has segments")


# -- kinds of symbols -----------------------------------------------------------------------------------------


def quantity_symbol(meaning: str, column: str, value: Callable[[Study], np.ndarray], stage: str) -> SymbolSource:
    """Symbol of a quantity that has a column.

    Parameters
    ----------
    meaning, column : str
    value : callable
        Study -> ndarray (n,) [SI unit of the quantity].
    stage : str

    Returns
    -------
    SymbolSource
    """
    key = next((key for key in sorted(UNITS, key=len, reverse=True) if column.endswith(f"_{key}")), "")
    return SymbolSource(meaning, key, lambda study, _: first(value(study)), stage, column)


def field_symbol(path: str, meaning: str, unit: str = "") -> SymbolSource:
    """A symbol that is a field of the design."""
    factor = UNITS[unit].factor if unit else 1.0
    return SymbolSource(meaning, unit, lambda study, _: factor * float(get(study.design, path) or 0.0), path)


def vector_symbols(key: str, meaning: str, unit: str, value: Point, origin: str = CAM) -> dict[str, SymbolSource]:
    """A vector, and its components x and y."""
    name, dot, subject = key.partition(".")
    mark = name if "_" in name else f"{name}_"

    def part(axis: str, take: Callable[[complex], float]) -> SymbolSource:
        return SymbolSource(f"{meaning}, {axis}", unit, lambda study, member: take(value(study, member)), origin)

    return {
        key: SymbolSource(meaning),
        f"{mark}x{dot}{subject}": part("x", lambda z: z.real),
        f"{mark}y{dot}{subject}": part("y", lambda z: z.imag),
    }
