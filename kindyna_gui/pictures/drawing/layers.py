"""What a drawing of a mechanism can show and hide."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from core.frozen import frozen
from core.study import Study
from kindyna_gui.requirements import lists_links


@frozen
class Layer:
    """One row of what can be shown: its name for the user, and whether it is shown at first."""

    label: str
    shown: bool = True


DIMENSIONS, TWIST, MODULO = "dimensions", "twist", "modulo"

LAYERS: Mapping[str, Layer] = MappingProxyType(
    {
        "ground": Layer("Ground"),
        "guide": Layer("Guide"),
        "cam": Layer("Cam"),
        "pitch": Layer("Pitch curve"),
        "base": Layer("Base circle"),
        "roller": Layer("Roller"),
        "linkage": Layer("Linkage"),
        "normal": Layer("Contact normal"),
        "centre": Layer("Instant centre"),
        "loads": Layer("Springs and loads"),
        "masses": Layer("Centres of mass", shown=False),
        "velocities": Layer("Velocities", shown=False),
        "forces": Layer("Forces", shown=False),
        "inertia": Layer("Weight and inertia forces", shown=False),
        "pressure_colours": Layer("Profile coloured by pressure angle", shown=False),
        "curvature_colours": Layer("Profile coloured by curvature", shown=False),
        "stress_colours": Layer("Profile coloured by contact pressure", shown=False),
        TWIST: Layer("Flexible shaft and its twist", shown=False),
        DIMENSIONS: Layer("Dimensions", shown=False),
        MODULO: Layer("Position modulo the advance", shown=False),
        "labels": Layer("Labels"),
        "scale": Layer("Scale bar"),
    }
)

GHOSTS: Mapping[str, int] = MappingProxyType({f"poses{n}": n for n in (10, 15, 30, 45, 90)})
"""Layers of ghost poses, with the degrees from one to the next."""

LINKAGE_LAYERS: Mapping[str, Layer] = MappingProxyType(
    {
        "centres": Layer("Instant centres of all links", shown=False),
        "kennedy": Layer("Kennedy's construction", shown=False),
        "ratios": Layer("Velocity ratios to the driver", shown=False),
        "chain": Layer("Velocity ratios from link to link", shown=False),
        "coupler": Layer("Coupler curves", shown=False),
        **{name: Layer(f"Ghost poses every {n}°", shown=False) for name, n in GHOSTS.items()},
    }
)
"""What the drawing of a general linkage can show besides."""

OF_STEP = ("centres", "kennedy")
"""Layers that a step of the circle diagram needs."""

COLOURS = ("pressure_colours", "curvature_colours", "stress_colours")
"""Layers of which one at most is shown at a time."""

OF_BODIES = ("forces", "inertia")
"""Layers of the forces on the bodies."""

OF_FORCES = (*OF_BODIES, "stress_colours")
"""Layers that follow from the forces."""

OF_LOADS = ("loads", "masses")
"""Layers that follow from the loads alone."""

_OF_CAMS = ("cam", "pitch", "base", "roller", "normal", "centre", *COLOURS)
EVERY_LAYER: Mapping[str, Layer] = MappingProxyType({**LAYERS, **LINKAGE_LAYERS})


def goes_on(study: Study) -> bool:
    """Whether the motion does not come back, so that each turn begins an advance further on."""
    motion = study.design.drive.motion
    return motion is not None and bool(motion.gain)


def layers_of(study: Study) -> tuple[str, ...]:
    """The layers that have something to show of this kind of design."""
    without = () if "cam" in study.stages else _OF_CAMS
    without = (
        *without,
        *(() if goes_on(study) else (MODULO,)),
        *(() if study.design.shaft is not None and study.design.shaft.elastic is not None else (TWIST,)),
    )
    rows = EVERY_LAYER if lists_links(study.design) else LAYERS
    return tuple(name for name in rows if name not in without)
