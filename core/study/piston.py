"""Piston of an engine under a valve: its travel, and the clearance between valve and piston over the turn.

Source of the crank: Heywood, *Internal Combustion Engine Fundamentals*, ch. 2.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from core.design import Engine, Valve, nose_deg, si
from core.design.engine import CRANK_PER_CAM, PARALLEL, within_cycle
from core.study.member_quantities import valve_lift
from core.study.study import Study


def _parts(study: Study) -> tuple[Engine, Valve]:
    engine, valve = study.design.engine, study.design.drive.valve
    assert engine is not None, "a design without [engine]"
    assert valve is not None, "a drive without [valve]"
    return engine, valve


def crank_at(study: Study, theta: Any) -> Any:
    """Crank angle from TDC of overlap of the valve's cylinder, -360 to 360 [deg], at a cam angle or an array of them [rad]."""
    _, valve = _parts(study)
    from_nose = np.rad2deg(theta) - nose_deg(study.design.drive.motion)
    return within_cycle(valve.centre_deg + CRANK_PER_CAM * from_nose)


def crank_degrees(study: Study) -> np.ndarray:
    """Crank angle from TDC of overlap of the valve's cylinder.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,) [deg]
        -360 … 360.
    """
    return np.asarray(crank_at(study, study.theta))


def throw_angle(study: Study) -> np.ndarray:
    """Angle of the crank's throw from the axis of the cylinder; with a pin offset it is not 0 where the piston is highest.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,) [rad]
    """
    s = si(_parts(study)[0])
    return np.deg2rad(crank_degrees(study)) + np.arcsin(s.pin_offset / (0.5 * s.stroke + s.rod))


def piston_travel(study: Study) -> np.ndarray:
    """Travel of the piston below its highest position, x = √((R + l)² - e²) - R cos θ - √(l² - (R sin θ - e)²).

    R is half the stroke, l the rod, e the pin offset, θ the angle of the throw.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,) [m]

    References
    ----------
    Heywood, ch. 2, with the pin offset.
    """
    s, theta = si(_parts(study)[0]), throw_angle(study)
    throw = 0.5 * s.stroke
    low = throw * np.cos(theta) + np.sqrt(s.rod**2 - (throw * np.sin(theta) - s.pin_offset) ** 2)
    return np.asarray(np.sqrt((throw + s.rod) ** 2 - s.pin_offset**2) - low)


def clearance_parts(study: Study) -> tuple[np.ndarray, np.ndarray]:
    """Travel x_p of the piston and lift y_p of the valve, both along the direction of the clearance.

    It is the cylinder's axis for a flat crown, x_p = x, y_p = y_v cos ν, and the valve's for a pocket, x_p = x cos ν, y_p = y_v.

    Parameters
    ----------
    study : Study

    Returns
    -------
    travel, lift : ndarray (n,) [m]
    """
    valve = _parts(study)[1]
    travel, lift, slope = piston_travel(study), valve_lift(study), np.cos(si(valve).angle)
    return (travel * slope, lift) if valve.pocket == PARALLEL else (travel, lift * slope)


def piston_clearance(study: Study) -> np.ndarray:
    """Clearance between valve and piston, c = c_0 + x_p - y_p, c_0 that of the closed valve at TDC.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,) [m]
    """
    travel, lift = clearance_parts(study)
    return si(_parts(study)[1]).clearance + travel - lift
