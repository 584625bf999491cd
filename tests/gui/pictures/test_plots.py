"""Curves over the cam angle: their values, units, limits, cursor and paper; and pictures as files."""

from dataclasses import replace
from io import BytesIO
from itertools import pairwise
from math import pi, radians

import numpy as np
import pytest
from mechanisms import LIFT, PUSHER, with_drive, with_follower, with_loads, with_shaft
from PIL import Image
from plot_reading import box_of, cursor, curves, limits, readouts
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QFontMetricsF, QPainterPath
from PySide6.QtSvg import QSvgRenderer
from sampled import spread

from core.design import Design, Motion, NamedCurve, Segment, edited, only
from core.output.channels import channel, channels
from core.output.drawing.palette import FAMILIES
from core.output.drawing.scales import nice_below, ticks
from core.output.drawing.turn import shown_range, spans, typical_range
from core.project import load
from core.study import Study
from kindyna_gui.pictures.film import paint
from kindyna_gui.pictures.items import Outline, Tag
from kindyna_gui.pictures.painter import png, svg
from kindyna_gui.pictures.plots.curves import CurvePlot
from kindyna_gui.pictures.plots.lines import CurveLine
from kindyna_gui.pictures.plots.marks import stacked, stacked_clear
from kindyna_gui.pictures.plots.plot import angle_ticks, name_ticks, value_ticks
from kindyna_gui.pictures.plots.quantities import without_equal_curves
from kindyna_gui.pictures.style import LIGHT, font
from kindyna_gui.pictures.units import digits, measure, number, readable, short
from kindyna_gui.places import example

pytestmark = pytest.mark.usefixtures("app")

SAMPLES = 720


def plot_of(design: Design, *slugs: str, size: tuple[int, int] = (700, 240), samples: int = SAMPLES) -> CurvePlot:
    study = Study(design, samples)
    plot = CurvePlot()
    plot.resize(*size)
    plot.grab()
    plot.set_curves(study, [channel(study.design, slug) for slug in slugs])
    return plot


def title(plot: CurvePlot) -> str:
    return plot.getAxis("left").labelText


def enters(curve: CurveLine, text: Tag, plot: CurvePlot) -> bool:
    """Whether a curve runs under a text."""
    box, view = box_of(text), plot.getViewBox().sceneBoundingRect()
    return curve.enters(
        QRectF(box.left() - view.left(), view.bottom() - box.bottom(), box.width(), box.height()), plot.frame()
    )


# -- units ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("symbol", "peak", "shown", "size"),
    [
        ("N", 45_200.0, "kN", 1e3),
        ("N", 850.0, "N", 1.0),
        ("N", 0.05, "mN", 1e-3),
        ("N", 3e6, "MN", 1e6),
        ("N·m", 7_400.0, "kN·m", 1e3),
        ("mm", 150.0, "mm", 1.0),
        ("mm", 5_000.0, "mm", 1.0),
        ("mm", 0.004, "µm", 1e-3),
        ("mm", 2e5, "m", 1e3),
        ("mm/s", 763.0, "mm/s", 1.0),
        ("mm/s", 2_500.0, "m/s", 1e3),
        ("mm/s²", 6_930.0, "m/s²", 1e3),
        ("mm/s³", 251_000.0, "m/s³", 1e3),
        ("1/mm", 0.0018, "1/m", 1e-3),
        ("1/mm", 0.5, "1/mm", 1.0),
        ("°", 45.0, "°", 1.0),
        ("", 0.9, "", 1.0),
        ("mm/s³", 4e9, "10⁶ m/s³", 1e9),
        ("°/s²", 2e6, "10⁶ °/s²", 1e6),
        ("N", 0.0, "N", 1.0),
        ("N", float("inf"), "N", 1.0),
    ],
)
def test_units_are_chosen_so_that_no_exponent_is_needed(symbol: str, peak: float, shown: str, size: float) -> None:
    display_unit = readable(symbol, peak)
    assert (display_unit.symbol, display_unit.size) == (shown, pytest.approx(size))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (number(-1234.5, 1), "−1234.5"),
        (number(12345.0, 0), "12\u202f345"),
        (number(-0.004, 2), "0.00"),
        (digits(0.0012346), "0.001235"),
        (digits(-45.678), "−45.68"),
        (digits(1e7), "10\u202f000\u202f000"),
        (digits(0.0), "0"),
        (digits(float("inf")), "∞"),
        (digits(float("-inf")), "−∞"),
        (measure(45.0, "°"), "45.00°"),
        (measure(1.5, "kN"), "1.500 kN"),
        (short(250.0), "250"),
        (short(0.25), "0.25"),
        (short(45.0, 4), "45"),
        (short(100.0), "100"),
    ],
)
def test_numbers_for_reading(text: str, expected: str) -> None:
    assert text == expected


def test_steps_are_round() -> None:
    assert [nice_below(v) for v in (0.0199, 1.0, 4.99, 5.0, 70.0)] == pytest.approx([0.01, 1.0, 2.0, 5.0, 50.0])
    assert ticks(-16.0, 103.0, 2) == ([0.0, 100.0], 100.0)
    assert ticks(-16.0, 87.0, 2) == ([0.0, 50.0], 50.0)
    assert [text for _, text in value_ticks(-0.013, 0.012, 100.0)] == ["−0.01", "0.00", "0.01"]
    assert len(value_ticks(-16.0, 87.0, 40.0)) >= 2


# -- curves -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("slug", spread([row.slug for row in channels(LIFT)], 6))
def test_a_curve_is_its_channel(slug: str) -> None:
    row, study = channel(LIFT, slug), Study(LIFT, SAMPLES)
    plot = plot_of(LIFT, slug, size=(700, 400))
    (curve,) = curves(plot)
    x, y = curve.x, curve.y
    assert x[:-1] == pytest.approx(np.rad2deg(study.theta))
    assert x[-1] == 360.0
    values = row.values(study)
    assert y[:-1] * plot.display_unit.size == pytest.approx(values, rel=1e-12, abs=1e-300)
    assert y[-1] == y[0]
    low, high = plot.getViewBox().viewRange()[1]
    assert low < y.min() <= y.max() < high
    assert plot.getViewBox().viewRange()[0] == [0.0, 360.0]
    assert curve.pen().color().name().upper() == LIGHT.family(row.family).upper()
    assert row.label in title(plot)
    if plot.display_unit.symbol:
        assert title(plot).endswith(f", {plot.display_unit.symbol}")


def test_every_family_has_a_colour() -> None:
    for design in (LIFT, PUSHER):
        assert {row.family for row in channels(design)} <= set(FAMILIES)
    assert len(set(FAMILIES.values())) == len(FAMILIES)


@pytest.mark.parametrize(
    ("slug", "unit", "factor"),
    [
        ("displacement_mm", "mm", 1.0),
        ("acceleration_mm_s2", "m/s²", 1e-3),
        ("jerk_mm_s3", "m/s³", 1e-3),
        ("contact_force_n", "kN", 1e-3),
        ("drive_torque_nm", "kN·m", 1e-3),
        ("pitch_curvature_per_mm", "1/m", 1e3),
    ],
)
def test_large_values_take_a_readable_unit(slug: str, unit: str, factor: float) -> None:
    plot = plot_of(LIFT, slug)
    assert plot.display_unit.symbol == unit
    y = curves(plot)[0].y
    assert y[:-1] == pytest.approx(channel(LIFT, slug).values(Study(LIFT, SAMPLES)) * factor)
    assert not [text for _, text in plot.getAxis("left").shown if "e" in text]


def test_curves_of_one_family_are_told_apart_and_named() -> None:
    plot = plot_of(PUSHER, "bearing_x_n", "bearing_y_n", "contact_force_n")
    pens = {curve.pen().color().name() for curve in curves(plot)}
    assert len(pens) == 3
    text = plot.legend.text
    assert all(name in text for name in ("Camshaft bearing, x", "Camshaft bearing, y", "Contact force"))
    assert title(plot) == "Force, N"
    plot.set_curves(Study(PUSHER, SAMPLES), [channel(PUSHER, "contact_force_n")])
    assert plot.legend.text == ""


def test_the_reference_is_dashed_and_in_the_same_unit() -> None:
    plot, row = plot_of(LIFT, "contact_force_n"), channel(LIFT, "contact_force_n")
    other = Study(with_shaft(LIFT, speed_rpm=60.0), 360)
    plot.set_curves(Study(LIFT, SAMPLES), [row], other)
    reference, curve = curves(plot)
    assert reference.pen().style() == Qt.PenStyle.CustomDashLine
    assert curve.pen().style() == Qt.PenStyle.SolidLine
    assert reference.y[:-1] * plot.display_unit.size == pytest.approx(row.values(other))
    low, high = plot.getViewBox().viewRange()[1]
    assert low < reference.y.min() < reference.y.max() < high


def test_a_curve_whose_values_and_axis_stay_is_not_drawn_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """A smaller variant comes and goes next to it."""
    redraw, drawn = CurveLine.redraw, []

    def count(line: CurveLine, path: QPainterPath) -> None:
        drawn.append(line)
        redraw(line, path)

    slow, slower = (Study(edited(LIFT, "shaft.speed_rpm", part * LIFT.shaft.speed_rpm), SAMPLES) for part in (0.5, 0.4))
    plot, study, rows = plot_of(LIFT, "acceleration_mm_s2"), Study(LIFT, SAMPLES), [channel(LIFT, "acceleration_mm_s2")]
    (line,) = curves(plot)
    plot.set_curves(study, rows, slow)  # the legend takes some height
    monkeypatch.setattr(CurveLine, "redraw", count)
    plot.set_curves(study, rows, slower)
    assert line in curves(plot)
    assert len(drawn) == 1
    assert line not in drawn


def test_after_a_change_of_the_look_the_same_request_draws_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """The view refreshes once its plots have taken over theme and font size; nothing is pinned, so the name is empty."""
    plot, study, rows = plot_of(LIFT, "velocity_mm_s"), Study(LIFT, SAMPLES), [channel(LIFT, "velocity_mm_s")]
    plot.set_curves(study, rows, reference_name="")
    laid: list[CurveLine] = []
    lay = CurveLine.lay
    monkeypatch.setattr(CurveLine, "lay", lambda line, *rest: (laid.append(line), lay(line, *rest)))
    plot.update_style()
    assert laid
    laid.clear()
    plot.set_curves(study, rows, reference_name="")
    assert not laid


def test_a_jump_is_a_jump() -> None:
    """The lift's jerk jumps where its dwells end: between two neighbouring samples and nowhere else."""
    y = curves(plot_of(LIFT, "jerk_mm_s3"))[0].y
    steps = np.abs(np.diff(y))
    assert np.sort(steps)[-4:].min() > 0.4 * np.ptp(y)
    assert np.sort(steps)[-5] < 0.15 * np.ptp(y)


def test_infinite_values_are_gaps() -> None:
    jammed = with_loads(with_follower(PUSHER, offset_mm=0.0), friction=6.0)
    study = Study(jammed, SAMPLES)
    force = study.dynamics.contact
    assert np.isinf(force).any()
    plot = plot_of(jammed, "contact_force_n")
    (curve,) = curves(plot)
    y = curve.y
    assert np.isnan(y[:-1]).tolist() == np.isinf(force).tolist()
    path, gap = curve.path(), curve.x[:-1][np.isinf(force)]
    drawn = [path.elementAt(i) for i in range(path.elementCount())]
    lines = [(one.x, other.x) for one, other in pairwise(drawn) if other.isLineTo()]
    assert len(lines) > 0.5 * SAMPLES
    assert not [(start, end) for start, end in lines if ((start <= gap) & (gap <= end)).any()]
    low, high = plot.getViewBox().viewRange()[1]
    assert np.isfinite([low, high]).all()
    assert np.nanmax(np.abs(y)) < 100.0 * (high - low)
    plot.set_angle(float(study.theta[np.flatnonzero(np.isinf(force))[0]]))
    assert plot.readings() == ["∞ N"]
    assert png(plot, 1.0)


def test_a_whole_curve_is_one_line_through_all_its_points() -> None:
    plot = plot_of(LIFT, "velocity_mm_s")
    (curve,) = curves(plot)
    path = curve.path()
    assert [(path.elementAt(i).x, path.elementAt(i).y) for i in range(path.elementCount())] == list(
        zip(curve.x.tolist(), curve.y.tolist(), strict=True)
    )
    assert not any(path.elementAt(i).isMoveTo() for i in range(1, path.elementCount()))


# -- what the axis shows ----------------------------------------------------------------------------------


def test_zero_belongs_to_forces_and_to_places_only_where_near() -> None:
    assert plot_of(LIFT, "contact_force_n").getViewBox().viewRange()[1][0] < 0.0
    assert plot_of(LIFT, "radius_mm").getViewBox().viewRange()[1][0] > 300.0
    assert plot_of(LIFT, "displacement_mm").getViewBox().viewRange()[1][0] < 0.0


def test_a_constant_has_room_around_it() -> None:
    low, high = shown_range([np.full(5, 3.0)], {"length"}, [])
    assert low < 3.0 < high
    low, high = shown_range([np.zeros(5)], {"force"}, [])
    assert low < 0.0 < high


def test_what_is_next_to_infinity_does_not_set_the_scale() -> None:
    values = np.append(np.linspace(1.0, 2.0, 100), [1e9, np.inf])
    low, high = typical_range(values)
    assert 0.4 < low <= 1.1
    assert 1.9 < high < 3.0
    assert typical_range(np.array([np.inf, np.nan])) == (0.0, 0.0)


PRESSED = edited(LIFT, "cam.thickness_mm", 2000.0)
for _name in ("cam.material", "cam.roller_material"):
    PRESSED = edited(PRESSED, _name, "16mncr5")


@pytest.mark.parametrize(
    ("design", "slug", "texts"),
    [
        (LIFT, "pressure_angle_deg", ["typical limit 45°"]),
        (PUSHER, "pressure_angle_deg", ["typical limit 30°"]),
        (LIFT, "pitch_curvature_per_mm", ["undercut from 6.667 1/m"]),
        (
            edited(LIFT, "limits.pressure_angle_return_deg", 30.0),
            "pressure_angle_deg",
            ["typical limit 45°", "limit of the return 30°"],
        ),
        (
            edited(edited(PUSHER, "limits.pressure_angle_return_deg", 30.0), "limits.pressure_angle_rise_deg", 30.0),
            "pressure_angle_deg",
            ["limit of the rise and the return 30°"],
        ),
        (
            edited(edited(PUSHER, "limits.pressure_angle_return_deg", 25.0), "limits.pressure_angle_rise_deg", 28.0),
            "pressure_angle_deg",
            ["limit of the return 25°", "limit of the rise 28°"],
        ),
        (PRESSED, "contact_pressure_mpa", ["allowable 1500 MPa"]),  # also where the pressure is far below it
        (edited(PRESSED, "limits.contact_pressure_mpa", 900.0), "contact_pressure_mpa", ["limit 900 MPa"]),
        (LIFT, "contact_force_n", ["lifts off below 0 kN"]),
        (edited(LIFT, "limits.contact_force_n", 6e4), "contact_force_n", ["lifts off below 0 kN", "limit 60 kN"]),
        (edited(LIFT, "cam.form", "groove"), "contact_force_n", []),
        (LIFT, "displacement_mm", []),
        (LIFT, "jam_factor", []),  # far below its limit
    ],
)
def test_limits_stand_as_red_lines_with_their_value(design: Design, slug: str, texts: list[str]) -> None:
    plot = plot_of(design, slug)
    assert sorted(limit.text for limit in limits(plot)) == sorted(texts)
    low, high = plot.getViewBox().viewRange()[1]
    assert all(low < limit.y() < high for limit in limits(plot))


QUIET = with_drive(
    with_follower(PUSHER, offset_mm=0.0, direction_deg=53.0),
    motion=Motion(0.0, (Segment(360.0, 0.0, NamedCurve("dwell")),)),
)
"""A dwell all round: the pressure angle is the difference of two equal directions."""


def test_what_rounding_leaves_of_a_zero_is_drawn_as_zero() -> None:
    raw = channel(QUIET, "pressure_angle_deg").values(Study(QUIET, SAMPLES))
    assert 0.0 < np.abs(raw).max() < 1e-9, "else there is nothing to be seen here"
    plot = plot_of(QUIET, "pressure_angle_deg")
    (curve,) = curves(plot)
    assert not curve.y.any()
    assert plot.display_unit.symbol == "°"
    low, high = plot.getViewBox().viewRange()[1]
    assert low < -0.1 < 0.1 < high
    plot.set_angle(1.0, Study(QUIET, SAMPLES).at_theta(np.array([1.0])))
    assert plot.readings() == ["0°"]


def test_a_small_quantity_is_no_zero() -> None:
    """A stroke of a nanometre keeps its curves, and so do forces a millionth of what they were."""
    motion = replace(
        LIFT.drive.motion,
        start=150.0,
        segments=tuple(replace(s, rise=1e-8 * s.rise) for s in LIFT.drive.motion.segments),
    )
    plot = plot_of(with_drive(LIFT, motion=motion), "velocity_mm_s")
    assert np.ptp(curves(plot)[0].y) > 0.01
    assert plot.display_unit.symbol.endswith("µm/s")
    assert np.ptp(curves(plot_of(with_drive(LIFT, motion=motion), "drive_torque_nm"))[0].y) > 0.0


def test_a_limit_of_several_curves_is_one_line() -> None:
    design = edited(load(example("conjugate")), "limits.contact_force_n", 200.0)
    plot = CurvePlot()
    plot.resize(640, 300)
    plot.set_curves(Study(design), [channel(design, f"{of}contact_force_n") for of in ("", "second_")])
    assert [limit.text for limit in limits(plot)] == ["limit 200 N"]


def test_the_limits_text_covers_no_curve_where_it_can_be_helped() -> None:
    for design, slug, size in (
        (LIFT, "contact_force_n", (400, 180)),
        (PUSHER, "contact_force_n", (300, 160)),
        (LIFT, "pressure_angle_deg", (400, 180)),
        (PUSHER, "pressure_angle_deg", (300, 160)),
        (LIFT, "pitch_curvature_per_mm", (300, 180)),
    ):
        plot = plot_of(design, slug, size=size)
        plot.grab()
        (limit,), (curve,) = limits(plot), curves(plot)
        assert not enters(curve, limit, plot), slug
    plot = plot_of(LIFT, "pitch_curvature_per_mm", "profile_curvature_per_mm", size=(384, 182))
    plot.grab()
    (limit,) = limits(plot)
    assert limit.text == "Pitch curvature: limit of undercut", "the axis tells the value"
    assert not any(enters(curve, limit, plot) for curve in curves(plot))


@pytest.mark.parametrize("size", [(700, 240), (320, 150), (250, 150)])
def test_the_cursors_value_stands_clear_of_the_limits_text(size: tuple[int, int]) -> None:
    """A force that is zero over the whole turn runs on its limit."""
    idle = with_loads(PUSHER, follower_mass_kg=0.0, spring_rate_n_per_mm=0.0, preload_n=0.0)
    for design in (idle, PUSHER, LIFT):
        plot = plot_of(design, "contact_force_n", size=size)
        plot.grab()
        for degrees in range(0, 361, 4):
            plot.set_angle(radians(degrees))
            (readout,), (limit,) = readouts(plot), limits(plot)
            assert not box_of(readout).adjusted(0.5, 0.5, -0.5, -0.5).intersects(box_of(limit)), f"{degrees} deg"


def test_texts_find_the_gaps_that_are_left() -> None:
    assert stacked_clear([], [50.0], 10.0, 100.0) == stacked([50.0], 10.0, 100.0)
    (one,) = stacked_clear([(45.0, 60.0)], [50.0], 10.0, 100.0)
    assert one == 39.0, "below, which is nearer"
    low, high = sorted(stacked_clear([(40.0, 60.0)], [42.0, 58.0], 10.0, 100.0))
    assert low <= 35.0
    assert high >= 65.0
    assert stacked_clear([(0.0, 95.0)], [50.0], 10.0, 100.0) == stacked([50.0], 10.0, 100.0), "no gap at all"
    crowd = stacked_clear([(12.0, 100.0)], [20.0, 30.0, 40.0], 10.0, 100.0)
    assert crowd == stacked([20.0, 30.0, 40.0], 10.0, 100.0), "too little of it"


# -- paper ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("width", "step"), [(700.0, 30), (400.0, 60), (200.0, 90), (90.0, 180)])
def test_the_cam_angle_has_ticks_every_30_or_60_degrees_where_there_is_room(width: float, step: int) -> None:
    shown = angle_ticks(width)
    assert shown[0] == (0.0, "0")
    assert shown[-1] == (360.0, "360")
    assert shown[1][0] == step


def test_segments_are_named_where_they_are_wide_enough() -> None:
    segments = spans(LIFT.drive.motion)
    assert [s.name for s in segments] == ["Dwell", "Modified sine", "Dwell", "Modified sine", "Dwell"]
    assert [s.start for s in segments] == pytest.approx([0.0, 35.0, 76.5, 283.5, 325.0])
    assert segments[-1].end == 360.0
    wide, narrow = name_ticks(segments, 900.0), name_ticks(segments, 300.0)
    assert [name for _, name in wide] == [s.name for s in segments]
    assert [at for at, _ in wide] == pytest.approx([(s.start + s.end) / 2 for s in segments])
    assert [name for _, name in narrow] == ["D", "MS", "Dwell", "MS", "D"], "the handbooks' abbreviations"
    assert [name for _, name in name_ticks(segments, 150.0)] == ["D", "Dwell", "D"]
    assert name_ticks(segments, 20.0) == []


def test_the_grid_is_one_static_item() -> None:
    plot = plot_of(LIFT, "velocity_mm_s")
    (grid,) = (
        item
        for item in plot.items()
        if isinstance(item, Outline) and item.pen().color().name() == LIGHT.faint.lower() and item.path().elementCount()
    )
    before = grid.path()
    plot.set_angle(1.0)
    plot.set_angle(2.0)
    assert grid.path() == before
    assert not any(plot.getAxis(side).grid for side in ("left", "bottom"))
    xs = {before.elementAt(i).x for i in range(before.elementCount())}
    assert {0.0, 30.0, 180.0, 330.0, 360.0} <= xs


def test_an_empty_plot_says_what_would_fill_it() -> None:
    plot = plot_of(LIFT, "velocity_mm_s")
    plot.show_message("choose a curve")
    assert curves(plot) == []
    assert plot.readings() == []
    assert "choose a curve" in [item.text for item in plot.items() if isinstance(item, Tag)]
    plot.set_curves(Study(LIFT, SAMPLES), [channel(LIFT, "jerk_mm_s3")])
    assert len(curves(plot)) == 1


def test_every_letter_is_in_the_font() -> None:
    metrics = QFontMetricsF(font(12))
    plot = plot_of(LIFT, "pitch_curvature_per_mm")
    plot.set_angle(1.0)
    texts = [item.text for item in plot.items() if isinstance(item, Tag)] + [title(plot)]
    for row in channels(LIFT) + channels(PUSHER):
        texts += [row.label, readable(row.unit.symbol, 1e4).symbol, readable(row.unit.symbol, 1e12).symbol]
    assert not [letter for text in texts for letter in text if not metrics.inFontUcs4(ord(letter))]


# -- cursor -----------------------------------------------------------------------------------------------


def test_the_cursor_tells_the_value_beside_its_line() -> None:
    plot = plot_of(LIFT, "displacement_mm", samples=3600)
    plot.set_angle(radians(10.0))
    assert plot.readings() == ["150.0 mm"]
    plot.set_angle(radians(180.0))
    assert plot.readings() == ["0 mm"]
    assert plot.angle == radians(180.0)
    assert cursor(plot).value() == pytest.approx(180.0)


def test_where_a_curve_crosses_zero_the_cursor_reads_zero() -> None:
    """The jerk of a modified sine vanishes at 7/8 of its span, here 56°: machine angle 24°, less the drive's phase of 328°."""
    feed = only(load(example("transfer_unit")), 0)
    study, plot = Study(feed, SAMPLES), plot_of(feed, "jerk_deg_s3")
    theta = radians(24.0) - radians(328.0) + 2.0 * pi
    plot.set_angle(theta, study.at_theta(np.array([theta])))
    assert plot.readings() == ["0 °/s³"]


@pytest.mark.parametrize("degrees", spread([0.0, 1.0, 58.0, 90.0, 180.0, 304.0, 340.0, 355.0, 360.0], 4))
@pytest.mark.parametrize("slugs", [("velocity_mm_s",), ("slider_pin_n", "arm_pin_n", "pivot_n", "bearing_n")])
@pytest.mark.parametrize("size", [(700, 240), (320, 150)])
def test_the_cursors_values_stay_inside_the_plot_and_apart(
    degrees: float, slugs: tuple[str, ...], size: tuple[int, int]
) -> None:
    plot = plot_of(LIFT, *slugs, size=size)
    plot.set_angle(radians(degrees))
    view = plot.getViewBox().sceneBoundingRect()
    line = plot.getViewBox().mapViewToScene(QPointF(degrees, 0.0)).x()
    boxes = []
    assert len(readouts(plot)) == len(slugs)
    for readout in readouts(plot):
        boxes.append(box_of(readout))
        assert view.adjusted(-0.5, -0.5, 0.5, 0.5).contains(boxes[-1])
        assert not boxes[-1].left() < line < boxes[-1].right()
    if size[1] > 200:
        for i, one in enumerate(boxes):
            assert not any(one.adjusted(0, 0.5, 0, -0.5).intersects(other) for other in boxes[i + 1 :])


def test_boxes_are_moved_apart_as_little_as_needed() -> None:
    assert stacked([50.0, 20.0], 10.0, 100.0) == [50.0, 20.0]
    assert stacked([50.0, 52.0], 10.0, 100.0) == [50.0, 60.0]
    assert stacked([99.0, 98.0, 97.0], 10.0, 100.0) == [94.0, 84.0, 74.0]
    assert stacked([-5.0], 10.0, 100.0) == [6.0]
    assert stacked([], 10.0, 100.0) == []


def test_paper_has_no_cursor() -> None:
    plot = plot_of(LIFT, "velocity_mm_s")
    plot.show_cursor(False)
    plot.set_angle(1.0)
    assert readouts(plot) == []
    line = cursor(plot)
    assert not [item for item in plot.items() if item.zValue() == line.zValue() and item.isVisible()], "nor dots"


# -- files ------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def pictures() -> dict[str, bytes]:
    return paint(Study(LIFT, SAMPLES))


@pytest.mark.stress
def test_a_report_has_its_pictures(pictures: dict[str, bytes]) -> None:
    assert list(pictures) == ["mechanism.png", "mechanism.svg", "motion.png", "cam.png", "forces.png"]
    for name, data in pictures.items():
        if name.endswith(".png"):
            with Image.open(BytesIO(data)) as image:
                assert min(image.size) > 1000
                assert len(image.convert("RGB").getcolors(1 << 24)) > 30


@pytest.mark.stress
def test_the_same_design_gives_the_same_bytes(pictures: dict[str, bytes]) -> None:
    assert paint(Study(LIFT, SAMPLES)) == pictures


@pytest.mark.parametrize(
    ("name", "families"),
    [
        ("motion.png", ("displacement", "velocity", "acceleration", "jerk")),
        ("cam.png", ("pressure-angle", "curvature", "length")),
        ("forces.png", ("force", "torque")),
    ],
)
def test_the_colours_of_the_quantities_are_in_the_pictures(
    pictures: dict[str, bytes], name: str, families: tuple[str, ...]
) -> None:
    with Image.open(BytesIO(pictures[name])) as image:
        colours = image.convert("RGB").getcolors(image.width * image.height)
    counts, shown = (np.array(each) for each in zip(*colours, strict=True))
    for family in families:
        colour = LIGHT.family(family)
        rgb = [int(colour[i : i + 2], 16) for i in (1, 3, 5)]
        assert counts[np.abs(shown - rgb).max(axis=1) < 24].sum() > 200, family


def test_the_svg_is_a_drawing_with_real_texts(pictures: dict[str, bytes]) -> None:
    drawing = pictures["mechanism.svg"]
    renderer = QSvgRenderer(drawing)
    assert renderer.isValid()
    text = drawing.decode("utf-8")
    for word in ("Cam angle", "cam", "roller", "arm", "500 mm", "<title>lift</title>"):
        assert word in text
    assert 'viewBox="0 0 960 720"' in text
    assert "<image" not in text


def test_a_plot_becomes_svg_without_pixels() -> None:
    data = svg(plot_of(LIFT, "acceleration_mm_s2", size=(900, 240)), "acceleration")
    assert QSvgRenderer(data).isValid()
    assert "<image" not in data.decode("utf-8")
    assert "Modified sine" in data.decode("utf-8")


def test_the_flywheel_gives_the_torque_picture_a_second_curve() -> None:
    rows = [channel(LIFT, slug) for slug in ("drive_torque_nm", "motor_torque_nm")]
    assert without_equal_curves(Study(LIFT, SAMPLES), rows) == rows[:1]
    assert without_equal_curves(Study(with_shaft(LIFT, flywheel_inertia_kg_m2=5000.0), SAMPLES), rows) == rows


def test_a_low_plot_keeps_its_height_for_the_curve_and_says_the_unit_of_the_angle_behind_its_last_number() -> None:
    plot = plot_of(LIFT, "pressure_angle_deg")
    axis = plot.getAxis("bottom")
    assert (axis.labelText, axis.shown[-1][1]) == ("Cam angle, °", "360")
    whole = plot.height() - plot.getViewBox().height()
    plot.resize(380, 130)
    plot.grab()
    assert (axis.labelText, axis.shown[-1][1]) == ("", "360°")
    assert plot.height() - plot.getViewBox().height() < whole - 15
    plot.resize(700, 240)
    plot.grab()
    assert (axis.labelText, axis.shown[-1][1]) == ("Cam angle, °", "360")
