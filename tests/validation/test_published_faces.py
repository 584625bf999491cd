"""Flat-faced cams of textbooks, in inches as printed."""

import math

import numpy as np
import pytest
from mechanisms import levels

from core.design import Design, DiskCam, Drive, Shaft, TiltedFlat, Translating, TranslatingLoads
from core.study import Study, extremes_of

INCH = 25.4


def tappet(base: float, offset: float, *steps: tuple[float, float, str]) -> Study:
    """A flat-faced translating follower; base radius, offset and levels in inches."""
    motion = levels(0.0, *((span, INCH * level, law) for span, level, law in steps))
    follower = Translating(face=TiltedFlat(), offset_mm=INCH * offset)
    return Study(
        Design("printed", Shaft("ccw", 60.0), (Drive(motion, follower, DiskCam(INCH * base), TranslatingLoads()),))
    )


def test_harmonic_up_and_down_has_one_radius_of_curvature() -> None:
    """Offset 0.75 in, 2 in stroke, base radius 1.5 in, simple harmonic up and down in 180° each: ρ = 2.5 in throughout."""
    study = tappet(1.5, 0.75, (180.0, 2.0, "simple-harmonic"), (180.0, 0.0, "simple-harmonic"))
    flank = study.cam.flank
    assert np.abs(flank.profile_radius / (2.5e-3 * INCH) - 1.0).max() <= 1e-12
    assert np.abs(flank.profile_curvature * 2.5e-3 * INCH - 1.0).max() <= 1e-12
    assert extremes_of(study, "cam")["pressure_angle"].high.value == 0.0


def test_cycloidal_in_a_quarter_turn_needs_a_face_of_printed_width() -> None:
    """Base radius 1.893 in, cycloidal 1 in up and down in 90° each, dwells of 90° between: least face width 2.546 in, printed
    2.55."""
    steps = ((90.0, 1.0, "cycloidal"), (90.0, 1.0, "dwell"), (90.0, 0.0, "cycloidal"), (90.0, 0.0, "dwell"))
    place = extremes_of(tappet(1.893, 0.0, *steps), "cam")["contact_on_face"]
    width = (place.high.value - place.low.value) / (1e-3 * INCH)
    assert width == pytest.approx(2.0 * 2.0 / (math.pi / 2.0), rel=1e-12)
    assert round(width, 3) == 2.546
    assert width == pytest.approx(2.55, abs=0.005)
