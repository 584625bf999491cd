"""The numbers of Shin1995 Fig. 1: the lift in each of the eight layouts, and where its parts stand."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from core.errors import NoAnswer
from core.followers.layouts import LAYOUT_LENGTHS, in_layout
from core.papers.claim import MISPRINT, parted
from core.papers.examples import Examples
from core.papers.sheet import MechanismPicture, PaperFigure
from core.papers.shin1995.geometry import LIFT
from core.study import Study

PRINTED = {
    "a": ("left", "above", "right"), "b": ("left", "above", "left"), "c": ("right", "above", "right"), "d": ("right", "above", "left"),
    "e": ("left", "below", "right"), "f": ("left", "below", "left"), "g": ("right", "below", "right"), "h": ("right", "below", "left"),
}  # fmt: skip
"""Layout -> where cam, roller and slider stand, in the words of §2.1."""
SAMPLES = 360

Numbers = Mapping[str, Any]
Sides = tuple[str, str, str]


def study_of(examples: Examples, letter: str) -> Study:
    study: Study = examples.once(("layout", letter), lambda: Study(in_layout(examples.design(LIFT), letter), SAMPLES))
    return study


def sides(study: Study, theta: float) -> Sides:
    """Where the cam stands of the pivot, the roller of the line from pivot to cam, the slider of the arm's pin."""
    there = study.at_theta(np.array([theta]))
    bodies = there.linkage.bodies
    pivot, pin, slider = (
        complex(bodies[body].place(point)[0])
        for body, point in (("arm", "pivot"), ("arm", "arm_pin"), ("slider", "slider_pin"))
    )
    side = (pivot.conjugate() * complex(there.cam.reference[0])).imag
    left = pivot.real > 0.0
    above = (side if left else -side) > 0.0
    return "left" if left else "right", "above" if above else "below", "left" if slider.real < pin.real else "right"


def types(examples: Examples) -> Numbers:
    """Sides at the base position, and the least contact force [N] over the turn; nothing of a layout that cannot be assembled."""
    found: dict[str, Sides] = {}
    force: dict[str, float] = {}
    for letter in LAYOUT_LENGTHS:
        study = study_of(examples, letter)
        try:
            found[letter] = sides(study, np.pi)
            force[letter] = float(study.dynamics.contact.min())
        except NoAnswer:
            continue
    return {"found": found, "force": force}


def eight(found: Mapping[str, Sides], force: Mapping[str, float]) -> tuple[str, str]:
    """Whether all eight are as described, and the roller stays on the cam in each."""
    alike = [letter for letter in PRINTED if found.get(letter) == PRINTED[letter]]
    held = [letter for letter in PRINTED if force.get(letter, -1.0) > 0.0]
    words = f"({', '.join(alike) or 'none'}) stand as described; the roller stays on the cam in ({', '.join(held) or 'none'})"
    least = f", with at least {min(force.values()) / 1e3:.3g} kN" if force else ""
    return ("agrees" if len(alike) == len(held) == len(PRINTED) else "differs"), words + least


# -- Fig. 16, the lift itself ------------------------------------------------------------------------------


def lift(examples: Examples) -> Numbers:
    return {"found": sides(examples.study(LIFT), np.pi)}


def as_b(found: Sides) -> tuple[str, str]:
    return (
        "agrees" if found == PRINTED["b"] else "differs"
    ), f"cam {found[0]} of the pivot, roller {found[1]}, slider {found[2]}"


NAMED = 17
"""§6.4's number of the figure that has the lift as its sentence describes it: cam left, roller above, slider left."""


def figure_numbers(figures: Mapping[int, PaperFigure]) -> Callable[[Examples], Numbers]:
    """Which of Shin1995's figures of §6, number -> sheet, have a mechanism that stands so."""

    def numbers(examples: Examples) -> Numbers:
        drawn = {number: sheet.drawing(examples) for number, sheet in figures.items() if sheet.drawing is not None}
        posed = {
            number: sides(each.study, np.deg2rad(each.angle_deg))
            for number, each in drawn.items()
            if isinstance(each, MechanismPicture)
        }
        return {"named": NAMED, "shown": tuple(number for number, found in posed.items() if found == PRINTED["b"])}

    return numbers


def as_numbered(named: int, shown: tuple[int, ...]) -> tuple[str, str]:
    words = f"Fig. {' and '.join(map(str, shown))}" if shown else "no figure"
    return parted(MISPRINT, named not in shown, not shown), (
        f"of the figures of §6 {words} has the lift as that sentence describes it; the same number stands for the slider's motion next"
    )
