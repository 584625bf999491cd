"""Study of a design: stages of every drive, computed on first use, the drives on their shaft, and figures of designs."""

from typing import TYPE_CHECKING

from core.design import STAGES, Segment
from core.design.curves import solve_machines_by
from core.process import lazy_attributes
from core.study.camshaft import Camshaft
from core.study.drive_forces import roller_lives
from core.study.drive_study import SAMPLES
from core.study.extremes import cam_extremes, extremes_of, undercut_on
from core.study.findings import findings_of
from core.study.many import Many, many
from core.study.quantities import QUANTITIES, Quantity, names_of, quantities_of, quantity
from core.study.quantity_requests import TOTALS
from core.study.stages import clear_caches, evaluations
from core.study.study import Study

if TYPE_CHECKING:
    from core.laws.local import LocalLaw
    from core.study.certificate import certificate_of
    from core.study.machine_laws import law_in_machine
    from core.study.sensitivities import sensitivity
    from core.study.speeds import at_speeds
else:
    __getattr__ = lazy_attributes(__name__, "certificate", "machine_laws", "sensitivities", "speeds")

__all__ = [
    "QUANTITIES", "SAMPLES", "STAGES", "TOTALS", "Camshaft", "Many", "Quantity", "Study", "at_speeds", "cam_extremes",
    "certificate_of", "clear_caches", "evaluations", "extremes_of", "findings_of", "law_in_machine", "many", "names_of", "quantities_of",
    "quantity", "roller_lives", "sensitivity", "undercut_on",
]  # fmt: skip


def _law_in_machine(segment: Segment, whole_turn: bool) -> "LocalLaw":
    from core.study.machine_laws import law_in_machine as solve  # imported here to save start-up time

    return solve(segment, whole_turn)


solve_machines_by(_law_in_machine)
