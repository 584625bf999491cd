"""Where a number comes from: its equation with the paper's number, and the letters with their values at that angle."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, TypeVar

import numpy as np

from core.errors import KindynaError, NoSolution
from core.findings import Finding, Residual
from core.frozen import frozen
from core.motion.extremes import Extreme
from core.output.channels import channels, existing
from core.output.explain.shaft import FIGURES, has_figure, shaft_columns
from core.output.explain.workings import calculation_of
from core.output.lines import columns, digits
from core.study import Quantity, Study, certificate_of, extremes_of
from core.study.extremes import has_quantity, is_unlimited
from core.study.formulas import FORMULAS
from core.study.letters import keys_of, letters_of
from core.study.symbols import Letter, first

# -- where a number comes from ----------------------------------------------------------------------------------


BESIDE = 1e-10  # rad from a jump, where its side is looked at
APART = 1e-9  # of an extreme: the value at its angle is that of the other side
S = TypeVar("S")


@frozen
class Explanation:
    """A number and what it follows from, or why it grows without limit.

    quantity  column of its table, or name of a figure of the summary; label: in words
    value     in the unit; infinite where it grows without limit
    at_deg    cam or crank angle [deg]; None of a figure of the whole turn
    law       the equation as the report prints it, with equations of symbols in it
    lines     the form that is evaluated with the values of the letters
    source    paper and number, or what it follows from
    letters   with their values there; none where it grows without limit
    residual  of the certificate, the one that comes nearest to its bound among those of its stage; None where none is known
    """

    quantity: str
    label: str
    value: float
    unit: str
    at_deg: float | None
    law: tuple[str, ...]
    lines: tuple[str, ...]
    source: str
    letters: tuple[Letter, ...]
    residual: tuple[str, Residual] | None
    why: str = ""

    @property
    def equations(self) -> tuple[str, ...]:
        """The law, then the form that is evaluated where it is another."""
        return tuple(dict.fromkeys((*self.law, *self.lines)))

    def headline(self, most: int) -> str:
        """What it is, where and how much, with so many digits; and why it is infinite where it is."""
        at = "" if self.at_deg is None else f" at {self.at_deg:.6g}°"
        text = f"{self.label}{at}: {digits(self.value, most)} {self.unit if not self.why else ''}".rstrip()
        return f"{text}: {self.why}" if self.why else text


@np.errstate(all="ignore")  # where a crank locks, or a curve has a cusp
def explained(study: Study, name: str, at_deg: float | None = None) -> Explanation:
    """The quantity of a column, or a figure of the summary; at_deg: without, at the angle of its largest absolute value.

    Raises KindynaError for what this design does not have, and an angle at which it does not stand; NoSolution as its stage does.
    """
    if has_figure(study, name):
        return _figure(study, name)
    if study.design.listed:
        return _shaft_column(study, name, at_deg)
    row = next((row for row in channels(study.design) if row.slug == name), None)
    if row is None or not has_quantity(study, row):
        raise KindynaError(
            f"explain {name}: this design has no such quantity; allowed: {', '.join(explainable(study))}"
        )
    largest = _largest(study, row) if at_deg is None else None
    angle = at_deg if at_deg is not None else math.degrees(largest.theta if largest else study.theta[0]) % 360.0
    _require_angle(angle)
    if largest is None:
        there = study.at_theta(np.array([math.radians(angle)]))
    else:
        there = _standing(study.at_theta, row.values, largest.theta, largest.value / row.unit.factor)
    calculation = calculation_of(there, row)
    value = float(row.values(there)[0])
    if largest is not None and not math.isfinite(largest.value):
        value = largest.value
    elif is_unlimited(study, row.name, math.radians(angle)):
        value = math.copysign(math.inf, value)
    letters, why = calculation.letters, ""
    if not math.isfinite(value):
        letters, why = (), _why_infinite(study, row)
    elif not all(math.isfinite(each.value) for each in letters):
        raise KindynaError(f"explain {name} --at {angle:g}: it has no value there; {_why_infinite(study, row)}")
    assert row.formula is not None, row.name
    return Explanation(
        row.slug,
        row.label,
        value,
        row.unit.symbol,
        angle,
        row.formula.lines,
        calculation.lines,
        row.source,
        letters,
        _proof(study, row.stage),
        why,
    )


def explainable(study: Study) -> list[str]:
    """The columns and figures that this design has."""
    rows = (
        [*shaft_columns(study)]
        if study.design.listed
        else [row.slug for row in existing(study, channels(study.design))]
    )
    return [*rows, *(name for name in FIGURES if has_figure(study, name))]


def labels_of(study: Study) -> dict[str, str]:
    """Labels of the columns and figures of this design."""
    columns = {row.slug: row.label for row in channels(study.design)}
    return columns | {name: figure.label for name, figure in FIGURES.items()}


def _shaft_column(study: Study, name: str, at_deg: float | None) -> Explanation:
    """The torque of all that turns on one shaft by the machine's angle, and that of one drive."""
    columns = shaft_columns(study)
    if name not in columns:
        raise KindynaError(
            f"explain {name}: this shaft has no such quantity; allowed: {', '.join(explainable(study))}, or with --drive"
        )
    column, camshaft = columns[name], study.camshaft
    if at_deg is None:
        largest = column.largest(camshaft)
        angle = math.degrees(largest.theta) % 360.0
        there = _standing(camshaft.at_theta, column.values, largest.theta, largest.value)
    else:
        _require_angle(at_deg)
        angle, there = at_deg, camshaft.at_theta(np.radians([at_deg]))
    calculation, formula = column.calculation(there), FORMULAS["torque_nm"]
    return Explanation(
        name,
        column.label,
        first(column.values(there)) / column.unit.factor,
        column.unit.symbol,
        angle,
        formula.lines,
        calculation.lines,
        formula.source,
        calculation.letters,
        _proof(study, "dynamics"),
    )


def _require_angle(angle: float) -> None:
    if not 0.0 <= angle <= 360.0:
        raise KindynaError(f"explain --at {angle:g}: angle of the turn; allowed: 0 to 360 deg")


def _figure(study: Study, name: str) -> Explanation:
    """The explanation of a figure of the whole turn."""
    figure, formula = FIGURES[name], FORMULAS[name]
    return Explanation(
        name,
        figure.label,
        figure.value(study) / figure.unit.factor,
        figure.unit.symbol,
        None,
        formula.lines,
        (formula.evaluated,),
        formula.source,
        letters_of(study, keys_of(formula)),
        _proof(study, "dynamics"),
    )


def _largest(study: Study, row: Quantity) -> Extreme | None:
    """Largest without regard to its sign; None of an angle that goes round."""
    found = extremes_of(study, row.stage).get(row.name)
    return None if found is None else max((found.low, found.high), key=lambda each: abs(each.value))


def _standing(at_theta: Callable[[np.ndarray], S], values: Callable[[S], np.ndarray], theta: float, value: float) -> S:
    """The study or shaft at an extreme; where the quantity jumps there, on the side that the extreme is taken from."""
    there = at_theta(np.array([theta]))
    if abs(first(values(there)) - value) <= APART * abs(value) or not math.isfinite(value):
        return there
    sides = [there, *(at_theta(np.array([theta + by])) for by in (-BESIDE, BESIDE))]
    return min(sides, key=lambda side: abs(first(values(side)) - value))


def _why_infinite(study: Study, row: Quantity) -> str:
    """Why a quantity grows without limit towards an angle."""
    if row.stage == "dynamics" and study.jam is not None:
        return "friction jams there"
    if "instant_centre" in row.name:
        return "the follower turns as fast as the cam there, and their instant centre is infinitely far away"
    if "curvature" in row.name:
        return "the curve has a cusp there, where its radius of curvature passes through 0"
    ranges = study.driver_ranges.ranges if study.by_crank else ()
    joints = sorted({joint for each in ranges for joint in (each.low_joint, each.high_joint) if joint})
    if not joints:
        return "the equation divides by 0 there"
    return f"the crank locks at {' and '.join(joints)}; were it to turn on, the links would move infinitely fast there"


def _proof(study: Study, stage: str) -> tuple[str, Residual] | None:
    """The residual of a stage that comes nearest to its bound."""
    try:
        rows = certificate_of(study, (stage,))
    except NoSolution:
        return None
    return max(rows.items(), key=lambda row: row[1].value / (row[1].bound or 1.0), default=None)


# -- as files and text -------------------------------------------------------------------------------------


def as_row(made: Explanation) -> Mapping[str, Any]:
    """For JSON."""
    return {
        "quantity": made.quantity,
        "value": made.value,
        "unit": made.unit,
        "at_deg": made.at_deg,
        "law": list(made.law),
        "equation": list(made.lines),
        "source": made.source,
        "symbols": [
            {
                "symbol": each.symbol,
                "meaning": each.meaning,
                "value": each.value,
                "unit": each.unit,
                "from": each.origin,
            }
            for each in made.letters
        ],
        "why": made.why,
        "residual": None if made.residual is None else made.residual[1].value,
        "bound": None if made.residual is None else made.residual[1].bound,
    }


def as_text(made: Explanation) -> str:
    """For the terminal."""
    head = [made.headline(9), *(f"  {line}" for line in made.equations)]
    rows = [(each.symbol, digits(each.value, 9), each.unit, each.meaning, each.origin) for each in made.letters]
    proof = (
        []
        if made.residual is None
        else [f"certificate: {made.residual[0]} = {made.residual[1].value:.3g}, bound {made.residual[1].bound:.3g}"]
    )
    return "\n".join((*head, f"  after {made.source}", *(columns(rows, left=1) if rows else ()), *proof)) + "\n"


# -- which number a finding, or a residual of the certificate, is about -----------------------------------------


OF_FINDINGS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "pressure-angle": ("pressure_angle_deg",),
        "roller-pressure-angle": ("pressure_angle_deg",),
        "second-pressure-angle": ("second_pressure_angle_deg",),
        "undercut": ("pitch_curvature_per_mm", "profile_curvature_per_mm"),
        "outer-undercut": ("outer_curvature_per_mm",),
        "second-undercut": ("second_pitch_curvature_per_mm",),
        "convex-radius": ("profile_curvature_per_mm",),
        "concave-radius": ("profile_curvature_per_mm",),
        "cutter-too-large": ("profile_curvature_per_mm",),
        "polar-radius": ("radius_mm",),
        "profile-meets": ("radius_mm",),
        "face-too-narrow": ("contact_on_face_mm",),
        "contact-pressure": ("contact_pressure_mpa",),
        "material-pressure": ("contact_pressure_mpa",),
        "separation": ("contact_force_n",),
        "contact-force-low": ("contact_force_n",),
        "flank-change": ("contact_force_n",),
        "elastic-separation": ("elastic_contact_force_n",),
        "jamming": ("jam_factor",),
        "pair-jamming": ("jam_factor",),
        "jump-displacement": ("displacement_mm", "displacement_deg"),
        "jump-velocity": ("velocity_mm_s", "velocity_deg_s"),
        "jump-acceleration": ("acceleration_mm_s2", "acceleration_deg_s2"),
        "flywheel": ("fluctuation", "needed_inertia_kg_m2"),
    }
)
"""Code of a finding, or what it begins with -> columns or figures, the first that the design has."""

OF_RESIDUALS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "motion_closure": ("displacement_mm", "displacement_deg"),
        "loop_closure": ("phi_deg", "link3_deg", "link2_deg", "pivot_x_n", "displacement_mm"),
        "instant_centre": ("instant_centre_mm", "instant_centre_x_mm"),
        "three_centres": ("link3_rad_s",),
        "tangency": ("x_mm",),
        "second_centre": ("second_pitch_x_mm",),
        "power_balance": ("drive_torque_nm", "driver_torque_nm", "driver_force_n"),
        "momentum_balance": ("contact_force_n", "driver_torque_nm", "driver_force_n"),
    }
)
"""Name of a residual, or what it ends with, likewise."""


def number_of_finding(study: Study, finding: Finding) -> str:
    """Empty where it is about none that can be explained."""
    return _first(study, next((names for code, names in OF_FINDINGS.items() if finding.code.startswith(code)), ()))


def number_of_residual(study: Study, name: str) -> str:
    """Likewise; name: with the drive's before it, of several."""
    own = name.rpartition(".")[2]
    return _first(study, next((names for end, names in OF_RESIDUALS.items() if own.endswith(end)), ()))


def _first(study: Study, names: tuple[str, ...]) -> str:
    there = set(explainable(study)) if names else set()
    return next((name for name in names if name in there), "")
