"""The labels of lines in plots: no limit's and no rule's text lies across a curve; without room it is in the legend."""

from collections.abc import Iterator, Sequence

import numpy as np
import pytest
from plot_reading import box_of, curves, is_limit, limits
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtWidgets import QApplication
from sampled import spread
from window_user import Open, wait_for

from core.design import only
from core.errors import KindynaError
from core.output.drawing.palette import BLUE
from core.project import load
from core.study import Quantity, Study
from kindyna_gui.graph.live_plot import LivePlot
from kindyna_gui.pictures.items import Tag
from kindyna_gui.pictures.plots.quantities import limits_of, quantities_for, rows_of, split
from kindyna_gui.pictures.plots.xy import Line, Rule, XYPlot
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.places import example, examples
from kindyna_gui.window.docks import VIEWS

SIZES = ((700, 400), (480, 260), (380, 150), (240, 150))
SHARED = 4  # points of a line between two of its samples


def runs_through(plot: XYPlot | LivePlot, x: np.ndarray, y: np.ndarray, box: QRectF) -> bool:
    """Whether a line through these points of the axes has a point within a box of the scene, an edge apart."""
    steps = np.arange(SHARED * (x.size - 1) + 1) / SHARED
    across, upwards = (np.interp(steps, np.arange(x.size), row) for row in (x, y))
    corner, far = (plot.getViewBox().mapViewToScene(QPointF(at, at)) for at in (0.0, 1.0))
    pixels_x = corner.x() + across * (far.x() - corner.x())
    pixels_y = corner.y() + upwards * (far.y() - corner.y())
    inner = box.adjusted(1.0, 1.0, -1.0, -1.0)
    within = (inner.left() < pixels_x) & (pixels_x < inner.right())
    return bool((within & (inner.top() < pixels_y) & (pixels_y < inner.bottom())).any())


def limited_plots(name: str) -> Iterator[tuple[Study, Sequence[Quantity]]]:
    """Each drive of an example, and the quantities of each plot with a limit."""
    design = load(example(name))
    for number in range(len(design.drives)):
        study = Study(only(design, number), 360)
        for view in VIEWS.values():
            try:
                rows, _ = (
                    split(study, rows_of(study, quantities_for(study, view.quantities)))
                    if view.quantities
                    else ([], [])
                )
            except KindynaError:
                continue
            if rows and limits_of(study, rows):
                yield study, rows


@pytest.mark.parametrize("name", spread(sorted(path.stem for _, path in examples()), 6))
def test_no_limits_text_lies_across_a_curve(app: QApplication, name: str) -> None:
    for study, rows in limited_plots(name):
        plot = LivePlot()
        for size in SIZES:
            plot.resize(*size)
            plot.show()
            plot.set_curves(study, rows)
            app.processEvents()
            shown = limits(plot)
            for text in shown:
                crossed = [curve for curve in curves(plot) if runs_through(plot, curve.x, curve.y, box_of(text))]
                assert not crossed, f"{text.text} at {size}"
            hidden = [item for item in plot.items() if isinstance(item, Tag) and is_limit(item) and item not in shown]
            assert all(item.text[:8] in plot.legend.text for item in hidden), "it is in the legend instead"
        plot.close()


def test_a_limit_says_what_it_limits(app: QApplication) -> None:
    """A text without its value is no alarm: *limit of undercut*, not *undercut*."""
    for name in ("transfer_lift", "conjugate"):
        for study, rows in limited_plots(name):
            assert all("limit" in short or "allowable" in short for _, (_, short, _) in limits_of(study, rows))


def texts(plot: XYPlot) -> list[Tag]:
    return [item for item in plot.items() if isinstance(item, Tag) and item.text and item.isVisible()]


def test_a_rules_text_finds_a_free_place_or_moves_to_the_legend(app: QApplication) -> None:
    x = np.linspace(0.0, 10.0, 200)
    plot = XYPlot("x, mm", "y, N")
    plot.resize(420, 260)
    plot.show()
    level, upright = Rule(0.9, "limit 0.9 N", SCREEN.limit, level=True), Rule(3.0, "answer 3 mm", SCREEN.ink, low=True)
    app.processEvents()
    for wave in (np.sin(0.3 * x), 0.9 + 0.05 * np.sin(x), np.exp(-x), 0.9 + 0.0 * x):
        plot.show_lines([Line(x, wave, BLUE)], rules=[level, upright])
        app.processEvents()
        shown = texts(plot)
        assert {text.text for text in shown} == {level.text, upright.text}
        assert not any(runs_through(plot, x, wave, box_of(text)) for text in shown)
    dense = 0.9 + np.sin(200.0 * np.linspace(0.0, 10.0, 4000))
    plot.show_lines([Line(np.linspace(0.0, 10.0, 4000), dense, BLUE)], rules=[level, upright])
    app.processEvents()
    assert texts(plot) == []
    assert level.text in plot.legend.text
    assert upright.text in plot.legend.text


def test_the_limits_of_find_lie_beside_its_curve(open_user: Open) -> None:
    user = open_user(example("transfer_lift"))
    view = user.window.show_view("find")
    wait_for(lambda: view.up_to_date and not view.busy and bool(view.plot.rules))
    tags = {text.text: text for text in texts(view.plot)}
    assert {rule.text for rule in view.plot.rules if rule.text} <= tags.keys() | {view.plot.legend.text}
    for text in tags.values():
        assert not any(runs_through(view.plot, x, y, box_of(text)) for x, y in view.plot.lines), text.text
