"""Shin1995's figures and tables as numbers and as what is painted."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from core.design import get
from core.papers.examples import Examples
from core.papers.sheet import (
    Drawing,
    FigureTable,
    Lines,
    MechanismPicture,
    MechanismRow,
    PaperFigure,
    PlotLine,
    ShaftPicture,
    by_angle,
    closed,
    of_columns,
    plotted,
    posed_sheet,
    table_by_column,
)  # fmt: skip
from core.papers.shin1995 import cam, layouts, program, torque
from core.papers.shin1995.geometry import LIFT, PRINTED_INERTIAS, TABLE_2, TABLE_3, UNIT, base
from core.plot import Plot, PlotCurve
from core.study import quantity
from core.study.transfer_path import along, leads, travel

BASE_ANGLE = 180.0  # in the low dwell, where the roller is on the base circle
MM = 1e3


# -- geometry ----------------------------------------------------------------------------------------------


def _base(examples: Examples) -> FigureTable:
    values = base(examples)
    symbols = {"L0": ("slider", "mm"), "φ0": ("phi", "deg"), "α0": ("alpha", "deg"), "β0": ("beta", "deg")}
    names, units = tuple(symbols), tuple(unit for _, unit in symbols.values())
    return FigureTable(
        ("symbol", "value", "unit"),
        (names, np.array([values[key] for key, _ in symbols.values()]), units),
        "Base position",
    )


def _points(examples: Examples) -> FigureTable:
    """Where the pins are at the base position [mm], cam centre at the origin."""
    there = examples.study(LIFT).at_theta(np.array([np.deg2rad(BASE_ANGLE)]))
    bodies = there.linkage.bodies
    named = {"cam centre": 0j, "roller centre": complex(there.cam.reference[0])}
    for body, point, name in (
        ("arm", "pivot", "pivot"),
        ("arm", "arm_pin", "arm pin"),
        ("slider", "slider_pin", "slider pin"),
    ):
        named[name] = complex(bodies[body].place(point)[0])
    z = np.array(list(named.values())) * MM
    return FigureTable(("point", "x_mm", "y_mm"), (tuple(named), z.real, z.imag), "Lift mechanism at its base position")


def _dimensions(
    rows: Mapping[str, tuple[str, float, str]], inertias: Mapping[str, str], title: str
) -> Callable[[Examples], FigureTable]:
    """inertias: as named in the table -> the link's name in the loads."""

    def table(examples: Examples) -> FigureTable:
        design = examples.design(LIFT)
        names = (*rows, *inertias)
        printed = [value for _, value, _ in rows.values()] + [PRINTED_INERTIAS[link] for link in inertias.values()]
        paths = [path for path, *_ in rows.values()] + [f"loads.{link}_inertia_kg_m2" for link in inertias.values()]
        here = [float(get(design, path)) for path in paths]
        units = (*(unit for *_, unit in rows.values()), *("kg·mm² printed, kg·m² here" for _ in inertias))
        return FigureTable(
            ("quantity", "printed", "here", "unit"), (names, np.array(printed), np.array(here), units), title
        )

    return table


def _program(examples: Examples) -> FigureTable:
    found = program.files(examples)["found"]
    names, says, tried, _ = zip(*program.FILES, strict=True)
    columns = (tuple(map(str, names)), tuple(map(str, says)), tuple(map(str, tried)), np.array(list(found.values())))
    return FigureTable(("file", "key_point", "here", "value"), columns, "Program of 1995")


def _drives(examples: Examples) -> FigureTable:
    shaft = examples.shaft(UNIT)
    strokes = torque.directions(examples)["strokes"]
    names = tuple(strokes)
    phases = np.array([drive.phase_deg for drive in shaft.design.drives])
    stroke, span = (np.array([strokes[name][i] for name in names]) for i in (0, 2))
    return FigureTable(
        ("drive", "phase_deg", "stroke", "unit", "moves_deg"),
        (names, phases, stroke, tuple(strokes[n][1] for n in names), span),
        "Cams on the main shaft",
    )


# -- curves by cam angle ------------------------------------------------------------------------------------


def _of_lift(examples: Examples, **columns: np.ndarray) -> dict[str, np.ndarray]:
    """Columns by its cam angle."""
    return {"cam_angle_deg": examples.study(LIFT).angle_degrees, **columns}


def _motion(examples: Examples) -> dict[str, np.ndarray]:
    names = ("displacement", "velocity", "acceleration")
    columns = ("displacement_mm", "velocity_mm_s", "acceleration_mm_s2")
    study = examples.study(LIFT)
    return _of_lift(examples, **{c: quantity(name).value(study) * MM for name, c in zip(names, columns, strict=True)})


def _displacement(examples: Examples) -> tuple[Plot, ...]:
    at = [angle for a, b, _ in cam.divisions(examples)["strokes"] for angle in (a, b)]
    lines = Lines("Displacement, mm", (PlotLine("displacement_mm"),), quiet=True)
    return by_angle(_motion(examples), (lines,), marks=tuple((angle, f"{angle:g}°") for angle in at))


def _shape_table(examples: Examples) -> FigureTable:
    study = examples.study(LIFT)
    z = [np.asarray(each) * MM for each in (study.cam.flank.profile, study.cam.flank.pitch)]
    names = ("cam_angle_deg", "x_mm", "y_mm", "pitch_x_mm", "pitch_y_mm")
    return FigureTable(names, (study.angle_degrees, z[0].real, z[0].imag, z[1].real, z[1].imag))


def _shape(examples: Examples) -> tuple[Plot, ...]:
    study = examples.study(LIFT)
    profile, pitch = np.asarray(study.cam.flank.profile), np.asarray(study.cam.flank.pitch)
    circle = np.abs(profile).min() * np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 361))
    rows = (("cam profile", profile, False), ("roller centre", pitch, True), ("base circle", circle, True))
    curves = tuple(
        PlotCurve(closed(z).real * MM, closed(z).imag * MM, label, i, dashed)
        for i, (label, z, dashed) in enumerate(rows)
    )
    return (Plot("x, mm", "y, mm", curves, alike=True),)


# -- equations ---------------------------------------------------------------------------------------------


def _centre(examples: Examples) -> dict[str, np.ndarray]:
    names = {"q": "q_mm", "printed": "q_as_printed_mm", "corrected": "q_corrected_mm"}
    c = cam.centre(examples)
    return {"cam_angle_deg": c["degrees"], **{name: c[key] * MM for key, name in names.items()}}


def _contact_table(examples: Examples) -> FigureTable:
    c = cam.contact(examples)
    z = {
        f"{name.replace(' ', '_')}_{axis}_mm": getattr(c[name], part) * MM
        for name in c
        for axis, part in (("x", "real"), ("y", "imag"))
    }
    return FigureTable(("cam_angle_deg", *z), (examples.study(LIFT).angle_degrees, *z.values()))


def _contact(examples: Examples) -> tuple[Plot, ...]:
    c = cam.contact(examples)
    rows = (
        ("roller below the line: contact", "below", False),
        ("by (19), (20) as printed", "below printed", True),
        ("roller above the line: contact", "above", False),
    )
    curves = tuple(
        PlotCurve(closed(c[name]).real * MM, closed(c[name]).imag * MM, label, i, dashed)
        for i, (label, name, dashed) in enumerate(rows)
    )
    return (Plot("Along the line to the pivot, mm", "Across it, mm", curves, alike=True),)


def _pin(examples: Examples) -> dict[str, np.ndarray]:
    names = ("by_n", "by_as_printed_in_m", "by_as_printed_in_mm", "by_corrected_n")
    return _of_lift(examples, **dict(zip(names, torque.pin_force(examples).values(), strict=True)))


def _arm(examples: Examples) -> dict[str, np.ndarray]:
    names = ("torque_nm", "torque_as_printed_nm", "torque_corrected_nm")
    return _of_lift(examples, **dict(zip(names, torque.arm_torque(examples).values(), strict=True)))


def _arm_plots(examples: Examples) -> tuple[Plot, ...]:
    found = _arm(examples)
    found["twice"] = found["torque_as_printed_nm"] - found["torque_nm"]
    both = PlotLine("torque_nm", "here"), PlotLine("torque_as_printed_nm", "(24), inertias about the pivot", True)
    return by_angle(found, (Lines("TL, N·m", both), Lines("Counted twice, N·m", (PlotLine("twice"),))))


# -- torque ------------------------------------------------------------------------------------------------


def _torques(examples: Examples) -> dict[str, np.ndarray]:
    study = torque.fitted(examples)
    found = _of_lift(examples, drive_torque_nm=study.dynamics.torque)
    if study.flywheel.runs:
        found["motor_torque_nm"] = study.flywheel.motor_torque(study.angles)
        found["speed_rpm"] = study.flywheel.speed(study.angles) * 30.0 / np.pi
    return found


def _both(examples: Examples) -> tuple[Plot, ...]:
    inertia = torque.shaft_of(torque.fitted(examples)).flywheel_inertia_kg_m2
    levelled = PlotLine("motor_torque_nm", f"with a flywheel of {inertia:.5g} kg·m²")
    return by_angle(
        _torques(examples), (Lines("Torque, N·m", (PlotLine("drive_torque_nm", "without flywheel"), levelled)),)
    )


# fmt: off
FIG_2 = posed_sheet("figure_2", "Shin1995 Fig. 2: dimensions at the base position", LIFT, BASE_ANGLE, _base, "dimensions",
    without=("labels", "loads", "normal"))
FIG_4 = posed_sheet("figure_4", "Shin1995 Fig. 4: instant centre of cam and roller arm", LIFT, 58.5, lambda e: table_by_column(_centre(e)),
    "velocities")
FIG_15 = plotted("figure_15", "Shin1995 Fig. 15: slider motion angle", lambda e: table_by_column(_motion(e)), _displacement)
FIG_16 = posed_sheet("figure_16", "Shin1995 Fig. 16: geometry for lift mechanism", LIFT, BASE_ANGLE, _points)
FIG_17 = of_columns("figure_17", "Shin1995 Fig. 17: displacement, velocity and acceleration curves of slider", _motion,
    Lines("Displacement, mm", (PlotLine("displacement_mm", family="displacement"),)),
    Lines("Velocity, mm/s", (PlotLine("velocity_mm_s", family="velocity"),)),
    Lines("Acceleration, mm/s²", (PlotLine("acceleration_mm_s2", family="acceleration"),)))
FIG_18 = plotted("figure_18", "Shin1995 Fig. 18: cam shape", _shape_table, _shape)
FIG_19 = of_columns("figure_19", "Shin1995 Fig. 19: torque due to cam with flywheel", _torques,
    Lines("Torque with flywheel, N·m", (PlotLine("motor_torque_nm"),), fit=True), Lines("Speed, rpm", (PlotLine("speed_rpm"),), fit=True))
FIG_20 = plotted("figure_20", "Shin1995 Fig. 20: total torque curves due to cam", lambda e: table_by_column(_torques(e)), _both)
TABLE_1_SHEET = PaperFigure("table_1", "Shin1995 Table 1: structure of program", _program)
TABLE_2_SHEET = PaperFigure("table_2", "Shin1995 Table 2: data for slider mechanism",
    _dimensions(TABLE_2, {"I_L": "arm", "I_A": "rod"}, "Data for slider mechanism"))
TABLE_3_SHEET = PaperFigure("table_3", "Shin1995 Table 3: data for cam mechanism",
    _dimensions(TABLE_3, {"I_R": "roller"}, "Data for cam mechanism"))
EQ_18 = of_columns("eq_18", "Shin1995 (18): the instant centre on the line to the pivot", _centre,
    Lines("Q from the cam centre, mm", (PlotLine("q_mm", "here"), PlotLine("q_as_printed_mm", "(18) as printed", True))))
EQ_20 = plotted("eq_19_20", "Shin1995 (19), (20): contact points", _contact_table, _contact)
EQ_23 = of_columns("eq_23", "Shin1995 (23): force on the arm's pin", _pin,
    Lines("By, N", (PlotLine("by_n", "here"), PlotLine("by_as_printed_in_m", "(23) as printed, in m", True))))
EQ_24 = plotted("eq_24", "Shin1995 (24): torque on the arm", lambda e: table_by_column(_arm(e)), _arm_plots)
SECTION_6 = {16: FIG_16, 17: FIG_17, 18: FIG_18, 19: FIG_19, 20: FIG_20}
# fmt: on


def _unit(examples: Examples) -> Drawing:
    return ShaftPicture(examples.shaft(UNIT), 0.0, "Shin1995 Fig. 14: structure of transfer unit")


def _types_table(examples: Examples) -> FigureTable:
    numbers = layouts.types(examples)
    found, force = numbers["found"], numbers["force"]
    columns = tuple(tuple(row[i] for row in found.values()) for i in range(3))
    forces = np.array([force.get(letter, np.nan) for letter in found])
    return FigureTable(("type", "cam", "roller", "slider", "least_contact_force_n"), (tuple(found), *columns, forces))


def _types(examples: Examples) -> Drawing:
    there = layouts.types(examples)["found"]
    posed = tuple(
        MechanismPicture(layouts.study_of(examples, k), BASE_ANGLE, title=f"({k}) {', '.join(row)}")
        for k, row in there.items()
    )
    return MechanismRow(posed, 4, "Shin1995 Fig. 1: types of cam driving slide mechanisms; cam, roller, slider")


FIG_1 = PaperFigure("figure_1", "Shin1995 Fig. 1: types of cam driving slide mechanisms", _types_table, _types)
FIG_14 = PaperFigure("figure_14", "Shin1995 Fig. 14: structure of transfer unit", _drives, _unit)


def _path_columns(examples: Examples) -> dict[str, np.ndarray]:
    """Of what the first drives carry, by machine angle [mm, mm/s]."""
    shaft = examples.shaft(UNIT)
    return {name: travel(shaft, name)[0] * MM for name in leads(shaft)} | {"speed": along(shaft, 1) * MM}


def _path_table(examples: Examples) -> FigureTable:
    columns = _path_columns(examples)
    names = (f"{name.lower()}_mm{'_s' * (name == 'speed')}" for name in columns)
    return FigureTable(("machine_angle_deg", *names), (examples.shaft(UNIT).angle_degrees, *columns.values()))


def _path(examples: Examples) -> tuple[Plot, ...]:
    columns = {name: closed(column) for name, column in _path_columns(examples).items()}
    first, *others = leads(examples.shaft(UNIT))
    angle = np.append(examples.shaft(UNIT).angle_degrees, 360.0)
    paths = tuple(
        Plot(f"{first}, mm", f"{name}, mm", (PlotCurve(columns[first], columns[name]),), alike=True, fit=True)
        for name in others
    )
    return (*paths, Plot("Machine angle, °", "Speed, mm/s", (PlotCurve(angle, columns["speed"]),)))


PATH = plotted("figure_14_path", "Shin1995 Fig. 14: path of the transfer", _path_table, _path)
