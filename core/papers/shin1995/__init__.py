"""Shin, Kim and Ha 1995, kinetodynamic analysis of cam-driven slider mechanisms: its statements in the order of the paper."""

from core.papers.claim import CONVENTION, METHOD, MISPRINT, Row, as_printed, kept, limited, mended
from core.papers.shin1995 import cam, geometry, layouts, program, sheets, torque
from core.papers.shin1995.geometry import LIFT, TABLE_2, TABLE_3, UNIT

_SINGULAR = (
    "tan of the half angle is ({numerators[0]:.4g} or {numerators[1]:.4g})/{denominator:g} where a root is at 180°"
)
_INERTIA = (
    "{value:.3f} kg·mm² would be a radius of gyration of {radius:.2f} mm on {length:g} mm; as m r²/9.81 in kgf·mm·s² it is "
    "{in_kgf:.5g} kg·m²"
)

ROWS = (
    Row("Fig. 1", "eight types: cam left or right, roller above or below, slider right or left", layouts.types, layouts.eight, LIFT,
        sheets.FIG_1),
    Row("(1)-(6), Fig. 2", "θb, θz, α0, φ0 and L0 of the base position", geometry.printed_base, kept(
        "as printed they give the base position to {off:.1g} of each value"), LIFT, sheets.FIG_2),
    Row("(7)", "β0 = 2 atan((-E ± √(D² + E² - F²))/(F - D))", geometry.base_rod, limited(
        "in doubles it gives {in_doubles:.14f}° for the lift, {ours:.14f}° by the triangle's area: no digit is lost; but " + _SINGULAR
        + ", as at the 180° that §6.4 prints"), LIFT),
    Row("(9)", "φ = 2 atan((-B ± √(A² + B² - C²))/(C - A))", geometry.level_arm, limited(
        "in doubles right to {used:.1g}° over the turn of the lift; but " + _SINGULAR), LIFT),
    Row("(10)", "β = 2 atan((-E ± √(D² + E² - F²))/(F - D))", geometry.level_rod, limited(
        "in doubles right to {used:.1g}° over the turn of the lift; but " + _SINGULAR), LIFT),
    Row("(11)-(14)", "angular velocities and accelerations of arm and rod", cam.velocities, kept(
        "right as printed: to {off:.1g} of the largest"), LIFT),
    Row("(15)-(17), Fig. 4", "VQ = Q dθ/dt, VR = Zl dφ/dt = VQ Zl/(Zxy - Q)", cam.roller_velocity, kept(
        "both ways give the roller's velocity, at most {roller:.4g} m/s, to {off:.1g} of it; VQ is at most {centre:.4g} m/s (φ "
        "counted against the cam's sense)"), LIFT, sheets.FIG_4),
    Row("(18)", "Q = Zxy φ'/(1 + φ')", cam.centre_sign, mended(CONVENTION,
        "the algebra of (15)-(17), φ' counted against the cam's sense, as it stands for a cam that turns clockwise: then the contact "
        "normal misses Q by {kept:.1g} mm; with φ' counter-clockwise, as θ, Q = Zxy φ'/(φ' - d), and as printed it is up to {printed:.3g} "
        "mm off and the normal misses it by up to {missed:.3g} mm"), LIFT, sheets.EQ_18),
    Row("(19), (20)", "ψ = atan((Q - Rx)/Ry), C = R + Rr (sin ψ, -cos ψ)", cam.quadrant, limited(
        "with the roller above the line to the pivot, as drawn, and R counted from it C is {used:.1g} mm off; below it {below:.1f} mm, a "
        "roller's diameter, since atan knows one quadrant; with a global x axis {axes:.2f} mm for the lift. Along the relative velocity's "
        "normal it is {corrected:.1g} mm in both poses"), LIFT, sheets.EQ_20),
    Row("(21)", "the slider's friction is μW", torque.guide_friction, kept(
        "the guide carries the rod's push too: μ|N| is up to {rubbed:.4g} N, μW {weight:.4g} N"), LIFT),
    Row("(23)", "By = Bx sin β (L3 + L4) + mA L4 (…) + IA d²β/dt²/(L3 + L4) cos β", torque.bracket, mended(MISPRINT,
        "the whole sum stands over (L3 + L4) cos β (and IA d²β/dt² with a minus for the β of (10)): as printed By is at most {metres:.4g} "
        "in m and {millimetres:.4g} in mm; Newton-Euler has {largest:.4g} N, and so has the corrected line, to {corrected:.1g}"), LIFT,
        sheets.EQ_23),
    Row("(24)", "inertias about the pivot, beside the moments of mD aD and mR aR", torque.counted_twice, mended(METHOD,
        "m r² is then counted twice: TL is up to {apart:.3g} N·m off, {printed:.2g} of the largest; with inertias about the mass centres "
        "it is Newton-Euler's to {corrected:.1g}"), LIFT, sheets.EQ_24),
    Row("(25)-(27)", "Tc = Rx Fcy - Ry Fcx", torque.drive_torque, kept(
        "that is the power of TL over ω to {off:.1g} of the largest, {largest:.4g} N·m"), LIFT, sheets.FIG_20),
    Row("Table 1", "nine files: menus, input, motion, make, files, compo, kine, dyna, graph", program.files, program.all_there, LIFT,
        sheets.TABLE_1_SHEET),
    Row("Table 1, FILEIO.C", "a data file of displacement, velocity and acceleration is called", program.data_file, kept(
        "{fitted} of {columns} columns make the motion; with {rows} rows of the lift the file's velocity is up to "
        "{velocity_off:.2g} mm/s off it, its acceleration {acceleration_off:.3g} mm/s², {off:.2g} of the largest"), LIFT),
    Row("Fig. 14, §6.1", "four cams on one main shaft: feed, clamp, lift and torque", torque.cams, torque.four_cams, UNIT, sheets.FIG_14),
    Row("Fig. 14, §6.1, motion", "the transfer moves front-back and up-down in three dimensions", torque.transferred, torque.in_three, UNIT,
        sheets.PATH),
    Row("Fig. 15, §6.2", "down from 35° to 76.5°, up from 283.5° to 325°, 150 mm", cam.divisions, cam.as_divided, LIFT, sheets.FIG_15),
    Row("Fig. 16", "cam left of the pivot, roller above, slider left", layouts.lift, layouts.as_b, LIFT, sheets.FIG_16),
    Row("Table 2", "lengths and masses of the slider mechanism", geometry.printed_values(TABLE_2), as_printed, LIFT, sheets.TABLE_2_SHEET),
    Row("Table 2, IL", "IL = 1691.509 kg·mm²", geometry.inertia("arm", "follower.slider_arm_mm"), geometry.as_decoded(
        _INERTIA + ", with r = LD = {r:.3f} mm, a number that stands nowhere: inferred. The example keeps arm_centre_mm = {centre:g} and "
        "takes {taken:g} kg·m² about the mass centre, {own:.4g} mm"), LIFT, sheets.TABLE_2_SHEET),
    Row("Table 2, IA", "IA = 2274.544 kg·mm²", geometry.inertia("rod", "follower.rod_mm", geometry.half_rod), geometry.as_decoded(
        _INERTIA + ", with r = L2/2 = {r:g} mm {digits} ({decoded:.3f}): a parallel-axis term. About its mass centre the example takes "
        "mA L2²/12 = {taken:g} kg·m², {own:.4g} mm"), LIFT, sheets.TABLE_2_SHEET),
    Row("Table 3", "lengths, roller and speed of the cam mechanism", geometry.printed_values(TABLE_3), as_printed, LIFT,
        sheets.TABLE_3_SHEET),
    Row("Table 3, IR", "IR = 2110.577 kg·mm²", geometry.inertia("roller", "cam.roller_radius_mm", geometry.roller_arm), geometry.as_decoded(
        _INERTIA + ", with r = Zl = {r:g} mm {digits} ({decoded:.3f}): about the pivot. About its own centre the example takes "
        "½ mR Rr² = {taken:g} kg·m², {own:.4g} mm"), LIFT, sheets.TABLE_3_SHEET),
    Row("Fig. 2, §6.4", "L0 = -919.9947 mm, φ0 = 93.30°, α0 = 136.94°, β0 = 180°", geometry.base_position, as_printed, LIFT, sheets.FIG_2),
    Row("§6.4, ω0", "ω0 = 136.94°", geometry.arm_angle, mended(MISPRINT,
        "α0 for ω0: α0 = {alpha:.4f}°; the shaft turns by {shaft:g}°/s, and at the base the arm does not turn"), LIFT, sheets.FIG_2),
    Row("§6.4, Fig. 17", "Fig. 17 is the geometry of the lift, and Fig. 17 the slider's motion", layouts.figure_numbers(sheets.SECTION_6),
        layouts.as_numbered, LIFT, sheets.FIG_16),
    Row("Fig. 17", "modified sine: velocity and acceleration are continuous over the whole turn", cam.joins, kept(
        "the largest jump at a join is {off:.1g} of the largest value; peaks {velocity:.4f} h/β and {acceleration:.4f} h/β²"), LIFT,
        sheets.FIG_17),
    Row("Fig. 18", "the shape of the designed cam", cam.shape, kept(
        "a closed profile about the base circle of {least:.6g} mm without a cusp; roller centre {near:.4g} … {far:.4g} mm, largest "
        "pressure angle {angle:.4f}°"), LIFT, sheets.FIG_18),
    Row("Fig. 19", "with the flywheel the torque is stabilised", torque.flywheel, torque.stabilised, LIFT, sheets.FIG_19),
    Row("Fig. 20", "with a flywheel much less driving torque is needed", torque.flywheel, torque.much_less, LIFT, sheets.FIG_20),
)  # fmt: skip
"""Every row of the paper."""

__all__ = ["ROWS"]
