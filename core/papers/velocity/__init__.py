"""The lecture on velocity analysis, chapter 6: its statements page by page."""

from core.papers.claim import ROUNDED, Row, as_printed, kept, mended
from core.papers.velocity import centres, sheets
from core.papers.velocity.centres import FOUR_BAR, SIX_BAR, SLIDER_CRANK, SUSPENSION

STEPS = {FOUR_BAR: 2, SLIDER_CRANK: 2, SIX_BAR: 8}
"""Centres that the construction of each finds."""


def _steps(name: str) -> tuple[Row, ...]:
    page = sheets.PAGES[name][0]
    says = "the wanted centre lies where the lines of two triangles of known centres cross"
    return tuple(
        Row(
            f"p. {page}, step {number}",
            says,
            centres.step(name, number),
            centres.crossed,
            name,
            sheets.step_sheet(name, number),
        )
        for number in range(1, STEPS[name] + 1)
    )


def _sight(name: str, printed: int) -> Row:
    page, words = sheets.PAGES[name]
    return Row(
        f"p. {page}",
        f"n(n - 1)/2 = {printed} centres of the {words}",
        centres.count(name),
        centres.as_counted(printed),
        name,
        sheets.step_sheet(name, 0),
    )


ROWS = (
    Row("p. 1", "the velocities give the stored kinetic energy", centres.energy, centres.as_stored, SIX_BAR, sheets.PAGE_1),
    Row("p. 2", "V = jω p e^jθ", centres.crank_velocity, kept("the crank pin's velocity, {crank_pin:.5g} cm/s, is that to {off:.1g} of it"),
        SIX_BAR),
    Row("p. 3", "VP = VA + VPA", centres.differences, kept("{count} differences of the six-bar close to {off:.1g} of the largest velocity"),
        SIX_BAR, sheets.PAGE_3),
    Row("p. 4", "4C2 = 4(4 - 1)/2 = 6 centres of four links", centres.count(FOUR_BAR), centres.as_counted(6), FOUR_BAR,
        sheets.step_sheet(FOUR_BAR, 0)),
    Row("p. 5", "the three centres of any three links lie on one line; a centre may lie outside its link", centres.on_one_line, kept(
        "they miss it by at most {off:.1g} over the turn of the six-bar; I13 lies {outside:.3f} of link 3 beyond its end"), SIX_BAR,
        sheets.PAGE_8),
    _sight(FOUR_BAR, 6),
    *_steps(FOUR_BAR),
    _sight(SLIDER_CRANK, 6),
    *_steps(SLIDER_CRANK),
    _sight(SIX_BAR, 15),
    *_steps(SIX_BAR),
    Row("p. 9", "ω4/ω2 = (I12I24)/(I14I24), ω3/ω2 = (I12I23)/(I13I23)", centres.ratios(FOUR_BAR), kept(
        "{found}, as by the links to {off:.1g}"), FOUR_BAR, sheets.PAGE_9),
    Row("p. 10", "I24: V2 = V4", centres.slider_velocity, kept(
        "I12I24 ω2 = {arm:.5g} cm · ω2 = {speed:.6g} cm/s, the slider's velocity to {off:.1g}"), SLIDER_CRANK, sheets.PAGE_10),
    Row("p. 11, A", "I12I13 = 20.07 cm, ω3 = 6.64 rpm", centres.six_bar("A"), as_printed, SIX_BAR, sheets.PAGE_11),
    Row("p. 11, B", "I14I13 = 16.39 cm, ω4 = 20.57 rpm", centres.six_bar("B"), as_printed, SIX_BAR, sheets.PAGE_11),
    Row("p. 11, C", "(I14I45)/(I15I45) = 6/6, ω5 = 20.57 rpm", centres.six_bar("C"), as_printed, SIX_BAR, sheets.PAGE_11),
    Row("p. 11, D", "v6 = 22.39 cm/s", centres.six_bar("D"), as_printed, SIX_BAR, sheets.PAGE_11),
    Row("p. 11, link 3", "link 3 is 6.9 cm long", centres.coupler, mended(ROUNDED,
        "{asked:.6f} cm, of which 6.9 is the rounding, for the rocker at 60° of the lecture's own triangle (45°, 120°, 15°), which the "
        "example takes ({own:.6f} cm): with 6.9 cm it stands at {rocker:.3f}° and ω3 is {omega_3:.4f} rpm instead of "
        "{own_omega_3:.4f}"), SIX_BAR),
    Row("p. 12", "an uneven road causes the car to steer", centres.steering, centres.steers, SUSPENSION, sheets.PAGE_12),
)  # fmt: skip
"""Every row of the lecture."""

__all__ = ["ROWS"]
