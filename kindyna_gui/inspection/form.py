"""How a cut cam is inspected, as a form that begins with the cam's own follower."""

from __future__ import annotations

from core.design import Design
from core.output.files.inspection import follower_direction, follower_probe
from core.output.files.probe import PROBES, InspectionRequest
from kindyna_gui.forms.computed_dialog import flanks
from kindyna_gui.forms.request_form import RequestForm

A_RADIUS = 5.0  # mm, where the cam's own follower has none


class ProbeForm(RequestForm):
    """Each flank begins with the probe that is its own follower; a probe without a radius is asked for none."""

    def __init__(self, design: Design) -> None:
        first = {"direction_deg": follower_direction(design), "radius_mm": A_RADIUS}
        super().__init__(InspectionRequest, flanks(design), first)
        self._design = design
        self.boxes["tolerance_mm"].setPrefix("± ")
        self.boxes["probe"].removeItem(0)  # that of the cam's own follower is named
        self._begin()
        self.boxes["flank"].currentIndexChanged.connect(self._begin)
        self.boxes["probe"].currentIndexChanged.connect(self._offer_radius)

    def _begin(self) -> None:
        name, radius = follower_probe(self._design, self.boxes["flank"].currentData())
        self.show_value("probe", name)
        if radius > 0.0:
            self.show_value("radius_mm", radius)
        self._offer_radius()

    def _offer_radius(self) -> None:
        self.boxes["radius_mm"].setEnabled(PROBES[self.boxes["probe"].currentData()].radius)

    @property
    def request(self) -> InspectionRequest:
        request: InspectionRequest = super().request
        return request


__all__ = ["ProbeForm"]
