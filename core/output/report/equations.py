"""The equations that a design's numbers come from, as its report prints them: the rows of ``FORMULAS`` by title, and the motion laws."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable

from core.design import NamedCurve
from core.frozen import frozen
from core.laws import FLAT_FORMULA, FLAT_WHERE, named_law
from core.output.report.formula import mathml
from core.study import Study, names_of
from core.study.formulas import FORMULAS
from core.study.letters import LETTERS
from core.study.quantities import shape_of
from core.study.study import FLAT, SURFACE, variant_of
from core.study.symbols import Formula, symbol_of

LOWERED = str.maketrans("0123456789aehijklmnoprstuvx", "₀₁₂₃₄₅₆₇₈₉ₐₑₕᵢⱼₖₗₘₙₒₚᵣₛₜᵤᵥₓ")
_INDEX = re.compile(r"(?<=\w)_(\w+)")
_MOTION = ("displacement", "velocity", "acceleration", "jerk")


@frozen
class Equation:
    """An entry of the report: its heading, its lines, what their symbols mean, and its source."""

    name: str
    lines: tuple[str, ...]
    source: str
    where: str = ""

    @property
    def mathml(self) -> tuple[str, ...]:
        """Its lines as MathML."""
        return tuple(mathml(line) for line in self.lines)

    @property
    def meaning(self) -> str:
        """What its symbols mean, their indices lowered: R_r is written Rᵣ where that letter can be lowered, else Rr."""
        return _INDEX.sub(lambda match: _lowered(match[1]), self.where)


def _lowered(index: str) -> str:
    return index.translate(LOWERED) if all(ord(letter) in LOWERED for letter in index) else index


# -- rows of FORMULAS -----------------------------------------------------------------------------------------


def is_used(row: Formula, study: Study, names: Collection[str]) -> bool:
    """Whether a formula gives a number of a design that has quantities of these names."""
    if row.when is not None:
        return row.when(study, names)
    quantity, variant = next(
        ((row.name.removesuffix(end), end) for end in (FLAT, SURFACE) if row.name.endswith(end)), (row.name, "")
    )
    if f"{quantity}{variant_of(names)}" in FORMULAS and variant != variant_of(names):
        return False
    return quantity in {shape_of(name) for name in names}


def equations(rows: Iterable[Formula]) -> tuple[Equation, ...]:
    """Entries of a report, one for all rows of a title."""
    titles: dict[str, list[Formula]] = {}
    for row in rows:
        titles.setdefault(row.title, []).append(row)
    return tuple(_entry(title, entry) for title, entry in titles.items())


def _entry(title: str, rows: list[Formula]) -> Equation:
    lines = tuple(dict.fromkeys(line for row in rows for line in row.lines))
    left = {line.partition(" = ")[0].removeprefix("tan ") for line in lines}
    keys = dict.fromkeys(key for row in rows for key in row.letters.split() if symbol_of(key) not in left)
    meanings = [f"{symbol_of(key)} {LETTERS[key].meaning}" for key in keys]
    remarks = dict.fromkeys(row.remark for row in rows if row.remark)
    sources = dict.fromkeys(row.source for row in rows)
    return Equation(title, lines, "; ".join(sources), "; ".join((*meanings, *remarks)))


# -- motion laws ----------------------------------------------------------------------------------------------


def _law(slug: str) -> Equation | None:
    """The formula of a motion law; None where it does not move."""
    law = named_law(slug)
    if not law.formula:
        return None
    source, _, _ = law.source.partition(":")
    if law.own:
        name = law.label if law.label.isupper() else law.label.lower()
        return Equation(f"Motion law: {name}", law.formula, source, law.where)
    where = law.where or ("of a return: s(u) times a negative rise" if law.rises < 0 else "")
    return Equation(f"Motion law: {law.label}", law.formula, source if source[:1].isupper() else "definition", where)


FLAT_LAW = Equation(
    "Motion law: half cycloid with constant acceleration", FLAT_FORMULA, "half a modified trapezoid", FLAT_WHERE
)


def equations_of(study: Study) -> tuple[Equation, ...]:
    """Entries of a design: displacement and its derivatives, motion laws, then mechanism, cam, forces and shaft."""
    singles = tuple(study.solved_drives.values())
    designs = [frozenset[str](), *(frozenset(names_of(single.design)) for single in singles)]
    used = [row for row in FORMULAS.values() if any(is_used(row, study, names) for names in designs)]
    curves = [s.curve for single in singles if "motion" in single.stages for s in single.program.motion.segments]
    of_curves = (FLAT_LAW if isinstance(c, NamedCurve) and c.flat_fraction else _law(c.law) for c in curves)
    laws = dict.fromkeys(law for law in of_curves if law is not None)
    motion = [row for row in used if row.name in _MOTION]
    return (*equations(motion), *laws, *equations(row for row in used if row not in motion))
