"""A measured table of lift against what the same probe measures on the exact profile."""

from __future__ import annotations

import numpy as np

from core.errors import KindynaError
from core.findings import ERROR, NOTE, Finding
from core.frozen import frozen
from core.measured import ColumnChoice, RowFault, TableError, layout, read_sheet, read_table
from core.measured.table import MeasuredTable as Measured
from core.measured.table import gaps
from core.measured.units import ANGLE_UNITS, TIME_UNITS, meaning
from core.motion import TURN
from core.numerics.cancellation import checkpoint
from core.output.inspection.lift import LiftTable, Probing

TRIES = 720  # zero marks that are tried before the best is refined
MOST_ROWS = 2_000  # of the table, by which they are tried
STEPS, HALVINGS = 60, 40  # of Gauss and Newton's method
LEAST_FITTED = 4  # rows by which two unknowns are fitted
DIGITS = 1e-9  # mm: a row so much beyond the band lies on it


@frozen(eq=False)
class ProfileComparison:
    """Measured rows (n,) beside the exact profile.

    name          of the file; ``lines`` (n,) of it, in the order of the rows
    table         what the probe measures on the exact profile at the rows' cam angles
    measured      (n,) [mm] lift, the fitted offset taken off
    angle_offset  [deg]: cam angle = angle of the row + this; lift_offset [mm]: measured lift = lift of the row - this; both 0
                  where they were not fitted
    fitted        whether they were, by least squares
    notes         how the file was read
    gaps          stretches (from, to) [deg] without a row
    """

    probing: Probing
    name: str
    lines: np.ndarray
    table: LiftTable
    measured: np.ndarray
    angle_offset: float
    lift_offset: float
    fitted: bool
    notes: tuple[str, ...]
    gaps: tuple[tuple[float, float], ...]

    @property
    def deviation(self) -> np.ndarray:
        """Measured lift less that of the exact profile (n,) [mm]."""
        return self.measured - self.table.lift

    @property
    def normal(self) -> np.ndarray:
        """The same normal to the profile (n,) [mm], positive where the cam stands proud (on a groove's outer flank: lies back)."""
        return self.deviation * self.table.cosine

    @property
    def worst(self) -> int:
        """The row with the largest deviation normal to the profile."""
        return int(np.argmax(np.abs(self.normal)))

    @property
    def most(self) -> int:
        """The row with the largest deviation of lift: where the pressure angle is large it is another one."""
        return int(np.argmax(np.abs(self.deviation)))

    @property
    def out(self) -> np.ndarray:
        """(n,) whether the row lies outside of the band."""
        return (self.measured < self.table.lower - DIGITS) | (self.measured > self.table.upper + DIGITS)

    @property
    def in_tolerance(self) -> bool:
        """Whether every row is within the tolerance."""
        return not self.out.any()

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What stands against the cam, and what was not measured."""
        found = list(self.probing.findings)
        if not self.in_tolerance:
            row = int(np.argmax(np.where(self.out, np.abs(self.normal), -1.0)))
            values = {
                "deviation_mm": float(self.deviation[row]), "normal_mm": float(self.normal[row]),
                "limit_mm": self.probing.request.tolerance_mm,
            }  # fmt: skip
            found.append(
                Finding("out-of-tolerance", ERROR, "inspection.tolerance_mm", float(self.table.degrees[row]), values)
            )
        for begin, end in self.gaps:
            found.append(Finding("not-measured", NOTE, "inspection.measured", None, {"from_deg": begin, "to_deg": end}))
        return tuple(found)


def measured_lift(data: bytes, name: str) -> Measured:
    """The lift in a file's bytes: cam angles in degrees unless its header says otherwise, lengths in the unit that it says.

    Raises TableError where a row is wrong, where the values are no lengths, or the angles no angles.
    """
    sheet = read_sheet(data, name)
    how = layout(sheet)
    if meaning(sheet.names[how.angle_column]).unit not in (*ANGLE_UNITS, *TIME_UNITS):
        how = layout(sheet, ColumnChoice(angle_unit="deg"))
    if how.quantity != "displacement":
        raise TableError(
            name, [RowFault(0, f"column {how.value_column + 1} holds a {how.quantity}; wanted: the lift in mm")]
        )
    return read_table(sheet, how)


def compare(probing: Probing, measured: Measured, fit: bool = False) -> ProfileComparison:
    """Measured rows beside the exact profile; fit: the zero mark of the angles and that of the lift are unknown and chosen so that
    the sum of squares is least.

    Raises KindynaError where the rows are too few to be fitted.
    """
    theta, lift = np.deg2rad(measured.angles), measured.values
    shift, level = _fitted(probing, theta, lift) if fit else (0.0, 0.0)
    offset = float(np.rad2deg(np.remainder(shift + 0.5 * TURN, TURN) - 0.5 * TURN))
    table = probing.table(np.mod(measured.angles + offset, 360.0))
    missing = [tuple(float(np.mod(end + offset, 360.0)) for end in gap) for gap in gaps(measured.angles)]
    notes = tuple(note for note in (*measured.layout.guesses, *measured.notes) if not note.startswith("no rows from"))
    return ProfileComparison(
        probing,
        measured.name,
        measured.lines,
        table,
        lift - level,
        offset,
        level,
        fit,
        notes,
        tuple((begin, end or 360.0) for begin, end in missing),
    )


def _fitted(probing: Probing, theta: np.ndarray, lift: np.ndarray) -> tuple[float, float]:
    """Shift of the angles [rad] and level of the lift [mm] with the least Σ (lift - level - L(theta + shift))²: the best of many
    shifts, refined by Gauss and Newton's method, each step halved until it helps."""
    if theta.size < LEAST_FITTED:
        raise KindynaError(f"{theta.size} rows: too few to fit zero mark and level; allowed: {LEAST_FITTED} and more")
    grid = TURN * np.arange(TRIES) / TRIES
    nominal = probing.lift(grid)[0]
    some = slice(None, None, 1 + theta.size // MOST_ROWS)

    def trial(shift: float) -> float:
        return float(np.var(lift[some] - np.interp(theta[some] + shift, grid, nominal, period=TURN)))

    shift = float(min(grid.tolist(), key=trial))

    def residual(shift: float) -> tuple[np.ndarray, np.ndarray, float]:
        exact, slope = probing.lift(np.mod(theta + shift, TURN))
        left = lift - exact
        return left - left.mean(), slope - slope.mean(), float(left.mean())

    left, slope, level = residual(shift)
    for _ in range(STEPS):
        checkpoint()
        steepness = float(slope @ slope)
        if steepness <= (1e-12 * probing.base) ** 2:  # a circle about the cam centre has no zero mark
            break
        step = float(left @ slope) / steepness
        for _ in range(HALVINGS):
            nearer = residual(shift + step)
            if nearer[0] @ nearer[0] <= left @ left:
                break
            step *= 0.5
        else:
            break
        shift += step
        left, slope, level = nearer
        if abs(step) <= 1e-15 * TURN:
            break
    return shift, level


__all__ = ["ProfileComparison", "compare", "measured_lift"]
