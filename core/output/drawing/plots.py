"""Plots as pictures: curves over common axes, one plot below the other, with segments of the motion and marked extremes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from core.frozen import frozen
from core.number_text import fixed_text, result_text
from core.output.drawing import svg
from core.output.drawing.palette import FAMILIES
from core.output.drawing.scales import decimals_of, needed, readable_unit, ticks
from core.output.drawing.sheet import DASHED, DOTTED, SMALL, paint, picture, text_width
from core.output.drawing.turn import axis_range, readable_range, shown_range, without_noise
from core.plot import Figure, Plot, PlotCurve, PlotDot, Span

# Width of a picture, height of a plot, height of each where there are more than so many plots, pixels.
WIDTH, HEIGHT, LOW_HEIGHT, MANY = 680.0, 150.0, 112.0, 3
LEFT, RIGHT, HEAD, NAMES, FOOT, GAP = 66.0, 18.0, 20.0, 16.0, 38.0, 8.0  # around plots and for their texts, pixels
TICKS_UP, TICK_ROOM, ANGLE_ROOM = 28.0, 46.0, 38.0  # least distance of ticks upwards, across, and of angles, pixels
ANGLE_STEPS = (30.0, 60.0, 90.0, 180.0)
ROOM = 16.0  # above and below the curves for the texts of extremes, pixels
SWATCH, LINE, DOT = 16.0, 1.6, 2.6  # length of a line in the legend, width of a curve, radius of a dot, pixels
DETAIL = 0.1  # error of a thinned curve, pixels
ROWS = ("displacement", "acceleration", "velocity", "jerk", "pressure-angle", "torque", "stress", "energy")
"""Colours of the curves of a plot in order, by the family that they belong to."""
_SIDES = ((0.0, -1.0), (1.0, -1.0), (-1.0, -1.0), (0.0, 1.0), (1.0, 1.0), (-1.0, 1.0), (1.0, 0.0), (-1.0, 0.0))
"""Position of a text relative to its dot, in the order of trial."""

# -- curves over a turn -----------------------------------------------------------------------------------------


@frozen(eq=False)
class TurnCurve:
    """A quantity over the angle of cam, driver or machine.

    Attributes
    ----------
    label, unit, family : quantity, symbol of its unit, and family, which chooses its colour
    angles : ndarray (n,) [deg]
    values : ndarray (n,), in the unit
    extremes : angle [deg] and value of refined extremes
    moving : ndarray (n,) of bool, samples at which the mechanism moves
    gain : increase of the values in a turn
    floor : size below which a value is rounding noise
    """

    label: str
    unit: str
    family: str
    angles: np.ndarray
    values: np.ndarray
    extremes: tuple[tuple[float, float], ...] = ()
    moving: np.ndarray | None = None
    gain: float = 0.0
    floor: float = 0.0


def turn_figure(name: str, across: str, curves: Sequence[TurnCurve], segments: Sequence[Span] = ()) -> Figure:
    """Figure with one plot for each unit, in the order in which the units occur; each in a unit without exponents."""
    by_unit: dict[str, list[TurnCurve]] = {}
    for curve in curves:
        by_unit.setdefault(curve.unit, []).append(curve)
    return Figure("", name, tuple(_turn_plot(across, rows, tuple(segments)) for rows in by_unit.values()))


def _turn_plot(across: str, rows: Sequence[TurnCurve], segments: tuple[Span, ...]) -> Plot:
    values = [without_noise(curve.values, curve.floor) for curve in rows]
    moves = [np.ones(curve.values.size, dtype=bool) if curve.moving is None else curve.moving for curve in rows]
    ranges = [readable_range(row, move) for row, move in zip(values, moves, strict=True)]
    unit = readable_unit(rows[0].unit, max(abs(end) for ends in ranges for end in ends))
    size = unit.size
    drawn = tuple(
        PlotCurve(*closed_turn(curve.angles, row / size, curve.gain / size), curve.label, i, family=curve.family)
        for i, (curve, row) in enumerate(zip(rows, values, strict=True))
    )
    ends = axis_range([(low / size, high / size) for low, high in ranges], {curve.family for curve in rows}, ())
    dots = tuple(
        PlotDot(angle, shown, f"{result_text(shown)} at {result_text(round(angle, 2), 5)}°", i)
        for i, (curve, row) in enumerate(zip(rows, values, strict=True))
        if _spread(row) > curve.floor
        for angle, value in curve.extremes
        for shown in [value / size if abs(value) > curve.floor else 0.0]
    )
    return Plot(across, unit.symbol, drawn, fit=True, dots=dots, spans=segments, ends=ends)


def _spread(values: np.ndarray) -> float:
    known = values[np.isfinite(values)]
    return float(np.ptp(known)) if known.size else 0.0


def closed_turn(angles: np.ndarray, values: np.ndarray, gain: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Curve that ends where the turn does, interrupted where the angles have a gap.

    Parameters
    ----------
    angles : ndarray (n,) [deg]
        Increasing angles.
    values : ndarray (n,) [any unit]
    gain : float
        Increase of the values in a turn.

    Returns
    -------
    angles : ndarray (m,) [deg]
    values : ndarray (m,) [unit of the values], NaN in gaps
    """
    if angles.size < 3:
        return angles, values
    steps = np.diff(angles)
    step = float(np.median(steps))
    cuts = np.flatnonzero(steps > 1.5 * step) + 1
    turns = (angles[-1] + step - angles[0]) / 360.0
    x, y = np.insert(angles, cuts, angles[cuts]), np.insert(values.astype(float), cuts, np.nan)
    if turns > 0.5 and abs(turns - round(turns)) < 1e-6:
        x, y = np.append(x, angles[0] + 360.0 * round(turns)), np.append(y, values[0] + gain)
    return x, y


# -- picture ----------------------------------------------------------------------------------------------------


def figure_picture(figure: Figure) -> str:
    """Picture of all plots of a figure as SVG, on one x axis where they have the same."""
    height = HEIGHT if len(figure.plots) <= MANY else LOW_HEIGHT
    lines: list[str] = []
    top = GAP
    for i, plot in enumerate(figure.plots):
        is_last = i + 1 == len(figure.plots) or plot.across != figure.plots[i + 1].across
        frame = _Frame(plot, top, height, i == 0 or not plot.spans)
        lines += frame.lines(is_last)
        top = frame.bottom + (FOOT if is_last else GAP)
    labels = "; ".join(
        f"{', '.join(dict.fromkeys(c.label for c in plot.curves))} [{plot.upwards}]" for plot in figure.plots
    )
    across = figure.plots[-1].across if figure.plots else ""
    return picture(lines, WIDTH, top, figure.title, f"{labels} over {across[:1].lower()}{across[1:]}")


class _Frame:
    """A plot within its frame in pixels."""

    def __init__(self, plot: Plot, top: float, height: float, has_names: bool) -> None:
        self.plot = plot
        self.roles = _roles(plot.curves)
        self.legend = _legend(plot)
        self.names_top = top + HEAD * len(self.legend)
        self.top = self.names_top + (NAMES if plot.spans and has_names else 4.0)
        self.has_names = has_names
        self.bottom = self.top + height
        self.head = top
        x = np.concatenate([curve.x for curve in plot.curves])
        self.x_ends = (float(np.nanmin(x)), float(np.nanmax(x)))
        if self.x_ends[0] == self.x_ends[1]:
            self.x_ends = (self.x_ends[0] - 0.5, self.x_ends[1] + 0.5)
        families = () if plot.fit else ("force",)  # an axis from zero
        self.y_ends = plot.ends or shown_range([curve.y for curve in plot.curves], families, ())
        if plot.dots:  # room for the texts of the extremes
            room = ROOM * (self.y_ends[1] - self.y_ends[0]) / height
            self.y_ends = (self.y_ends[0] - room, self.y_ends[1] + room)

    def x(self, value: float | np.ndarray) -> np.ndarray:
        """Pixels of a position on the x axis."""
        low, high = self.x_ends
        return np.asarray(LEFT + (value - low) / (high - low) * (WIDTH - LEFT - RIGHT))

    def y(self, value: float | np.ndarray) -> np.ndarray:
        """Pixels of a value."""
        low, high = self.y_ends
        return np.asarray(self.bottom - (value - low) / (high - low) * (self.bottom - self.top))

    def lines(self, is_last: bool) -> list[str]:
        """Elements from the back to the front; the numbers below the last plot of an axis."""
        parts = [*self._spans(), *self._axes(is_last), *self._marks(), *self._curves(), *self._dots(), *self._heads()]
        return svg.group(parts, stroke_linejoin="round", stroke_linecap="round")

    def _text(self, label: str, x: float, y: float, role: str, anchor: str | None = None, size: float = SMALL) -> str:
        place = {"x": round(float(x), 1), "y": round(float(y), 1)}
        return svg.text(label, **place, font_size=size, text_anchor=anchor, **paint(role))

    def _spans(self) -> Iterator[str]:
        for i, span in enumerate(self.plot.spans):
            start, end = (float(self.x(np.clip(at, *self.x_ends))) for at in (span.start, span.end))
            if end - start < 0.5:
                continue
            if i % 2:
                box = {"x": round(start, 2), "y": round(self.top, 2), "width": round(end - start, 2)}
                yield svg.element("rect", **box, height=round(self.bottom - self.top, 2), **paint("band"))
            if self.has_names:
                room = end - start - 4.0
                name = next((name for name in (span.name, span.short) if name and text_width(name, 10.0) <= room), "")
                if name:
                    yield self._text(name, 0.5 * (start + end), self.top - 4.0, "quiet", "middle", 10.0)

    def _axes(self, is_last: bool) -> Iterator[str]:
        values, step = ticks(*self.y_ends, max(2, int((self.bottom - self.top) / TICKS_UP)))
        for value in values:
            y = float(self.y(value))
            yield svg.line(complex(LEFT, -y), complex(WIDTH - RIGHT, -y), 1, **paint("none", "faint"))
            yield self._text(fixed_text(value, decimals_of(step)), LEFT - 6.0, y + 4.0, "ink", "end")
        for value, label in self._x_ticks():
            x = float(self.x(value))
            yield svg.line(complex(x, -self.top), complex(x, -self.bottom), 1, **paint("none", "faint"))
            if is_last:
                yield self._text(label, x, self.bottom + 15.0, "ink", "middle")
        if self.y_ends[0] < 0.0 < self.y_ends[1]:
            zero = float(self.y(0.0))
            yield svg.line(complex(LEFT, -zero), complex(WIDTH - RIGHT, -zero), 1, **paint("none", "quiet"))
        frame = {"x": LEFT, "y": self.top, "width": WIDTH - LEFT - RIGHT, "height": self.bottom - self.top}
        yield svg.element("rect", **frame, **paint("none", "quiet"))
        if is_last:
            middle = 0.5 * (LEFT + WIDTH - RIGHT)
            yield self._text(self.plot.across, middle, self.bottom + 32.0, "ink", "middle")

    def _x_ticks(self) -> list[tuple[float, str]]:
        low, high = self.x_ends
        width = WIDTH - LEFT - RIGHT
        if self.plot.across.endswith("°") and high - low > 90.0:
            turns = (high - low) / 360.0
            step = next(
                (s for s in ANGLE_STEPS if width * s / (high - low) >= ANGLE_ROOM), 360.0 * math.ceil(turns / 12.0)
            )
            first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
            return [(step * i, fixed_text(step * i, 0)) for i in range(first, last + 1)]
        values, step = ticks(low, high, max(2, int(width / TICK_ROOM / 1.5)))
        return [(value, fixed_text(value, decimals_of(step))) for value in values]

    def _marks(self) -> Iterator[str]:
        role = "quiet" if self.plot.quiet else "limit"
        for at, label in self.plot.marks:
            if self.x_ends[0] <= at <= self.x_ends[1]:
                x = float(self.x(at))
                dashes = " ".join(f"{part:g}" for part in DOTTED)
                yield svg.line(
                    complex(x, -self.top), complex(x, -self.bottom), 1, stroke_dasharray=dashes, **paint("none", role)
                )
                anchor, side = ("end", -4.0) if x > 0.8 * WIDTH else (None, 4.0)
                yield self._text(label, x + side, self.top + 12.0, role, anchor)

    def _curves(self) -> Iterator[str]:
        for curve, role in zip(self.plot.curves, self.roles, strict=True):
            dashes = " ".join(f"{part:g}" for part in DASHED) if curve.dashed else None
            for z in self._pieces(curve):
                yield svg.polyline(z, False, 2, stroke_width=LINE, stroke_dasharray=dashes, **paint("none", role))

    def _pieces(self, curve: PlotCurve) -> Iterator[np.ndarray]:
        """Thinned pieces (m,) complex [pixels], y upwards, between the gaps; values beyond the axis are left out."""
        low, high = self.y_ends
        inside = np.isfinite(curve.y) & (curve.y >= low) & (curve.y <= high)
        shown = inside | (np.append(inside[1:], False) | np.append(False, inside[:-1])) & np.isfinite(curve.y)
        z = self.x(curve.x) - 1j * self.y(np.clip(curve.y, low, high))
        for part in np.split(np.arange(z.size), np.flatnonzero(np.diff(shown)) + 1):
            if part.size > 1 and shown[part[0]]:
                yield z[part][needed(z[part], DETAIL)]

    def _dots(self) -> Iterator[str]:
        taken: list[tuple[complex, complex]] = []
        pixels = np.concatenate(
            [z for curve in self.plot.curves for z in self._dense(curve)] or [np.zeros(0, dtype=complex)]
        )
        inside = [dot for dot in self.plot.dots if math.isfinite(dot.y) and self.y_ends[0] <= dot.y <= self.y_ends[1]]
        inside = [dot for dot in inside if self.x_ends[0] <= dot.x <= self.x_ends[1]]
        for dot in inside:
            yield self._label(dot, pixels, taken)
        for dot in inside:
            at = complex(float(self.x(dot.x)), -float(self.y(dot.y)))
            yield svg.circle(at, DOT, 2, stroke_width=1.2, **paint("paper", self.roles[dot.row]))

    def _dense(self, curve: PlotCurve) -> Iterator[np.ndarray]:
        for z in self._pieces(curve):
            for a, b in pairwise(z):
                yield np.linspace(a, b, max(2, int(abs(b - a) / 2.0)))

    def _label(self, dot: PlotDot, pixels: np.ndarray, taken: list[tuple[complex, complex]]) -> str:
        """Text of a dot where it covers no curve and no other text; nothing where there is no room."""
        at = complex(float(self.x(dot.x)), -float(self.y(dot.y)))
        half = 0.5 * complex(text_width(dot.text, 10.0), 10.0)
        is_low = dot.y < 0.5 * sum(self.y_ends)
        for across, up in sorted(_SIDES, key=lambda side: (side[1] > 0.0) is not is_low):
            centre = at + complex(across * (half.real + 5.0), -up * (half.imag + 5.0))
            if not (centre.real - half.real > LEFT and centre.real + half.real < WIDTH - RIGHT):
                continue
            if not (self.top < -centre.imag - half.imag and -centre.imag + half.imag < self.bottom):
                continue
            apart = pixels - centre
            if np.any((np.abs(apart.real) < half.real + 1.0) & (np.abs(apart.imag) < half.imag)):
                continue
            if any(
                abs((c - centre).real) < (h + half).real and abs((c - centre).imag) < (h + half).imag for c, h in taken
            ):
                continue
            taken.append((centre, half))
            return self._text(dot.text, centre.real, -centre.imag + 3.6, "ink", "middle", 10.0)
        return ""

    def _heads(self) -> Iterator[str]:
        for line, entries in enumerate(self.legend):
            x, y = LEFT, self.head + HEAD * line + 13.0
            for row, label in entries:
                if row is not None:
                    yield svg.line(
                        complex(x, 4.0 - y),
                        complex(x + SWATCH, 4.0 - y),
                        1,
                        stroke_width=LINE,
                        **paint("none", self.roles[row]),
                    )
                    x += SWATCH + 5.0
                yield self._text(label, x, y, "ink")
                x += text_width(label) + 14.0


def _roles(curves: Sequence[PlotCurve]) -> list[str]:
    """Colour of each curve: that of its family, another one where the family occurs again; rows that are equal have one colour."""
    roles: list[str] = []
    by_row: dict[int, str] = {}
    for curve in curves:
        wanted = curve.family if curve.family in FAMILIES else ROWS[curve.row % len(ROWS)]
        free = [role for role in (wanted, *ROWS) if role not in by_row.values()]
        roles.append(by_row.setdefault(curve.row, (free or [wanted])[0]))
    return roles


def _legend(plot: Plot) -> list[list[tuple[int | None, str]]]:
    """Lines of the legend: index of a curve and its label, the unit behind the last one."""
    first = {curve.row: i for i, curve in reversed(list(enumerate(plot.curves)))}
    entries: list[tuple[int | None, str]] = [
        (i, plot.curves[i].label) for i in sorted(first.values()) if plot.curves[i].label
    ]
    if plot.note:
        entries.append((None, plot.note))
    unit = plot.upwards
    if not entries:
        return [[(None, unit)]]
    if unit:
        entries[-1] = (entries[-1][0], f"{entries[-1][1]}, {unit}")
    lines: list[list[tuple[int | None, str]]] = [[]]
    room = WIDTH - LEFT - RIGHT
    for entry in entries:
        width = text_width(entry[1]) + SWATCH + 19.0
        if room < width and lines[-1]:
            lines.append([])
            room = WIDTH - LEFT - RIGHT
        lines[-1].append(entry)
        room -= width
    return lines
