"""Forces that are seen: vectors on the mechanism and polygons of forces, held against the channels; computed only while drawn."""

import math
import re
import tomllib

import numpy as np
import pytest
from mechanisms import PUSHER, with_follower, with_loads
from window_user import Open, User, settle, wait_for

from core.design import Design, edited
from core.output.channels import channel
from core.project import from_table, load
from core.study import Study
from kindyna_gui.linkage.centres_view import PolygonView
from kindyna_gui.linkage.mechanism_view import MechanismView
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.drawing.polygons import force_diagram, force_name
from kindyna_gui.places import example

pytestmark = pytest.mark.usefixtures("app")
ANGLES = (20.0, 55.0, 300.0)


def of(study: Study, *slugs: str) -> complex:
    """Two channels of a study of one angle as x and y."""
    x, y = (float(channel(study.design, slug).values(study)[0]) for slug in slugs)
    return complex(x, y)


def forces_on(user: User, body: str) -> PolygonView:
    """Chosen in the menu, then in the list."""
    user.choose("Dyna", "Force polygon")
    view = user.window.view("polygon")
    assert isinstance(view, PolygonView)
    view.choice.setCurrentText(body)
    wait_for(lambda: view.up_to_date and view.on_screen())
    return view


def test_the_forces_on_the_arm_close_a_polygon_of_the_channels(user: User) -> None:
    sheet = forces_on(user, "Forces on arm").sheet
    for degrees in ANGLES:
        study = user.turn(degrees)
        drawn, (value, pixels) = sheet.vectors(), sheet.scale_bar
        assert drawn["F_arm pin"][1] == pytest.approx(of(study, "arm_pin_x_n", "arm_pin_y_n"), rel=1e-9)
        assert drawn["F_pivot"][1] == pytest.approx(of(study, "pivot_x_n", "pivot_y_n"), rel=1e-9)
        assert drawn["F_cam"][1] == pytest.approx(of(study, "bearing_x_n", "bearing_y_n"), rel=1e-9)
        assert drawn["G_arm"][1] == pytest.approx(-714.0 * 9.80665j, rel=1e-12)
        ends = [start + vector.conjugate() * pixels / value for start, vector in drawn.values()]
        starts = [start for start, _ in drawn.values()]
        assert ends == pytest.approx([*starts[1:], starts[0]], abs=1e-6)
        assert sheet.values["F_pivot"].startswith(f"{abs(drawn['F_pivot'][1]) / 1e3:.4g}"[:4])
        assert sheet.lines[0].startswith(f"{len(drawn)} forces, closed")


def test_the_force_in_a_pin_runs_along_its_curve(user: User) -> None:
    sheet = forces_on(user, "Force at pivot over the turn").sheet
    for degrees in ANGLES:
        study = user.turn(degrees)
        force = sheet.vectors()["F_pivot"][1]
        size, way = (float(channel(study.design, slug).values(study)[0]) for slug in ("pivot_n", "pivot_direction_deg"))
        assert force == pytest.approx(size * np.exp(1j * math.radians(way)), rel=1e-9)
        assert np.abs(sheet.curve - force).min() <= 0.02 * size, "beside one of the turn's samples"
        assert f"at {abs(way):.1f}".replace("-", "") in sheet.lines[0].replace("\u2212", "")


def test_a_linkages_forces_wait_until_they_are_chosen(open_user: Open) -> None:
    user = open_user(example("slider_crank"))
    user.choose("Compo", "Velocity polygon")
    view = user.window.view("polygon")
    assert isinstance(view, PolygonView)
    wait_for(lambda: view.up_to_date and view.on_screen())
    assert view.stages == ("linkage",)
    view.choice.setCurrentText("Forces on link 4")
    wait_for(lambda: view.up_to_date)
    assert "dynamics" in view.stages
    study = user.turn(70.0)
    drawn = view.sheet.vectors()
    assert drawn["F_B"][1] == pytest.approx(
        of(study, "B_x_n", "B_y_n") * (1.0 if study.linkage.pairs["B"].body == "link4" else -1.0)
    )
    assert {key[0] for key in drawn} >= {"F", "P", "G", "\u2212"}
    assert sum(vector for _, vector in drawn.values()) == pytest.approx(0.0, abs=1e-10)


def test_where_friction_jams_the_polygon_says_so() -> None:
    study = Study(with_loads(with_follower(PUSHER, offset_mm=0.0), friction=6.0), 72)
    jams = np.flatnonzero(np.isinf(study.dynamics.contact))[:1]
    diagram = force_diagram(study.at_theta(study.theta[jams]).free_bodies["follower"], 1.0)
    assert diagram.strokes == ()
    assert "jams" in diagram.lines[0]
    assert force_diagram(study.at_theta(study.theta[:1]).free_bodies["follower"], 1.0).strokes


def test_vectors_on_the_mechanism_are_the_channels_to_the_scale_of_the_corner(user: User) -> None:
    view = user.window.view("mechanism")
    assert isinstance(view, MechanismView)
    for action in view.layer_actions():
        if action.text() in ("Forces", "Weight and inertia forces"):
            action.trigger()
    settle()
    scene, scales = view.scene, []
    assert scene.overlay is not None
    assert [arrow.isVisible() for arrow in scene.overlay.vectors.values()] == [True, False], "one scale for both"
    for degrees in ANGLES:
        user.turn(degrees)
        study = scene.geometry.study.at_theta(scene.geometry.study.theta[scene.index : scene.index + 1])  # type: ignore[union-attr]
        forces = {"forces.pivot": "pivot", "forces.arm_pin": "arm_pin", "forces.bearing": "bearing"}
        drawn = {key: scene.item(key).path() for key in (*forces, "inertia.weight.arm")}  # type: ignore[attr-defined]
        for key, name in forces.items():
            start, tip = (drawn[key].elementAt(i) for i in (0, 3))
            vector = complex(tip.x - start.x, tip.y - start.y)
            scales.append(vector / of(study, f"{name}_x_n", f"{name}_y_n"))
        contact = scene.item("forces.contact").path()  # type: ignore[attr-defined]
        start, tip = (contact.elementAt(i) for i in (0, 3))
        scales.append(
            complex(tip.x - start.x, tip.y - start.y) / of(study, "bearing_x_n", "bearing_y_n")
        )  # which holds the cam
        start, tip = (drawn["inertia.weight.arm"].elementAt(i) for i in (0, 3))
        scales.append(complex(tip.x - start.x, tip.y - start.y) / (-714.0 * 9.80665j))
    assert scales == pytest.approx([scales[0]] * len(scales), rel=1e-6), "one scale over the turn"
    assert scales[0].real > 0.0
    assert abs(scales[0].imag) < 1e-6 * scales[0].real


# -- loads ------------------------------------------------------------------------------------------------

LOADS = {
    "masses": [{"link": 3, "mass_kg": 2.0, "centre": [30.0, 10.0]}],
    "springs": [{"from": {"link": 1, "at": [90.0, 60.0]}, "to": {"link": 4, "point": "B"}, "rate_n_per_mm": 1.0,
                 "free_length_mm": 20.0, "damping_n_s_per_mm": 0.01}],
    "torsion_springs": [{"link": 4, "on": 1, "rate_nm_per_rad": 2.0}],
    "forces": [{"link": 3, "point": "B", "x_n": 30.0, "y_n": 40.0, "torque_nm": -0.5}],
    "process": [{"link": 4, "point": "B", "direction_deg": 180.0, "force_n": 7.0, "cam_from_deg": 90.0, "cam_to_deg": 180.0}],
}  # fmt: skip


def loaded_four_bar() -> Design:
    table = tomllib.loads(example("four_bar").read_text(encoding="utf-8"))
    return from_table({**table, "assumed": [], "loads": LOADS})


def test_a_torsion_spring_and_a_spring_of_one_number_have_names_of_their_own() -> None:
    study = Study(loaded_four_bar(), 72).at_theta(np.array([1.0]))
    indices = [force_name(row)[1] for row in study.free_bodies["link4"] if "spring" in row.name]
    assert sorted(indices) == ["1", "torsion 1"]


def seen(scene: MechanismScene, key: str) -> bool:
    item = scene.item(key)
    return item.isVisible() and item.opacity() > 0.0


def test_loads_stand_where_they_act_and_move_with_it() -> None:
    study = Study(loaded_four_bar(), 72)
    scene = MechanismScene(study)
    scene.set_layer("masses", True)
    links = study.linkage.bodies
    windings = set()
    for index in (0, 10, 20, 50):
        scene.set_index(index)
        b = links["link4"].position("B")[index] * 1e3
        spring = scene.item("spring.spring1")
        ends = [spring.mapToScene(x, 0.0) for x in (0.0, 1.0)]
        assert [complex(p.x(), p.y()) for p in ends] == pytest.approx([90.0 + 60.0j, b], abs=1e-9)
        path = scene.item("spring.torsion_spring1").path()  # type: ignore[attr-defined]
        points = [complex(path.elementAt(i).x, path.elementAt(i).y) for i in range(path.elementCount())]
        round_about = np.unwrap(np.angle(np.array(points) - links["link4"].position("O4")[index] * 1e3))
        windings.add(round(float(round_about[-1] - round_about[0] + links["link4"].turn[0][index]), 9))
        arrow = scene.item("load.force1").path()  # type: ignore[attr-defined]
        tail, tip = (complex(arrow.elementAt(i).x, arrow.elementAt(i).y) for i in (0, 3))
        assert (tip - tail) / abs(tip - tail) == pytest.approx(0.6 + 0.8j, abs=1e-9)
        assert min(abs(tail - b), abs(tip - b)) < 5.0 < max(abs(tail - b), abs(tip - b))
        assert scene.item("load_value.force1").text == "50 N"  # type: ignore[attr-defined]
        assert scene.item("torque_value.force1").text == "0.5 N·m"  # type: ignore[attr-defined]
        mass = scene.item("mass.link3").pos()
        assert complex(mass.x(), mass.y()) == pytest.approx(
            links["link3"].fixed_point(0.03 + 0.01j)[0][index] * 1e3, abs=1e-9
        )
        on = 90.0 <= np.rad2deg(study.theta[index]) < 180.0
        assert seen(scene, "load_value.process1") == on
        assert scene.item("load.process1").path().isEmpty() != on  # type: ignore[attr-defined]
    assert len(windings) == 1, "wound by as much as the link turns"


def test_a_closing_spring_keeps_between_the_follower_and_its_bush() -> None:
    study = Study(load(example("card_picker")), 72)
    scene = MechanismScene(study)
    lengths = []
    for index in (0, 20, 40, 60):
        scene.set_index(index)
        spring = scene.item("spring.load")
        one, other = (spring.mapToScene(x, 0.0).y() for x in (0.0, 1.0))
        lengths.append(other - one)
        assert one == pytest.approx(
            study.linkage.follower.position("roller")[index].imag * 1e3 + scene.geometry.face_radius
        )  # type: ignore[union-attr]
    assert max(lengths) - min(lengths) == pytest.approx(
        np.ptp(study.linkage.follower.origin[0].imag[[0, 20, 40, 60]]) * 1e3
    )
    assert min(lengths) > 0.0


def test_hidden_loads_are_not_even_made() -> None:
    scene = MechanismScene(None)
    scene.set_layer("loads", False)
    scene.update_study(Study(loaded_four_bar(), 36))
    assert not any(key.startswith(("spring.", "load", "torque", "free.")) for key in scene.parts)
    scene.set_layer("loads", True)
    assert seen(scene, "load.force1")
    changed = edited(loaded_four_bar(), "loads.forces[0].x_n", 0.0)
    scene.update_study(Study(changed, 36), keep_labels=True)
    assert scene.item("load_value.force1").text == "40 N"  # type: ignore[attr-defined]


def test_all_drives_show_their_loads_and_the_chosen_one_its_colours(open_user: Open) -> None:
    user = open_user(example("transfer_unit"))
    view = user.window.view("mechanism")
    assert isinstance(view, MechanismView)
    view.arrange("beside")
    next(a for a in view.layer_actions() if a.text() == "Profile coloured by pressure angle").trigger()
    settle()
    for number, figure in view.assembly.figures.items():
        keys = {part.key for part in figure.parts}
        coloured = any(key.startswith("pressure_colours") for key in keys)
        assert coloured == (number == user.session.chosen)
        if figure.name == "Lift":
            tags = [part.item for part in figure.parts if part.key.startswith("load_value")]
            assert [tag.text for tag in tags] == ["20 kN"]  # type: ignore[attr-defined]
    assert [bar.isVisible() for bar in view.assembly.overlay.colours.values()] == [True]
    next(a for a in view.layer_actions() if a.text() == "Forces").trigger()
    settle()
    drawn = {
        number
        for number, figure in view.assembly.figures.items()
        for part in figure.parts
        if part.key.startswith("forces.")
    }
    assert drawn == {user.session.chosen}
    assert len(view.assembly.overlay.vectors) == 1


def test_force_and_pressure_are_read_on_the_profile_where_forces_are_drawn() -> None:
    design = edited(edited(load(example("rocker_cam")), "cam.thickness_mm", 12.0), "cam.material", "16mncr5")
    study = Study(edited(design, "cam.roller_material", "100cr6"), 360)
    scene = MechanismScene(study)
    scene.set_index(60)
    place = complex(study.cam.flank.contact[60] * 1e3)
    scene.read_profile(place, 1.0)
    assert scene.overlay is not None
    assert "pressure angle" in scene.overlay.reading_text
    assert "force" not in scene.overlay.reading_text
    assert "dynamics" not in vars(study)
    scene.set_layer("stress_colours", True)
    scene.read_profile(place, 1.0)
    wanted = [
        float(channel(study.design, slug).values(study)[60]) for slug in ("contact_force_n", "contact_pressure_mpa")
    ]
    told = [
        float(x) for x in re.findall(r"force ([\d.]+) N, contact pressure ([\d.]+) MPa", scene.overlay.reading_text)[0]
    ]
    assert told == pytest.approx(wanted, rel=1e-3)
    assert "at 60.0\N{DEGREE SIGN}" in scene.overlay.reading_text


def test_a_linkage_without_loads_says_what_would_fill_its_forces(open_user: Open) -> None:
    user = open_user(example("four_bar"))
    view = user.window.view("mechanism")
    assert isinstance(view, MechanismView)
    next(a for a in view.layer_actions() if a.text() == "Forces").trigger()
    settle()
    assert "Type masses and forces" in view.note.text()
