"""Shin, Kim and Ha 1995, kinetodynamic analysis of cam-driven slider mechanisms: its claims in their order."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import isfinite
from typing import Any

import numpy as np

from core.design import all_paths, get
from core.errors import KindynaError
from core.laws import LAWS
from core.measured import ColumnChoice, fit, layout, read_sheet, read_table
from core.motion import program
from core.papers import shin1995_cam as cam
from core.papers import shin1995_cam as torque
from core.papers import shin1995_geometry as geometry
from core.papers import shin1995_geometry as layouts
from core.papers.claim import (
    CONVENTION,
    METHOD,
    MISPRINT,
    Drawing,
    Examples,
    FigureTable,
    Lines,
    MechanismPicture,
    MechanismRow,
    PaperFigure,
    PlotLine,
    Row,
    ShaftPicture,
    by_angle,
    closed,
    column_figure,
    corrected_print,
    judge_numbers,
    mechanism_figure,
    plot_figure,
    table_by_column,
    valid_where_used,
    within_bound,
)
from core.papers.shin1995_cam import largest
from core.papers.shin1995_geometry import LIFT, PRINTED_INERTIAS, TABLE_2, TABLE_3, UNIT, base
from core.plot import Plot, PlotCurve
from core.study import Study, names_of, quantity
from core.study.quantity_requests import output_travel, path_drives, path_rate

# -- Table 1 ----------------------------------------------------------------------------------------------------

Numbers = Mapping[str, Any]
EVERY = 2  # step between rows of the study: one row for each degree
COLUMNS = {"displacement": "mm", "velocity": "mm_s", "acceleration": "mm_s2"}
ALIKE = 1e-6  # relative error up to which an acceleration is that of the file


def data_file(examples: Examples) -> Numbers:
    """Motion read from a file of displacement, velocity and acceleration of the lift, a row for each degree (FILEIO.C).

    The number of columns from which it is built, and the errors of its own velocity [mm/s] and acceleration [mm/s²].
    """
    return examples.once("data file of the lift", lambda: _read(examples))


def _read(examples: Examples) -> Numbers:
    study = examples.study(LIFT)
    columns = np.array([study.angle_degrees, *(quantity(name).value(study) * 1e3 for name in COLUMNS)])[:, ::EVERY]
    heads = ("cam_angle_deg", *(f"{name}_{unit}" for name, unit in COLUMNS.items()))
    lines = "\n".join([",".join(heads), *(",".join(map(repr, row)) for row in columns.T.tolist())])
    rpm = study.design.speed_rpm
    sheet = read_sheet(lines.encode(), "lift.csv")
    columns_of_file = layout(sheet, ColumnChoice(), "mm", rpm)
    fitted = fit(read_table(sheet, columns_of_file, rpm), 0.0, laws=False)
    compiled = program(fitted.motion)
    y = compiled.state(compiled.angles(np.deg2rad(columns[0]))).displacement
    off = [float(np.abs(y[k] * study.omega**k * 1e3 - columns[1 + k]).max()) for k in range(3)]
    return {
        "fitted": len(fitted.columns) - len(fitted.contradicted),
        "columns": len(COLUMNS),
        "rows": columns.shape[1],
        "off": off[2] / float(np.abs(columns[3]).max()),
        "bound": ALIKE,
        "velocity_off": off[1],
        "acceleration_off": off[2],
    }


def _lift_measure(measure: Callable[[Study], float]) -> Callable[[Examples], float]:
    return lambda examples: measure(examples.study(LIFT))


FILES: tuple[tuple[str, str, str, Callable[[Examples], float]], ...] = (
    ("MAIN.C", "calls each program, makes the menus", "stages of a study", _lift_measure(lambda s: float(len(s.stages)))),
    ("INPUT.C", "screen input and output", "values of the form", _lift_measure(lambda s: float(len(list(all_paths(s.design)))))),
    ("MOTION.C", "follower displacement, velocity, acceleration", "motion laws", lambda _: float(len(LAWS))),
    ("MAKE.C", "makes the displacement curve, decides its continuity", "joins without a jump of v and a",
     _lift_measure(lambda s: float(sum(not join.jumps[1:3].any() for join in s.program.joins)))),
    ("FILEIO.C", "calls a data file of displacement, velocity, acceleration", "columns that make the motion",
     lambda examples: float(data_file(examples)["fitted"])),
    ("COMPO.C", "geometric form, basic position", "L0, mm", lambda examples: base(examples)["slider"]),
    ("KINE.C", "shape of the cam, pressure angle diagram", "largest pressure angle, °",
     _lift_measure(lambda s: float(np.rad2deg(largest(s, "cam", "pressure_angle"))))),
    ("DYNA.C", "cam contact forces and torque", "largest torque, N·m", _lift_measure(lambda s: largest(s, "dynamics", "drive_torque"))),
    ("GRAPH.C", "draws graphs", "quantities that a graph can show", _lift_measure(lambda s: float(len(names_of(s.design))))),
)  # fmt: skip
"""File -> its key point in Table 1, the measure of its counterpart here, and the function that computes it."""


def _value_or_zero(measure: Callable[[Examples], float], examples: Examples) -> float:
    try:
        return measure(examples)
    except KindynaError:
        return 0.0


def files(examples: Examples) -> Numbers:
    """Measure of the counterpart of each file of Table 1."""
    return {"measures": {name: _value_or_zero(measure, examples) for name, _, _, measure in FILES}}


def judge_files(measures: Mapping[str, float]) -> tuple[str, str]:
    """Judge Table 1: whether each file has a counterpart with a result."""
    without = [name for name, value in measures.items() if not isfinite(value) or value == 0.0]
    words = f"{len(measures) - len(without)} of {len(measures)} files have their counterpart, applied to the lift"
    return ("differs" if without else "agrees"), words + (f"; not {', '.join(without)}" if without else "")


# -- figures and tables -----------------------------------------------------------------------------------------

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
    """Positions of the pins at the base position [mm], cam centre at the origin."""
    study = examples.study(LIFT).at_theta(np.array([np.deg2rad(BASE_ANGLE)]))
    bodies = study.linkage.bodies
    points = {"cam centre": 0j, "roller centre": complex(study.cam.reference[0])}
    for body, point, name in (
        ("arm", "pivot", "pivot"),
        ("arm", "arm_pin", "arm pin"),
        ("slider", "slider_pin", "slider pin"),
    ):
        points[name] = complex(bodies[body].position(point)[0])
    z = np.array(list(points.values())) * MM
    return FigureTable(
        ("point", "x_mm", "y_mm"), (tuple(points), z.real, z.imag), "Lift mechanism at its base position"
    )


def _dimensions(
    rows: Mapping[str, tuple[str, float, str]], inertias: Mapping[str, str], title: str
) -> Callable[[Examples], FigureTable]:
    """Function that builds a table of dimensions; inertias: name in the table -> name of the link in the loads."""

    def table(examples: Examples) -> FigureTable:
        design = examples.design(LIFT)
        names = (*rows, *inertias)
        printed = [value for _, value, _ in rows.values()] + [PRINTED_INERTIAS[link] for link in inertias.values()]
        paths = [path for path, *_ in rows.values()] + [f"loads.{link}_inertia_kg_m2" for link in inertias.values()]
        values = [float(get(design, path)) for path in paths]
        units = (*(unit for *_, unit in rows.values()), *("kg·mm² printed, kg·m² here" for _ in inertias))
        return FigureTable(
            ("quantity", "printed", "here", "unit"), (names, np.array(printed), np.array(values), units), title
        )

    return table


def _program(examples: Examples) -> FigureTable:
    measures = files(examples)["measures"]
    names, says, measure_names, _ = zip(*FILES, strict=True)
    columns = (
        tuple(map(str, names)),
        tuple(map(str, says)),
        tuple(map(str, measure_names)),
        np.array(list(measures.values())),
    )
    return FigureTable(("file", "key_point", "here", "value"), columns, "Program of 1995")


def _drives(examples: Examples) -> FigureTable:
    shaft = examples.shaft(UNIT)
    strokes = torque.directions(examples)["strokes"]
    names = tuple(strokes)
    phases = np.array([drive.phase for drive in shaft.design.drives])
    stroke, span = (np.array([strokes[name][i] for name in names]) for i in (0, 2))
    return FigureTable(
        ("drive", "phase_deg", "stroke", "unit", "moves_deg"),
        (names, phases, stroke, tuple(strokes[n][1] for n in names), span),
        "Cams on the main shaft",
    )


# -- curves by cam angle ------------------------------------------------------------------------------------


def _lift_columns(examples: Examples, **columns: np.ndarray) -> dict[str, np.ndarray]:
    """Columns with the cam angle of the lift."""
    return {"cam_angle_deg": examples.study(LIFT).angle_degrees, **columns}


def _motion(examples: Examples) -> dict[str, np.ndarray]:
    names = ("displacement", "velocity", "acceleration")
    columns = ("displacement_mm", "velocity_mm_s", "acceleration_mm_s2")
    study = examples.study(LIFT)
    return _lift_columns(
        examples, **{c: quantity(name).value(study) * MM for name, c in zip(names, columns, strict=True)}
    )


def _displacement(examples: Examples) -> tuple[Plot, ...]:
    angles = [angle for a, b, _ in cam.divisions(examples)["strokes"] for angle in (a, b)]
    lines = Lines("Displacement, mm", (PlotLine("displacement_mm"),), quiet=True)
    return by_angle(_motion(examples), (lines,), marks=tuple((angle, f"{angle:g}°") for angle in angles))


def _shape_table(examples: Examples) -> FigureTable:
    study = examples.study(LIFT)
    z = [np.asarray(points) * MM for points in (study.cam.flank.profile, study.cam.flank.pitch)]
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
    return _lift_columns(examples, **dict(zip(names, torque.pin_force(examples).values(), strict=True)))


def _arm(examples: Examples) -> dict[str, np.ndarray]:
    names = ("torque_nm", "torque_as_printed_nm", "torque_corrected_nm")
    return _lift_columns(examples, **dict(zip(names, torque.arm_torque(examples).values(), strict=True)))


def _arm_plots(examples: Examples) -> tuple[Plot, ...]:
    columns = _arm(examples)
    columns["twice"] = columns["torque_as_printed_nm"] - columns["torque_nm"]
    both = PlotLine("torque_nm", "here"), PlotLine("torque_as_printed_nm", "(24), inertias about the pivot", True)
    return by_angle(columns, (Lines("TL, N·m", both), Lines("Counted twice, N·m", (PlotLine("twice"),))))


# -- torque ------------------------------------------------------------------------------------------------


def _torques(examples: Examples) -> dict[str, np.ndarray]:
    study = torque.with_flywheel(examples)
    columns = _lift_columns(examples, drive_torque_nm=study.dynamics.torque)
    if study.flywheel.runs:
        columns["motor_torque_nm"] = study.flywheel.motor_torque(study.angles)
        columns["speed_rpm"] = study.flywheel.speed(study.angles) * 30.0 / np.pi
    return columns


def _both(examples: Examples) -> tuple[Plot, ...]:
    inertia = torque.shaft_of(torque.with_flywheel(examples)).flywheel_inertia_kg_m2
    with_flywheel = PlotLine("motor_torque_nm", f"with a flywheel of {inertia:.5g} kg·m²")
    return by_angle(
        _torques(examples), (Lines("Torque, N·m", (PlotLine("drive_torque_nm", "without flywheel"), with_flywheel)),)
    )


# fmt: off
FIG_2 = mechanism_figure("figure_2", "Shin1995 Fig. 2: dimensions at the base position", LIFT, BASE_ANGLE, _base, "dimensions",
    without=("labels", "loads", "normal"))
FIG_4 = mechanism_figure("figure_4", "Shin1995 Fig. 4: instant centre of cam and roller arm", LIFT, 58.5,
    lambda e: table_by_column(_centre(e)), "velocities")
FIG_15 = plot_figure("figure_15", "Shin1995 Fig. 15: slider motion angle", lambda e: table_by_column(_motion(e)), _displacement)
FIG_16 = mechanism_figure("figure_16", "Shin1995 Fig. 16: geometry for lift mechanism", LIFT, BASE_ANGLE, _points)
FIG_17 = column_figure("figure_17", "Shin1995 Fig. 17: displacement, velocity and acceleration curves of slider", _motion,
    Lines("Displacement, mm", (PlotLine("displacement_mm", family="displacement"),)),
    Lines("Velocity, mm/s", (PlotLine("velocity_mm_s", family="velocity"),)),
    Lines("Acceleration, mm/s²", (PlotLine("acceleration_mm_s2", family="acceleration"),)))
FIG_18 = plot_figure("figure_18", "Shin1995 Fig. 18: cam shape", _shape_table, _shape)
FIG_19 = column_figure("figure_19", "Shin1995 Fig. 19: torque due to cam with flywheel", _torques,
    Lines("Torque with flywheel, N·m", (PlotLine("motor_torque_nm"),), fit=True), Lines("Speed, rpm", (PlotLine("speed_rpm"),), fit=True))
FIG_20 = plot_figure("figure_20", "Shin1995 Fig. 20: total torque curves due to cam", lambda e: table_by_column(_torques(e)), _both)
TABLE_1_SHEET = PaperFigure("table_1", "Shin1995 Table 1: structure of program", _program)
TABLE_2_SHEET = PaperFigure("table_2", "Shin1995 Table 2: data for slider mechanism",
    _dimensions(TABLE_2, {"I_L": "arm", "I_A": "rod"}, "Data for slider mechanism"))
TABLE_3_SHEET = PaperFigure("table_3", "Shin1995 Table 3: data for cam mechanism",
    _dimensions(TABLE_3, {"I_R": "roller"}, "Data for cam mechanism"))
EQ_18 = column_figure("eq_18", "Shin1995 (18): the instant centre on the line to the pivot", _centre,
    Lines("Q from the cam centre, mm", (PlotLine("q_mm", "here"), PlotLine("q_as_printed_mm", "(18) as printed", True))))
EQ_20 = plot_figure("eq_19_20", "Shin1995 (19), (20): contact points", _contact_table, _contact)
EQ_23 = column_figure("eq_23", "Shin1995 (23): force on the arm's pin", _pin,
    Lines("By, N", (PlotLine("by_n", "here"), PlotLine("by_as_printed_in_m", "(23) as printed, in m", True))))
EQ_24 = plot_figure("eq_24", "Shin1995 (24): torque on the arm", lambda e: table_by_column(_arm(e)), _arm_plots)
SECTION_6 = {16: FIG_16, 17: FIG_17, 18: FIG_18, 19: FIG_19, 20: FIG_20}
# fmt: on


def _types_table(examples: Examples) -> FigureTable:
    numbers = layouts.types(examples)
    layouts_found, force = numbers["layouts"], numbers["force"]
    columns = tuple(tuple(row[i] for row in layouts_found.values()) for i in range(3))
    forces = np.array([force.get(letter, np.nan) for letter in layouts_found])
    return FigureTable(
        ("type", "cam", "roller", "slider", "least_contact_force_n"), (tuple(layouts_found), *columns, forces)
    )


def _types(examples: Examples) -> Drawing:
    mechanisms = tuple(
        MechanismPicture(layouts.study_of(examples, k), BASE_ANGLE, title=f"({k}) {', '.join(row)}")
        for k, row in layouts.types(examples)["layouts"].items()
    )
    return MechanismRow(mechanisms, 4, "Shin1995 Fig. 1: types of cam driving slide mechanisms; cam, roller, slider")


FIG_1 = PaperFigure("figure_1", "Shin1995 Fig. 1: types of cam driving slide mechanisms", _types_table, _types)
FIG_14 = PaperFigure(
    "figure_14",
    "Shin1995 Fig. 14: structure of transfer unit",
    _drives,
    lambda examples: ShaftPicture(examples.shaft(UNIT), 0.0, "Shin1995 Fig. 14: structure of transfer unit"),
)


def _path_columns(examples: Examples) -> dict[str, np.ndarray]:
    """Path of the transfer by machine angle [mm], and its speed [mm/s]."""
    shaft = examples.shaft(UNIT)
    return {name: output_travel(shaft, name)[0] * MM for name in path_drives(shaft)} | {
        "speed": path_rate(shaft, 1) * MM
    }


def _path_table(examples: Examples) -> FigureTable:
    columns = _path_columns(examples)
    names = (f"{name.lower()}_mm{'_s' * (name == 'speed')}" for name in columns)
    return FigureTable(("machine_angle_deg", *names), (examples.shaft(UNIT).angle_degrees, *columns.values()))


def _path(examples: Examples) -> tuple[Plot, ...]:
    columns = {name: closed(column) for name, column in _path_columns(examples).items()}
    first, *others = path_drives(examples.shaft(UNIT))
    angle = np.append(examples.shaft(UNIT).angle_degrees, 360.0)
    paths = tuple(
        Plot(f"{first}, mm", f"{name}, mm", (PlotCurve(columns[first], columns[name]),), alike=True, fit=True)
        for name in others
    )
    return (*paths, Plot("Machine angle, °", "Speed, mm/s", (PlotCurve(angle, columns["speed"]),)))


PATH = plot_figure("figure_14_path", "Shin1995 Fig. 14: path of the transfer", _path_table, _path)


# -- rows of claims ---------------------------------------------------------------------------------------------

_SINGULAR = (
    "tan of the half angle is ({numerators[0]:.4g} or {numerators[1]:.4g})/{denominator:g} where a root is at 180°"
)
_INERTIA = (
    "{value:.3f} kg·mm² would be a radius of gyration of {radius:.2f} mm on {length:g} mm; as m r²/9.81 in kgf·mm·s² it is "
    "{in_kgf:.5g} kg·m²"
)

ROWS = (
    Row("Fig. 1", "eight types: cam left or right, roller above or below, slider right or left", layouts.types, layouts.eight, LIFT,
        FIG_1),
    Row("(1)-(6), Fig. 2", "θb, θz, α0, φ0 and L0 of the base position", geometry.printed_base, within_bound(
        "as printed they give the base position to {off:.1g} of each value"), LIFT, FIG_2),
    Row("(7)", "β0 = 2 atan((-E ± √(D² + E² - F²))/(F - D))", geometry.base_rod, valid_where_used(
        "in doubles it gives {in_doubles:.14f}° for the lift, {ours:.14f}° by the triangle's area: no digit is lost; but " + _SINGULAR
        + ", as at the 180° that §6.4 prints"), LIFT),
    Row("(9)", "φ = 2 atan((-B ± √(A² + B² - C²))/(C - A))", geometry.level_arm, valid_where_used(
        "in doubles right to {used:.1g}° over the turn of the lift; but " + _SINGULAR), LIFT),
    Row("(10)", "β = 2 atan((-E ± √(D² + E² - F²))/(F - D))", geometry.level_rod, valid_where_used(
        "in doubles right to {used:.1g}° over the turn of the lift; but " + _SINGULAR), LIFT),
    Row("(11)-(14)", "angular velocities and accelerations of arm and rod", cam.velocities, within_bound(
        "right as printed: to {off:.1g} of the largest"), LIFT),
    Row("(15)-(17), Fig. 4", "VQ = Q dθ/dt, VR = Zl dφ/dt = VQ Zl/(Zxy - Q)", cam.roller_velocity, within_bound(
        "both ways give the roller's velocity, at most {roller:.4g} m/s, to {off:.1g} of it; VQ is at most {centre:.4g} m/s (φ "
        "counted against the cam's sense)"), LIFT, FIG_4),
    Row("(18)", "Q = Zxy φ'/(1 + φ')", cam.centre_sign, corrected_print(CONVENTION,
        "the algebra of (15)-(17), φ' counted against the cam's sense, is that of a cam that turns clockwise: then the contact normal "
        "misses Q by {missed_corrected:.1g} mm; with φ' counter-clockwise, as θ, Q = Zxy φ'/(φ' - d), and as printed it is up to "
        "{printed:.3g} mm off and the normal misses it by up to {missed:.3g} mm"), LIFT, EQ_18),
    Row("(19), (20)", "ψ = atan((Q - Rx)/Ry), C = R + Rr (sin ψ, -cos ψ)", cam.quadrant, valid_where_used(
        "with the roller above the line to the pivot, as drawn, and R counted from it C is {used:.1g} mm off; below it {below:.1f} mm, a "
        "roller's diameter, since atan knows one quadrant; with a global x axis {axes:.2f} mm for the lift. Along the relative velocity's "
        "normal it is {corrected:.1g} mm in both poses"), LIFT, EQ_20),
    Row("(21)", "the slider's friction is μW", torque.guide_friction, within_bound(
        "the guide also supports the rod's force: μ|N| is up to {friction:.4g} N, μW {weight:.4g} N"), LIFT),
    Row("(23)", "By = Bx sin β (L3 + L4) + mA L4 (…) + IA d²β/dt²/(L3 + L4) cos β", torque.bracket, corrected_print(MISPRINT,
        "the complete sum is over (L3 + L4) cos β (and IA d²β/dt² with a minus for the β of (10)): as printed By is at most {metres:.4g} "
        "in m and {millimetres:.4g} in mm; Newton-Euler has {largest:.4g} N, and so has the corrected line, to {corrected:.1g}"), LIFT,
        EQ_23),
    Row("(24)", "inertias about the pivot, together with the moments of mD aD and mR aR", torque.counted_twice, corrected_print(METHOD,
        "m r² is then counted twice: TL is up to {difference:.3g} N·m off, {printed:.2g} of the largest; with inertias about the mass "
        "centres it is Newton-Euler's to {corrected:.1g}"), LIFT, EQ_24),
    Row("(25)-(27)", "Tc = Rx Fcy - Ry Fcx", torque.drive_torque, within_bound(
        "that is the power of TL over ω to {off:.1g} of the largest, {largest:.4g} N·m"), LIFT, FIG_20),
    Row("Table 1", "nine files: menus, input, motion, make, files, compo, kine, dyna, graph", files, judge_files, LIFT,
        TABLE_1_SHEET),
    Row("Table 1, FILEIO.C", "a data file of displacement, velocity and acceleration is called", data_file, within_bound(
        "{fitted} of {columns} columns make the motion; with {rows} rows of the lift the file's velocity is up to "
        "{velocity_off:.2g} mm/s off it, its acceleration {acceleration_off:.3g} mm/s², {off:.2g} of the largest"), LIFT),
    Row("Fig. 14, §6.1", "four cams on one main shaft: feed, clamp, lift and torque", torque.cams, torque.four_cams, UNIT, FIG_14),
    Row("Fig. 14, §6.1, motion", "the transfer moves front-back and up-down in three dimensions", torque.transferred, torque.in_three, UNIT,
        PATH),
    Row("Fig. 15, §6.2", "down from 35° to 76.5°, up from 283.5° to 325°, 150 mm", cam.divisions, cam.as_divided, LIFT, FIG_15),
    Row("Fig. 16", "cam left of the pivot, roller above, slider left", layouts.lift, layouts.as_b, LIFT, FIG_16),
    Row("Table 2", "lengths and masses of the slider mechanism", geometry.printed_values(TABLE_2), judge_numbers, LIFT, TABLE_2_SHEET),
    Row("Table 2, IL", "IL = 1691.509 kg·mm²", geometry.inertia("arm", "follower.slider_arm_mm"), geometry.as_decoded(
        _INERTIA + ", with r = LD = {r:.3f} mm, a number that is not printed: inferred. The example has arm_centre_mm = {centre:g} and "
        "{taken:g} kg·m² about the mass centre, {example_radius:.4g} mm"), LIFT, TABLE_2_SHEET),
    Row("Table 2, IA", "IA = 2274.544 kg·mm²", geometry.inertia("rod", "follower.rod_mm", geometry.half_rod), geometry.as_decoded(
        _INERTIA + ", with r = L2/2 = {r:g} mm {digits} ({decoded:.3f}): a parallel-axis term. About its mass centre the example has "
        "mA L2²/12 = {taken:g} kg·m², {example_radius:.4g} mm"), LIFT, TABLE_2_SHEET),
    Row("Table 3", "lengths, roller and speed of the cam mechanism", geometry.printed_values(TABLE_3), judge_numbers, LIFT,
        TABLE_3_SHEET),
    Row("Table 3, IR", "IR = 2110.577 kg·mm²", geometry.inertia("roller", "cam.roller_radius_mm", geometry.roller_arm), geometry.as_decoded(
        _INERTIA + ", with r = Zl = {r:g} mm {digits} ({decoded:.3f}): about the pivot. About its own centre the example has "
        "½ mR Rr² = {taken:g} kg·m², {example_radius:.4g} mm"), LIFT, TABLE_3_SHEET),
    Row("Fig. 2, §6.4", "L0 = -919.9947 mm, φ0 = 93.30°, α0 = 136.94°, β0 = 180°", geometry.base_position, judge_numbers, LIFT, FIG_2),
    Row("§6.4, ω0", "ω0 = 136.94°", geometry.arm_angle, corrected_print(MISPRINT,
        "α0 for ω0: α0 = {alpha:.4f}°; the shaft turns by {shaft:g}°/s, and at the base the arm does not turn"), LIFT, FIG_2),
    Row("§6.4, Fig. 17", "Fig. 17 is the geometry of the lift, and Fig. 17 the slider's motion", layouts.figure_numbers(SECTION_6),
        layouts.as_numbered, LIFT, FIG_16),
    Row("Fig. 17", "modified sine: velocity and acceleration are continuous over the whole turn", cam.joins, within_bound(
        "the largest jump at a join is {off:.1g} of the largest value; peaks {velocity:.4f} h/β and {acceleration:.4f} h/β²"), LIFT,
        FIG_17),
    Row("Fig. 18", "the shape of the designed cam", cam.shape, within_bound(
        "a closed profile about the base circle of {least:.6g} mm without a cusp; roller centre {near:.4g} … {far:.4g} mm, largest "
        "pressure angle {angle:.4f}°"), LIFT, FIG_18),
    Row("Fig. 19", "with the flywheel the torque is stabilised", torque.flywheel, torque.stabilised, LIFT, FIG_19),
    Row("Fig. 20", "with a flywheel much less driving torque is needed", torque.flywheel, torque.much_less, LIFT, FIG_20),
)  # fmt: skip
"""Every row of the paper."""
