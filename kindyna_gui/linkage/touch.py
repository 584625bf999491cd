"""What of the drawn machine lies under the mouse: the field that it stands for, what can be done with it, and what answers while it is
drawn elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QPolygonF
from PySide6.QtWidgets import QApplication

from core.design import Design, entries, get, split_unit
from core.errors import NoAnswer
from core.find import offered, varied
from core.followers.dragging import joints_of
from core.frozen import frozen
from core.study import Study
from kindyna_gui.labels import name_of
from kindyna_gui.linkage.canvas import Canvas
from kindyna_gui.linkage.load_places import rows_at
from kindyna_gui.linkage.picking import Picker
from kindyna_gui.pictures.drawing.geometry import Geometry
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.plots.curves import limits_on
from kindyna_gui.pictures.plots.quantities import rows_of
from kindyna_gui.pictures.units import digits, measure, with_unit
from kindyna_gui.saving import copy_picture
from kindyna_gui.view import NumberAtHand, View, ViewHost

Answer = tuple[str, bool]
"""A line beside the mouse, and whether it says that a limit is passed."""


@frozen
class Thing:
    """What lies under the mouse.

    noun     for the reader: ``Roller``
    path     of the field that a click opens
    explain  the channel whose value here is explained; empty: none
    """

    noun: str
    path: str
    explain: str = ""


# -- what lies where ------------------------------------------------------------------------------------------

LINKS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "arm": ("follower.slider_arm_mm", "follower.arm_mm", "follower.face_offset_mm"),
        "rod": ("follower.rod_mm",),
        "slider": ("follower.guide_height_mm",),
        "follower": ("follower.offset_mm",),
    }
)
"""Body of a follower -> the fields that say how large it is, the first that a design has."""


def thing_at(canvas: Canvas, scene: MechanismScene, picker: Picker, at: complex) -> Thing | None:
    """The uppermost thing at a place [mm], with its field; None on the bare sheet."""
    geometry = scene.geometry
    if geometry is None:
        return None
    return next((found for look in LOOKS if (found := look(canvas, scene, picker, at, geometry)) is not None), None)


def _pin(canvas: Canvas, scene: MechanismScene, picker: Picker, at: complex, geometry: Geometry) -> Thing | None:
    name = canvas.joint_at(canvas.viewportTransform().map(QPointF(at.real, at.imag)), rims=False)
    drag = joints_of(geometry.study.design).get(name)
    return None if drag is None else Thing(drag.label[:1].upper() + drag.label[1:], drag.field, "pressure_angle")


def _load(canvas: Canvas, scene: MechanismScene, picker: Picker, at: complex, geometry: Geometry) -> Thing | None:
    rows = [row for row in rows_at(canvas, at) if row]
    return Thing(name_of(geometry.study.design, rows[0]), rows[0]) if rows else None


def _face(canvas: Canvas, scene: MechanismScene, picker: Picker, at: complex, geometry: Geometry) -> Thing | None:
    inside = abs(at - complex(geometry.reference[scene.index])) <= geometry.face_radius
    if not inside or geometry.face_radius == 0.0:
        return None
    noun = geometry.study.design.drive.face.noun
    return Thing(noun[:1].upper() + noun[1:], geometry.face_path, "contact_force")


def _link(canvas: Canvas, scene: MechanismScene, picker: Picker, at: complex, geometry: Geometry) -> Thing | None:
    name = picker.face_at(geometry, geometry.moving, at)
    if name is None:
        return None
    design = geometry.study.design
    number = next((n for n, body in geometry.study.mechanism.bodies.items() if body == name), 0)
    typed = [
        row.path for section in ("follower", "linkage") if section in design.tables for row in entries(design, section)
    ]
    links = design.drive.linkage.links if design.drive.links else ()
    own = [f"linkage.links[{i}].points" for i, link in enumerate(links) if link.number == number]
    path = next((path for path in LINKS.get(name, ()) if path in typed), "")
    path = path or next(
        (path for path in typed if own and path.startswith(own[0])), "follower" if not links else "linkage"
    )
    return Thing(f"Link {number}" if links else name[:1].upper() + name[1:], path)


def _cam(canvas: Canvas, scene: MechanismScene, picker: Picker, at: complex, geometry: Geometry) -> Thing | None:
    if not geometry.profile.size:
        return None
    own = at * np.exp(-1j * np.deg2rad(geometry.turned[scene.index]))
    outline = QPolygonF([QPointF(p.real, p.imag) for p in geometry.profile])
    if not outline.containsPoint(QPointF(own.real, own.imag), Qt.FillRule.OddEvenFill):
        return None
    sized = hasattr(geometry.study.design.drive.cam, "base_radius_mm")
    return Thing("Cam", "cam.base_radius_mm" if sized else "cam", "pitch_curvature")


LOOKS = (_pin, _load, _face, _link, _cam)
"""What may lie under the mouse, the uppermost first."""


# -- what can be done with it -----------------------------------------------------------------------------------


def value_text(design: Design, path: str) -> str:
    """The value of a field with its unit; empty where the path leads to no number."""
    try:
        value = get(design, path)
    except KeyError:
        return ""
    return with_unit(f"{value:.10g}", split_unit(path)[1].symbol) if isinstance(value, float | int) else ""


def search_for(design: Design, path: str) -> str:
    """What Find seeks that varies this field; empty where nothing does."""
    return next((what for what in offered(design) if varied(design, what) == (path,)), "")


Deed = tuple[str, Callable[[], Any]]


def deeds(thing: Thing | None, view: View, host: ViewHost) -> Iterator[Deed]:
    """The entries of the context menu over a thing, and on the bare sheet: text and what it does."""
    session = view.session
    if thing is not None:
        design, path = session.design, thing.path
        name, value = name_of(design, path), value_text(design, path)
        yield f"Edit {name}", lambda: host.focus_field(path)
        if what := search_for(design, path):
            yield f"Find {name}...", lambda: host.show_search(what)
        if value:
            yield f"Vary {name}", lambda: session.vary(path)
        if thing.explain and rows_of(session.study, (thing.explain,)):
            label = rows_of(session.study, (thing.explain,))[0].label
            yield f"Explain {label[:1].lower()}{label[1:]} here", lambda: host.explain(NumberAtHand(thing.explain))
        if value:
            yield f"Copy {value}", lambda: QApplication.clipboard().setText(value)
    yield "Copy picture", lambda: copy_picture(view)
    yield "Fit", view.fit


# -- what answers while it is drawn elsewhere -------------------------------------------------------------------


def answers(study: Study, path: str, stages: tuple[str, ...]) -> list[Answer]:
    """The value that the mouse changes, and below it what answers: pressure angle and undercut, and of forces what is on the screen
    anyway (``stages``); each with the limit that it is held against."""
    lines: list[Answer] = [(f"{name_of(study.design, path)} {value_text(study.design, path)}", False)]
    for row in rows_of(study, ("pressure_angle", "pitch_curvature", "drive_torque", "contact_force")):
        if row.stage not in ("cam", *stages):
            continue
        try:
            values = row.values(study)
            limits = [limit.value / row.unit.factor for limit in limits_on(study, row.name)]
        except NoAnswer:
            continue
        lines.append(
            _radius(values * row.unit.factor, [limit * row.unit.factor for limit in limits])
            if row.name == "pitch_curvature"
            else _peak(row, values, limits)
        )
    return lines


def _peak(row: Any, values: np.ndarray, limits: list[float]) -> Answer:
    """A force is held against the least that is wanted, all else against the most."""
    low = row.name == "contact_force"
    top = float(values.min() if low else values[np.argmax(np.abs(values))])
    held = (max if low else min)(limits, default=None)
    passed = held is not None and (top < held if low else abs(top) > held)
    text = f"{row.label} {'least ' if low else ''}{measure(top, row.unit.symbol)}"
    return (text if held is None else f"{text}, limit {measure(held, row.unit.symbol)}"), passed


def _radius(values: np.ndarray, limits: list[float]) -> Answer:
    """The least radius of the pitch curve against that from which on it is undercut [1/m]."""
    top = float(values.max())
    if not limits or top <= 0.0:
        return "No undercut", False
    text = f"Pitch radius {digits(1e3 / top)} mm, undercut below {digits(1e3 / min(limits))} mm"
    return text, top >= min(limits)


__all__ = ["Thing", "answers", "deeds", "thing_at"]
