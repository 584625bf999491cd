"""Level of detail: fewer points, the same picture, and all of them again where they are wanted."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mechanisms import LIFT, PUSHER
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPainterPath, QPainterPathStroker, QTransform
from PySide6.QtWidgets import QWidget
from sampled import spread

from core.design import Design, edited
from core.output.channels import channels
from core.output.drawing.scales import needed
from core.study import Study
from kindyna_gui.graph.live_plot import LivePlot
from kindyna_gui.graph.live_polar import LivePolar
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.items import Loop, Silhouette
from kindyna_gui.pictures.painter import PICTURES, MechanismSheet
from kindyna_gui.pictures.plots import lines as plot_lines
from kindyna_gui.pictures.plots.lines import CurveLine
from kindyna_gui.pictures.plots.polar import PolarPlot
from kindyna_gui.pictures.units import level

pytestmark = pytest.mark.usefixtures("app")
SAMPLES = 1800
FINE = 0.05  # pixels: a line that is off by so little looks the same
EDGE = 26  # of 255: what antialiasing makes of a line that is off by so much, and of rounding to 1/64 pixel
# Qt draws hair lines piece by piece: where many pieces meet in a pixel it gets darker than one line would make it
HAIR = 90


@pytest.fixture(autouse=True)
def application(app: object) -> None:
    """Pictures want one."""


def dots(widget: QWidget) -> np.ndarray:
    """What a widget shows (height, width, 3)."""
    image = widget.grab().toImage().convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, : 3 * image.width()].reshape(image.height(), image.width(), 3).astype(int)


def inked(plot: LivePlot) -> np.ndarray:
    """The curve of a plot as one line one pixel wide, drawn in one go (height, width)."""
    view, (curve,) = plot.getViewBox(), lines(plot)
    box, (low, high) = view.sceneBoundingRect(), view.viewRange()[1]
    onto = QTransform().scale(box.width() / 360.0, -box.height() / (high - low)).translate(0.0, -high)
    image = QImage(round(box.width()) + 2, round(box.height()) + 2, QImage.Format.Format_Grayscale8)
    image.fill(255)
    painter = QPainter(image)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    stroker = QPainterPathStroker()
    stroker.setWidth(1.0)
    painter.fillPath(stroker.createStroke(onto.map(curve.path())), QColor("black"))
    painter.end()
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, : image.width()].astype(int)


def off(points: np.ndarray, kept: np.ndarray) -> float:
    """How far the points are from the line through those that are kept, at most."""
    farthest = 0.0
    for start, end in pairwise(kept.tolist()):
        one, way = points[start], points[end] - points[start]
        part = points[start : end + 1] - one
        along = np.clip((part * np.conj(way)).real / (abs(way) ** 2 or 1.0), 0.0, 1.0)
        farthest = max(farthest, float(np.abs(part - along * way).max()))
    return farthest


# -- which points -----------------------------------------------------------------------------------------


@given(st.integers(0, 2**32 - 1), st.integers(1, 700), st.floats(0.0, 2.0))
def test_no_point_left_out_is_further_off_than_allowed(seed: int, count: int, tolerance: float) -> None:
    """Random walks that stand still, jump and turn back."""
    random = np.random.default_rng(seed)
    steps = random.normal(size=(count, 2)) @ [1.0, 1.0j] * random.choice([0.0, 0.01, 1.0, 50.0], size=count)
    points = np.cumsum(steps)
    kept = needed(points, tolerance)
    assert kept[0] == 0
    assert kept[-1] == count - 1
    assert (np.diff(kept) > 0).all()
    assert off(points, kept) <= tolerance * 2.0**0.5 + 1e-9


def test_a_straight_line_needs_its_ends_a_circle_few_points_a_jump_both_sides() -> None:
    x = np.linspace(0.0, 300.0, 1801)
    assert needed(x + 0j, FINE).size < 40
    assert needed(100.0 * np.exp(2j * np.pi * x / 300.0), FINE).size < 300
    jump = x + 1j * np.where(x < 123.4, 0.0, 50.0)
    kept = needed(jump, FINE)
    edge = int(np.flatnonzero(np.diff(jump.imag))[0])
    assert {edge, edge + 1} <= set(kept.tolist())
    spike = x + 1j * (np.arange(1801) == 777) * 0.4
    assert 777 in needed(spike, FINE)


def test_what_is_beside_a_gap_stays_and_no_tolerance_keeps_all() -> None:
    points = np.linspace(0.0, 300.0, 600) + 0j
    points[200:230] = complex(np.nan, np.nan)
    assert {199, *range(200, 230), 230} <= set(needed(points, 1.0).tolist())
    assert needed(points, 0.0).size == 600


def test_a_level_serves_scales_up_to_its_own() -> None:
    assert [level(s) for s in (0.9, 1.0, 1.1, 2.0)] == [1.0, 1.0, 2.0, 2.0]


# -- plots ------------------------------------------------------------------------------------------------


class FullPlot(LivePlot):
    """The same on the screen with every point."""

    unseen = 0.0


def lines(plot: LivePlot) -> list[CurveLine]:
    return [item for item in plot.items() if isinstance(item, CurveLine)]


FEW = ("displacement", "jerk", "pressure_angle", "drive_torque")


@pytest.mark.parametrize(
    ("design", "size", "quantities"),
    spread([(LIFT, (300, 178), ()), (PUSHER, (300, 178), ()), (LIFT, (900, 420), FEW)], 1),
    ids=["lift", "pusher", "large"],
)
def test_a_curve_of_few_points_looks_like_the_whole(
    design: Design, size: tuple[int, int], quantities: tuple[str, ...]
) -> None:
    study = Study(design, SAMPLES)
    thin, full = LivePlot(), FullPlot()
    for plot in (thin, full):
        plot.text_room = 0.0
        plot.resize(*size)
        plot.grab()
    drawn = []
    for row in (row for row in channels(design) if row.name in (quantities or (row.name,))):
        for plot in (thin, full):
            plot.set_curves(study, [row])
        assert np.abs(inked(thin) - inked(full)).max() <= EDGE, row.slug
        apart = np.abs(dots(thin) - dots(full)).max(axis=2)
        if lines(thin)[0].pen().style() is Qt.PenStyle.SolidLine:
            assert apart.max() <= HAIR, row.slug
        else:
            assert (apart > EDGE).mean() < 2e-3, "only where dashes end"
        assert lines(full)[0].drawn == SAMPLES + 1
        drawn.append(lines(thin)[0].drawn)
        assert lines(thin)[0].path().elementCount() == drawn[-1]
        assert lines(thin)[0].x.size == SAMPLES + 1, "no value is lost"
    assert max(drawn) <= 2 * size[0]
    assert np.median(drawn) <= 0.35 * SAMPLES


def test_a_curve_is_thinned_once_for_a_size_and_a_design(monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither a cursor that moves nor a layout that changes nothing looks at its points again."""
    thinned: list[int] = []
    monkeypatch.setattr(plot_lines, "needed", lambda points, unseen: thinned.append(1) or needed(points, unseen))
    plot = LivePlot()
    plot.resize(300, 178)
    plot.grab()
    plot.set_curves(Study(LIFT, SAMPLES), [row for row in channels(LIFT) if row.name == "jerk"])
    assert thinned
    thinned.clear()
    plot.set_angle(1.0)
    plot.resize(300, 178)
    plot.set_curves(Study(LIFT, SAMPLES), [row for row in channels(LIFT) if row.name == "jerk"])
    plot.grab()
    assert thinned == []


def test_a_larger_plot_gets_more_points() -> None:
    plot = LivePlot()
    counts = []
    for width in (240, 480, 1900):
        plot.resize(width, width // 2)
        plot.grab()
        plot.set_curves(Study(LIFT, SAMPLES), [row for row in channels(LIFT) if row.name == "acceleration"])
        counts.append(lines(plot)[0].drawn)
    assert counts == sorted(set(counts))
    plot.resize(240, 120)
    plot.grab()
    assert lines(plot)[0].drawn == counts[0]


class FullPolar(LivePolar):
    unseen = 0.0


@pytest.mark.stress
def test_a_polar_curve_of_few_points_looks_like_the_whole() -> None:
    study = Study(LIFT, SAMPLES)
    thin, full = LivePolar(), FullPolar()
    for row in channels(LIFT):
        pictures = []
        for plot in (thin, full):
            plot.resize(420, 420)
            plot.set_curves(study, [row])
            pictures.append(dots(plot))
        assert np.abs(pictures[0] - pictures[1]).max() <= HAIR, row.slug
        assert thin.paths[0].elementCount() <= SAMPLES // 2


def test_paper_has_every_point() -> None:
    plot = PolarPlot()
    plot.resize(300, 300)
    plot.set_curves(Study(LIFT, SAMPLES), [row for row in channels(LIFT) if row.name == "radius"])
    plot.show_cursor(False)
    plot.grab()
    assert plot.paths[0].elementCount() >= SAMPLES


# -- the mechanism ----------------------------------------------------------------------------------------


@pytest.fixture(params=[LIFT, PUSHER], ids=lambda d: d.name)
def scenes(request: pytest.FixtureRequest) -> tuple[MechanismScene, MechanismScene]:
    """A drawing as the screen has it, and one with every point."""
    study = Study(request.param, SAMPLES)
    made = MechanismScene(study), MechanismScene(study, closest=1e6)
    for scene in made:
        scene.set_layer("labels", False)
        scene.set_index(271)
    return made


def corners(path: QPainterPath) -> np.ndarray:
    """The points that a path goes through, as complex numbers."""
    return np.array([complex(e.x, e.y) for e in map(path.elementAt, range(path.elementCount()))])


def loops(scene: MechanismScene) -> int:
    return sum(part.item.path().elementCount() for part in scene.parts.values() if isinstance(part.item, Loop))


@pytest.mark.parametrize("zoom", spread([1.0, 7.0, 60.0], 2))
def test_the_cam_of_few_points_looks_like_the_whole(scenes: tuple[MechanismScene, MechanismScene], zoom: float) -> None:
    thin, full = scenes

    def apart() -> np.ndarray:
        pictures = []
        for scene in scenes:
            visible, scale = scene.fit(600, 500)
            near = QRectF(QPointF(), visible.size() / zoom)
            near.moveCenter(scene.item("contact").pos())
            pictures.append(dots(MechanismSheet(scene, 600, 500, (near if zoom > 1.0 else visible, scale * zoom))))
        return np.abs(pictures[0] - pictures[1]).max(axis=2)

    assert (apart() > EDGE).mean() < 2e-3, "only hair lines, where dashes end"
    for scene in scenes:
        for dashed in ("pitch", "base"):
            scene.set_layer(dashed, False)
    assert (apart() > HAIR).sum() <= 2, "a single dot that Qt sets where a line turns on the edge of a pixel"
    assert loops(full) >= 2 * SAMPLES
    assert loops(thin) < {1.0: 0.3, 7.0: 0.6, 60.0: 1.01}[zoom] * loops(full)


@pytest.mark.parametrize("zoom", spread([1.0, 7.0, 60.0], 2))
def test_no_point_of_the_cam_is_off_by_more_than_nobody_sees(
    scenes: tuple[MechanismScene, MechanismScene], zoom: float
) -> None:
    scene, full = scenes
    visible, scale = scene.fit(600, 500)
    scene.show_region(visible, scale * zoom)
    for key, part in scene.parts.items():
        if isinstance(part.item, Loop):
            whole = corners(full.item(key).path())
            kept = np.flatnonzero(np.isin(whole, corners(part.item.path())))
            assert kept[[0, -1]].tolist() == [0, SAMPLES]
            assert off(whole, kept) * scale * zoom <= 2.0 * FINE


def test_a_design_edited_under_the_glass_has_all_its_points_there(
    scenes: tuple[MechanismScene, MechanismScene],
) -> None:
    scene = scenes[0]
    assert scene.geometry is not None
    visible, scale = scene.fit(600, 500)
    scene.show_region(visible, scale * 400.0)
    near = loops(scene)
    larger = edited(
        scene.geometry.study.design, "cam.base_radius_mm", scene.geometry.study.design.drive.cam.base_radius_mm + 0.5
    )
    for keep in (True, False):
        scene.update_study(Study(larger if keep else scene.geometry.study.design, SAMPLES), keep_labels=keep)
        assert loops(scene) == pytest.approx(near, rel=0.02)
    scene.show_region(visible, scale)
    assert loops(scene) < 0.3 * near


def test_zooming_brings_points_back_and_leaves_them_again(scenes: tuple[MechanismScene, MechanismScene]) -> None:
    scene = scenes[0]
    visible, scale = scene.fit(600, 500)
    counts = []
    for zoom in (1.0, 20.0, 400.0, 1.0):
        scene.show_region(visible, scale * zoom)
        counts.append(loops(scene))
    assert counts[0] < counts[1] < counts[2]
    assert counts[3] == counts[0]


def test_a_body_of_pieces_has_no_line_inside() -> None:
    """Where pieces of the arm overlap there is nothing but its fill, and around it one line without a break."""
    scene = MechanismScene(Study(LIFT, 360))
    for name in ("labels", "cam", "pitch", "base", "roller", "normal", "centre", "ground", "scale"):
        scene.set_layer(name, False)
    arm = scene.item("body.arm")
    assert isinstance(arm, Silhouette)
    for key, part in scene.parts.items():
        part.item.setVisible(key == "body.arm")
    hub = arm.mapToScene(QPointF(0.0, 0.0))
    assert scene.geometry is not None
    unit, scale = scene.geometry.unit, 2.0  # pixels per mm
    box = QRectF(hub.x() - 80.0, hub.y() - 80.0, 160.0, 160.0)
    shown = dots(MechanismSheet(scene, 320, 320, (box, scale)))
    fill = np.array([int(fill_of(scene)[i : i + 2], 16) for i in (1, 3, 5)])
    middle = slice(160 - round(0.8 * unit * scale), 160 + round(0.8 * unit * scale))
    assert (np.abs(shown[middle, middle] - fill).max(axis=2) <= 2).all()
    below = shown[160:, 160].max(axis=1)  # out of the hub, where no arm goes
    assert below.min() < 60, "and a dark line around it"
    assert (below < 200).sum() <= 3


def fill_of(scene: MechanismScene) -> str:
    item = scene.item("body.arm")
    assert isinstance(item, Silhouette)
    return item.brush().color().name()


def test_a_vector_picture_may_be_enlarged() -> None:
    text = PICTURES["mechanism.svg"](Study(LIFT, SAMPLES)).decode()
    assert max(path.count("L") for path in text.split("<path")) > 0.8 * SAMPLES
