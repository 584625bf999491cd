"""Designs with outlines, as texts of files, and their clearances by brute force."""

import cmath
import math

import numpy as np

from core.process import resources
from core.project import loads
from core.study import Study


def example(name: str) -> str:
    """Text of an example."""
    return (resources() / "examples" / f"{name}.toml").read_text("utf-8")


def outline(of: str, **entries: object) -> str:
    """Table [[outlines]] of a body."""
    lines = [f'of = "{of}"']
    for key, value in entries.items():
        lines.append(f'{key} = "{value}"' if isinstance(value, str) else f"{key} = {value}")
    return "\n[[outlines]]\n" + "\n".join(lines) + "\n"


def clearance(first: str, second: str, least_mm: float) -> str:
    """Table [[clearances]] of two bodies."""
    return f'\n[[clearances]]\nbetween = ["{first}", "{second}"]\nleast_mm = {least_mm}\n'


def studied(text: str) -> Study:
    """Study of the design in a text."""
    return Study(loads(text))


def outlines_of(segments: list[tuple[complex, complex]], count: int) -> np.ndarray:
    """Points along segments (n,)."""
    part = np.linspace(0.0, 1.0, count)
    return np.concatenate([a + part * (b - a) for a, b in segments])


def slides(first_phase: float, second_phase: float, gap: float) -> str:
    """Two translating followers on one shaft that rise along the same line, the second mirrored to the other side of the centre."""
    drive = """
[[drives]]
name = "{name}"
phase_deg = {phase}

[drives.motion]
start_mm = 0.0

[[drives.motion.segments]]
law = "cycloidal"
span_deg = 120.0
rise_mm = 30.0

[[drives.motion.segments]]
law = "dwell"
span_deg = 60.0

[[drives.motion.segments]]
law = "cycloidal"
span_deg = 120.0
rise_mm = -30.0

[[drives.motion.segments]]
law = "dwell"
span_deg = 60.0

[drives.follower]
kind = "translating"
offset_mm = 0.0
direction_deg = 90.0

[drives.cam]
base_radius_mm = 50.0
roller_radius_mm = 10.0

[drives.loads]
follower_mass_kg = 1.0
spring_rate_n_per_mm = 1.0
preload_n = 100.0
"""
    text = 'format = 1\nname = "Slides"\n[shaft]\nrotation = "ccw"\nspeed_rpm = 60.0\n'
    text += drive.format(name="Left", phase=first_phase) + drive.format(name="Right", phase=second_phase)
    # the right one is hung a gap above the left one, where both rest at the bottom
    text += outline("follower", drive="left", points=[[-10.0, -5.0], [0.0, -5.0], [0.0, 5.0], [-10.0, 5.0]])
    return text + outline(
        "follower", drive="right", points=[[gap, -5.0], [gap + 10.0, -5.0], [gap + 10.0, 5.0], [gap, 5.0]]
    )


def rise(theta: np.ndarray) -> np.ndarray:
    """Motion of a slide of ``slides`` at cam angles (n,) [deg], in mm."""
    theta = theta % 360.0
    up = np.clip(theta / 120.0, 0.0, 1.0)
    down = np.clip((theta - 180.0) / 120.0, 0.0, 1.0)
    law = lambda u: u - np.sin(2.0 * np.pi * u) / (2.0 * np.pi)  # noqa: E731
    return 30.0 * (law(up) - law(down))


def four_bar_points(theta: float) -> tuple[complex, complex, complex]:
    """Pins A and B, and the angle of the coupler as e^{iφ}, of the example four_bar [mm]: circles about both known pins."""
    a = cmath.rect(30.0, theta)
    to = 100.0 - a
    d = abs(to)
    along = (d * d + 90.0**2 - 70.0**2) / (2.0 * d)
    b = a + to / d * complex(along, math.sqrt(90.0**2 - along**2))
    return a, b, (b - a) / 90.0
