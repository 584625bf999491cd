"""kindyna_gui.pictures.plots.lines, plot: names above a plot, however narrow it is."""

import pytest
from mechanisms import LIFT, PUSHER
from PySide6.QtCore import QRectF
from window_user import Alone, settle

from core.design import Design
from core.output.channels import channel, channels
from core.project import load
from core.study import Study
from kindyna_gui.documents.session import Session
from kindyna_gui.graph.graph_choice import PlotSelection
from kindyna_gui.graph.graph_view import GraphView
from kindyna_gui.graph.live_plot import LivePlot
from kindyna_gui.pictures.plots.curves import CurvePlot
from kindyna_gui.pictures.plots.lines import Entry, cut, legend_rows
from kindyna_gui.pictures.plots.marks import title_pieces
from kindyna_gui.pictures.plots.xy import Line, XYPlot
from kindyna_gui.places import example
from kindyna_gui.player import Player

pytestmark = pytest.mark.usefixtures("app")

CURVATURE = ("pitch_curvature_per_mm", "profile_curvature_per_mm")
FORCES = ("bearing_x_n", "bearing_y_n", "contact_force_n", "guide_force_n")


def plot_of(design: Design, slugs: tuple[str, ...]) -> CurvePlot:
    study = Study(design, samples=90)
    plot = CurvePlot()
    plot.set_curves(study, [channel(study.design, slug) for slug in slugs])
    return plot


def lay(plot: CurvePlot | XYPlot, width: int, height: int) -> tuple[QRectF, QRectF]:
    """Where names and curves stand in the widget [pixels]."""
    plot.resize(width, height)
    plot.grab()
    return plot.legend.sceneBoundingRect(), plot.getViewBox().sceneBoundingRect()


@pytest.mark.parametrize(("design", "slugs"), [(LIFT, CURVATURE), (PUSHER, FORCES)])
def test_names_never_push_the_plot_out_of_sight(design: Design, slugs: tuple[str, ...]) -> None:
    """Made wider and narrower again: the curves end where the paper does, the names stand above them."""
    plot = plot_of(design, slugs)
    _, first = lay(plot, 700, 400)
    for width in (700, 260, 240, 420, 300):
        for height in (120, 178, 400):
            names, curves = lay(plot, width, height)
            assert width - curves.right() == pytest.approx(700 - first.right(), abs=1.0)
            assert curves.left() == pytest.approx(first.left(), abs=1.0)
            assert names.left() >= curves.left() - 1.0
            assert names.right() <= curves.right() + 1.0
            assert names.top() >= 0.0
            assert names.bottom() <= curves.top()
            assert curves.height() >= 24.0


def test_two_names_that_do_not_fit_beside_each_other_stand_on_two_lines() -> None:
    plot = plot_of(LIFT, CURVATURE)
    _, wide = lay(plot, 420, 210)
    assert plot.legend.text.split() == ["—", "Pitch", "curvature", "—", "Profile", "curvature"]
    assert "\n" not in plot.legend.text
    _, narrow = lay(plot, 260, 210)
    assert plot.legend.text == "— Pitch curvature\n— Profile curvature"
    assert narrow.top() > wide.top() + 8.0
    assert narrow.bottom() == wide.bottom()
    _, again = lay(plot, 420, 210)
    assert again == wide
    study = Study(LIFT, samples=90)
    plot.set_curves(study, [channel(study.design, CURVATURE[0])])
    _, alone = lay(plot, 421, 170)
    assert plot.legend.text == ""
    assert alone.top() < wide.top() - 8.0, "no room is lost where nothing has a name"


def test_what_is_too_long_for_its_lines_is_cut() -> None:
    """Four names in a plot too low for more than two lines; a high one has room for all of them."""
    plot = plot_of(PUSHER, FORCES)
    lay(plot, 260, 120)
    assert plot.legend.text.count("\n") == 1
    assert plot.legend.text.count("…") >= 2
    assert plot.legend.text.count("—") == len(FORCES), "each curve keeps its mark"
    lay(plot, 260, 400)
    assert "…" not in plot.legend.text
    assert plot.legend.text.count("\n") == 3


def test_a_note_stands_behind_the_names_only_where_all_is_on_one_line() -> None:
    plot = XYPlot("Time, s", "Wind-up, °")
    rows = Study(LIFT, samples=90).theta
    plot.show_lines(
        [Line(rows, rows, "#0072B2", "one of them"), Line(rows, -rows, "#D55E00", "the other")], note="a note"
    )
    for width, noted in ((600, True), (250, False)):
        names, curves = lay(plot, width, 220)
        assert ("a note" in plot.legend.text) is noted
        assert names.center().x() == pytest.approx(curves.center().x(), abs=1.0)
        assert names.bottom() <= curves.top() + 4.0


def test_lines_are_filled_one_after_the_other() -> None:
    assert legend_rows([30.0, 40.0, 50.0], 10.0, 90.0, 3) == [[0, 1], [2]]
    assert legend_rows([30.0, 40.0, 50.0], 10.0, 79.0, 3) == [[0], [1], [2]]
    assert legend_rows([30.0, 40.0, 50.0], 10.0, 79.0, 2) == [[0, 1], [2]], "then they are cut"
    assert legend_rows([], 10.0, 79.0, 2) == []
    assert cut("Contact force", 9.0, len) == "Contact…"
    assert cut("Contact", 7.0, len) == "Contact"
    assert cut("Contact", 0.0, len) == "C…"
    assert Entry("#000000", "a").mark == "—"


def test_names_of_a_polar_plot_are_cut_to_their_room() -> None:
    names = [("Link 3, acceleration", "#111111"), ("Link 4, acceleration", "#222222")]
    for room in (30.0, 50.0, 200.0):
        told = title_pieces(names, "m/s²", "#333333", len, room)
        assert sum(len(text) for text, _ in told) <= room
        assert [colour for _, colour in told] == ["#111111", "#222222", "#333333"]
        assert told[-1][0] == "m/s²"
        assert ("…" in told[0][0]) is (room < 50.0)


@pytest.fixture
def narrow(alone: Alone) -> GraphView:
    """The graph of a linkage with three plots in a narrow window."""
    return alone(GraphView(Session(load(example("lecture_six_bar"))), Player()), 520, 520)


def test_names_of_a_polar_plot_leave_the_corner_free(narrow: GraphView) -> None:
    names = [row.name for row in channels(narrow.session.design) if row.name.endswith("_velocity")]
    narrow.selection = PlotSelection([names, names[:1]])
    narrow.set_form("polar")
    settle()
    panel = narrow.panels[0]
    button = panel.close_button.geometry().translated(-panel.plot.pos())
    picture = panel.plot.grab().toImage()
    paper = picture.pixel(picture.width() - 1, 0)
    assert {picture.pixel(x, y) for x in range(button.left(), picture.width()) for y in range(button.bottom())} == {
        paper
    }
    assert len({picture.pixel(x, y) for x in range(button.left()) for y in range(button.bottom())}) > 10, (
        "beside it they stand"
    )


def test_names_stay_clear_of_the_button_that_takes_a_plot_away(narrow: GraphView) -> None:
    assert len(narrow.panels) == 3
    for panel in narrow.panels:
        plot = panel.plot
        assert isinstance(plot, LivePlot)
        assert panel.close_button.isVisible()
        told = plot.legend.sceneBoundingRect().translated(plot.mapTo(panel, plot.rect().topLeft()))
        assert plot.legend.text
        assert told.right() <= panel.close_button.geometry().left()
    names = [row.name for row in channels(narrow.session.design) if row.name.endswith("_velocity")]
    narrow.selection = PlotSelection([names])
    narrow.invalidate()
    settle()
    (alone,) = narrow.panels
    assert not alone.close_button.isVisible()
    assert isinstance(alone.plot, LivePlot)
    assert alone.plot.corner == 0.0
