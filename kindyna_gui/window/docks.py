"""VIEWS, docks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from importlib import import_module
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QEvent, QObject, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QPaintEvent
from PySide6.QtWidgets import (
    QDockWidget,
    QMainWindow,
    QStyle,
    QStyleOptionDockWidget,
    QStyleOptionFrame,
    QStylePainter,
    QTabBar,
    QWidget,
)

from core.frozen import frozen
from kindyna_gui.documents.session import Session
from kindyna_gui.player import Player
from kindyna_gui.view import View, in_sight

# -- dock sizes ------------------------------------------------------------------------------------------

# Qt squeezes docks when a window shrinks and gives what a growing one gains to the middle alone: a column of plots that
# has once been narrow would stay so.

ACROSS, UPWARDS = Qt.Orientation.Horizontal, Qt.Orientation.Vertical
Area = Qt.DockWidgetArea
NEAR = 8  # pixels from tabs to what they belong to


def _grown(size: int, then: int, now: int) -> int:
    return round(size * now / then)


def _same(size: int, then: int, now: int) -> int:
    return size


@frozen
class ResizeRule:
    """How the docks of an area take part in another size of the window: their width, and their height.

    Each takes a dock's size, and the window's at that time and now.
    """

    across: Callable[[int, int, int], int]
    upwards: Callable[[int, int, int], int]


RULES: Mapping[Area, ResizeRule] = MappingProxyType(
    {
        Area.LeftDockWidgetArea: ResizeRule(_grown, _grown),
        Area.RightDockWidgetArea: ResizeRule(_grown, _grown),
        Area.TopDockWidgetArea: ResizeRule(_grown, _same),
        Area.BottomDockWidgetArea: ResizeRule(_grown, _same),
    }
)
FORMS = frozenset({"parameters"})
"""Docks that need no more width in a large window; a picture does."""


class DockShares(QObject):
    """Notes the sizes of docks whenever the user gives them others, and restores them after a resize of the window."""

    def __init__(self, window: QMainWindow, docks: Iterable[QDockWidget]) -> None:
        super().__init__(window)
        self._window, self._docks = window, tuple(docks)
        self._sizes: dict[str, QSize] = {}
        self._noted, self._seen = QSize(), QSize()  # sizes of the window: at the note, and when last looked at
        self._echo = False
        self._late = QTimer(self, singleShot=True, interval=0)
        self._late.timeout.connect(self._settle)
        window.installEventFilter(self)
        for dock in self._docks:
            dock.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() in (QEvent.Type.Resize, QEvent.Type.Show, QEvent.Type.Hide):
            self._late.start()
        return super().eventFilter(watched, event)

    @property
    def noted(self) -> tuple[Mapping[str, QSize], QSize]:
        """The sizes of docks that the user last saw, by name, and that of the window at the time."""
        if self._noted == self._window.size():  # tabs may have come since
            self._sizes = {name: self._place(dock) for name, dock in self._front().items()}
        return self._sizes, self._noted

    def take_up(self, sizes: Mapping[str, QSize], window: QSize) -> None:
        """Docks are there that are to have these sizes in a window of this one, and others in one of another."""
        self._sizes, self._noted, self._seen = dict(sizes), window, QSize()
        self._echo = False
        self._late.start()

    def _front(self) -> dict[str, QDockWidget]:
        """The docks in sight that stand in the window, by name."""
        return {dock.objectName(): dock for dock in self._docks if not dock.isFloating() and in_sight(dock)}

    def _settle(self) -> None:
        """All sizes are what they will be: restore them where the window has another size, else note them."""
        if not self._window.isVisible():
            return
        front, size = self._front(), self._window.size()
        grown, self._seen = size != self._seen, size
        if self._sizes.keys() != front.keys():
            grown = self._echo = False
        if grown:
            self._restore(front)
            self._echo = True  # the docks report the sizes that they have just been given
            self._late.start()
        elif self._echo:
            self._echo = False
        else:
            self._sizes = {name: self._place(dock) for name, dock in front.items()}
            self._noted = size

    def _place(self, dock: QDockWidget) -> QSize:
        """The size of a dock with the tabs above it of those that share its place, as ``resizeDocks`` counts it."""
        box = dock.geometry()
        bars = self._window.findChildren(QTabBar, options=Qt.FindChildOption.FindDirectChildrenOnly)
        places = [bar.geometry() for bar in bars if bar.isVisible()]
        above = [tabs for tabs in places if tabs.left() == box.left() and 0 < box.top() - tabs.bottom() < NEAR]
        return QSize(box.width(), box.bottom() + 1 - min([tabs.top() for tabs in above], default=box.top()))

    def _restore(self, front: Mapping[str, QDockWidget]) -> None:
        then, now = self._noted, self._window.size()
        for area, rule in RULES.items():
            docks = [dock for dock in front.values() if self._window.dockWidgetArea(dock) == area]
            sizes = [self._sizes[dock.objectName()] for dock in docks]
            form = rule.upwards is _grown and any(dock.objectName() in FORMS for dock in docks)
            across = [(_same if form else rule.across)(size.width(), then.width(), now.width()) for size in sizes]
            upwards = [rule.upwards(size.height(), then.height(), now.height()) for size in sizes]
            self._window.resizeDocks(docks, across, ACROSS)
            self._window.resizeDocks(docks, upwards, UPWARDS)


# -- docks -----------------------------------------------------------------------------------------------

LEFT = Qt.DockWidgetArea.LeftDockWidgetArea
RIGHT = Qt.DockWidgetArea.RightDockWidgetArea
TOP = Qt.DockWidgetArea.TopDockWidgetArea
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
    """One view.

    title        of its dock or page
    make         what makes it
    area         the side of the window that suits it, or the middle; where it stands in each task is in ``tasks.TASKS``
    menu         its entry where ``menus.MENUS`` names it, with what that says of it, its keys, its icon
    picture      whether it is a picture worth exporting
    quantities   of a plot
    of_cam       whether it shows nothing without a cam
    help         the page of the help on it, and behind # the words to look for there
    """

    title: str
    make: Make
    area: Qt.DockWidgetArea
    menu: str = ""
    tip: str = ""
    keys: str | None = None
    icon: str = ""
    picture: bool = False
    quantities: tuple[str, ...] = ()
    of_cam: bool = False
    help: str = "tour"


def _plot(
    title: str,
    quantities: tuple[str, ...],
    menu: str,
    tip: str,
    of_cam: bool = False,
    help: str = "tour#Plots, in the tasks",
) -> ViewRow:
    make = lazily("graph.plots_view", "PlotView", quantities=quantities)
    return ViewRow(title, make, RIGHT, menu, tip, picture=True, quantities=quantities, of_cam=of_cam, help=help)


VIEWS: Mapping[str, ViewRow] = MappingProxyType(
    {
        "mechanism": ViewRow("Mechanism", lazily("linkage.mechanism_view", "MechanismView"), CENTRE,
            "&Mechanism", "The mechanism to scale", picture=True, help="tour#See it move"),
        "graph": ViewRow("Graph", lazily("graph.graph_view", "GraphView"), CENTRE,
            "New &graph...", "Any channels over the cam angle, straight or polar", keys="Ctrl+G", icon="graph", picture=True,
            help="graphs#draws channels of the design in plots"),
        "curves": ViewRow("Curves", lazily("graph.curves_view", "CurvesView"), CENTRE,
            "&Curves", "Channels, tables and other designs on one graph: axes by unit, differences, values",
            icon="graph", picture=True, help="graphs#Curves on one graph"),
        "space": ViewRow("Path in space", lazily("space_view", "SpaceView"), CENTRE,
            "Path in &space", "The path of the part that the drives carry together, as a picture in space that turns", picture=True,
            help="camshaft#Path in space"),
        "laws": ViewRow("Laws", lazily("motion.laws_view", "LawsView"), CENTRE,
            "&Law table", "Every motion law with its peaks, drawn over each other", keys="Ctrl+L", picture=True, help="laws#Motion laws"),
        "stability": ViewRow("Stability", lazily("stability_view", "StabilityView"), CENTRE,
            "&Chart", "Tongues of instability of the flexible camshaft, and the wind-up there", keys="Ctrl+T", picture=True,
            help="stability#What you see"),
        "log": ViewRow("Log", lazily("window.log_view", "LogView"), CENTRE, "Lo&g", "What has failed in this program, and when",
            help="tour#If something fails"),
        "parameters": ViewRow("Parameters", lazily("motion.inspector", "inspector"), RIGHT, help="tour#Change it"),
        "motion": ViewRow("Motion", lazily("motion.segments_view", "SegmentsView"), LEFT,
            "&Motion table", "Segments of the motion: law, span, rise", keys="Ctrl+M", help="making#By mouse"),
        "drives": ViewRow("Drives", lazily("drives_view", "DrivesView"), LEFT,
            "D&rives", "The drives on the shaft: add, copy, remove, rename, turn against each other, peak torques",
            help="camshaft#In the window"),
        "find": ViewRow("Find", lazily("find", "FindView"), LEFT,
            "Fi&nd", "The base radius, roller, offset, pivot or span that just keeps your limits, with what it is traded for",
            keys="Ctrl+F", help="finding#Finding dimensions"),
        "study": ViewRow("Study", lazily("studies.study_view", "StudyView"), LEFT,
            "St&udy", "Vary numbers of the design: curves over one, a live map over two, parallel coordinates of more; a board of designs",
            picture=True, help="studies#In the window"),
        "centres": ViewRow("Centres", lazily("linkage.centres_view", "CentresView"), LEFT,
            "&Instant centres", "Instant centres, angular velocities and points at the angle at hand",
            help="linkages#Instant centres and velocities"),
        "circle": ViewRow("Circle diagram", lazily("linkage.centres_view", "CircleView"), LEFT,
            "Circle &diagram", "Find the instant centres step by step, as the lecture does", help="linkages#Circle diagram"),
        "polygon": ViewRow("Polygons", lazily("linkage.centres_view", "PolygonView"), LEFT, picture=True,
            help="linkages#draws all velocities from one pole"),
        "stack": ViewRow("Motion and pressure angle", lazily("graph.plots_view", "StackView"), LEFT,
            "Motion and pressure an&gle", "Displacement, velocity, acceleration, jerk and pressure angle under each other on one axis",
            picture=True, help="tour#Plots, in the tasks"),
        "displacement": _plot("Displacement", ("displacement", "elastic_displacement"),
            "&Displacement", "Displacement over the cam angle"),
        "velocity": _plot("Velocity", ("velocity",), "&Velocity", "Velocity over the cam angle"),
        "acceleration": _plot("Acceleration", ("acceleration", "elastic_acceleration"),
            "&Acceleration", "Acceleration over the cam angle"),
        "jerk": _plot("Jerk", ("jerk",), "&Jerk", "Jerk over the cam angle"),
        "pressure_angle": _plot("Pressure angle", ("pressure_angle", "second_pressure_angle"),
            "&Pressure angle", "Pressure angle over the cam angle", help="followers#Limits and checks"),
        "curvature": _plot("Curvature", ("pitch_curvature", "profile_curvature", "outer_curvature", "second_profile_curvature"),
            "&Curvature", "Curvature of pitch curve and profile", of_cam=True, help="followers#Limits and checks"),
        "torque": _plot("Torque", ("drive_torque", "motor_torque", "linear_motor_torque"),
            "&Torque", "Torque at the camshaft, with and without flywheel", help="tour#Plots, in the tasks"),
        "camshaft_speed": _plot("Camshaft speed", ("camshaft_speed",),
            "Camshaft &speed", "Speed over the cam angle, which the flywheel evens out", help="tour#Camshaft speed"),
        "contact_force": _plot("Contact force", ("contact_force", "second_contact_force", "elastic_contact_force"),
            "&Contact force", "Force between roller and cam", help="tour#Plots, in the tasks"),
        "contact_pressure": _plot("Contact pressure", ("contact_pressure", "second_contact_pressure"),
            "Contact &pressure", "Hertz pressure between follower and cam, with what its materials bear", of_cam=True,
            help="followers#Contact pressure and rolling life"),
        "shaft_torque": ViewRow("Shaft torque", lazily("shaft", "ShaftTorqueView"), RIGHT,
            "S&haft torque", "What the drives on the shaft ask of it together, with flywheel and balance cam", picture=True,
            help="camshaft#Shaft torque"),
        "shaft_figures": ViewRow("Shaft figures", lazily("shaft", "ShaftFiguresView"), RIGHT,
            "Shaft fig&ures", "Mean, RMS, peak torque and power of each drive and of the shaft; its true speed", picture=True,
            help="camshaft#Shaft figures"),
        "against_speed": ViewRow("Against speed", lazily("shaft", "AgainstSpeedView"), RIGHT,
            "Agai&nst speed", "Torque of the shaft and fluctuation of its speed against the machine's speed", picture=True,
            help="camshaft#Against speed"),
        "servo": ViewRow("Cam or servo", lazily("shaft", "ServoView"), CENTRE,
            "Ca&m or servo", "Torque of cam and flywheel, and of a servo: working points of its motor, energy", picture=True,
            help="controllers#The motor"),
        "findings": ViewRow("Findings", lazily("findings", "FindingsView"), BOTTOM, help="tour#also behind their number"),
        "certificate": ViewRow("Certificate", lazily("findings", "CertificateView"), BOTTOM,
            help="tour#what proves the figures"),
        "timing": ViewRow("Timing", lazily("timing_view", "TimingView"), BOTTOM,
            "T&iming chart", "The motions of all drives over the machine angle, and what must come after what", picture=True,
            help="timing#By mouse"),
        "contact": ViewRow("Keeping contact", lazily("graph.flywheel_view", "ContactView"), RIGHT,
            "K&eeping contact", "Contact force over angle and speed, and the flight of a follower that leaves its cam", of_cam=True,
            help="finding#Keeping contact"),
        "vibration": ViewRow("Response spectrum", lazily("graph.flywheel_view", "VibrationView"), RIGHT,
            "Resp&onse spectrum", "How an elastic follower vibrates in its dwells at the design's speed, and against speed",
            picture=True, of_cam=True, help="followers#Elastic follower"),
        "compare": ViewRow("What changed", lazily("compare", "CompareView"), BOTTOM,
            "&What changed", "Inputs and results beside those of the pinned variant, worst first", help="tour#What changed"),
        "explain": ViewRow("Explain", lazily("compare", "ExplainView"), RIGHT,
            "&Explain a number", "Its equation, each letter with its value at the angle at hand and where that comes from",
            help="tour#Explain a number"),
        "flywheel": ViewRow("Flywheel", lazily("graph.flywheel_view", "FlywheelView"), BOTTOM,
            "&Flywheel", "Size of the flywheel for the wanted evenness of speed", help="tour#how large it must be"),
    }
)  # fmt: skip
"""Every view by the name that menus and ``show_view`` use."""

PLAYER_BAR = lazily("window.player_bar", "PlayerBar")


_ANY_HEIGHT = (1 << 24) - 1  # Qt's own
_ANY = 0, _ANY_HEIGHT


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
        self._heights = _ANY
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
            if hasattr(self._view, "height_wanted"):
                self._view.height_wanted.connect(self._limit)
            self.setWidget(self._view)
            self._blank.deleteLater()
        return self._view

    def _limit(self, least: int, whole: bool) -> None:
        """The view needs at least this height, and no more where that is the whole of it."""
        self._heights = (least, least if whole else _ANY_HEIGHT)
        self._take_limit()

    def _take_limit(self) -> None:
        """A limit counts for a dock that stands alone at its place: what stands behind the same tabs may need more."""
        window = self.parent()
        alone = isinstance(window, QMainWindow) and not self.isFloating() and not window.tabifiedDockWidgets(self)
        self.lift_limit(self._heights if alone else _ANY)

    def lift_limit(self, heights: tuple[int, int] = _ANY) -> None:
        """No limit until it is known with what else the dock stands at its place."""
        view = self._view
        if view is not None and (view.minimumHeight(), view.maximumHeight()) != heights:
            view.setMinimumHeight(heights[0])
            view.setMaximumHeight(heights[1])

    def wake(self) -> None:
        """Make the view, or let it catch up, if something of the dock can be seen."""
        self._take_limit()
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

    def paintEvent(self, event: QPaintEvent) -> None:
        """Qt would keep the title in the letters that it had when the dock was made."""
        painter = QStylePainter(self)
        if self.isFloating():
            frame = QStyleOptionFrame()
            frame.initFrom(self)
            painter.drawPrimitive(QStyle.PrimitiveElement.PE_FrameDockWidget, frame)
        if self.titleBarWidget() is None:
            title = QStyleOptionDockWidget()
            self.initStyleOption(title)
            painter.setFont(self.font())
            painter.drawControl(QStyle.ControlElement.CE_DockWidgetTitle, title)
        painter.end()

    def show_title(self, on: bool) -> None:
        """Behind a tab with the same words a title is a waste of height."""
        hidden = self.titleBarWidget() is self._no_title
        if on and hidden:
            self.setTitleBarWidget(None)  # type: ignore[arg-type]
            self._no_title.setParent(self)
            self._no_title.hide()
        elif not on and not hidden:
            self.setTitleBarWidget(self._no_title)
