"""Yang and Shon, blended cam curves: their statements in the order of the paper."""

from core.papers.claim import CONTRADICTION, MISPRINT, Row, kept, mended
from core.papers.yang import curves, sheets, tables
from core.papers.yang.curves import DRD, PEAK, PICKER

_BOTH = kept("{left:.10g} and {right:.10g}")

ROWS = (
    Row("§1, 1-4", "heights add up to the stroke, spans to the angle, velocity and acceleration meet at every join", curves.conditions,
        kept("the card picker leaves {off:.1g} of either; jumps of velocity {velocity_jump:.1g}, of acceleration {acceleration_jump:.1g}"),
        PICKER),
    Row("§1", "where the size and the span of a constant acceleration are limited, curves are blended; the common example is the modified "
        "trapezoid", curves.constant_acceleration,
        kept("C1-C2 with {span:.6g}° at {constant:.6g} mm/°² each is the modified trapezoid but for {off:.1g}"), DRD),
    Row("Table 1", "signs of v and a at the ends of 16 curves, and what is usable next", tables.table_1, tables.as_table_1, PICKER,
        sheets.TABLE_1),
    Row("Table 1, CV2", "S of CV2 is 0, -", tables.returning, mended(MISPRINT,
        "it falls as C3, C4, C6 do, which are printed +, 0: {printed:.0f} signs are not those of its formula, with +, 0 {corrected:.0f}"),
        PICKER, sheets.TABLE_1),
    Row("Fig. 1", "PQ, the first part of DRD: s, v and a are 0, then s and v above 0: only C1", tables.first_place, tables.only_c1, DRD,
        sheets.FIG_1),
    Row("Table 2", "at each place of DRD, DRRD and RRR there is only one curve", tables.table_2, tables.as_table_2, PICKER, sheets.TABLE_2),
    Row("Fig. 2", "C1, CV1 and C2 join smoothly in velocity and acceleration", curves.smooth, kept(
        "the largest jump at a join of the rise is {off:.1g} of the largest value; peaks {velocity:.4g} mm/° and {acceleration:.4g} mm/°²"),
        DRD, sheets.FIG_2),
    Row("(1)", "2h1/β1 = h2/β2", curves.join(0, 1), _BOTH, DRD, sheets.FIG_2),
    Row("(2)", "2h3/β3 = h2/β2", curves.join(2, 1), _BOTH, DRD, sheets.FIG_2),
    Row("(3)", "β1 + β2 + β3 = β", curves.total(1), _BOTH, DRD, sheets.FIG_2),
    Row("(4)", "h1 + h2 + h3 = h", curves.total(0), _BOTH, DRD, sheets.FIG_2),
    Row("§3.1", "four equations, six unknowns: two values determine C1-CV1-C2", curves.freedom, curves.two_free, DRD, sheets.FIG_2),
    Row("(5)", "h2/β2 = Cv", curves.constant_velocity, _BOTH, DRD, sheets.FIG_2),
    Row("§3.1, Cv", "with Cv given one of h1, h2, h3 determines C1-CV1-C2", curves.determining, curves.any_height, DRD, sheets.FIG_2),
    Row("(6)", "(2h1/h2 + 1 + 2h3/h2) β2 = β", curves.spans, _BOTH, DRD, sheets.FIG_2),
    Row("(7)", "β2 = 2h/Cv - β", curves.middle_span, _BOTH, DRD, sheets.FIG_2),
    Row("(8)", "h/β ≤ Cv ≤ 2h/β", curves.speed_range, curves.as_range, DRD),
    Row("Fig. 3", "DRRD with a constant velocity takes at least 4 curves", curves.least_curves, curves.four_curves, PICKER, sheets.FIG_3),
    Row("Fig. 4", "18.846 / 169.613 / 14.801 / 96.740°", curves.card_picker, curves.spans_words, PICKER, sheets.FIG_4),
    Row("Fig. 4, table", "where each curve starts and ends", curves.picker_table, curves.as_tabled, PICKER, sheets.FIG_4),
    Row("§3.2, 3)", "rise from 30° to 250°; Fig. 4 has its top at 233.26°", curves.top, mended(CONTRADICTION,
        "both cannot be: with Fig. 4's h1 = h3 = 1 mm the top stands at {here:.4f}°, {printed:.2f}° before the one that the text wants; "
        "with the peak at 250° h3 is {h3:.4f} mm and the spans are {spans}°, top {peak:.6g}°"), PEAK, sheets.FIG_4),
    Row("§3.2, 4)", "constant velocity over at least 150°", curves.constant_length, curves.long_enough, PICKER, sheets.FIG_4),
    Row("Concl.", "design, machining and verification of the cam", curves.made, curves.as_made, PICKER),
)  # fmt: skip
"""Every row of the paper."""

__all__ = ["ROWS"]
