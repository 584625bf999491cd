"""Where a number comes from: its equation with the paper's number, and the letters with their values at that angle."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from core.errors import KindynaError, NoAnswer
from core.findings import Residual
from core.frozen import frozen
from core.output.channels import channels, existing
from core.output.explain.figures import FIGURES, Figure
from core.output.explain.letters import Letter, first, letter
from core.output.explain.workings import working_of
from core.output.lines import columns, digits
from core.study import Quantity, Study, certificate_of, extremes_of
from core.study.extremes import exists
from core.study.quantities import member_of, shape_of


@frozen
class Explanation:
    """A number and what it follows from.

    quantity  column of its table, or name of a figure of the summary; label: in words
    value     in the unit
    at_deg    cam or crank angle [deg]; None of a figure of the whole turn
    lines     its equation first, then those of letters in it that have one of their own
    source    paper and number, or what it follows from
    letters   with their values there
    residual  of the certificate, the one that comes nearest to its bound among those of its stage; None where none is known
    """

    quantity: str
    label: str
    value: float
    unit: str
    at_deg: float | None
    lines: tuple[str, ...]
    source: str
    letters: tuple[Letter, ...]
    residual: tuple[str, Residual] | None


def explained(study: Study, name: str, at_deg: float | None = None) -> Explanation:
    """The quantity of a column, or a figure of the summary; at_deg: without, at the angle of its largest absolute value.

    Raises KindynaError for what this design does not have, and an angle at which it does not stand; NoAnswer as its stage does.
    """
    figure = FIGURES.get(name)
    if figure is not None and figure.exists(study):
        return _of_figure(study, name, figure)
    if study.design.listed:
        return _of_shaft(study, name, at_deg)
    row = next((row for row in channels(study.design) if row.slug == name), None)
    if row is None or not exists(study, row):
        raise KindynaError(
            f"explain {name}: this design has no such quantity; allowed: {', '.join(explainable(study))}"
        )
    angle = _largest(study, row) if at_deg is None else at_deg
    _require_angle(angle)
    there = study.at_theta(np.array([math.radians(angle)]))
    working = working_of(there, shape_of(row.name), member_of(row.name))
    value = float(row.values(there)[0])
    if not math.isfinite(value):
        raise _limitless(name, angle)
    lines = working.lines or (f"{row.symbol} = {row.equation}",)
    return Explanation(
        row.slug, row.label, value, row.unit.symbol, angle, lines, row.source, working.letters, _proof(study, row.stage)
    )


def explainable(study: Study) -> list[str]:
    """The columns and figures that this design has."""
    if study.design.listed:
        camshaft = study.camshaft
        rows = [
            "torque_nm",
            *(f"{camshaft.slugs[name]}_torque_nm" for name in camshaft.carried if name not in camshaft.failures),
        ]
    else:
        rows = [row.slug for row in existing(study, channels(study.design))]
    return [*rows, *(name for name, figure in FIGURES.items() if figure.exists(study))]


def _of_shaft(study: Study, name: str, at_deg: float | None) -> Explanation:
    """The torque of all that turns on one shaft by the machine's angle, and that of one drive."""
    camshaft = study.camshaft
    carried = [each for each in camshaft.carried if each not in camshaft.failures]
    slugs = {f"{camshaft.slugs[each]}_torque_nm": each for each in carried}
    if name not in ("torque_nm", *slugs):
        raise KindynaError(
            f"explain {name}: this shaft has no such quantity; allowed: {', '.join(explainable(study))}, or with --drive"
        )
    wanted = [slugs[name]] if name in slugs else carried
    worst = camshaft.peak_torque if name == "torque_nm" else camshaft.drive_peak(slugs[name])
    angle = math.degrees(worst.theta) % 360.0 if at_deg is None else at_deg
    _require_angle(angle)
    there = camshaft.at_theta(np.radians([angle]))
    parts = [
        letter(f"T_{i}", f"torque of {each} there", first(there.drive_torque(each)), "nm")
        for i, each in enumerate(wanted, 1)
    ]
    if name == "torque_nm" and there.balancer is not None:
        parts.append(letter("T_b", "torque of the balance cam there", first(there.balancer_torque), "nm"))
    value = sum(each.value for each in parts)
    line = f"T = {' + '.join(each.symbol for each in parts)}"
    return Explanation(
        name,
        "Torque of the shaft",
        value,
        "N·m",
        angle,
        (line,),
        "one shaft: T(θ) = Σ T_k(θ - θ_k)",
        tuple(parts),
        _proof(study, "dynamics"),
    )


def _require_angle(angle: float) -> None:
    if not 0.0 <= angle <= 360.0:
        raise KindynaError(f"explain --at {angle:g}: angle of the turn; allowed: 0 to 360 deg")


def _of_figure(study: Study, name: str, figure: Figure) -> Explanation:
    letters = figure.letters(study)
    value = figure.value(study) / figure.unit.factor
    return Explanation(
        name,
        figure.label,
        value,
        figure.unit.symbol,
        None,
        (figure.line,),
        figure.source,
        letters,
        _proof(study, "dynamics"),
    )


def _largest(study: Study, row: Quantity) -> float:
    """Where it is largest without regard to its sign [deg]; of what goes round where the turn begins."""
    found = extremes_of(study, row.stage).get(row.name)
    if found is None:
        return float(np.rad2deg(study.theta[0]))
    worst = max((found.low, found.high), key=lambda each: abs(each.value))
    angle = math.degrees(worst.theta) % 360.0
    if not math.isfinite(worst.value):
        raise _limitless(row.slug, angle)
    return angle


def _limitless(name: str, angle: float) -> KindynaError:
    return KindynaError(
        f"explain {name}: it grows without limit at {angle:.6g} deg; ask for it at another angle with --at"
    )


def _proof(study: Study, stage: str) -> tuple[str, Residual] | None:
    """The residual of a stage that comes nearest to its bound."""
    try:
        rows = certificate_of(study, (stage,))
    except NoAnswer:
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
        "residual": None if made.residual is None else made.residual[1].value,
        "bound": None if made.residual is None else made.residual[1].bound,
    }


def as_text(made: Explanation) -> str:
    """For the terminal."""
    at = "" if made.at_deg is None else f" at {made.at_deg:.6g} deg"
    head = [f"{made.label}{at}: {digits(made.value, 9)} {made.unit}".rstrip(), *(f"  {line}" for line in made.lines)]
    rows = [(each.symbol, digits(each.value, 9), each.unit, each.meaning, each.origin) for each in made.letters]
    proof = (
        []
        if made.residual is None
        else [f"certificate: {made.residual[0]} = {made.residual[1].value:.3g}, bound {made.residual[1].bound:.3g}"]
    )
    return "\n".join((*head, f"  after {made.source}", *columns(rows, left=1), *proof)) + "\n"


__all__ = ["Explanation", "as_row", "as_text", "explainable", "explained"]
