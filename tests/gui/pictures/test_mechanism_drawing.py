"""The drawing of a mechanism: everything stands where the kinematics says, moves without being made anew, and is legible."""

from dataclasses import replace
from itertools import pairwise
from math import pi
from types import SimpleNamespace

import numpy as np
import pytest
from mechanisms import LIFT, PUSHER, with_cam, with_drive, with_follower, with_loads, with_shaft
from plot_reading import box_in_mm
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QFontMetricsF
from PySide6.QtWidgets import QApplication, QGraphicsLineItem
from sampled import spread, stressed

from core.design import Design, Motion, Translating, edited
from core.dynamics import Loading
from core.errors import NoSolution
from core.instant_centres import Centres
from core.mechanism.kinematics import FRAME, REVOLUTE, SLIDING, Kinematics, Pair, Pose
from core.motion import Angles, MotionState
from core.numerics.derivatives import Derivatives
from core.project import load
from core.study import Study
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.drawing.parts import LAYERS
from kindyna_gui.pictures.items import Tag
from kindyna_gui.pictures.painter import MechanismSheet, png
from kindyna_gui.pictures.style import DARK, LIGHT, font
from kindyna_gui.places import example

pytestmark = pytest.mark.usefixtures("app")

SAMPLES = 360
INDICES = (0, 1, 50, 58, 121, 180, 299, 304, 359)


def mirrored(design: Design) -> Design:
    """The lift seen from behind: layout c, everything the other way round."""
    motion, follower = design.drive.motion, design.drive.mechanism
    segments = tuple(replace(s, rise=-s.rise) for s in motion.segments)
    turned = replace(follower, layout="c", pivot_x_mm=-follower.pivot_x_mm, fixed_angle_deg=-follower.fixed_angle_deg)
    return with_shaft(with_drive(design, motion=Motion(-motion.start, segments), mechanism=turned), rotation="cw")


def sized(design: Design, factor: float) -> Design:
    """Every length times the factor."""

    def part(old: object) -> object:
        return replace(old, **{k: v * factor for k, v in vars(old).items() if k.endswith("_mm") and v is not None})  # type: ignore[type-var]

    drive = design.drive
    segments = tuple(replace(s, rise=s.rise * factor) for s in drive.motion.segments)
    motion = Motion(drive.motion.start * factor, segments)
    return with_drive(design, motion=motion, mechanism=part(drive.mechanism), cam=part(drive.cam))


DESIGNS = {
    "lift": LIFT,
    "lift cw": with_shaft(LIFT, rotation="cw"),
    "lift mirrored": mirrored(LIFT),
    "pusher": PUSHER,
    "pusher cw": with_shaft(PUSHER, rotation="cw"),
    "pusher downwards": with_follower(PUSHER, direction_deg=-90.0, offset_mm=-15.0),
    "lift of a millimetre": sized(LIFT, 1e-3),
    "lift of a kilometre": sized(LIFT, 1e3),
}
designs = pytest.mark.parametrize("design", DESIGNS.values(), ids=DESIGNS)


def scene_of(design: Design, samples: int = SAMPLES) -> MechanismScene:
    return MechanismScene(Study(design, samples))


def place(point: QPointF) -> complex:
    return complex(point.x(), point.y())


# -- places -----------------------------------------------------------------------------------------------


@designs
def test_every_point_of_every_body_is_drawn_where_the_kinematics_has_it(design: Design) -> None:
    scene, kinematics = scene_of(design), Study(design, SAMPLES).linkage
    size = abs(scene.fit_rect().width())
    found = 0
    for i in INDICES:
        scene.set_index(i)
        for key, part in scene.parts.items():
            kind, _, name = key.partition(".")
            if kind in ("body", "block", "stem"):
                body = name if kind == "body" else kinematics.pairs[name].body
                for point, local in kinematics.bodies[body].points.items():
                    there = place(part.item.mapToScene(QPointF(local.real * 1e3, local.imag * 1e3)))
                    assert there == pytest.approx(
                        complex(kinematics.bodies[body].point(point)[0][i]) * 1e3, abs=1e-12 * size
                    )
                    found += 1
            if kind == "pin":
                pair = kinematics.pairs[name]
                there = complex(kinematics.bodies[pair.body].point(pair.point)[0][i]) * 1e3
                assert place(part.item.pos()) == pytest.approx(there, abs=1e-12 * size)
                found += 1
    assert found >= len(INDICES) * len(kinematics.pairs)


@designs
def test_the_turned_cam_touches_the_roller_at_every_cam_angle(design: Design) -> None:
    scene, study = scene_of(design), Study(design, SAMPLES)
    profile, radius = study.cam.flank.profile * 1e3, design.drive.cam.roller_radius_mm
    cam, roller, dot = (scene.item(key) for key in ("cam", "roller", "contact"))
    for i in range(SAMPLES):
        scene.set_index(i)
        touch = place(cam.mapToScene(QPointF(profile[i].real, profile[i].imag)))
        assert abs(abs(touch - place(roller.pos())) / radius - 1.0) < 1e-9
        assert abs(place(dot.pos()) - touch) < 1e-9 * radius


@designs
def test_the_normal_runs_from_the_contact_through_the_roller_centre_to_the_instant_centre(design: Design) -> None:
    scene, study = scene_of(design), Study(design, SAMPLES)
    line = scene.item("normal")
    assert isinstance(line, QGraphicsLineItem)
    for i in INDICES:
        scene.set_index(i)
        start, end = place(line.line().p1()), place(line.line().p2())
        centre = complex(study.cam.centre.finite[i]) * 1e3
        contact = place(scene.item("contact").pos())
        assert place(scene.item("centre").pos()) == pytest.approx(centre, rel=1e-12, abs=1e-9 * abs(end - start))
        for point in (contact, place(scene.item("roller").pos()), centre):
            share = (point - start) / (end - start)
            assert abs(share.imag) < 1e-9
            assert -1e-9 < share.real < 1.0 + 1e-9


def test_an_instant_centre_at_infinity_leaves_a_line_across_the_picture() -> None:
    study = Study(LIFT, SAMPLES)
    weight = study.cam.centre.weight.copy()
    weight[7] = 0.0
    flank = replace(study.cam.flank, centre=Centres(study.cam.centre.point, weight))
    cam = replace(study.cam, flanks=(flank,))
    parts = {
        "linkage": study.linkage,
        "design": LIFT,
        "theta": study.theta,
        "omega": study.omega,
        "stages": study.stages,
        "has_disk": study.has_disk,
        "has_surface": False,
        "sense": study.sense,
        "loading": study.loading,
    }
    scene = MechanismScene(SimpleNamespace(cam=cam, **parts))  # type: ignore[arg-type]
    scene.set_index(7)
    line = scene.item("normal").line()  # type: ignore[attr-defined]
    assert line.length() > 2.0 * scene.fit_rect().width()
    assert scene.item("centre").opacity() == 0.0
    scene.set_index(8)
    assert scene.item("centre").opacity() == 1.0


# -- motion -----------------------------------------------------------------------------------------------


def test_nothing_is_made_anew_in_motion() -> None:
    scene = scene_of(LIFT)
    for layer in LAYERS:
        scene.set_layer(layer, True)
    before = list(scene.items())
    for i in range(0, SAMPLES, 7):
        scene.set_index(i)
    after = list(scene.items())
    assert len(before) == len(after)
    assert all(one is other for one, other in zip(before, after, strict=True))


def test_index_fraction_and_angle_say_the_same() -> None:
    scene = scene_of(LIFT)
    scene.set_fraction(0.25)
    assert scene.index == 90
    scene.set_angle(pi)
    assert scene.index == 180
    scene.set_index(SAMPLES + 3)
    assert scene.index == 3
    scene.set_angle(2.0 * pi)
    assert scene.index == 0
    scene.set_index(58)
    assert scene.overlay is not None
    assert scene.overlay.text == "Cam angle 58.0°"


def test_another_study_keeps_angle_and_layers() -> None:
    scene = scene_of(LIFT, 360)
    scene.set_layer("labels", False)
    scene.set_layer("velocities", True)
    scene.set_index(90)
    scene.update_study(Study(PUSHER, 720))
    assert scene.index == 180
    assert not scene.item("label.cam").isVisible()
    assert scene.item("velocities.follower.roller").isVisible()


def test_another_speed_moves_nothing_but_the_arrows() -> None:
    scene = scene_of(LIFT)
    scene.set_layer("velocities", True)
    scene.set_index(58)
    before = {key: part.item for key, part in scene.parts.items()}
    assert scene.overlay is not None
    told = scene.overlay.vectors["velocities"].text
    scene.update_study(Study(with_shaft(LIFT, speed_rpm=55.0), SAMPLES), keep_labels=True)
    moved = {key for key, part in scene.parts.items() if part.item is not before[key]}
    assert moved == {key for key in scene.parts if key.startswith("velocities.")}
    assert scene.overlay.vectors["velocities"].text != told
    assert scene.index == 58
    scene.update_study(Study(with_cam(LIFT, base_radius_mm=410.0), SAMPLES), keep_labels=True)
    assert scene.item("cam") is not before["cam"]
    assert scene.item("label.cam") is before["label.cam"], "labels are told elsewhere, not made anew"


def test_what_is_drawn_after_edits_is_what_a_fresh_drawing_shows() -> None:
    """However many items are kept on the way: speed, cam, another kind of follower, loads, and back."""
    designs = (
        LIFT,
        with_shaft(LIFT, speed_rpm=55.0),
        with_cam(LIFT, base_radius_mm=420.0),
        PUSHER,
        with_loads(PUSHER, friction=0.3),
        LIFT,
    )
    changed = MechanismScene()
    for layer in ("velocities", "forces"):
        changed.set_layer(layer, True)
    for design in designs:
        study = Study(design, SAMPLES)
        changed.update_study(study, keep_labels=True)
        fresh = MechanismScene()
        for layer in ("velocities", "forces"):
            fresh.set_layer(layer, True)
        fresh.update_study(study)
        shown = []
        for scene in (changed, fresh):
            scene.set_index(304)
            shown.append(image(MechanismSheet(scene, 480, 400)))
        assert (shown[0] == shown[1]).all(), design.name


def test_a_label_that_was_out_of_reach_comes_back() -> None:
    study = Study(LIFT, SAMPLES)
    weight = study.cam.centre.weight.copy()
    weight[7] = 0.0
    flank = replace(study.cam.flank, centre=Centres(study.cam.centre.point, weight))
    cam = replace(study.cam, flanks=(flank,))
    parts = {
        "linkage": study.linkage,
        "design": LIFT,
        "theta": study.theta,
        "omega": study.omega,
        "stages": study.stages,
        "has_disk": study.has_disk,
        "has_surface": False,
        "sense": study.sense,
        "loading": study.loading,
    }
    scene = MechanismScene(SimpleNamespace(cam=cam, **parts))  # type: ignore[arg-type]
    scene.set_index(7)
    assert scene.item("label.centre").opacity() == 0.0
    scene.update_study(study, keep_labels=True)
    assert scene.item("label.centre").opacity() == 1.0


def test_a_study_without_position_is_refused_and_the_old_drawing_stays() -> None:
    scene = scene_of(LIFT)
    parts = dict(scene.parts)
    with pytest.raises(NoSolution):
        scene.update_study(Study(with_follower(LIFT, rod_mm=1.0), SAMPLES))
    assert scene.parts == parts


@pytest.mark.stress
def test_a_linkage_without_cam_is_still_drawn() -> None:
    motion = replace(LIFT.drive.motion, start=0.0)
    design = with_cam(with_drive(LIFT, motion=motion), base_radius_mm=0.5, roller_radius_mm=549.5)
    with pytest.raises(NoSolution):
        _ = Study(design, SAMPLES).cam
    scene = scene_of(design)
    for layer in LAYERS:
        scene.set_layer(layer, True)
    assert "body.arm" in scene.parts
    assert "cam" not in scene.parts
    assert png(MechanismSheet(scene, 300, 200), 1.0)


# -- layers -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("layer", spread([name for name in LAYERS if name not in ("scale", "modulo", "outlines")], 6))
def test_each_layer_is_shown_and_hidden(layer: str) -> None:
    design = LIFT
    for path, value in {"cam.thickness_mm": 80.0, "cam.material": "16mncr5", "cam.roller_material": "100cr6"}.items():
        design = edited(design, path, value)  # else no contact pressure colours it
    scene = scene_of(design)
    assert scene.layer_shown(layer) is LAYERS[layer].shown
    scene.set_layer(layer, True)
    keys = [key for key, part in scene.parts.items() if layer in part.layers]
    assert keys
    assert all(scene.item(key).isVisible() for key in keys)
    scene.set_layer(layer, False)
    assert not any(scene.item(key).isVisible() for key in keys)


def test_the_scale_bar_is_shown_and_hidden() -> None:
    scene = scene_of(LIFT)
    assert scene.overlay is not None
    assert scene.overlay.bar.isVisible()
    scene.set_layer("scale", False)
    assert not scene.overlay.bar.isVisible()


def test_hub_and_bore_are_drawn_where_they_are_known() -> None:
    scene = scene_of(PUSHER)
    assert not {"hub", "bore"} & set(scene.parts)
    cam = replace(PUSHER.drive.cam, hub_mm=24.0, bore_mm=10.0)
    scene.update_study(Study(with_drive(PUSHER, cam=cam), SAMPLES))
    assert [scene.item(name).boundingRect().width() for name in ("hub", "bore")] == pytest.approx([24.0, 10.0])
    keyed = replace(cam, keyway_width_mm=3.0, keyway_depth_mm=1.5, keyway_angle_deg=90.0)
    scene.update_study(Study(with_drive(PUSHER, cam=keyed), SAMPLES))
    box = scene.item("bore").boundingRect()
    assert (box.width(), box.top(), box.bottom()) == pytest.approx((10.0, -5.0, 6.5), abs=1e-2), "it turns with the cam"


# -- vectors ----------------------------------------------------------------------------------------------


def test_arrows_are_the_velocities_to_one_scale() -> None:
    scene, study = scene_of(LIFT), Study(LIFT, SAMPLES)
    scene.set_layer("velocities", True)
    scene.set_index(58)
    assert scene.overlay is not None
    points = {
        "arm.arm_pin": ("arm", "arm_pin"),
        "slider.slider_pin": ("slider", "slider_pin"),
        "roller": ("roller", "roller"),
    }
    scales = []
    for body, point in points.values():
        z = study.linkage.bodies[body].point(point)
        keys = [k for k in scene.parts if k.startswith("velocities.") and k.endswith(point)]
        path = scene.item(keys[0]).path()  # type: ignore[attr-defined]
        start = complex(path.elementAt(0).x, path.elementAt(0).y)
        tip = complex(path.elementAt(3).x, path.elementAt(3).y)
        assert start == pytest.approx(complex(z[0][58]) * 1e3, rel=1e-12)
        scales.append((tip - start) / complex(z[1][58] * study.omega))
    assert scales == pytest.approx([scales[0].real] * 3, rel=1e-9)
    assert "velocities.arm.pivot" not in scene.parts


def test_the_instant_centre_has_its_arrow_from_which_that_of_the_roller_follows() -> None:
    """Shin1995 (15)-(17): V_Q = Q θ̇ across the line to the cam centre, V_R = V_Q Zl/(Zxy - Q), by the arrows' own lengths."""
    scene = scene_of(LIFT)
    scene.set_layer("velocities", True)
    scene.set_index(58)

    def arrow(key: str) -> tuple[complex, complex]:
        path = scene.item(key).path()  # type: ignore[attr-defined]
        start, tip = (complex(path.elementAt(i).x, path.elementAt(i).y) for i in (0, 3))
        return start, tip - start

    (q, v_q), (_, v_r) = arrow("velocities.centre"), arrow("velocities.arm.roller")
    pivot = complex(873.746, -65.0)
    along = (q / (pivot / abs(pivot))).real
    assert (v_q / q).real == pytest.approx(0.0, abs=1e-9)
    assert (v_q / q).imag > 0.0, "with the cam, which turns counter-clockwise"
    assert abs(v_r) == pytest.approx(abs(abs(v_q) * 651.081 / (abs(pivot) - along)), rel=1e-9)


def test_the_force_on_the_slider_balances_in_the_drawing() -> None:
    """Contact on the roller and the pivot's force are drawn where they act, to one scale."""
    scene, study = scene_of(LIFT), Study(LIFT, SAMPLES)
    scene.set_layer("forces", True)
    scene.set_index(40)
    forces = study.dynamics

    def drawn(key: str) -> tuple[complex, complex]:
        path = scene.item(key).path()  # type: ignore[attr-defined]
        start, tip = path.elementAt(0), path.elementAt(3)
        return complex(start.x, start.y), complex(tip.x - start.x, tip.y - start.y)

    start, contact = drawn("forces.contact")
    assert start == pytest.approx(place(scene.item("contact").pos()), rel=1e-12)
    _, pivot = drawn("forces.pivot")
    assert contact / pivot == pytest.approx(
        complex(-forces.contact[40] * study.cam.flank.normal[40] / forces.pairs["pivot"][40]), rel=1e-9
    )


def test_infinite_forces_have_no_arrow() -> None:
    jammed = with_loads(with_follower(PUSHER, offset_mm=0.0), friction=6.0)
    study = Study(jammed, SAMPLES)
    infinite = np.flatnonzero(np.isinf(study.dynamics.contact))
    assert infinite.size
    scene = scene_of(jammed)
    scene.set_layer("forces", True)
    scene.set_index(int(infinite[0]))
    assert scene.item("forces.contact").path().isEmpty()  # type: ignore[attr-defined]
    scene.set_index(0)
    assert not scene.item("forces.contact").path().isEmpty()  # type: ignore[attr-defined]


# -- sight ------------------------------------------------------------------------------------------------


@designs
def test_the_frame_holds_the_whole_turn_and_never_moves(design: Design) -> None:
    scene, study = scene_of(design), Study(design, SAMPLES)
    rect = scene.fit_rect()
    for i in INDICES:
        scene.set_index(i)
        assert scene.fit_rect() == rect
        for body in study.linkage.bodies.values():
            for name in body.points:
                z = complex(body.point(name)[0][i]) * 1e3
                assert rect.contains(QPointF(z.real, z.imag))
        pitch = scene.item("pitch")
        box = pitch.mapToScene(pitch.path()).boundingRect()  # type: ignore[attr-defined]
        assert rect.contains(box)


@designs
def test_symbols_keep_their_size_whatever_the_size_of_the_mechanism(design: Design) -> None:
    scene = scene_of(design)
    assert scene.geometry is not None
    rect = scene.fit_rect()
    assert 60.0 < np.hypot(rect.width(), rect.height()) / scene.geometry.unit < 200.0


def test_a_mechanism_of_any_size_gives_the_same_picture() -> None:
    pictures = []
    for design in (LIFT, sized(LIFT, 1e-6), sized(LIFT, 1e3)):
        scene = scene_of(design)
        scene.set_layer("scale", False)
        scene.set_index(58)
        pictures.append(image(MechanismSheet(scene, 480, 360)))
    for other in pictures[1:]:
        assert np.mean(np.abs(other - pictures[0]).max(axis=2) > 40) < 2e-3


def image(sheet: MechanismSheet) -> np.ndarray:
    """What a PNG of one dot per pixel shows (height, width, 3)."""
    from io import BytesIO

    from PIL import Image

    with Image.open(BytesIO(png(sheet, 1.0))) as opened:
        return np.asarray(opened.convert("RGB")).astype(int)


def distance(box: QRectF, z: complex) -> float:
    x = max(box.left() - z.real, 0.0, z.real - box.right())
    y = max(box.top() - z.imag, 0.0, z.imag - box.bottom())
    return float(np.hypot(x, y))


@designs
@pytest.mark.parametrize("size", [stressed((1200, 900)), (640, 480), stressed((360, 300))])
def test_labels_cover_neither_the_part_they_name_nor_each_other_nor_the_edge(
    design: Design, size: tuple[int, int]
) -> None:
    scene = scene_of(design)
    reading = scene.geometry
    assert reading is not None
    visible, scale = scene.fit(*size)
    scene.show_region(visible, scale)
    parts = {key.removeprefix("label."): part.item for key, part in scene.parts.items() if key.startswith("label.")}
    assert {"cam", "roller"} <= set(parts)
    for i in INDICES:
        scene.set_index(i)
        boxes = {}
        for name, item in parts.items():
            assert isinstance(item, Tag)
            boxes[name] = box = box_in_mm(item, scale)
            assert visible.contains(box), name
        assert distance(boxes["roller"], complex(reading.reference[i])) > reading.face_radius
        turn = np.exp(1j * np.deg2rad(reading.cam_rotation[i]))
        assert min(distance(boxes["cam"], complex(z)) for z in reading.profile[::3] * turn) > 0.0
        assert distance(boxes["cam"], 0j) > reading.base_radius
        for name, body in reading.bodies.items():
            ends = [complex(body.track(p)[i]) for p in body.nodes.values()]
            if len(ends) > 1 and name in boxes:
                along = ends[0] + (ends[1] - ends[0]) * np.linspace(0.0, 1.0, 60)
                assert min(distance(boxes[name], complex(z)) for z in along) > 0.6 * reading.unit
        for joint in reading.joints:
            if f"pin.{joint.name}" in boxes:
                assert distance(boxes[f"pin.{joint.name}"], complex(joint.track[i])) > reading.unit
        if size[0] > 400:
            names = [n for n in boxes if n != "centre"]
            for k, one in enumerate(names):
                assert not any(boxes[one].intersects(boxes[other]) for other in names[k + 1 :]), one


LOW = (680, 380)  # as in a report


def test_the_followers_name_keeps_clear_of_its_stem_bush_and_spring() -> None:
    scene = MechanismScene(Study(load(example("transfer_unit")), SAMPLES).drives["Clamp"])
    visible, scale = scene.fit(*LOW)
    scene.show_region(visible, scale)
    label, reading = scene.item("label.follower"), scene.geometry
    assert isinstance(label, Tag)
    assert reading is not None
    (guide,) = (joint for joint in reading.joints if joint.pair.kind == SLIDING)
    rails = scene.item("rails.guide").sceneBoundingRect()
    for i in INDICES:
        scene.set_index(i)
        box = box_in_mm(label, scale)
        stem = complex(reading.reference[i]) + guide.outward_sign * guide.line * np.linspace(
            0.0, rails.bottom() - rails.top(), 60
        )
        assert min(distance(box, complex(z)) for z in stem) > reading.unit, i
        assert not rails.intersects(box), i


def test_names_in_a_picture_that_stands_still_suit_its_angle() -> None:
    """Of a four-bar, whose crank goes all round: over a turn no side of its pin is free of it."""
    study = Study(load(example("four_bar")), SAMPLES)
    scene = MechanismScene(study, LIGHT, still=True)
    reading = scene.geometry
    assert reading is not None
    for i in (45, 130, 220, 300):
        scene.set_index(i)
        visible, scale = scene.fit(*LOW)
        scene.show_region(visible, scale)
        for name in ("A", "B"):
            label = scene.item(f"label.pin.{name}")
            assert isinstance(label, Tag)
            box = box_in_mm(label, scale)
            for body in reading.moving.values():
                ends = [complex(body.track(p)[i]) for p in body.nodes.values()]
                for start, end in pairwise([*ends, ends[0]]):
                    along = start + (end - start) * np.linspace(0.0, 1.0, 60)
                    assert min(distance(box, complex(z)) for z in along) > 0.5 * reading.unit, (i, name, body.name)


@pytest.mark.parametrize(
    ("size", "texts"),
    [((900, 675), ["0", "250", "500 mm"]), ((320, 240), ["0", "500", "1000 mm"])],
)
def test_the_scale_bar_is_round(size: tuple[int, int], texts: list[str]) -> None:
    scene = scene_of(LIFT)
    visible, scale = scene.fit(*size)
    scene.show_region(visible, scale)
    assert scene.overlay is not None
    assert scene.overlay.bar.texts == texts
    width = scene.overlay.bar.childItems()[0].boundingRect().width()
    assert width == pytest.approx(float(texts[-1].split()[0]) * scale)


def test_scales_of_vectors_are_round_and_as_long_as_the_arrows() -> None:
    scene = scene_of(LIFT)
    scene.set_layer("velocities", True)
    scene.set_layer("forces", True)
    assert scene.overlay is not None
    assert [arrow.text for arrow in scene.overlay.vectors.values()] == ["velocity 0.5 m/s", "force 20 kN"]


@pytest.mark.parametrize("theme", [LIGHT, DARK], ids=["light", "dark"])
def test_every_letter_is_in_the_font(theme: object, app: QApplication) -> None:
    scene = MechanismScene(Study(LIFT, SAMPLES), theme)  # type: ignore[arg-type]
    metrics = QFontMetricsF(font(12))
    texts = [item.text for item in scene.items() if isinstance(item, Tag)]
    assert "Cam angle 0.0°" in texts
    assert all(metrics.inFontUcs4(ord(letter)) for text in texts for letter in text)


def test_the_picture_has_the_colours_of_its_parts() -> None:
    scene = scene_of(LIFT)
    for layer in LAYERS:
        scene.set_layer(layer, True)
    scene.set_index(58)
    shown = image(MechanismSheet(scene, 900, 675))
    assert shown.shape == (675, 900, 3)
    wanted = (LIGHT.paper, LIGHT.cam, LIGHT.slider, LIGHT.links[0], LIGHT.links[1], LIGHT.ink, LIGHT.family("velocity"))
    for colour in wanted:
        rgb = [int(colour[i : i + 2], 16) for i in (1, 3, 5)]
        assert (np.abs(shown - rgb).max(axis=2) < 12).any(), colour


# -- other mechanisms -----------------------------------------------------------------------------------------


class Quick:
    """A stand-in for a study: an inverted slider-crank with a coupler plate, and no cam."""

    def __init__(self) -> None:
        self.theta = np.arange(SAMPLES) * 2.0 * pi / SAMPLES
        self.omega = 6.0
        cam = SimpleNamespace(base_radius_mm=80.0)
        drive = SimpleNamespace(cam=cam, links=(), loads=SimpleNamespace(springs=()))
        self.design = SimpleNamespace(
            name="quick", shaft=SimpleNamespace(sense=1.0), drive=drive, outlines=(), clearances=()
        )
        self.stages, self.has_disk, self.sense, self.loading = ("linkage", "cam"), True, 1.0, Loading()
        self.has_surface = False
        end = 0.3 + 0.1 * np.exp(1j * self.theta)
        rocker = np.angle(end - (0.3 - 0.3j))
        bodies = {
            "crank": self._pose(0.3 + 0j, self.theta, {"O2": 0j, "A": 0.1 + 0j}),
            "rocker": self._pose(0.3 - 0.3j, rocker, {"O4": 0j, "tip": 0.5 + 0j}),
            "block": self._pose(end, rocker, {"A": 0j}),
            "coupler": self._pose(end, 0.3 * np.sin(self.theta), {"A": 0j, "B": 0.25 + 0j, "C": 0.1 + 0.15j}),
        }
        pairs = {
            "O2": Pair(REVOLUTE, FRAME, "crank", "O2"),
            "A": Pair(REVOLUTE, "crank", "block", "A"),
            "O4": Pair(REVOLUTE, FRAME, "rocker", "O4"),
            "slot": Pair(SLIDING, "rocker", "block", "A", 1 + 0j),
        }
        n, one = SAMPLES, np.ones(SAMPLES)
        motion = MotionState(Angles(self.theta, np.zeros(n, dtype=int)), Derivatives.of(np.zeros((4, n))), np.zeros(n))
        self.linkage = Kinematics(motion, bodies, pairs, (), "block", "crank", "O2", one + 0j, {}, {}, 0.0 * one, one)

    @property
    def cam(self) -> None:
        raise NoSolution("no cam", "cam", "")

    def _pose(self, z: np.ndarray | complex, angle: np.ndarray, points: dict[str, complex]) -> Pose:
        where, turn = np.zeros((4, SAMPLES), dtype=complex), np.zeros((4, SAMPLES))
        where[0], turn[0] = z, angle
        return Pose.of(where, turn, points)


def test_a_slide_on_a_moving_body_moves_with_it() -> None:
    quick = Quick()
    scene = MechanismScene(quick)  # type: ignore[arg-type]
    assert "ground.slot" not in scene.parts
    for i in INDICES:
        scene.set_index(i)
        rocker, rails = quick.linkage.bodies["rocker"], scene.item("rails.slot")
        assert rails.rotation() == pytest.approx(np.rad2deg(rocker.angle[0][i]))
        assert place(rails.pos()) == pytest.approx(300.0 - 300.0j)
        box = scene.item("block.slot")
        end = complex(quick.linkage.bodies["block"].z[0][i]) * 1e3
        assert place(box.mapToScene(QPointF())) == pytest.approx(end)
        on_rails = place(rails.mapFromScene(QPointF(end.real, end.imag)))
        assert on_rails.imag == pytest.approx(0.0, abs=1e-9)
        span = rails.path().boundingRect()  # type: ignore[attr-defined]
        assert span.left() < on_rails.real < span.right()
    assert scene.item("body.coupler").path().contains(QPointF(120.0, 50.0))  # type: ignore[attr-defined]


@pytest.mark.parametrize("size", [(614, 648), (502, 468), (420, 360)])
@pytest.mark.parametrize("design", [LIFT, PUSHER], ids=lambda d: d.name)
def test_no_label_stands_on_hatching(design: Design, size: tuple[int, int]) -> None:
    scene = scene_of(design)
    visible, scale = scene.fit(*size)
    scene.show_region(visible, scale)
    hatched = [part.item for key, part in scene.parts.items() if key.startswith("ground.")]
    for i in INDICES:
        scene.set_index(i)
        for key, part in scene.parts.items():
            if key.startswith("label."):
                assert isinstance(part.item, Tag)
                box = box_in_mm(part.item, scale)
                assert not any(h.mapToScene(h.path()).intersects(box) for h in hatched), f"{key} at {i}"  # type: ignore[attr-defined]


def test_the_drawing_knows_no_follower_by_name() -> None:
    from pathlib import Path

    import kindyna_gui.pictures

    words = ("cam-slider", "cam_slider", "CamSlider", "translating", Translating.__name__, '"arm"', '"rod"', '"slider"')
    for path in Path(kindyna_gui.pictures.__file__).parent.glob("*.py"):
        text = path.read_text(encoding="utf-8")
        assert not [word for word in words if word in text], path.name
