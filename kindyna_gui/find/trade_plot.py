"""The trade-off of a search as a curve: what is reached over the value that it is bought with, limit and answer marked on it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.design import Design
from core.find import LIMITS, Solution
from kindyna_gui.find.texts import axis_title, typed_text, unit_of
from kindyna_gui.pictures.plots.xy import Dots, Line, Rule, XYPlot
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import short
from kindyna_gui.preferences.units import size_of

ROOM = 1.6  # of the highest value that is marked, shown of a curve that goes on rising
MARK_DIGITS = 6  # of the answer beside its line
BESIDE = 0.03  # of the width, left free on both sides


def show_solution(plot: XYPlot, design: Design, solution: Solution) -> None:
    """Draw what a search has found: a curve over one value, the limit level, the answer upright and a dot, the present value a
    ring."""
    path, key = next(iter(solution.answer)), solution.curve_of
    low, high = solution.near
    curve = np.array([point for point in solution.curve if low <= point[0] <= high])
    x, y = curve[:, 0], np.where(np.isfinite(curve[:, 1]), curve[:, 1], np.nan)
    limit = solution.limits.get(key)
    answer = (solution.answer[path], solution.reached.get(key, solution.answer.get(key, np.nan)))
    now = (solution.present[path], solution.before.get(key, solution.present.get(key)))
    if key in solution.answer:  # another field that is varied: the first one is what it is bought with
        path, key, x, y, answer, now = key, path, y, x, answer[::-1], now[::-1]
    size = size_of(unit_of(design, path).symbol), size_of(unit_of(design, key).symbol)
    x, y, answer = x / size[0], y / size[1], (answer[0] / size[0], answer[1] / size[1])
    dots, rules = [_dot(answer)], []
    if now[0] is not None and now[1] is not None and np.isfinite(now[1]):
        now = now[0] / size[0], now[1] / size[1]
        dots.append(_dot(now, hollow=True))
    if limit is not None:
        text = f"limit {typed_text(limit, unit_of(design, key))}" if limit or key not in LIMITS else "undercut"
        limit /= size[1]
        rules.append(Rule(limit, text, SCREEN.limit, level=True))
    rules.append(Rule(answer[0], short(answer[0], min(MARK_DIGITS, solution.digits)), SCREEN.ink, low=True))
    plot.name_axes(axis_title(design, path), axis_title(design, key))
    colour = SCREEN.family("pressure-angle" if key in LIMITS and LIMITS[key].is_upper else "curvature")
    plot.show_lines([Line(x, _what_matters(y, [answer[1], now[1], limit]), colour)], rules=rules, dots=dots)
    beside = BESIDE * float(np.ptp(x))  # else a dot at the end of the curve is cut
    plot.show_range((float(x.min()) - beside, float(x.max()) + beside))


def _dot(at: tuple[float, float], hollow: bool = False) -> Dots:
    return Dots(np.array(at[:1]), np.array(at[1:]), SCREEN.ink, hollow=hollow)


def _what_matters(y: np.ndarray, pins: Sequence[float | None]) -> np.ndarray:
    """The values (n,) without those that are far above or below all that are marked, else these would be seen at one height."""
    marked = [value for value in pins if value is not None and np.isfinite(value)]
    most = ROOM * max((abs(value) for value in marked), default=np.inf)
    near = np.where(np.abs(y) <= most, y, np.nan) if most > 0.0 else y
    return near if np.isfinite(near).sum() > 1 else y
