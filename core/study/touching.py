"""What touches the cam: materials and load ratings of a study's design, and how fast its rollers turn."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from core import stress
from core.cam import INNER, OUTER, SECOND
from core.stress import Pairing
from core.study.study import Study

PRESSURES: Mapping[str, str] = {INNER: "contact_pressure", SECOND: "second_contact_pressure"}
"""First flank of each roller -> the quantity; of a groove both flanks together."""
ROLLERS: Mapping[str, tuple[str, ...]] = {"first": (INNER, OUTER), "second": (SECOND,)}


def pairings(study: Study) -> Mapping[str, Pairing]:
    """Flank -> what touches there; empty where a stress is not asked for, or not all is known."""
    drive = study.design.drive
    return stress.pairings(drive.face, drive.cam) if drive.cam is not None else {}


def ratings(study: Study) -> Mapping[str, float]:
    """Roller -> load rating [N], as far as stated."""
    drive = study.design.drive
    return stress.ratings(drive.face, drive.cam) if drive.cam is not None else {}


def pressing(study: Study, roller: str) -> np.ndarray:
    """What presses a roller on its flanks (n,) [N]."""
    flanks = zip(study.cam.flanks, study.dynamics.contacts, strict=True)
    pressed = [contact.force for flank, contact in flanks if flank.name in ROLLERS[roller]]
    return np.sum([np.maximum(each, 0.0) for each in pressed], axis=0)


def roller_speed(study: Study, roller: str) -> np.ndarray:
    """ω_r (n,) [rad/s] about its own axis, on the flank that carries."""
    flanks = [
        (flank, contact)
        for flank, contact in zip(study.cam.flanks, study.dynamics.contacts, strict=True)
        if flank.name in ROLLERS[roller]
    ]
    speed = stress.roller_speed(study.linkage, flanks[0][0], study.sense)
    for flank, contact in flanks[1:]:
        speed = np.where(contact.force > 0.0, stress.roller_speed(study.linkage, flank, study.sense), speed)
    return speed * study.omega
