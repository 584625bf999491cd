"""The lecture on velocity analysis, chapter 6: its statements page by page."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from core.instant_centres import velocity_polygon
from core.papers import velocity_centres as centres
from core.papers.claim import (
    ROUNDED,
    Drawing,
    Examples,
    FigureTable,
    PaperFigure,
    Polygon,
    Row,
    corrected_print,
    judge_numbers,
    mechanism_figure,
    plot_figure,
    within_bound,
)
from core.papers.velocity_centres import (
    ANGLES,
    CM,
    FOUR_BAR,
    MOVING,
    SIX_BAR,
    SLIDER_CRANK,
    SUSPENSION,
    axle,
    label,
    link_chain,
    posed,
    stored,
)
from core.plot import Plot, PlotCurve

# -- figures and tables -----------------------------------------------------------------------------------------

MM = 1e3
PAGES = {FOUR_BAR: (6, "four-bar"), SLIDER_CRANK: (7, "slider-crank"), SIX_BAR: (8, "six-bar")}


def _centre_table(name: str, last: int | None = None) -> Callable[[Examples], FigureTable]:
    """Function that builds a table of all centres, or of those known after a step.

    Its columns are the position [mm], or the direction [deg] at infinity, and the lines of the construction.
    """

    def table(examples: Examples) -> FigureTable:
        table = posed(examples, name).centres
        plan = table.construction
        steps = plan.steps if last is None else plan.steps[:last]
        known = [(key, "at sight") for key in plan.known]
        known += [(s.key, " and ".join(f"{label(t.first)}-{label(t.second)}" for t in s.triangles[:2])) for s in steps]
        rows = []
        for key, lines in known:
            centre = table.centres[key]
            position = complex(centre.finite[0]) * MM
            if bool(centre.is_far(table.size)[0]):
                where = ("", "", repr(float(np.rad2deg(centre.direction[0]))))
            else:
                where = (repr(position.real), repr(position.imag), "")
            rows.append((label(key), lines, *where))
        return FigureTable(("centre", "found", "x_mm", "y_mm", "direction_deg"), tuple(zip(*rows, strict=True)))

    return table


def step_sheet(name: str, number: int) -> PaperFigure:
    """Figure of one step of the construction; 0: the centres known at sight."""
    page, words = PAGES[name]
    title = f"Lecture p. {page}: centres of the {words}, " + (f"step {number}" if number else "known at sight")
    table = _centre_table(name, number)
    return mechanism_figure(
        f"page_{page}_step_{number}", title, name, ANGLES[name], table, "centres", "kennedy", step=number
    )


def _at_its_angle(
    sheet: str, title: str, name: str, table: Callable[[Examples], FigureTable], *layers: str
) -> PaperFigure:
    return mechanism_figure(sheet, f"Lecture {title}", name, ANGLES[name], table, *layers)


def _polygon_table(examples: Examples) -> FigureTable:
    """Sides of the velocity polygon [cm/s]."""
    study = posed(examples, SIX_BAR)
    sides = velocity_polygon(study.linkage).sides
    vectors = np.array([complex(side.vector[0]) * study.omega / CM for side in sides])
    names = tuple(f"V_{side.end[0]}{side.start[0]}" for side in sides)
    return FigureTable(
        ("velocity", "x_cm_s", "y_cm_s", "size_cm_s"), (names, vectors.real, vectors.imag, np.abs(vectors))
    )


def _polygon(examples: Examples) -> Drawing:
    return Polygon(examples.study(SIX_BAR), ANGLES[SIX_BAR], "Lecture p. 3: velocity differences of the six-bar")


def _chain_table(examples: Examples) -> FigureTable:
    body, base, first, second, ratio = zip(*link_chain(examples), strict=True)
    finite = tuple("" if not np.isfinite(length) else repr(length) for length in second)
    return FigureTable(
        ("of", "from", "base_arm_cm", "body_arm_cm", "ratio"), (body, base, np.array(first), finite, np.array(ratio))
    )


def _ratio_table(name: str) -> Callable[[Examples], FigureTable]:
    def table(examples: Examples) -> FigureTable:
        speeds = {n: float(w[0]) for n, w in posed(examples, name).angular_velocities().items()}
        rpm = np.array(list(speeds.values())) * 30.0 / np.pi
        return FigureTable(("link", "rad_s", "rpm"), (tuple(map(str, speeds)), np.array(list(speeds.values())), rpm))

    return table


def _bump_table(examples: Examples) -> FigureTable:
    columns = axle(examples)
    names = (
        "driver_angle_deg",
        "along_mm",
        "up_mm",
        "link3_deg",
        "steer_other_standing_deg",
        "steer_opposite_bump_deg",
    )
    return FigureTable(names, (examples.study(SUSPENSION).angle_degrees, *columns.values()))


def _bump(examples: Examples) -> tuple[Plot, ...]:
    """Path of the wheel, and over its height the rotation of its link and the axle's steer angle."""
    columns = {name: np.append(column, column[0]) for name, column in axle(examples).items()}
    up = columns["up"]
    path = Plot("Along the car, mm", "Up, mm", (PlotCurve(columns["along"], up),), alike=True, fit=True)
    rotation = Plot("Up, mm", "Angle of the wheel's link, °", (PlotCurve(up, columns["rotation"]),), fit=True)
    words = {"standing": "other wheel fixed", "opposite": "opposite bump"}
    steer = Plot(
        "Up, mm",
        "Steer angle of the axle, °",
        tuple(PlotCurve(up, columns[n], text, i) for i, (n, text) in enumerate(words.items())),
    )
    return path, rotation, steer


def _energy_table(examples: Examples) -> FigureTable:
    names = tuple(f"{name}_kinetic_energy_j" for name in MOVING)
    return FigureTable(
        ("driver_angle_deg", *names), (examples.study(SIX_BAR).angle_degrees, *stored(examples).values())
    )


def _energy(examples: Examples) -> tuple[Plot, ...]:
    plots = []
    for name, energy in stored(examples).items():
        small = float(energy.max()) < 1.0
        curve = PlotCurve(
            np.append(examples.study(name).angle_degrees, 360.0), np.append(energy, energy[0]) * (MM if small else 1.0)
        )
        plots.append(
            Plot("Driver angle, °", f"Kinetic energy of the {MOVING[name]}, {'mJ' if small else 'J'}", (curve,))
        )
    return tuple(plots)


PAGE_1 = plot_figure("page_1", "Lecture p. 1: stored kinetic energy", _energy_table, _energy)
PAGE_3 = PaperFigure("page_3", "Lecture p. 3: velocity differences of the six-bar", _polygon_table, _polygon)
PAGE_8 = _at_its_angle("page_8", "p. 8: all centres of the six-bar", SIX_BAR, _centre_table(SIX_BAR), "centres")
PAGE_9 = _at_its_angle(
    "page_9", "p. 9: velocity ratios of the four-bar", FOUR_BAR, _ratio_table(FOUR_BAR), "centres", "ratios"
)
PAGE_10 = _at_its_angle(
    "page_10", "p. 10: velocities of the slider-crank", SLIDER_CRANK, _ratio_table(SLIDER_CRANK), "centres", "ratios"
)
PAGE_11 = _at_its_angle(
    "page_11", "p. 11: velocities of the six-bar, from link to link", SIX_BAR, _chain_table, "centres", "chain"
)
PAGE_12 = plot_figure("page_12", "Lecture p. 12: the wheel over a bump", _bump_table, _bump)


# -- rows of claims ---------------------------------------------------------------------------------------------

STEPS = {FOUR_BAR: 2, SLIDER_CRANK: 2, SIX_BAR: 8}
"""Number of centres that each construction determines."""


def _steps(name: str) -> tuple[Row, ...]:
    page = PAGES[name][0]
    says = "the unknown centre is the intersection of the lines of two triangles of known centres"
    return tuple(
        Row(
            f"p. {page}, step {number}",
            says,
            centres.step(name, number),
            centres.judge_step,
            name,
            step_sheet(name, number),
        )
        for number in range(1, STEPS[name] + 1)
    )


def _sight(name: str, printed: int) -> Row:
    page, words = PAGES[name]
    return Row(
        f"p. {page}",
        f"n(n - 1)/2 = {printed} centres of the {words}",
        centres.count(name),
        centres.as_counted(printed),
        name,
        step_sheet(name, 0),
    )


ROWS = (
    Row("p. 1", "the velocities give the stored kinetic energy", centres.energy, centres.as_stored, SIX_BAR, PAGE_1),
    Row("p. 2", "V = jω p e^jθ", centres.crank_velocity,
        within_bound("the crank pin's velocity, {crank_pin:.5g} cm/s, is that to {off:.1g} of it"), SIX_BAR),
    Row("p. 3", "VP = VA + VPA", centres.differences,
        within_bound("{count} differences of the six-bar close to {off:.1g} of the largest velocity"), SIX_BAR, PAGE_3),
    Row("p. 4", "4C2 = 4(4 - 1)/2 = 6 centres of four links", centres.count(FOUR_BAR), centres.as_counted(6), FOUR_BAR,
        step_sheet(FOUR_BAR, 0)),
    Row("p. 5", "the three centres of any three links lie on one line; a centre may lie outside its link", centres.on_one_line,
        within_bound(
        "they miss it by at most {off:.1g} over the turn of the six-bar; I13 is {outside:.3f} of link 3 beyond its end"), SIX_BAR,
        PAGE_8),
    _sight(FOUR_BAR, 6),
    *_steps(FOUR_BAR),
    _sight(SLIDER_CRANK, 6),
    *_steps(SLIDER_CRANK),
    _sight(SIX_BAR, 15),
    *_steps(SIX_BAR),
    Row("p. 9", "ω4/ω2 = (I12I24)/(I14I24), ω3/ω2 = (I12I23)/(I13I23)", centres.ratios(FOUR_BAR), within_bound(
        "{ratios}, as by the links to {off:.1g}"), FOUR_BAR, PAGE_9),
    Row("p. 10", "I24: V2 = V4", centres.slider_velocity, within_bound(
        "I12I24 ω2 = {arm:.5g} cm · ω2 = {speed:.6g} cm/s, the slider's velocity to {off:.1g}"), SLIDER_CRANK, PAGE_10),
    Row("p. 11, A", "I12I13 = 20.07 cm, ω3 = 6.64 rpm", centres.six_bar("A"), judge_numbers, SIX_BAR, PAGE_11),
    Row("p. 11, B", "I14I13 = 16.39 cm, ω4 = 20.57 rpm", centres.six_bar("B"), judge_numbers, SIX_BAR, PAGE_11),
    Row("p. 11, C", "(I14I45)/(I15I45) = 6/6, ω5 = 20.57 rpm", centres.six_bar("C"), judge_numbers, SIX_BAR, PAGE_11),
    Row("p. 11, D", "v6 = 22.39 cm/s", centres.six_bar("D"), judge_numbers, SIX_BAR, PAGE_11),
    Row("p. 11, link 3", "link 3 is 6.9 cm long", centres.coupler, corrected_print(ROUNDED,
        "{required:.6f} cm, of which 6.9 is the rounding, for the rocker at 60° of the lecture's own triangle (45°, 120°, 15°), which the "
        "example uses ({own:.6f} cm): with 6.9 cm it is at {rocker:.3f}° and ω3 is {omega_3:.4f} rpm instead of "
        "{own_omega_3:.4f}"), SIX_BAR),
    Row("p. 12", "an uneven road causes the car to steer", centres.steering, centres.steers, SUSPENSION, PAGE_12),
)  # fmt: skip
"""Every row of the lecture."""
