"""The views of the window as a table, and the docks that hold them: a view is made when it is first seen."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtWidgets import QDockWidget, QMainWindow, QWidget

from core.frozen import frozen
from kindyna_gui.documents.session import Session
from kindyna_gui.player import Player
from kindyna_gui.view import View, in_sight

LEFT = Qt.DockWidgetArea.LeftDockWidgetArea
RIGHT = Qt.DockWidgetArea.RightDockWidgetArea
BOTTOM = Qt.DockWidgetArea.BottomDockWidgetArea
CENTRE = Qt.DockWidgetArea.NoDockWidgetArea  # no dock: a page in the middle of the window

Make = Callable[[Session, Player], View]


def lazily(module: str, name: str, **more: Any) -> Make:
    """Makes a view whose module is imported only then."""

    def make(session: Session, player: Player) -> View:
        view: View = getattr(import_module(f"kindyna_gui.{module}"), name)(session, player, **more)
        return view

    return make


@frozen
class ViewRow:
    """One view: its title, what makes it, the side of the window that suits it, or the middle; whether it is a picture
    worth exporting; of a plot its quantities; whether it shows nothing without a cam. Where it stands in each task is in
    ``tasks.TASKS``."""

    title: str
    make: Make
    area: Qt.DockWidgetArea
    picture: bool = False
    quantities: tuple[str, ...] = ()
    of_cam: bool = False


def _plot(title: str, *quantities: str, of_cam: bool = False) -> ViewRow:
    make = lazily("graph.plots_view", "PlotView", quantities=quantities)
    return ViewRow(title, make, RIGHT, picture=True, quantities=quantities, of_cam=of_cam)


VIEWS: Mapping[str, ViewRow] = MappingProxyType(
    {
        "mechanism": ViewRow("Mechanism", lazily("linkage.mechanism_view", "MechanismView"), CENTRE, picture=True),
        "graph": ViewRow("Graph", lazily("graph.graph_view", "GraphView"), CENTRE, picture=True),
        "curves": ViewRow("Curves", lazily("graph.curves_view", "CurvesView"), CENTRE, picture=True),
        "laws": ViewRow("Laws", lazily("motion.laws_view", "LawsView"), CENTRE, picture=True),
        "stability": ViewRow("Stability", lazily("stability.stability_view", "StabilityView"), CENTRE, picture=True),
        "log": ViewRow("Log", lazily("window.log_view", "LogView"), CENTRE),
        "parameters": ViewRow("Parameters", lazily("forms.parameters_view", "ParametersView"), LEFT),
        "motion": ViewRow("Motion", lazily("motion.segments_view", "SegmentsView"), LEFT),
        "drives": ViewRow("Drives", lazily("drives.drives_view", "DrivesView"), LEFT),
        "find": ViewRow("Find", lazily("find.find_view", "FindView"), LEFT),
        "centres": ViewRow("Centres", lazily("linkage.centres_view", "CentresView"), LEFT),
        "circle": ViewRow("Circle diagram", lazily("linkage.circle_view", "CircleView"), LEFT),
        "polygon": ViewRow("Polygons", lazily("linkage.polygon_view", "PolygonView"), LEFT, picture=True),
        "displacement": _plot("Displacement", "displacement", "elastic_displacement"),
        "velocity": _plot("Velocity", "velocity"),
        "acceleration": _plot("Acceleration", "acceleration", "elastic_acceleration"),
        "jerk": _plot("Jerk", "jerk"),
        "pressure_angle": _plot("Pressure angle", "pressure_angle", "second_pressure_angle"),
        "curvature": _plot(
            "Curvature",
            "pitch_curvature",
            "profile_curvature",
            "outer_curvature",
            "second_profile_curvature",
            of_cam=True,
        ),
        "torque": _plot("Torque", "drive_torque", "motor_torque", "linear_motor_torque"),
        "camshaft_speed": _plot("Camshaft speed", "camshaft_speed"),
        "contact_force": _plot("Contact force", "contact_force", "second_contact_force", "elastic_contact_force"),
        "contact_pressure": _plot("Contact pressure", "contact_pressure", "second_contact_pressure", of_cam=True),
        "shaft_torque": ViewRow("Shaft torque", lazily("shaft.torque_view", "ShaftTorqueView"), RIGHT, picture=True),
        "shaft_figures": ViewRow("Shaft figures", lazily("shaft.torque_view", "ShaftFiguresView"), RIGHT, picture=True),
        "against_speed": ViewRow("Against speed", lazily("shaft.speeds_view", "AgainstSpeedView"), RIGHT, picture=True),
        "findings": ViewRow("Findings", lazily("window.findings_view", "FindingsView"), BOTTOM),
        "certificate": ViewRow("Certificate", lazily("window.certificate_view", "CertificateView"), BOTTOM),
        "timing": ViewRow("Timing", lazily("timing.timing_view", "TimingView"), BOTTOM, picture=True),
        "contact": ViewRow("Keeping contact", lazily("graph.contact_view", "ContactView"), RIGHT, of_cam=True),
        "vibration": ViewRow(
            "Response spectrum", lazily("graph.vibration_view", "VibrationView"), RIGHT, picture=True, of_cam=True
        ),
        "flywheel": ViewRow("Flywheel", lazily("graph.flywheel_view", "FlywheelView"), BOTTOM),
    }
)
"""Every view by the name that menus and ``show_view`` use."""

PLAYER_BAR = lazily("window.player_bar", "PlayerBar")


class Dock(QDockWidget):
    """A dock whose view is made when it is first seen.

    seen   the view came into sight, or went out of it
    """

    seen = Signal()

    def __init__(self, name: str, row: ViewRow, make: Callable[[], View], window: QMainWindow) -> None:
        super().__init__(row.title, window)  # without a window it would be one, and float until it is laid out
        self.setObjectName(name)
        self._make = make
        self._view: View | None = None
        self._held = False
        self._blank = QWidget()
        self._no_title = QWidget()
        self._no_title.setParent(self)
        self._no_title.hide()
        self.setWidget(self._blank)
        self._soon = QTimer(self, singleShot=True, interval=0)
        self._soon.timeout.connect(self.wake)
        self.visibilityChanged.connect(self._visibility_changed)

    @property
    def view(self) -> View | None:
        """The view, None where it has not been seen yet."""
        return self._view

    def build(self) -> View:
        """The view, made now where it is not there yet."""
        if self._view is None:
            self._view = self._make()
            self.setWidget(self._view)
            self._blank.deleteLater()
        return self._view

    def wake(self) -> None:
        """Make the view, or let it catch up, if something of the dock can be seen."""
        if in_sight(self) and not self._held:
            self.build().wake()
        self.seen.emit()

    def hold(self, on: bool) -> None:
        """Make no view while something else is to be seen first."""
        self._held = on
        if not on:
            self._soon.start()

    def _visibility_changed(self, visible: bool) -> None:
        # whether it stands in front is known once the tabs are laid out
        self._soon.start()

    def show_title(self, on: bool) -> None:
        """Behind a tab with the same words a title is a waste of height."""
        hidden = self.titleBarWidget() is self._no_title
        if on and hidden:
            self.setTitleBarWidget(None)  # type: ignore[arg-type]
            self._no_title.setParent(self)
            self._no_title.hide()
        elif not on and not hidden:
            self.setTitleBarWidget(self._no_title)
