"""Explanation of a number: its formula with the number of the paper, and the symbols with their values at that angle."""

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
from core.number_text import COMPARED_DIGITS, result_text
from core.output.channels import channels, existing
from core.output.explain.shaft import FIGURES, has_figure, shaft_columns
from core.output.explain.workings import calculation_of
from core.output.lines import columns, digits
from core.project.reading_faults import did_you_mean
from core.study import Quantity, Study, certificate_of, extremes_of
from core.study.extremes import has_quantity, is_unlimited
from core.study.formulas import FORMULAS
from core.study.letters import keys_of, letters_of
from core.study.symbols import Letter, first

# -- explanations ----------------------------------------------------------------------------------------------


JUMP_STEP = 1e-10  # rad from a jump, where the value on either side is computed
SIDE_TOLERANCE = 1e-9  # of an extreme: a larger difference shows that its angle gives the value of the other side
S = TypeVar("S")


@frozen
class Explanation:
    """A number, its formula and the values of the symbols, or why it grows without limit.

    Attributes
    ----------
    quantity : column of its table, or name of a figure of the summary
    label : in words
    value : in the unit; infinite where it grows without limit
    unit : symbol of the unit
    at_deg : angle of cam, crank or machine [deg]; None for a figure of the whole turn
    law : the equation as the report prints it, with equations of symbols in it
    lines : the form that is evaluated with the values of the symbols
    source : author, year and number, or the principle
    letters : symbols with their values; empty where the number grows without limit
    residual : name and residual of the certificate that is nearest to its bound in the stage; None where there is none
    why : why the number grows without limit; empty where it does not
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
        """The law, then the evaluated form where it is another line."""
        return tuple(dict.fromkeys((*self.law, *self.lines)))

    def headline(self, most: int) -> str:
        """Label, angle and value with at most this number of digits; why it is infinite, where it is."""
        at = "" if self.at_deg is None else f" at {result_text(self.at_deg, max(most, COMPARED_DIGITS))}°"
        text = f"{self.label}{at}: {digits(self.value, most)} {self.unit if not self.why else ''}".rstrip()
        return f"{text}: {self.why}" if self.why else text


@np.errstate(all="ignore")  # where a crank locks, or a curve has a cusp
def explained(study: Study, name: str, at_deg: float | None = None) -> Explanation:
    """Explain the quantity of a column, or a figure of the summary.

    Parameters
    ----------
    study : Study
    name : str
        Column, or name in ``summary.json``.
    at_deg : float, optional
        Angle [deg]; by default the angle of the greatest absolute value.

    Returns
    -------
    Explanation

    Raises
    ------
    KindynaError
        Where the design lacks the quantity, the angle is not in 0 to 360°, or the quantity has no value there.
    NoSolution
        Where a stage has no solution.
    """
    if has_figure(study, name):
        return _figure(study, name)
    if study.design.listed:
        return _shaft_column(study, name, at_deg)
    row = next((row for row in channels(study.design) if row.slug == name), None)
    if row is None or not has_quantity(study, row):
        raise KindynaError(f"explain {name}: this design has no such quantity{_near(study, name)}")
    largest = _largest(study, row) if at_deg is None else None
    angle = at_deg if at_deg is not None else math.degrees(largest.theta if largest else study.theta[0]) % 360.0
    _require_angle(angle)
    if largest is None:
        position = study.at_theta(np.array([math.radians(angle)]))
    else:
        position = _study_at(study.at_theta, row.values, largest.theta, largest.value / row.unit.factor)
    calculation = calculation_of(position, row)
    value = float(row.values(position)[0])
    if largest is not None and not math.isfinite(largest.value):
        value = largest.value
    elif is_unlimited(study, row.name, math.radians(angle)):
        value = math.copysign(math.inf, value)
    letters, why = calculation.letters, ""
    if not math.isfinite(value):
        letters, why = (), _why_infinite(study, row)
    elif not all(math.isfinite(letter.value) for letter in letters):
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


def _near(study: Study, name: str) -> str:
    """The names nearest to one that the study lacks, and all that it has."""
    names = explainable(study)
    return f"{did_you_mean(name, names)}; allowed: {', '.join(names)}"


def explainable(study: Study) -> list[str]:
    """Names of the columns and figures of a design that can be explained."""
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
    """The explanation of a column of a shaft with several drives, by machine angle."""
    columns = shaft_columns(study)
    if name not in columns:
        raise KindynaError(
            f"explain {name}: this shaft has no such quantity{_near(study, name)}, or choose a drive with --drive"
        )
    column, camshaft = columns[name], study.camshaft
    if at_deg is None:
        largest = column.largest(camshaft)
        angle = math.degrees(largest.theta) % 360.0
        position = _study_at(camshaft.at_theta, column.values, largest.theta, largest.value)
    else:
        _require_angle(at_deg)
        angle, position = at_deg, camshaft.at_theta(np.radians([at_deg]))
    calculation, formula = column.calculation(position), FORMULAS["torque_nm"]
    return Explanation(
        name,
        column.label,
        first(column.values(position)) / column.unit.factor,
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
    """Extreme of the greatest absolute value; None for an angle that wraps."""
    extremes = extremes_of(study, row.stage).get(row.name)
    return None if extremes is None else max((extremes.low, extremes.high), key=lambda extreme: abs(extreme.value))


def _study_at(at_theta: Callable[[np.ndarray], S], values: Callable[[S], np.ndarray], theta: float, value: float) -> S:
    """The study or shaft at an extreme; where the quantity jumps there, on the side with the extreme value."""
    position = at_theta(np.array([theta]))
    if abs(first(values(position)) - value) <= SIDE_TOLERANCE * abs(value) or not math.isfinite(value):
        return position
    sides = [position, *(at_theta(np.array([theta + step])) for step in (-JUMP_STEP, JUMP_STEP))]
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
    joints = sorted({joint for span in ranges for joint in (span.low_joint, span.high_joint) if joint})
    if not joints:
        return "the equation divides by 0 there"
    return f"the crank locks at {' and '.join(joints)}, towards which the links move infinitely fast"


def _proof(study: Study, stage: str) -> tuple[str, Residual] | None:
    """The residual of a stage that is nearest to its bound."""
    try:
        rows = certificate_of(study, (stage,))
    except NoSolution:
        return None
    return max(rows.items(), key=lambda row: row[1].value / (row[1].bound or 1.0), default=None)


# -- as JSON and as text --------------------------------------------------------------------------------------


def as_row(explanation: Explanation) -> Mapping[str, Any]:
    """An explanation for JSON."""
    return {
        "quantity": explanation.quantity,
        "value": explanation.value,
        "unit": explanation.unit,
        "at_deg": explanation.at_deg,
        "law": list(explanation.law),
        "equation": list(explanation.lines),
        "source": explanation.source,
        "symbols": [
            {
                "symbol": letter.symbol,
                "meaning": letter.meaning,
                "value": letter.value,
                "unit": letter.unit,
                "from": letter.origin,
            }
            for letter in explanation.letters
        ],
        "why": explanation.why,
        "residual": None if explanation.residual is None else explanation.residual[1].value,
        "bound": None if explanation.residual is None else explanation.residual[1].bound,
    }


WORKING_DIGITS = 9  # of a calculation that is repeated by hand


def as_text(explanation: Explanation) -> str:
    """An explanation for the terminal."""
    lines = [
        explanation.headline(WORKING_DIGITS),
        *(f"  {line}" for line in explanation.equations),
        f"  source: {explanation.source}",
    ]
    rows = [
        (letter.symbol, digits(letter.value, WORKING_DIGITS), letter.unit, letter.meaning, letter.origin)
        for letter in explanation.letters
    ]
    lines += columns(rows, left=1) if rows else ()
    if explanation.residual is not None:
        name, residual = explanation.residual
        lines.append(f"certificate: {name} = {result_text(residual.value, 3)}, bound {result_text(residual.bound, 3)}")
    return "\n".join(lines) + "\n"


# -- numbers of findings and residuals ------------------------------------------------------------------------


FINDING_NUMBERS: Mapping[str, tuple[str, ...]] = MappingProxyType(
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
"""Code of a finding, or the beginning of the code -> columns or figures; the first that the design has is explained."""

RESIDUAL_NUMBERS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "motion_closure": ("displacement_mm", "displacement_deg"),
        "loop_closure": ("phi_deg", "rocker_ratio", "link3_deg", "link2_deg", "pivot_x_n", "displacement_mm"),
        "instant_centre": ("instant_centre_mm", "instant_centre_x_mm"),
        "three_centres": ("link3_rad_s",),
        "tangency": ("x_mm",),
        "second_centre": ("second_pitch_x_mm",),
        "power_balance": ("drive_torque_nm", "driver_torque_nm", "driver_force_n"),
        "momentum_balance": ("contact_force_n", "driver_torque_nm", "driver_force_n"),
    }
)
"""Name of a residual, or the end of the name -> columns or figures; the first that the design has is explained."""


def number_of_finding(study: Study, finding: Finding) -> str:
    """Name of the number that a finding judges; empty where it is not explained."""
    return _first(study, next((names for code, names in FINDING_NUMBERS.items() if finding.code.startswith(code)), ()))


def number_of_residual(study: Study, name: str) -> str:
    """Name of a number that a residual proves; empty where it is not explained.

    With several drives the residual's name begins with its drive.
    """
    residual = name.rpartition(".")[2]
    return _first(study, next((names for end, names in RESIDUAL_NUMBERS.items() if residual.endswith(end)), ()))


def _first(study: Study, names: tuple[str, ...]) -> str:
    available = set(explainable(study)) if names else set()
    return next((name for name in names if name in available), "")
