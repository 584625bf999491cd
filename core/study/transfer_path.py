"""The path on which the first drives of a shaft lead what they carry together: forwards, sideways, up and down."""

from __future__ import annotations

import numpy as np

from core.study.camshaft import Camshaft
from core.study.quantities import quantity
from core.study.study import Study

OUTPUTS = ("displacement", "velocity", "acceleration")
DIRECTIONS = 3


def leads(camshaft: Camshaft[Study]) -> tuple[str, ...]:
    """The drives that lead the path: the first three of the list, or two where there are no more; none where one of them has no
    measure in lengths."""
    names = tuple(camshaft.drives)[:DIRECTIONS]
    return names if len(names) > 1 and all(lever(camshaft.drives[name]) is not None for name in names) else ()


def swings(study: Study) -> bool:
    """Whether a drive's output is an angle."""
    motion = study.design.drive.motion
    return motion is not None and motion.unit == "deg"


def lever(study: Study) -> float | None:
    """Length by output: 1 of what slides; of what swings the length of the roller's arm [m]; None where there is none."""
    if study.design.drive.motion is None:
        return None
    if not swings(study):
        return 1.0
    arm: float | None = getattr(study.design.drive.mechanism, "arm_mm", None)
    return None if arm is None else arm * 1e-3


def travel(camshaft: Camshaft[Study], name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Output of a drive as a length, its velocity and acceleration, each (n,), at its machine angles [m, m/s, m/s²].

    s = y of what slides; s = l φ of what swings, l the length of the roller's arm.
    """
    there, length = camshaft.there(name), lever(camshaft.drives[name])
    assert length is not None, name
    first, second, third = (quantity(key).value(there) * length for key in OUTPUTS)
    return first, second, third


def along(camshaft: Camshaft[Study], order: int) -> np.ndarray:
    """Speed along the path (order 1) and size of the acceleration on it (2), of drives that move at right angles: √(Σ ṡ²), √(Σ s̈²)
    (n,) [m/s, m/s²]."""
    return np.asarray(np.linalg.norm([travel(camshaft, name)[order] for name in leads(camshaft)], axis=0))
