"""Does every sign matter to a test? One change of ``core`` after the other, each to turn a named test red.

    .venv/bin/python tests/mutations.py [WORD ...]

works on copies of the tree, never on the tree itself; with words, only on the files whose path holds one of them.
Fails where a test does not notice its change, where the text to be changed no longer stands in its file exactly once,
and where a named test does not pass to begin with.
"""

from __future__ import annotations

import os
import queue
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from digit_mutations import DIGIT_MUTATIONS
from linkage_mutations import LINKAGE_MUTATIONS
from shaft_mutations import MUTATIONS as SHAFT_MUTATIONS

ROOT = Path(__file__).parents[1]
COPIED = ("core", "kindyna_gui", "tests", "resources", "pyproject.toml")
LONGEST = 300  # [s] one test may take

LAWS, MOTION, LINKAGE, CAM = (f"tests/core/test_{name}.py::" for name in ("laws", "motion", "linkage", "cam"))
DYNAMICS, SHAFT, EXTREMES = (f"tests/core/test_{name}.py::" for name in ("dynamics", "shaft", "extremes"))
CROSSINGS = "tests/core/test_crossings.py::"
PASSES_ZERO = CROSSINGS + "test_a_root_is_found_to_the_last_bits_whatever_the_slopes_on_its_sides"
STUDY, CHANNELS, CLI = (f"tests/core/test_{name}.py::" for name in ("study", "channels", "cli"))
SHIN = "tests/validation/test_shin1995.py::"

TEXTBOOK = LAWS + "test_a_law_and_its_three_derivatives_keep_to_the_textbook"
TRAPEZOID, SINE = TEXTBOOK + "[modified-trapezoid]", TEXTBOOK + "[modified-sine]"
CIRCLES = LINKAGE + "test_points_angles_and_three_derivatives_follow_from_the_circles"
ARM = CIRCLES + "[c-2.5]"  # layout c within a rise: no derivative vanishes
SIDES = LINKAGE + "test_roller_and_slider_stand_on_the_side_the_letter_says"
PITCH = CAM + "test_profile_pressure_angle_and_curvatures_follow_from_the_pitch_curve"
RELATIVE = CAM + "test_the_relative_motion_is_the_pitch_curves_own_derivatives[c]"
CENTRE = CAM + "test_cam_and_follower_move_alike_at_their_instant_centre"
CUT_FREE = DYNAMICS + "test_every_reaction_is_that_of_bodies_cut_free"
REACTIONS, PUSHED = CUT_FREE + "[c-4.3]", CUT_FREE + "[pusher-1.5]"
BALANCE = DYNAMICS + "test_power_and_momentum_balance_to_a_millionth_of_a_millionth"
GUIDE = DYNAMICS + "test_the_guide_solves_its_equation_or_jams[1.9-0.5-1.0-5.0]"
WAVE = SHAFT + "test_a_wave_of_torque_comes_to_the_motor_smaller_and_later[even-0.5-1]"
STIFF_WAVE = SHAFT + "test_a_wave_of_torque_comes_to_the_motor_smaller_and_later[even-0.001-1]"
STEP = SHAFT + "test_a_step_of_torque_reaches_the_motor_exponentially[1.0]"
DIGITS = SHAFT + "test_what_the_flywheel_does_within_a_panel_keeps_its_digits"
MEAN = SHAFT + "test_a_wave_has_its_mean_and_swings_by_twice_its_integral[1-halves]"
COLUMNS = CHANNELS + "test_every_column_holds_what_its_name_says[c]"
MOVES = MOTION + "test_a_motion_keeps_to_its_laws_at_any_cam_angle"
ORDER = MOTION + "test_in_turn_or_in_any_order_the_motion_is_the_same_to_the_last_bit[lift]"
JUMPS = MOTION + "test_jumps_are_told_with_their_cam_angle_size_and_segment"
CLOSED = LINKAGE + "test_the_loop_is_closed_and_stays_on_one_branch"
AHEAD = LINKAGE + "test_every_body_points_where_its_angle_says[c]"
DEAD_ANGLES = LINKAGE + "test_the_area_keeps_all_its_digits_down_to_dead_centres"
NEEDLE = LINKAGE + "test_area_and_angle_keep_their_digits_in_a_needle[3.0-4.0-5.0]"
DEAD_CENTRE = LINKAGE + "test_near_a_dead_centre_a_finding_names_the_angle_and_the_sine"
JAMS = DYNAMICS + "test_the_guide_solves_its_equation_or_jams[1.9--4.0-1.0-5.0]"
TOP = EXTREMES + "test_a_waves_top_and_bottom_are_found_to_rounding[1.0-one]"
COMBINED = DYNAMICS + "test_masses_on_one_body_combine_about_their_common_centre"
UNDERCUT = CAM + "test_undercut_is_told_from_the_sharpest_place_on_and_not_before"
FRESH = STUDY + "test_what_an_edit_leaves_alone_is_the_same_object_and_what_it_touches_changes"

# file: (what stands there, what shall stand there, the test that must fail)
MUTATIONS: dict[str, list[tuple[str, str, str]]] = {
    "core/vectors.py": [
        ("a.real * b.imag - a.imag * b.real", "a.real * b.imag + a.imag * b.real", PITCH + "[c-2.5]"),
        ("a.real * b.real + a.imag * b.imag", "a.real * b.real - a.imag * b.imag", PITCH + "[c-2.5]"),
        ("u * a1 * 1j if", "u * a1 * -1j if", CLOSED),
        ("factor.imag = rates[1]", "factor.imag = -rates[1]", ARM),
        ("np.multiply(-a1, a1", "np.multiply(a1, a1", ARM),
        ("np.multiply(-3.0 * a1, rates[1]", "np.multiply(3.0 * a1, rates[1]", ARM),
        ("np.multiply(-3.0 * a1, rates[1]", "np.multiply(-2.0 * a1, rates[1]", ARM),
        ("np.subtract(rates[2], a1 * a1", "np.add(rates[2], a1 * a1", ARM),
    ],
    "core/laws/pieces.py": [
        ("v + speed * cos0, row.level / 2.0", "v - speed * cos0, row.level / 2.0", TRAPEZOID),
        ("v + speed * cos0, row.level / 2.0", "v + speed * cos0, row.level", TRAPEZOID),
        ("(s + place * sin0, v", "(s - place * sin0, v", TRAPEZOID),
        ("Sine(-place, f, row.phase)", "Sine(place, f, row.phase)", TRAPEZOID),
        ("place * (sin0 - sin1)", "place * (sin1 - sin0)", TRAPEZOID),
        ("speed * (cos0 - cos1)", "speed * (cos1 - cos0)", TRAPEZOID),
        ("0.5 * row.level * w", "row.level * w", TRAPEZOID),
        ("w * (v + speed * cos0 +", "w * (v - speed * cos0 +", TRAPEZOID),
        ("a / f, a / f**2", "a / f, a / f", TRAPEZOID),
        ("math.sin(row.phase), math.cos(row.phase)", "math.cos(row.phase), math.sin(row.phase)", TRAPEZOID),
        ("_scaled(p, 1.0 / s)", "_scaled(p, s)", TRAPEZOID),
        ("if row.width <= 0.0", "if row.width < 0.0", LAWS + "test_integration_leaves_out_what_has_no_width"),
        ("np.arange(1, last.shape[0])", "np.arange(2, last.shape[0] + 1)", TEXTBOOK + "[3-4-5]"),
        ("out[0] += sin", "out[0] -= sin", TEXTBOOK + "[cycloidal]"),
        ("out[1] += f * cos", "out[1] -= f * cos", TEXTBOOK + "[cycloidal]"),
        ("out[2] -= f2 * sin", "out[2] += f2 * sin", TEXTBOOK + "[cycloidal]"),
        ("out[3] -= f2 * f * cos", "out[3] += f2 * f * cos", TEXTBOOK + "[cycloidal]"),
        ("f * w + phase[index]", "f * w - phase[index]", SINE),
        ("f * w + phase\n", "f * w - phase\n", TEXTBOOK + "[simple-harmonic]"),
        ("total += c\n", "total -= c\n", TEXTBOOK + "[3-4-5]"),
        ("total += row", "total -= row", SINE),
        ("np.flatnonzero(index[1:] != index[:-1]) + 1", "np.flatnonzero(index[1:] != index[:-1])",
         MOTION + "test_in_turn_or_in_any_order_the_motion_is_the_same_to_the_last_bit[lift]"),
    ],
    "core/laws/table.py": [
        ("(Sine(-_K / 4, 4 * pi),)", "(Sine(_K / 4, 4 * pi),)", SINE),
        ("Sine(-2.25 * _K", "Sine(2.25 * _K", SINE),
        ("(2 + pi / 8) * _K", "(2 - pi / 8) * _K", SINE),
        ("4 * pi / 3, pi / 2", "4 * pi / 3, pi / 3", SINE),
        ("Sine(_K / 4, 4 * pi, pi / 2)", "Sine(_K / 4, 4 * pi, -pi / 2)", SINE),
        ("(4 + 7 * pi / 8) * _K", "(4 - 7 * pi / 8) * _K", SINE),
        ("HARMONIC = _one(0.5, sines=(Sine(-0.5", "HARMONIC = _one(0.5, sines=(Sine(0.5", TEXTBOOK + "[simple-harmonic]"),
        ("Sine(-0.5 / pi, 2 * pi)", "Sine(0.5 / pi, 2 * pi)", TEXTBOOK + "[cycloidal]"),
        ("10.0, -15.0, 6.0)", "10.0, 15.0, 6.0)", TEXTBOOK + "[3-4-5]"),
        ("35.0, -84.0, 70.0, -20.0)", "35.0, -84.0, 70.0, 20.0)", TEXTBOOK + "[4-5-6-7]"),
        ("amplitude=-1.0, frequency=fall)", "amplitude=1.0, frequency=fall)", TRAPEZOID),
        ("c / 2, level=-1.0", "c / 2, level=1.0", TRAPEZOID),
        ("amplitude=-1.0, frequency=ramp, phase=pi / 2", "amplitude=-1.0, frequency=ramp", TRAPEZOID),
        ("pi / b if b else 1.0, pi / d if d", "pi / d if b else 1.0, pi / b if d",
         LAWS + "test_peaks_are_the_published_ones[modified sine + CV 20% (SCCA; MCV/MSC)]"),
    ],
    "core/motion.py": [
        ("/ self._span[at] - self._u0[at]", "/ self._span[at] + self._u0[at]", ORDER),
        ("/ self._span[piece] - self._u0[piece]", "/ self._span[piece] + self._u0[piece]", MOVES),
        ("self._rise / self._span **", "self._rise * self._span **", MOVES),
        ("y[0] += self._base[at]", "y[0] -= self._base[at]", ORDER),
        ("out[0] += self._base[piece]", "out[0] -= self._base[piece]", MOVES),
        ("(motion.start + row[2])", "(motion.start - row[2])", MOVES),
        ("row[4] for row in rows", "-row[4] for row in rows", MOVES),
        ("self.starts - SNAP", "self.starts + SNAP", MOTION + "test_at_a_join_the_right_hand_limit_is_taken_and_a_rounding_below_it_too"),
        ("np.where(theta >= TURN - SNAP", "np.where(theta >= TURN",
         MOTION + "test_the_end_of_the_turn_is_its_beginning[6.283185307179585]"),
        ("low += taken", "low += 0.0",
         MOTION + "test_segments_begin_at_the_sum_of_the_spans_before_them[3600 segments]"),
        ("jump = after - before", "jump = before - after", JUMPS),
        (".y, -1, axis=1)", ".y, 1, axis=1)", JUMPS),
        ("[{(i + 1) % len(joins)}]", "[{i % len(joins)}]", JUMPS),
        ("JUMP_BOUND = 64.0", "JUMP_BOUND = 1e17", MOTION + "test_a_true_jump_is_always_told"),
        ("JUMP_BOUND = 64.0", "JUMP_BOUND = 0.0", MOTION + "test_rounding_is_never_told_as_a_jump"),
        ("bound *= 1.0 + TURN /", "bound *= 1.0 + 0.0 * TURN /", MOTION + "test_rounding_is_never_told_as_a_jump"),
        ("360.0 * np.arange(samples) / samples", "np.arange(samples) * (360.0 / samples)", MOTION + "test_degrees_are_rounded_once"),
    ],
    "core/linkage/triangle.py": [
        ("(small + gap)", "(small - gap)", NEEDLE),
        ("(big + (mid - small))", "(big + (mid + small))", NEEDLE),
        ("a * a + (b - c) * (b + c)", "a * a - (b - c) * (b + c)", NEEDLE),
        ("product >= 0.0", "product >= -9.0", LINKAGE + "test_no_triangle_gives_no_area"),
        ("folded -= less", "folded += less", NEEDLE.partition("[")[0]),
        ("stretched += more", "stretched -= more", NEEDLE.partition("[")[0]),
        ("product *= r + (a + b)", "product *= r - (a + b)", NEEDLE),
        ("product *= r + abs(a - b)", "product *= r - abs(a - b)", NEEDLE),
    ],
    "core/linkage/base.py": [
        ("theta_z - theta_b if layout.cam_left == layout.roller_above else theta_z + theta_b",
         "theta_z + theta_b if layout.cam_left == layout.roller_above else theta_z - theta_b", SIDES + "[a]"),
        ("if layout.cam_left == layout.roller_above else", "if layout.roller_above else", SIDES + "[c]"),
        ("alpha - g.fixed_angle", "alpha + g.fixed_angle", ARM),
        ("- g.fixed_angle - g.guide_angle", "- g.fixed_angle + g.guide_angle", ARM),
        ("rise = g.guide_height - g.slider_arm", "rise = g.guide_height + g.slider_arm", CIRCLES + "[lift-1.1]"),
        ("(g.rod - rise) * (g.rod + rise)", "(g.rod + rise) * (g.rod + rise)", ARM),
        ("1.0 if layout.slider_right else -1.0", "-1.0 if layout.slider_right else 1.0", SIDES + "[a]"),
        ("math.cos(phi) + run", "math.cos(phi) - run", ARM),
        ("math.sin(phi) - g.guide_height * math.cos(phi)", "math.sin(phi) + g.guide_height * math.cos(phi)",
         LINKAGE + "test_a_slider_high_above_the_pivot_keeps_the_arms_pin_on_its_side[b]"),
        ("math.atan2(rise, run)", "math.atan2(run, rise)", LINKAGE + "test_the_base_circle_is_where_the_motion_is_zero"),
        ("math.atan2(-g.pivot_y, -g.pivot_x)", "math.atan2(g.pivot_y, -g.pivot_x)", ARM),
    ],
    "core/linkage/dead_centres.py": [
        ("((self.root - far) + self.rest)", "((self.root - far) - self.rest)", DEAD_ANGLES),
        ("(self.root + far)", "(self.root - far)", DEAD_ANGLES),
        ("_DIGITS.subtract(difference, high)", "_DIGITS.add(difference, high)", DEAD_ANGLES),
    ],
    "core/linkage/rod_and_arm.py": [
        ("np.add(base.slider, y, out", "np.subtract(base.slider, y, out", ARM),
        ("square += h * h", "square -= h * h", ARM),
        ("opposite = sigma * np.arctan2", "opposite = -sigma * np.arctan2", ARM),
        ("angle(0, base.sigma, difference", "angle(0, -base.sigma, difference", ARM),
        ("angle(1, -base.sigma, -difference", "angle(1, base.sigma, -difference", ARM),
        ("np.arctan2(area, square + beside)", "np.arctan2(area, square - beside)", ARM),
        ("np.multiply(square + other, share", "np.multiply(square - other, share", ARM),
        ("np.multiply(k, share * sigma", "np.multiply(k, share * -sigma", ARM),
        ("(difference, -difference), (base.sigma, -base.sigma)", "(difference, difference), (base.sigma, -base.sigma)", AHEAD),
        ("(difference, -difference), (base.sigma, -base.sigma)", "(difference, -difference), (base.sigma, base.sigma)", AHEAD),
        ("line.real, line.imag = slider, h", "line.real, line.imag = slider, -h", ARM),
        ("_whole_turns(g, base)[which]", "0.0", LINKAGE + "test_angles_do_not_wrap_within_the_cycle"),
        ("units.real[::-1, at]", "units.real[:, at]", ARM),
        ("np.divide(-2.0 * sigma * l2", "np.divide(2.0 * sigma * l2", ARM),
        ("np.divide(2.0 * sigma * l1", "np.divide(-2.0 * sigma * l1", ARM),
        ("3.0 * w * lower[1]", "2.0 * w * lower[1]", ARM),
        ("np.array([[l1], [l2]])", "np.array([[l2], [l1]])", ARM),
        ("cos = (square - (l1", "cos = (square + (l1", ARM),
        ("known += turning * cos", "known -= turning * cos", ARM),
        ("known += turning[::-1]", "known -= turning[::-1]", ARM),
        ("known += turning[::-1]", "known += turning", ARM),
        ("out += w * w * w", "out -= w * w * w", ARM),
    ],
    "core/linkage/cam_slider.py": [
        ("else pivot + place * arm)", "else -pivot + place * arm)", ARM),
        ("travel=lambda: 1j * roller", "travel=lambda: roller", PITCH + "[c-2.5]"),
        ("pivot + g.slider_arm * unit", "pivot - g.slider_arm * unit", CLOSED),
        ("pin + g.rod * unit", "pin - g.rod * unit", CLOSED),
        ("(slider + 1j * g.guide_height)", "(slider - 1j * g.guide_height)", ARM),
        ("cmath.exp(1j * g.fixed_angle)", "cmath.exp(-1j * g.fixed_angle)", ARM),
        ("cmath.exp(1j * g.guide_angle)", "cmath.exp(-1j * g.guide_angle)", ARM),
        ("_ahead(solved.phi, g.fixed_angle + g.guide_angle)", "_ahead(solved.phi, g.fixed_angle - g.guide_angle)", AHEAD),
        ("_ahead(solved.phi, g.guide_angle)", "_ahead(solved.phi, -g.guide_angle)", AHEAD),
        ("_ahead(solved.beta, g.guide_angle)", "_ahead(solved.beta, -g.guide_angle)", AHEAD),
        ("_polar(g.roller_arm, g.fixed_angle)", "_polar(g.roller_arm, -g.fixed_angle)",
         LINKAGE + "test_the_loop_is_closed_and_stays_on_one_branch"),
        ("solved.area / (2.0 *", "solved.area / (1.0 *", DEAD_CENTRE),
        ("np.abs(solved.rod.real)", "np.abs(solved.rod.imag)", LINKAGE + "test_a_rod_across_the_guide_is_told_with_angle_and_cosine"),
        ("~(solved.area > 0.0)", "~(solved.area >= 0.0)", LINKAGE + "test_arm_and_rod_exactly_in_line_are_told_with_the_cam_angle"),
    ],
    "core/linkage/limits.py": [
        ("AT = 1e-3", "AT = 1e-4", DEAD_CENTRE),
        ('"dead-centre": (0.05', '"dead-centre": (0.06', DEAD_CENTRE),
    ],
    "core/linkage/translating.py": [
        ("(reach - g.offset) * (reach + g.offset)", "(reach + g.offset) * (reach + g.offset)", CIRCLES + "[pusher-1.1]"),
        ("place[0] += base", "place[0] -= base", CIRCLES + "[pusher-1.1]"),
        ("z[0] += 1j * g.offset", "z[0] -= 1j * g.offset", CIRCLES + "[pusher-1.1]"),
        ("if inside <= 0.0", "if inside < 0.0", LINKAGE + "test_an_offset_beyond_the_base_circle_is_named[50.0-False]"),
    ],
    "core/instant_centres/cam.py": [
        ("pivot * turn, turn - sense", "pivot * turn, turn + sense", CENTRE + "[c]"),
        ("Centres(pivot * turn,", "Centres(-pivot * turn,", CENTRE + "[c]"),
        ("-1j * sense * speed", "1j * sense * speed", CENTRE + "[pusher]"),
        ("-1j * sense * speed", "-1j * speed", CENTRE + "[pusher turned round]"),
    ],
    "core/cam/shape.py": [
        ("(-1j * sense) ** (order - k)", "(1j * sense) ** (order - k)", RELATIVE),
        ("(-1j * sense) ** (order - k)", "(-1j) ** (order - k)", PITCH + "[lift turned round-1.1]"),
        ("(-1j * sense) ** (order - k)", "(-1j * sense)", RELATIVE),
        ("return -sense * cross(", "return sense * cross(", PITCH + "[c-2.5]"),
        ("return -sense * cross(", "return -cross(", PITCH + "[c turned round-2.5]"),
        ("return -sense * bend", "return -bend", PITCH + "[c turned round-2.5]"),
        ("cross(t, x) - 3.0 * cross", "cross(t, x) + 3.0 * cross", PITCH + "[c-2.5]"),
        ("cross(t, x) - 3.0 * cross", "cross(t, x) - 2.0 * cross", PITCH + "[c-2.5]"),
        ("normal = (-1j * sense)", "normal = (1j * sense)", PITCH + "[c-2.5]"),
        ("normal = (-1j * sense)", "normal = (-1j)", PITCH + "[c turned round-2.5]"),
        ("turned.conj() if sense > 0.0 else turned", "turned if sense > 0.0 else turned.conj()", PITCH + "[c-2.5]"),
        ("reference + radius * normal", "reference - radius * normal", PITCH + "[c-2.5]"),
        ("(1.0 - radius * pitch_curvature)", "(1.0 + radius * pitch_curvature)", PITCH + "[c-2.5]"),
        ("np.abs(cross(normal, train.travel)), np.abs(dot(normal, train.travel))",
         "np.abs(dot(normal, train.travel)), np.abs(cross(normal, train.travel))", PITCH + "[pusher-2.5]"),
        ("bad = distance <= radius", "bad = distance <= 0.5 * radius",
         CAM + "test_a_roller_that_covers_the_cam_centre_is_told_with_the_cam_angles"),
        ("still = t == 0.0", "still = t == 1.0", CAM + "test_a_roller_that_stands_still_on_the_cam_is_a_cusp_and_told"),
    ],
    "core/cam/limits.py": [
        ('extremes["pitch_curvature"].high', 'extremes["pitch_curvature"].low',
         UNDERCUT),
        ("radius * sharpest.value >= 1.0", "radius * sharpest.value >= 1.1",
         UNDERCUT),
        ("{SLIDING: 30.0, REVOLUTE: 45.0}", "{SLIDING: 45.0, REVOLUTE: 30.0}",
         CAM + "test_the_pressure_angle_is_measured_against_the_limit_of_its_follower"),
    ],
    "core/cam/proof.py": [
        ("centre.weight * shape.reference - centre.point)", "centre.weight * shape.reference + centre.point)",
         CAM + "test_every_cam_carries_its_own_proof"),
        ("by_centre = 1j * scale", "by_centre = -1j * scale", CAM + "test_every_cam_carries_its_own_proof"),
        (".min()) - radius", ".min()) + 0.0 * radius", CAM + "test_the_certificates_tangency_sees_a_dent_a_wrong_radius_and_an_undercut"),
    ],
    "core/dynamics/forces.py": [
        ("inertia.centre, 2) - self.loading.gravity", "inertia.centre, 2) + self.loading.gravity", REACTIONS),
        ("inertia.about_centre * square", "-inertia.about_centre * square", REACTIONS),
        ("(pin_a - pin_b) * axis.conjugate()", "(pin_a - pin_b) * axis", REACTIONS),
        ("in_guide = slider_force * axis.conjugate()", "in_guide = slider_force * axis", REACTIONS),
        ("    x = in_guide.real - walk.loading.along_guide(train.motion.y[0])\n    e =",
         "    x = in_guide.real + walk.loading.along_guide(train.motion.y[0])\n    e =", REACTIONS),
        ("cross(pin_b - centre, mass_force) - spin", "cross(pin_b - centre, mass_force) + spin", REACTIONS),
        ("cross(pin_b - centre, mass_force) - spin", "cross(centre - pin_b, mass_force) - spin", REACTIONS),
        ("-(x * along.imag + e)", "-(x * along.imag - e)", REACTIONS),
        ("-(x * along.imag + e)", "-(e - x * along.imag)", REACTIONS),
        ("/ along.real + in_guide.imag", "/ along.real - in_guide.imag", REACTIONS),
        ("slope = along.imag / along.real", "slope = -along.imag / along.real", REACTIONS),
        ("on_slider = (x - guide.friction", "on_slider = (x + guide.friction", REACTIONS),
        ("(in_guide.imag - guide.normal)", "(in_guide.imag + guide.normal)", REACTIONS),
        ("on_rod = on_slider + mass_force", "on_rod = on_slider - mass_force", REACTIONS),
        ("walk.pairs[inner] = on_slider, -on_rod", "walk.pairs[inner] = on_slider, on_rod", REACTIONS),
        ("walk.pairs[sliding] = (guide.friction +", "walk.pairs[sliding] = (-guide.friction +", REACTIONS),
        (".point] = -on_rod", ".point] = on_rod", REACTIONS),
        ("moment = -spin - cross", "moment = spin - cross", REACTIONS),
        ("moment = -spin - cross", "moment = -spin + cross", REACTIONS),
        ("moment = moment + cross", "moment = moment - cross", REACTIONS),
        ("outer = outer + force", "outer = outer - force", REACTIONS),
        ("mass_force - outer + contact", "mass_force + outer + contact", REACTIONS),
        ("mass_force - outer + contact", "mass_force - outer - contact", REACTIONS),
        ("return contact, -moment", "return contact, moment", REACTIONS),
        ("slope = across / forward", "slope = -across / forward", PUSHED),
        ("-x * slope + in_guide.imag", "x * slope + in_guide.imag", PUSHED),
        ("-x * slope + in_guide.imag", "-x * slope - in_guide.imag", PUSHED),
        ("(guide.friction - x) / forward", "(guide.friction + x) / forward", PUSHED),
        ("(guide.friction - x) / forward", "(-guide.friction - x) / forward", PUSHED),
        ("return contact, -contact * forward", "return contact, contact * forward", PUSHED),
        ('walk.pairs["bearing"] = -pressing', 'walk.pairs["bearing"] = pressing', PUSHED),
        ("torque = -shape.sense *", "torque = shape.sense *", PUSHED),
        ("torque = -shape.sense *", "torque = -1.0 *", CUT_FREE + "[pusher turned round-1.5]"),
    ],
    "core/dynamics/friction.py": [
        ("tau = coefficient * way", "tau = -coefficient * way", GUIDE),
        ("* slope * np.sign(frictionless)", "* slope", DYNAMICS + "test_the_guide_solves_its_equation_or_jams[0.1-0.5-1.0--3.0]"),
        ("frictionless / (1.0 + tau)", "frictionless / (1.0 - tau)", GUIDE),
        ("friction = -coefficient", "friction = coefficient", PUSHED),
        ("tau > -1.0", "tau > -9.0", JAMS),
        ("np.abs(coefficient * slope)", "coefficient * slope", JAMS),
    ],
    "core/dynamics/loading.py": [
        ("self.force - self.rate * y", "self.force + self.rate * y", REACTIONS),
        ("+ p.mass * abs(p.centre - centre) ** 2", "", COMBINED),
        ("abs(p.centre - centre) ** 2", "abs(p.centre) ** 2", COMBINED),
        ("cmath.rect(s.gravity, s.gravity_angle)", "cmath.rect(s.gravity, -s.gravity_angle)", REACTIONS),
        ("complex(s.rod_centre * g.rod)", "complex((1.0 - s.rod_centre) * g.rod)", REACTIONS),
        ("cmath.rect(s.arm_centre, s.arm_centre_angle)", "cmath.rect(s.arm_centre, -s.arm_centre_angle)", REACTIONS),
        ("cmath.rect(g.roller_arm, g.fixed_angle)", "cmath.rect(g.roller_arm, -g.fixed_angle)", REACTIONS),
        ("-s.preload", "s.preload", PUSHED),
    ],
    "core/dynamics/balance.py": [
        ("output = -loading", "output = loading", BALANCE),
        ("lost = -forces", "lost = forces", BALANCE),
        ("potential - mass", "potential + mass", BALANCE),
        ("about * a[1] * a[2]", "-about * a[1] * a[2]", BALANCE),
        ("(-forces.contact *", "(forces.contact *", BALANCE),
        ("mass * loading.gravity", "-mass * loading.gravity", BALANCE),
        ("+ about * a[2]", "- about * a[2]", BALANCE),
        ("sum(moments) - sum(turn)", "sum(moments) + sum(turn)", BALANCE),
        ("product = omega *", "product = 0.0 * omega *", BALANCE),
        ("0.5 * i * a[1] ** 2", "i * a[1] ** 2", DYNAMICS + "test_the_kinetic_energy_is_that_of_the_single_bodies"),
    ],
    "core/dynamics/limits.py": [
        ("least.value <= 0.0", "least.value <= -1.0",
         DYNAMICS + "test_separation_is_told_from_the_speed_on_where_the_spring_no_longer_follows"),
        ("worst.value >= 1.0", "worst.value >= 1.1", DYNAMICS + "test_jamming_is_told_from_the_limit_on_and_not_before[pusher]"),
    ],
    "core/shaft.py": [
        ("to_chebyshev[0] /= 2.0", "to_chebyshev[0] /= 1.0", MEAN),
        ("1.0, (-1.0, 2.0)", "1.0, (1.0, 2.0)", MEAN),
        ("sum(axis=0)).sum() / TURN)", "sum(axis=0)).sum() / pi)", MEAN),
        ("power / np.arange(1, NODES + 1)[:, None]).sum", "power / np.arange(2, NODES + 2)[:, None]).sum", MEAN),
        ("value = (1.0 - z * value)", "value = (1.0 + z * value)", WAVE),
        ("(1.0, 14)", "(1.0, 9)", DIGITS + "[1.0]"),
        ("(_PARTED, 22)", "(_PARTED, 15)", DIGITS + "[4.0]"),
        ("_PARTED = 4.0", "_PARTED = 9.0", DIGITS + "[8.5]"),
        ("_PARTED = 4.0", "_PARTED = 0.5", DIGITS + "[2.7]"),
        ("out[0] = -np.expm1(-z)", "out[0] = np.expm1(-z)", STIFF_WAVE),
        ("(1.0 - k * out[k - 1])", "(1.0 + k * out[k - 1])", STIFF_WAVE),
        ("    power[0] -= curve.mean\n    decay", "    decay", STEP + " " + WAVE),
        ("decay = np.exp(-rate", "decay = np.exp(rate", WAVE),
        ("left * end + added", "left * end - added", STEP),
        ("end / -np.expm1(-rate * TURN)", "end / np.expm1(-rate * TURN)", STEP),
        ("* np.exp(-rate * curve.start)", "* np.exp(-rate * (TURN - curve.start))", STEP),
        ("np.exp(-rate * h) * begins[at] + h", "np.exp(-rate * h) * begins[at] - h", WAVE),
        ("= s.flywheel_inertia * s.speed", "= s.flywheel_inertia", WAVE),
        ("curve.mean + rate * answer", "curve.mean - rate * answer", WAVE),
        ("s.speed_fluctuation / s.speed / s.speed", "s.speed_fluctuation / s.speed",
         SHAFT + "test_the_needed_inertia_keeps_the_speed_within_the_share"),
        ("at.max() - at.min()", "at.max()", MEAN),
        ("places.append(np.array([curve.start[panel] + root * curve.width[panel]]))", "pass", MEAN),
        ("if switch is not None", "if False", SHAFT + "test_a_kink_ends_a_panel_and_costs_nothing[1.0-0.9]"),
        ("LEAST_PANELS = 16", "LEAST_PANELS = 1", SHAFT + "test_a_jolt_within_a_thousandth_of_a_degree_is_not_lost"),
        ("if rate == np.inf", "if rate == -1.0",
         SHAFT + "test_without_flywheel_the_motor_gives_the_cams_torque_and_with_a_huge_one_the_mean"),
    ],
    "core/crossings.py": [
        ("fa / (fa - fb)", "fa / (fa + fb)", PASSES_ZERO),
        ("f * fa > 0.0", "f * fb > 0.0", PASSES_ZERO),
        ("values[:-2] * values[2:] < 0.0", "values[:-2] * values[2:] <= 0.0",
         CROSSINGS + "test_a_sample_that_is_zero_counts_once_where_the_sign_changes_and_not_where_it_does_not"),
        ("bend >= size[1:-1]", "bend < size[1:-1]",
         CROSSINGS + "test_two_changes_between_two_samples_are_seen"),
        ("< 0.0) & same)", "< 0.0))", CROSSINGS + "test_a_jump_of_sign_at_a_join_is_no_root_and_one_inside_a_piece_is"),
    ],
    "core/extremes.py": [
        ("theta[2] - h * slope / bend", "theta[2] + h * slope / bend", TOP),
        ("- 0.5 * slope * slope / bend", "+ 0.5 * slope * slope / bend", TOP),
        ("self.finest = SHARPEST", "pass", EXTREMES + "test_a_kink_is_narrowed_down[one-1.0]"),
        ("min(equal)", "max(equal)", EXTREMES + "test_of_equal_tops_the_smallest_cam_angle_is_named"),
        ("theta % (2.0 * pi)", "theta", EXTREMES + "test_an_extreme_at_the_end_of_the_turn_stands_at_zero"),
        ("np.isnan(value), -np.inf, value)\n        same", "np.isnan(value), np.inf, value)\n        same",
         EXTREMES + "test_infinity_is_highest_and_what_is_no_number_is_left_out"),
        ("np.flatnonzero(tops & np.isfinite(value))", "np.flatnonzero(tops & np.isfinite(value))[:1]",
         EXTREMES + "test_many_equal_tops_are_told_apart_by_the_highest[9]"),
    ],
    "core/study/study.py": [
        ('"linkage": (drive.motion, self.omega, drive.follower, self.reach)', '"linkage": (drive.motion, drive.follower, self.reach)',
         FRESH + "[speed]"),
        ('"cam": (drive.motion, drive.follower, drive.cam, shaft.rotation)', '"cam": (drive.motion, drive.follower, drive.cam)',
         FRESH + "[rotation]"),
        ('"cam": (drive.motion, drive.follower, drive.cam, shaft.rotation)',
         '"cam": (drive.motion, drive.follower, self.reach, shaft.rotation)',
         FRESH + "[roller for base radius]"),
        ('self.design.shaft if stage == "dynamics" else None', "None", FRESH + "[flywheel]"),
        ('self.design.shaft if stage == "dynamics" else None', "self.design.shaft",
         STUDY + "test_extremes_are_kept_too_and_another_flywheel_does_not_touch_those_of_the_cam"),
        ("self.loading.friction else None", "False else None",
         SHAFT + "test_mean_and_swing_of_a_design_are_those_of_the_quadrature[pusher]"),
    ],
    "core/study/base.py": [
        ("if self.angles.kept else", "if True else", STUDY + "test_passing_cam_angles_are_not_kept"),
    ],
    "core/study/stages.py": [
        ("return locked(function(*parts))", "return function(*parts)", STUDY + "test_nobody_can_spoil_what_others_share"),
        ("lru_cache(maxsize=KEPT)", "lru_cache(maxsize=1)", STUDY + "test_undo_computes_nothing[rod]"),
        ("lru_cache(maxsize=KEPT)", "lru_cache(maxsize=7)", STUDY + "test_eight_designs_in_turn_stay_in_memory"),
    ],
    "core/study/quantities.py": [
        ("s.motion.y[order] * s.omega**order", "s.motion.y[order]", COLUMNS),
        ("coordinates[name][order] * s.omega**order", "coordinates[name][order] * s.omega", COLUMNS),
        ("pairs[name].real", "pairs[name].imag", COLUMNS),
        ("np.mod(np.angle(study.cam.flank.profile)", "np.mod(np.angle(study.cam.flank.pitch)", COLUMNS),
    ],
    "core/channels.py": [
        ("/ self.unit.factor + 0.0", "/ self.unit.factor", CHANNELS + "test_the_text_is_plain_and_reads_back_to_the_last_bit"),
        ("/ self.unit.factor + 0.0", "* self.unit.factor + 0.0", COLUMNS),
    ],
    "core/summary.py": [
        ("value if not isinstance(value, float) or math.isfinite(value) else None", "value",
         CHANNELS + "test_findings_stand_in_the_summary_with_all_that_a_program_needs"),
    ],
}  # fmt: skip
for _more in (LINKAGE_MUTATIONS, SHAFT_MUTATIONS, DIGIT_MUTATIONS):
    for _file, _rows in _more.items():
        MUTATIONS[_file] = [*MUTATIONS.get(_file, []), *_rows]


@dataclass(frozen=True)
class Mutation:
    """One change; ``tests`` are node ids, one of which must fail."""

    file: str
    old: str
    new: str
    tests: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.file}: {self.old.strip()!r} -> {self.new.strip()!r}"


def mutations(words: Iterable[str] = ()) -> list[Mutation]:
    wanted = tuple(words)
    return [
        Mutation(file, old, new, tuple(f"tests/{t}" for t in tests.removeprefix("tests/").split(" tests/")))
        for file, rows in MUTATIONS.items()
        if not wanted or any(word in file for word in wanted)
        for old, new, tests in rows
    ]


def copied(folder: Path) -> Path:
    """A copy of what the tests need."""
    for name in COPIED:
        source, target = ROOT / name, folder / name
        if source.is_dir():
            shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy2(source, target)
    return folder


def passes(tree: Path, tests: Iterable[str]) -> bool:
    """Run tests in a copy. Raises RuntimeError where they could not be run."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTEST")}
    environment |= {"PYTHONPATH": str(tree), "PYTHONDONTWRITEBYTECODE": "1", "CI": "1"}  # CI: the same examples each time
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", "-p", "no:xdist", *tests]
    done = subprocess.run(command, cwd=tree, env=environment, capture_output=True, text=True, timeout=LONGEST)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{' '.join(tests)} could not be run:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.returncode == 0


def survives(tree: Path, mutation: Mutation) -> str:
    """What is wrong with the tests, '' where they notice the change."""
    path = tree / mutation.file
    right = path.read_text(encoding="utf-8")
    if right.count(mutation.old) != 1:
        return f"stands {right.count(mutation.old)} times in its file"
    path.write_text(right.replace(mutation.old, mutation.new), encoding="utf-8")
    try:
        return f"not noticed by {' '.join(mutation.tests)}" if passes(tree, mutation.tests) else ""
    except subprocess.TimeoutExpired:
        return ""  # noticed, in a way
    finally:
        path.write_text(right, encoding="utf-8")


def check(words: Iterable[str] = ()) -> Iterator[str]:
    """Every mutation that no test notices."""
    todo = mutations(words)
    count = os.cpu_count() or 1
    with tempfile.TemporaryDirectory() as folder:
        trees: queue.SimpleQueue[Path] = queue.SimpleQueue()
        for i in range(count):
            trees.put(copied(Path(folder) / str(i)))

        def one(mutation: Mutation) -> str:
            tree = trees.get()
            try:
                return survives(tree, mutation)
            finally:
                trees.put(tree)

        tree = trees.get()
        if not passes(tree, sorted({test for m in todo for test in m.tests})):
            yield "a named test fails as it is"
            return
        trees.put(tree)
        with ThreadPoolExecutor(count) as pool:
            for mutation, problem in zip(todo, pool.map(one, todo), strict=True):
                if problem:
                    yield f"{mutation}: {problem}"


def main(words: list[str]) -> int:
    survivors = 0
    for problem in check(words):
        print(problem, flush=True)
        survivors += 1
    print(f"{len(mutations(words))} mutations, {survivors} not noticed")
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
