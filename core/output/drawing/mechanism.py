"""A mechanism at one angle as layers of lines and circles: links and pins, blocks on guides, cam and follower's face."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from core.cam import OUTER, SECOND
from core.design import FRAME_LINK
from core.mechanism.kinematics import FRAME
from core.output.drawing.layers import WRITERS, Layers, LayerShapes
from core.output.drawing.scene import MM, Scene
from core.study import Study

Line = tuple[np.ndarray, bool]

PIN = 0.012  # radius of a pin, relative to the size
_BLOCK = 0.035  # half the length of a block, relative to the size
_BLOCK_CORNERS = np.array([-1.0 - 0.6j, 1.0 - 0.6j, 1.0 + 0.6j, -1.0 + 0.6j])
_GUIDE = np.array([-4.0, 4.0])  # ends of a guide, by half the length of its block
PROFILES: Mapping[str, str] = {OUTER: "PROFILE_OUTER", SECOND: "PROFILE_SECOND"}
"""Flank -> layer of its profile, of flanks other than the first; layers as in files of a profile."""


def mechanism_size(study: Study) -> float:
    """Length characteristic of the mechanism's size [mm]."""
    size = study.driver_ranges.plan.size if study.mechanism.ranged else study.reach
    return float(size) * MM


def pose_layers(full: Study, study: Study) -> dict[str, LayerShapes]:
    """Layers of a mechanism at the first angle of a study: cam, lines between the points of each link, pins, blocks on guides.

    Parameters
    ----------
    full : Study
        Study of the same design over the turn, with the profile of the cam.
    study : Study
        The position.
    """
    scene, size = Scene(study), mechanism_size(full)
    layers: dict[str, LayerShapes] = {}
    blocks, guides = block_lines(scene, _BLOCK * size)
    for layer, name, paths in drawn_bodies(scene):
        z = np.array([complex(path[0]) for path in paths])
        lines = [(z, z.size > 2)] if z.size > 1 and name != FRAME else []
        pins = tuple((complex(p), PIN * size) for p in z)
        shapes = LayerShapes((*lines, *blocks.get(name, ()), *guides.get(name, ())), pins)
        if shapes.lines or shapes.circles:
            layers[layer] = shapes
    return {**layers, **(dict(_cam_layers(Scene(full), scene, PIN * size)) if scene.has_cam else {})}


def drawn_bodies(scene: Scene) -> Iterator[tuple[str, str, list[np.ndarray]]]:
    """Bodies with their points, the frame first.

    Returns
    -------
    iterator of str, str and list of ndarray (n,) complex [mm]
        Layer, ``LINK_3`` or the name of a follower's body; name of the body; paths of its points.
    """
    study = scene.study
    numbered = bool(study.design.drive.links)
    for number, name in sorted({FRAME_LINK: FRAME, **study.mechanism.bodies}.items()):
        layer = f"LINK_{number}" if numbered else name.upper()
        body = scene.bodies.get(name)
        if body is None:  # the frame of a follower
            yield layer, name, [np.full(scene.theta.size, at) for at in scene.pivots.values()]
        else:
            yield layer, name, [body.track(point) for point in study.mechanism.linkage.by_number[number].places]


def block_lines(scene: Scene, half: float) -> tuple[dict[str, list[Line]], dict[str, list[Line]]]:
    """Blocks of sliding pairs and their guides by body; the length of a block is twice ``half`` [mm]."""
    blocks: dict[str, list[Line]] = {}
    guides: dict[str, list[Line]] = {}
    for slide in scene.slides:
        at, line = complex(slide.z[0]), complex(slide.line[0])
        blocks.setdefault(slide.body, []).append((at + half * _BLOCK_CORNERS * line, True))
        guides.setdefault(slide.on, []).append((at + half * _GUIDE * line, False))
    return blocks, guides


def _cam_layers(full: Scene, scene: Scene, shaft: float) -> Iterator[tuple[str, LayerShapes]]:
    """Layers of the camshaft's centre, of the cam at the first angle of a scene, and of the follower's face."""
    yield "CAMSHAFT", LayerShapes((), ((0j, shaft),))
    turn = np.exp(1j * scene.cam_angle[0])
    for flank, profile in full.flanks.items():
        yield PROFILES.get(flank, "PROFILE"), LayerShapes(((profile * turn, True),))
    if full.pitch.size:
        yield "PITCH", LayerShapes(((full.pitch * turn, True),))
    for name, radius in full.circles.items():
        yield name.upper(), LayerShapes((), ((0j, radius),))
    if full.keyway:
        yield "KEYWAY", LayerShapes(((np.array(full.keyway) * turn, False),))
    if (face := face_shapes(full, scene)) is not None:
        yield "FACE", face


def face_shapes(full: Scene, scene: Scene) -> LayerShapes | None:
    """The follower's face and the rollers on other flanks at the first angle of a scene; None without a cam."""
    face, body = full.face, scene.face_body
    if face is None:
        return None
    circles = [(complex(z[0]), radius) for radius, z in scene.further_rollers]
    if face.rolls and face.radius:
        return LayerShapes((), ((complex(body.z[0]), face.radius), *circles))
    return LayerShapes(((body.placed(face.outline), True),), tuple(circles))


def repeated_pose_layers(study: Study, every_deg: float) -> dict[str, LayerShapes]:
    """A layer with the lines of all links at equal steps of the turn [deg], where the mechanism can be assembled."""
    angles = np.deg2rad(np.arange(0.0, 360.0, every_deg))
    posed = study.at_theta(angles[study.uncut.is_assembled(angles)] if study.by_crank else angles)
    lines = [
        (z, z.size > 2)
        for _, name, paths in drawn_bodies(Scene(posed))
        if name != FRAME and len(paths) > 1
        for z in np.array(paths).T
    ]
    return {"GHOSTS": LayerShapes(tuple(lines))}


def pose_file(study: Study, theta: float, ending: str, added: Layers | None = None) -> bytes:
    """Mechanism at an angle [rad] of the driver or the cam, and more layers, in a format of ``WRITERS``."""
    layers = {**pose_layers(study, study.at_theta(np.array([theta]))), **(added or {})}
    return WRITERS[ending]((f"{study.design.name} at {np.rad2deg(theta):g} deg, mm",), layers)
