"""The plots of a graph: their two forms, and the panel that holds one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QPainter, QPaintEvent, QResizeEvent
from PySide6.QtWidgets import QHBoxLayout, QToolButton, QWidget

from core.frozen import frozen
from core.motion.extremes import Extremes
from core.study import Study
from kindyna_gui.graph.live_plot import LivePlot, LivePolar
from kindyna_gui.look import icon
from kindyna_gui.pictures.files import curves_file
from kindyna_gui.pictures.plots.sheets import columns_for, polar_file
from kindyna_gui.pictures.style import SCREEN

LEAST_STRAIGHT, LEAST_POLAR = 118, 280  # height of a plot before the column scrolls, pixels
Plot = LivePlot | LivePolar


@frozen
class PanelForm:
    """Straight or polar: name, tip, a plot of the form, and the file of a picture."""

    label: str
    tip: str
    make: Callable[[int, int], Plot]
    file: Callable[..., bytes]
    least: int
    columns: Callable[[int, float, float], int]


FORMS: Mapping[str, PanelForm] = MappingProxyType(
    {
        "straight": PanelForm(
            "Straight", "The cam angle along, the value upwards",
            lambda i, n: LivePlot(names=i == 0, angles=i == n - 1), curves_file, LEAST_STRAIGHT, lambda *_: 1,
        ),
        "polar": PanelForm(
            "Polar", "The cam angle round about, the value outwards",
            lambda i, n: LivePolar(), polar_file, LEAST_POLAR, columns_for,
        ),
    }
)  # fmt: skip


class Panel(QWidget):
    """One plot with a button that takes it away; a bar on its left where it takes what is ticked next."""

    BAR = 3

    def __init__(self, plot: Plot, take_away: Callable[[], None]) -> None:
        super().__init__()
        self.plot, self.active = plot, False
        row = QHBoxLayout(self)
        row.setContentsMargins(self.BAR + 1, 0, 0, 0)
        row.addWidget(plot)
        self.close_button = QToolButton(self, autoRaise=True)
        self.close_button.setIcon(icon("close"))
        self.close_button.setIconSize(QSize(12, 12))
        self.close_button.setToolTip("Take this plot away")
        self.close_button.setAccessibleName("Take this plot away")
        self.close_button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.close_button.clicked.connect(take_away)

    def offer_close(self, on: bool) -> None:
        """Whether the button is there; the names of the curves stay clear of it."""
        self.close_button.setVisible(on)
        if isinstance(self.plot, LivePlot):  # a polar one always does
            self.plot.keep_corner(float(self.close_button.sizeHint().width()) if on else 0.0)

    def name_angle(self, study: Study) -> None:
        """Cam angle or driver angle, also where no curve is drawn."""
        if isinstance(self.plot, LivePlot):
            self.plot.name_angle(study)

    @property
    def lacks_extremes(self) -> bool:
        """Whether other curves are drawn than those whose extremes were shown last."""
        return self.plot.lacks_extremes

    def show_extremes(self, found: Mapping[str, Extremes] | None) -> None:
        """Mark them."""
        self.plot.show_extremes(found)

    def set_active(self, on: bool) -> None:
        self.active = on
        self.update()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        size = self.close_button.sizeHint()
        self.close_button.setGeometry(self.width() - size.width(), 0, size.width(), size.height())
        self.close_button.raise_()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), self.palette().base())
        if self.active:
            painter.fillRect(0, 2, self.BAR, self.height() - 4, SCREEN.chosen)
        painter.end()
