"""The limits that plots show as thin lines: one row per quantity, read from where core judges by them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import pi
from types import MappingProxyType

import numpy as np

from core.cam import PRESSURE_LIMITS
from core.mechanism.kinematics import REVOLUTE
from core.study import Study


@dataclass(frozen=True)
class Limit:
    """A value not to be passed [SI], and the words that say so."""

    value: float
    words: str


def _pressure_angle(study: Study) -> float:
    kinematics = study.linkage
    held = kinematics.pairs[kinematics.ground].kind if kinematics.ground else REVOLUTE
    return PRESSURE_LIMITS[held] * pi / 180.0


def _undercut(study: Study) -> float:
    """The pitch curvature whose radius is that of the roller; infinite for an edge."""
    flank = study.cam.flank
    radius = float(np.abs(flank.profile - flank.pitch)[0])
    return 1.0 / radius if radius > 0.0 else np.inf


LIMITS: Mapping[str, tuple[str, Callable[[Study], float]]] = MappingProxyType(
    {
        "pressure_angle": ("usual limit {}", _pressure_angle),
        "pitch_curvature": ("undercut from {}", _undercut),
        "contact_force": ("lifts off below {}", lambda study: 0.0),
        "jam_factor": ("jams from {}", lambda study: 1.0),
    }
)


def limit_of(study: Study, quantity: str) -> Limit | None:
    """The limit of a quantity of ``core.study``, None where there is none."""
    row = LIMITS.get(quantity)
    if row is None:
        return None
    value = row[1](study)
    return Limit(value, row[0]) if np.isfinite(value) else None
